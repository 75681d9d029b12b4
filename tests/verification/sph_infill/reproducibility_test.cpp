/// The same bits for any number of threads, and across a checkpoint.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/unit/sph_infill/sph_test_support.h"
#include "tests/verification/sph_infill/cases/same_bits.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

/// A bed of yielding mixture hit from above on a fifth of its surface: plastic flow, tension, viscosity,
/// damping, contact and several rebuilt neighbour lists.
struct StruckBed {
  SphInfill infill;
  test::Tray tray;

  explicit StruckBed(test::Preset preset, int width = 10, const SoilEffects& effects = {})
      : infill(test::block(width, width, 10, pitch), test::single_material(test::mixture_with_effects()),
               settings_of(preset, effects)),
        tray(width * pitch, width * pitch, 10 * 4e6 * pitch, 0.1) {}
  static SphSettings settings_of(test::Preset preset, const SoilEffects& effects) {
    SphSettings settings;
    settings.options = test::options_of(preset, pitch);
    settings.soil_effects = effects;
    return settings;
  }
  void strike() {
    const ParticleView p = infill.particles();
    for (std::size_t i = 0; i < p.size(); ++i)
      if (p.z[i] > 8 * pitch && p.x[i] < -2 * pitch) infill.set_velocity(i, {0.3, 0.1, -6});
    infill.set_damping(20);
  }
  void run(int windows) {
    ContactImpulses contact;
    for (int k = 0; k < windows; ++k) {
      const double window = 0.7 * infill.stable_step();
      tray.push(infill.particles(), window, contact);
      infill.advance(window, 2, contact);
    }
  }
};

class Reproducibility : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, Reproducibility,
                         testing::Values(test::Preset::accurate, test::Preset::paper));

void expect_same_on_one_and_two_threads(test::Preset preset, const SoilEffects& effects) {
  const int threads = omp_get_max_threads();
  StruckBed one(preset, 10, effects), two(preset, 10, effects);
  one.strike();
  two.strike();
  set_threads(1);
  one.run(40);
  set_threads(2);
  two.run(40);
  set_threads(threads);
  EXPECT_GT(one.infill.energy().dissipated, 0);
  test::expect_same(one.infill, two.infill);
}

struct TemporaryFile {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tuft_sph_checkpoint_" + std::to_string(getpid()) + ".h5");
  ~TemporaryFile() { std::filesystem::remove(path); }
};

void expect_same_when_continued(test::Preset preset, const SoilEffects& effects) {
  const TemporaryFile file;
  StruckBed straight(preset, 10, effects);
  straight.strike();
  // Not at a rebuild of the neighbour list: particles have moved since, and the row order is that of the
  // build.
  straight.run(23);
  {
    h5::File out = h5::File::create_atomically(file.path);
    h5::Group group = out.root().create_group("infill");
    straight.infill.save(group);
    out.commit();
  }
  straight.run(30);
  StruckBed resumed(preset, 10, effects);
  resumed.infill.load(h5::File::open(file.path).root().open_group("infill"));
  resumed.run(30);
  test::expect_same(straight.infill, resumed.infill);
}

TEST_P(Reproducibility, OneAndTwoThreadsGiveTheSameBits) {
  expect_same_on_one_and_two_threads(GetParam(), {});
}

TEST_P(Reproducibility, ARunThatWasSavedAndLoadedGoesOnWithTheSameBits) {
  expect_same_when_continued(GetParam(), {});
}

TEST(ReproducibilityOfSoilEffects, OneAndTwoThreadsGiveTheSameBits) {
  expect_same_on_one_and_two_threads(test::Preset::accurate, test::all_soil_effects);
}

TEST(ReproducibilityOfSoilEffects, ARunThatWasSavedAndLoadedGoesOnWithTheSameBits) {
  expect_same_when_continued(test::Preset::accurate, test::all_soil_effects);
}

TEST(ReproducibilityOfSoilEffects, EachOfThemChangesWhatABlowDoes) {
  const auto struck = [](const SoilEffects& effects) {
    StruckBed bed(test::Preset::paper, 6, effects);
    bed.strike();
    bed.run(20);
    return bed.infill.energy().dissipated;
  };
  const double without = struck({});
  for (const SoilEffects& effects :
       {SoilEffects{.density_hardening = true}, SoilEffects{.strength_softening = true},
        SoilEffects{.strength_rate = true}, SoilEffects{.dilation = true}, SoilEffects{.shear_energy = true},
        SoilEffects{.inertial_friction = true}})
    EXPECT_GT(std::abs(struck(effects) - without), 1e-6 * without);
  EXPECT_NE(struck({.strength_softening = true, .strength_recovery = true}),
            struck({.strength_softening = true}));
}

TEST_P(Reproducibility, ACheckpointOfAnotherSceneIsRejected) {
  const TemporaryFile file;
  StruckBed bed(GetParam()), other(GetParam(), 8);
  {
    h5::File out = h5::File::create_atomically(file.path);
    h5::Group group = out.root().create_group("infill");
    bed.infill.save(group);
    out.commit();
  }
  try {
    other.infill.load(h5::File::open(file.path).root().open_group("infill"));
    FAIL() << "loaded";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1000 values instead of 640"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace tuft::sph
