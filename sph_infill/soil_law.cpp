#include "sph_infill/soil_law.h"

#include <limits>
#include <numbers>
#include <string_view>

#include "core/error.h"
#include "sph_infill/soil_update.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

void check_curve(const Curve& curve, std::string_view name, std::size_t least_points) {
  if (curve.x.size() != curve.y.size() || curve.x.size() < least_points)
    throw_input_error(
        "{} curve has {} abscissae and {} values; give at least {} of each, as many of one as of the other",
        name, curve.x.size(), curve.y.size(), least_points);
  for (std::size_t k = 0; k < curve.x.size(); ++k) {
    if (!std::isfinite(curve.x[k]) || !std::isfinite(curve.y[k]))
      throw_input_error("{} curve, point {}: ({}, {}) is not finite", name, k + 1, curve.x[k], curve.y[k]);
    if (k > 0 && curve.x[k] <= curve.x[k - 1])
      throw_input_error("{} curve, point {}: abscissa {} does not rise above {}", name, k + 1, curve.x[k],
                        curve.x[k - 1]);
  }
}

void check_parameter(double value, std::string_view name, double least, bool may_equal) {
  if (!std::isfinite(value) || value < least || (!may_equal && value == least))
    throw_input_error("{} is {}; it must be finite and {} {}", name, value, may_equal ? "at least" : "above",
                      least);
}

void check_share(double value, std::string_view name, bool may_be_zero) {
  if (!(value <= 1 && (may_be_zero ? value >= 0 : value > 0)))
    throw_input_error("{} is {}; it must be {} 0 and at most 1", name, value,
                      may_be_zero ? "at least" : "above");
}

/// A modulus that is linear in pressure from `start` on.
struct LinearModulus {
  double start, value, rate;
  [[nodiscard]] double at(double p) const { return value + rate * (p - start); }
};

/// The virgin curve in pieces, its continuation included.
std::vector<CurvePiece> tabulated_pieces(const Curve& curve) {
  check_curve(curve, "pressure", 2);
  if (curve.x[0] != 0 || curve.y[0] != 0)
    throw_input_error("pressure curve starts at ({}, {}); start it at (0, 0), the reference density",
                      curve.x[0], curve.y[0]);
  std::vector<CurvePiece> pieces;
  for (std::size_t k = 0; k + 1 < curve.x.size(); ++k) {
    if (curve.y[k + 1] <= curve.y[k])
      throw_input_error("pressure curve, point {}: {} Pa does not rise above {} Pa", k + 2, curve.y[k + 1],
                        curve.y[k]);
    pieces.push_back(
        {curve.x[k], curve.y[k], (curve.y[k + 1] - curve.y[k]) / (curve.x[k + 1] - curve.x[k]), 0});
  }
  // For an exponential curve the slope of a chord is near the slope at the chord's mean pressure, so two
  // chords give the growth of slope with pressure, and its value at the last point.
  const std::size_t n = pieces.size();
  const double last_pressure = curve.y.back();
  double growth = 0;
  if (n >= 2) {
    const double mean_last = (curve.y[n] + curve.y[n - 1]) / 2,
                 mean_before = (curve.y[n - 1] + curve.y[n - 2]) / 2;
    growth = std::max(0.0, (pieces[n - 1].slope - pieces[n - 2].slope) / (mean_last - mean_before));
  }
  const double mean_last = (curve.y[n] + curve.y[n - 1]) / 2;
  pieces.push_back(
      {curve.x.back(), last_pressure, pieces.back().slope + growth * (last_pressure - mean_last), growth});
  return pieces;
}

std::vector<CurvePiece> virgin_pieces(const SoilFoamMaterial& material) {
  if (!material.pressure_exponential) return tabulated_pieces(material.pressure);
  const ExponentialCompression& law = *material.pressure_exponential;
  if (!material.pressure.x.empty())
    throw_input_error("first loading is given by a pressure curve and by pressure_exponential; give one");
  check_parameter(law.modulus, "pressure_exponential.modulus", 0, false);
  check_parameter(law.growth, "pressure_exponential.growth", 0, false);
  return {{0, 0, law.modulus, law.growth}};
}

/// The unloading modulus as given, for p >= start, up to the next of its points.
LinearModulus unloading_modulus(const Curve& curve, double start) {
  const std::size_t n = curve.x.size();
  if (start < curve.x[0]) return {start, curve.y[0], 0};
  std::size_t k = 0;
  while (k + 1 < n && curve.x[k + 1] <= start) ++k;
  double rate = 0;
  if (k + 1 < n)
    rate = (curve.y[k + 1] - curve.y[k]) / (curve.x[k + 1] - curve.x[k]);
  else if (n >= 2)
    rate = std::max(0.0, (curve.y[n - 1] - curve.y[n - 2]) / (curve.x[n - 1] - curve.x[n - 2]));
  return {start, curve.y[k] + rate * (start - curve.x[k]), rate};
}

