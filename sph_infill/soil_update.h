#pragma once
/// One step of the soil law (soil_law.h), as templates over the number type: double for one point, Pack for
/// as many points as there are lanes, each with its own law. No branch depends on a single lane's state.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/lane_math.h"
#include "sph_infill/law_of_lanes.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

/// Largest J2 at pressure p, Pa^2, >= 0.
template <class Real, class Law>
[[nodiscard]] Real yield_limit_of(const Law& law, const Real& p) {
  const Real vertex = law.value(&SoilLaw::yield_vertex), q = select(p < vertex, vertex, p);
  const Real limit =
      law.value(&SoilLaw::yield_a0) + q * (law.value(&SoilLaw::yield_a1) + q * law.value(&SoilLaw::yield_a2));
  return select(limit < Real(0), Real(0), limit);
}

/// What multiplies cohesion sqrt(a0), slope sqrt(a2), and then both.
template <class Real>
struct StrengthFactorsOf {
  Real cohesion, slope, both;
};

/// The yield surface under factors: J2 <= c0 + c1 p + c2 p^2 at pressures above the vertex.
template <class Real>
struct YieldSurfaceOf {
  Real c0, c1, c2, vertex;

  /// Largest J2 at pressure p, Pa^2, >= 0.
  [[nodiscard]] Real limit(const Real& p) const {
    const Real q = select(p < vertex, vertex, p), value = c0 + q * (c1 + q * c2);
    return select(value < Real(0), Real(0), value);
  }
};

template <class Real, class Law>
[[nodiscard]] YieldSurfaceOf<Real> yield_surface_of(const Law& law, const StrengthFactorsOf<Real>& f) {
  const Real c = f.both * f.cohesion, s = f.both * f.slope;
  return {c * c * law.value(&SoilLaw::yield_a0), c * s * law.value(&SoilLaw::yield_a1),
          s * s * law.value(&SoilLaw::yield_a2), law.value(&SoilLaw::yield_vertex) * f.cohesion / f.slope};
}

/// rotate() of soil_law.h.
template <class Real>
[[nodiscard]] SymmetricTensorOf<Real> rotated(const SymmetricTensorOf<Real>& s,
                                              const std::array<Real, 3>& w) {
  // Q = 1 + (W + W^2/2) / (1 + |w|^2/4), the Cayley transform of a skew matrix in closed form.
  const Real f = Real(1) / (Real(1) + Real(0.25) * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2])),
             half = Real(0.5) * f;
  const TensorOf<Real> q{Real(1) - half * (w[1] * w[1] + w[2] * w[2]),
                         half * w[0] * w[1] - f * w[2],
                         half * w[0] * w[2] + f * w[1],  //
                         half * w[0] * w[1] + f * w[2],
                         Real(1) - half * (w[0] * w[0] + w[2] * w[2]),
                         half * w[1] * w[2] - f * w[0],  //
                         half * w[0] * w[2] - f * w[1],
                         half * w[1] * w[2] + f * w[0],
                         Real(1) - half * (w[0] * w[0] + w[1] * w[1])};
  const TensorOf<Real> t = dot(q, s);  // Q s; then the rows of it with those of Q
  return {t.xx * q.xx + t.xy * q.xy + t.xz * q.xz, t.yx * q.yx + t.yy * q.yy + t.yz * q.yz,
          t.zx * q.zx + t.zy * q.zy + t.zz * q.zz, t.xx * q.yx + t.xy * q.yy + t.xz * q.yz,
          t.yx * q.zx + t.yy * q.zy + t.yz * q.zz, t.zx * q.xx + t.zy * q.xy + t.zz * q.xz};
}

