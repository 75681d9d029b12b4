// Grains in a scene: what is read of them, and the one line that each mistake gets.
#include <gmock/gmock.h>

#include <fstream>

#include "good_scene.h"

namespace tuft {
namespace {

using test::complaint;
using test::good;
using test::message_of;
using test::ScratchFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TEST(SceneMistakes, NamesOfGrainsInDemOptions) {
  EXPECT_EQ(complaint(good + "[infill.dem]\nmaterial_coarse_graining = { sbt = 2 }\n"),
            "a.toml:25: infill.dem.material_coarse_graining.sbt: 2: no layer holds this material; did you "
            "mean \"sbr\"?");
  EXPECT_THAT(
      complaint(good + "[infill.dem]\npairs = [{ materials = [\"sand\", \"gravel\"], friction = 0.4 }]\n"),
      StartsWith("a.toml:25: infill.dem.pairs.0.materials.1: \"gravel\": no such file in materials/"));
}

TEST(SceneReader, GrainSizesAreReadAndWrittenBack) {
  const std::string text = good + R"([infill.dem]
contact = "hooke"
rolling = "cdt"
pairs = [{ materials = ["sand", "sbr"], restitution = 0.4, cohesion_energy_density = "2 kJ/m^3" }]
[materials.sand.grain]
diameter_min = "0 mm"
diameter_max = "0 mm"
cohesion_energy_density = "500 J/m^3"
[materials.sand.grain.sizes]
law = "sieve"
by = "mass"
sieve = { unit = "mm", opening = [0.1, 0.5, 1], passing = [0, 0.25, 1] }
[materials.sbr.grain.sizes]
law = "lognormal"
by = "number"
median = "0.9 mm"
geometric_deviation = 1.4
)";
  const auto check = [](const Scene& scene) {
    const auto grain_of = [&](const char* name) {
      return *std::ranges::find(scene.materials, name, &Material::name)->grain;
    };
    const GrainMaterial sand = grain_of("sand"), sbr = grain_of("sbr");
    EXPECT_EQ(sand.sizes.law, SizeLaw::sieve);
    EXPECT_EQ(sand.sizes.by, SizeShares::mass);
    EXPECT_DOUBLE_EQ(sand.sizes.sieve.x[1], 0.5e-3);
    EXPECT_EQ(sand.sizes.sieve.y, (std::vector<double>{0, 0.25, 1}));
    EXPECT_DOUBLE_EQ(sand.diameter_min, 0.1e-3) << "from the curve";
    EXPECT_DOUBLE_EQ(sand.diameter_max, 1e-3);
    EXPECT_EQ(sand.cohesion_energy_density, 500);
    EXPECT_EQ(sbr.sizes.law, SizeLaw::lognormal);
    EXPECT_EQ(sbr.sizes.by, SizeShares::number);
    EXPECT_DOUBLE_EQ(sbr.sizes.median, 0.9e-3);
    EXPECT_EQ(sbr.sizes.geometric_deviation, 1.4);
    const DemOptions& dem = scene.infill.dem;
    EXPECT_EQ(dem.contact, GrainContact::hooke);
    EXPECT_EQ(dem.rolling, RollingModel::cdt);
    EXPECT_EQ(dem.characteristic_velocity, 2.85) << "left out: the missile's speed";
    ASSERT_EQ(dem.pairs.size(), 1u);
    EXPECT_EQ(dem.pairs[0].restitution, 0.4);
    EXPECT_EQ(dem.pairs[0].cohesion_energy_density, 2000);
    EXPECT_FALSE(dem.pairs[0].friction);
  };
  const Scene scene = read_scene_text(text, "a.toml");
  check(scene);
  check(read_scene_text(write_scene(scene), "b.toml"));
}

TEST(SceneMistakes, GrainSizesThatAreNoneAreNamed) {
  const auto of_sand = [](const std::string& keys, const std::string& grain = "") {
    return complaint(good + "[materials.sand.grain]\n" + grain + "[materials.sand.grain.sizes]\n" + keys);
  };
  const std::string key = "materials.sand.grain.sizes", lognormal = "law = \"lognormal\"\n",
                    sieve = "law = \"sieve\"\nby = \"mass\"\n",
                    no_limits = "diameter_min = \"0 mm\"\ndiameter_max = \"0 mm\"\n";
  EXPECT_THAT(of_sand("law = \"normal\"\n"), StartsWith("a.toml:26: " + key + ".law: \"normal\""));
  EXPECT_THAT(of_sand(lognormal), AllOf(HasSubstr(key + ".by"), HasSubstr("missing; say what shares count")));
  EXPECT_THAT(of_sand(lognormal + "by = \"mass\"\n"), HasSubstr(key + ".median: missing"));
  EXPECT_THAT(of_sand(lognormal + "by = \"mass\"\nmedian = \"1 mm\"\ngeometric_deviation = 0.5\n"),
              AllOf(StartsWith("a.toml:29: " + key + ".geometric_deviation: 0.5:"), HasSubstr("above 1")));
  EXPECT_THAT(
      of_sand(lognormal + "by = \"mass\"\nmedian = \"9 mm\"\ngeometric_deviation = 1.4\n"),
      AllOf(StartsWith("a.toml:28: " + key + ".median: \"9 mm\":"), HasSubstr("lies between diameter_min")));
  EXPECT_THAT(of_sand("median = \"1 mm\"\n"), HasSubstr(".median: \"1 mm\": is for law = \"lognormal\""));
  EXPECT_THAT(of_sand(sieve, no_limits), HasSubstr("law = \"sieve\" needs { unit = \"mm\""));
  const auto curve = [&](const std::string& opening, const std::string& passing, const std::string& grain) {
    return of_sand(
        sieve + "sieve = { unit = \"mm\", opening = [" + opening + "], passing = [" + passing + "] }\n",
        grain);
  };
  EXPECT_THAT(curve("0.2, 0.5, 1", "0, 42, 100", no_limits),
              AllOf(HasSubstr("sieve.passing.1: 42"), HasSubstr("at most 1")));
  EXPECT_THAT(curve("0.2, 0.5, 1", "0.1, 0.5, 1", no_limits), HasSubstr("passing begins at 0.1"));
  EXPECT_THAT(curve("0.2, 0.5, 1", "0, 0.5, 0.9", no_limits), HasSubstr("passing ends at 0.9"));
  EXPECT_THAT(curve("0.2, 0.5, 1", "0, 1, 0.5", no_limits), HasSubstr("passing ends at 0.5"));
  EXPECT_THAT(curve("0.2, 0.5, 0.8, 1", "0, 0.6, 0.5, 1", no_limits),
              HasSubstr("passing falls from 0.6 to 0.5"));
  EXPECT_THAT(curve("0.2, 1, 0.5", "0, 0.5, 1", no_limits), HasSubstr("must be above the number before it"));
  EXPECT_THAT(curve("0, 0.5, 1", "0, 0.5, 1", no_limits), HasSubstr("first opening must be above 0"));
  EXPECT_THAT(curve("0.3, 0.5, 1", "0, 0.5, 1", ""),
              HasSubstr("diameter_min: \"0.2 mm\": the sieve curve says 0.3 mm"));
  EXPECT_THAT(of_sand("by = \"mass\"\n", "diameter_min = \"0 mm\"\n"),
              HasSubstr("diameter_min: \"0 mm\": missing"));
}

TEST(SceneReader, ClumpsAreReadAndWrittenBack) {
  const std::string text = good + R"([materials.sand.grain]
clump = { shape = "spheres", spheres = [{ radius = 2 }, { x = 1.5, z = -0.5, radius = 1 }] }
[materials.sbr.grain.clump]
shape = "pair"
overlap = 0.25
)";
  const Scene read = read_scene_text(text, "a.toml"), again = read_scene_text(write_scene(read), "again");
  for (const Scene& scene : {read, again}) {
    const auto clump_of = [&](const char* name) {
      return *std::ranges::find(scene.materials, name, &Material::name)->grain->clump;
    };
    const Clump sand = clump_of("sand"), sbr = clump_of("sbr");
    EXPECT_EQ(sand.shape, ClumpShape::spheres);
    ASSERT_EQ(sand.spheres.size(), 2u);
    EXPECT_EQ(sand.spheres[0].x, 0);
    EXPECT_EQ(sand.spheres[1].x, 1.5);
    EXPECT_EQ(sand.spheres[1].z, -0.5);
    EXPECT_EQ(sand.spheres[1].radius, 1);
    EXPECT_EQ(sbr.shape, ClumpShape::pair);
    EXPECT_EQ(sbr.overlap, 0.25);
  }
  EXPECT_FALSE(read_scene_text(good, "a.toml").materials[0].grain->clump);
}

