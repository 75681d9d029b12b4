#include "app/report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "core/error.h"
#include "rigs/run_folder.h"
#include "unit/app/fake_run.h"

namespace tuft::app {
namespace {

using test::FakeRun;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

FakeRun short_run(Approach approach) {
  FakeRun run;
  run.approach = approach;
  run.duration = 0.02;
  run.frame_interval = 0.002;
  return run;
}

std::string compared_page(const std::filesystem::path& folder) {
  test::write_fake_run(folder / "sph", short_run(Approach::sph));
  test::write_fake_run(folder / "dem", short_run(Approach::dem));
  write_report({folder}, folder / "report.html");
  return read_file(folder / "report.html");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
    ++found;
  return found;
}

/// Every tag that is opened is closed, in order: enough to catch a figure or table left open.
void expect_balanced(const std::string& html) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)[^>]*?(/?)>");
  const std::string without_script =
      std::regex_replace(html, std::regex("<(script|style)>[^]*?</(script|style)>"), "");
  for (auto match = std::sregex_iterator(without_script.begin(), without_script.end(), tag);
       match != std::sregex_iterator(); ++match) {
    const std::string name = (*match)[2];
    if ((*match)[3] == "/" || name == "meta" || name == "br") continue;
    if ((*match)[1] != "/") {
      open.push_back(name);
    } else {
      ASSERT_FALSE(open.empty()) << "</" << name << "> closes nothing";
      ASSERT_EQ(open.back(), name);
      open.pop_back();
    }
  }
  EXPECT_TRUE(open.empty());
}

class ComparedReport : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    page_ = compared_page(folder_->path());
  }
  static void TearDownTestSuite() { delete folder_; }
  inline static test::TemporaryFolder* folder_ = nullptr;
  inline static std::string page_;
};

TEST_F(ComparedReport, HoldsEverySection) {
  for (const char* id :
       {"results",        "curves",      "curve-acceleration", "curve-velocity", "curve-penetration",
        "sections",       "section-0-0", "section-0-1",        "section-0-2",    "section-1-0",
        "section-1-2",    "energy",      "energy-0",           "energy-1",       "energy-error",
        "cost",           "cost-bars",   "cost-table",         "effects-table",  "settings-table",
        "materials-table"})
    EXPECT_EQ(count(page_, fmt::format("id=\"{}\"", id)), 1u) << id;
}

TEST_F(ComparedReport, DrawsBothRunsInEachPlotOfCurves) {
  for (const char* id : {"curve-acceleration", "curve-velocity", "curve-penetration"}) {
    const std::size_t start = page_.find(fmt::format("<figure class=\"plot\" id=\"{}\"", id));
    const std::string figure = page_.substr(start, page_.find("</figure>", start) - start);
    EXPECT_EQ(count(figure, "data-label=\"SPH\""), 1u) << id;
    EXPECT_EQ(count(figure, "data-label=\"DEM\""), 1u) << id;
  }
}

TEST_F(ComparedReport, IsSelfContained) {
  EXPECT_EQ(page_.find("http://"), std::string::npos);
  EXPECT_EQ(page_.find("https://"), std::string::npos);
  EXPECT_EQ(page_.find(" src="), std::string::npos);
  EXPECT_EQ(page_.find("<link"), std::string::npos);
  EXPECT_EQ(page_.find("url("), std::string::npos);
}

TEST_F(ComparedReport, ShowsNoNumberThatIsNotOne) {
  EXPECT_FALSE(std::regex_search(page_, std::regex("\\b(nan|inf|NaN)\\b")));
}

TEST_F(ComparedReport, ClosesEveryTagItOpens) {
  expect_balanced(page_);
}

TEST_F(ComparedReport, StaysUnderFiveMegabytes) {
  EXPECT_LT(page_.size(), 5u << 20);
}

TEST_F(ComparedReport, GivesResultsInReadableUnits) {
  EXPECT_NE(page_.find("Largest penetration <i>[mm]</i>"), std::string::npos);
  EXPECT_NE(page_.find("<td>13.7</td>"), std::string::npos);
}

/// The curve's pixels, read back through the axes' scales, give the recorded peak: nothing was lost or
/// misplaced.
TEST_F(ComparedReport, PlotsThePeakWhereItWasRecorded) {
  const std::size_t start = page_.find("<figure class=\"plot\" id=\"curve-acceleration\"");
  const std::string figure = page_.substr(start, page_.find("</figure>", start) - start);
  std::smatch y_scale, x_scale, curve;
  ASSERT_TRUE(std::regex_search(figure, y_scale, std::regex("data-y=\"(\\S+) (\\S+) (\\S+) ([^\"]+)\"")));
  ASSERT_TRUE(std::regex_search(figure, x_scale, std::regex("data-x=\"(\\S+) (\\S+) (\\S+) ([^\"]+)\"")));
  ASSERT_TRUE(std::regex_search(figure, curve, std::regex("data-label=\"SPH\" points=\"([^\"]+)\"")));
  const auto value = [](const std::smatch& s, double pixel) {
    const double low = std::stod(s[1]), high = std::stod(s[2]), p0 = std::stod(s[3]), p1 = std::stod(s[4]);
    return low + (pixel - p0) / (p1 - p0) * (high - low);
  };
  std::istringstream points(curve[1]);
  double largest = 0, at = 0, x, y;
  char comma;
  while (points >> x >> comma >> y) {
    if (value(y_scale, y) > largest) {
      largest = value(y_scale, y);
      at = value(x_scale, x);
    }
  }
  EXPECT_NEAR(largest, 50.0, 0.3);  // g, what the fake run was given
  EXPECT_NEAR(at, 6.0, 0.3);        // ms after touch, half the pulse
}

