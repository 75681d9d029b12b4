/// Infill that sleeps where it is at rest and takes steps of its own where it moves.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <limits>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/verification/sph_infill/cases/same_bits.h"
#include "tests/verification/sph_infill/cases/stiff_and_soft.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002, soft_modulus = 0.25e6, tolerance = 1e-5;
constexpr int width = 8, stiff_rows = 8, soft_rows = 52;
const double soft_speed = std::sqrt(soft_modulus * 5 / 3 / test::soft_density);

/// A free column: 8 rows of a stiff elastic material (50 MPa) under 52 of a soft one, at rest. A block is
/// four rows of it.
struct Column {
  Lattice lattice;
  SphInfill infill;
  double dt;

  explicit Column(double sleep_tolerance, const Vec3& gravity = {0, 0, 0}, int steps = 8)
      : Column(test::stiff_under_soft(width, stiff_rows, soft_rows, pitch), sleep_tolerance, gravity, steps) {
  }
  Column(const Lattice& given, double sleep_tolerance, const Vec3& gravity = {0, 0, 0}, int steps = 8)
      : lattice(given), infill(lattice, test::stiff_and_soft(soft_modulus), [&] {
          SphSettings settings;
          settings.options = test::options_of(test::Preset::accurate, pitch);
          settings.gravity = gravity;
          settings.artificial_viscosity = false;
          settings.zero_energy_control = true;
          settings.sleep_tolerance = sleep_tolerance;
          settings.individual_steps = steps;
          return settings;
        }()) {
    dt = 0.6 * infill.stable_step();
  }
  [[nodiscard]] std::size_t size() const { return lattice.position.size(); }
  [[nodiscard]] double height(std::size_t i) const { return lattice.position.z[i] / pitch; }
  void advance(int steps) {
    for (int k = 0; k < steps; ++k) infill.advance(dt, 1, {});
  }
  /// Sets the uppermost ten rows moving down.
  void strike(double speed) {
    for (std::size_t i = 0; i < size(); ++i)
      if (height(i) > stiff_rows + soft_rows - 10) infill.set_velocity(i, {0, 0, -speed});
  }
  /// One step under what `push` gives a particle, in its own kicks alone, as contact does.
  template <class Force>
  AdvanceReport advance_under(Force&& force) {
    infill.begin_window(dt, 1, true);
    const ParticleView p = infill.particles();
    ContactImpulses contact;
    contact.linear.assign(p.size(), 0);
    for (std::size_t i = 0; i < p.size(); ++i)
      contact.linear.set(i, p.kicks.length[i / p.kicks.group] * force(i, p));
    return infill.advance(dt, 1, contact);
  }
  /// Steps under its weight on a floor, a light spring with a dashpot.
  void stand(int steps) {
    for (int k = 0; k < steps; ++k)
      advance_under([](std::size_t i, const ParticleView& p) -> Vec3 {
        const double overlap = p.radius[i] - p.z[i], stiffness = 10 * soft_modulus * pitch;
        if (overlap <= 0) return {0, 0, 0};
        return {0, 0, stiffness * overlap - 0.2 * std::sqrt(stiffness * p.mass[i]) * p.vz[i]};
      });
  }
  [[nodiscard]] std::uint64_t computed_in(int steps) {
    const std::uint64_t before = infill.particle_steps();
    advance(steps);
    return infill.particle_steps() - before;
  }
};

TEST(SleepAndSteps, InfillAtRestIsNotComputed) {
  Column column(tolerance);
  EXPECT_GT(column.computed_in(8), 0u);
  column.advance(60);
  EXPECT_EQ(column.computed_in(50), 0u);
}

