// Numbers of a material's file, and the file with others in their place.
#include "core/material_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "core/point_test.h"
#include "core/scene_files.h"
#include "core/scene_reader.h"
#include "scratch_folder.h"

namespace tuft {
namespace {

using testing::HasSubstr;

const std::string text = R"toml(# Überall.
[material]
name = "soil"
bulk_density = "1.5 g/cm^3"  # of a jar

[friction]
fibre = { static = 0.3, dynamic = 0.3 }
body = { static = 0.2, dynamic = 0.25 }  # smooth

[continuum]
unloading = { unit = "MPa", pressure = [0.0, 1.0], modulus = [12, 84] }
"shear_ratio" = 0.5
yield_a2=0.1
tension_cutoff = "20 kPa"  # calibrated: tuft calibrate old.toml
pressure_exponential = { modulus = "1.5 MPa", growth = 10 }
)toml";

MaterialFile soil(const test::ScratchFolder& folder) {
  std::ofstream(folder / "soil.toml") << text;
  return read_material_file(folder / "soil.toml", "soil");
}

TEST(MaterialFile, KnowsItsSingleNumbersWithUnitsAndRanges) {
  const test::ScratchFolder folder;
  const MaterialFile file = soil(folder);
  std::vector<std::string> keys;
  for (const MaterialNumber& number : file.numbers) keys.push_back(number.key);
  EXPECT_THAT(keys, testing::UnorderedElementsAre(
                        "material.bulk_density", "friction.fibre.static", "friction.fibre.dynamic",
                        "friction.body.static", "friction.body.dynamic", "continuum.shear_ratio",
                        "continuum.yield_a2", "continuum.tension_cutoff",
                        "continuum.pressure_exponential.modulus", "continuum.pressure_exponential.growth"))
      << "neither curves nor what is left out";
  for (const MaterialNumber& number : file.numbers) {
    if (number.key == "continuum.pressure_exponential.modulus") {
      EXPECT_EQ(number.unit, "Pa");
      EXPECT_EQ(number.value, 1.5e6);
      EXPECT_FALSE(number.allows(0)) << "must be above 0";
      EXPECT_TRUE(number.allows(1));
    }
    if (number.key == "continuum.yield_a2") {
      EXPECT_EQ(number.unit, "1");
    }
  }
}

TEST(MaterialFile, WithOtherNumbersKeepsAllElseToTheLetter) {
  const test::ScratchFolder folder;
  const std::string changed = with_numbers(soil(folder), {{"material.bulk_density", 1234.5},
                                                          {"friction.body.dynamic", 0.125},
                                                          {"continuum.yield_a2", 0.375},
                                                          {"continuum.pressure_exponential.modulus", 2.25e6},
                                                          {"continuum.pressure_exponential.growth", 7.5}});
  std::string expected = text;
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"1.5 g/cm^3", "1.2345 g/cm^3"},
                                                        {"dynamic = 0.25", "dynamic = 0.125"},
                                                        {"yield_a2=0.1", "yield_a2=0.375"},
                                                        {"\"1.5 MPa\"", "\"2.25 MPa\""},
                                                        {"growth = 10", "growth = 7.5"}})
    expected.replace(expected.find(from), from.size(), to);
  EXPECT_EQ(changed, expected);
}

TEST(MaterialFile, ChangedLinesBearTheRemarkOnceHoweverOftenItIsMade) {
  const test::ScratchFolder folder;
  const std::map<std::string, double> values{{"material.bulk_density", 1400},
                                             {"continuum.tension_cutoff", 1e4},
                                             {"continuum.pressure_exponential.modulus", 2e6},
                                             {"continuum.pressure_exponential.growth", 7}};
  const std::string once = with_numbers(soil(folder), values, "calibrated: tuft calibrate a.toml");
  EXPECT_THAT(once,
              HasSubstr("bulk_density = \"1.4 g/cm^3\"  # of a jar  # calibrated: tuft calibrate a.toml\n"));
  EXPECT_THAT(once, HasSubstr("tension_cutoff = \"10 kPa\"  # calibrated: tuft calibrate a.toml\n"))
      << "in place of the old one";
  EXPECT_THAT(once, HasSubstr("{ modulus = \"2 MPa\", growth = 7 }  # calibrated: tuft calibrate a.toml\n"));
  std::ofstream(folder / "soil.toml") << once;
  EXPECT_EQ(with_numbers(read_material_file(folder / "soil.toml", "soil"), values,
                         "calibrated: tuft calibrate a.toml"),
            once);
}

TEST(MaterialFile, RefusesKeysThatItHasNot) {
  const test::ScratchFolder folder;
  const MaterialFile file = soil(folder);
  for (const std::string key :
       {"continuum.unloading", "continuum.unloading.modulus", "continuum.dilation_angle"})
    EXPECT_THAT(test::message_of<InputError>([&] { (void)with_numbers(file, {{key, 1}}); }), HasSubstr(key));
}

TEST(MaterialTexts, StandInForFilesInScenesAndPointTests) {
  MaterialFile file = read_material_file("inputs/materials/sbr_calibrated.toml", "sbr_calibrated");
  const MaterialTexts texts{
      {"sbr_calibrated", {"tried.toml", with_numbers(file, {{"continuum.unloading_ratio", 1.75}})}}};
  const Overrides point{{"point.material", "sbr_calibrated"}}, scene{{"rig.material", "sbr_calibrated"}};
  const auto ratio = [](const Material& m) { return m.continuum->unloading_ratio; };
  EXPECT_EQ(ratio(read_point_test("inputs/calibrations/models/oedometer.toml", point, texts).tested()), 1.75);
  const Scene ring = read_scene("inputs/oedometer_sbr.toml", scene, texts);
  EXPECT_EQ(ratio(ring.materials.front()), 1.75);
  EXPECT_EQ(ring.materials.front().file, "tried.toml");
  EXPECT_NE(ratio(read_scene("inputs/oedometer_sbr.toml", scene).materials.front()), 1.75);
}

TEST(MaterialTexts, AreRefusedWhereAResolvedInputHasTheMaterialWhole) {
  const test::ScratchFolder folder;
  const Overrides scene{{"rig.material", "sbr_calibrated"}};
  std::ofstream(folder / "resolved.toml") << write_scene(read_scene("inputs/oedometer_sbr.toml", scene));
  const MaterialTexts texts{{"sbr_calibrated", {"tried.toml", "[material]\n"}}};
  EXPECT_THAT(test::message_of<InputError>([&] { (void)read_scene(folder / "resolved.toml", {}, texts); }),
              HasSubstr("no other can be tried in its place"));
}

}  // namespace
}  // namespace tuft