LinearModulus virgin_modulus(const std::vector<CurvePiece>& virgin, double start) {
  std::size_t k = 0;
  while (k + 1 < virgin.size() && virgin[k + 1].y0 <= start) ++k;
  return {start, virgin[k].derivative_at_value(start), virgin[k].rate};
}

/// p = U(elastic strain): dp/de = max(unloading modulus, virgin slope), both piecewise linear in p.
std::vector<CurvePiece> elastic_pieces(const SoilFoamMaterial& material,
                                       const std::vector<CurvePiece>& virgin) {
  const Curve& unloading = material.unloading;
  const double ratio = material.unloading_ratio;
  if (ratio == 0) {
    check_curve(unloading, "unloading", 1);
  } else {
    if (!unloading.x.empty())
      throw_input_error("unloading is given by a curve and by unloading_ratio; give one");
    check_parameter(ratio, "unloading_ratio", 1, true);
  }
  for (std::size_t k = 0; k < unloading.y.size(); ++k)
    if (unloading.y[k] <= 0)
      throw_input_error("unloading curve, point {}: modulus {} Pa is not positive", k + 1, unloading.y[k]);

  std::vector<double> starts;
  for (const CurvePiece& piece : virgin) starts.push_back(piece.y0);
  for (const double p : unloading.x)
    if (p > 0) starts.push_back(p);
  std::sort(starts.begin(), starts.end());
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());

  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<CurvePiece> pieces;
  double strain = 0;
  const auto add = [&](double start, double end, const LinearModulus& a, const LinearModulus& b) {
    const double middle = end < infinity ? (start + end) / 2 : 2 * start + 1;
    const LinearModulus& modulus = a.at(middle) >= b.at(middle) ? a : b;
    // Where one line of the modulus goes on, so does the piece: fewer are found quicker.
    const auto goes_on = [&](const CurvePiece& last) {
      const double slope = modulus.at(start);
      return last.rate == modulus.rate && std::abs(last.derivative_at_value(start) - slope) <= 1e-13 * slope;
    };
    if (pieces.empty() || !goes_on(pieces.back()))
      pieces.push_back({strain, start, modulus.at(start), modulus.rate});
    if (end < infinity) strain = pieces.back().argument(end);
  };
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const double start = starts[k], end = k + 1 < starts.size() ? starts[k + 1] : infinity;
    const LinearModulus b = virgin_modulus(virgin, start),
                        a = ratio > 0 ? LinearModulus{start, ratio * b.value, ratio * b.rate}
                                      : unloading_modulus(unloading, start);
    const double crossing = a.rate == b.rate ? infinity : start + (b.value - a.value) / (a.rate - b.rate);
    if (crossing > start * (1 + 1e-12) && crossing < end) {
      add(start, crossing, a, b);
      add(crossing, end, a, b);
    } else {
      add(start, end, a, b);
    }
  }
  pieces.insert(pieces.begin(), CurvePiece{0, 0, pieces.front().slope, 0});  // tension: K(0)
  // The table wants rising starts: the tension piece begins below the first loading piece.
  pieces.front().x0 = -1;
  pieces.front().y0 = -pieces.front().slope;
  return pieces;
}