TEST(SceneMistakes, ClumpsThatAreNoBodiesAreNamed) {
  const auto clump = [](const std::string& table) {
    return complaint(good + "[materials.sand.grain]\nclump = { " + table + " }\n");
  };
  EXPECT_THAT(
      clump("shape = \"cube\""),
      AllOf(StartsWith("a.toml:25: materials.sand.grain.clump.shape: \"cube\""), HasSubstr("tetrahedron")));
  EXPECT_THAT(clump("overlap = 1"), AllOf(HasSubstr("clump.overlap: 1"), HasSubstr("below 1")));
  EXPECT_THAT(clump("shape = \"spheres\""), AllOf(StartsWith("a.toml:25"), HasSubstr("missing; shape")));
  EXPECT_THAT(clump("shape = \"pair\", spheres = [{ radius = 1 }]"), HasSubstr("is for shape = \"spheres\""));
  const std::string spheres = "shape = \"spheres\", spheres = ";
  EXPECT_THAT(clump(spheres + "[{ x = 1 }]"), HasSubstr("radius"));
  EXPECT_THAT(clump(spheres + "[{ radius = 0 }]"), AllOf(HasSubstr("radius: 0"), HasSubstr("above 0")));
  EXPECT_THAT(clump(spheres + "[{ radius = 1 }, { x = 3, radius = 1 }]"),
              AllOf(HasSubstr("spheres.1"), HasSubstr("a clump is one piece")));
  EXPECT_THAT(clump(spheres + "[{ radius = 1 }, { x = 0.2, radius = 0.5 }]"),
              AllOf(HasSubstr("spheres.1"), HasSubstr("lies within sphere 0")));
  EXPECT_THAT(clump(spheres + "[{ radius = 1 }, { x = 1, radius = 1 }], overlap = 0.2"),
              HasSubstr("listed spheres lie as they are"));
  std::string many = "[";
  for (int i = 0; i < 33; ++i) many += "{ x = " + std::to_string(i) + ", radius = 1 }, ";
  EXPECT_THAT(clump(spheres + many + "]"), HasSubstr("holds 33 spheres; a clump has at most 32"));
}

