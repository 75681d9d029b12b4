/// What packings are kept by, and that what is no packing of this scene is not taken for one.
#include "coupler/packing_cache.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "core/scene_reader.h"
#include "tests/unit/core/scratch_folder.h"

namespace tuft::coupler {
namespace {

namespace fs = std::filesystem;

class KeptPacking : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = std::getenv("TUFT_CACHE") == nullptr ? "" : std::getenv("TUFT_CACHE");
    ::setenv("TUFT_CACHE", folder_.path().c_str(), 1);
  }
  void TearDown() override {
    before_.empty() ? ::unsetenv("TUFT_CACHE") : ::setenv("TUFT_CACHE", before_.c_str(), 1);
  }

  static Scene scene(const Overrides& more = {}) {
    Overrides overrides{{"infill.approach", "dem"}};
    overrides.insert(overrides.end(), more.begin(), more.end());
    return read_scene("inputs/clegg_small.toml", overrides);
  }
  static PackingCache cache_of(const Scene& scene, const std::string& container = "") {
    return {scene, decide_effects(scene), container};
  }
  /// Two grains of the scene's materials beside a strand of two nodes.
  Packing packing() const {
    Packing made;
    Index sand = 0;
    while (!scene_.materials.at(static_cast<std::size_t>(sand)).grain) ++sand;
    for (const double x : {-0.001, 0.001}) {
      made.grains.position.push_back(Vec3(x, 0, 0.01));
      made.grains.radius.push_back(0.001);
      made.grains.density.push_back(1150);
      made.grains.layer.push_back(1);
      made.grains.material.push_back(sand);
      made.carpet.position.push_back(Vec3(x, 0, 0));
    }
    made.carpet.element_state = {1, 2, 3};
    made.carpet.strain = 4;
    made.report.time = 0.007;
    made.report.at_rest = true;
    return made;
  }
  static bool is_kept(const PackingCache& cache) {
    Packing ignored;
    return cache.load(ignored, [](const Packing&) {});
  }
  fs::path file() const {
    fs::path found;
    for (const auto& entry : fs::directory_iterator(folder_.path())) found = entry.path();
    return found;
  }
  /// The kept file with one dataset written otherwise.
  void rewrite(const std::string& name, const std::vector<double>& values) const {
    const fs::path path = file();
    h5::File changed = h5::File::create_atomically(path);
    {
      const h5::Group old = h5::File::open(path).root();
      h5::Group root = changed.root();
      for (const std::string& dataset : old.names()) {
        const std::vector<double> written = dataset == name ? values : old.read_doubles(dataset);
        root.write(dataset, std::span<const double>(written));
      }
    }
    changed.commit();
  }
  /// What is said of the file, and that nothing of it is taken.
  std::string trouble(const std::function<void(const Packing&)>& check = [](const Packing&) {}) const {
    Packing loaded;
    EXPECT_FALSE(cache_of(scene_).load(loaded, check));
    EXPECT_EQ(loaded.grains.size(), 0u);
    EXPECT_EQ(loaded.carpet.position.size(), 0u);
    EXPECT_EQ(loaded.report.time, 0);
    const std::string& said = loaded.report.cache_trouble;
    EXPECT_TRUE(said.starts_with(file().string())) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_NE(said.find("packed anew"), std::string::npos) << said;
    return said;
  }
  void expect_trouble(const std::string& name, const std::vector<double>& values, const std::string& words) {
    cache_of(scene_).store(packing());
    rewrite(name, values);
    EXPECT_NE(trouble().find(words), std::string::npos) << trouble();
  }

  const Scene scene_ = scene();
  const test::ScratchFolder folder_;
  std::string before_;
};

TEST_F(KeptPacking, ComesBackAsItWasMade) {
  const PackingCache cache = cache_of(scene_);
  Packing kept;
  EXPECT_FALSE(cache.load(kept, [](const Packing&) {}));
  EXPECT_TRUE(kept.report.cache_trouble.empty()) << "what is not there is no trouble";
  const Packing made = packing();
  cache.store(made);
  ASSERT_TRUE(cache.load(kept, [](const Packing&) {}));
  EXPECT_EQ(kept.grains.position.x, made.grains.position.x);
  EXPECT_EQ(kept.grains.radius, made.grains.radius);
  EXPECT_EQ(kept.grains.density, made.grains.density);
  EXPECT_EQ(kept.grains.layer, made.grains.layer);
  EXPECT_EQ(kept.grains.material, made.grains.material);
  EXPECT_EQ(kept.carpet.position.x, made.carpet.position.x);
  EXPECT_EQ(kept.carpet.element_state, made.carpet.element_state);
  EXPECT_EQ(kept.carpet.strain, 4);
  EXPECT_EQ(kept.report.time, 0.007);
  EXPECT_TRUE(kept.report.at_rest);
}

