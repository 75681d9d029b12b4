/// Infill at rest sleeps, and wakes for whatever reaches it.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <limits>
#include <memory>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002, density = 1000, bulk_modulus = 1e6, tolerance = 1e-5;
const double wave_speed = std::sqrt(bulk_modulus * 5 / 3 / density);

SphSettings settings_of(double sleep_tolerance, test::Preset preset = test::Preset::accurate) {
  SphSettings settings;
  settings.options = test::options_of(preset, pitch);
  settings.gravity = {0, 0, 0};
  settings.artificial_viscosity = false;
  settings.zero_energy_control = true;
  settings.sleep_tolerance = sleep_tolerance;
  return settings;
}

/// A bar of 90 x 6 x 6 particles along x, at rest: a block is about seven layers of it.
struct Bar {
  static constexpr int length = 90;
  Lattice lattice = test::block(length, 6, 6, pitch);
  SphInfill infill;

  explicit Bar(double sleep_tolerance, const Vec3& gravity = {0, 0, 0})
      : infill(lattice, test::single_material(test::elastic_material(bulk_modulus, density)), [&] {
          SphSettings settings = settings_of(sleep_tolerance);
          settings.gravity = gravity;
          return settings;
        }()) {}

  [[nodiscard]] double step() const { return 0.6 * infill.stable_step(); }
  void advance(double dt, int steps) {
    for (int k = 0; k < steps; ++k) infill.advance(dt, 1, {});
  }
  /// Sets the first ten layers moving along x.
  void strike(double speed) {
    for (std::size_t i = 0; i < lattice.position.size(); ++i)
      if (lattice.position.x[i] < (10 - 0.5 * length) * pitch) infill.set_velocity(i, {speed, 0, 0});
  }
  /// Mean displacement of the last four layers, m.
  [[nodiscard]] double far_end() const {
    const ParticleView p = infill.particles();
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (lattice.position.x[i] > (0.5 * length - 4) * pitch) sum += p.x[i] - lattice.position.x[i], ++count;
    return sum / count;
  }
};

/// Particle-steps of `steps` steps.
std::uint64_t computed(Bar& bar, int steps) {
  const std::uint64_t before = bar.infill.particle_steps();
  bar.advance(bar.step(), steps);
  return bar.infill.particle_steps() - before;
}

TEST(Sleep, InfillAtRestIsNotComputed) {
  Bar bar(tolerance);
  EXPECT_EQ(computed(bar, 10), 10 * bar.lattice.position.size());
  bar.advance(bar.step(), 30);
  EXPECT_EQ(computed(bar, 50), 0u);
}

TEST(Sleep, WithToleranceZeroComputesAllForEver) {
  Bar bar(0);
  bar.advance(bar.step(), 100);
  EXPECT_EQ(computed(bar, 10), 10 * bar.lattice.position.size());
}

/// A pulse of strain 1e-3, ten layers long, sent through a bar that slept, and through one awake: the largest
/// difference of their far ends' displacements over the largest displacement, and the share of the steps
/// computed.
struct Passage {
  double difference, share;
};
Passage send_pulse(double sleep_tolerance) {
  Bar awake(0), sleeper(sleep_tolerance);
  const double dt = awake.step(), strain = 1e-3;
  awake.advance(dt, 30), sleeper.advance(dt, 30);
  EXPECT_EQ(computed(sleeper, 1), 0u);
  awake.strike(strain * wave_speed), sleeper.strike(strain * wave_speed);
  // The pulse crosses 80 layers in 80 pitch/c; half as long again, until all of it has arrived.
  const int steps = static_cast<int>(120 * pitch / wave_speed / dt);
  const std::uint64_t before = sleeper.infill.particle_steps();
  double difference = 0, largest = 0;
  for (int k = 0; k < steps; ++k) {
    awake.advance(dt, 1), sleeper.advance(dt, 1);
    largest = std::max(largest, std::abs(awake.far_end()));
    difference = std::max(difference, std::abs(awake.far_end() - sleeper.far_end()));
  }
  EXPECT_GT(largest, 0.5 * strain * 10 * pitch) << "the pulse has arrived";
  const InfillEnergy a = awake.infill.energy(), s = sleeper.infill.energy();
  EXPECT_NEAR(s.kinetic + s.stored + s.dissipated, a.kinetic + a.stored + a.dissipated,
              1e-3 * (a.kinetic + a.stored + a.dissipated));
  const auto all = static_cast<double>(static_cast<std::size_t>(steps) * sleeper.lattice.position.size());
  return {difference / largest, static_cast<double>(sleeper.infill.particle_steps() - before) / all};
}

