/// Values that LIGGGHTS would carry on in silence.
#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/hard_cases/dem_bridge/traces.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

using BadValues = Traces;

TEST_F(BadValues, ImpulseThatIsNotFiniteIsRefusedByGrainAndTime) {
  const ShakenBlock block(2);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.05));
  infill.advance(1e-6, 1, no_impulses(8));
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    ContactImpulses contact = no_impulses(8);
    contact.angular.y[5] = bad;
    const std::string message = message_of<RunError>([&] { infill.advance(1e-6, 1, contact); });
    EXPECT_NE(message.find("angular contact impulse of grain 5"), std::string::npos) << message;
    EXPECT_NE(message.find("t = 1e-06 s"), std::string::npos) << message;
  }
  infill.advance(1e-6, 1, no_impulses(8));  // refused, not swallowed: the run can go on
  EXPECT_TRUE(infill.particles().position(5).allFinite());
}

TEST_F(BadValues, GrainTooFastToBeSeenOutsideItsBoxIsNamed) {
  const ShakenBlock block(2);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.01));
  infill.set_velocity(3, Vec3(1e5, 0, 0), Vec3(0, 0, 0));  // a tenth of a metre a step
  const std::string message = message_of<RunError>([&] {
    for (int k = 0; k < 400; ++k) infill.advance(1e-6, 1, no_impulses(8));
  });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("grain 3 was last seen at"), std::string::npos) << message;
  EXPECT_NE(message.find("left the box"), std::string::npos) << message;
}

TEST_F(BadValues, OverflowInsideTheHostStopsTheRun) {
  const ShakenBlock block(2);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.05));
  infill.advance(1e-6, 1, no_impulses(8));
  ContactImpulses contact = no_impulses(8);
  contact.linear.x[2] = 1e306;  // finite, and its speed is not
  const std::string message = message_of<RunError>([&] {
    for (int k = 0; k < 5; ++k) infill.advance(1e-6, 1, contact);
  });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("of grain 2 is not finite"), std::string::npos) << message;
}

TEST_F(BadValues, GrainsThatCannotBeSimulatedAreInputErrors) {
  const auto message_for = [](auto&& spoil) {
    ShakenBlock block(2);
    DemSettings settings = settings_in_box(0.05);
    spoil(block, settings);
    return message_of<InputError>([&] { DemInfill infill(block.grains, block.materials, settings); });
  };
  EXPECT_NE(message_for([](ShakenBlock& block, DemSettings&) {
              block.grains.position.z[4] = 0.06;
            }).find("grain 4"),
            std::string::npos);
  EXPECT_NE(
      message_for([](ShakenBlock& block, DemSettings&) { block.grains.radius[1] = 0; }).find("radius 0"),
      std::string::npos);
  EXPECT_NE(message_for([](ShakenBlock& block, DemSettings&) {
              block.grains.position.x[0] = std::nan("");
            }).find("must be finite"),
            std::string::npos);
  EXPECT_NE(message_for([](ShakenBlock& block, DemSettings&) {
              block.materials[0].grain.reset();
            }).find("no grain properties"),
            std::string::npos);
  EXPECT_NE(message_for([](ShakenBlock& block, DemSettings&) {
              block.grains = Grains{};
            }).find("not a single grain"),
            std::string::npos);
}

TEST_F(BadValues, WindowsAndImpulsesOfTheWrongSizeAreRefused) {
  const ShakenBlock block(2);
  DemInfill infill(block.grains, block.materials, settings_in_box(0.05));
  EXPECT_THROW(infill.advance(0, 1, no_impulses(8)), RunError);
  EXPECT_THROW(infill.advance(1e-6, 0, no_impulses(8)), RunError);
  EXPECT_THROW(infill.advance(std::nan(""), 1, no_impulses(8)), RunError);
  EXPECT_THROW(infill.advance(1e-6, 1, no_impulses(7)), RunError);
  EXPECT_THROW(infill.set_damping(-1), RunError);
  infill.advance(1e-6, 1, no_impulses(8));
  EXPECT_THROW(infill.set_velocity(0, Vec3(0, 0, 0), Vec3(0, 0, 0)), std::logic_error);
}

}  // namespace
}  // namespace tuft::dem::test
