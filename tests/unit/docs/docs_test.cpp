// What the documentation shows must work: scenes are read, links lead somewhere, tables are those of the
// code.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "core/scene_reader.h"
#include "scene_reference_page.h"

namespace tuft {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<fs::path> pages() {
  std::vector<fs::path> found{"README.md", "CHANGELOG.md"};
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator("docs"))
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  return found;
}

/// The blocks of a page that are fenced with this language.
std::vector<std::string> code_blocks(const std::string& page, const std::string& language) {
  std::vector<std::string> blocks;
  const std::string fence = "```" + language + "\n";
  for (std::size_t start = page.find(fence); start != std::string::npos; start = page.find(fence, start)) {
    start += fence.size();
    const std::size_t end = page.find("```", start);
    blocks.push_back(page.substr(start, end - start));
  }
  return blocks;
}

TEST(Docs, SceneOfTheReadmeIsRead) {
  const std::vector<std::string> scenes = code_blocks(read_text("README.md"), "toml");
  ASSERT_EQ(scenes.size(), 1u);
  for (const Approach approach : {Approach::sph, Approach::dem}) {
    const Scene scene = read_scene_text(scenes[0], "README.md",
                                        {{"infill.approach", approach == Approach::sph ? "sph" : "dem"}});
    EXPECT_EQ(scene.infill.approach, approach);
    EXPECT_FALSE(scene.turf.layers.empty());
  }
}

TEST(Docs, EveryRelativeLinkLeadsToAFile) {
  const std::regex link(R"(\]\(([^)#]+)(#[^)]*)?\))");
  std::size_t links = 0;
  for (const fs::path& page : pages()) {
    const std::string text = read_text(page);
    for (std::sregex_iterator match(text.begin(), text.end(), link), end; match != end; ++match) {
      const std::string target = (*match)[1];
      if (target.rfind("http", 0) == 0) continue;
      ++links;
      EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << " links to " << target;
    }
  }
  EXPECT_GT(links, 10u);
}

TEST(Docs, SceneReferenceIsThatOfTheCode) {
  EXPECT_EQ(read_text("docs/scene_reference.md"), scene_reference_page())
      << "make it anew: build/release/bin/print_scene_reference > docs/scene_reference.md";
}

}  // namespace
}  // namespace tuft
