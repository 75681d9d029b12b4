#include "coupler/roller.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft::coupler {
namespace {

Scene rolled(const Overrides& more = {}) {
  Overrides overrides{{"infill.approach", "dem"}, {"conditioning.method", "roller"}};
  overrides.insert(overrides.end(), more.begin(), more.end());
  return read_scene("inputs/clegg_small.toml", overrides);
}

TEST(Roller, StandsBesideThePatchBeforeAndAfterEachPass) {
  const Scene scene = rolled();
  const Roller roller(scene);
  const std::vector<RigidBody> bodies = roller.bodies();
  ASSERT_EQ(bodies.size(), 1u + 12 * 2);
  for (int pass = 0; pass < 3; ++pass)
    for (const double share : {0.0, 1.0})
      for (std::size_t k = 0; k < roller.size(); ++k) {
        const double radius =
            k == 0 ? 0.5 * scene.conditioning.roller.diameter : 0.5 * scene.conditioning.roller.stud_diameter;
        EXPECT_GT(std::abs(roller.place(k, pass, share).x()), 0.5 * scene.turf.size[0] + radius) << k;
      }
  EXPECT_EQ(roller.place(0, 0, 1), Vec3(-roller.place(0, 0, 0).x(), 0, roller.place(0, 0, 0).z()));
}

TEST(Roller, ComesToTheDepthAskedForWithItsLastPass) {
  const Scene scene = rolled({{"conditioning.roller.passes", "4"}});
  const Roller roller(scene);
  const double surface = scene.turf.carpet.backing_thickness + scene.infill_depth();
  for (int pass = 0; pass < 4; ++pass)
    EXPECT_NEAR(roller.place(0, pass, 0.5).z() - 0.5 * scene.conditioning.roller.diameter,
                surface - scene.conditioning.depth * (pass + 1) / 4, 1e-12);
}

TEST(Roller, OfMoreThanTwoThousandStudsIsRefusedByTheirNumber) {
  const double width = rolled().turf.size[1];
  const auto spacing = [&](int rings) {
    return Overrides{{"conditioning.roller.studs_around", "100"},
                     {"conditioning.roller.stud_spacing", fmt::format("{:.17g} m", width / (rings + 0.5))}};
  };
  EXPECT_EQ(Roller(rolled(spacing(20))).size(), 1u + 2000);
  try {
    (void)rolled(spacing(21));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find("conditioning.roller.stud_spacing"), std::string::npos) << said;
    EXPECT_NE(said.find("makes 2.1e+03 studs; 2000 are the most"), std::string::npos) << said;
  }
}

TEST(Roller, RollsWithoutSliding) {
  // The cylinder's lowest point stands still; a stud's tip, farther out, goes back by what it is farther.
  const Scene scene = rolled();
  const Roller roller(scene);
  const ConditioningRoller& shape = scene.conditioning.roller;
  const double radius = 0.5 * shape.diameter, arm = radius + shape.stud_length - 0.5 * shape.stud_diameter;
  for (const int pass : {0, 1}) {
    double lowest = 1;
    Vec3 motion(0, 0, 0);
    const double h = 1e-4;
    double axis = 0;
    for (double share = 0; share < 1; share += h)
      for (std::size_t k = 1; k <= 12; ++k)
        if (roller.place(k, pass, share).z() < lowest) {
          lowest = roller.place(k, pass, share).z();
          motion = roller.place(k, pass, share + h) - roller.place(k, pass, share - h);
          axis = roller.place(0, pass, share + h).x() - roller.place(0, pass, share - h).x();
        }
    EXPECT_NEAR(motion.x(), axis * (1 - arm / radius), 0.01 * std::abs(axis));
    EXPECT_NEAR(motion.z(), 0, 0.02 * std::abs(axis));
    EXPECT_EQ(axis > 0, pass == 0);
  }
}

}  // namespace
}  // namespace tuft::coupler
