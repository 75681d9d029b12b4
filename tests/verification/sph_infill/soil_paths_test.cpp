/// Paths of one material point against closed forms: yield surface, large simple shear, tension, cycles.
#include <gtest/gtest.h>

#include "core/error.h"
#include "sph_infill/strain_path.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double cohesion = 15e3, angle = 0.55;  // Pa, rad

/// Mixture by closed forms, with a Mohr-Coulomb strength matched in triaxial compression.
SoilFoamMaterial material(ConeMatch match = ConeMatch::triaxial_compression) {
  SoilFoamMaterial m = test::mixture_material();
  m.pressure = m.unloading = {};
  m.pressure_exponential = ExponentialCompression{1.5e6, 10};
  m.unloading_ratio = 1.2;
  m.yield_a0 = m.yield_a1 = m.yield_a2 = 0;
  m.mohr_coulomb = MohrCoulombStrength{cohesion, angle, match};
  m.tension_cutoff = 5e3;
  return m;
}

PathSegment to_strain(PathKind kind, double strain) {
  PathSegment segment;
  segment.kind = kind;
  segment.strain = strain;
  return segment;
}
PathSegment to_stress(PathKind kind, double stress) {
  PathSegment segment;
  segment.kind = kind;
  segment.stress = stress;
  return segment;
}

PathRecord run(const SoilLaw& law, std::vector<PathSegment> segments, double step = 1e-4) {
  PointTest test;
  test.file = "test.toml";
  test.segments = std::move(segments);
  test.step = step;
  PathRecord record;
  run_strain_path(law, test, record);
  return record;
}

const PathRow& end_of(const PathRecord& record, std::size_t segment) {
  const PathRow* last = nullptr;
  for (const PathRow& row : record.rows)
    if (row.segment == segment) last = &row;
  return *last;
}

TEST(YieldSurface, TriaxialCompressionFailsAtMohrAndCoulombsStress) {
  const SoilLaw law = make_soil_law(material());
  const double sine = std::sin(angle), kp = (1 + sine) / (1 - sine);
  for (const double lateral : {50e3, 100e3, 200e3}) {
    const PathRecord record =
        run(law, {to_stress(PathKind::isotropic, lateral), to_strain(PathKind::triaxial, 0.3)});
    const PathRow& end = end_of(record, 2);
    EXPECT_NEAR(-end.stress().xx, lateral, 1e-6 * lateral);
    EXPECT_NEAR(-end.stress().zz, kp * lateral + 2 * cohesion * std::sqrt(kp), 1e-5 * kp * lateral);
    // dq/dp is 3 all the way.
    for (const PathRow& row : record.rows)
      if (row.segment == 2) {
        EXPECT_NEAR(row.q(), 3 * (row.state.pressure - lateral), 1e-5 * lateral);
      }
  }
}

TEST(YieldSurface, TriaxialExtensionFailsAtTheSameSquareRootOfJ2) {
  const SoilLaw law = make_soil_law(material());
  const double sine = std::sin(angle), m = 6 * sine / (3 - sine),
               d = 6 * cohesion * std::cos(angle) / (3 - sine), lateral = 200e3;
  const PathRecord record =
      run(law, {to_stress(PathKind::isotropic, lateral), to_strain(PathKind::triaxial, -0.2)});
  // q = d + m p and p = lateral - q/3.
  const double q = (d + m * lateral) / (1 + m / 3);
  EXPECT_NEAR(end_of(record, 2).q(), q, 1e-5 * q);
  EXPECT_NEAR(-end_of(record, 2).stress().zz, lateral - q, 1e-5 * q);
}

TEST(YieldSurface, PureShearIsElasticThenAtCohesionAndFriction) {
  const SoilLaw law = make_soil_law(material(ConeMatch::pure_shear));
  const double p = 150e3, limit = cohesion + p * std::tan(angle),
               shear_modulus = 0.5 * 1.2 * (1.5e6 + 10 * p);
  const PathRecord record =
      run(law, {to_stress(PathKind::isotropic, p), to_strain(PathKind::pure_shear, 0.2)});
  for (const PathRow& row : record.rows) {
    if (row.segment != 2) continue;
    const double gamma = 2 * row.strain.xy;
    EXPECT_NEAR(row.state.deviator.xy, std::min(shear_modulus * gamma, limit), 1e-4 * limit);
    EXPECT_NEAR(row.state.pressure, p, 1e-6 * p) << "no dilation";
  }
}