/// A pulse of strain 1e-3, ten rows long, sent down through a column that slept and one awake. Differences
/// are of positions, rms, over the rms displacement.
struct Passage {
  double difference = 0, share = 0;  ///< and particle-steps over those of one awake
};
Passage send_pulse(double sleep_tolerance, int longest_period) {
  Column awake(0, {0, 0, 0}, longest_period), sleeper(sleep_tolerance, {0, 0, 0}, longest_period);
  const double strain = 1e-3;
  awake.advance(80), sleeper.advance(80);
  awake.strike(strain * soft_speed), sleeper.strike(strain * soft_speed);
  const std::uint64_t all = awake.infill.particle_steps(), some = sleeper.infill.particle_steps();
  // Down to the stiff rows, through them, and back by ten.
  const int steps = static_cast<int>(60 * pitch / soft_speed / awake.dt / 8) * 8;
  awake.advance(steps), sleeper.advance(steps);
  double difference = 0, moved = 0, foot = 0;
  for (std::size_t i = 0; i < awake.size(); ++i) {
    const Vec3 way = awake.infill.particles().position(i) - awake.lattice.position[i];
    difference +=
        (sleeper.infill.particles().position(i) - awake.infill.particles().position(i)).squaredNorm();
    moved += way.squaredNorm();
    if (awake.height(i) < 1) foot = std::max(foot, way.norm());
  }
  EXPECT_GT(foot, 0.05 * strain * 10 * pitch) << "the pulse has arrived";
  const InfillEnergy a = awake.infill.energy(), s = sleeper.infill.energy();
  EXPECT_NEAR(s.kinetic + s.stored + s.dissipated, a.kinetic + a.stored + a.dissipated,
              2e-3 * (a.kinetic + a.stored + a.dissipated));
  return {std::sqrt(difference / moved), static_cast<double>(sleeper.infill.particle_steps() - some) /
                                             static_cast<double>(awake.infill.particle_steps() - all)};
}

TEST(SleepAndSteps, AWaveRunsThroughASleepingColumnAsThroughOneAwake) {
  const Passage coarse = send_pulse(1e-6, 8), fine = send_pulse(1e-7, 8), one = send_pulse(1e-6, 1);
  EXPECT_LT(coarse.difference, 0.01) << "with a tolerance of a tenth of its strain in the stiff rows";
  EXPECT_LT(coarse.difference, 1.1 * one.difference) << "steps of their own make it no worse";
  EXPECT_LT(fine.difference, 0.2 * coarse.difference) << "and as much less as the tolerance";
  EXPECT_LT(coarse.share, 0.9) << "what the pulse has not reached went on sleeping";
}

TEST(SleepAndSteps, MotionUnderTheToleranceIsStoppedAndItsEnergyCounted) {
  Column column(tolerance);
  column.strike(0.3 * tolerance * soft_speed);
  column.advance(1);
  const InfillEnergy first = column.infill.energy();
  column.advance(127);
  EXPECT_EQ(column.computed_in(8), 0u);
  const InfillEnergy last = column.infill.energy();
  EXPECT_GT(first.kinetic, 0);
  EXPECT_EQ(last.kinetic, 0);
  EXPECT_NEAR(last.stored + last.dissipated, first.kinetic + first.stored + first.dissipated,
              5e-3 * first.kinetic);
  for (const double v : column.infill.particles().vz) EXPECT_EQ(v, 0);
}

TEST(SleepAndSteps, APushAnywhereWakesAndIsReceivedInFullEvenByWhatSleepsOn) {
  Column column(tolerance);
  column.advance(80);
  const std::size_t pushed = column.size() - 100;
  const double h = 1.3 * pitch,
               least = tolerance * soft_speed * soft_speed / h * column.infill.particles().mass[pushed];  // N
  const auto push = [&](double force) {
    Vec3 received(0, 0, 0);
    for (int k = 0; k < 24; ++k)
      received += column
                      .advance_under([&](std::size_t i, const ParticleView&) {
                        return Vec3(i == pushed ? force : 0, 0, 0);
                      })
                      .impulse_received;
    return received;
  };
  EXPECT_NEAR(push(0.1 * least).x(), 24 * column.dt * 0.1 * least, 8 * column.dt * 0.1 * least);
  EXPECT_EQ(column.infill.particles().vx[pushed], 0);
  EXPECT_NEAR(push(3 * least).x(), 24 * column.dt * 3 * least, 8 * column.dt * 3 * least);
  EXPECT_GT(column.infill.particles().vx[pushed], 0);
}

TEST(SleepAndSteps, WhatStandsOnAFloorSleepsUnderItsWeight) {
  Column column(1e-4, {0, 0, -9.81});
  column.infill.set_damping(1000);
  column.stand(600);
  const std::uint64_t before = column.infill.particle_steps();
  column.stand(32);
  EXPECT_EQ(column.infill.particle_steps(), before);
}