/// The parameters of the effects that are on; those of the others keep their neutral values.
void set_effects(const SoilFoamMaterial& material, const SoilEffects& on, SoilLaw& law) {
  law.effects = on;
  if (on.density_hardening && material.density_hardening) {
    const DensityHardening& given = *material.density_hardening;
    check_parameter(given.modulus_exponent, "density_hardening.modulus_exponent", 0, true);
    check_parameter(given.cohesion_exponent, "density_hardening.cohesion_exponent", 0, true);
    check_parameter(given.friction_exponent, "density_hardening.friction_exponent", 0, true);
    law.modulus_exponent = given.modulus_exponent;
    law.cohesion_exponent = given.cohesion_exponent;
    law.friction_exponent = given.friction_exponent;
  }
  if (on.strength_softening && material.strength_softening) {
    const StrengthSoftening& given = *material.strength_softening;
    check_parameter(given.strain, "strength_softening.strain", 0, false);
    check_share(given.residual_cohesion, "strength_softening.residual_cohesion", true);
    check_share(given.residual_friction, "strength_softening.residual_friction", false);
    law.softening = 1 / given.strain;
    law.lost_cohesion = 1 - given.residual_cohesion;
    law.lost_friction = 1 - given.residual_friction;
  }
  if (on.strength_recovery && material.strength_recovery) {
    const StrengthRecovery& given = *material.strength_recovery;
    check_parameter(given.time, "strength_recovery.time", 0, true);
    check_parameter(given.compression, "strength_recovery.compression", 0, true);
    law.recovery_rate = given.time > 0 ? 1 / given.time : 0;
    law.recovery_by_compression = given.compression > 0 ? 1 / given.compression : 0;
  }
  if (on.strength_rate && material.strength_rate) {
    check_parameter(material.strength_rate->coefficient, "strength_rate.coefficient", 0, false);
    check_parameter(material.strength_rate->reference, "strength_rate.reference", 0, false);
    law.rate_coefficient = material.strength_rate->coefficient;
    law.rate_period = 1 / material.strength_rate->reference;
  }
  if (on.inertial_friction && material.inertial_friction) {
    const InertialFriction& given = *material.inertial_friction;
    check_parameter(given.increase, "inertial_friction.increase", 0, false);
    check_parameter(given.inertial_number, "inertial_friction.inertial_number", 0, false);
    check_parameter(given.grain_diameter, "inertial_friction.grain_diameter", 0, false);
    check_parameter(given.grain_density, "inertial_friction.grain_density", 0, false);
    law.friction_increase = given.increase;
    law.inertial_rate = given.inertial_number / (given.grain_diameter * std::sqrt(given.grain_density));
  }
  if (on.dilation) {
    check_parameter(material.dilation_angle, "dilation_angle", 0, true);
    law.dilatancy = std::tan(material.dilation_angle);
    // Against more than friction, expansion under pressure would take out more than shear puts in.
    const double least_friction = std::sqrt(law.yield_a2) * (1 - law.lost_friction);
    if (!(law.dilatancy <= least_friction))
      throw_input_error(
          "dilation_angle is {:.4g} rad, its tangent {:.4g}; it must be at most the least slope of the yield "
          "surface, sqrt(a2) = {:.4g}{}",
          material.dilation_angle, law.dilatancy, least_friction,
          law.lost_friction > 0 ? " with strength_softening.residual_friction" : "");
  }
}

}  // namespace

std::array<double, 3> yield_of(const MohrCoulombStrength& strength) {
  check_parameter(strength.cohesion, "mohr_coulomb.cohesion", 0, true);
  if (!(strength.friction_angle >= 0 && strength.friction_angle < 0.5 * std::numbers::pi))
    throw_input_error("mohr_coulomb.friction_angle is {} rad; it must be at least 0 and below pi/2",
                      strength.friction_angle);
  const double sine = std::sin(strength.friction_angle), cosine = std::cos(strength.friction_angle),
               tangent = std::tan(strength.friction_angle);
  // sqrt(J2) = k + alpha p with alpha = slope tan(phi) and k = slope c.
  double slope = 1;
  if (strength.match == ConeMatch::plane_strain) slope = 3 / std::sqrt(9 + 12 * tangent * tangent);
  if (strength.match == ConeMatch::triaxial_compression)
    slope = 6 * cosine / (std::numbers::sqrt3 * (3 - sine));
  const double k = slope * strength.cohesion, alpha = slope * tangent;
  return {k * k, 2 * k * alpha, alpha * alpha};
}

