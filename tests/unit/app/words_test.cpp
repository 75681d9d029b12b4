#include <gtest/gtest.h>

#include "app/command_line.h"
#include "app/html.h"
#include "app/progress_display.h"
#include "app/text_table.h"
#include "core/error.h"

namespace tuft::app {
namespace {

TEST(NearestWord, FindsASlipOfTheFingersAndLeavesOtherWordsAlone) {
  const std::vector<std::string> verbs{"run", "resume", "check", "compare"};
  EXPECT_EQ(nearest_word("rnu", verbs), "run");
  EXPECT_EQ(nearest_word("comapre", verbs), "compare");
  EXPECT_EQ(nearest_word("frobnicate", verbs), "");
}

TEST(ParseSettings, SplitsAtTheFirstEqualsSign) {
  const Overrides overrides = parse_settings({"rig.clegg.speed=2 m/s", "a=b=c"});
  ASSERT_EQ(overrides.size(), 2u);
  EXPECT_EQ(overrides[0].first, "rig.clegg.speed");
  EXPECT_EQ(overrides[0].second, "2 m/s");
  EXPECT_EQ(overrides[1].second, "b=c");
}

TEST(ParseSettings, RefusesTextWithoutKeyOrValue) {
  EXPECT_THROW((void)parse_settings({"numerics.seed"}), InputError);
  EXPECT_THROW((void)parse_settings({"=2"}), InputError);
}

TEST(TextTable, AlignsNumbersToTheRightByCharactersNotBytes) {
  TextTable table({"", "SPH"});
  table.add({"step", "1.2 µs"});
  table.add({"carpet step", "12.5 ms"});
  EXPECT_EQ(table.text(""), "                 SPH\nstep          1.2 µs\ncarpet step  12.5 ms\n");
}

TEST(EscapeHtml, LeavesNothingThatCouldOpenATag) {
  EXPECT_EQ(escape_html("<b> & \"x\" 'y'"), "&lt;b&gt; &amp; &quot;x&quot; &#39;y&#39;");
}

TEST(ProgressLine, SaysStageTimeShareEnergyErrorAndTimeLeft) {
  rigs::Progress progress{"drop", 0.0075, 0.03, 1234, 0.00012, 12.3, 40};
  const std::string line = progress_line(progress);
  for (const char* part : {"drop", "7.50 of 30.0 ms", "25 %", "1 234", "0.012 %", "12.3 s", "40.0 s to go"})
    EXPECT_NE(line.find(part), std::string::npos) << part << " is missing in: " << line;
}

TEST(ProgressLine, SaysNothingOfTimeLeftBeforeItIsKnown) {
  rigs::Progress progress{"packing", 0, 0.03, 0, 0, 2.0, -1};
  EXPECT_EQ(progress_line(progress).find("to go"), std::string::npos);
}

}  // namespace
}  // namespace tuft::app
