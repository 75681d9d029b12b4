#pragma once
/// One step of the soil law (soil_law.h), as templates over the number type: double for one point, Pack for
/// as many points as there are lanes, each with its own law. No branch depends on a single lane's state.
#include <array>
#include <cmath>

#include "core/lane_math.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

/// What the update asks of a law, for one point.
class LawOfPoint {
 public:
  explicit LawOfPoint(const SoilLaw& law) : law_(law) {}
  [[nodiscard]] CurvePiece virgin_piece(double e) const { return law_.virgin.piece(e); }
  [[nodiscard]] CurvePiece elastic_piece(double strain) const { return law_.elastic.piece(strain); }
  [[nodiscard]] CurvePiece elastic_piece_of_value(double p) const { return law_.elastic.piece_of_value(p); }
  [[nodiscard]] double value(double SoilLaw::*parameter) const { return law_.*parameter; }

 private:
  const SoilLaw& law_;
};

/// The same for a law a lane.
class LawOfLanes {
 public:
  explicit LawOfLanes(const std::array<const SoilLaw*, lanes>& law) : law_(law) {}
  [[nodiscard]] CurvePieceOf<Pack> virgin_piece(const Pack& e) const {
    return gather_pieces([&](std::size_t l) -> const CurvePiece& { return law_[l]->virgin.piece(e[l]); });
  }
  [[nodiscard]] CurvePieceOf<Pack> elastic_piece(const Pack& strain) const {
    return gather_pieces(
        [&](std::size_t l) -> const CurvePiece& { return law_[l]->elastic.piece(strain[l]); });
  }
  [[nodiscard]] CurvePieceOf<Pack> elastic_piece_of_value(const Pack& p) const {
    return gather_pieces(
        [&](std::size_t l) -> const CurvePiece& { return law_[l]->elastic.piece_of_value(p[l]); });
  }
  [[nodiscard]] Pack value(double SoilLaw::*parameter) const {
    return Pack([&](auto lane) { return law_[lane]->*parameter; });
  }

 private:
  template <class PieceOfLane>
  static CurvePieceOf<Pack> gather_pieces(PieceOfLane&& piece_of_lane) {
    std::array<const CurvePiece*, lanes> piece;
    for (std::size_t l = 0; l < lanes; ++l) piece[l] = &piece_of_lane(l);
    return {Pack([&](auto l) { return piece[l]->x0; }), Pack([&](auto l) { return piece[l]->y0; }),
            Pack([&](auto l) { return piece[l]->slope; }), Pack([&](auto l) { return piece[l]->rate; })};
  }

  const std::array<const SoilLaw*, lanes>& law_;
};

/// Largest J2 at pressure p, Pa^2, >= 0.
template <class Real, class Law>
[[nodiscard]] Real yield_limit_of(const Law& law, const Real& p) {
  const Real vertex = law.value(&SoilLaw::yield_vertex), q = select(p < vertex, vertex, p);
  const Real limit =
      law.value(&SoilLaw::yield_a0) + q * (law.value(&SoilLaw::yield_a1) + q * law.value(&SoilLaw::yield_a2));
  return select(limit < Real(0), Real(0), limit);
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
  return {symmetric_part(l), {half * (l.zy - l.yz), half * (l.xz - l.zx), half * (l.yx - l.xy)}};
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
template <class Real, class Law>
auto update_pressure(const Law& law, const Real& strain, SoilStateOf<Real>& state) {
  const Real before = state.compression, pressure_before = state.pressure,
             reached = state.largest_compression;
  state.compression = before + strain;
  const auto first = state.compression > reached;

  const Real elastic_part = state.compression - state.plastic_compression;
  const CurvePieceOf<Real> elastic = law.elastic_piece(elastic_part);
  const Real unbounded = elastic.value(elastic_part), lowest = -law.value(&SoilLaw::tension_cutoff);
  const auto torn = !first && unbounded < lowest;
  // A gap wider than that is not a gap between neighbours any more.
  const Real widest = state.plastic_compression - Real(largest_gap);
  state.compression = select(torn && state.compression < widest, widest, state.compression);
  state.pressure = select(torn, lowest, unbounded);
  state.bulk_modulus = elastic.derivative_at_value(unbounded);

  Real dissipated = 0;
  if (any(first)) {
    const Real pressure = law.virgin_piece(state.compression).value(state.compression);
    const Real yield_from =
        select(before < reached, law.virgin_piece(reached).value(reached), pressure_before);
    const CurvePieceOf<Real> piece = law.elastic_piece_of_value(pressure);
    // Grows by dP (1/P' - 1/K) >= 0; the maximum removes rounding.
    const Real now = state.compression - piece.argument(pressure), old = state.plastic_compression;
    const Real plastic = select(first && now > old, now, old);
    dissipated = Real(0.5) * (yield_from + pressure) * (plastic - old);  // 0 where nothing is new
    state.plastic_compression = plastic;
    state.pressure = select(first, pressure, state.pressure);
    state.bulk_modulus = select(first, piece.derivative_at_value(pressure), state.bulk_modulus);
    state.largest_compression = select(first, state.compression, reached);
  }
  return PressureStep<Real, std::decay_t<decltype(torn)>>{dissipated, torn};
}

/// Advances points by one step; see soil_law.h for the law.
template <class Real, class Law>
SoilWorkOf<Real> update_soil_state(const Law& law, const StrainStepOf<Real>& step, SoilStateOf<Real>& state) {
  using std::sqrt;
  const Real zero = 0, half = 0.5;
  const Real strain = -trace(step.strain);
  const SymmetricTensorOf<Real> strain_deviator = deviator(step.strain);
  const SymmetricTensorOf<Real> deviator_before = state.deviator;
  const Real pressure_before = state.pressure, modulus_before = state.bulk_modulus;

  const auto pressure_step = update_pressure(law, strain, state);

  // Half of the strain goes in before the turn and half after: second order in the step, and elastic work
  // over a step, (s + s') : D dt/2, is then the change of s : s/4G exactly.
  const Real shear_ratio = law.value(&SoilLaw::shear_ratio);
  const SymmetricTensorOf<Real> first_half = (shear_ratio * modulus_before) * strain_deviator,
                                second_half = (shear_ratio * state.bulk_modulus) * strain_deviator;
  const SymmetricTensorOf<Real> half_way = rotated(deviator_before + first_half, step.rotation);
  const SymmetricTensorOf<Real> trial = half_way + second_half, turned = half_way - first_half;
  const Real twice_shear_modulus = shear_ratio * (modulus_before + state.bulk_modulus);
  const Real j2 = half * double_dot(trial, trial);
  const Real limit = select(pressure_step.torn, zero, yield_limit_of(law, state.pressure));
  const auto yields = j2 > limit;
  state.deviator = select(yields, sqrt(limit / select(yields, j2, Real(1))), Real(1)) * trial;
  // Plastic strain (s_trial - s)/2G under the mean stress of the step. It is negative only if the step
  // reverses a deviator that the limit then cuts; the end-point value, never negative, serves there.
  const SymmetricTensorOf<Real> excess = trial - state.deviator;
  const Real mean_work = half * double_dot(turned + state.deviator, excess);
  const Real taken = select(mean_work < zero, double_dot(state.deviator, excess), mean_work);
  SoilWorkOf<Real> work;
  work.dissipated = pressure_step.dissipated + select(yields, taken / twice_shear_modulus, zero);
  work.total = half * (pressure_before + state.pressure) * strain +
               half * double_dot(deviator_before + state.deviator, strain_deviator);
  return work;
}

}  // namespace tuft::sph
