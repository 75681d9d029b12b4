#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <numbers>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "fe_carpet/orthotropic.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

ShellMaterial cloth() {
  ShellMaterial material{200e6, 0.3, 950};
  material.across_young_modulus = 50e6;
  material.shear_modulus = 8e6;
  return material;
}

Mat3 matrix(const OrthotropicLaw<double>& q) {
  Mat3 m;
  m << q.q11, q.q12, q.q16, q.q12, q.q22, q.q26, q.q16, q.q26, q.q66;
  return m;
}

/// Young's modulus in the element's direction 1: 1 / S_11.
double modulus_at(double angle) {
  return 1 / matrix(orthotropic_law(cloth(), angle)).inverse()(0, 0);
}

TEST(Orthotropic, YoungsModulusFollowsTheClosedFormInEveryDirection) {
  const ShellMaterial m = cloth();
  for (double angle = 0; angle < std::numbers::pi; angle += 0.1) {
    const double c = std::cos(angle), s = std::sin(angle);
    const double compliance = std::pow(c, 4) / m.young_modulus + std::pow(s, 4) / m.across_young_modulus +
                              c * c * s * s * (1 / m.shear_modulus - 2 * m.poisson_ratio / m.young_modulus);
    EXPECT_NEAR(modulus_at(angle) * compliance, 1, 1e-12) << angle;
  }
}

TEST(Orthotropic, ComplianceIsTheInverseOfTheStiffnessInEveryDirection) {
  for (const double angle : {-1.0, 0.0, 0.3, 0.8, 1.5, 2.5}) {
    const OrthotropicLaw<double> q = orthotropic_law(cloth(), angle);
    Mat3 s;
    s << q.s11, q.s12, q.s16, q.s12, q.s22, q.s26, q.s16, q.s26, q.s66;
    EXPECT_LT((s * matrix(q) - Mat3::Identity()).norm(), 1e-12) << angle;
  }
}

TEST(Orthotropic, AFibreStrainedByOneIsInUniaxialStressOfItsModulus) {
  const double angle = 0.7, c = std::cos(angle), s = std::sin(angle);
  const OrthotropicLaw<double> law = orthotropic_law(cloth(), 0.2);
  const PlaneStrain<double> e = law.fibre_strain(3 * c, 3 * s);
  EXPECT_NEAR(c * c * e.xx + s * s * e.yy + c * s * e.xy, 1, 1e-12);
  const PlaneStress<double> stress = law.stress(e.xx, e.yy, e.xy);
  const double modulus = modulus_at(0.2 - angle);
  EXPECT_NEAR(stress.xx / modulus, c * c, 1e-12);
  EXPECT_NEAR(stress.yy / modulus, s * s, 1e-12);
  EXPECT_NEAR(stress.xy / modulus, c * s, 1e-12);
}

TEST(Orthotropic, StressInTurnedAxesIsTheTurnedStress) {
  const OrthotropicLaw<double> own = orthotropic_law(cloth(), 0);
  const double exx = 1e-3, eyy = -4e-4, gxy = 7e-4;
  for (const double angle : {-0.9, 0.5, 2.0}) {
    const double c = std::cos(angle), s = std::sin(angle);
    const PlaneStress<double> t =
        own.stress(c * c * exx + s * s * eyy + c * s * gxy, s * s * exx + c * c * eyy - c * s * gxy,
                   2 * c * s * (eyy - exx) + (c * c - s * s) * gxy);
    const PlaneStress<double> a = orthotropic_law(cloth(), angle).stress(exx, eyy, gxy);
    EXPECT_NEAR(a.xx, c * c * t.xx + s * s * t.yy - 2 * c * s * t.xy, 1e-6);
    EXPECT_NEAR(a.yy, s * s * t.xx + c * c * t.yy + 2 * c * s * t.xy, 1e-6);
    EXPECT_NEAR(a.xy, c * s * (t.xx - t.yy) + (c * c - s * s) * t.xy, 1e-6);
  }
}

