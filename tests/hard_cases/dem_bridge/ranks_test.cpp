/// A host on several MPI ranks: the same physics, the same clear ends.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <sstream>

#include "core/error.h"
#include "dem_bridge/scratch_folder.h"
#include "tests/hard_cases/dem_bridge/traces.h"
#include "tests/verification/dem_bridge/bridge_scene.h"
#include "tests/verification/same_energy.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

class Ranks : public Traces {
 protected:
  Ranks() {
    settings_.rolling_resistance = true;
    settings_.options.answer_timeout = 60;
  }
  std::unique_ptr<DemInfill> start(int ranks) {
    DemSettings settings = settings_;
    settings.options.ranks = ranks;
    auto infill = std::make_unique<DemInfill>(block_.grains, block_.materials, settings);
    return infill;
  }
  std::unique_ptr<DemInfill> shaken(int ranks) {
    auto infill = start(ranks);
    block_.shake(*infill, 0.5);
    return infill;
  }
  void advance(DemInfill& infill, int windows) const {
    const double window = 2 * 0.5 * infill.stable_step();
    for (int k = 0; k < windows; ++k) {
      infill.begin_window(window, 2, k + 1 == windows);
      infill.advance(window, 2, block_.confine(infill, window));
    }
  }
  static double largest_difference(const DemInfill& a, const DemInfill& b) {
    const ParticleView one = a.particles(), two = b.particles();
    double largest = 0;
    for (std::size_t i = 0; i < one.size(); ++i)
      largest = std::max(largest, (one.velocity(i) - two.velocity(i)).norm());
    return largest;
  }
  /// What is said when `blow` has fallen on a run of two ranks, of which nothing is left. `blow` gets what
  /// started them and then all below it.
  std::string end_of_two(const std::function<void(const std::vector<int>&)>& blow) {
    const auto infill = shaken(2);
    advance(*infill, 1);
    std::vector<int> all = descendants(infill->host_process());
    EXPECT_GE(all.size(), 2u);
    all.insert(all.begin(), infill->host_process());
    blow(all);
    // Ranks may know of it a moment later only, and answer till then.
    const std::string message = message_of<RunError>([&] { advance(*infill, 1'000'000); });
    EXPECT_TRUE(is_one_line(message)) << message;
    for (const int process : all) EXPECT_TRUE(gone_within(process, 3.0)) << process;
    return message;
  }
  void save(DemInfill& infill) const {
    auto file = h5::File::create_atomically(file_);
    h5::Group group = file.root();
    infill.save(group);
    file.commit();
  }
  ~Ranks() override { fs::remove(file_); }

  ShakenBlock block_{6};
  DemSettings settings_ = settings_in_box(0.05, Vec3(0, 0, -9.81));
  fs::path file_ = fs::temp_directory_path() / ("tuft-ranks-" + std::to_string(::getpid()) + ".h5");
};

TEST_F(Ranks, TwoMoveGrainsAsOneDoesUpToRoundOff) {
  const auto one = shaken(1), two = shaken(2);
  advance(*one, 60);
  advance(*two, 60);
  EXPECT_LT(largest_difference(*one, *two), 1e-10) << "m/s, of 0.5";
  const InfillEnergy e1 = one->energy(), e2 = two->energy();
  EXPECT_GT(e1.stored, 0);
  EXPECT_NEAR(e2.stored, e1.stored, 1e-9 * e1.stored);
  EXPECT_NEAR(e2.kinetic, e1.kinetic, 1e-9 * e1.kinetic);
  EXPECT_NEAR(e2.dissipated, e1.dissipated, 1e-9 * e1.kinetic);
  const auto o1 = one->overlaps(), o2 = two->overlaps();
  ASSERT_GT(o1.contacts, 50u);
  EXPECT_EQ(o2.contacts, o1.contacts) << "contacts between ranks count once";
  EXPECT_NEAR(o2.mean, o1.mean, 1e-9 * o1.mean);
  EXPECT_NEAR(two->largest_overlaps()[0].largest_of_run, one->largest_overlaps()[0].largest_of_run, 1e-9);
  const ContactNetwork c1 = one->contacts(), c2 = two->contacts();
  ASSERT_EQ(c2.particle, c1.particle);
  ASSERT_EQ(c2.other, c1.other);
  for (std::size_t c = 0; c < c1.other.size(); ++c)
    ASSERT_LT((c2.force(c) - c1.force(c)).norm(), 1e-6) << "N, of contact " << c;
  EXPECT_EQ(one->fields()[0].values, two->fields()[0].values) << "coordination";
}

/// Collisions make the last digit grow. Two ranks add forces in another order, and may part from one no
/// faster than one does from itself when grains are nudged by the last digit; what a bed is measured by stays
/// the same.
TEST_F(Ranks, TwoPartFromOneAsOnePartsFromItselfNudgedByTheLastDigit) {
  const auto one = shaken(1), two = shaken(2), nudged = shaken(1);
  for (std::size_t i = 0; i < block_.grains.size(); ++i)
    nudged->set_velocity(i, nudged->particles().velocity(i) * (1 + 4e-16), nudged->particles().spin(i));
  for (const int windows : {60, 240, 700, 1500}) {
    for (const auto* run : {&one, &two, &nudged}) advance(**run, windows);
    const double of_ranks = largest_difference(*one, *two), of_nudge = largest_difference(*one, *nudged);
    RecordProperty("after_" + std::to_string(windows), fmt::format("{:.1e} {:.1e}", of_ranks, of_nudge));
    EXPECT_LT(of_ranks, 100 * of_nudge + 1e-14) << "m/s, after " << windows << " more windows";
  }
  const auto scale = one->energy().kinetic + one->energy().stored + one->energy().dissipated;
  EXPECT_NEAR(two->energy().dissipated, one->energy().dissipated, 1e-3 * scale);
  EXPECT_NEAR(two->energy().gravity_potential, one->energy().gravity_potential, 1e-3 * scale);
  const double contacts = static_cast<double>(one->contacts().size());
  EXPECT_NEAR(static_cast<double>(two->contacts().size()), contacts, 0.1 * contacts)
      << "collisions of a block that flies apart: by now they are others";
}

