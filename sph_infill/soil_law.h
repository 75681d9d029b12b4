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
///
/// Effects (docs/theory/sph.md says why none of them lets a cycle gain energy), E the largest compression so
/// far:
/// - density_hardening: K is m K(p) with m = exp(n E), so p = U(m (e - e_p)) and e_p = e - u(P(e))/m on first
///   loading; k = sqrt(a0) and alpha = sqrt(a2) grow as exp(n_k E) and exp(n_a E).
/// - strength_softening: k and alpha times 1 - (1 - residual) lambda, where d(lambda) = (1 - lambda)
///   d(gamma)/strain with the plastic shear strain gamma; opening of a gap counts as gamma.
/// - strength_recovery: d(lambda) = -lambda (dt/time + de/compression), de > 0.
/// - strength_rate: sqrt(J2) at yield times 1 + C ln(1 + rate/reference), rate = sqrt(2 dev D : dev D).
/// - inertial_friction: sqrt(J2) at yield times 1 + r I/(I + I0), I = gamma' d sqrt(rho_s/p) the inertial
///   number of the plastic shear rate gamma' (Jop, Forterre & Pouliquen 2006: mu(I), r = mu_2/mu_s - 1),
///   solved for within the step.
/// - dilation: d(e_p) = -tan(psi) d(gamma), as long as p < P(e): a point on the curve of first loading is as
///   loose as it can be. First loading then begins where p meets P(e), not where e exceeds E.
/// - shear_energy: s is scaled so that V J2/(2 G), the energy of elastic shear, stays as G and the volume V
///   change under it.
#include "core/scene.h"
#include "sph_infill/curve_table.h"
#include "sph_infill/soil_effects.h"
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

  // Of the effects. These values change nothing: they stay where a law lacks what others of the run have.
  SoilEffects effects;  ///< those of the run
  double modulus_exponent = 0, cohesion_exponent = 0, friction_exponent = 0;
  double softening = 0;                         ///< 1 / strain
  double lost_cohesion = 0, lost_friction = 0;  ///< shares that can be lost
  double recovery_rate = 0;                     ///< 1/s
  double recovery_by_compression = 0;           ///< 1 / compression
  double rate_coefficient = 0;
  double rate_period = 0;        ///< s, 1 / reference rate
  double friction_increase = 0;  ///< r
  double inertial_rate = 0;  ///< 1/(s sqrt(Pa)): I0/(d sqrt(rho_s)); times sqrt(p), the rate where I is I0
  double dilatancy = 0;      ///< tan(psi)
};

/// State of one material point.
/// Real: double for one point, Pack for as many as there are lanes.
template <class Real>
struct SoilStateOf {
  Real compression = 0;              ///< e = ln(rho/rho0)
  Real largest_compression = 0;      ///< largest e so far on first loading, >= 0
  Real plastic_compression = 0;      ///< e_p
  Real pressure = 0;                 ///< Pa
  Real bulk_modulus = 0;             ///< K at that pressure, Pa
  SymmetricTensorOf<Real> deviator;  ///< s, Pa
  Real lost_strength = 0;            ///< lambda, [0, 1]; of strength_softening
};
using SoilState = SoilStateOf<double>;

/// Motion over one step at its middle configuration: strain D dt and the axial vector of the spin W dt
/// (w = curl(v)/2 dt).
template <class Real>
struct StrainStepOf {
  SymmetricTensorOf<Real> strain;
  std::array<Real, 3> rotation{};
  double duration = 0;  ///< dt, s; what depends on rates takes 0 as infinitely slow
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
/// the curve, the point and its value for curves that are empty, not rising, or not positive; naming the
/// parameter for one out of range, or given in two forms.
[[nodiscard]] SoilLaw make_soil_law(const SoilFoamMaterial& material, bool tension_cutoff = true,
                                    const SoilEffects& effects = {});

/// a0, a1, a2 of a cone: k^2, 2 k alpha, alpha^2 (ConeMatch says what k and alpha are).
[[nodiscard]] std::array<double, 3> yield_of(const MohrCoulombStrength& strength);

/// Stress-free at the reference density.
[[nodiscard]] SoilState reference_state(const SoilLaw& law);

/// Stress-free at rho0 exp(residual), as left by a compression beyond it and its release: what a pressed bed
/// is. residual >= 0. Throws InputError when no compression of up to ln 5 leaves so much (a law that unloads
/// as it loads leaves none).
[[nodiscard]] SoilState compacted_state(const SoilLaw& law, double residual);

/// Whether a conditioned bed of this law goes on in that state, rather than in its initial one.
[[nodiscard]] bool is_left_compacted(const SoilLaw& law, ConditionedState state);

/// Largest J2 that a state would bear at a pressure, Pa^2, under a shear strain rate sqrt(2 dev D : dev D),
/// 1/s, all of it plastic.
[[nodiscard]] double yield_limit(const SoilLaw& law, const SoilState& state, double pressure,
                                 double shear_rate = 0);

/// Energy that a point can give back, J/m^3 of the present volume: int_0^p u'(p') p' dp'/m + J2/(2 G).
/// Volumes are taken as constant in the first term (its error is a share of the elastic strain).
[[nodiscard]] double stored_energy(const SoilLaw& law, const SoilState& state);

/// Advances a point by one step, with the effects of its law. For many at once: soil_update.h.
SoilWork update_soil(const SoilLaw& law, const StrainStep& step, SoilState& state);

/// s turned by the rotation of axial vector w over one step: s' = Q s Q^T, Q = (1 - W/2)^-1 (1 + W/2) (Hughes
/// & Winget 1980). Q is a rotation for any w; with w from the middle configuration it is the exact one.
[[nodiscard]] SymmetricTensor rotate(const SymmetricTensor& s, const std::array<double, 3>& w);

/// Strain and rotation of a step of length dt that ended in the configuration in which L was measured:
/// L_mid = L (1 - L dt/2)^-1, since x_mid = x_end - v dt/2.
[[nodiscard]] StrainStep strain_step(const Mat3& velocity_gradient, double dt);

}  // namespace tuft::sph