/// The upper part comes from too far away to be a neighbour when the list is first made.
TEST(SleepAndSteps, WhatSleepsWakesForWhatFallsOnIt) {
  Lattice lattice = test::stiff_under_soft(width, stiff_rows, soft_rows, pitch);
  constexpr int lower = 36;
  const auto is_upper = [&](std::size_t i) { return lattice.position.z[i] > lower * pitch; };
  std::vector<bool> upper;
  for (std::size_t i = 0; i < lattice.position.size(); ++i) upper.push_back(is_upper(i));
  for (std::size_t i = 0; i < upper.size(); ++i)
    if (upper[i]) lattice.position.z[i] += 4 * pitch;
  Column column(lattice, tolerance);
  column.advance(80);
  const double speed = 0.02 * soft_speed;
  double mass = 0;
  for (std::size_t i = 0; i < upper.size(); ++i)
    if (upper[i]) column.infill.set_velocity(i, {0, 0, -speed}), mass += column.infill.particles().mass[i];
  // Until they are within reach, and as long again.
  const int steps = static_cast<int>(6 * pitch / speed / column.dt);
  column.advance(steps);
  const ParticleView p = column.infill.particles();
  double passed_on = 0;
  for (std::size_t i = 0; i < upper.size(); ++i)
    if (!upper[i]) passed_on -= p.mass[i] * p.vz[i];
  EXPECT_GT(passed_on, 0.02 * mass * speed);
}

TEST(SleepAndSteps, AnImpulseThatIsNotANumberEndsTheRunAlthoughTheInfillSleeps) {
  Column column(tolerance);
  column.advance(80);
  EXPECT_THROW(
      {
        for (int k = 0; k < 16; ++k)
          column.advance_under([](std::size_t i, const ParticleView&) {
            return Vec3(0, i == 100 ? std::numeric_limits<double>::quiet_NaN() : 0, 0);
          });
      },
      RunError);
}

/// Parts are held up, others fall and hit each other: the books hold the weight of all.
TEST(SleepAndSteps, TheEnergyOfWeightIsThatOfAllParticles) {
  const Vec3 gravity(0, 0, -9.81);
  Column column(1e-3, gravity);
  column.advance(80);
  EXPECT_EQ(column.computed_in(8), 0u);
  column.strike(0.02 * soft_speed);
  int compared = 0;
  for (int k = 0; k < 200; ++k) {
    double potential = 0;
    const ParticleView p = column.infill.particles();
    for (std::size_t i = 0; i < p.size(); ++i) potential -= p.mass[i] * gravity.dot(p.position(i));
    column.advance(1);
    if (!column.infill.energy_is_current()) continue;
    EXPECT_NEAR(column.infill.energy().gravity_potential, potential, 1e-12 * potential);
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

std::unique_ptr<Column> struck() {
  auto column = std::make_unique<Column>(1e-4, Vec3(0, 0, -9.81));
  column->infill.set_damping(300);
  column->stand(400);
  column->infill.set_damping(0);
  column->strike(0.05 * soft_speed);
  column->stand(60);
  return column;
}

TEST(SleepAndSteps, OneAndTwoThreadsGiveTheSameBits) {
  const int threads = omp_get_max_threads();
  set_threads(1);
  const auto one = struck();
  set_threads(2);
  const auto two = struck();
  set_threads(threads);
  test::expect_same(one->infill, two->infill);
}

TEST(SleepAndSteps, ARunThatWasSavedWhilePartsSleepGoesOnWithTheSameBits) {
  const auto path =
      std::filesystem::temp_directory_path() / ("tuft_sleep_steps_" + std::to_string(getpid()) + ".h5");
  for (const int between : {0, 3}) {
    const auto whole = struck();
    const std::uint64_t before = whole->infill.particle_steps();
    whole->stand(8 + between);
    EXPECT_LT(whole->infill.particle_steps() - before, 5 * whole->size()) << "some of it sleeps";
    {
      h5::File file = h5::File::create_atomically(path);
      h5::Group group = file.root().create_group("infill");
      whole->infill.save(group);
      file.commit();
    }
    Column resumed(1e-4, {0, 0, -9.81});
    resumed.infill.load(h5::File::open(path).root().open_group("infill"));
    std::filesystem::remove(path);
    whole->stand(150);
    resumed.stand(150);
    test::expect_same(whole->infill, resumed.infill);
  }
}

}  // namespace
}  // namespace tuft::sph
