/// Objectivity: rigid rotation turns stress and does nothing else.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

TEST(Objectivity, AStressedPointTurnedByNinetyDegreesKeepsItsStressInItsOwnFrame) {
  const SoilLaw law = make_soil_law(test::elastic_material(1e6, 1000));
  for (const int steps : {2, 9, 500}) {
    SoilState state = reference_state(law);
    update_soil(law, {{-0.01, 0.004, -0.02, 0.003, -0.005, 0.001}, {}}, state);
    const Mat3 before = to_matrix(state.deviator);
    const double pressure = state.pressure;
    const Vec3 axis = Vec3(1, -2, 0.5).normalized();
    const double dt = 1e-4;
    const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2 / steps, axis).toRotationMatrix();
    // v = (x_end - x_begin)/dt = (1 - R^T) x_end/dt.
    const Mat3 gradient = (Mat3::Identity() - turn.transpose()) / dt;
    for (int k = 0; k < steps; ++k) update_soil(law, strain_step(gradient, dt), state);
    const Mat3 whole = Eigen::AngleAxisd(std::numbers::pi / 2, axis).toRotationMatrix();
    EXPECT_LT((to_matrix(state.deviator) - whole * before * whole.transpose()).norm(), 1e-10 * before.norm());
    EXPECT_NEAR(state.pressure, pressure, 1e-9 * pressure);
  }
}

class SpunBlob : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, SpunBlob, testing::Values(test::Preset::accurate, test::Preset::paper));

/// The particles' own loops on a prescribed rotation: every particle's stress turns, free surfaces included.
TEST_P(SpunBlob, EveryParticleKeepsItsStressInItsOwnFrame) {
  const Lattice lattice = test::block(7, 7, 7, pitch);
  const std::size_t n = lattice.position.size();
  LoopSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  settings.laws = {make_soil_law(test::elastic_material(1e6, 1000))};
  settings.artificial_viscosity = false;
  const SymmetricTensor stress{3e4, -1e4, -2e4, 5e3, -7e3, 1e3};
  Particles p;
  p.assign(n, settings.options.smoothing_length);
  p.position = lattice.position;
  p.volume = p.reference_volume = lattice.volume;
  for (std::size_t i = 0; i < n; ++i) {
    p.mass[i] = 1000 * lattice.volume[i];
    SoilState state = reference_state(settings.laws[0]);
    state.deviator = stress;
    p.set_soil_state(i, state);
  }
  const int steps = 60;
  const double dt = 1e-4;
  const Vec3 axis = Vec3(0.3, 1, -0.4).normalized();
  NeighbourList list(p.position, 2 * settings.options.smoothing_length, 0.1 * pitch);
  std::vector<StressSums> blocks(block_count(p));
  for (int k = 1; k <= steps; ++k) {
    const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2 * k / steps, axis).toRotationMatrix();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 now = turn * lattice.position[i];
      p.velocity.set(i, (now - p.position[i]) / dt);
      p.position.set(i, now);
    }
    p.record_motion();
    list.build(p.position);
    const StressSums sums = update_stress(settings, list, dt, p, blocks);
    ASSERT_TRUE(sums.valid);
  }
  const Mat3 whole = Eigen::AngleAxisd(std::numbers::pi / 2, axis).toRotationMatrix();
  const Mat3 expected = whole * to_matrix(stress) * whole.transpose();
  for (std::size_t i = 0; i < n; ++i) {
    const SoilState state = p.soil_state(i);
    EXPECT_LT((to_matrix(state.deviator) - expected).norm(), 1e-5 * expected.norm()) << "particle " << i;
    EXPECT_NEAR(state.compression, 0, 5e-7);
  }
}

/// A free block that turns by ninety degrees keeps its shape and spin, but for the small strains of its own
/// centrifugal load, rho w^2 R^2 / K = 1e-4.
TEST_P(SpunBlob, AFreeSpinningBlockKeepsItsShapeAndAngularMomentum) {
  const Lattice lattice = test::block(6, 6, 6, pitch);
  SphSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = false;
  SphInfill infill(lattice, test::single_material(test::elastic_material(1e6, 1000)), settings);
  const Vec3 centre(0, 0, 3 * pitch), spin(0, 30, 0);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    infill.set_velocity(i, spin.cross(lattice.position[i] - centre));
  const double whole = std::numbers::pi / 2 / spin.norm();
  const int steps = static_cast<int>(std::ceil(whole / (0.8 * infill.stable_step())));
  infill.advance(whole, steps, {});
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi / 2, spin.normalized()).toRotationMatrix();
  double worst = 0;
  Vec3 momentum(0, 0, 0), before(0, 0, 0);
  const ParticleView p = infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    worst = std::max(worst, (p.position(i) - centre - turn * (lattice.position[i] - centre)).norm());
    momentum += p.mass[i] * (p.position(i) - centre).cross(p.velocity(i));
    before += p.mass[i] * (lattice.position[i] - centre).cross(spin.cross(lattice.position[i] - centre));
  }
  RecordProperty("worst_over_pitch", testing::PrintToString(worst / pitch));
  EXPECT_LT(worst, 0.01 * pitch);
  EXPECT_LT((momentum - before).norm(), 1e-3 * before.norm());
}

}  // namespace
}  // namespace tuft::sph
