#include "sph_infill/path_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::sph {
namespace {

/// Rows of one segment with the row that it begins with: [first, last].
struct Rows {
  std::size_t first = 0, last = 0;
  bool there = false;
};

Rows rows_of(const PathRecord& record, std::size_t segment) {
  const auto of = [&](const PathRow& row) { return row.segment == segment; };
  const auto begin = std::find_if(record.rows.begin(), record.rows.end(), of);
  if (begin == record.rows.end()) return {};
  const auto end = std::find_if_not(begin, record.rows.end(), of);
  const auto first = static_cast<std::size_t>(begin - record.rows.begin()),
             last = static_cast<std::size_t>(end - record.rows.begin()) - 1;
  // A fresh segment has its own start among its rows.
  const bool has_start = begin->work == 0 && begin->strain.zz == 0 && begin->strain.xx == 0 &&
                         begin->strain.xy == 0 && begin->strain.zx == 0;
  return {has_start || first == 0 ? first : first - 1, last, true};
}

double compression_of_height(const PathRow& row) {
  return 1 - std::exp(row.strain.zz);
}

std::optional<double> cycle_ratio(const PathRecord& record, std::size_t segment, std::size_t release) {
  const auto up = axial_branch(record, segment), down = axial_branch(record, release);
  double peak = 0;
  for (const BranchPoint& point : up) peak = std::max(peak, point.stress);
  const double low = cycle_low_share * peak, high = cycle_high_share * peak;
  const auto loading = secant_modulus(up, low, high, 1), unloading = secant_modulus(down, high, low, -1);
  if (!loading || !unloading) return std::nullopt;
  return *unloading / *loading;
}

std::string_view unit_of(MeasureKind kind) {
  switch (kind) {
    case MeasureKind::modulus:
    case MeasureKind::cohesion:
      return "Pa";
    case MeasureKind::friction_angle:
      return "deg";
    default:
      return "1";
  }
}

std::optional<double> value_of(const PointTest& test, const PathRecord& record, const PointMeasure& measure) {
  const auto segment = static_cast<std::size_t>(measure.segment),
             release = static_cast<std::size_t>(measure.release);
  switch (measure.kind) {
    case MeasureKind::modulus: {
      const auto branch = axial_branch(record, segment);
      const bool up = !branch.empty() && branch.back().stress >= branch.front().stress;
      return up ? secant_modulus(branch, measure.between[0], measure.between[1], 1)
                : secant_modulus(branch, measure.between[1], measure.between[0], -1);
    }
    case MeasureKind::loss:
      return loop_loss(record, segment);
    case MeasureKind::unloading_over_loading:
      return cycle_ratio(record, segment, release);
    default:
      break;
  }
  const auto line = shear_line(test, record);
  if (!line) return std::nullopt;
  return measure.kind == MeasureKind::cohesion ? line->cohesion
                                               : 180 / std::numbers::pi * line->friction_angle;
}

/// The segment after which a measure is known.
std::size_t needed(const PointTest& test, const PointMeasure& measure) {
  if (measure.segment > 0) return static_cast<std::size_t>(std::max(measure.segment, measure.release));
  std::size_t last = 0;
  for (std::size_t k = 0; k < test.segments.size(); ++k)
    if (test.segments[k].kind == PathKind::direct_shear) last = k + 1;
  return last;
}

/// Results at the end of a segment.
std::vector<PathResult> end_results(const PointTest& test, const PathRow& row) {
  const std::string end = fmt::format("segment_{}_", row.segment);
  return {{end + "compression", "1", row.state.compression},
          {end + "pressure", "Pa", row.state.pressure},
          {end + "q", "Pa", row.q()},
          {end + "axial_stress", "Pa", -row.stress().zz},
          {end + "shear_stress", "Pa", shear_stress(test, row)},
          {end + "bulk_modulus", "Pa", row.state.bulk_modulus}};
}

/// What an experimenter draws of a segment.
struct Axes {
  double (*x)(const PathRow&);
  double (*y)(const PathRow&);
  const char *x_label, *y_label;
};

Axes axes_of(PathKind kind) {
  switch (kind) {
    case PathKind::isotropic:
      return {[](const PathRow& r) { return r.state.compression; },
              [](const PathRow& r) { return r.state.pressure; }, "compression ln(ρ/ρ0)", "pressure"};
    case PathKind::oedometric:
      return {compression_of_height, [](const PathRow& r) { return -r.stress().zz; }, "compression",
              "axial stress"};
    case PathKind::triaxial:
      return {[](const PathRow& r) { return -r.strain.zz; }, [](const PathRow& r) { return r.q(); },
              "axial strain, logarithmic", "q"};
    case PathKind::direct_shear:
      return {[](const PathRow& r) { return 2 * r.strain.zx; },
              [](const PathRow& r) { return r.state.deviator.zx; }, "shear strain", "shear stress"};
    default:
      return {[](const PathRow& r) { return 2 * r.strain.xy; },
              [](const PathRow& r) { return r.state.deviator.xy; }, "shear strain", "shear stress"};
  }
}

}  // namespace

