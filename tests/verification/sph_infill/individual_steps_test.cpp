/// Particles of soft layers take longer steps: stable, as accurate as with one step for all to second order,
/// and the same bits however it is run.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <limits>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"
#include "sph_infill/individual_steps.h"
#include "tests/verification/sph_infill/cases/same_bits.h"
#include "tests/verification/sph_infill/cases/stiff_and_soft.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;
constexpr int width = 8, stiff_rows = 4, soft_rows = 12;

/// A free block: 4 rows of a stiff elastic material (50 MPa) under 12 of a soft one (1 MPa).
struct LayeredBlock {
  Lattice lattice;
  SphInfill infill;

  LayeredBlock(int individual_steps, test::Preset preset, bool viscosity, double safety = 0.8)
      : lattice(lattice_of()),
        infill(lattice, test::stiff_and_soft(), settings_of(individual_steps, preset, viscosity, safety)) {}

  static Lattice lattice_of() { return test::stiff_under_soft(width, stiff_rows, soft_rows, pitch); }
  static SphSettings settings_of(int individual_steps, test::Preset preset, bool viscosity,
                                 double safety = 0.8) {
    SphSettings settings;
    settings.options = test::options_of(preset, pitch);
    settings.gravity = {0, 0, 0};
    settings.artificial_viscosity = viscosity;
    settings.individual_steps = individual_steps;
    settings.step_safety = safety;
    return settings;
  }
  [[nodiscard]] double height(std::size_t i) const { return lattice.position.z[i] / pitch; }
  void shake(double speed) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> any(-speed, speed);
    for (std::size_t i = 0; i < lattice.position.size(); ++i)
      infill.set_velocity(i, {any(random), any(random), any(random)});
  }
  /// A smooth bump of downward velocity in the soft layer, on its way to the stiff one.
  void strike(double speed) {
    for (std::size_t i = 0; i < lattice.position.size(); ++i)
      infill.set_velocity(i, {0, 0, -speed * std::exp(-std::pow((height(i) - 11) / 3, 2))});
  }
  void advance(double dt, int steps) {
    for (int k = 0; k < steps; ++k) infill.advance(dt, 1, {});
  }
  [[nodiscard]] double total_energy() const {
    const InfillEnergy e = infill.energy();
    return e.kinetic + e.stored + e.dissipated;
  }
  /// How far the centre of mass has moved along z, m. Velocities are of different times, positions are not.
  [[nodiscard]] double moved() const {
    const ParticleView p = infill.particles();
    double sum = 0, mass = 0;
    for (std::size_t i = 0; i < p.size(); ++i)
      sum += p.mass[i] * (p.z[i] - lattice.position.z[i]), mass += p.mass[i];
    return sum / mass;
  }
  [[nodiscard]] double mean_speed() const {
    const ParticleView p = infill.particles();
    double sum = 0, mass = 0;
    for (std::size_t i = 0; i < p.size(); ++i) sum += p.mass[i] * p.vz[i], mass += p.mass[i];
    return sum / mass;
  }
};

class IndividualStepsOf : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, IndividualStepsOf,
                         testing::Values(test::Preset::accurate, test::Preset::paper));

TEST_P(IndividualStepsOf, AreLongInTheSoftLayerButNotWithinReachOfTheStiffOne) {
  LayeredBlock block(8, GetParam(), false);
  block.shake(1e-4);
  block.advance(0.8 * block.infill.stable_step(), 4);
  const double support = 2 * test::options_of(GetParam(), pitch).smoothing_length / pitch;
  int longest = 1;
  for (std::size_t i = 0; i < block.lattice.position.size(); ++i) {
    if (block.height(i) < stiff_rows - 0.5 + support) {
      EXPECT_EQ(block.infill.period_of(i), 1) << block.height(i);
    }
    longest = std::max(longest, block.infill.period_of(i));
  }
  EXPECT_GE(longest, 4);
  block.advance(0.8 * block.infill.stable_step(), 60);
  EXPECT_LT(block.infill.particle_steps(), 64 * block.lattice.position.size() * 6 / 10);
}

TEST_P(IndividualStepsOf, KeepTheEnergyOfAShakenBlockWithoutViscosityForTenThousandSteps) {
  LayeredBlock block(8, GetParam(), false);
  block.shake(1e-4);
  const double dt = 0.8 * block.infill.stable_step();
  block.advance(dt, 8);
  const double first = block.total_energy();
  double largest = 0;
  for (int k = 0; k < 100; ++k) {
    block.advance(dt, 100);
    largest = std::max(largest, std::abs(block.total_energy() - first) / first);
  }
  EXPECT_LT(largest, 0.01);
}

