#include "coupler/contact_law.h"

#include <gtest/gtest.h>

namespace tuft::coupler {
namespace {

ContactKinematics moment(double overlap, const Vec3& normal, const Vec3& velocity, double mass) {
  return {overlap, normal, velocity, mass, -velocity.dot(normal), 1};
}

/// A mass on a fixed plane z = 0, leapfrog, until it parts or `steps` are done. Returns the velocities.
struct Bounce {
  double rebound = 0;
  double elastic_left = 0, damped = 0, friction = 0;
  Vec3 final_velocity{0, 0, 0};
};

Bounce bounce(const ContactParameters& p, double mass, const Vec3& velocity_in, double dt) {
  Bounce result;
  ContactHistory history;
  Vec3 velocity = velocity_in;
  double z = 0;
  for (int i = 0; i < 1000000; ++i) {
    z += velocity.z() * dt;
    if (z >= 0) {
      result.friction += release_spring(history);
      break;
    }
    const ContactForce f = compute_contact_force(p, moment(-z, Vec3(0, 0, 1), velocity, mass), dt, history);
    result.damped += f.damped;
    result.friction += f.friction;
    velocity += f.force / mass * dt;
  }
  result.rebound = velocity.z();
  result.final_velocity = velocity;
  return result;
}

TEST(ContactLaw, ReboundFollowsTheRestitutionOfTheDampingRatio) {
  for (const double restitution : {0.3, 0.5, 0.9, 1.0}) {
    const ContactParameters p{{1e5}, damping_ratio_of_restitution(restitution), 0.5, {}};
    const double mass = 1e-4, period = 2 * std::numbers::pi * std::sqrt(mass / p.spring.stiffness);
    const Bounce b = bounce(p, mass, Vec3(0, 0, -2), period / 2000);
    EXPECT_NEAR(b.rebound / 2, restitution, 0.005);
  }
}

TEST(ContactLaw, DampedEnergyIsTheKineticEnergyLost) {
  const ContactParameters p{{1e5}, damping_ratio_of_restitution(0.5), 0.5, {}};
  const double mass = 1e-4, period = 2 * std::numbers::pi * std::sqrt(mass / p.spring.stiffness);
  const Bounce b = bounce(p, mass, Vec3(0, 0, -2), period / 4000);
  const double lost = 0.5 * mass * (4 - b.rebound * b.rebound);
  EXPECT_NEAR(b.damped / lost, 1, 5e-3);
}

TEST(ContactLaw, WorkOfAnOverlapLetGoIsWhatMassAndSpringGainToRounding) {
  constexpr double stiffness = 1e5, mass = 1e-4, first_overlap = 5e-4, steps = 400;
  const double dt = 0.02 * std::sqrt(mass / stiffness), let_go = first_overlap / steps;
  double overlap = first_overlap, speed = 0, work = 0;
  int loaded = 0;
  for (int k = 1; k < steps; ++k, ++loaded) {
    overlap += speed * dt;
    const double depth = overlap - first_overlap * (1 - k / steps);
    if (!(depth > 0)) break;
    work += release_work({stiffness}, depth, let_go, speed * dt);
    const double before = speed;
    speed -= stiffness * depth / mass * dt;
    ASSERT_NEAR(0.5 * mass * before * speed + 0.5 * stiffness * depth * depth, work, 1e-12 * work) << k;
  }
  EXPECT_GT(loaded, 100);
  EXPECT_NEAR(overlap - first_overlap, -let_go * loaded, 0.1 * let_go * loaded)
      << "it moves as far as it is let go";
}

constexpr NormalSpring stiffening_spring{2e5, 3e3, 4e-4};

TEST(NormalSpring, ForceIsTheDerivativeOfItsEnergyAndTangentThatOfItsForce) {
  const NormalSpring& s = stiffening_spring;
  constexpr double step = 1e-8;
  for (const double d : {1e-5, 2e-4, 3.99e-4, 4.01e-4, 8e-4}) {
    EXPECT_NEAR((s.energy(d + step) - s.energy(d - step)) / (2 * step) / s.force(d), 1, 1e-7) << d;
    EXPECT_NEAR((s.force(d + step) - s.force(d - step)) / (2 * step) / s.tangent(d), 1, 1e-7) << d;
  }
  EXPECT_EQ(s.force(0), 0);
  EXPECT_EQ(s.energy(0), 0);
}

TEST(NormalSpring, StiffensInProportionToItsForceUpToItsEndAndNotBeyond) {
  const NormalSpring& s = stiffening_spring;
  for (const double d : {1e-5, 1e-4, 3.9e-4})
    EXPECT_NEAR(s.tangent(d) / (s.stiffness + s.stiffening * s.force(d)), 1, 1e-12) << d;
  EXPECT_EQ(s.tangent(1e-3), s.tangent(s.end));
}

TEST(NormalSpring, AllAtOnceAreWhatEachIsByItself) {
  for (const NormalSpring& spring : {NormalSpring{2e4}, NormalSpring{2e4, 300, 1e-3}})
    for (const double overlap : {0.0, 1e-7, 4e-4, 1e-3, 2e-3}) {
      const NormalSpring::State state = spring.at(overlap);
      EXPECT_NEAR(state.tangent, spring.tangent(overlap), 1e-15 * spring.tangent(2e-3)) << overlap;
      EXPECT_DOUBLE_EQ(state.force, spring.force(overlap)) << overlap;
      EXPECT_DOUBLE_EQ(state.energy, spring.energy(overlap)) << overlap;
    }
}

TEST(NormalSpring, WithLittleStiffeningIsTheLinearOne) {
  const NormalSpring linear{2e5}, nearly{2e5, 1e-3};
  EXPECT_NEAR(nearly.force(3e-4) / linear.force(3e-4), 1, 1e-6);
  EXPECT_NEAR(nearly.energy(3e-4) / linear.energy(3e-4), 1, 1e-6);
}

TEST(ContactLaw, ASpringThatStiffensGivesBackTheVelocityItTook) {
  const ContactParameters p{stiffening_spring, 0, 0.5, {}};
  const Bounce b = bounce(p, 1e-4, Vec3(0, 0, -30), 2e-9);
  EXPECT_NEAR(b.rebound / 30, 1, 1e-4);
}

TEST(ContactLaw, ForceNeverPulls) {
  const ContactParameters p{{1e4}, 0.9, 0.5, {}};
  ContactHistory history;
  const ContactForce f =
      compute_contact_force(p, moment(1e-6, Vec3(0, 0, 1), Vec3(0, 0, 50), 1e-3), 1e-6, history);
  EXPECT_EQ(f.force.z(), 0);
  // What the dashpot takes from the spring is dissipated, not lost.
  EXPECT_NEAR(f.damped, 0.5 * 1e4 * 1e-6 * 50 * 1e-6, 1e-18)
      << "half: the force rose from zero over the step";
}

TEST(ContactLaw, SlidingForceIsCoulombsWithTheCoefficientOfThatSpeed) {
  const FrictionLaw law{0.44, 0.60, 300};
  for (const double speed : {0.001, 0.01, 1.0}) {
    const ContactParameters p{{1e5}, 0, 0.5, law};
    ContactHistory history;
    ContactForce f;
    for (int i = 0; i < 20000; ++i)
      f = compute_contact_force(p, moment(1e-5, Vec3(0, 0, 1), Vec3(speed, 0, 0), 1e-3), 1e-4 * 0.01 / speed,
                                history);
    const double mu = 0.60 + (0.44 - 0.60) * std::exp(-300 * speed);
    EXPECT_NEAR(-f.force.x(), mu * 1e5 * 1e-5, 1e-9) << speed;
    EXPECT_NEAR(f.friction, mu * 1.0 * speed * 1e-4 * 0.01 / speed, 1e-12)
        << "all work of steady sliding is friction";
  }
}

TEST(ContactLaw, FrictionMayRiseWithSpeed) {
  const FrictionLaw law{0.65, 1.60, 300};
  EXPECT_NEAR(friction_coefficient(law, 0), 0.65, 1e-15);
  EXPECT_GT(friction_coefficient(law, 0.01), friction_coefficient(law, 0.001));
  EXPECT_NEAR(friction_coefficient(law, 1.0), 1.60, 1e-9);
}

TEST(ContactLaw, StickingSpringReturnsItsEnergyWithoutLoss) {
  const ContactParameters p{{1e5}, 0, 0.5, {10, 10, 0}};
  ContactHistory history;
  const double dt = 1e-6, mass = 1e-4;
  double x = 0, v = 0.05, friction = 0, largest = 0;
  for (int i = 0; i < 20000; ++i) {
    const ContactForce f =
        compute_contact_force(p, moment(1e-4, Vec3(0, 0, 1), Vec3(v, 0, 0), mass), dt, history);
    friction += f.friction;
    v += f.force.x() / mass * dt;
    x += v * dt;
    largest = std::max(largest, std::abs(x));
  }
  EXPECT_LT(std::abs(friction), 1e-12 * 0.5 * mass * 0.05 * 0.05 * 20000)
      << "an ideal spring dissipates nothing";
  EXPECT_NEAR(largest, 0.05 * std::sqrt(mass / (0.5 * 1e5)), 0.03 * largest);
}

TEST(ContactLaw, ForceTurnsWithTheContact) {
  // The same state seen from a rotated frame gives the rotated force.
  const ContactParameters p{{3e4}, 0.2, 0.5, {0.4, 0.6, 10}};
  const Mat3 turn = (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).toRotationMatrix();
  ContactHistory a, b;
  a.spring = std::sqrt(0.5 * 3e4) * Vec3(1e-5, 2e-5, 0);
  b.spring = turn * a.spring;
  const Vec3 v(0.3, -0.2, -0.5);
  const ContactForce fa = compute_contact_force(p, moment(1e-4, Vec3(0, 0, 1), v, 1e-3), 1e-6, a);
  const ContactForce fb =
      compute_contact_force(p, moment(1e-4, turn * Vec3(0, 0, 1), turn * v, 1e-3), 1e-6, b);
  EXPECT_LT((turn * fa.force - fb.force).norm(), 1e-12 * fa.force.norm());
  EXPECT_LT((turn * a.spring - b.spring).norm(), 1e-14);
  EXPECT_NEAR(fa.elastic, fb.elastic, 1e-15);
}

}  // namespace
}  // namespace tuft::coupler