TEST(SceneMistakes, WhatClumpsCannotBeCombinedWithIsNamed) {
  const std::string clumps = good + "[materials.sand.grain.clump]\nshape = \"pair\"\n";
  const Overrides dem{{"infill.approach", "dem"}};
  EXPECT_NO_THROW((void)read_scene_text(clumps, "a.toml", dem));
  EXPECT_THAT(
      complaint(clumps + "[infill.dem]\nranks = 2\n", dem),
      AllOf(StartsWith("a.toml:27: infill.dem.ranks: 2"), HasSubstr("clumps of grains need one process")));
  const Overrides off{{"infill.approach", "dem"}, {"effects.clumps", "false"}};
  EXPECT_NO_THROW((void)read_scene_text(clumps + "[infill.dem]\nranks = 2\n", "a.toml", off));
  EXPECT_THAT(complaint(good, {{"infill.approach", "dem"}, {"effects.clumps", "true"}}),
              HasSubstr("no grain material has a clump"));
}

TEST(SceneMistakes, ContactsOfGrainsThatMakeNoSenseAreNamed) {
  const auto pairs = [](const std::string& list) {
    return complaint(good + "[infill.dem]\npairs = [" + list + "]\n");
  };
  const std::string materials = "materials = [\"sand\", \"sbr\"]";
  EXPECT_THAT(pairs("{ " + materials + " }"), StartsWith("a.toml:25: infill.dem.pairs.0"));
  EXPECT_THAT(pairs("{ " + materials + " }"), HasSubstr("gives nothing"));
  EXPECT_THAT(pairs("{ materials = [\"sand\", \"sand\"], friction = 0.4 }"),
              HasSubstr("a material and itself"));
  EXPECT_THAT(
      pairs("{ " + materials + ", friction = 0.4 }, { materials = [\"sbr\", \"sand\"], restitution = 0.4 }"),
      HasSubstr("pairs.1.materials"));
  EXPECT_THAT(pairs("{ materials = [\"sand\", \"mixture\"], friction = 0.4 }"),
              HasSubstr("\"mixture\" has no [grain]"));
  EXPECT_THAT(pairs("{ " + materials + ", restitution = 1.2 }"), HasSubstr("pairs.0.restitution: 1.2"));
  EXPECT_THAT(pairs("{ " + materials + ", restitution = 0.04 }"), HasSubstr("pairs.0.restitution: 0.04"));
  EXPECT_THAT(pairs("{ " + materials + ", cohesion_energy_density = \"1 N\" }"),
              HasSubstr("pairs.0.cohesion_energy_density: \"1 N\""));
  EXPECT_THAT(complaint(good + "[infill.dem]\ncharacteristic_velocity = \"1 m/s\"\n"),
              AllOf(StartsWith("a.toml:25: infill.dem.characteristic_velocity"),
                    HasSubstr("is for contact = \"hooke\"")));
  EXPECT_THAT(complaint(good + "[infill.dem]\ncontact = \"jkr\"\n"),
              HasSubstr("infill.dem.contact: \"jkr\""));
}

TEST(SceneMistakes, HostsThatCannotBeReachedAreNamed) {
  const auto host = [](const std::string& address) {
    return complaint(good + "[infill.dem]\nhost = \"" + address + "\"\n");
  };
  for (const char* address : {"tcp://machine", "tcp://:5555", "tcp://machine:", "tcp://machine:0",
                              "tcp://machine:65536", "tcp://machine:55x"})
    EXPECT_THAT(host(address), AllOf(StartsWith("a.toml:25: infill.dem.host: "), HasSubstr(address),
                                     HasSubstr("tcp://machine:port")));
  EXPECT_EQ(read_scene_text(good + "[infill.dem]\nhost = \"tcp://machine:5555\"\nranks = 2\n", "a.toml")
                .infill.dem.ranks,
            2);
  EXPECT_EQ(read_scene_text(good + "[infill.dem]\nhost = \"tcp://[::1]:5555\"\n", "a.toml").infill.dem.host,
            "tcp://[::1]:5555");
}

}  // namespace
}  // namespace tuft
