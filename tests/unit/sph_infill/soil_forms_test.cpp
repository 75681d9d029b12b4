// The forms in which parts of the soil law can be given, and where curves end.
#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "sph_infill/soil_law.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

/// K0 1.5 MPa, b 10, tabulated up to `last` Pa in `points` points.
Curve tabulated(double last, int points) {
  Curve curve;
  const double end = std::log1p(10 * last / 1.5e6) / 10;
  for (int k = 0; k < points; ++k) {
    const double e = end * k / (points - 1);
    curve.x.push_back(e);
    curve.y.push_back(k + 1 == points ? last : 1.5e5 * std::expm1(10 * e));
  }
  return curve;
}

SoilFoamMaterial closed_form() {
  SoilFoamMaterial m = test::mixture_material();
  m.pressure = m.unloading = {};
  m.pressure_exponential = ExponentialCompression{1.5e6, 10};
  m.unloading_ratio = 1.2;
  return m;
}

TEST(ClosedForm, OfFirstLoadingIsExactAtEveryPressure) {
  const SoilLaw law = make_soil_law(closed_form());
  for (const double e : {1e-6, 0.01, 0.17, 0.6}) {
    const auto point = law.virgin(e);
    EXPECT_NEAR(point.value, 1.5e5 * std::expm1(10 * e), 1e-14 * point.value);
    EXPECT_NEAR(point.derivative, 1.5e6 * std::exp(10 * e), 1e-14 * point.derivative);
  }
}

TEST(ClosedForm, OfUnloadingIsTheRatioTimesTheSlopeOfFirstLoadingAtThatPressure) {
  SoilFoamMaterial m = closed_form();
  const SoilLaw law = make_soil_law(m);
  for (const double p : {0.0, 1e3, 6e5, 5e6})
    EXPECT_NEAR(law.elastic(law.elastic.argument(p)).derivative, 1.2 * (1.5e6 + 10 * p), 1e-3);
  m.pressure = tabulated(667e3, 12);  // of a table: of its straight pieces
  m.pressure_exponential.reset();
  const SoilLaw of_table = make_soil_law(m);
  const double p = 0.5 * (m.pressure.y[4] + m.pressure.y[5]),
               slope = (m.pressure.y[5] - m.pressure.y[4]) / (m.pressure.x[5] - m.pressure.x[4]);
  EXPECT_NEAR(of_table.elastic(of_table.elastic.argument(p)).derivative, 1.2 * slope, 1e-6 * slope);
}

TEST(ClosedForm, IsWhatItsTableConvergesTo) {
  SoilFoamMaterial m = closed_form();
  const SoilLaw exact = make_soil_law(m);
  m.pressure_exponential.reset();
  double before = 1;
  for (const int points : {9, 17, 33}) {
    m.pressure = tabulated(667e3, points);
    const SoilLaw table = make_soil_law(m);
    double worst = 0;
    for (double e = 0.001; e < 0.168; e += 0.001)
      worst = std::max(worst, std::abs(table.virgin(e).value - exact.virgin(e).value) / 667e3);
    EXPECT_LT(worst, before / 3.5) << points;  // second order
    before = worst;
  }
}

/// Mean pressure under the missile at its published peaks (53.1 g and 72.3 g) against the last point of the
/// published oedometer tests (1500 N on 53.5 mm).
TEST(BeyondTheLastPoint, PressuresUnderTheMissileFollowTheCurveThatTheTableWasTakenFrom) {
  SoilFoamMaterial m = closed_form();
  m.pressure_exponential.reset();
  m.pressure = tabulated(667e3, 12);
  const SoilLaw law = make_soil_law(m);
  const auto strain_at = [](double p) { return std::log1p(10 * p / 1.5e6) / 10; };
  EXPECT_NEAR(law.virgin(strain_at(597e3)).value, 597e3, 0.005 * 597e3);
  EXPECT_NEAR(law.virgin(strain_at(813e3)).value, 813e3, 0.01 * 813e3);
  const double slope_597 = law.virgin(strain_at(597e3)).derivative,
               slope_813 = law.virgin(strain_at(813e3)).derivative;
  EXPECT_GT(slope_813, 1.1 * slope_597) << "goes on stiffening";
  EXPECT_NEAR(slope_813, 1.5e6 + 10 * 813e3, 0.02 * slope_813);
  // And so does unloading from there.
  const double unloading = law.elastic(law.elastic.argument(813e3)).derivative;
  EXPECT_GE(unloading, slope_813 * (1 - 1e-12));
}

