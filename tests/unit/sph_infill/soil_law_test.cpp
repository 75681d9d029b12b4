#include "sph_infill/soil_law.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "sph_infill/soil_update.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

StrainStep compress(double strain) {
  return {{-strain / 3, -strain / 3, -strain / 3, 0, 0, 0}, {}};
}

struct PathWork {
  double total = 0, dissipated = 0;
};

/// Compresses to `target` in equal steps; sums work per volume (volume change left out: small strains here).
PathWork go_to(const SoilLaw& law, SoilState& state, double target, int steps) {
  PathWork sum;
  const double strain = (target - state.compression) / steps;
  for (int k = 0; k < steps; ++k) {
    const SoilWork work = update_soil(law, compress(strain), state);
    sum.total += work.total;
    sum.dissipated += work.dissipated;
  }
  return sum;
}

TEST(SoilLaw, FirstLoadingFollowsThePressureCurveExactly) {
  const SoilFoamMaterial material = test::mixture_material();
  const SoilLaw law = make_soil_law(material);
  SoilState state = reference_state(law);
  for (std::size_t k = 1; k < material.pressure.x.size(); ++k) {
    go_to(law, state, material.pressure.x[k], 3);
    EXPECT_NEAR(state.pressure, material.pressure.y[k], 1e-9 * material.pressure.y[k]);
  }
}

TEST(SoilLaw, UnloadingFollowsTheIntegralOfTheUnloadingModulusWhateverTheStep) {
  SoilFoamMaterial material = test::elastic_material(1e6, 1000);
  const double k0 = 2e6, slope = 8;
  material.unloading = {{0, 1e5}, {k0, k0 + slope * 1e5}};
  const SoilLaw law = make_soil_law(material);
  for (const int steps : {1, 7, 100}) {
    SoilState state = reference_state(law);
    go_to(law, state, 0.2, 10);
    ASSERT_NEAR(state.pressure, 2e5, 1e-6);
    go_to(law, state, 0.15, steps);
    // dp/de = k0 + slope p: k0 + slope p = (k0 + slope p_max) exp(slope (e - e_max)).
    const double expected = ((k0 + slope * 2e5) * std::exp(-slope * 0.05) - k0) / slope;
    EXPECT_NEAR(state.pressure, expected, 1e-9 * expected);
    EXPECT_NEAR(state.bulk_modulus, k0 + slope * expected, 1e-8 * k0);
    go_to(law, state, 0.2, steps);
    EXPECT_NEAR(state.pressure, 2e5, 1e-6);  // reloading: the same way back
  }
}

TEST(SoilLaw, NeverExceedsTheFirstLoadingCurve) {
  for (const double modulus : {1.3e6, 1e5}) {  // the second is softer than first loading and must be raised
    SoilFoamMaterial material = test::mixture_material();
    material.unloading = {{0}, {modulus}};
    const SoilLaw law = make_soil_law(material);
    SoilState state = reference_state(law);
    std::mt19937_64 random(2);
    std::normal_distribution<double> strain(0.0005, 0.01);
    for (int k = 0; k < 3000; ++k) {
      update_soil(law, compress(state.compression > 0.5 ? -0.3 : strain(random)), state);
      if (state.compression <= 0) continue;
      EXPECT_LE(state.pressure, law.virgin(state.compression).value * (1 + 1e-9) + 1e-6);
    }
  }
}

TEST(SoilLaw, StoredVolumetricEnergyIsTheClosedFormOfTheUnloadingCurve) {
  SoilFoamMaterial material = test::elastic_material(1e6, 1000);
  const double k0 = 2e6, slope = 8;
  material.unloading = {{0, 1e5}, {k0, k0 + slope * 1e5}};
  const SoilLaw law = make_soil_law(material);
  SoilState state = reference_state(law);
  const PathWork work = go_to(law, state, 0.1, 2000);
  // p = P(e) = 1e6 e; u(p) = log(1 + slope p/k0)/slope; stored = int_0^u p du.
  const double u = std::log1p(slope * 1e5 / k0) / slope;
  const double stored = k0 / slope * (std::expm1(slope * u) / slope - u);
  EXPECT_NEAR(work.total, 0.5 * 1e6 * 0.01, 1e-6 * 5000);
  EXPECT_NEAR(work.total - work.dissipated, stored, 1e-5 * stored);
}

