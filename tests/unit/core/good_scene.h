#pragma once
/// A scene without mistakes, to be spoilt, and the one line that each mistake gets.
#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "core/scene_reader.h"
#include "scratch_folder.h"

namespace tuft::test {

// Line numbers below count from the line after R"(.
inline const std::string good = R"([scene]
duration = "25 ms"
[turf]
design = "slit_film_coarse"
size = ["80 mm", "90 mm"]
tray_depth = "70 mm"
[[turf.layers]]
material = "sand"
depth = "5 mm"
[[turf.layers]]
material = "sbr"
depth = "45 mm"
[infill]
approach = "sph"
[infill.sph]
pitch = "4 mm"
[rig]
type = "clegg"
speed = "2.85 m/s"
[effects]
fibres = true
[numerics]
step_safety = 0.5
)";

/// The good scene with `from` replaced by `to`.
inline std::string with(const std::string& from, const std::string& to) {
  std::string text = good;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

inline std::string complaint(const std::string& text, const Overrides& overrides = {}) {
  const std::string message =
      message_of<InputError>([&] { (void)read_scene_text(text, "a.toml", overrides); });
  EXPECT_NE(message, "") << "accepted";
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one line: " << message;
  return message;
}

inline std::string complaint_for(const std::string& from, const std::string& to) {
  return complaint(with(from, to));
}

}  // namespace tuft::test
