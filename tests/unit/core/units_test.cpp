#include "core/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/scene_reader.h"
#include "scratch_folder.h"

namespace tuft {
namespace {

using test::message_of;
using testing::HasSubstr;

std::string complaint(const std::string& text, const std::string& unit) {
  return message_of<InputError>([&] { (void)parse_quantity(text, unit); });
}

TEST(Units, ConvertToSi) {
  EXPECT_EQ(parse_quantity("2 mm", "m"), 0.002);
  EXPECT_EQ(parse_quantity("2.25 kg", "kg"), 2.25);
  EXPECT_EQ(parse_quantity("10 ms", "s"), 0.010);
  EXPECT_EQ(parse_quantity("0.3615 GPa", "Pa"), 361.5e6);
  EXPECT_EQ(parse_quantity("3600 kPa^2", "Pa^2"), 3.6e9);
  EXPECT_EQ(parse_quantity("300 s/m", "s/m"), 300);
  EXPECT_EQ(parse_quantity("1 1/ms", "Hz"), 1000);
  EXPECT_EQ(parse_quantity("1 g/cm^3", "kg/m^3"), 1000);
  EXPECT_DOUBLE_EQ(parse_quantity("180 degree", "rad"), std::numbers::pi);
  EXPECT_DOUBLE_EQ(parse_quantity("0.75 in", "m"), 0.01905);
  EXPECT_EQ(parse_quantity("  +5mm ", "m"), 0.005);
  EXPECT_EQ(parse_quantity("-1e-3 m/s", "m/s"), -0.001);
}

TEST(Units, WholeMillimetresGiveTheBitsOfTheirLiteral) {
  for (int k = 1; k < 2000; ++k)
    ASSERT_EQ(parse_quantity(std::to_string(k) + " mm", "m"), std::stod(std::to_string(k) + "e-3")) << k;
}

TEST(Units, AnotherDimensionIsRefusedWithAnExample) {
  EXPECT_EQ(complaint("2 kg", "m"), "\"kg\" is not the unit of a length (m); write for example \"5 mm\"");
  EXPECT_EQ(complaint("2 mm", "m/s"),
            "\"mm\" is not the unit of a speed (m/s); write for example \"2.85 m/s\"");
  EXPECT_NE(complaint("2 kPa", "Pa^2"), "");
}

TEST(Units, WhatIsNoQuantityIsRefused) {
  EXPECT_THAT(complaint("2", "m"), HasSubstr("has no unit; a length (m) is needed, for example \"2 m\""));
  EXPECT_THAT(complaint("mm", "m"), HasSubstr("does not begin with a number"));
  EXPECT_THAT(complaint("", "m"), HasSubstr("does not begin with a number"));
  EXPECT_THAT(complaint("2 furlung", "m"), HasSubstr("\"furlung\" is not a unit"));
  EXPECT_THAT(complaint("nan mm", "m"), HasSubstr("must be a finite number"));
  EXPECT_THAT(complaint("inf mm", "m"), HasSubstr("must be a finite number"));
  EXPECT_THAT(complaint("1e400 mm", "m"), HasSubstr("too large"));
  EXPECT_THAT(complaint("1e308 km", "m"), HasSubstr("too large"));
}

TEST(Units, OffsetAndLogarithmicUnitsAreRefused) {
  EXPECT_THAT(complaint("20 degC", "K"),
              HasSubstr("\"degC\" is not a plain multiple of K; give the value in K"));
  EXPECT_THAT(complaint("20 degF", "K"), HasSubstr("not a plain multiple"));
  EXPECT_THAT(complaint("3 lg(re 1 m)", "m"), HasSubstr("not a plain multiple"));
  EXPECT_EQ(parse_quantity("20 K", "K"), 20);
}

TEST(NearestName, CountsSwapsAsOneEdit) {
  EXPECT_EQ(edit_distance("depth", "depth"), 0u);
  EXPECT_EQ(edit_distance("depht", "depth"), 1u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
}

TEST(NearestName, FindsTheMistypedNameOrNone) {
  const std::vector<std::string> known{"pitch", "preset", "smoothing_length", "kernel"};
  EXPECT_EQ(nearest_name("pich", known), "pitch");
  EXPECT_EQ(nearest_name("smoothing_lenght", known), "smoothing_length");
  EXPECT_EQ(nearest_name("temperature", known), std::nullopt);
  EXPECT_EQ(nearest_name("x", std::vector<std::string>{}), std::nullopt);
}

}  // namespace
}  // namespace tuft