TEST(ReadRun, FindsTheTouchAtTheForceThreshold) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path(), short_run(Approach::sph));
  const RunData run = read_run(folder.path());
  ASSERT_TRUE(run.touch_time.has_value());
  EXPECT_GT(*run.touch_time, 0.001) << "the force has to rise to the threshold";
  EXPECT_LT(*run.touch_time, 0.001 + 2e-4);
}

TEST(Section, TakesOnlyParticlesNearThePlaneAndTheMissileFromTheFrame) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path(), short_run(Approach::sph));
  const RunData run = read_run(folder.path());
  const auto section = run.section(0.004);
  ASSERT_TRUE(section.has_value());
  EXPECT_NEAR(section->time, 0.004, 1e-9);
  EXPECT_NEAR(section->particle_slice, 1.5 * 0.0025, 1e-9);
  // 32 columns by 20 rows; the slice of 1.5 pitches around y = 0 holds the two rows at half a pitch either
  // side.
  EXPECT_EQ(section->dots.size(), 2u * 32 * 20);
  for (const Dot& dot : section->dots) EXPECT_LE(std::abs(dot.depth), 0.5 * section->particle_slice);
  EXPECT_LT(section->missile.face_height, 0.0515);
  EXPECT_FALSE(section->facets.empty());
}

TEST(Section, HoldsWholeStrandsAndOnlyTheOutlineOfEach) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path(), short_run(Approach::sph));
  const auto section = read_run(folder.path()).section(0.004);
  ASSERT_TRUE(section.has_value());
  // 8 tufts of 4 strands with 12 facets each stand in the plane; a strip of 12 facets has 26 free edges.
  std::size_t facets = 0, free_edges = 0;
  for (const Facet& facet : section->facets) {
    if (facet.backing) continue;
    ++facets;
    for (const bool free : facet.free_edge) free_edges += free ? 1 : 0;
  }
  EXPECT_EQ(facets, 8u * 4 * 12);
  EXPECT_EQ(free_edges, 8u * 4 * 26);
}

TEST(Section, ShowsNoMissileBeforeTheRelease) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path(), short_run(Approach::sph));
  const auto section = read_run(folder.path()).section(0.0);
  ASSERT_TRUE(section.has_value());
  EXPECT_EQ(section->missile.radius, 0.0);
}

TEST(Report, ShowsAFailedRunAsFailedBesideAGoodOne) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path() / "sph", short_run(Approach::sph));
  test::write_failed_run(folder.path() / "dem", Approach::dem, "the host <died>");
  write_report({folder.path()}, folder.path() / "report.html");
  const std::string page = read_file(folder.path() / "report.html");
  EXPECT_NE(page.find("state failed"), std::string::npos);
  EXPECT_NE(page.find("the host &lt;died&gt;"), std::string::npos);
  EXPECT_EQ(page.find("the host <died>"), std::string::npos);
  expect_balanced(page);
}

TEST(Report, IsWrittenForARunThatRecordedNothing) {
  const test::TemporaryFolder folder;
  test::write_failed_run(folder.path(), Approach::dem, "no host");
  write_report({folder.path()}, folder.path() / "report.html");
  const std::string page = read_file(folder.path() / "report.html");
  EXPECT_NE(page.find("No result was measured"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex("\\b(nan|inf|NaN)\\b")));
  expect_balanced(page);
}

TEST(Report, TellsRunsOfOneApproachApartByTheirFolders) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path() / "fine", short_run(Approach::sph));
  test::write_fake_run(folder.path() / "coarse", short_run(Approach::sph));
  write_report({folder.path() / "fine", folder.path() / "coarse"}, folder.path() / "report.html");
  const std::string page = read_file(folder.path() / "report.html");
  EXPECT_NE(page.find("SPH · fine"), std::string::npos);
  EXPECT_NE(page.find("SPH · coarse"), std::string::npos);
}

TEST(Report, SaysOfRecordsThatCannotBeReadThatTheyAreMissing) {
  const test::TemporaryFolder folder;
  test::write_fake_run(folder.path(), short_run(Approach::sph));
  write_report({folder.path()}, folder.path() / "report.html");
  EXPECT_EQ(read_file(folder.path() / "report.html").find("No curves and frames"), std::string::npos);
  std::ofstream(folder.path() / "run.h5") << "not what it was";
  write_report({folder.path()}, folder.path() / "report.html");
  EXPECT_NE(read_file(folder.path() / "report.html").find("No curves and frames: "), std::string::npos);
}

TEST(Report, OfAFolderWithoutARunIsTheUsersMistake) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(write_report({folder.path()}, folder.path() / "report.html"), InputError);
}

}  // namespace
}  // namespace tuft::app
