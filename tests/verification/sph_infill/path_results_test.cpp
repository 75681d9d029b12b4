/// What is read off the path of a point, against closed forms; shear under a kept normal stress.
#include "sph_infill/path_results.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace tuft::sph {
namespace {

PathSegment segment(PathKind kind, std::optional<double> strain, std::optional<double> stress,
                    bool fresh = false) {
  PathSegment s;
  s.kind = kind;
  s.strain = strain;
  s.stress = stress;
  s.fresh = fresh;
  return s;
}

PathRecord run(const SoilLaw& law, const PointTest& test) {
  PathRecord record;
  run_strain_path(law, test, record);
  return record;
}

double result(const PointTest& test, const PathRecord& record, const std::string& name) {
  for (const PathResult& r : path_results(test, record))
    if (r.name == name) return r.value;
  ADD_FAILURE() << "no result " << name;
  return 0;
}

/// P = K e, unloading at m K, no strength in shear: the axial stress is the pressure.
struct Fluid {
  double modulus = 2e6, ratio = 1.6, peak = 400e3;
  SoilLaw law;
  PointTest test;
  PathRecord record;

  Fluid() {
    SoilFoamMaterial m;
    m.density = 500;
    m.pressure = {{0, 1}, {0, modulus}};
    m.unloading = {{0, 1e6}, {ratio * modulus, ratio * modulus}};
    law = make_soil_law(m, false);
    test.segments = {segment(PathKind::oedometric, {}, peak), segment(PathKind::oedometric, {}, 0)};
    test.measures = {{"secant", MeasureKind::modulus, 1, 0, {100e3, 300e3}},
                     {"release", MeasureKind::modulus, 2, 0, {100e3, 300e3}},
                     {"loss", MeasureKind::loss, 1, 2, {}},
                     {"slopes", MeasureKind::unloading_over_loading, 1, 2, {}}};
    test.samples = 4000;
    record = run(law, test);
  }
  /// Compression over the height as placed at a stress on either branch.
  [[nodiscard]] double loading(double stress) const { return 1 - std::exp(-stress / modulus); }
  [[nodiscard]] double unloading(double stress) const {
    const double plastic = peak / modulus * (1 - 1 / ratio);
    return 1 - std::exp(-(plastic + stress / (ratio * modulus)));
  }
};

TEST(PathResults, SecantModuliAreThoseOfTheClosedForm) {
  const Fluid f;
  EXPECT_NEAR(result(f.test, f.record, "secant") / (200e3 / (f.loading(300e3) - f.loading(100e3))), 1, 1e-5);
  EXPECT_NEAR(result(f.test, f.record, "release") / (200e3 / (f.unloading(300e3) - f.unloading(100e3))), 1,
              1e-5);
  const double low = 0.1 * f.peak, high = 0.9 * f.peak,
               slopes = (f.loading(high) - f.loading(low)) / (f.unloading(high) - f.unloading(low));
  EXPECT_NEAR(result(f.test, f.record, "slopes") / slopes, 1, 1e-5);
}

TEST(PathResults, LossOfALoopIsThatOfTheClosedForm) {
  const Fluid f;
  // Work per volume as placed: int K e exp(-e) de up, the same at m K from e_p on down.
  const auto work = [](double modulus, double e) { return modulus * (1 - std::exp(-e) * (1 + e)); };
  const double most = f.peak / f.modulus, plastic = most * (1 - 1 / f.ratio),
               back = std::exp(-plastic) * work(f.ratio * f.modulus, most / f.ratio);
  EXPECT_NEAR(result(f.test, f.record, "loss"), 1 - back / work(f.modulus, most), 1e-5);
}

TEST(PathResults, OfABranchThatDoesNotReachThemAreLeftOut) {
  Fluid f;
  f.test.measures = {{"far", MeasureKind::modulus, 1, 0, {100e3, 500e3}}};
  for (const PathResult& r : path_results(f.test, f.record)) EXPECT_NE(r.name, "far");
}

TEST(PathResults, AreNamedBeforeTheTestIsRun) {
  const Fluid f;
  const auto names = path_result_names(f.test), results = path_results(f.test, f.record);
  ASSERT_EQ(names.size(), results.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(names[i].name, results[i].name);
    EXPECT_EQ(names[i].unit, results[i].unit);
  }
}

/// Stiff in shear, so that a point is at its steady state after little strain.
SoilFoamMaterial stiff(double a0, double a1, double a2) {
  SoilFoamMaterial m;
  m.density = 1000;
  m.pressure_exponential = ExponentialCompression{500e6, 20};
  m.unloading_ratio = 1.5;
  m.yield_a0 = a0, m.yield_a1 = a1, m.yield_a2 = a2;
  m.tension_cutoff = 1e3;
  return m;
}

PointTest box() {
  PointTest test;
  test.step = 1e-3;
  for (const double normal : {100e3, 200e3, 300e3}) {
    test.segments.push_back(segment(PathKind::oedometric, {}, normal, normal > 100e3));
    test.segments.push_back(segment(PathKind::direct_shear, 0.5, {}));
  }
  test.measures = {{"phi", MeasureKind::friction_angle, 0, 0, {}}, {"c", MeasureKind::cohesion, 0, 0, {}}};
  return test;
}

TEST(DirectShearOfAPoint, KeepsItsNormalStressAndEndsOnTheYieldSurfaceAtThatPressure) {
  const double a0 = 3.6e9, a1 = 5e3, a2 = 0.3;
  const PointTest test = box();
  const PathRecord record = run(make_soil_law(stiff(a0, a1, a2)), test);
  for (const PathRow& row : record.rows) {
    if (row.segment == 0 || test.segments[row.segment - 1].kind != PathKind::direct_shear) continue;
    const double normal = 100e3 * static_cast<double>(row.segment / 2);
    EXPECT_NEAR(-row.stress().zz, normal, 1e-3) << row.segment;
    EXPECT_EQ(row.strain.xx, 0);
    EXPECT_EQ(row.strain.yy, 0);
  }
  for (const int k : {1, 2, 3}) {
    const double normal = 100e3 * k, tau = std::sqrt(a0 + a1 * normal + a2 * normal * normal);
    // The turn of the material keeps a normal deviator of the order tau^2/G.
    EXPECT_NEAR(result(test, record, fmt::format("segment_{}_shear_stress", 2 * k)) / tau, 1, 1e-3);
  }
}

TEST(DirectShearOfAPoint, OfAConeGivesItsCohesionAndTheAngleOfItsSlope) {
  const double k = 20e3, alpha = 0.6;
  const PointTest test = box();
  const PathRecord record = run(make_soil_law(stiff(k * k, 2 * k * alpha, alpha * alpha)), test);
  EXPECT_NEAR(result(test, record, "phi"), 180 / std::numbers::pi * std::atan(alpha), 0.02);
  EXPECT_NEAR(result(test, record, "c"), k, 2e-3 * k);
}

TEST(DirectShearOfAPoint, AngleOfTheLineIsNotThatOfTheSecant) {
  // Cohesion alone: the line is flat, while tau/sigma falls from 0.6 to 0.2.
  const PointTest test = box();
  const PathRecord record = run(make_soil_law(stiff(60e3 * 60e3, 0, 0)), test);
  EXPECT_NEAR(result(test, record, "phi"), 0, 0.01);
  EXPECT_NEAR(result(test, record, "c"), 60e3, 60);
}

TEST(FreshSegments, RepeatWhatTheFirstDidToTheBit) {
  PointTest test;
  test.segments = {segment(PathKind::oedometric, {}, 200e3), segment(PathKind::simple_shear, 0.1, {}),
                   segment(PathKind::oedometric, {}, 200e3, true)};
  const PathRecord record = run(make_soil_law(stiff(1e9, 0, 0.2)), test);
  const auto first = axial_branch(record, 1), again = axial_branch(record, 3);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].strain, again[i].strain);
    EXPECT_EQ(first[i].stress, again[i].stress);
  }
}

TEST(PathCurves, BeginWhereTheirSegmentsDo) {
  const PointTest test = box();
  const PathRecord record = run(make_soil_law(stiff(1e9, 0, 0.2)), test);
  const auto curves = path_curves(test, record);
  ASSERT_EQ(curves.size(), 6U);
  for (const std::size_t k : {0U, 2U, 4U}) {
    EXPECT_EQ(curves[k].x.front(), 0);
    EXPECT_EQ(curves[k].y.front(), 0);
    EXPECT_NEAR(curves[k].y.back(), 100e3 * (1 + static_cast<double>(k) / 2), 1e-3);
  }
  EXPECT_NEAR(curves[1].x.back(), 0.5, 1e-12);
}

}  // namespace
}  // namespace tuft::sph
