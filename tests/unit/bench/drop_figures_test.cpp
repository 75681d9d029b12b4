#include "bench/drop_figures.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <stdexcept>

#include "bench/child_program.h"

namespace tuft::bench {
namespace {

namespace fs = std::filesystem;

class DropFigures : public ::testing::Test {
 protected:
  DropFigures() {
    std::string name = (fs::temp_directory_path() / "tuft_drop_figures_XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~DropFigures() override { fs::remove_all(folder_); }

  /// A program in place of `tuft`: takes the same arguments and runs `body` with $infill, $threads and $out
  /// set.
  fs::path write_program(const std::string& body) {
    const fs::path path = folder_ / "program";
    std::ofstream(path) << "#!/bin/bash\ninfill=$4 threads=$6 out=$8\n" << body;
    fs::permissions(path, fs::perms::owner_all);
    return path;
  }
  [[nodiscard]] DropRequest request(const fs::path& program, int repetitions = 1) const {
    return {program, folder_ / "scene.toml", folder_, repetitions};
  }

  fs::path folder_;
};

TEST_F(DropFigures, CouplingShareLeavesOutWhatComesOnce) {
  const nlohmann::json cost{{"setup", 50.0},  {"packing", 70.0}, {"checkpoint", 20.0}, {"search", 1.0},
                            {"contact", 2.0}, {"exchange", 3.0}, {"waiting", 4.0},     {"carpet", 15.0},
                            {"infill", 5.0},  {"rig", 4.0},      {"ledger", 3.0},      {"record", 3.0}};
  EXPECT_DOUBLE_EQ(coupling_share(cost), 10.0 / 40.0);
}

TEST_F(DropFigures, CostWithoutStepsIsAnError) {
  EXPECT_THROW(static_cast<void>(coupling_share(nlohmann::json{{"setup", 1.0}})), std::runtime_error);
}

TEST_F(DropFigures, FastestRunOfEachKindCounts) {
  // wall_s is 12 in the first run of a kind and 7 + threads in the second.
  const fs::path program = write_program(R"(
count="$(dirname "$out")/count_${infill}_$threads"
wall=12; [[ -e $count ]] && wall=$((7 + threads)); touch "$count"
contact=1; [[ $infill == dem ]] && contact=3
mkdir -p "$out"
echo "{\"status\": \"completed\", \"wall_s\": $wall, \"cost\": {\"contact\": $contact, \"carpet\": 4}}" > "$out/summary.json"
)");
  const Figures figures = figures_of_drops(request(program, 2));
  EXPECT_EQ(figures.at("clegg_small_sph_wall/1").value, 8);
  EXPECT_EQ(figures.at("clegg_small_dem_wall/2").value, 9);
  EXPECT_EQ(figures.at("clegg_small_dem_wall/2").threads, 2);
  EXPECT_DOUBLE_EQ(figures.at("coupled_contact_share_sph/1").value, 1.0 / 5.0);
  EXPECT_DOUBLE_EQ(figures.at("coupled_contact_share/1").value, 3.0 / 7.0);
}

TEST_F(DropFigures, FailedRunPassesItsWordsOn) {
  const fs::path program = write_program("echo 'the host is missing' >&2; exit 1\n");
  try {
    static_cast<void>(figures_of_drops(request(program)));
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("ended with code 1:\nthe host is missing"), std::string::npos)
        << error.what();
  }
}

TEST_F(DropFigures, RunThatWasStoppedIsNoFigure) {
  const fs::path program = write_program(
      "mkdir -p \"$out\"; echo '{\"status\": \"stopped\", \"wall_s\": 1}' > \"$out/summary.json\"\n");
  EXPECT_THROW(static_cast<void>(figures_of_drops(request(program))), std::runtime_error);
}

TEST_F(DropFigures, ProgramThatIsNotThereIsAnError) {
  EXPECT_THROW(static_cast<void>(run_program({folder_ / "nothing"}, folder_ / "log")), std::runtime_error);
}

}  // namespace
}  // namespace tuft::bench