SoilLaw make_soil_law(const SoilFoamMaterial& material, bool tension_cutoff, const SoilEffects& effects) {
  check_parameter(material.density, "density", 0, false);
  check_parameter(material.shear_ratio, "shear_ratio", 0, false);
  check_parameter(material.yield_a0, "yield_a0", 0, true);
  check_parameter(material.yield_a1, "yield_a1", 0, true);
  check_parameter(material.yield_a2, "yield_a2", 0, true);
  check_parameter(material.tension_cutoff, "tension_cutoff", 0, true);

  SoilLaw law;
  const auto virgin = virgin_pieces(material);
  law.virgin = CurveTable(virgin);
  law.elastic = CurveTable(elastic_pieces(material, virgin));
  law.density = material.density;
  law.shear_ratio = material.shear_ratio;
  law.yield_a0 = material.yield_a0;
  law.yield_a1 = material.yield_a1;
  law.yield_a2 = material.yield_a2;
  if (material.mohr_coulomb) {
    if (law.yield_a0 > 0 || law.yield_a1 > 0 || law.yield_a2 > 0)
      throw_input_error("strength is given by mohr_coulomb and by yield_a0, yield_a1, yield_a2; give one");
    const auto [a0, a1, a2] = yield_of(*material.mohr_coulomb);
    law.yield_a0 = a0, law.yield_a1 = a1, law.yield_a2 = a2;
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  law.yield_vertex = law.yield_a2 > 0 ? -law.yield_a1 / (2 * law.yield_a2) : -infinity;
  law.tension_cutoff = tension_cutoff ? material.tension_cutoff : infinity;
  set_effects(material, effects, law);
  return law;
}

SoilState reference_state(const SoilLaw& law) {
  SoilState state;
  state.bulk_modulus = law.elastic(0).derivative;
  return state;
}

SymmetricTensor rotate(const SymmetricTensor& s, const std::array<double, 3>& w) {
  return rotated(s, w);
}

StrainStep strain_step(const Mat3& l, double dt) {
  const TensorOf<double> gradient{l(0, 0), l(0, 1), l(0, 2), l(1, 0), l(1, 1),
                                  l(1, 2), l(2, 0), l(2, 1), l(2, 2)};
  return strain_step_of(gradient, dt);
}

SoilWork update_soil(const SoilLaw& law, const StrainStep& step, SoilState& state) {
  SoilWork work;
  with_soil_effects(law.effects, [&](auto effects) {
    work = update_soil_state<decltype(effects)::value>(LawOfPoint(law), step, state);
  });
  return work;
}

SoilState compacted_state(const SoilLaw& law, double residual) {
  if (!(residual >= 0) || !std::isfinite(residual))
    throw_input_error("residual compression is {}; it must be at least 0", residual);
  const auto left_by = [&law](double largest) {
    const double hardness = std::exp(law.modulus_exponent * largest);
    return largest - law.elastic.argument(law.virgin(largest).value) / hardness;
  };
  constexpr double densest = 5;  // over the reference density
  double low = residual, high = std::log(densest);
  if (residual > 0 && left_by(high) < residual)
    throw_input_error(
        "no compression up to {:.3g} leaves {:.4g} behind when it is released, only {:.4g}; raise the "
        "unloading "
        "modulus or density_hardening.modulus_exponent",
        high, residual, left_by(high));
  // What is left rises with the largest compression: bisect.
  for (int k = 0; residual > 0 && k < 200 && high - low > 1e-15 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (left_by(middle) < residual ? low : high) = middle;
  }
  SoilState state;
  state.largest_compression = residual > 0 ? high : 0;
  state.plastic_compression = state.compression = residual;
  state.bulk_modulus = std::exp(law.modulus_exponent * state.largest_compression) * law.elastic(0).derivative;
  return state;
}

bool is_left_compacted(const SoilLaw& law, ConditionedState state) {
  const bool hardens = law.modulus_exponent > 0 || law.cohesion_exponent > 0 || law.friction_exponent > 0;
  return state == ConditionedState::compacted || (state == ConditionedState::automatic && hardens);
}

double yield_limit(const SoilLaw& law, const SoilState& state, double pressure, double shear_rate) {
  // Those that are off have neutral parameters.
  constexpr SoilEffects all{true, true, true, true, true, true, true};
  const StrainStep step{{}, {}, 1};
  const SymmetricTensor shear{0, 0, 0, 0.5 * shear_rate, 0, 0};
  StrengthFactorsOf<double> factors = strength_factors<all>(LawOfPoint(law), step, shear, state);
  if (law.friction_increase > 0 && shear_rate > 0)
    factors.both *= 1 + law.friction_increase * shear_rate /
                            (shear_rate + law.inertial_rate * std::sqrt(std::max(0.0, pressure)));
  return yield_surface_of(LawOfPoint(law), factors).limit(pressure);
}

double stored_energy(const SoilLaw& law, const SoilState& state) {
  const double hardness = std::exp(law.modulus_exponent * state.largest_compression);
  const double strain = law.elastic.argument(state.pressure);
  // Behind the cutoff the gap opens and closes under a constant pressure.
  const double gap = hardness * (state.compression - state.plastic_compression) - strain;
  return (law.elastic.piece(strain).area(strain) + state.pressure * gap) / hardness +
         0.25 * double_dot(state.deviator, state.deviator) / (law.shear_ratio * state.bulk_modulus);
}

SoilEffects soil_effects_of(const std::vector<EffectDecision>& effects) {
  return {effect_on(effects, "density_hardening"), effect_on(effects, "strength_softening"),
          effect_on(effects, "strength_recovery"), effect_on(effects, "strength_rate"),
          effect_on(effects, "dilation"),          effect_on(effects, "shear_energy"),
          effect_on(effects, "inertial_friction")};
}

double constrained_modulus(const SoilFoamMaterial& material, double pressure, const SoilEffects& effects) {
  const SoilLaw law = make_soil_law(material, true, effects);
  const double modulus = law.elastic(law.elastic.argument(pressure)).derivative;
  const double hardness = std::exp(law.modulus_exponent * std::max(0.0, law.virgin.argument(pressure)));
  return hardness * modulus * (1 + 4.0 / 3.0 * material.shear_ratio);
}

}  // namespace tuft::sph