TEST(SoilLaw, PressureCyclesNeverGiveEnergyBack) {
  for (const double modulus : {3e6, 1e5}) {
    SoilFoamMaterial material = test::mixture_material();
    material.unloading = {{0}, {modulus}};
    const SoilLaw law = make_soil_law(material);
    SoilState state = reference_state(law);
    go_to(law, state, 0.05, 500);
    PathWork cycle = go_to(law, state, 0.15, 1000);
    const PathWork back = go_to(law, state, 0.05, 1000);
    EXPECT_GE(cycle.total + back.total, -1e-9 * cycle.total) << "unloading modulus " << modulus;
    EXPECT_GE(cycle.dissipated + back.dissipated, 0);
  }
}

TEST(SoilLaw, DissipationIsNeverNegativeOnRandomPaths) {
  const SoilLaw law = make_soil_law(test::mixture_material());
  std::mt19937_64 random(7);
  std::normal_distribution<double> any(0, 0.004);
  SoilState state = reference_state(law);
  double sum = 0;
  for (int k = 0; k < 20000; ++k) {
    const double drift = 0.02 * (0.1 - state.compression);
    StrainStep step{
        {any(random) - drift, any(random) - drift, any(random), any(random), any(random), any(random)},
        {any(random), any(random), any(random)}};
    const SoilWork work = update_soil(law, step, state);
    ASSERT_GE(work.dissipated, 0) << "step " << k;
    sum += work.dissipated;
  }
  EXPECT_GT(sum, 0);
}

TEST(SoilLaw, DeviatorNeverLeavesTheYieldSurfaceAndReturnsRadially) {
  const SoilLaw law = make_soil_law(test::mixture_material());
  SoilState state = reference_state(law);
  go_to(law, state, 0.1, 20);
  const double limit = yield_limit_of(LawOfPoint(law), state.pressure);
  update_soil(law, {{0, 0, 0, 0.3, 0.1, 0}, {}}, state);
  EXPECT_NEAR(0.5 * double_dot(state.deviator, state.deviator), limit, 1e-12 * limit);
  EXPECT_NEAR(state.deviator.xy / state.deviator.yz, 3, 1e-12);
  EXPECT_NEAR(state.compression, 0.1, 1e-15) << "no dilation";
}

TEST(SoilLaw, ShearBelowYieldIsElasticWithTheUnloadingModulus) {
  const SoilFoamMaterial material = test::mixture_material();
  const SoilLaw law = make_soil_law(material);
  SoilState state = reference_state(law);
  const SoilWork work = update_soil(law, {{0, 0, 0, 1e-3, 0, 0}, {}}, state);
  const double shear_modulus = material.shear_ratio * material.unloading.y[0];
  EXPECT_NEAR(state.deviator.xy, 2 * shear_modulus * 1e-3, 1e-6);
  EXPECT_NEAR(work.total, 2 * shear_modulus * 1e-6, 1e-9);  // s:e/2 with both shear entries
  EXPECT_EQ(work.dissipated, 0);
}

TEST(SoilLaw, YieldLimitNeverRisesInTension) {
  SoilFoamMaterial material = test::mixture_material();
  SoilLaw law = make_soil_law(material);
  const double apex = -material.yield_a1 / (2 * material.yield_a2);
  EXPECT_NEAR(yield_limit_of(LawOfPoint(law), apex), 0, 1e-6);
  EXPECT_EQ(yield_limit_of(LawOfPoint(law), 10 * apex), yield_limit_of(LawOfPoint(law), apex));
  material.yield_a1 = 0;  // J2 <= k^2 + alpha^2 p^2
  law = make_soil_law(material);
  EXPECT_EQ(yield_limit_of(LawOfPoint(law), -1e5), material.yield_a0);
}

TEST(SoilLaw, TensionCutoffHoldsPressureZeroesTheDeviatorAndRemembersTheGap) {
  const SoilFoamMaterial material = test::mixture_material();
  const SoilLaw law = make_soil_law(material);
  SoilState state = reference_state(law);
  update_soil(law, {{0, 0, 0, 2e-3, 0, 0}, {}}, state);
  ASSERT_GT(state.deviator.xy, 0);
  const SoilWork work = update_soil(law, compress(-0.05), state);
  EXPECT_EQ(state.pressure, -material.tension_cutoff);
  EXPECT_EQ(state.deviator.xy, 0);
  EXPECT_GT(work.dissipated, 0);  // the shear energy
  update_soil(law, compress(0.02), state);
  EXPECT_EQ(state.pressure, -material.tension_cutoff) << "the gap is still open";
  update_soil(law, compress(0.03), state);
  EXPECT_NEAR(state.pressure, 0, 1e-6) << "closed at the density where it opened";
}