TEST(Sleep, AWaveRunsThroughASleepingBarAsThroughOneAwake) {
  const Passage coarse = send_pulse(1e-5), fine = send_pulse(1e-6);
  EXPECT_LT(coarse.difference, 0.01) << "with a tolerance of a hundredth of its strain";
  EXPECT_LT(fine.difference, 0.2 * coarse.difference) << "and as much less as the tolerance";
  EXPECT_LT(coarse.share, 0.9) << "what the pulse has not reached went on sleeping";
}

TEST(Sleep, MotionUnderTheToleranceIsStoppedAndItsEnergyCounted) {
  Bar bar(tolerance);
  bar.strike(0.3 * tolerance * wave_speed);
  bar.advance(bar.step(), 1);
  const InfillEnergy first = bar.infill.energy();
  bar.advance(bar.step(), 60);
  EXPECT_EQ(computed(bar, 1), 0u);
  const InfillEnergy last = bar.infill.energy();
  EXPECT_GT(first.kinetic, 0);
  EXPECT_EQ(last.kinetic, 0);
  EXPECT_NEAR(last.stored + last.dissipated, first.kinetic + first.stored + first.dissipated,
              1e-3 * first.kinetic);
}

TEST(Sleep, APushAnywhereWakesAndIsReceivedInFullEvenByWhatSleepsOn) {
  Bar bar(tolerance);
  bar.advance(bar.step(), 60);
  const double dt = bar.step();
  const std::size_t n = bar.lattice.position.size(), middle = n / 2;
  const double mass = bar.infill.particles().mass[middle], h = 1.3 * pitch;
  ContactImpulses push;
  push.linear.assign(n, 0);
  // Far under the tolerance: an acceleration of tolerance c^2/h times 0.1.
  const double least = tolerance * wave_speed * wave_speed / h * mass * dt;
  push.linear.x[middle] = 0.1 * least;
  AdvanceReport report = bar.infill.advance(dt, 1, push);
  EXPECT_DOUBLE_EQ(report.impulse_received.x(), 0.1 * least);
  EXPECT_EQ(bar.infill.particles().vx[middle], 0);
  push.linear.x[middle] = 3 * least;
  for (int k = 0; k < 3; ++k) report = bar.infill.advance(dt, 1, push);
  EXPECT_DOUBLE_EQ(report.impulse_received.x(), 3 * least);
  EXPECT_GT(bar.infill.particles().vx[middle], 0);
}

TEST(Sleep, AnImpulseThatIsNotANumberEndsTheRunAlthoughTheInfillSleeps) {
  Bar bar(tolerance);
  bar.advance(bar.step(), 60);
  ContactImpulses push;
  push.linear.assign(bar.lattice.position.size(), 0);
  push.linear.y[100] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(bar.infill.advance(bar.step(), 1, push), RunError);
}