TEST_F(KeptPacking, ServesEveryRigAndWhateverChangesNothingInIt) {
  cache_of(scene_).store(packing());
  for (const auto& [key, value] : Overrides{{"rig.speed", "4 m/s"},
                                            {"rig.mass", "1 kg"},
                                            {"scene.duration", "5 ms"},
                                            {"output.frames", "2 ms"},
                                            {"numerics.coupling_window", "5 us"},
                                            {"numerics.settle_time", "1 ms"},
                                            {"conditioning.method", "compaction"},
                                            {"infill.sph.pitch", "5 mm"},
                                            {"infill.dem.ranks", "2"},
                                            {"infill.dem.host", "/some/host"},
                                            {"infill.dem.answer_timeout", "5 s"}})
    EXPECT_TRUE(is_kept(cache_of(scene({{key, value}})))) << key;
}

TEST_F(KeptPacking, ServesNoOtherSeedFrictionLayerOrContainer) {
  cache_of(scene_).store(packing());
  for (const auto& [key, value] :
       Overrides{{"numerics.seed", "2"},
                 {"numerics.step_safety", "0.7"},
                 {"infill.dem.pairs", "[{ materials = [\"sand\", \"sbr\"], friction = 0.44 }]"},
                 {"infill.dem.packing_friction", "0.5"},
                 {"infill.dem.material_coarse_graining.sbr", "3.5"},
                 {"infill.dem.settle_time", "4 ms"},
                 {"turf.size", "[\"80 mm\", \"81 mm\"]"},
                 {"effects.rolling_resistance", "false"},
                 {"effects.fibres", "false"}})
    EXPECT_FALSE(is_kept(cache_of(scene({{key, value}})))) << key;
  Scene other = scene_;
  other.turf.layers.at(1).depth *= 1 + 1e-9;
  EXPECT_FALSE(is_kept(cache_of(other))) << "a layer's depth";
  other = scene_;
  for (Material& material : other.materials)
    if (material.grain) material.grain->friction *= 1 + 1e-9;
  EXPECT_FALSE(is_kept(cache_of(other))) << "friction of grains";
  EXPECT_FALSE(is_kept(cache_of(scene_, "ring")));
  EXPECT_TRUE(is_kept(cache_of(scene_)));
}

TEST_F(KeptPacking, IsMadeUnderNoNumericsButThoseThatTellItApart) {
  const Scene asked = scene({{"numerics.coupling_window", "5 us"}, {"numerics.seed", "3"}});
  const Scene packed = packing_scene(asked);
  EXPECT_EQ(packed.numerics.coupling_window, 0);
  EXPECT_EQ(packed.numerics.seed, 3);
}

TEST_F(KeptPacking, ThatIsCutShortOrNoFileOfItsKindIsNotTaken) {
  cache_of(scene_).store(packing());
  const auto whole = fs::file_size(file());
  for (const std::uintmax_t size : {whole - 1, whole / 2, std::uintmax_t{100}, std::uintmax_t{0}}) {
    cache_of(scene_).store(packing());
    fs::resize_file(file(), size);
    EXPECT_NE(trouble(), "") << size;
  }
  std::ofstream(file()) << "no packing";
  EXPECT_NE(trouble(), "");
}

TEST_F(KeptPacking, OfDamagedValuesIsNotTaken) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  expect_trouble("y", {0}, "y holds 1 values instead of 2");
  expect_trouble("z", {0.01, none}, "z holds nan");
  expect_trouble("radius", {0.001, 0}, "radius holds 0");
  expect_trouble("radius", {}, "not a single grain");
  expect_trouble("density", {1150, -1}, "density holds -1");
  expect_trouble("layer", {0, 3}, "layer holds 3");
  expect_trouble("material", {0, 99}, "material holds 99");
  expect_trouble("material", {0, -1}, "material holds -1");
  expect_trouble("report", {1, 2}, "report holds 2 values");
  expect_trouble("carpet_z", {0}, "carpet_z holds 1 values instead of 2");
  expect_trouble("carpet_elements", {1, none}, "carpet_elements holds nan");
  expect_trouble("carpet_strain", {1, 2}, "carpet_strain holds 2 values");
}

TEST_F(KeptPacking, OfMaterialsThatAreNoGrainsIsNotTaken) {
  double soil = 0;
  while (scene_.materials.at(static_cast<std::size_t>(soil)).grain) ++soil;
  expect_trouble("material", {soil, soil}, "which is no grain's");
}

TEST_F(KeptPacking, ThatIsRefusedIsNotTaken) {
  cache_of(scene_).store(packing());
  EXPECT_NE(trouble([](const Packing&) {
              throw_run_error("of another carpet's nodes");
            }).find("of another carpet's nodes"),
            std::string::npos);
}

TEST_F(KeptPacking, IsReplacedByTheOneMadeAnew) {
  cache_of(scene_).store(packing());
  fs::resize_file(file(), 100);
  EXPECT_FALSE(is_kept(cache_of(scene_)));
  cache_of(scene_).store(packing());
  EXPECT_TRUE(is_kept(cache_of(scene_)));
}

TEST_F(KeptPacking, ThatCannotBeKeptStopsNothing) {
  ::setenv("TUFT_CACHE", "/proc/no/such/folder", 1);
  const PackingCache cache = cache_of(scene_);
  cache.store(packing());
  EXPECT_FALSE(is_kept(cache));
}

}  // namespace
}  // namespace tuft::coupler
