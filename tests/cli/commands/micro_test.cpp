/// `tuft micro`: what a run recorded of its micro-scale, what its checkpoint holds of it on demand, and what
/// is said where there is nothing.
#include <algorithm>
#include <map>

#include "cli/commands/command.h"
#include "core/hdf5_file.h"

namespace tuft::test {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> looking{"--set", "output.micro.contacts=true", "--set",
                                       "output.micro.fields=true"};
const std::vector<std::string> of_grains{
    "--infill", "dem",
    "--set",    "infill.dem.material_coarse_graining={ sbr = 7.0, sand = 9.0 }",
    "--set",    "infill.dem.use_cache=false",
    "--set",    "infill.dem.settle_time=1 ms"};

using Words = std::vector<std::string>;

Outcome recorded_run(const std::string& folder, const std::vector<Words>& more) {
  Words words{"run"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--out", folder});
  for (const Words& part : more) words.insert(words.end(), part.begin(), part.end());
  return run_tuft(words);
}

/// All but the first line, which says where the moment is from.
std::string tables(const Outcome& micro) {
  EXPECT_EQ(micro.exit_code, 0) << micro.error;
  return micro.out.substr(micro.out.find('\n'));
}

std::string first_line(const Outcome& micro) {
  return micro.out.substr(0, micro.out.find('\n'));
}

/// What each file of a folder holds.
std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[entry.path().string()] = read_text(entry.path());
  return files;
}

TEST(Micro, PrintsContactsAndFieldsOfAFrameAndWritesThemAsCsv) {
  const Workplace place;
  const std::string folder = place.path("run"), csv = place.path("contacts.csv");
  const Outcome run = recorded_run(folder, {looking});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Outcome micro = run_tuft({"micro", folder, "--frame", "3", "--csv", csv});
  ASSERT_EQ(micro.exit_code, 0) << micro.error;
  for (const char* part : {"sph, frame 3 at ", "contacts_body", "fields by height", "stress zz Pa"})
    EXPECT_NE(micro.out.find(part), std::string::npos) << part;
  const std::string text = read_text(csv);
  EXPECT_EQ(text.rfind("kind,particle,other,", 0), 0u);
  EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 1);
  expect_bad_input(run_tuft({"micro", folder, "--frame", "99"}), {"no frame 99"});
}

class MicroOfACheckpoint : public ::testing::TestWithParam<const char*> {
 protected:
  [[nodiscard]] Words infill() const { return std::string(GetParam()) == "dem" ? of_grains : Words{}; }
  const Workplace place_;
  const std::string folder_ = place_.path("run");
};
INSTANTIATE_TEST_SUITE_P(Approaches, MicroOfACheckpoint, ::testing::Values("sph", "dem"));

TEST_P(MicroOfACheckpoint, IsThatOfTheFrameOfItsMoment) {
  const Words stop{"--stop-after-checkpoints", "2"};
  const Outcome run = recorded_run(folder_, {infill(), looking, stop});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const std::string of_frame = place_.path("frame.csv"), of_checkpoint = place_.path("checkpoint.csv");
  const Outcome frame = run_tuft({"micro", folder_, "--csv", of_frame}),
                checkpoint = run_tuft({"micro", folder_, "--checkpoint", "--csv", of_checkpoint});
  const std::string at = first_line(frame).substr(first_line(frame).find(" at "));
  EXPECT_EQ(first_line(checkpoint), GetParam() + std::string(", checkpoint") + at);
  EXPECT_EQ(tables(frame), tables(checkpoint));
  EXPECT_EQ(read_text(of_frame), read_text(of_checkpoint));
  EXPECT_GT(std::ranges::count(read_text(of_frame), '\n'), 100) << "contacts";
  const bool has_forces = frame.out.find("forces between particles") != std::string::npos;
  EXPECT_EQ(has_forces, std::string(GetParam()) == "dem");
}