TEST(MohrCoulomb, IsMatchedWhereItSays) {
  const double phi = 0.5, c = 10e3, p = 2e5;
  const auto strength = [&](ConeMatch match) {
    SoilFoamMaterial m = closed_form();
    m.yield_a0 = m.yield_a1 = m.yield_a2 = 0;
    m.mohr_coulomb = MohrCoulombStrength{c, phi, match};
    const SoilLaw law = make_soil_law(m);
    return std::sqrt(law.yield_a0 + p * (law.yield_a1 + p * law.yield_a2));
  };
  // Shear stress on a plane under the normal stress p, all three normal stresses being p.
  EXPECT_NEAR(strength(ConeMatch::pure_shear), c + p * std::tan(phi), 1e-6 * p);
  // Axial stress s1 over lateral s3 with (s1 - s3)/2 = c cos + (s1 + s3)/2 sin, and p = (s1 + 2 s3)/3.
  const double sine = std::sin(phi), q = 6 * (c * std::cos(phi) + p * sine) / (3 - sine);
  const double s3 = p - q / 3, s1 = s3 + q;
  ASSERT_NEAR((s1 - s3) / 2, c * std::cos(phi) + (s1 + s3) / 2 * sine, 1e-6 * p);
  EXPECT_NEAR(strength(ConeMatch::triaxial_compression), q / std::numbers::sqrt3, 1e-6 * p);
  // Plane strain with the cone's own, associated flow: no strain along z fixes s_zz, and then (s1 - s3)/2 = c
  // cos + (s1 + s3)/2 sin. Flow n = s/(2 sqrt(J2)) + alpha/3 in sums of stresses, n_zz = 0: s_zz = -(2/3)
  // alpha sqrt(J2) (tension positive).
  const double tangent = std::tan(phi), alpha = 3 * tangent / std::sqrt(9 + 12 * tangent * tangent),
               k = 3 * c / std::sqrt(9 + 12 * tangent * tangent);
  const double root = strength(ConeMatch::plane_strain);
  ASSERT_NEAR(root, k + alpha * p, 1e-6 * p);
  const double szz = -2.0 / 3 * alpha * root, radius = std::sqrt(root * root - 0.75 * szz * szz);
  const double mean = p + 0.5 * szz;  // of the two stresses in the plane, compression positive
  EXPECT_NEAR(radius, c * std::cos(phi) + mean * sine, 1e-6 * p);
}

void expect_rejected(const SoilFoamMaterial& material, const std::string& words) {
  try {
    (void)make_soil_law(material);
    FAIL() << "accepted, expected: " << words;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Forms, GivenTwiceOrOutOfRangeAreRefused) {
  const SoilFoamMaterial good = closed_form();
  SoilFoamMaterial m = good;
  m.pressure = tabulated(1e5, 5);
  expect_rejected(m, "first loading is given by a pressure curve and by pressure_exponential");
  m = good;
  m.unloading = {{0}, {1e6}};
  expect_rejected(m, "unloading is given by a curve and by unloading_ratio");
  m = good;
  m.mohr_coulomb = MohrCoulombStrength{1e3, 0.5, ConeMatch::pure_shear};
  expect_rejected(m, "strength is given by mohr_coulomb and by yield_a0");
  m = good;
  m.unloading_ratio = 0.9;
  expect_rejected(m, "unloading_ratio is 0.9");
  m = good;
  m.pressure_exponential->growth = 0;
  expect_rejected(m, "pressure_exponential.growth is 0");
  m = good;
  m.yield_a0 = m.yield_a1 = m.yield_a2 = 0;
  m.mohr_coulomb = MohrCoulombStrength{1e3, 2, ConeMatch::pure_shear};
  expect_rejected(m, "mohr_coulomb.friction_angle is 2 rad");
}

}  // namespace
}  // namespace tuft::sph
