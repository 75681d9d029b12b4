/// The control of zero-energy modes: it takes what no velocity gradient sees, and nothing else.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/kernel.h"
#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002, density = 1000, bulk_modulus = 1e6, zeta = 0.05;

/// A disordered block without stress, in which the control is the only force.
struct StressFreeBlock {
  LoopSettings settings;
  Particles particles;
  NeighbourList list;

  explicit StressFreeBlock(test::Preset preset, int nx = 8, int ny = 7, int nz = 6, double jitter = 0.1) {
    Lattice lattice = test::block(nx, ny, nz, pitch);
    test::jitter(lattice, jitter);
    const std::size_t n = lattice.position.size();
    settings.options = test::options_of(preset, pitch);
    settings.options.zero_energy_viscosity = zeta;
    settings.artificial_viscosity = false;
    settings.zero_energy_control = true;
    settings.laws = {make_soil_law(test::elastic_material(bulk_modulus, density))};
    Particles& p = particles;
    p.assign(n, settings.options.smoothing_length);
    p.residual.assign(n, {});
    p.position = lattice.position;
    p.volume = lattice.volume;
    for (std::size_t i = 0; i < n; ++i) {
      p.mass[i] =
          density * (i % 3 == 0 ? 2 : 1) * lattice.volume[i];  // unequal masses: pairs must not assume
      p.reference_volume[i] = p.mass[i] / density;
      p.set_soil_state(i, reference_state(settings.laws[0]));
    }
    list = NeighbourList(p.position, 2 * settings.options.smoothing_length, 0);
    list.build(p.position);
    p.record_motion();
  }

  /// Forces on the particles, N, for velocities as set.
  Vec3Array forces() {
    Particles& p = particles;
    p.record_motion();
    const Vec3Array velocity = p.velocity;
    std::vector<StressSums> stress_blocks(block_count(p));
    std::vector<KickSums> kick_blocks(block_count(p));
    update_stress(settings, list, 0, p, stress_blocks);
    const double duration = 1e-3;
    kick(settings, list, {duration, duration, Vec3(0, 0, 0), 0, nullptr, 0}, p, kick_blocks);
    Vec3Array force;
    for (std::size_t i = 0; i < p.size(); ++i)
      force.push_back(p.mass[i] * (p.velocity[i] - velocity[i]) / duration);
    p.velocity = velocity;
    return force;
  }

  /// 2 D of sph_loops.h, W, from its definition, pair by pair.
  [[nodiscard]] double dissipation() const {
    const Particles& p = particles;
    const double h = settings.options.smoothing_length;
    const double modulus = bulk_modulus * (1 + 4.0 / 3.0 * settings.laws[0].shear_ratio);
    double sum = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const GradientSums sums = sum_gradients(settings, list, p, i);
      const Correction correction = correction_of(sums.moment);
      if (!correction.exact) continue;
      const Mat3 l = sums.velocity * to_matrix(correction.b);
      const double c = zeta * h * std::sqrt(modulus * p.mass[i] / p.volume[i]);
      for (const Index k : list.row(i)) {
        const auto j = static_cast<std::size_t>(k);
        const Vec3 x = p.position[j] - p.position[i], r = p.velocity[j] - p.velocity[i] - l * x;
        const double slope = settings.options.kernel == Kernel::cubic_spline
                                 ? CubicSpline(h).slope_over_distance(x.squaredNorm())
                                 : WendlandC2(h).slope_over_distance(x.squaredNorm());
        sum -= c * p.volume[i] * p.volume[j] * slope * r.squaredNorm();
      }
    }
    return sum;
  }

  void set_random_velocities() {
    std::mt19937_64 random(5);
    std::normal_distribution<double> any;
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.velocity.set(i, {any(random), any(random), any(random)});
  }
};

double largest(const Vec3Array& values) {
  double found = 0;
  for (std::size_t i = 0; i < values.size(); ++i) found = std::max(found, values[i].norm());
  return found;
}

class ZeroEnergyControl : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, ZeroEnergyControl,
                         testing::Values(test::Preset::accurate, test::Preset::paper));

