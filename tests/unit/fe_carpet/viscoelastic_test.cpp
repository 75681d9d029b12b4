#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fe_carpet/viscoelastic.h"

namespace tuft::fe::test {
namespace {

/// Published for slit film: 0.061, 0.0663, 0.2 GPa with decays 0, 10, 1000 1/s (Bustamante et al. 2024);
/// Poisson's ratio assumed.
ShellMaterial slit_film() {
  const double nu = 0.42, shear = 0.3273e9;
  return {2 * shear * (1 + nu), nu, 920, {{0.0663e9, 10}, {0.2e9, 1000}}};
}

struct Point {
  explicit Point(const ShellMaterial& material) : law(viscoelastic_law(material)) {
    rows.assign(law.plane_rows(), 0.0);
    shear_rows.assign(law.shear_rows(), 0.0);
  }
  PlaneStress<double> strain(const PlaneStrain<double>& de, double dt) {
    law.set_step(dt);
    const PlaneAdvance<double> a = law.advance<double>(PointRows<double>{rows.data()}, de);
    work += power(a.mean, de);
    trace += de.xx + de.yy + a.thickness_strain;
    return a.stress;
  }
  double shear(double dg, double dt) {
    law.set_step(dt);
    return law.advance_shear<double>(PointRows<double>{shear_rows.data()}, dg).stress;
  }
  ViscoelasticLaw law;
  std::vector<double> rows, shear_rows;
  double work = 0;   ///< J/m^3
  double trace = 0;  ///< volume strain
};

double relaxation_modulus(double t) {
  return 0.061e9 + 0.0663e9 * std::exp(-10 * t) + 0.2e9 * std::exp(-1000 * t);
}

TEST(Viscoelastic, ShearStressAfterAStepFollowsThePronySeries) {
  Point point(slit_film());
  const double gamma = 0.01, dt = 1e-5;
  point.strain({0, 0, gamma}, 0);
  double t = 0, transverse = 0;
  point.shear(gamma, 0);
  for (int i = 0; i < 20000; ++i) {
    const PlaneStress<double> s = point.strain({0, 0, 0}, dt);
    transverse = point.shear(0, dt);
    t += dt;
    ASSERT_NEAR(s.xy / (gamma * relaxation_modulus(t)), 1, 1e-9) << t;
  }
  EXPECT_NEAR(transverse / (shear_correction * gamma * relaxation_modulus(t)), 1, 1e-9);
}

TEST(Viscoelastic, ShearStressOnARampIsTheClosedFormWhateverTheStep) {
  for (const double dt : {1e-5, 1e-3, 0.05}) {
    Point point(slit_film());
    const double rate = 0.3, end = 0.1;
    PlaneStress<double> s{};
    for (int i = 0; i < std::lround(end / dt); ++i) s = point.strain({0, 0, rate * dt}, dt);
    const double expected = rate * (0.061e9 * end + 0.0663e9 / 10 * (1 - std::exp(-10 * end)) +
                                    0.2e9 / 1000 * (1 - std::exp(-1000 * end)));
    EXPECT_NEAR(s.xy / expected, 1, 1e-9) << dt;
  }
}

TEST(Viscoelastic, InstantaneousResponseIsTheElasticLawOfTheInstantaneousModuli) {
  Point point(slit_film());
  const PlaneStrain<double> e{0.003, -0.001, 0.002};
  const PlaneStress<double> s = point.strain(e, 0);
  const PlaneStress<double> elastic = instantaneous_law(slit_film()).stress(e.xx, e.yy, e.xy);
  EXPECT_NEAR(s.xx / elastic.xx, 1, 1e-12);
  EXPECT_NEAR(s.yy / elastic.yy, 1, 1e-12);
  EXPECT_NEAR(s.xy / elastic.xy, 1, 1e-12);
}

TEST(Viscoelastic, LongTermResponseIsTheElasticLawOfTheLongTermShearAndTheBulkModulus) {
  Point point(slit_film());
  const PlaneStrain<double> e{0.003, -0.001, 0.002};
  point.strain(e, 0);
  PlaneStress<double> s{};
  for (int i = 0; i < 100; ++i) s = point.strain({0, 0, 0}, 0.1);
  const double shear = 0.061e9, bulk = point.law.bulk;
  const double nu = (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
  const PlaneStress<double> elastic = isotropic_law(2 * shear * (1 + nu), nu).stress(e.xx, e.yy, e.xy);
  EXPECT_NEAR(s.xx / elastic.xx, 1, 1e-9);
  EXPECT_NEAR(s.yy / elastic.yy, 1, 1e-9);
  EXPECT_NEAR(s.xy / elastic.xy, 1, 1e-9);
}

TEST(Viscoelastic, StressThroughTheThicknessStaysZero) {
  // With s_zz + p = 0 the mean of the in-plane stresses is 3/2 p, and p = K tr e.
  Point point(slit_film());
  for (int i = 0; i < 500; ++i) {
    const double phase = 0.05 * i;
    const PlaneStress<double> s = point.strain(
        {1e-4 * std::sin(phase), 1e-4 * std::cos(1.7 * phase), 1e-4 * std::sin(2.3 * phase)}, 1e-4);
    EXPECT_NEAR((s.xx + s.yy) / 3, point.law.bulk * point.trace, 1e-9 * 1e6);
  }
}

TEST(Viscoelastic, ForcesOfUniaxialStressRelaxAsTheLawDoesWithFreeSides) {
  ViscoelasticLaw law = viscoelastic_law(slit_film());
  law.set_step(2e-4);
  std::vector<double> plane(law.plane_rows(), 0.0), uniaxial(law.shear_rows(), 0.0);
  for (int i = 0; i < 300; ++i) {
    const double along = i < 50 ? 1e-4 : 2e-5 * std::sin(0.3 * i);
    // The stress across is linear in the strain across: two trials give the one that leaves it free.
    const auto across = [&](double strain) {
      std::vector<double> rows = plane;
      return law.advance(PointRows<double>{rows.data()}, PlaneStrain<double>{along, strain, 0}).stress.yy;
    };
    const double at_zero = across(0), slope = (across(1e-4) - at_zero) / 1e-4;
    const double stress =
        law.advance(PointRows<double>{plane.data()}, PlaneStrain<double>{along, -at_zero / slope, 0})
            .stress.xx;
    const ShearAdvance<double> a =
        law.relax_uniaxial(PointRows<double>{uniaxial.data()}, slit_film().young_modulus * along);
    ASSERT_NEAR(a.stress / stress, 1, 1e-9) << i;
  }
}

TEST(Viscoelastic, AClosedCycleOfStrainDissipates) {
  for (const double rate : {1.0, 30.0, 1000.0, 30000.0}) {
    Point point(slit_film());
    const double amplitude = 0.01;
    constexpr int steps = 2000;
    double before = 0, first_cycle = 0;
    for (int i = 1; i <= 2 * steps; ++i) {
      const double now = amplitude * std::sin(2 * std::numbers::pi * i / steps);
      point.strain({now - before, 0, 0}, 2 * std::numbers::pi / rate / steps);
      before = now;
      if (i == steps) first_cycle = point.work;
    }
    EXPECT_GT(point.work - first_cycle, 0) << rate;
  }
}

TEST(Viscoelastic, TermsWithoutDecayAreElastic) {
  ShellMaterial material = slit_film();
  material.relaxation = {{0.2e9, 0}};
  Point point(material);
  const IsotropicLaw elastic = instantaneous_law(material);
  PlaneStress<double> s{};
  for (int i = 0; i < 1000; ++i) s = point.strain({1e-5, -3e-6, 2e-6}, 1e-3);
  const PlaneStress<double> expected = elastic.stress(1e-2, -3e-3, 2e-3);
  EXPECT_NEAR(s.xx / expected.xx, 1, 1e-10);
  EXPECT_NEAR(s.yy / expected.yy, 1, 1e-10);
  EXPECT_NEAR(s.xy / expected.xy, 1, 1e-10);
}

}  // namespace
}  // namespace tuft::fe::test
