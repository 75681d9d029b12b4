/// The corrected kernel gradient, and the force that is its variational partner.
#include <gtest/gtest.h>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

struct Cloud {
  LoopSettings settings;
  Particles particles;
  NeighbourList list;

  Cloud(test::Preset preset, double jitter_share) {
    Lattice lattice = test::block(8, 8, 8, pitch);
    test::jitter(lattice, jitter_share);
    settings.options = test::options_of(preset, pitch);
    particles.assign(lattice.position.size(), settings.options.smoothing_length);
    particles.position = lattice.position;
    particles.volume = particles.mass = lattice.volume;
    particles.record_motion();
    list = NeighbourList(lattice.position, 2 * settings.options.smoothing_length, 0.2 * pitch);
    list.build(lattice.position);
  }
};

class VelocityGradient : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, VelocityGradient,
                         testing::Values(test::Preset::accurate, test::Preset::fast, test::Preset::paper));

TEST_P(VelocityGradient, OfALinearFieldIsExactInsideAndAtFreeSurfacesOfAJitteredLattice) {
  // At this jitter every particle of both presets, corners included, keeps all eigenvalues of its moment over
  // the safeguard's bound; see the next test for what lies below it.
  Mat3 exact;
  exact << 10, -3, 7, 4, -20, 5, 1, 8, 12;
  for (const Vec3& drift : {Vec3(0, 0, 0), Vec3(3, -1, 2)}) {
    Cloud cloud(GetParam(), 0.05);
    for (std::size_t i = 0; i < cloud.particles.size(); ++i)
      cloud.particles.velocity.set(i, drift + exact * cloud.particles.position[i]);
    cloud.particles.record_motion();
    double worst = 0;
    for (std::size_t i = 0; i < cloud.particles.size(); ++i) {
      const GradientSums sums = sum_gradients(cloud.settings, cloud.list, cloud.particles, i);
      const Mat3 gradient = sums.velocity * to_matrix(correction_matrix(sums.moment));
      worst = std::max(worst, (gradient - exact).norm() / exact.norm());
    }
    RecordProperty(drift.isZero() ? "worst_relative_error" : "worst_relative_error_in_drift",
                   testing::PrintToString(worst));
    // Rounding of pairs to single precision, and of velocities: the drift's, over a pitch and |L|.
    const double of_velocity = std::ldexp(drift.norm(), -24) / (pitch * exact.norm());
    EXPECT_LT(worst, 2e-6 + 2 * of_velocity);
  }
}

TEST_P(VelocityGradient, OfPoorlySupportedParticlesIsExactInTheirSupportedDirectionsAndNeverLarger) {
  Cloud cloud(GetParam(), 0);
  // A single line of particles along x, far from each other's neighbourhoods in y and z.
  for (std::size_t i = 0; i < cloud.particles.size(); ++i)
    cloud.particles.position.set(i, {0.7 * pitch * static_cast<double>(i), 0, 0});
  cloud.list = NeighbourList(cloud.particles.position, 2 * cloud.settings.options.smoothing_length, 0);
  cloud.list.build(cloud.particles.position);
  Mat3 exact;
  exact << 10, -3, 7, 4, -20, 5, 1, 8, 12;
  for (std::size_t i = 0; i < cloud.particles.size(); ++i)
    cloud.particles.velocity.set(i, exact * cloud.particles.position[i]);
  cloud.particles.record_motion();
  const GradientSums sums = sum_gradients(cloud.settings, cloud.list, cloud.particles, 100);
  const Mat3 gradient = sums.velocity * to_matrix(correction_matrix(sums.moment));
  EXPECT_LT((gradient.col(0) - exact.col(0)).norm(), 1e-5 * exact.norm());
  EXPECT_LT(gradient.rightCols(2).norm(), 1e-5 * exact.norm());
}

TEST_P(VelocityGradient, IsThePartnerOfTheForceSoThatPowersAgreeForAnyVelocity) {
  // sum f.v = -sum V sigma : L for random stress, positions and velocities, from one real step of the loops.
  Lattice lattice = test::block(7, 7, 7, pitch);
  test::jitter(lattice, 0.1);
  const std::size_t n = lattice.position.size();
  LoopSettings settings;
  settings.options = test::options_of(GetParam(), pitch);
  settings.artificial_viscosity = false;
  settings.laws = {make_soil_law(test::elastic_material(1e6, 1000))};
  Particles p;
  p.assign(n, settings.options.smoothing_length);
  p.position = lattice.position;
  p.volume = p.reference_volume = lattice.volume;
  for (std::size_t i = 0; i < n; ++i) p.mass[i] = 1000 * lattice.volume[i];
  std::mt19937_64 random(3);
  std::normal_distribution<double> any;
  p.bulk_modulus.assign(n, 1e6);
  for (std::size_t i = 0; i < n; ++i) {
    p.pressure[i] = 1e4 * any(random);
    for (auto& values : p.deviator) values[i] = 1e4 * any(random);
    p.velocity.set(i, {any(random), any(random), any(random)});
  }
  for (std::size_t i = 0; i < n; ++i) p.deviator[2][i] = -p.deviator[0][i] - p.deviator[1][i];
  p.record_motion();
  const Vec3Array velocity = p.velocity;
  NeighbourList list(p.position, 2 * settings.options.smoothing_length, 0);
  list.build(p.position);
  double stress_power = 0, scale = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const GradientSums sums = sum_gradients(settings, list, p, i);
    const Mat3 gradient = sums.velocity * to_matrix(correction_matrix(sums.moment));
    const SoilState state = p.soil_state(i);
    const double power = p.volume[i] * (to_matrix(state.deviator).cwiseProduct(gradient).sum() -
                                        state.pressure * gradient.trace());
    stress_power += power;
    scale += std::abs(power);
  }
  std::vector<StressSums> stress_blocks(block_count(p));
  std::vector<KickSums> kick_blocks(block_count(p));
  update_stress(settings, list, 0, p, stress_blocks);
  const double duration = 1e-9;
  kick(settings, list, {duration, duration, Vec3(0, 0, 0), 0, nullptr, 0}, p, kick_blocks);
  double force_power = 0;
  Vec3 momentum(0, 0, 0);
  double momentum_scale = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 force = p.mass[i] * (p.velocity[i] - velocity[i]) / duration;
    force_power += force.dot(velocity[i]);
    momentum += force;
    momentum_scale += force.norm();
  }
  // Velocity changes by 1e-7 of itself in the kick, which leaves 9 digits of the force.
  EXPECT_NEAR(force_power, -stress_power, 1e-7 * scale);
  EXPECT_LT(momentum.norm(), 1e-8 * momentum_scale);
}

}  // namespace
}  // namespace tuft::sph