TEST_P(ZeroEnergyControl, GivesNoForceOnAnyLinearMotionFreeSurfacesIncluded) {
  StressFreeBlock block(GetParam());
  block.set_random_velocities();
  const double random_force = largest(block.forces());
  Mat3 gradient;  // |gradient| times the block's size is about the random velocities' 1 m/s
  gradient << 100, -30, 70, 40, -200, 50, 10, 80, 120;
  for (std::size_t i = 0; i < block.particles.size(); ++i)
    block.particles.velocity.set(i, Vec3(3, -1, 2) + gradient * block.particles.position[i]);
  // Rounding of the records to single precision.
  EXPECT_LT(largest(block.forces()), 1e-6 * random_force);
}

TEST_P(ZeroEnergyControl, TakesTwiceItsDissipationFunctionAndKeepsBothMomenta) {
  StressFreeBlock block(GetParam());
  block.set_random_velocities();
  const Vec3Array force = block.forces();
  const Particles& p = block.particles;
  double power = 0, scale = 0, torque_scale = 0;
  Vec3 sum(0, 0, 0), torque(0, 0, 0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    power += force[i].dot(p.velocity[i]);
    sum += force[i];
    scale += force[i].norm();
    torque += p.position[i].cross(force[i]);
    torque_scale += p.position[i].norm() * force[i].norm();
  }
  const double expected = block.dissipation();
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(power, -expected, 1e-6 * expected);
  EXPECT_LT(sum.norm(), 1e-12 * scale);
  EXPECT_LT(torque.norm(), 1e-6 * torque_scale);
}

double alternating(const Vec3& x) {
  const auto cell = [](double along) { return static_cast<int>(std::floor(along / pitch + 100)); };
  return (cell(x.x()) + cell(x.y()) + cell(x.z())) % 2 == 0 ? 1.0 : -1.0;
}

/// Kinetic energy of a free elastic block over that at first, `periods` of h/c later.
double energy_left(test::Preset preset, bool controlled, double periods,
                   const std::function<Vec3(const Vec3&)>& velocity) {
  const Lattice lattice = test::block(10, 10, 10, pitch);
  SphSettings settings;
  settings.options = test::options_of(preset, pitch);
  settings.options.zero_energy_viscosity = zeta;
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = false;
  settings.zero_energy_control = controlled;
  SphInfill infill(lattice, test::single_material(test::elastic_material(bulk_modulus, density)), settings);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    infill.set_velocity(i, velocity(lattice.position[i]));
  const double c = std::sqrt(bulk_modulus * 5 / 3 / density), time = periods * 1.3 * pitch / c;
  infill.advance(1e-12, 1, {});
  const InfillEnergy first = infill.energy();
  infill.advance(time, static_cast<int>(std::ceil(time / (0.6 * infill.stable_step()))), {});
  const InfillEnergy last = infill.energy();
  EXPECT_NEAR(last.kinetic + last.stored + last.dissipated, first.kinetic, 2e-3 * first.kinetic);
  if (!controlled) {
    EXPECT_LT(std::abs(last.dissipated), 1e-12 * first.kinetic);
  }
  return (last.kinetic + last.stored) / first.kinetic;
}

TEST_P(ZeroEnergyControl, EndsAlternatingMotionThatNothingElseWould) {
  const auto alternate = [](const Vec3& x) -> Vec3 { return Vec3(1e-4, -1e-4, 1e-4) * alternating(x); };
  EXPECT_GT(energy_left(GetParam(), false, 30, alternate), 0.99);
  EXPECT_LT(energy_left(GetParam(), true, 30, alternate), 0.02);
}

/// Power over kinetic energy of a shear wave as long as the block, 1/s.
double damping_of_a_wave(test::Preset preset, int particles) {
  StressFreeBlock block(preset, particles, particles, particles, 0);
  Particles& p = block.particles;
  const double wave_number = 2 * std::numbers::pi / (particles * pitch);
  double kinetic = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    p.velocity.set(i, {0, 0, std::sin(wave_number * p.position.x[i])});
    kinetic += 0.5 * p.mass[i] * p.velocity[i].squaredNorm();
  }
  p.record_motion();
  return block.dissipation() / kinetic;
}

TEST_P(ZeroEnergyControl, ActsOnSmoothMotionAsAViscosityOfTheFourthDerivative) {
  // With zeta c h^3 (wave number)^4; here the number of wavelengths in a block is one.
  const double coarse = damping_of_a_wave(GetParam(), 10), fine = damping_of_a_wave(GetParam(), 20);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.5);
}

}  // namespace
}  // namespace tuft::sph