/// Of a wave from the soft into the stiff layer and back.
struct WaveErrors {
  double energy = 0;    ///< largest change over the energy of the wave
  double momentum = 0;  ///< difference of the centre of mass from uniform motion, over its way
  double motion = 0;  ///< rms difference of positions from those with one step for all, over rms displacement
};

/// Periods are the same for any share, and so are all steps in proportion to it.
WaveErrors errors_of_wave(test::Preset preset, double share) {
  LayeredBlock own(8, preset, false, share), one(1, preset, false);
  own.strike(0.01), one.strike(0.01);
  const double speed = own.mean_speed(), dt = share * own.infill.stable_step();
  own.advance(dt, 1);
  const double energy = own.total_energy();
  WaveErrors errors;
  const int cycles = static_cast<int>(std::lround(2e-3 / dt / 8));
  for (int k = 1; k <= cycles; ++k) {
    own.advance(dt, 8);
    errors.energy = std::max(errors.energy, std::abs(own.total_energy() / energy - 1));
  }
  const double way = speed * dt * (8 * cycles + 1);
  errors.momentum = std::abs(own.moved() / way - 1);
  one.advance(dt, 8 * cycles + 1);
  const ParticleView p = own.infill.particles(), q = one.infill.particles();
  double difference = 0, moved = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    difference += (p.position(i) - q.position(i)).squaredNorm();
    moved += (q.position(i) - one.lattice.position[i]).squaredNorm();
  }
  errors.motion = std::sqrt(difference / moved);
  return errors;
}

TEST_P(IndividualStepsOf, ErrInAWaveBySecondOrderOfTheStep) {
  const WaveErrors coarse = errors_of_wave(GetParam(), 0.8), fine = errors_of_wave(GetParam(), 0.4);
  EXPECT_LT(coarse.energy, 0.01);
  EXPECT_LT(coarse.momentum, 0.01);
  EXPECT_LT(coarse.motion, 0.01);
  EXPECT_LT(fine.energy, 0.4 * coarse.energy);
  EXPECT_LT(fine.momentum, 0.4 * coarse.momentum);
  EXPECT_LT(fine.motion, 0.4 * coarse.motion);
}

TEST(IndividualSteps, WhereContactCallsForEveryStepGiveTheBitsOfOneStepForAll) {
  LayeredBlock own(8, test::Preset::accurate, true), one(1, test::Preset::accurate, true);
  own.infill.set_contact_rates(
      std::vector<float>(own.lattice.position.size(), std::numeric_limits<float>::infinity()));
  own.strike(3), one.strike(3);
  const double dt = 0.7 * one.infill.stable_step();
  own.advance(dt, 120), one.advance(dt, 120);
  EXPECT_EQ(own.infill.particle_steps(), one.infill.particle_steps());
  test::expect_same(own.infill, one.infill);
}

/// Struck hard enough that the list is built anew and periods change.
void run(LayeredBlock& block, int steps) {
  for (int k = 0; k < steps; ++k) block.infill.advance(0.7 * block.infill.stable_step(), 1, {});
}

TEST_P(IndividualStepsOf, GiveTheSameBitsOnOneAndTwoThreads) {
  const int threads = omp_get_max_threads();
  LayeredBlock one(8, GetParam(), true), two(8, GetParam(), true);
  one.strike(20), two.strike(20);
  set_threads(1);
  run(one, 150);
  set_threads(2);
  run(two, 150);
  set_threads(threads);
  test::expect_same(one.infill, two.infill);
}

std::filesystem::path saved(SphInfill& infill, const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / (name + "_" + std::to_string(getpid()) + ".h5");
  h5::File out = h5::File::create_atomically(path);
  h5::Group group = out.root().create_group("infill");
  infill.save(group);
  out.commit();
  return path;
}

TEST_P(IndividualStepsOf, GiveTheSameBitsWhenContinuedFromACheckpointBetweenTwoKicks) {
  LayeredBlock straight(8, GetParam(), true);
  straight.strike(20);
  run(straight, 75);
  const std::filesystem::path path = saved(straight.infill, "tuft_own_steps");
  LayeredBlock resumed(8, GetParam(), true);
  resumed.infill.load(h5::File::open(path).root().open_group("infill"));
  std::filesystem::remove(path);
  run(straight, 130), run(resumed, 130);
  test::expect_same(straight.infill, resumed.infill);
}

