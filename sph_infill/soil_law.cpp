#include "sph_infill/soil_law.h"

#include <limits>
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

/// A modulus that is linear in pressure from `start` on.
struct LinearModulus {
  double start, value, rate;
  [[nodiscard]] double at(double p) const { return value + rate * (p - start); }
};

/// The virgin curve in pieces, its continuation included.
std::vector<CurvePiece> virgin_pieces(const Curve& curve) {
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
std::vector<CurvePiece> elastic_pieces(const Curve& unloading, const std::vector<CurvePiece>& virgin) {
  check_curve(unloading, "unloading", 1);
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
    pieces.push_back({strain, start, modulus.at(start), modulus.rate});
    if (end < infinity) strain = pieces.back().argument(end);
  };
  for (std::size_t k = 0; k < starts.size(); ++k) {
    const double start = starts[k], end = k + 1 < starts.size() ? starts[k + 1] : infinity;
    const LinearModulus a = unloading_modulus(unloading, start), b = virgin_modulus(virgin, start);
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

void check_parameter(double value, std::string_view name, double least, bool may_equal) {
  if (!std::isfinite(value) || value < least || (!may_equal && value == least))
    throw_input_error("{} is {}; it must be finite and {} {}", name, value, may_equal ? "at least" : "above",
                      least);
}

}  // namespace

SoilLaw make_soil_law(const SoilFoamMaterial& material, bool tension_cutoff) {
  check_parameter(material.density, "density", 0, false);
  check_parameter(material.shear_ratio, "shear_ratio", 0, false);
  check_parameter(material.yield_a0, "yield_a0", 0, true);
  check_parameter(material.yield_a1, "yield_a1", 0, true);
  check_parameter(material.yield_a2, "yield_a2", 0, true);
  check_parameter(material.tension_cutoff, "tension_cutoff", 0, true);

  SoilLaw law;
  const auto virgin = virgin_pieces(material.pressure);
  law.virgin = CurveTable(virgin);
  law.elastic = CurveTable(elastic_pieces(material.unloading, virgin));
  law.density = material.density;
  law.shear_ratio = material.shear_ratio;
  law.yield_a0 = material.yield_a0;
  law.yield_a1 = material.yield_a1;
  law.yield_a2 = material.yield_a2;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  law.yield_vertex = material.yield_a2 > 0 ? -material.yield_a1 / (2 * material.yield_a2) : -infinity;
  law.tension_cutoff = tension_cutoff ? material.tension_cutoff : infinity;
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
  return update_soil_state(LawOfPoint(law), step, state);
}

double constrained_modulus(const SoilFoamMaterial& material, double pressure) {
  const SoilLaw law = make_soil_law(material);
  const double modulus = law.elastic(law.elastic.argument(pressure)).derivative;
  return modulus * (1 + 4.0 / 3.0 * material.shear_ratio);
}

}  // namespace tuft::sph
