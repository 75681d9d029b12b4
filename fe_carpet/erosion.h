#pragma once
/// Shells that fail: an element goes as soon as its largest principal strain passes its material's
/// failure_strain at any point of the plane, at either of the outermost points through the thickness. Its
/// mass stays on its nodes.
///
/// The strain is the sum of the increments in the element's axes: logarithmic under stretching without
/// rotation of the principal directions in the material, as in the rate form of the stress. Pure functions.
#include <cmath>

#include "fe_carpet/shell_section.h"

namespace tuft::fe {

/// gxy: engineering shear.
template <class Real>
TUFT_HD inline Real largest_principal_strain(const Real& exx, const Real& eyy, const Real& gxy) {
  using std::sqrt;
  const Real half_sum = Real(0.5) * (exx + eyy), half_difference = Real(0.5) * (exx - eyy);
  return half_sum + sqrt(half_difference * half_difference + Real(0.25) * gxy * gxy);
}

/// Height of the outermost point through the thickness over half of the thickness: a Gauss point, or the face
/// where forces and moments are integrated exactly.
template <int Points>
[[nodiscard]] constexpr double outermost_height() {
  if constexpr (Points == 1)
    return 1;
  else
    return thickness_rule<Points>().height.back();
}

/// Adds increments to the strain of a point of the plane (rows: membrane xx, yy, xy, curvature xx, yy, xy)
/// and returns its largest principal strain at the heights +-z.
template <class Real, class Rows>
[[nodiscard]] Real advance_strain(const Rows& rows, const SectionStrain<Real>& de, const Real& z) {
  using std::max;
  const auto add = [&rows](std::size_t row, const Real& increment) {
    const Real sum = rows.read(row) + increment;
    rows.write(row, sum);
    return sum;
  };
  const Real exx = add(0, de.membrane.xx), eyy = add(1, de.membrane.yy), gxy = add(2, de.membrane.xy);
  const Real kxx = z * add(3, de.curvature.xx), kyy = z * add(4, de.curvature.yy),
             kxy = z * add(5, de.curvature.xy);
  return max(largest_principal_strain<Real>(exx + kxx, eyy + kyy, gxy + kxy),
             largest_principal_strain<Real>(exx - kxx, eyy - kyy, gxy - kxy));
}

/// Work of forces over increments conjugate to them.
template <class Real>
TUFT_HD inline Real work(const ShellModes<Real>& s, const ShellModes<Real>& de) {
  return s.exx * de.exx + s.eyy * de.eyy + s.gxy * de.gxy + s.kxx * de.kxx + s.kyy * de.kyy + s.kxy * de.kxy +
         s.shear_xi * de.shear_xi + s.shear_xi_eta * de.shear_xi_eta + s.shear_eta * de.shear_eta +
         s.shear_eta_xi * de.shear_eta_xi + s.fibre_xi * de.fibre_xi + s.fibre_eta * de.fibre_eta +
         s.turn_x * de.turn_x + s.turn_y * de.turn_y + s.spin * de.spin + s.spin_xi * de.spin_xi +
         s.spin_eta * de.spin_eta + s.spin_h * de.spin_h;
}

struct ElementArrays;
struct ShellMesh;

/// Energies, J, of what was taken out.
struct ErodedWork {
  double strain = 0, hourglass = 0;  ///< work that had gone into the elements until they failed
};

/// Takes the elements out that the last update marked, in the order of their slots, and moves their work from
/// the sums of their blocks into what is returned. They bear no force any more, that of this moment included:
/// over the last step the nodes did the work of half of the force before it.
ErodedWork erode_marked(ElementArrays& elements, Index first_spare_node);

/// The mesh's nodes, with the corners of the resting square behind them where something can fail.
[[nodiscard]] Vec3Array positions_with_spares(const ShellMesh& mesh, const ElementArrays& elements);

/// Makes slots nothing: no thickness, no mass, no state, and the corners of a square that rests, on the four
/// spare nodes from first_spare_node on.
void empty_slot(ElementArrays& elements, std::size_t slot, Index first_spare_node);

}  // namespace tuft::fe