/// strain_step() of soil_law.h: L (1 - L dt/2)^-1 dt, the inverse by cofactors.
template <class Real>
[[nodiscard]] StrainStepOf<Real> strain_step_of(const TensorOf<Real>& velocity_gradient, double dt) {
  const Real t = dt, h = -0.5 * dt;
  const TensorOf<Real>& v = velocity_gradient;
  const TensorOf<Real> a{Real(1) + h * v.xx, h * v.xy, h * v.xz, h * v.yx,          Real(1) + h * v.yy,
                         h * v.yz,           h * v.zx, h * v.zy, Real(1) + h * v.zz};
  const TensorOf<Real> c{a.yy * a.zz - a.yz * a.zy, a.xz * a.zy - a.xy * a.zz, a.xy * a.yz - a.xz * a.yy,
                         a.yz * a.zx - a.yx * a.zz, a.xx * a.zz - a.xz * a.zx, a.xz * a.yx - a.xx * a.yz,
                         a.yx * a.zy - a.yy * a.zx, a.xy * a.zx - a.xx * a.zy, a.xx * a.yy - a.xy * a.yx};
  const Real f = t / (a.xx * c.xx + a.xy * c.yx + a.xz * c.zx), half = Real(0.5);
  const TensorOf<Real> l{
      f * (v.xx * c.xx + v.xy * c.yx + v.xz * c.zx), f * (v.xx * c.xy + v.xy * c.yy + v.xz * c.zy),
      f * (v.xx * c.xz + v.xy * c.yz + v.xz * c.zz), f * (v.yx * c.xx + v.yy * c.yx + v.yz * c.zx),
      f * (v.yx * c.xy + v.yy * c.yy + v.yz * c.zy), f * (v.yx * c.xz + v.yy * c.yz + v.yz * c.zz),
      f * (v.zx * c.xx + v.zy * c.yx + v.zz * c.zx), f * (v.zx * c.xy + v.zy * c.yy + v.zz * c.zy),
      f * (v.zx * c.xz + v.zy * c.yz + v.zz * c.zz)};
  return {symmetric_part(l), {half * (l.zy - l.yz), half * (l.xz - l.zx), half * (l.yx - l.xy)}, dt};
}

/// Factor on the elastic moduli.
template <SoilEffects on, class Real, class Law>
[[nodiscard]] Real hardness_of(const Law& law, const Real& largest_compression) {
  if constexpr (on.density_hardening)
    return exp(law.value(&SoilLaw::modulus_exponent) * largest_compression);
  else
    return Real(1);
}

/// x times y, where y is 1 and left out unless the effect is on.
template <bool on, class Real>
[[nodiscard]] Real times_if(const Real& x, const Real& y) {
  if constexpr (on)
    return x * y;
  else
    return x;
}

/// Pressure of first loading at compression e, but no tension: where dilation and first loading meet.
template <class Real, class Law>
[[nodiscard]] Real loosest_pressure(const Law& law, const Real& e) {
  const Real p = law.virgin_piece(e).value(e);
  return select(e > Real(0) && p > Real(0), p, Real(0));
}

/// A torn point remembers its gap until its density has halved. Spray and the thin edge of a heap go on
/// expanding for as long as their particles part: remembered without end, the gap would let them pile up at a
/// fraction of their volume each when they come down, and volumes that large would spoil their neighbours'
/// sums.
inline constexpr double largest_gap = 0.6931471805599453;

template <class Real, class Mask>
struct PressureStep {
  Real dissipated;  ///< plastic work per volume, J/m^3
  Mask torn;        ///< the tension cutoff bites
};

