/// One material point in uniaxial strain against the closed form of its law.
#include <gtest/gtest.h>

#include "sph_infill/soil_law.h"

namespace tuft::sph {
namespace {

/// P = K e on first loading; unloading modulus K0 + b p; G = ratio K_un; cone sqrt(J2) <= k + alpha p.
struct Oedometer {
  double virgin = 2e6, k0 = 3e6, b = 12, ratio = 1.0, cohesion = 30e3, alpha = 0.3, cutoff = 15e3;
  SoilLaw law;
  SoilState state;

  Oedometer() {
    SoilFoamMaterial m;
    m.density = 1000;
    m.pressure = {{0, 1}, {0, virgin}};
    m.unloading = {{0, 1e6}, {k0, k0 + b * 1e6}};
    m.shear_ratio = ratio;
    m.yield_a0 = cohesion * cohesion;
    m.yield_a1 = 2 * cohesion * alpha;
    m.yield_a2 = alpha * alpha;
    m.tension_cutoff = cutoff;
    law = make_soil_law(m);
    state = reference_state(law);
  }
  /// One-dimensional compression to e in steps of about 1e-4.
  void go_to(double e) {
    const int steps = static_cast<int>(std::ceil(std::abs(e - state.compression) / 1e-4));
    const double strain = (e - state.compression) / steps;
    for (int n = 0; n < steps; ++n) update_soil(law, {{0, 0, -strain, 0, 0, 0}, {}}, state);
  }
  /// Vertical deviator is -2/sqrt(3) sqrt(J2) or its opposite at yield.
  [[nodiscard]] double yielding(double p) const { return 2 / std::sqrt(3) * (cohesion + alpha * p); }
  /// 2 G (2/3) de with G = ratio K is (4/3) ratio dp off first loading.
  [[nodiscard]] double elastic_change(double dp) const { return 4.0 / 3 * ratio * dp; }
};

constexpr double tolerance = 50;  // Pa; stresses here are 1e4 to 3e5

TEST(UniaxialStrain, LoadsElasticallyThenOnTheYieldSurface) {
  Oedometer o;
  o.go_to(0.005);
  // s_zz = -int 2 G (2/3) de, G = ratio (K0 + b K e).
  const auto elastic = [&](double e) {
    return -4.0 / 3 * o.ratio * (o.k0 * e + 0.5 * o.b * o.virgin * e * e);
  };
  EXPECT_NEAR(o.state.pressure, o.virgin * 0.005, 1e-6);
  EXPECT_NEAR(o.state.deviator.zz, elastic(0.005), 1);
  ASSERT_LT(std::abs(elastic(0.005)), o.yielding(o.state.pressure));
  o.go_to(0.1);
  EXPECT_NEAR(o.state.pressure, o.virgin * 0.1, 1e-6);
  EXPECT_NEAR(o.state.deviator.zz, -o.yielding(o.state.pressure), tolerance);
  EXPECT_NEAR(o.state.deviator.xx, 0.5 * o.yielding(o.state.pressure), tolerance);
}

TEST(UniaxialStrain, UnloadsElasticallyThenYieldsInReverse) {
  Oedometer o;
  o.go_to(0.1);
  const double p_max = o.state.pressure, s_max = o.state.deviator.zz;
  const auto unloaded = [&](double e) {
    return ((o.k0 + o.b * p_max) * std::exp(o.b * (e - 0.1)) - o.k0) / o.b;
  };
  o.go_to(0.09);
  const double p = unloaded(0.09);
  EXPECT_NEAR(o.state.pressure, p, 1e-6 * p_max);
  EXPECT_NEAR(o.state.deviator.zz, s_max - o.elastic_change(p - p_max), tolerance);
  o.go_to(0.065);
  const double low = unloaded(0.065);
  EXPECT_NEAR(o.state.pressure, low, 1e-6 * p_max);
  EXPECT_NEAR(o.state.deviator.zz, o.yielding(low), tolerance) << "horizontal stress is the larger now";
}

TEST(UniaxialStrain, ReloadsAlongTheUnloadingCurveAndRejoinsFirstLoading) {
  Oedometer o;
  o.go_to(0.1);
  o.go_to(0.09);
  const double p = o.state.pressure, s = o.state.deviator.zz;
  o.go_to(0.095);
  EXPECT_NEAR(o.state.deviator.zz, s - o.elastic_change(o.state.pressure - p), tolerance);
  o.go_to(0.1);
  EXPECT_NEAR(o.state.pressure, o.virgin * 0.1, 1e-6 * o.virgin);
  o.go_to(0.13);
  EXPECT_NEAR(o.state.pressure, o.virgin * 0.13, 1e-6 * o.virgin);
  EXPECT_NEAR(o.state.deviator.zz, -o.yielding(o.state.pressure), tolerance);
}

TEST(UniaxialStrain, TearsAtTheCutoffAndLosesItsShear) {
  Oedometer o;
  o.go_to(0.05);
  o.go_to(-0.05);
  EXPECT_EQ(o.state.pressure, -o.cutoff);
  EXPECT_EQ(double_dot(o.state.deviator, o.state.deviator), 0);
}

TEST(UniaxialStrain, StressWorkIsTheAreaUnderTheStressStrainCurve) {
  Oedometer o;
  double work = 0, area = 0, dissipated = 0, before = 0;
  for (const double strain : {1e-4, -1e-4, 1e-4})
    for (int n = 0; n < 600; ++n) {
      const SoilWork step = update_soil(o.law, {{0, 0, -strain, 0, 0, 0}, {}}, o.state);
      const double stress = o.state.deviator.zz - o.state.pressure;
      area += 0.5 * (before + stress) * -strain;
      before = stress;
      work += step.total;
      dissipated += step.dissipated;
    }
  EXPECT_NEAR(work, area, 1e-9 * area);
  EXPECT_GT(dissipated, 0);
  EXPECT_LT(dissipated, work);
}

}  // namespace
}  // namespace tuft::sph
