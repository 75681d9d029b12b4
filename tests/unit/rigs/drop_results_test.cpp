#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rigs/clegg.h"

namespace tuft::rigs {
namespace {

/// A missile on a linear spring, closed form: half a sine of acceleration, rebound as fast as impact.
DropRecord spring_drop(double omega, double speed, double free_before, double dt) {
  DropRecord r;
  r.interval = dt;
  const double end = free_before + std::numbers::pi / omega + 0.002;
  for (int i = 1; i * dt <= end; ++i) {
    const double t = i * dt - free_before, middle = t - 0.5 * dt;
    const bool touching = middle > 0 && middle < std::numbers::pi / omega;
    r.acceleration.push_back(touching ? speed * omega * std::sin(omega * middle) : 0);
    if (t <= 0) {
      r.velocity.push_back(-speed);
      r.height.push_back(-speed * t);
    } else if (t < std::numbers::pi / omega) {
      r.velocity.push_back(-speed * std::cos(omega * t));
      r.height.push_back(-speed / omega * std::sin(omega * t));
    } else {
      r.velocity.push_back(speed);
      r.height.push_back(speed * (t - std::numbers::pi / omega));
    }
  }
  return r;
}

TEST(DropResults, OfASpringAreThoseOfTheClosedForm) {
  const double omega = 300, speed = 2.85, dt = 2e-5;
  const DropRecord record = spring_drop(omega, speed, 0.001, dt);
  const DropResults r = evaluate_drop(record, record.acceleration, 2.25, 5);
  EXPECT_TRUE(r.touched);
  EXPECT_TRUE(r.separated);
  EXPECT_NEAR(r.peak_g, speed * omega / 9.80665, 1e-3 * r.peak_g);
  EXPECT_NEAR(r.time_of_peak, std::numbers::pi / 2 / omega, 3 * dt);
  EXPECT_NEAR(r.rebound_velocity, speed, 1e-3);
  EXPECT_NEAR(r.max_penetration, speed / omega, 3 * speed * dt);
  EXPECT_NEAR(r.contact_time, std::numbers::pi / omega, 3 * dt);
  // Above a tenth of the peak from asin(0.1) to pi - asin(0.1).
  EXPECT_NEAR(r.pulse_duration, (std::numbers::pi - 2 * std::asin(0.1)) / omega, 0.1 * dt);
  EXPECT_NEAR(r.impact_velocity, speed, 1e-12);
}

TEST(DropResults, PulseDurationLeavesOutALongWeakTouchBeforeAndAfter) {
  DropRecord record = spring_drop(300, 2.85, 0.001, 2e-5);
  const double alone = evaluate_drop(record, record.acceleration, 2.25, 22).pulse_duration;
  const DropRecord bare = record;
  for (double& a : record.acceleration)
    a = std::max(a, 20.0);  // fibres before and after: 2 g under a peak of 87
  const DropResults r = evaluate_drop(record, record.acceleration, 2.25, 22);
  EXPECT_NEAR(r.pulse_duration, alone, 1e-12);
  EXPECT_GT(r.contact_time, evaluate_drop(bare, bare.acceleration, 2.25, 22).contact_time + 1e-3)
      << "the threshold does see the fibres";
}

/// Strands that buckle under the falling missile, 3 mm above the infill.
TEST(DropResults, AMomentOfForceBeforeTheInfillIsNotTheTouch) {
  DropRecord record = spring_drop(300, 2.85, 0.003, 2e-5);
  const DropResults bare = evaluate_drop(record, record.acceleration, 2.25, 22);
  for (std::size_t i = 100; i < 110; ++i) record.acceleration[i] = 28 / 2.25;
  const DropResults r = evaluate_drop(record, record.acceleration, 2.25, 22);
  EXPECT_EQ(r.touch_time, bare.touch_time);
  EXPECT_EQ(r.max_penetration, bare.max_penetration);
  EXPECT_EQ(r.contact_time, bare.contact_time);
  EXPECT_EQ(r.time_of_peak, bare.time_of_peak);
}

TEST(TouchClock, KnowsAtEachSampleOnlyWhatHasBeen) {
  TouchClock clock(22);
  const double force[] = {0, 5, 28, 30, 10, 25, 29, 40, 12, 39};
  const int touch[] = {-1, -1, 2, 2, 2, 2, 2, 5, 5, 5};
  for (std::size_t i = 0; i < std::size(force); ++i) {
    clock.sample(force[i]);
    EXPECT_EQ(clock.touched() ? static_cast<int>(clock.touch()) : -1, touch[i]) << i;
  }
}

TEST(DropResults, WithoutReboundSayThatItDidNotPart) {
  DropRecord record = spring_drop(300, 2.85, 0.001, 2e-5);
  const std::size_t keep = 300;  // cut before it parts
  record.acceleration.resize(keep);
  record.velocity.resize(keep);
  record.height.resize(keep);
  const DropResults r = evaluate_drop(record, record.acceleration, 2.25, 5);
  EXPECT_TRUE(r.touched);
  EXPECT_FALSE(r.separated);
}

TEST(DropResults, OfAMissThatTouchedNothingAreEmpty) {
  DropRecord record;
  record.interval = 1e-5;
  record.acceleration.assign(10, 0);
  record.velocity.assign(10, -1);
  record.height.assign(10, 1);
  EXPECT_FALSE(evaluate_drop(record, record.acceleration, 2.25, 5).touched);
}

}  // namespace
}  // namespace tuft::rigs
