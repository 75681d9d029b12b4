/// `tuft micro`: what a run recorded of its micro-scale, and what it says where there is nothing.
#include <algorithm>

#include "cli/commands/command.h"

namespace tuft::test {
namespace {

Outcome recorded_run(const std::string& folder, const std::vector<std::string>& more) {
  std::vector<std::string> words{"run"};
  const auto scene = tiny_scene();
  words.insert(words.end(), scene.begin(), scene.end());
  words.insert(words.end(), {"--out", folder});
  words.insert(words.end(), more.begin(), more.end());
  return run_tuft(words);
}

TEST(Micro, PrintsContactsAndFieldsOfAFrameAndWritesThemAsCsv) {
  const Workplace place;
  const std::string folder = place.path("run"), csv = place.path("contacts.csv");
  const Outcome run =
      recorded_run(folder, {"--set", "output.micro.contacts=true", "--set", "output.micro.fields=true"});
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

TEST(Micro, OfARunThatRecordedNothingSaysHowToAskForIt) {
  const Workplace place;
  ASSERT_EQ(recorded_run(place.path("run"), {}).exit_code, 0);
  expect_bad_input(run_tuft({"micro", place.path("run")}),
                   {"neither contacts nor fields", "output.micro.contacts"});
}

}  // namespace
}  // namespace tuft::test