/// What a particle that leaves asks for is a list built at once, with the skin that was found best last.
TEST(IndividualSteps, GoOnWithTheSameListWhenSavedAsAParticleLeaves) {
  SphSettings settings = LayeredBlock::settings_of(8, test::Preset::accurate, true);
  const Lattice lattice = LayeredBlock::lattice_of();
  settings.box.high.z() = (stiff_rows + soft_rows) * pitch;  // half a pitch above the top
  const auto make = [&] { return std::make_unique<SphInfill>(lattice, test::stiff_and_soft(), settings); };
  const auto straight = make(), resumed = make();
  const std::size_t top = lattice.position.size() - 1;
  straight->set_velocity(top, {0, 0, 60});
  for (int k = 0; straight->expelled().particles == 0; ++k) {
    ASSERT_LT(k, 1000);
    straight->advance(0.7 * straight->stable_step(), 1, {});
  }
  const std::filesystem::path first = saved(*straight, "tuft_leaves");
  const auto skin_of = [](const h5::Group& group, const char* which) { return group.read_double(which); };
  {
    const h5::File file = h5::File::open(first);
    const h5::Group group = file.root().open_group("infill");
    ASSERT_NE(skin_of(group, "list_skin"), skin_of(group, "list_next_skin")) << "the case in question";
    resumed->load(group);
  }
  std::vector<double> skins;
  for (SphInfill* infill : {straight.get(), resumed.get()}) {
    infill->advance(0.7 * infill->stable_step(), 1, {});
    const std::filesystem::path second = saved(*infill, "tuft_left");
    skins.push_back(skin_of(h5::File::open(second).root().open_group("infill"), "list_skin"));
    std::filesystem::remove(second);
  }
  std::filesystem::remove(first);
  EXPECT_EQ(skins[0], skins[1]);
  for (SphInfill* infill : {straight.get(), resumed.get()})
    for (int k = 0; k < 200; ++k) infill->advance(0.7 * infill->stable_step(), 1, {});
  test::expect_same(*straight, *resumed);
}

TEST(IndividualSteps, OfAFallingBlockAreThoseOfFreeFall) {
  Lattice lattice = LayeredBlock::lattice_of();
  SphSettings settings = LayeredBlock::settings_of(8, test::Preset::accurate, true);
  settings.gravity = {0, 0, -9.81};
  SphInfill infill(lattice, test::stiff_and_soft(), settings);
  double time = 0;
  for (int k = 0; k < 203; ++k) {
    const double dt = (k < 100 ? 0.7 : 0.4) * infill.stable_step();  // the step changes under way
    infill.advance(dt, 1, {});
    time += dt;
  }
  const ParticleView p = infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    EXPECT_NEAR(p.z[i] - lattice.position.z[i], -0.5 * 9.81 * time * time, 1e-3 * 9.81 * time * time) << i;
}

TEST(IndividualSteps, FallAsFarWhereKicksAreCutShortToHaveEnergiesOfOneMoment) {
  SphSettings settings = LayeredBlock::settings_of(8, test::Preset::accurate, true);
  settings.gravity = {0, 0, -9.81};
  settings.kick_length = KickLength::step_begun;
  const Lattice lattice = LayeredBlock::lattice_of();
  SphInfill infill(lattice, test::stiff_and_soft(), settings);
  const double dt = 0.7 * infill.stable_step();
  const int steps = 800;
  int current = 0;
  for (int k = 1; k <= steps; ++k) {
    const bool wanted = k % 25 == 0;  // meets no multiple of 8 before 200 steps are over
    infill.begin_window(dt, 1, wanted);
    infill.advance(dt, 1, {});
    if (wanted && infill.energy_is_current()) ++current;
  }
  EXPECT_GE(current, 8);
  const double time = steps * dt, fallen = 0.5 * 9.81 * time * time;
  const ParticleView p = infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    EXPECT_NEAR(lattice.position.z[i] - p.z[i], fallen, 0.005 * fallen) << i;
}

TEST(IndividualSteps, AreNotTakenWithinAWindowOfSeveral) {
  LayeredBlock block(8, test::Preset::accurate, true);
  block.strike(3);
  const double dt = 0.7 * block.infill.stable_step();
  block.advance(dt, 20);
  block.infill.begin_window(4 * dt, 4, true);
  EXPECT_TRUE(block.infill.particles().kicks.empty()) << "contact's impulse is of the whole window";
  const std::uint64_t before = block.infill.particle_steps();
  block.infill.advance(4 * dt, 4, {});
  EXPECT_EQ(block.infill.particle_steps() - before, 4 * block.lattice.position.size());
}

TEST(IndividualSteps, OtherThanPowersOfTwoUpToSixteenAreRefused) {
  for (const int wrong : {0, 3, 32}) EXPECT_THROW(IndividualSteps(wrong, 0.8, 100), InputError) << wrong;
}

}  // namespace
}  // namespace tuft::sph