TEST(Sleep, ASlowPressIsNotSleptThrough) {
  // One end is pressed so slowly that no speed comes near the tolerance; the strain does, and passes it.
  Bar awake(0), sleeper(tolerance);
  const double dt = awake.step(), stiffness = 0.2 * bulk_modulus * pitch, strain = 6 * tolerance;
  const double speed = 0.3 * tolerance * wave_speed;
  const auto press = [&](Bar& bar, int step) {
    const ParticleView p = bar.infill.particles();
    ContactImpulses push;
    push.linear.assign(p.size(), 0);
    const double left = -0.5 * Bar::length * pitch + speed * step * dt, right = 0.5 * Bar::length * pitch;
    for (std::size_t i = 0; i < p.size(); ++i)
      push.linear.x[i] =
          dt * stiffness *
          (std::max(0.0, left + p.radius[i] - p.x[i]) - std::max(0.0, p.x[i] + p.radius[i] - right));
    bar.infill.advance(dt, 1, push);
  };
  const int steps = static_cast<int>(strain * Bar::length * pitch / (speed * dt));
  awake.infill.set_damping(300), sleeper.infill.set_damping(300);
  for (int k = 0; k < steps; ++k) press(awake, k), press(sleeper, k);
  const auto mean_pressure = [](const Bar& bar) {
    const std::vector<double> pressure = bar.infill.fields()[0].values;
    return std::accumulate(pressure.begin(), pressure.end(), 0.0) / static_cast<double>(pressure.size());
  };
  const double expected = mean_pressure(awake);
  EXPECT_GT(expected, 2 * tolerance * bulk_modulus);
  EXPECT_NEAR(mean_pressure(sleeper), expected, 0.5 * tolerance * bulk_modulus);
}

/// The bar in a tray under gravity, come to rest, then hit at one end: parts sleep, others move, lists are
/// rebuilt.
void run_struck(Bar& bar, int steps) {
  ContactImpulses contact;
  test::Tray tray(Bar::length * pitch, 6 * pitch, 10 * bulk_modulus * pitch, 0.1);
  for (int k = 0; k < steps; ++k) {
    const double window = bar.step();
    tray.push(bar.infill.particles(), window, contact);
    bar.infill.advance(window, 1, contact);
  }
}

void settle(Bar& bar) {
  bar.infill.set_damping(2000);
  run_struck(bar, 150);
  bar.infill.set_damping(0);
}

void expect_same_bits(const SphInfill& a, const SphInfill& b) {
  const ParticleView p = a.particles(), q = b.particles();
  EXPECT_TRUE(std::ranges::equal(p.x, q.x) && std::ranges::equal(p.y, q.y) && std::ranges::equal(p.z, q.z));
  EXPECT_TRUE(std::ranges::equal(p.vx, q.vx) && std::ranges::equal(p.vz, q.vz));
  EXPECT_EQ(a.fields()[0].values, b.fields()[0].values);
  EXPECT_EQ(a.energy().dissipated, b.energy().dissipated);
  EXPECT_EQ(a.energy().kinetic, b.energy().kinetic);
  EXPECT_EQ(a.energy().gravity_potential, b.energy().gravity_potential);
  EXPECT_EQ(a.particle_steps(), b.particle_steps());
  EXPECT_EQ(a.stable_step(), b.stable_step());
}

TEST(Sleep, OneAndTwoThreadsGiveTheSameBits) {
  const int threads = omp_get_max_threads();
  const auto result = [](int count) {
    set_threads(count);
    auto bar = std::make_unique<Bar>(1e-3, Vec3(0, 0, -9.81));
    settle(*bar);
    bar->strike(0.05 * wave_speed);
    run_struck(*bar, 60);
    return bar;
  };
  const auto one = result(1), two = result(2);
  set_threads(threads);
  expect_same_bits(one->infill, two->infill);
  EXPECT_LT(one->infill.particle_steps(), 200 * one->lattice.position.size()) << "some of it slept";
}

TEST(Sleep, ARunThatWasSavedWhilePartsSleepGoesOnWithTheSameBits) {
  const auto path =
      std::filesystem::temp_directory_path() / ("tuft_sleep_" + std::to_string(getpid()) + ".h5");
  Bar whole(1e-3, {0, 0, -9.81});
  settle(whole);
  whole.strike(0.05 * wave_speed);
  run_struck(whole, 25);
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("infill");
    whole.infill.save(group);
    file.commit();
  }
  Bar resumed(1e-3, {0, 0, -9.81});
  resumed.infill.load(h5::File::open(path).root().open_group("infill"));
  std::filesystem::remove(path);
  EXPECT_LT(whole.infill.particle_steps(), 170 * whole.lattice.position.size()) << "some of it sleeps";
  run_struck(whole, 60);
  run_struck(resumed, 60);
  expect_same_bits(whole.infill, resumed.infill);
}

}  // namespace
}  // namespace tuft::sph
