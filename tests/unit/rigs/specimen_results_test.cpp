// What is read from the rows of oedometer and direct shear, on rows made up.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rigs/direct_shear.h"
#include "rigs/oedometer.h"

namespace tuft::rigs {
namespace {

/// Up along stress = 10 MPa x strain to 0.05, down along 20 MPa.
std::vector<OedometerRow> triangle(double end_stress) {
  std::vector<OedometerRow> rows;
  const auto add = [&](double strain, double stress, double direction) {
    OedometerRow row;
    row.strain = strain;
    row.stress = stress;
    row.force = 1e-3 * stress;
    row.direction = direction;
    rows.push_back(row);
  };
  for (int i = 0; i <= 100; ++i) add(5e-4 * i, 5e3 * i, 1);
  for (double stress = 495e3; stress >= end_stress; stress -= 5e3)
    add(0.05 - (500e3 - stress) / 20e6, stress, -1);
  return rows;
}

TEST(OedometerResults, GiveModuliLossAndResidualStrainOfATriangle) {
  const CycleResults r = evaluate_cycle(triangle(0), 5);
  EXPECT_NEAR(*r.loading_modulus, 10e6, 1);
  EXPECT_NEAR(*r.unloading_modulus, 20e6, 1);
  EXPECT_NEAR(*r.loss, 0.5, 1e-12);
  EXPECT_NEAR(*r.residual_strain, 0.025, 1e-12);
  EXPECT_NEAR(r.peak_force, 500, 1e-9);
  EXPECT_NEAR(r.peak_strain, 0.05, 1e-12);
}

TEST(OedometerResults, LeaveOutWhatACycleDidNotComeTo) {
  const CycleResults r = evaluate_cycle(triangle(200e3), 5);
  EXPECT_TRUE(r.loading_modulus.has_value());
  EXPECT_FALSE(r.unloading_modulus.has_value());
  EXPECT_FALSE(r.loss.has_value());
  EXPECT_FALSE(r.residual_strain.has_value());
  EXPECT_FALSE(loading_secant(triangle(0), 100e3, 600e3).has_value()) << "600 kPa was not reached";
  EXPECT_NEAR(*loading_secant(triangle(0), 100e3, 400e3), 10e6, 1);
}

std::vector<ShearRow> shear_rows(double until) {
  std::vector<ShearRow> rows(3);  // of the normal load: no part of the shearing
  rows.back().shear_stress = 1e9;
  for (double strain = 0; strain <= until * (1 + 1e-9); strain += 1e-3) {
    ShearRow row;
    row.shearing = 1;
    row.shear_strain = strain;
    row.shear_stress = strain < 0.05 ? 2e6 * strain : 80e3 + 1e5 * (0.12 - strain);
    row.displacement = 0.05 * strain;
    row.plane_stress = 101e3;
    rows.push_back(row);
  }
  return rows;
}

TEST(ShearResults, ReadTheYieldOverTheWindowBeforeTheYieldStrain) {
  const ShearResults r = evaluate_shear(shear_rows(0.12), 0.12);
  ASSERT_TRUE(r.yield_stress.has_value());
  EXPECT_NEAR(*r.yield_stress, 80e3 + 1e5 * yield_window / 2, 1);
  EXPECT_NEAR(r.displacement, 0.05 * (0.12 - yield_window / 2), 1e-9);
  EXPECT_NEAR(*r.plane_stress, 101e3, 1e-6);
  EXPECT_NEAR(r.peak_stress, 98e3, 1) << "at the end of the elastic part, not under the normal load";
}

TEST(ShearResults, GiveNoYieldBeforeTheYieldStrain) {
  EXPECT_FALSE(evaluate_shear(shear_rows(0.11), 0.12).yield_stress.has_value());
}

TEST(MohrCoulombLine, PassesThroughPointsOnALineAndSaysHowFarOthersAre) {
  const double phi = 30 * std::numbers::pi / 180;
  const std::vector<double> normal{100e3, 200e3, 300e3};
  std::vector<double> shear;
  for (const double n : normal) shear.push_back(15e3 + n * std::tan(phi));
  const auto line = fit_mohr_coulomb(normal, shear);
  ASSERT_TRUE(line.has_value());
  EXPECT_NEAR(line->cohesion, 15e3, 1e-6);
  EXPECT_NEAR(line->friction_angle, phi, 1e-12);
  EXPECT_NEAR(line->largest_misfit, 0, 1e-6);
  shear[1] += 3e3;
  EXPECT_NEAR(fit_mohr_coulomb(normal, shear)->largest_misfit, 2e3, 1e-6);
  EXPECT_FALSE(fit_mohr_coulomb({normal.data(), 1}, {shear.data(), 1}).has_value());
  const std::vector<double> same{100e3, 100e3};
  EXPECT_FALSE(fit_mohr_coulomb(same, {shear.data(), 2}).has_value());
}

}  // namespace
}  // namespace tuft::rigs