TEST(Orthotropic, WithEqualModuliIsTheIsotropicLaw) {
  ShellMaterial m{200e6, 0.3, 950};
  m.across_young_modulus = m.young_modulus;
  m.shear_modulus = m.young_modulus / 2.6;
  const IsotropicLaw isotropic = instantaneous_law(m);
  for (const double angle : {0.0, 0.4, 1.3}) {
    const PlaneStress<double> a = orthotropic_law(m, angle).stress(1e-3, -2e-3, 3e-3);
    const PlaneStress<double> b = isotropic.stress(1e-3, -2e-3, 3e-3);
    EXPECT_NEAR(a.xx / b.xx, 1, 1e-12);
    EXPECT_NEAR(a.yy / b.yy, 1, 1e-12);
    EXPECT_NEAR(a.xy / b.xy, 1, 1e-12);
    const PlaneStrain<double> e = orthotropic_law(m, angle).fibre_strain(0.3, 0.7);
    const PlaneStrain<double> f = isotropic.fibre_strain(0.3, 0.7);
    EXPECT_NEAR(e.xx, f.xx, 1e-12);
    EXPECT_NEAR(e.yy, f.yy, 1e-12);
    EXPECT_NEAR(e.xy, f.xy, 1e-12);
  }
}

TEST(Orthotropic, TheBoundIsStifferInEveryStrain) {
  const IsotropicLaw b = stiffer_isotropic_law(cloth());
  Mat3 bound;
  bound << b.direct, b.coupled, 0, b.coupled, b.direct, 0, 0, 0, b.shear;
  for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
    const Mat3 difference = bound - matrix(orthotropic_law(cloth(), angle));
    EXPECT_GE(Eigen::SelfAdjointEigenSolver<Mat3>(difference).eigenvalues().minCoeff(), -1e-6) << angle;
  }
}

/// Axial swing of a strip along x with the cloth's stitch turned: period^-2 goes with the modulus that way.
double first_axial_frequency_squared(double turned, ElementKind element) {
  const Strip strip = make_strip({0.04, 0.002, 0.0005, 16, 2}, true);
  ShellMaterial material = cloth();
  material.along = {std::cos(turned), std::sin(turned), 0};
  CarpetOptions options = no_gravity();
  options.section.element = element;
  Carpet carpet(strip.mesh, {material}, options);
  const double dt = 0.5 * carpet.stable_step();
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    if (!strip.mesh.clamped[n])
      carpet.set_velocity(n, Vec3(1e-4 * std::sin(std::numbers::pi / 2 * strip.mesh.nodes.x[n] / 0.04), 0, 0),
                          Vec3(0, 0, 0));
  const Vec3Array load = no_load(strip.node_count());
  const auto tip = static_cast<std::size_t>(strip.node(16, 1));
  // Velocities belong to the middles of the steps, the first half a step before the start.
  double before = carpet.nodes().vx[tip], time = -0.5 * dt;
  while (time < 1) {
    carpet.step(dt, load);
    const double now = carpet.nodes().vx[tip];
    if (now <= 0) break;
    before = now;
    time += dt;
  }
  const double quarter = time + dt * before / (before - carpet.nodes().vx[tip]);
  return std::pow(std::numbers::pi / 2 / quarter, 2);
}

TEST(Orthotropic, AStripSwingsByTheModulusAlongIt) {
  for (const ElementKind element : {ElementKind::one_point, ElementKind::fully_integrated}) {
    const double wave = std::pow(std::numbers::pi / 2 / 0.04, 2) / 950;
    EXPECT_NEAR(first_axial_frequency_squared(0, element) / (wave * 200e6), 1, 0.02);
    EXPECT_NEAR(first_axial_frequency_squared(std::numbers::pi / 2, element) / (wave * 50e6), 1, 0.02);
  }
}

TEST(Orthotropic, ImpossibleConstantsAreRefused) {
  const Strip strip = make_strip({}, true);
  const auto refused = [&](const ShellMaterial& material) {
    try {
      const Carpet carpet(strip.mesh, {material}, no_gravity());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ShellMaterial m = cloth();
  m.shear_modulus = 0;
  EXPECT_NE(refused(m).find("shear modulus is 0"), std::string::npos) << refused(m);
  m = cloth();
  m.across_young_modulus = 100 * m.young_modulus;
  EXPECT_NE(refused(m).find("under 0.5"), std::string::npos) << refused(m);
  m = cloth();
  m.relaxation = {{1e6, 10}};
  EXPECT_NE(refused(m).find("not supported"), std::string::npos) << refused(m);
  m = cloth();
  m.along = {0, 0, 1};
  EXPECT_NE(refused(m).find("upright on element 0"), std::string::npos) << refused(m);
}

}  // namespace
}  // namespace tuft::fe::test
