#include "rigs/xdmf.h"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "core/hdf5_file.h"
#include "unit/app/fake_run.h"

namespace tuft::rigs {
namespace {

using Shape = std::vector<std::uint64_t>;

Shape numbers(const std::string& text) {
  std::istringstream stream(text);
  Shape shape;
  std::uint64_t value = 0;
  while (stream >> value) shape.push_back(value);
  return shape;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Written {
  test::TemporaryFolder folder;
  std::string text;
  explicit Written(Approach approach) {
    test::FakeRun run;
    run.approach = approach;
    run.duration = 0.004;
    test::write_fake_run(folder.path(), run);
    write_xdmf(folder.path());
    text = read_file(folder.path() / "run.xdmf");
  }
};

class Xdmf : public ::testing::TestWithParam<Approach> {};

TEST_P(Xdmf, ReferencesOnlyDatasetsThatExistWithTheirTrueDimensions) {
  const Written written(GetParam());
  const h5::Group root = h5::File::open(written.folder.path() / "run.h5").root();
  const std::regex item("<DataItem Dimensions=\"([^\"]+)\"[^>]*Format=\"HDF\">run\\.h5:/([^<]+)</DataItem>");
  std::size_t references = 0;
  for (auto match = std::sregex_iterator(written.text.begin(), written.text.end(), item);
       match != std::sregex_iterator(); ++match, ++references)
    EXPECT_EQ(root.shape((*match)[2].str()), numbers((*match)[1])) << (*match)[2];
  EXPECT_EQ(references, [&] {
    std::size_t count = 0;
    for (std::size_t at = written.text.find("run.h5:"); at != std::string::npos;
         at = written.text.find("run.h5:", at + 1))
      ++count;
    return count;
  }()) << "a reference the pattern did not cover";
  EXPECT_GT(references, 0u);
}

TEST_P(Xdmf, SelectsOneWholeRowInsideTheDatasetWithEveryHyperslab) {
  const Written written(GetParam());
  const std::regex slab(
      "<DataItem ItemType=\"HyperSlab\" Dimensions=\"([^\"]+)\"[^>]*>\\s*<DataItem Dimensions=\"3 "
      "(\\d+)\"[^>]*>([^<]+)</DataItem>"
      "\\s*<DataItem Dimensions=\"([^\"]+)\"");
  std::size_t slabs = 0;
  for (auto match = std::sregex_iterator(written.text.begin(), written.text.end(), slab);
       match != std::sregex_iterator(); ++match, ++slabs) {
    const Shape row = numbers((*match)[1]), selection = numbers((*match)[3]), whole = numbers((*match)[4]);
    const std::size_t rank = std::stoul((*match)[2]);
    ASSERT_EQ(rank, whole.size());
    ASSERT_EQ(selection.size(), 3 * rank);
    ASSERT_EQ(row, Shape(whole.begin() + 1, whole.end()));
    for (std::size_t d = 0; d < rank; ++d) {
      EXPECT_LE(selection[d] + selection[2 * rank + d], whole[d]);
      EXPECT_EQ(selection[rank + d], 1u);
      EXPECT_EQ(selection[2 * rank + d], d == 0 ? 1u : whole[d]);
    }
  }
  EXPECT_GT(slabs, 0u);
}

TEST_P(Xdmf, HasOneStepAFrameWithRisingTimes) {
  const Written written(GetParam());
  const h5::Group root = h5::File::open(written.folder.path() / "run.h5").root();
  const std::vector<double> times = root.open_group("frames").read_doubles("time");
  const std::regex time("<Time Value=\"([^\"]+)\"/>");
  std::vector<double> found;
  for (auto match = std::sregex_iterator(written.text.begin(), written.text.end(), time);
       match != std::sregex_iterator(); ++match)
    found.push_back(std::stod((*match)[1]));
  ASSERT_EQ(found.size(), times.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(found[i], times[i], 1e-9);
}

TEST_P(Xdmf, IsWellFormed) {
  const Written written(GetParam());
  std::vector<std::string> open;
  const std::regex tag("<(/?)([A-Za-z]+)[^>]*?(/?)>");
  for (auto match = std::sregex_iterator(written.text.begin(), written.text.end(), tag);
       match != std::sregex_iterator(); ++match) {
    if ((*match)[3] == "/") continue;
    if ((*match)[1] != "/") {
      open.push_back((*match)[2]);
    } else {
      ASSERT_FALSE(open.empty());
      ASSERT_EQ(open.back(), (*match)[2].str());
      open.pop_back();
    }
  }
  EXPECT_TRUE(open.empty());
}

TEST(XdmfFields, OfTheInfillBecomeAttributes) {
  const Written sph(Approach::sph);
  for (const char* name : {"velocity", "pressure", "radius", "layer", "material", "surface"})
    EXPECT_NE(sph.text.find(std::string("Attribute Name=\"") + name + "\""), std::string::npos) << name;
  EXPECT_NE(sph.text.find("TopologyType=\"Quadrilateral\""), std::string::npos);
  EXPECT_NE(sph.text.find("TopologyType=\"Polyvertex\""), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(BothApproaches, Xdmf, ::testing::Values(Approach::sph, Approach::dem),
                         [](const auto& tested) { return tested.param == Approach::sph ? "Sph" : "Dem"; });

}  // namespace
}  // namespace tuft::rigs