/// Moves compression, pressure, modulus and the plastic compression on by one strain (positive in
/// compression).
template <SoilEffects on = SoilEffects{}, class Real, class Law>
auto update_pressure(const Law& law, const Real& strain, SoilStateOf<Real>& state) {
  constexpr bool hard = on.density_hardening;
  const Real before = state.compression, pressure_before = state.pressure,
             reached = state.largest_compression;
  state.compression = before + strain;

  const Real hardness = hardness_of<on>(law, reached);
  const Real elastic_part = times_if<hard>(state.compression - state.plastic_compression, hardness);
  const CurvePieceOf<Real> elastic = law.elastic_piece(elastic_part);
  const Real unbounded = elastic.value(elastic_part), lowest = -law.value(&SoilLaw::tension_cutoff);
  const auto first = [&] {
    if constexpr (on.dilation)
      return state.compression > reached || unbounded > loosest_pressure(law, state.compression);
    else
      return state.compression > reached;
  }();
  const auto torn = !first && unbounded < lowest;
  // A gap wider than that is not a gap between neighbours any more.
  const Real widest = state.plastic_compression - Real(largest_gap);
  state.compression = select(torn && state.compression < widest, widest, state.compression);
  state.pressure = select(torn, lowest, unbounded);
  state.bulk_modulus = times_if<hard>(elastic.derivative_at_value(unbounded), hardness);

  Real dissipated = 0;
  if (any(first)) {
    const auto rises = first && state.compression > reached;
    const Real largest = select(rises, state.compression, reached);
    const Real hardness_now = hardness_of<on>(law, largest);
    Real pressure, yield_from;
    if constexpr (on.dilation) {
      pressure = loosest_pressure(law, state.compression);
      yield_from = select(pressure_before < Real(0), Real(0), pressure_before);
    } else {
      pressure = law.virgin_piece(state.compression).value(state.compression);
      yield_from = select(before < reached, law.virgin_piece(reached).value(reached), pressure_before);
    }
    const CurvePieceOf<Real> piece = law.elastic_piece_of_value(pressure);
    const Real elastic_now = piece.argument(pressure);
    // Grows by dP (1/P' - 1/K) >= 0; the maximum removes rounding.
    Real now = state.compression;
    if constexpr (hard)
      now -= elastic_now / hardness_now;
    else
      now -= elastic_now;
    const Real old = state.plastic_compression;
    const Real plastic = select(first && now > old, now, old);
    dissipated = Real(0.5) * (yield_from + pressure) * (plastic - old);  // 0 where nothing is new
    if constexpr (hard) {
      // At constant pressure the complementary energy u p - int U du goes as 1/m: the part of p de_p that m
      // has made of it is not lost. At the step's mean pressure.
      const Real middle = Real(0.5) * (yield_from + pressure);
      const CurvePieceOf<Real> of_middle = law.elastic_piece_of_value(middle);
      const Real strain_there = of_middle.argument(middle);
      const Real complementary = strain_there * middle - of_middle.area(strain_there);
      const Real net = dissipated - complementary * (Real(1) / hardness - Real(1) / hardness_now);
      dissipated = select(first && net > Real(0), net, Real(0));
    }
    state.plastic_compression = plastic;
    state.pressure = select(first, pressure, state.pressure);
    state.bulk_modulus =
        select(first, times_if<hard>(piece.derivative_at_value(pressure), hardness_now), state.bulk_modulus);
    state.largest_compression = largest;
  }
  return PressureStep<Real, std::decay_t<decltype(torn)>>{dissipated, torn};
}

/// Strength at the state reached, under the losses before this step.
template <SoilEffects on, class Real, class Law>
[[nodiscard]] StrengthFactorsOf<Real> strength_factors(const Law& law, const StrainStepOf<Real>& step,
                                                       const SymmetricTensorOf<Real>& strain_deviator,
                                                       const SoilStateOf<Real>& state) {
  using std::sqrt;
  StrengthFactorsOf<Real> f{Real(1), Real(1), Real(1)};
  if constexpr (on.density_hardening) {
    f.cohesion = exp(law.value(&SoilLaw::cohesion_exponent) * state.largest_compression);
    f.slope = exp(law.value(&SoilLaw::friction_exponent) * state.largest_compression);
  }
  if constexpr (on.strength_softening) {
    f.cohesion *= Real(1) - law.value(&SoilLaw::lost_cohesion) * state.lost_strength;
    f.slope *= Real(1) - law.value(&SoilLaw::lost_friction) * state.lost_strength;
  }
  if constexpr (on.strength_rate) {
    const Real per_time = step.duration > 0 ? 1 / step.duration : 0;
    const Real rate = sqrt(Real(2) * double_dot(strain_deviator, strain_deviator)) * per_time;
    f.both = Real(1) + law.value(&SoilLaw::rate_coefficient) * log1p(law.value(&SoilLaw::rate_period) * rate);
  }
  return f;
}

