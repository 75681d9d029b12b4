// The report of a tension run: its curves hold what the run recorded, one for each rate.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>

#include "app/report.h"
#include "core/scene_reader.h"
#include "rigs/run.h"
#include "rigs/run_folder.h"
#include "unit/app/fake_run.h"

namespace tuft::app {
namespace {

constexpr const char* rates[] = {"100 1/s", "500 1/s"};

class TensionReport : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    rigs::RunRequest request;
    request.folder = folder_->path() / "strand";
    request.scene = read_scene("inputs/strand_tension.toml", {{"rig.rates", "[\"100 Hz\", \"500 Hz\"]"},
                                                              {"rig.gauge_lengths", "[\"12 mm\"]"},
                                                              {"rig.samples", "60"}});
    rigs::prepare_run_folder(request.folder, request.scene);
    summary_ = rigs::run(request);
    write_report({request.folder}, folder_->path() / "report.html");
    std::ifstream file(folder_->path() / "report.html");
    std::ostringstream text;
    text << file.rdbuf();
    page_ = text.str();
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string figure(const std::string& id) {
    const std::size_t start = page_.find(fmt::format("<figure class=\"plot\" id=\"{}\"", id));
    if (start == std::string::npos) return "";
    return page_.substr(start, page_.find("</figure>", start) - start);
  }

  struct Point {
    double x = 0, y = 0;
  };
  /// A curve's points in the units of its axes, read back from the pixels.
  static std::vector<Point> curve(const std::string& id, const std::string& label) {
    const std::string text = figure(id);
    std::smatch x_scale, y_scale, points;
    const std::string scale = "=\"(\\S+) (\\S+) (\\S+) ([^\"]+)\"";
    if (!std::regex_search(text, x_scale, std::regex("data-x" + scale)) ||
        !std::regex_search(text, y_scale, std::regex("data-y" + scale)) ||
        !std::regex_search(text, points, std::regex("data-label=\"" + label + "\" points=\"([^\"]+)\"")))
      return {};
    const auto value = [](const std::smatch& s, double pixel) {
      const double low = std::stod(s[1]), high = std::stod(s[2]), p0 = std::stod(s[3]), p1 = std::stod(s[4]);
      return low + (pixel - p0) / (p1 - p0) * (high - low);
    };
    std::vector<Point> read;
    std::istringstream stream(points[1]);
    Point pixel;
    char comma;
    while (stream >> pixel.x >> comma >> pixel.y)
      read.push_back({value(x_scale, pixel.x), value(y_scale, pixel.y)});
    return read;
  }

  inline static test::TemporaryFolder* folder_ = nullptr;
  inline static rigs::RunSummary summary_;
  inline static std::string page_;
};

TEST_F(TensionReport, HasACurveForEachRateInEachPlot) {
  ASSERT_EQ(summary_.status, "completed") << summary_.error;
  for (const char* id : {"curve-stress", "curve-true-stress", "energy-work", "energy-error"})
    for (const char* rate : rates) EXPECT_GT(curve(id, rate).size(), 40u) << id << ", " << rate;
}

TEST_F(TensionReport, DrawsThePeakOfEachRateWhereItWasMeasured) {
  for (const auto& [rate, name] : {std::pair{rates[0], "rate_100_"}, {rates[1], "rate_500_"}}) {
    const std::vector<Point> points = curve("curve-stress", rate);
    const auto peak = std::max_element(points.begin(), points.end(),
                                       [](const Point& a, const Point& b) { return a.y < b.y; });
    ASSERT_NE(peak, points.end()) << rate;
    const double stress = summary_.results.at(std::string(name) + "peak_stress").value / 1e6,
                 strain = 100 * summary_.results.at(std::string(name) + "strain_at_peak").value;
    EXPECT_NEAR(peak->y / stress, 1, 0.01) << rate;
    EXPECT_NEAR(peak->x, strain, 0.3) << rate;
    // The strand tears: the curve ends with nothing.
    EXPECT_NEAR(points.back().y, 0, 0.02 * stress) << rate;
  }
}

TEST_F(TensionReport, ListsResultsByRateAndWhereTheStrandFailed) {
  const std::size_t start = page_.find("id=\"tension-table\"");
  ASSERT_NE(start, std::string::npos);
  const std::string table = page_.substr(start, page_.find("</table>", start) - start);
  for (const char* rate : rates) EXPECT_NE(table.find(rate), std::string::npos) << rate;
  EXPECT_EQ(table.find("–"), std::string::npos) << "everything was reached";
}

TEST_F(TensionReport, SpeaksOfNoInfillAndShowsNoNumberThatIsNotOne) {
  for (const char* id : {"sections", "effects-table"})
    EXPECT_EQ(page_.find(fmt::format("id=\"{}\"", id)), std::string::npos) << id;
  EXPECT_FALSE(std::regex_search(page_, std::regex("\\b(nan|inf|NaN)\\b")));
}

}  // namespace
}  // namespace tuft::app
