#pragma once
/// Material laws of shells in plane stress, as pure functions from strain increments and state to stress.
///
/// Each law has
///   stress(exx, eyy, gxy)       Pa, of an instantaneous strain in the element's axes
///   transverse_stress(g)        Pa, of transverse shear, corrected for the section
///   fibre_strain(x, y)          of uniaxial stress along the direction (x, y) in the element's axes, per
///   unit
///                               of strain along it: what the bending of fibres in the plane strains
///   advance(rows, de)           new in-plane stress after a strain increment; the rows hold the point's
///   state advance_shear(rows, dg)     the same for one component of transverse shear relax_uniaxial(rows,
///   d), relax_shear(rows, d)
///                               the same for a force that goes with uniaxial stress or with shear, d being
///                               its increment by the instantaneous moduli: what hourglass modes take
///   plane_rows(), shear_rows()  how many values of state advance and the other three take
/// All moduli are Pa. Strains are increments in corotated axes, so that the laws are in rate form; the stress
/// is Cauchy's.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/scene.h"
#include "core/vector.h"

namespace tuft::fe {

/// Mindlin's shear correction for a homogeneous section.
inline constexpr double shear_correction = 5.0 / 6.0;

template <class Real>
struct PlaneStress {
  Real xx, yy, xy;
};

template <class Real>
struct PlaneStrain {
  Real xx, yy, xy;  ///< xy: engineering shear
};

/// fibre_strain of a law with one Poisson's ratio nu, whatever its modulus.
template <class Real>
[[nodiscard]] inline PlaneStrain<Real> isotropic_fibre_strain(const Real& x, const Real& y, const Real& nu) {
  const Real over = Real(1.0) / (x * x + y * y);
  const Real xx = x * x * over, yy = y * y * over;
  return {xx - nu * yy, yy - nu * xx, Real(2.0) * (Real(1.0) + nu) * x * y * over};
}

/// Stress after an increment, its mean over the increment (whose product with the strain is the work), and
/// the strain increment through the thickness.
template <class Real>
struct PlaneAdvance {
  PlaneStress<Real> stress, mean;
  Real thickness_strain;
};

/// The same of one component.
template <class Real>
struct ShearAdvance {
  Real stress, mean;
};

/// State of one point, contiguous: what tests use. The element loop has one with a pack in each row.
template <class Real>
struct PointRows {
  Real* first;
  [[nodiscard]] Real read(std::size_t row) const { return first[row]; }
  void write(std::size_t row, const Real& value) const { first[row] = value; }
  [[nodiscard]] PointRows from(std::size_t row) const { return {first + row}; }
};

template <class Real>
[[nodiscard]] inline Real power(const PlaneStress<Real>& s, const PlaneStrain<Real>& e) {
  return s.xx * e.xx + s.yy * e.yy + s.xy * e.xy;
}

/// Adds an increment of stress to the state of an elastic point.
template <class Real, class Rows>
[[nodiscard]] inline PlaneAdvance<Real> add_stress(const Rows& rows, const PlaneStress<Real>& d,
                                                   const Real& thickness_strain) {
  const PlaneStress<Real> before{rows.read(0), rows.read(1), rows.read(2)};
  const PlaneStress<Real> after{before.xx + d.xx, before.yy + d.yy, before.xy + d.xy};
  rows.write(0, after.xx);
  rows.write(1, after.yy);
  rows.write(2, after.xy);
  return {after, {before.xx + 0.5 * d.xx, before.yy + 0.5 * d.yy, before.xy + 0.5 * d.xy}, thickness_strain};
}

template <class Real, class Rows>
[[nodiscard]] inline ShearAdvance<Real> add_shear(const Rows& rows, const Real& d) {
  const Real before = rows.read(0), after = before + d;
  rows.write(0, after);
  return {after, before + 0.5 * d};
}

/// Isotropic linear elastic.
struct IsotropicLaw {
  double direct = 0;            ///< E / (1 - nu^2)
  double coupled = 0;           ///< nu E / (1 - nu^2)
  double shear = 0;             ///< G = E / (2 (1 + nu))
  double transverse_shear = 0;  ///< shear_correction x G
  double poisson = 0;
  double thinning = 0;  ///< -e_zz / (e_xx + e_yy) = nu / (1 - nu)

  [[nodiscard]] static constexpr std::size_t plane_rows() { return 3; }
  [[nodiscard]] static constexpr std::size_t shear_rows() { return 1; }

  template <class Real>
  [[nodiscard]] PlaneStress<Real> stress(const Real& exx, const Real& eyy, const Real& gxy) const {
    return {direct * exx + coupled * eyy, coupled * exx + direct * eyy, shear * gxy};
  }
  template <class Real>
  [[nodiscard]] Real transverse_stress(const Real& strain) const {
    return transverse_shear * strain;
  }
  template <class Real>
  [[nodiscard]] PlaneStrain<Real> fibre_strain(const Real& x, const Real& y) const {
    return isotropic_fibre_strain(x, y, Real(poisson));
  }
  [[nodiscard]] double drilling_modulus() const { return shear; }
  template <class Real, class Rows>
  [[nodiscard]] PlaneAdvance<Real> advance(const Rows& rows, const PlaneStrain<Real>& de) const {
    return add_stress(rows, stress(de.xx, de.yy, de.xy), Real(-thinning * (de.xx + de.yy)));
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> advance_shear(const Rows& rows, const Real& dg) const {
    return add_shear(rows, Real(transverse_shear * dg));
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_uniaxial(const Rows& rows, const Real& d) const {
    return add_shear(rows, d);
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_shear(const Rows& rows, const Real& d) const {
    return add_shear(rows, d);
  }
};

[[nodiscard]] inline IsotropicLaw isotropic_law(double young_modulus, double poisson_ratio) {
  IsotropicLaw law;
  law.direct = young_modulus / (1 - poisson_ratio * poisson_ratio);
  law.coupled = poisson_ratio * law.direct;
  law.shear = young_modulus / (2 * (1 + poisson_ratio));
  law.transverse_shear = shear_correction * law.shear;
  law.poisson = poisson_ratio;
  law.thinning = poisson_ratio / (1 - poisson_ratio);
  return law;
}

/// Isotropic law at once: of an elastic material its own, of a viscoelastic one its instantaneous moduli.
[[nodiscard]] inline IsotropicLaw instantaneous_law(const ShellMaterial& material) {
  return isotropic_law(material.young_modulus, material.poisson_ratio);
}

}  // namespace tuft::fe
