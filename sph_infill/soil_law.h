#pragma once
/// Soil and foam (Krieg 1972; LS-DYNA MAT_005, Radioss LAW10) with a stress-dependent unloading modulus: pure
/// functions of one material point. Pressure and volumetric strain are positive in compression here; the
/// Cauchy stress is sigma = -p 1 + s.
///
/// Pressure. On first loading p = P(e), e = ln(rho/rho0). Unloading and reloading follow dp = K(p) de,
/// integrated in closed form: with u(p) = int_0^p dp'/K(p') the elastic strain is u(p) and p = U(e - e_p), U
/// = u^-1. The plastic compression e_p = e - u(P(e)) grows on first loading only, and dissipates, if K(p) >=
/// dP/de at every pressure. Where the given unloading curve lies lower, the slope of the first loading is
/// used in its place: a cycle could give energy back otherwise.
///
/// Shear. Deviator: objective elastic trial 2 G dev(D) dt with G = shear_ratio K(p), then radial return to
/// J2 = s:s/2 <= a0 + a1 p + a2 p^2. No dilation.
///
/// Tension. p >= -p_c; where that bites, the deviator is zero. The gap is remembered: e_p stays, so that
/// pressure comes back only when the density has; up to a halved density (largest_gap, soil_update.h). Below
/// p = 0 K stays at K(0).
#include "core/scene.h"
#include "sph_infill/curve_table.h"
#include "sph_infill/tensor.h"

namespace tuft::sph {

struct SoilLaw {
  CurveTable virgin;   ///< e -> p on first loading, Pa; continued beyond its last point, see make_soil_law
  CurveTable elastic;  ///< e - e_p -> p, Pa; derivative: bulk modulus K, Pa
  double density = 0;  ///< kg/m^3 at e = 0
  double shear_ratio = 0;  ///< G/K
  double yield_a0 = 0, yield_a1 = 0, yield_a2 = 0;
  double yield_vertex =
      0;  ///< Pa: below this pressure the limit is taken here, so that it never rises in tension
  double tension_cutoff = 0;  ///< Pa; infinite: none
};

/// State of one material point. The first four are what a checkpoint needs besides the deviator.
/// Real: double for one point, Pack for as many as there are lanes.
template <class Real>
struct SoilStateOf {
  Real compression = 0;              ///< e = ln(rho/rho0)
  Real largest_compression = 0;      ///< largest e so far on first loading, >= 0
  Real plastic_compression = 0;      ///< e_p
  Real pressure = 0;                 ///< Pa
  Real bulk_modulus = 0;             ///< K at that pressure, Pa
  SymmetricTensorOf<Real> deviator;  ///< s, Pa
};
using SoilState = SoilStateOf<double>;

/// Motion over one step at its middle configuration: strain D dt and the axial vector of the spin W dt
/// (w = curl(v)/2 dt).
template <class Real>
struct StrainStepOf {
  SymmetricTensorOf<Real> strain;
  std::array<Real, 3> rotation{};
};
using StrainStep = StrainStepOf<double>;

/// Work of one step per volume (of the middle of the step), J/m^3.
template <class Real>
struct SoilWorkOf {
  Real total = 0;       ///< sigma : D dt
  Real dissipated = 0;  ///< of which plastic, >= 0
};
using SoilWork = SoilWorkOf<double>;

/// Prepares a law. Beyond its last point the virgin curve goes on as an exponential: slope K_n + b (P - P_n),
/// where b is the growth of slope with pressure over the last two segments (0 if they do not stiffen) and K_n
/// >= the last segment's slope. The unloading curve goes on straight, never falling. Throws InputError naming
/// the curve, the point and its value for curves that are empty, not rising, or not positive.
[[nodiscard]] SoilLaw make_soil_law(const SoilFoamMaterial& material, bool tension_cutoff = true);

/// Stress-free at the reference density.
[[nodiscard]] SoilState reference_state(const SoilLaw& law);

/// Advances a point by one step. For many at once: soil_update.h.
SoilWork update_soil(const SoilLaw& law, const StrainStep& step, SoilState& state);

/// s turned by the rotation of axial vector w over one step: s' = Q s Q^T, Q = (1 - W/2)^-1 (1 + W/2) (Hughes
/// & Winget 1980). Q is a rotation for any w; with w from the middle configuration it is the exact one.
[[nodiscard]] SymmetricTensor rotate(const SymmetricTensor& s, const std::array<double, 3>& w);

/// Strain and rotation of a step of length dt that ended in the configuration in which L was measured:
/// L_mid = L (1 - L dt/2)^-1, since x_mid = x_end - v dt/2.
[[nodiscard]] StrainStep strain_step(const Mat3& velocity_gradient, double dt);

}  // namespace tuft::sph
