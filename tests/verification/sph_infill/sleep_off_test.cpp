/// Sleep switched off is no sleep: the same bits as where it is on and nothing ever rests.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/unit/sph_infill/sph_test_support.h"
#include "tests/verification/sph_infill/cases/same_bits.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;
/// Under it nothing that moves at all is at rest, so nothing sleeps; the rest of what sleep does is done.
constexpr double smallest_tolerance = 1e-300;

struct Run {
  test::Preset preset;
  int individual_steps;
  friend void PrintTo(const Run& r, std::ostream* os) {
    PrintTo(r.preset, os);
    *os << " individual steps " << r.individual_steps;
  }
};

/// A bed of yielding mixture in its tray, all of which is in motion; its upper half soft.
class StruckBed {
 public:
  /// sleep_tolerance: none, where it is left as settings have it.
  StruckBed(const Run& run, std::optional<double> sleep_tolerance)
      : infill_(lattice(), materials(), settings_of(run, sleep_tolerance)),
        tray_(width * pitch, width * pitch, stiffness, 0.1) {
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> any(-0.5, 0.5);
    const ParticleView p = infill_.particles();
    for (std::size_t i = 0; i < p.size(); ++i)
      infill_.set_velocity(i, Vec3(any(random), any(random), any(random)) +
                                  (p.z[i] > 12 * pitch ? Vec3(0.3, 0.1, -3) : Vec3(0, 0, 0)));
    infill_.set_damping(20);
  }
  void run(int windows) {
    ContactImpulses contact;
    for (int k = 0; k < windows; ++k) {
      const double window = std::min(0.6 * infill_.stable_step(), 1e-5);
      infill_.begin_window(window, 1, true);
      const ParticleView p = infill_.particles();
      tray_.push(p, window, contact);
      if (!p.kicks.empty())  // at particles' own kicks alone, for as long as they last
        for (std::size_t i = 0; i < p.size(); ++i)
          contact.linear.set(i, p.kicks.length[i / p.kicks.group] / window * contact.linear[i]);
      infill_.advance(window, 1, contact);
    }
  }
  [[nodiscard]] SphInfill& infill() { return infill_; }

 private:
  static constexpr int width = 8, rows = 14;
  static constexpr double stiffness = 10 * 4e6 * pitch;

  static Lattice lattice() {
    Lattice block = test::block(width, width, rows, pitch);
    for (std::size_t i = 0; i < block.position.size(); ++i)
      block.material[i] = block.position.z[i] > 6 * pitch ? 1 : 0;
    return block;
  }
  static std::vector<Material> materials() {
    std::vector<Material> both = test::single_material(test::elastic_material(50e6, 1600));
    both.push_back(test::single_material(test::mixture_material()).front());
    return both;
  }
  static SphSettings settings_of(const Run& run, std::optional<double> sleep_tolerance) {
    SphSettings settings;
    settings.options = test::options_of(run.preset, pitch);
    settings.zero_energy_control = run.preset != test::Preset::paper;
    settings.individual_steps = run.individual_steps;
    if (sleep_tolerance) settings.sleep_tolerance = *sleep_tolerance;
    return settings;
  }

  SphInfill infill_;
  test::Tray tray_;
};

class SleepSwitchedOff : public testing::TestWithParam<Run> {};
INSTANTIATE_TEST_SUITE_P(Runs, SleepSwitchedOff,
                         testing::Values(Run{test::Preset::accurate, 1}, Run{test::Preset::fast, 1},
                                         Run{test::Preset::paper, 1}, Run{test::Preset::accurate, 8},
                                         Run{test::Preset::paper, 8}));

/// Lists of neighbours are made otherwise there, of blocks as they are needed and with another skin, and
/// every loop goes over blocks chosen in place of all: no bit of the results may hang on any of it.
TEST_P(SleepSwitchedOff, GivesTheBitsOfABedThatMayFallAsleepAndNeverDoes) {
  StruckBed never(GetParam(), std::nullopt), off(GetParam(), 0), on(GetParam(), smallest_tolerance);
  never.run(150), off.run(150), on.run(150);
  EXPECT_GT(off.infill().energy().dissipated, 0);
  test::expect_same(never.infill(), off.infill());
  test::expect_same(off.infill(), on.infill());
}

/// And leaves nothing in a checkpoint.
TEST_P(SleepSwitchedOff, IsNoPartOfACheckpoint) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tuft_sleep_off_" + std::to_string(getpid()) + ".h5");
  StruckBed off(GetParam(), 0), on(GetParam(), smallest_tolerance);
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group of_off = file.root().create_group("off"), of_on = file.root().create_group("on");
    off.infill().save(of_off), on.infill().save(of_on);
    file.commit();
  }
  const h5::File file = h5::File::open(path);
  EXPECT_FALSE(file.root().has("off/sleep_held"));
  EXPECT_TRUE(file.root().has("on/sleep_held"));
  for (const std::string& name : file.root().open_group("off").names()) EXPECT_NE(name.substr(0, 5), "sleep");
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tuft::sph