TEST(YieldSurface, UnloadingLeavesItElasticallyAndMeetsItOnTheOtherSide) {
  const SoilLaw law = make_soil_law(material(ConeMatch::pure_shear));
  const double p = 150e3, limit = cohesion + p * std::tan(angle),
               shear_modulus = 0.5 * 1.2 * (1.5e6 + 10 * p);
  const PathRecord record = run(law, {to_stress(PathKind::isotropic, p), to_strain(PathKind::pure_shear, 0.1),
                                      to_strain(PathKind::pure_shear, -0.2)});
  const double turn = end_of(record, 2).strain.xy;
  for (const PathRow& row : record.rows) {
    if (row.segment != 3) continue;
    const double back = 2 * (turn - row.strain.xy);
    EXPECT_NEAR(row.state.deviator.xy, std::max(limit - shear_modulus * back, -limit), 1e-4 * limit);
  }
  EXPECT_NEAR(end_of(record, 3).state.deviator.xy, -limit, 1e-6 * limit);
}

TEST(YieldSurface, TensionEndsAtTheCutoffWithoutShear) {
  const SoilLaw law = make_soil_law(material());
  const PathRecord record =
      run(law, {to_stress(PathKind::isotropic, 50e3), to_strain(PathKind::pure_shear, 0.1),
                to_strain(PathKind::isotropic, -0.1)});
  ASSERT_GT(end_of(record, 2).q(), 1e4);
  bool torn = false;
  for (const PathRow& row : record.rows) {
    EXPECT_GE(row.state.pressure, -5e3);
    torn = torn || row.state.pressure == -5e3;
    if (torn) {
      EXPECT_EQ(row.q(), 0);
    }
    EXPECT_LE(row.q(), std::sqrt(3.0) * row.yield * (1 + 1e-9) + 1e-6);
  }
  EXPECT_TRUE(torn);
}

TEST(YieldSurface, OfTheGeneralQuadraticIsMetAtEveryPressure) {
  SoilFoamMaterial m = material();
  m.mohr_coulomb.reset();
  m.yield_a0 = 4e8, m.yield_a1 = 3e4, m.yield_a2 = 0.05;  // no perfect square
  const SoilLaw law = make_soil_law(m);
  for (const double p : {1e3, 1e5, 5e5}) {
    const PathRecord record =
        run(law, {to_stress(PathKind::isotropic, p), to_strain(PathKind::pure_shear, 0.3)});
    EXPECT_NEAR(end_of(record, 2).state.deviator.xy, std::sqrt(4e8 + 3e4 * p + 0.05 * p * p), 1e-4 * p);
  }
}

/// Jaumann's rate under simple shear gamma: s_xy = G sin(gamma), s_xx = -s_yy = G (1 - cos(gamma))
/// (Dienes 1979). A step's strain is added behind its turn, which is of first order: half the turn of a step.
TEST(SimpleShear, FollowsJaumannsClosedFormOverAFullTurnOfTheSineWithinAStepsShare) {
  const double bulk = 2e6, ratio = 0.5, shear_modulus = ratio * bulk;
  const SoilLaw law = make_soil_law(test::elastic_material(bulk, 1000, ratio));
  for (const double step : {0.01, 0.001, 0.0001}) {
    const PathRecord record = run(law, {to_strain(PathKind::simple_shear, 6.4)}, step);
    double worst = 0;
    for (const PathRow& row : record.rows) {
      const double gamma = 2 * row.strain.xy;
      worst = std::max({worst, std::abs(row.state.deviator.xy - shear_modulus * std::sin(gamma)),
                        std::abs(row.state.deviator.xx - shear_modulus * (1 - std::cos(gamma))),
                        std::abs(row.state.deviator.yy + shear_modulus * (1 - std::cos(gamma)))});
      EXPECT_NEAR(row.state.deviator.zz, 0, 1e-9 * shear_modulus);
      EXPECT_NEAR(row.state.pressure, 0, 1e-9 * shear_modulus);
    }
    EXPECT_LT(worst, 1.01 * step * shear_modulus);
  }
}

TEST(SimpleShear, AsAVelocityGradientIsTheSame) {
  const SoilLaw law = make_soil_law(material());
  PathSegment given;
  given.kind = PathKind::velocity_gradient;
  given.velocity_gradient = {0, 4, 0, 0, 0, 0, 0, 0, 0};
  given.duration = 0.25;
  const PathSegment press = to_stress(PathKind::isotropic, 1e5);
  const PathRow a = end_of(run(law, {press, given}), 2),
                b = end_of(run(law, {press, to_strain(PathKind::simple_shear, 1)}), 2);
  EXPECT_NEAR(a.state.deviator.xy, b.state.deviator.xy, 1e-6 * b.q());
  EXPECT_NEAR(a.state.deviator.xx, b.state.deviator.xx, 1e-6 * b.q());
}