TEST_F(Ranks, GoOnFromACheckpointToTheBit) {
  const auto whole = shaken(2);
  advance(*whole, 60);
  save(*whole);
  const auto resumed = start(2);
  resumed->load(h5::File::open(file_).root());
  advance(*whole, 60);
  advance(*resumed, 60);
  EXPECT_EQ(largest_difference(*whole, *resumed), 0);
  tuft::test::expect_same_energy(whole->energy(), resumed->energy());
}

TEST_F(Ranks, AGrainThatLeavesOnTheOtherRankIsBookedAsOnOne) {
  Grains grains;
  add_grain(grains, Vec3(-0.03, 0, 0), 0.001, 1150);
  add_grain(grains, Vec3(0.0495, 0, 0), 0.001, 1150);
  std::vector<Expelled> expelled;
  for (const int ranks : {1, 2}) {
    settings_.options.ranks = ranks;
    DemInfill infill(grains, block_.materials, settings_);
    infill.set_velocity(1, Vec3(3, 0, 0), Vec3(0, 0, 0));
    for (int k = 0; k < 300; ++k) infill.advance(1e-6, 1, no_impulses(2));
    expelled.push_back(infill.expelled());
  }
  EXPECT_EQ(expelled[1].particles, 1u);
  EXPECT_EQ(expelled[1].momentum, expelled[0].momentum);
  EXPECT_EQ(expelled[1].kinetic_energy, expelled[0].kinetic_energy);
}

TEST_F(Ranks, KillingOneIsAClearErrorAndEndsAll) {
  const std::string message = end_of_two([](const std::vector<int>& all) { ::kill(all.back(), SIGKILL); });
  EXPECT_NE(message.find("liggghts_host ended with exit code"), std::string::npos) << message;
  EXPECT_NE(message.find("exited on signal 9 (Killed)"), std::string::npos) << message;
}

TEST_F(Ranks, StoppingOneIsAClearErrorAfterTheTimeoutAndEndsAll) {
  settings_.options.answer_timeout = 6;
  const auto begin = std::chrono::steady_clock::now();
  const std::string message = end_of_two([](const std::vector<int>& all) { ::kill(all.back(), SIGSTOP); });
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 15);
  EXPECT_NE(message.find("liggghts_host did not answer for 6 s"), std::string::npos) << message;
}

TEST_F(Ranks, KillingWhatStartedThemIsAClearErrorAndEndsAll) {
  const std::string message = end_of_two([](const std::vector<int>& all) { ::kill(all.front(), SIGKILL); });
  EXPECT_NE(message.find("liggghts_host ended with signal 9"), std::string::npos) << message;
}

/// The first rank alone opens restart files. A folder of that name is in its way; the other one waits for it.
TEST_F(Ranks, AnErrorOfLiggghtsOnOneAloneComesWithItsWordsAndEndsAll) {
  const auto infill = shaken(2);
  advance(*infill, 1);
  for (const auto& scratch : fs::directory_iterator(folder()))
    fs::create_directory(scratch.path() / "restart");
  const std::vector<int> all = descendants(infill->host_process());
  ASSERT_GE(all.size(), 2u);
  const std::string message = message_of<RunError>([&] { save(*infill); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("Cannot open restart file"), std::string::npos) << message;
  for (const int process : all) EXPECT_TRUE(gone_within(process, 3.0)) << process;
}

TEST_F(Ranks, AnErrorOfLiggghtsComesWithItsWords) {
  block_.materials[0].grain->restitution = 0.01;  // LIGGGHTS wants 0.05 to 1
  const std::string message = message_of<RunError>([&] { (void)start(2); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("oefficientRestitution"), std::string::npos) << message;
}

TEST_F(Ranks, AllEndWhenTheirDriverIsKilled) {
  int pipe_ends[2];
  ASSERT_EQ(::pipe(pipe_ends), 0);
  const pid_t driver = ::fork();
  if (driver == 0) {
    const auto infill = shaken(2);
    advance(*infill, 1);
    std::vector<int> all = descendants(infill->host_process());
    all.push_back(infill->host_process());
    all.resize(8, 0);
    if (::write(pipe_ends[1], all.data(), 8 * sizeof(int)) != 8 * sizeof(int)) ::_exit(1);
    ::raise(SIGKILL);
  }
  std::vector<int> all(8, 0);
  ASSERT_EQ(::read(pipe_ends[0], all.data(), 8 * sizeof(int)), static_cast<ssize_t>(8 * sizeof(int)));
  ::close(pipe_ends[0]);
  ::close(pipe_ends[1]);
  ASSERT_EQ(::waitpid(driver, nullptr, 0), driver);
  for (const int process : all)
    if (process != 0) {
      EXPECT_TRUE(gone_within(process, 5.0)) << process;
    }
  { const ScratchFolder next; }
}

}  // namespace
}  // namespace tuft::dem::test
