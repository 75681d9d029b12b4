/// The carpet alone: its size, its mesh as a file, and a mesh file instead of it.
#include "cli/commands/command.h"

namespace tuft::test {
namespace {

constexpr const char* scene = "inputs/clegg_small.toml";

std::vector<std::string> with_mesh(const std::string& verb, const std::string& file) {
  return {verb, scene, "--set", "turf.carpet.mesh=" + file};
}

TEST(Carpet, PrintsWhatItConsistsOf) {
  const Outcome outcome = run_tuft({"carpet", scene});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_TRUE(outcome.error.empty()) << outcome.error;
  for (const char* word : {"tufts", "strands", "elements", "nodes", "mass"})
    EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
}

TEST(Carpet, IsWrittenInTheFormatOfTheEnding) {
  const Workplace place;
  for (const auto& [name, beginning] :
       {std::pair{"a.vtk", "# vtk"}, {"a.vtu", "<?xml"}, {"a.msh", "$MeshFormat"}, {"a.k", "*KEYWORD"}}) {
    const Outcome outcome = run_tuft({"carpet", scene, "--out", place.path(name)});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_EQ(read_text(place.path(name)).rfind(beginning, 0), 0u) << name;
    EXPECT_NE(outcome.out.find("lengths in mm"), std::string::npos);
  }
}

TEST(Carpet, ThatWasWrittenIsTheSameWhenItIsReadAgain) {
  const Workplace place;
  for (const std::string name : {"a.msh", "a.k"}) {
    const Outcome generated = run_tuft({"carpet", scene, "--out", place.path(name)});
    const Outcome imported = run_tuft(with_mesh("carpet", place.path(name)));
    ASSERT_EQ(imported.exit_code, 0) << imported.error;
    const std::string counts = generated.out.substr(0, generated.out.find("mesh:"));
    EXPECT_EQ(imported.out.rfind(counts, 0), 0u) << imported.out;
    const Outcome checked = run_tuft(with_mesh("check", place.path(name)));
    ASSERT_EQ(checked.exit_code, 0) << checked.error;
    const Outcome expected = run_tuft({"check", scene});
    const auto first_line = [](const std::string& text) { return text.substr(0, text.find('\n')); };
    EXPECT_EQ(first_line(checked.out), first_line(expected.out));
    EXPECT_NE(checked.out.find("lengths taken as mm"), std::string::npos);
  }
}

TEST(Carpet, FromAFileIsRunAndResumedAsLongAsTheFileIsTheSame) {
  const Workplace place;
  ASSERT_EQ(run_tuft({"carpet", scene, "--out", place.path("a.msh")}).exit_code, 0);
  std::vector<std::string> words{"run"};
  for (const std::string& word : tiny_scene()) words.push_back(word);
  words.insert(words.end(), {"--set", "turf.carpet.mesh=" + place.path("a.msh"), "--out", place.path("run"),
                             "--stop-after-checkpoints", "1"});
  const Outcome stopped = run_tuft(words);
  ASSERT_EQ(stopped.exit_code, 0) << stopped.error;
  const std::string text = read_text(place.path("a.msh"));
  place.write("a.msh", text + "\n");
  expect_bad_input(run_tuft({"resume", place.path("run")}), {"a.msh", "mesh_content"});
  place.write("a.msh", text);
  const Outcome resumed = run_tuft({"resume", place.path("run")});
  EXPECT_EQ(resumed.exit_code, 0) << resumed.error;
}

TEST(Carpet, IntoAFormatOrFolderThatIsNoneIsRefused) {
  const Workplace place;
  expect_bad_input(run_tuft({"carpet", scene, "--out", place.path("a.stl")}), {"'.stl'", ".vtu"});
  EXPECT_FALSE(std::filesystem::exists(place.path("a.stl")));
  expect_bad_input(run_tuft({"carpet", scene, "--out", place.path("no/a.vtu")}),
                   {"no folder", "choose another --out"});
  expect_bad_input(run_tuft({"carpet", scene, "--out", place.path("a.vtu"), "--unit", "kg"}), {"--unit kg"});
  expect_bad_input(run_tuft({"carpet", scene, "--out", place.path("a.vtu"), "--unit=-1 mm"}),
                   {"--unit -1 mm", "positive"});
}

TEST(Carpet, IsNotWrittenOverTheFileItComesFrom) {
  const Workplace place;
  ASSERT_EQ(run_tuft({"carpet", scene, "--out", place.path("a.msh")}).exit_code, 0);
  auto words = with_mesh("carpet", place.path("a.msh"));
  words.insert(words.end(), {"--out", place.path("a.msh")});
  expect_bad_input(run_tuft(words), {"a.msh", "choose another --out"});
}

TEST(Carpet, FromABadFileIsRefusedWithFileAndLine) {
  const Workplace place;
  place.write("bad.k", "*KEYWORD\n*NODE\n1,0,0,zero\n*END\n");
  for (const char* verb : {"carpet", "check", "explain"})
    expect_bad_input(run_tuft(with_mesh(verb, place.path("bad.k"))), {"bad.k:3", "'zero'"});
  place.write("bad.msh", "$MeshFormat\n4.1 1 8\n");
  expect_bad_input(run_tuft(with_mesh("check", place.path("bad.msh"))), {"bad.msh:2", "binary"});
  expect_bad_input(run_tuft(with_mesh("check", place.path("gone.msh"))),
                   {"--set", "gone.msh", "no such file"});
}

TEST(Carpet, FromAFileOfAnotherSizeThanThePatchIsRefused) {
  const Workplace place;
  ASSERT_EQ(run_tuft({"carpet", scene, "--out", place.path("a.msh"), "--unit", "m"}).exit_code, 0);
  expect_bad_input(run_tuft(with_mesh("check", place.path("a.msh"))), {"a.msh", "turf.size", "mesh_unit"});
}

}  // namespace
}  // namespace tuft::test