TEST(SoilLaw, PullsWithoutLimitWhenTheCutoffIsOff) {
  const SoilLaw law = make_soil_law(test::mixture_material(), false);
  SoilState state = reference_state(law);
  update_soil(law, compress(-0.1), state);
  EXPECT_NEAR(state.pressure, -0.1 * 1.8e6, 1e-6);
}

TEST(SoilLaw, ContinuationBeyondTheLastPointStiffensWithoutAJumpAndFollowsAnExponential) {
  const SoilFoamMaterial material = test::mixture_material();  // (K0/b)(exp(b e) - 1) up to e = 0.4
  const SoilLaw law = make_soil_law(material);
  const double last = material.pressure.x.back();
  EXPECT_NEAR(law.virgin(last + 1e-9).value, material.pressure.y.back(), 0.1);
  const auto& x = material.pressure.x;
  const auto& y = material.pressure.y;
  const std::size_t n = x.size();
  const double last_slope = (y[n - 1] - y[n - 2]) / (x[n - 1] - x[n - 2]);
  double before = last_slope;
  for (double e = last + 0.001; e < 1.6; e += 0.01) {
    const auto point = law.virgin(e);
    ASSERT_GE(point.derivative, before);
    before = point.derivative;
  }
  const double closed = 1.5e6 / 10 * std::expm1(10 * 0.6);
  EXPECT_NEAR(law.virgin(0.6).value, closed, 0.02 * closed);
}

TEST(SoilLaw, ContinuationOfACurveThatDoesNotStiffenKeepsTheLastSlope) {
  SoilFoamMaterial material = test::elastic_material(1e6, 1000);
  material.pressure = {{0, 0.1, 0.2}, {0, 2e5, 3e5}};
  const SoilLaw law = make_soil_law(material);
  EXPECT_NEAR(law.virgin(0.5).value, 6e5, 1e-6);
  EXPECT_NEAR(law.virgin(0.5).derivative, 1e6, 1e-6);
}

TEST(SoilLaw, ConstrainedModulusIsBulkPlusFourThirdsOfShear) {
  const SoilFoamMaterial material = test::mixture_material();
  const double p = 3e5, bulk = 1.2 * (1.5e6 + 10 * p);
  EXPECT_NEAR(constrained_modulus(material, p), bulk * (1 + 4.0 / 3 * 0.5), 1e-6 * bulk);
}

TEST(SoilLaw, RotationByCayleyIsAnExactRotation) {
  const SymmetricTensor s{3e4, -1e4, -2e4, 5e3, -7e3, 1e3};
  const std::array<double, 3> w{0.4, -0.9, 0.3};
  const double angle = 2 * std::atan(0.5 * std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]));
  const Vec3 axis = Vec3(w[0], w[1], w[2]).normalized();
  Mat3 cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  const Mat3 q = Mat3::Identity() + std::sin(angle) * cross + (1 - std::cos(angle)) * cross * cross;
  EXPECT_LT((to_matrix(rotate(s, w)) - q * to_matrix(s) * q.transpose()).norm(), 1e-10);
}

void expect_rejected(const SoilFoamMaterial& material, const std::string& words) {
  try {
    (void)make_soil_law(material);
    FAIL() << "accepted, expected: " << words;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(SoilLaw, RejectsCurvesThatAreNoCurves) {
  const SoilFoamMaterial good = test::mixture_material();
  SoilFoamMaterial m = good;
  m.pressure.y[5] = m.pressure.y[4];
  expect_rejected(m, "pressure curve, point 6");
  m = good;
  m.pressure.x[3] = m.pressure.x[2];
  expect_rejected(m, "pressure curve, point 4: abscissa");
  m = good;
  m.pressure = {{0}, {0}};
  expect_rejected(m, "at least 2");
  m = good;
  m.pressure.y[0] = 10;
  expect_rejected(m, "start it at (0, 0)");
  m = good;
  m.pressure.y[7] = std::nan("");
  expect_rejected(m, "point 8: (0.07, nan) is not finite");
  m = good;
  m.unloading.y[1] = -1;
  expect_rejected(m, "unloading curve, point 2: modulus -1 Pa is not positive");
  m = good;
  m.unloading = {};
  expect_rejected(m, "unloading curve has 0");
  m = good;
  m.density = 0;
  expect_rejected(m, "density is 0");
  m = good;
  m.tension_cutoff = -1;
  expect_rejected(m, "tension_cutoff is -1");
}

}  // namespace
}  // namespace tuft::sph