TEST(Oedometer, PastTheLastPointOfItsTableFollowsTheClosedFormBehindIt) {
  SoilFoamMaterial m = material();
  const SoilLaw exact = make_soil_law(m);
  m.pressure_exponential.reset();
  m.unloading_ratio = 0;
  const double last = std::log1p(10 * 667e3 / 1.5e6) / 10;
  for (int k = 0; k <= 12; ++k) {
    m.pressure.x.push_back(last * k / 12);
    m.pressure.y.push_back(1.5e5 * std::expm1(10 * m.pressure.x.back()));
  }
  m.unloading = {{0, 1e6}, {1.8e6, 13.8e6}};
  const SoilLaw table = make_soil_law(m);
  for (const double p : {597e3, 813e3}) {
    const double e = std::log1p(10 * p / 1.5e6) / 10;
    const PathRow a = end_of(run(exact, {to_strain(PathKind::oedometric, e)}), 1),
                  b = end_of(run(table, {to_strain(PathKind::oedometric, e)}), 1);
    EXPECT_NEAR(a.state.pressure, p, 1e-6 * p);
    EXPECT_NEAR(b.state.pressure, p, 0.01 * p);
    EXPECT_NEAR(b.stress().zz, a.stress().zz, 0.01 * p);
  }
}

TEST(Compaction, PressedAndReleasedInfillIsStifferAndStrongerThanPlaced) {
  SoilFoamMaterial m = material();
  m.density_hardening = DensityHardening{5.95, 2.08, 0.643};
  SoilEffects effects;
  effects.density_hardening = effects.shear_energy = true;
  const SoilLaw law = make_soil_law(m, true, effects);
  const auto sheared = [&](double pressing) {
    std::vector<PathSegment> segments;
    if (pressing > 0) segments.push_back(to_stress(PathKind::isotropic, pressing));
    segments.push_back(to_stress(PathKind::isotropic, 50e3));
    segments.push_back(to_strain(PathKind::triaxial, 0.2));
    return run(law, segments);
  };
  const PathRecord loose = sheared(0), pressed = sheared(500e3);
  const double hardness = std::exp(5.95 * 0.1 * std::log1p(10 * 500e3 / 1.5e6)),
               placed = std::exp(5.95 * 0.1 * std::log1p(10 * 50e3 / 1.5e6));
  const double loose_modulus = end_of(loose, 1).state.bulk_modulus,
               pressed_modulus = end_of(pressed, 2).state.bulk_modulus;
  EXPECT_NEAR(pressed_modulus / loose_modulus, hardness / placed, 1e-6);
  // q = d + m p, p = 50 kPa + q/3, under the factors of its largest compression.
  const double largest = 0.1 * std::log1p(10 * 500e3 / 1.5e6), sine = std::sin(angle);
  const double d = std::exp(2.08 * largest) * 6 * cohesion * std::cos(angle) / (3 - sine),
               slope = std::exp(0.643 * largest) * 6 * sine / (3 - sine),
               q = (d + slope * 50e3) / (1 - slope / 3);
  EXPECT_NEAR(end_of(pressed, 3).q(), q, 1e-4 * q);
  EXPECT_GT(q, 1.15 * end_of(loose, 2).q());
  EXPECT_GT(end_of(pressed, 3).state.compression, 0.05) << "and denser";
}

TEST(Cycles, AHundredOfThemTakeEnergyInAndNoneGivesAnyBack) {
  SoilFoamMaterial m = material();
  m.density_hardening = DensityHardening{5.95, 2.08, 0.643};
  m.dilation_angle = 0.1;
  SoilEffects effects;
  effects.density_hardening = effects.shear_energy = effects.dilation = true;
  const SoilLaw law = make_soil_law(m, true, effects);
  std::vector<PathSegment> segments;
  for (int k = 0; k < 100; ++k) {
    segments.push_back(to_stress(PathKind::oedometric, 300e3));
    segments.push_back(to_strain(PathKind::simple_shear, k % 2 == 0 ? 0.05 : -0.05));
    segments.push_back(to_stress(PathKind::oedometric, 10e3));
  }
  const PathRecord record = run(law, segments, 5e-4);
  double before = 0, dissipated = 0;
  for (std::size_t cycle = 1; cycle <= 100; ++cycle) {
    const PathRow& end = end_of(record, 3 * cycle);
    EXPECT_GT(end.work - end.stored, before) << "cycle " << cycle;
    EXPECT_GT(end.dissipated, dissipated) << "cycle " << cycle;
    before = end.work - end.stored, dissipated = end.dissipated;
  }
}

TEST(StressTargets, ThatCannotBeMetAreNamed) {
  const SoilLaw law = make_soil_law(material());
  try {
    (void)run(law, {to_stress(PathKind::isotropic, 1e5), to_stress(PathKind::pure_shear, 1e6)}, 1e-3);
    FAIL();
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("segments.1 (pure_shear): a stress of 1e+06 Pa is not met"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tuft::sph
