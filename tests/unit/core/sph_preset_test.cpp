// Presets of SPH, and what a scene may choose besides.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene_reader.h"
#include "good_scene.h"

namespace tuft {
namespace {

using test::complaint_for;
using test::with;
using testing::StartsWith;
TEST(SphPresets, SetKernelAndSmoothingLength) {
  const auto sph = [](const std::string& keys) {
    return read_scene_text(with("pitch = \"4 mm\"", keys), "a.toml").infill.sph;
  };
  EXPECT_DOUBLE_EQ(sph("pitch = \"4 mm\"").smoothing_length, 1.3 * 0.004);
  EXPECT_EQ(sph("pitch = \"4 mm\"").kernel, Kernel::wendland_c2);
  EXPECT_DOUBLE_EQ(sph("pitch = \"2 mm\"\npreset = \"paper\"").smoothing_length, 0.00142);
  EXPECT_EQ(sph("preset = \"paper\"").kernel, Kernel::cubic_spline);
  EXPECT_DOUBLE_EQ(sph("pitch = \"2 mm\"\npreset = \"fast\"").smoothing_length, 0.002);
  EXPECT_EQ(sph("preset = \"fast\"").kernel, Kernel::cubic_spline);
  const SphOptions own = sph("smoothing_length = \"3 mm\"\nkernel = \"cubic_spline\"");
  EXPECT_EQ(own.preset, "custom");
  EXPECT_EQ(own.smoothing_length, 0.003);
  EXPECT_EQ(own.kernel, Kernel::cubic_spline);
  EXPECT_EQ(complaint_for("pitch = \"4 mm\"",
                          "pitch = \"4 mm\"\npreset = \"accurate\"\nsmoothing_length = \"3 mm\""),
            "a.toml:18: infill.sph.smoothing_length: \"3 mm\": preset \"accurate\" makes it 5.2 mm at this "
            "pitch; leave it "
            "out, or set preset = \"custom\"");
  EXPECT_THAT(complaint_for("pitch = \"4 mm\"", "preset = \"custom\""),
              StartsWith("a.toml:15: infill.sph.smoothing_length: missing; preset \"custom\" needs it"));
}

TEST(SphPresets, TakeAKernelOfTheScenesOwnAndTheirSmoothingLengthFollowsThePitch) {
  struct Case {
    std::string preset;
    double over_pitch, zeta;
  };
  const double zeta = SphOptions{}.zero_energy_viscosity;
  for (const Case& c : {Case{"accurate", 1.3, zeta}, Case{"fast", 1, zeta}, Case{"paper", 0.71, 0},
                        Case{"specimen", 0.9, zeta}})
    for (const auto& [kernel, name] :
         {std::pair(Kernel::cubic_spline, "cubic_spline"), std::pair(Kernel::wendland_c2, "wendland_c2")})
      for (const double pitch_mm : {4.0, 5.0}) {
        SCOPED_TRACE(fmt::format("{} {} {}", c.preset, name, pitch_mm));
        const Scene scene =
            read_scene("inputs/clegg_small.toml", {{"infill.sph.preset", c.preset},
                                                   {"infill.sph.kernel", name},
                                                   {"infill.sph.pitch", fmt::format("{} mm", pitch_mm)}});
        const SphOptions& sph = scene.infill.sph;
        EXPECT_EQ(sph.preset, c.preset);
        EXPECT_EQ(sph.kernel, kernel);
        EXPECT_NEAR(sph.smoothing_length, c.over_pitch * 1e-3 * pitch_mm, 1e-12);
        EXPECT_EQ(sph.zero_energy_viscosity, c.zeta);
        // As it is kept in the folder of a run.
        const SphOptions again = read_scene_text(write_scene(scene), "scene.toml").infill.sph;
        EXPECT_EQ(again.preset, c.preset);
        EXPECT_EQ(again.kernel, kernel);
        EXPECT_EQ(again.smoothing_length, sph.smoothing_length);
      }
}

}  // namespace
}  // namespace tuft
