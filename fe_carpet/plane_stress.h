#pragma once
/// Elastic plane stress for shells and the stiffness of the hourglass modes, as pure functions.
#include <array>

#include "core/scene.h"
#include "fe_carpet/shell_kernel.h"

namespace tuft::fe {

/// Mindlin's shear correction for a homogeneous section.
inline constexpr double shear_correction = 5.0 / 6.0;

/// Elastic constants of a block of elements, Pa.
struct PlaneStressLaw {
  double direct = 0;                                                                ///< E / (1 - nu^2)
  double coupled = 0;                                                               ///< nu E / (1 - nu^2)
  double shear = 0;                                                                 ///< G = E / (2 (1 + nu))
  double transverse_shear = 0;                                                      ///< shear_correction x G
  double hourglass_membrane = 0, hourglass_deflection = 0, hourglass_rotation = 0;  ///< coefficient x modulus
};

[[nodiscard]] inline PlaneStressLaw plane_stress_law(const ShellMaterial& material,
                                                     double hourglass_coefficient) {
  const double nu = material.poisson_ratio;
  PlaneStressLaw law;
  law.direct = material.young_modulus / (1 - nu * nu);
  law.coupled = nu * law.direct;
  law.shear = material.young_modulus / (2 * (1 + nu));
  law.transverse_shear = shear_correction * law.shear;
  law.hourglass_membrane = hourglass_coefficient * material.young_modulus / 8;
  law.hourglass_deflection = hourglass_coefficient * law.transverse_shear / 12;
  law.hourglass_rotation = hourglass_coefficient * material.young_modulus / 192;
  return law;
}

template <class Real>
struct PlaneStress {
  Real xx, yy, xy;
};

/// Stress (Pa) of a strain (engineering shear).
template <class Real>
TUFT_HD inline PlaneStress<Real> elastic_stress(const PlaneStressLaw& law, const Real& exx, const Real& eyy,
                                                const Real& gxy) {
  return {law.direct * exx + law.coupled * eyy, law.coupled * exx + law.direct * eyy, law.shear * gxy};
}

/// Resultants (N/m, N, N/m) of a generalised strain, integrated exactly through the thickness t.
template <class Real>
TUFT_HD inline ShellResultants<Real> elastic_resultants(const PlaneStressLaw& law, const Real& t,
                                                        const ShellStrain<Real>& e) {
  const Real inertia = t * t * t * (1.0 / 12.0);
  const PlaneStress<Real> n = elastic_stress<Real>(law, e.exx, e.eyy, e.gxy);
  const PlaneStress<Real> m = elastic_stress<Real>(law, e.kxx, e.kyy, e.kxy);
  const Real shear = law.transverse_shear * t;
  return {t * n.xx,       t * n.yy,       t * n.xy,      inertia * m.xx,
          inertia * m.yy, inertia * m.xy, shear * e.gxz, shear * e.gyz};
}

/// Hourglass forces of hourglass displacements, stiffness form (Belytschko, Lin & Tsay 1984; B_aI B_aI is
/// `gradient_norm`):
/// membrane r E t A/8 B.B, deflection r kappa G t^3/12 B.B, rotation r E t^3 A/192 B.B.
template <class Real>
TUFT_HD inline ShellHourglass<Real> hourglass_resistance(const PlaneStressLaw& law, const Real& t,
                                                         const ShellGeometry<Real>& g,
                                                         const ShellHourglass<Real>& d) {
  const Real membrane = law.hourglass_membrane * t * g.area * g.gradient_norm;
  const Real deflection = law.hourglass_deflection * t * t * t * g.gradient_norm;
  const Real rotation = law.hourglass_rotation * t * t * t * g.area * g.gradient_norm;
  return {membrane * d.mx, membrane * d.my, deflection * d.w, rotation * d.tx, rotation * d.ty};
}

/// Gauss-Legendre points on [-1, 1] with weights that add up to 1.
template <int Points>
struct ThicknessRule {
  std::array<double, Points> height, weight;
};

template <int Points>
[[nodiscard]] constexpr ThicknessRule<Points> thickness_rule() {
  static_assert(Points >= 2 && Points <= 5);
  if constexpr (Points == 2) return {{-0.57735026918962576, 0.57735026918962576}, {0.5, 0.5}};
  if constexpr (Points == 3)
    return {{-0.77459666924148338, 0, 0.77459666924148338}, {5.0 / 18, 8.0 / 18, 5.0 / 18}};
  if constexpr (Points == 4) {
    constexpr double outer = 0.86113631159405258, inner = 0.33998104358485626;
    constexpr double outer_weight = 0.17392742256872692, inner_weight = 0.32607257743127308;
    return {{-outer, -inner, inner, outer}, {outer_weight, inner_weight, inner_weight, outer_weight}};
  }
  if constexpr (Points == 5) {
    constexpr double outer = 0.90617984593866399, inner = 0.53846931010568309;
    constexpr double outer_weight = 0.11846344252809454, inner_weight = 0.23931433524968324;
    return {{-outer, -inner, 0, inner, outer},
            {outer_weight, inner_weight, 64.0 / 225, inner_weight, outer_weight}};
  }
}

}  // namespace tuft::fe
