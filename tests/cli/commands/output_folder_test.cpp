/// Where results may go, and what may be resumed.
#include "cli/commands/command.h"

namespace tuft::test {
namespace {

std::vector<std::string> run_into(const std::string& verb, const std::string& folder) {
  std::vector<std::string> words{verb};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--out", folder});
  return words;
}

TEST(OutputFolder, BelowARegularFileIsRefused) {
  const Workplace place;
  place.write("file", "x");
  for (const char* verb : {"run", "compare"})
    expect_bad_input(run_tuft(run_into(verb, place.path("file/run"))),
                     {"is not a folder", "choose another --out"});
}

TEST(OutputFolder, ThatIsARegularFileIsRefused) {
  const Workplace place;
  place.write("file", "x");
  expect_bad_input(run_tuft(run_into("run", place.path("file"))),
                   {"is not a folder", "choose another --out"});
}

TEST(OutputFolder, ThatCannotBeWrittenIsRefused) {
  expect_bad_input(run_tuft(run_into("run", "/proc/tuft/run")), {"/proc/tuft/run", "choose another --out"});
}

TEST(OutputFolder, ThatHoldsARunIsRefusedAndLeftAsItIs) {
  for (const char* mark : {"summary.json", "run.h5"}) {
    const Workplace place;
    place.write(std::string("old/") + mark, "precious");
    expect_bad_input(run_tuft(run_into("run", place.path("old"))),
                     {"already holds a run", "choose another --out or remove it"});
    EXPECT_EQ(read_text(place.path(std::string("old/") + mark)), "precious");
    EXPECT_FALSE(std::filesystem::exists(place.path("old/scene.toml")));
  }
}

TEST(OutputFolder, OfAComparisonWhoseMembersHoldARunIsRefusedBeforeAnythingRuns) {
  const Workplace place;
  place.write("old/dem/summary.json", "precious");
  expect_bad_input(run_tuft(run_into("compare", place.path("old"))), {"already holds a run"});
  EXPECT_FALSE(std::filesystem::exists(place.path("old/sph")));
}

TEST(Resume, OfAFolderThatDoesNotExistIsRefused) {
  expect_bad_input(run_tuft({"resume", "no/such/run"}), {"no/such/run"});
}

TEST(Resume, OfAFolderThatHoldsNoRunIsRefused) {
  const Workplace place;
  place.write("empty/note", "x");
  expect_bad_input(run_tuft({"resume", place.path("empty")}), {"no scene.toml"});
}

/// One stopped run serves the tests of broken checkpoints.
class BrokenCheckpoint : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    place_ = new Workplace;
    auto words = run_into("run", place_->path("run"));
    words.insert(words.end(), {"--infill", "sph", "--stop-after-checkpoints", "1"});
    outcome_ = run_tuft(words);
  }
  static void TearDownTestSuite() { delete place_; }
  void SetUp() override {
    ASSERT_EQ(outcome_.exit_code, 0) << outcome_.error;
    ASSERT_TRUE(std::filesystem::exists(place_->path("run/checkpoint.h5")));
    std::filesystem::copy(place_->path("run"), copy_.path("run"), std::filesystem::copy_options::recursive);
  }
  Workplace copy_;
  inline static Workplace* place_ = nullptr;
  inline static Outcome outcome_;
};

TEST_F(BrokenCheckpoint, ThatIsMissingIsNamed) {
  std::filesystem::remove(copy_.path("run/checkpoint.h5"));
  expect_bad_input(run_tuft({"resume", copy_.path("run")}), {"no checkpoint"});
}

TEST_F(BrokenCheckpoint, ThatIsTruncatedIsNamed) {
  const std::string file = copy_.path("run/checkpoint.h5");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  expect_bad_input(run_tuft({"resume", copy_.path("run")}), {"checkpoint.h5"});
}

TEST_F(BrokenCheckpoint, ThatIsEmptyIsNamed) {
  std::filesystem::resize_file(copy_.path("run/checkpoint.h5"), 0);
  expect_bad_input(run_tuft({"resume", copy_.path("run")}), {"checkpoint.h5"});
}

TEST_F(BrokenCheckpoint, OfAnotherSceneIsNamed) {
  // Another run of another scene, whose checkpoint is put in the place of this one's.
  auto words = run_into("run", copy_.path("other"));
  words.insert(words.end(), {"--infill", "sph", "--stop-after-checkpoints", "1", "--set", "rig.speed=2 m/s"});
  const Outcome other = run_tuft(words);
  ASSERT_EQ(other.exit_code, 0) << other.error;
  std::filesystem::copy_file(copy_.path("other/checkpoint.h5"), copy_.path("run/checkpoint.h5"),
                             std::filesystem::copy_options::overwrite_existing);
  expect_bad_input(run_tuft({"resume", copy_.path("run")}), {"checkpoint.h5", "another scene"});
}

TEST_F(BrokenCheckpoint, LeavesTheRecordsOfTheRunAsTheyWere) {
  std::filesystem::resize_file(copy_.path("run/checkpoint.h5"), 100);
  const std::string records = read_text(copy_.path("run/run.h5"));
  EXPECT_EQ(run_tuft({"resume", copy_.path("run")}).exit_code, 2);
  EXPECT_TRUE(read_text(copy_.path("run/run.h5")) == records);
}

}  // namespace
}  // namespace tuft::test