TEST_P(MicroOfACheckpoint, IsTakenFromARunThatRecordedNothingAndChangesNothingThere) {
  const Outcome run = recorded_run(folder_, {infill()});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const auto before = files_in(folder_);
  const Outcome micro = run_tuft({"micro", folder_});
  ASSERT_EQ(micro.exit_code, 0) << micro.error;
  EXPECT_EQ(first_line(micro), GetParam() + std::string(", checkpoint at 1.000 ms"));
  for (const char* part : {"contacts_body", "fields by height", "stress zz Pa", "kg of infill"})
    EXPECT_NE(micro.out.find(part), std::string::npos) << part;
  EXPECT_EQ(files_in(folder_), before);
  expect_bad_input(run_tuft({"micro", folder_, "--frame", "0"}), {"neither contacts nor fields", "--frame"});

  const std::string out = place_.path("moment");
  const Outcome recorded = run_tuft({"micro", folder_, "--checkpoint", "--out", out});
  EXPECT_EQ(tables(recorded).rfind(tables(micro), 0), 0u) << "the same, and where it has been recorded";
  EXPECT_EQ(tables(run_tuft({"micro", out})), tables(micro));
  EXPECT_NE(read_text(fs::path(out) / "run.xdmf").find("frames/contacts/force"), std::string::npos);
  expect_bad_input(run_tuft({"micro", folder_, "--checkpoint", "--out", folder_}), {"already holds a run"});
}

/// There SPH infill is made of spheres.
TEST(Micro, OfACheckpointUnderTheConditioningPlateIsThatOfTheFrameOfItsMoment) {
  const Workplace place;
  const Words pressed{"--set",
                      "conditioning.method=compaction",
                      "--set",
                      "conditioning.press_time=2 ms",
                      "--set",
                      "conditioning.lift_time=1 ms",
                      "--set",
                      "conditioning.settle_time=1 ms",
                      "--set",
                      "conditioning.frames=0.4 ms",
                      "--stop-after-checkpoints",
                      "2"};
  const Outcome run = recorded_run(place.path("run"), {looking, pressed});
  ASSERT_EQ(run.exit_code, 0) << run.error;
  const Outcome frame = run_tuft({"micro", place.path("run")}),
                checkpoint = run_tuft({"micro", place.path("run"), "--checkpoint"});
  EXPECT_EQ(first_line(checkpoint), "sph, checkpoint at -3.600 ms");
  EXPECT_EQ(first_line(frame), "sph, frame 2 at -3.600 ms");
  EXPECT_EQ(tables(frame), tables(checkpoint));
}

TEST(Micro, OfACheckpointTakesAnotherGrid) {
  const Workplace place;
  ASSERT_EQ(recorded_run(place.path("run"), {}).exit_code, 0);
  const auto look = [&](const char* cell, const char* width) {
    return run_tuft({"micro", place.path("run"), "--checkpoint", "--cell", cell, "--width", width});
  };
  EXPECT_NE(look("20 mm", "30 mm").out.find("(coarse-graining width 30.0 mm)"), std::string::npos);
  EXPECT_NE(look("20 mm", "30 mm").out.find("  4 x 4 x 3 cells hold "), std::string::npos)
      << look("20 mm", "30 mm").out;
  expect_bad_input(look("20 kg", "30 mm"), {"output.micro.cell", "20 kg"});
  expect_bad_input(run_tuft({"micro", place.path("run"), "--cell", "2 mm"}), {"--checkpoint"});
}

TEST(Micro, WithoutACheckpointThatItCanReadSaysWhy) {
  const Workplace place;
  const std::string folder = place.path("run"), checkpoint = place.path("run/checkpoint.h5");
  ASSERT_EQ(recorded_run(folder, {}).exit_code, 0);
  const std::string whole = read_text(checkpoint);

  place.write("run/checkpoint.h5", whole.substr(0, whole.size() / 2));
  expect_bad_input(run_tuft({"micro", folder}), {checkpoint, "truncated or damaged"});
  {
    h5::File other = h5::File::create_atomically(checkpoint);
    h5::Group root = other.root();
    root.write_scalar("format", std::uint64_t{3});
    other.commit();
  }
  expect_bad_input(run_tuft({"micro", folder}), {checkpoint, "checkpoint format 3 is not the format"});
  fs::remove(checkpoint);
  expect_bad_input(run_tuft({"micro", folder}),
                   {folder, "neither contacts nor fields", "no checkpoint", "output.micro.contacts"});
  expect_bad_input(run_tuft({"micro", folder, "--checkpoint"}), {folder, "no checkpoint"});
  expect_bad_input(run_tuft({"micro", folder, "--checkpoint", "--frame", "1"}), {"--frame"});
  expect_bad_input(run_tuft({"micro", place.path("nowhere")}), {"nowhere", "not the folder of a run"});

  place.write("strand/scene.toml", read_text("inputs/strand_tension.toml"));
  place.write("strand/checkpoint.h5", whole);
  expect_bad_input(run_tuft({"micro", place.path("strand")}), {"strand_tension", "no infill"});
}

}  // namespace
}  // namespace tuft::test
