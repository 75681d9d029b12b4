#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "rigs/run.h"
#include "rigs/run_folder.h"
#include "unit/app/fake_run.h"

namespace tuft::rigs {
namespace {

TEST(Summary, ComesBackFromItsFileAsItWasWritten) {
  const test::TemporaryFolder folder;
  RunSummary written = test::fake_summary({});
  written.error = "lost \"host\"\nand more";
  written.energy_error = 0.1 + 0.2;  // needs all 17 digits
  written.particles = (1ULL << 53) + 1;
  write_summary(folder.path(), written);
  const RunSummary read = read_summary(folder.path());
  EXPECT_EQ(summary_json(read), summary_json(written));
  EXPECT_EQ(read.energy_error, written.energy_error);
  EXPECT_EQ(read.particles, written.particles);
  EXPECT_EQ(read.error, written.error);
  ASSERT_EQ(read.effects.size(), written.effects.size());
  EXPECT_EQ(read.effects[0].name, written.effects[0].name);  // order kept
  EXPECT_EQ(read.results.at("peak_g").unit, "g");
}

TEST(Summary, HasEveryNameThatScriptsRelyOn) {
  const auto json = nlohmann::json::parse(summary_json(test::fake_summary({})));
  for (const char* key : {"status", "error", "rig", "approach", "results", "energy_error", "momentum_error",
                          "steps", "wall_s", "cost", "particles", "shells", "particle_steps_per_s",
                          "element_steps_per_s", "peak_memory_bytes", "effects", "version"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_TRUE(json["results"]["peak_g"].contains("value"));
  EXPECT_TRUE(json["results"]["peak_g"].contains("unit"));
  EXPECT_TRUE(json["effects"]["fibres"].contains("on"));
  EXPECT_TRUE(json["effects"]["fibres"].contains("why"));
}

TEST(Summary, ReadsBackAValueThatWasNeverMeasuredAsNanNotAsANumber) {
  const test::TemporaryFolder folder;
  RunSummary written = test::fake_summary({});
  written.momentum_error = std::nan("");
  written.results["peak_g"].value = std::numeric_limits<double>::infinity();
  write_summary(folder.path(), written);
  const RunSummary read = read_summary(folder.path());
  EXPECT_TRUE(std::isnan(read.momentum_error));
  EXPECT_TRUE(std::isnan(read.results.at("peak_g").value));
}

TEST(Summary, KeepsAnErrorTextThatIsNotUtf8) {
  RunSummary summary = test::fake_summary({});
  summary.error = "bad \xff byte";
  EXPECT_TRUE(nlohmann::json::accept(summary_json(summary)));
}

TEST(Summary, OfAFolderWithoutARunIsTheUsersMistake) {
  const test::TemporaryFolder folder;
  try {
    (void)read_summary(folder.path());
    FAIL() << "no error";
  } catch (const InputError& failure) {
    EXPECT_NE(std::string(failure.what()).find("no summary.json"), std::string::npos) << failure.what();
  }
}

TEST(Summary, ThatIsCutOffIsTheUsersMistakeWithTheFilesName) {
  const test::TemporaryFolder folder;
  const std::string whole = summary_json(test::fake_summary({}));
  write_text_file(folder.path() / "summary.json", whole.substr(0, whole.size() / 2));
  try {
    (void)read_summary(folder.path());
    FAIL() << "no error";
  } catch (const InputError& failure) {
    EXPECT_NE(std::string(failure.what()).find("summary.json"), std::string::npos) << failure.what();
  }
}

TEST(RunFolder, ThatHoldsARunIsRefusedWithWhatToDo) {
  for (const char* mark : {"summary.json", "run.h5", "checkpoint.h5"}) {
    const test::TemporaryFolder folder;
    write_text_file(folder.path() / mark, "x");
    try {
      check_run_folder(folder.path());
      FAIL() << "no error for " << mark;
    } catch (const InputError& failure) {
      EXPECT_NE(std::string(failure.what()).find("choose another --out or remove it"), std::string::npos)
          << failure.what();
    }
  }
}

TEST(RunFolder, BelowARegularFileIsRefusedAndNamesTheFile) {
  const test::TemporaryFolder folder;
  write_text_file(folder.path() / "file", "x");
  try {
    check_run_folder(folder.path() / "file" / "deeper" / "run");
    FAIL() << "no error";
  } catch (const InputError& failure) {
    EXPECT_NE(std::string(failure.what()).find((folder.path() / "file").string() + "' is not a folder"),
              std::string::npos)
        << failure.what();
  }
}

TEST(RunFolder, IsMadeWithTheResolvedSceneInIt) {
  const test::TemporaryFolder folder;
  prepare_run_folder(folder.path() / "a" / "b", test::fake_scene(Approach::dem));
  EXPECT_EQ(read_run_scene(folder.path() / "a" / "b").infill.approach, Approach::dem);
}

}  // namespace
}  // namespace tuft::rigs