/// Factor on sqrt(J2) at yield by the inertial number (soil_law.h). The plastic shear x of the step solves
///
///     trial - G x = Y (1 + r x/(x + x0)), x0 = dt inertial_rate sqrt(p),
///
/// Y the strength without the factor: a quadratic with one root x >= 0, of which x/(x + x0) is wanted;
/// written so that no x0 is divided by. So steps of any length are stable, and shear at a constant rate ends
/// at mu(I) exactly. At p <= 0 any flow is fast.
template <class Real, class Law>
[[nodiscard]] Real inertial_factor(const Law& law, const Real& trial_root, const Real& strength,
                                   const Real& shear_modulus, const Real& pressure, double duration) {
  using std::sqrt;
  const Real zero = 0, one = 1, two = 2;
  if (duration == 0) return one;  // infinitely slow
  const Real increase = law.value(&SoilLaw::friction_increase);
  const Real reference =
      Real(duration) * law.value(&SoilLaw::inertial_rate) * sqrt(select(pressure > zero, pressure, zero));
  const Real excess = select(trial_root > strength, trial_root - strength, zero);
  const Real b = shear_modulus * reference + strength * increase - excess;
  const Real root = sqrt(b * b + Real(4) * shear_modulus * excess * reference);
  const Real sum = two * excess + b + root;  // b >= -excess
  return one + increase * (two * excess / select(sum > zero, sum, one));
}

/// Opens a yielding point at fixed density: pressure rises along the unloading curve, up to that of first
/// loading. Returns the energy that expanding against the pressure takes, J/m^3.
///
/// The plastic shear x of the step solves sqrt(J2) - G x = Y(p(x)), Y the yield surface at the pressure after
/// it. Newton's step from x = 0 overshoots where Y(p(x)) is convex, as for cones and hyperbolas; the chord to
/// where it ended, taken then, does not, so that expansion stays below tan(psi) times the shear returned.
template <SoilEffects on, class Real, class Law, class Mask>
[[nodiscard]] Real dilate(const Law& law, const YieldSurfaceOf<Real>& surface, const Real& trial_root,
                          const Real& shear_modulus, const Mask& yields, SoilStateOf<Real>& state) {
  using std::sqrt;
  constexpr bool hard = on.density_hardening;
  const Real zero = 0, bound = loosest_pressure(law, state.compression), p = state.pressure;
  const Real dilatancy = law.value(&SoilLaw::dilatancy);
  const auto opens = yields && p < bound && dilatancy > zero;
  if (!any(opens)) return zero;
  const Real hardness = hardness_of<on>(law, state.largest_compression);
  const auto pressure_after = [&](const Real& shear) {
    const Real strain =
        times_if<hard>(state.compression - state.plastic_compression + dilatancy * shear, hardness);
    const Real reached = law.elastic_piece(strain).value(strain);
    return select(reached > bound, bound, reached);
  };
  const Real root = sqrt(surface.limit(p)), excess = select(opens, trial_root - root, zero);
  const Real slope = (surface.c1 + Real(2) * p * surface.c2) / select(root > zero, Real(2) * root, Real(1));
  const Real newton =
      excess / (shear_modulus + select(slope > zero, slope, zero) * dilatancy * state.bulk_modulus);
  const Real chord =
      (sqrt(surface.limit(pressure_after(newton))) - root) / select(newton > zero, newton, Real(1));
  const Real shear = excess / (shear_modulus + select(chord > zero, chord, zero));
  const Real after = select(opens, pressure_after(shear), p);
  const CurvePieceOf<Real> piece = law.elastic_piece_of_value(after);
  Real plastic = state.compression;
  if constexpr (hard)
    plastic -= piece.argument(after) / hardness;
  else
    plastic -= piece.argument(after);
  const auto opened = opens && plastic < state.plastic_compression;
  const Real work = select(opened, Real(0.5) * (p + after) * (state.plastic_compression - plastic), zero);
  state.plastic_compression = select(opened, plastic, state.plastic_compression);
  state.pressure = select(opened, after, p);
  state.bulk_modulus =
      select(opened, times_if<hard>(piece.derivative_at_value(after), hardness), state.bulk_modulus);
  return work;
}

/// Strength that a step takes away and gives back.
template <SoilEffects on, class Real, class Law, class Mask>
void update_lost_strength(const Law& law, const Real& plastic_shear, const Real& strain, const Mask& torn,
                          double duration, SoilStateOf<Real>& state) {
  const Real zero = 0;
  const Real opening = select(torn && strain < zero, -strain, zero);
  const Real kept = exp(-law.value(&SoilLaw::softening) * (plastic_shear + opening));
  Real lost = Real(1) - (Real(1) - state.lost_strength) * kept;
  if constexpr (on.strength_recovery)
    lost *= exp(-(law.value(&SoilLaw::recovery_rate) * Real(duration) +
                  law.value(&SoilLaw::recovery_by_compression) * select(strain > zero, strain, zero)));
  state.lost_strength = lost;
}