std::vector<BranchPoint> axial_branch(const PathRecord& record, std::size_t segment) {
  std::vector<BranchPoint> branch;
  const Rows rows = rows_of(record, segment);
  for (std::size_t k = rows.first; rows.there && k <= rows.last; ++k)
    branch.push_back({compression_of_height(record.rows[k]), -record.rows[k].stress().zz});
  return branch;
}

std::optional<double> loop_loss(const PathRecord& record, std::size_t segment) {
  const Rows up = rows_of(record, segment), down = rows_of(record, segment + 1);
  if (!up.there || !down.there) return std::nullopt;
  const auto& rows = record.rows;
  const double put_in = rows[up.last].work - rows[up.first].work,
               given_back = rows[up.last].work - rows[down.last].work;
  if (!(put_in > 0)) return std::nullopt;
  return 1 - given_back / put_in;
}

std::optional<MohrCoulombLine> shear_line(const PointTest& test, const PathRecord& record) {
  std::vector<double> normal, shear;
  for (std::size_t k = 0; k < test.segments.size(); ++k) {
    const Rows rows = rows_of(record, k + 1);
    if (test.segments[k].kind != PathKind::direct_shear || !rows.there) continue;
    normal.push_back(-record.rows[rows.last].stress().zz);
    shear.push_back(shear_stress(test, record.rows[rows.last]));
  }
  return fit_mohr_coulomb(normal, shear);
}

std::vector<PathResult> path_results(const PointTest& test, const PathRecord& record) {
  std::vector<PathResult> results;
  for (std::size_t k = 1; k <= test.segments.size(); ++k)
    if (const Rows rows = rows_of(record, k); rows.there)
      for (PathResult& result : end_results(test, record.rows[rows.last])) results.push_back(result);
  double pressure = 0, q = 0;
  for (const PathRow& row : record.rows) {
    pressure = std::max(pressure, row.state.pressure);
    q = std::max(q, row.q());
  }
  results.push_back({"largest_pressure", "Pa", pressure});
  results.push_back({"largest_q", "Pa", q});
  results.push_back({"work", "J/m^3", record.rows.back().work});
  results.push_back({"dissipated", "J/m^3", record.rows.back().dissipated});
  for (const PointMeasure& measure : test.measures)
    if (const auto value = value_of(test, record, measure);
        value && record.completed >= needed(test, measure))
      results.push_back({measure.name, std::string(unit_of(measure.kind)), *value});
  return results;
}

std::vector<PathResult> path_result_names(const PointTest& test) {
  PathRecord record;
  for (std::size_t k = 0; k <= test.segments.size(); ++k) record.rows.emplace_back().segment = k;
  PointTest bare = test;
  bare.measures.clear();
  std::vector<PathResult> names = path_results(bare, record);
  for (PathResult& result : names) result.value = 0;
  for (const PointMeasure& measure : test.measures)
    names.push_back({measure.name, std::string(unit_of(measure.kind)), 0});
  return names;
}

std::vector<PathCurve> path_curve_names(const PointTest& test) {
  std::vector<PathCurve> names;
  for (std::size_t k = 1; k <= test.segments.size(); ++k) {
    const PathKind kind = test.segments[k - 1].kind;
    if (kind == PathKind::velocity_gradient) continue;
    const Axes axes = axes_of(kind);
    names.push_back({fmt::format("segment_{}_stress", k), "1", "Pa", axes.x_label, axes.y_label, {}, {}});
  }
  return names;
}

std::vector<PathCurve> path_curves(const PointTest& test, const PathRecord& record) {
  std::vector<PathCurve> curves = path_curve_names(test);
  auto curve = curves.begin();
  for (std::size_t k = 1; k <= test.segments.size(); ++k) {
    const PathKind kind = test.segments[k - 1].kind;
    if (kind == PathKind::velocity_gradient) continue;
    const Axes axes = axes_of(kind);
    const Rows rows = rows_of(record, k);
    for (std::size_t r = rows.first; rows.there && r <= rows.last; ++r) {
      curve->x.push_back(axes.x(record.rows[r]));
      curve->y.push_back(axes.y(record.rows[r]));
    }
    ++curve;
  }
  return curves;
}

}  // namespace tuft::sph