/// Advances points by one step; see soil_law.h for the law and its effects.
template <SoilEffects on = SoilEffects{}, class Real, class Law>
SoilWorkOf<Real> update_soil_state(const Law& law, const StrainStepOf<Real>& step, SoilStateOf<Real>& state) {
  using std::sqrt;
  constexpr bool plain_yield =
      !on.density_hardening && !on.strength_softening && !on.strength_rate && !on.inertial_friction;
  const Real zero = 0, half = 0.5;
  const Real strain = -trace(step.strain);
  const SymmetricTensorOf<Real> strain_deviator = deviator(step.strain);
  const SymmetricTensorOf<Real> deviator_before = state.deviator;
  const Real pressure_before = state.pressure, modulus_before = state.bulk_modulus;

  const auto pressure_step = update_pressure<on>(law, strain, state);

  // Half of the strain goes in before the turn and half after: second order in the step, and elastic work
  // over a step, (s + s') : D dt/2, is then the change of s : s/4G exactly.
  const Real shear_ratio = law.value(&SoilLaw::shear_ratio);
  const SymmetricTensorOf<Real> first_half = (shear_ratio * modulus_before) * strain_deviator,
                                second_half = (shear_ratio * state.bulk_modulus) * strain_deviator;
  SymmetricTensorOf<Real> half_way = rotated(deviator_before + first_half, step.rotation);
  if constexpr (on.shear_energy)  // V J2/G kept; exp(strain) is the ratio of volumes, to third order
    half_way =
        sqrt(state.bulk_modulus * (Real(2) + strain) / (modulus_before * (Real(2) - strain))) * half_way;
  const SymmetricTensorOf<Real> trial = half_way + second_half, carried = half_way - first_half;
  const Real twice_shear_modulus = shear_ratio * (modulus_before + state.bulk_modulus);
  const Real j2 = half * double_dot(trial, trial);
  Real limit, expansion_work = 0;
  if constexpr (plain_yield && !on.dilation) {
    limit = select(pressure_step.torn, zero, yield_limit_of(law, state.pressure));
  } else {
    StrengthFactorsOf<Real> factors = strength_factors<on>(law, step, strain_deviator, state);
    if constexpr (on.inertial_friction)
      factors.both *= inertial_factor(law, Real(sqrt(j2)),
                                      Real(sqrt(yield_surface_of(law, factors).limit(state.pressure))),
                                      Real(half * twice_shear_modulus), state.pressure, step.duration);
    const YieldSurfaceOf<Real> surface = yield_surface_of(law, factors);
    limit = select(pressure_step.torn, zero, surface.limit(state.pressure));
    if constexpr (on.dilation) {
      expansion_work = dilate<on>(law, surface, sqrt(j2), half * twice_shear_modulus,
                                  j2 > limit && !pressure_step.torn, state);
      limit = select(pressure_step.torn, zero, surface.limit(state.pressure));
    }
  }
  const auto yields = j2 > limit;
  const Real scale = select(yields, sqrt(limit / select(yields, j2, Real(1))), Real(1));
  state.deviator = scale * trial;
  // Plastic strain (s_trial - s)/2G under the mean stress of the step. It is negative only if the step
  // reverses a deviator that the limit then cuts; the end-point value, never negative, serves there.
  const SymmetricTensorOf<Real> excess = trial - state.deviator;
  const Real mean_work = half * double_dot(carried + state.deviator, excess);
  const Real taken = select(mean_work < zero, double_dot(state.deviator, excess), mean_work);
  SoilWorkOf<Real> work;
  work.dissipated = pressure_step.dissipated + select(yields, taken / twice_shear_modulus, zero);
  if constexpr (on.dilation) work.dissipated -= expansion_work;
  work.total = half * (pressure_before + state.pressure) * strain +
               half * double_dot(deviator_before + state.deviator, strain_deviator);
  if constexpr (on.strength_softening) {
    const Real plastic_shear = (Real(1) - scale) * sqrt(j2) / (half * twice_shear_modulus);
    update_lost_strength<on>(law, plastic_shear, strain, pressure_step.torn, step.duration, state);
  }
  return work;
}

}  // namespace tuft::sph
