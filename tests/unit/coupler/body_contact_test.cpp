/// Contact of many points with bodies, summed part by part on all threads.
#include "coupler/body_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/parallel.h"

namespace tuft::coupler {
namespace {

/// A bed of balls pressed into a floor and two walls in a corner: some touch one of them, some two or three.
/// More than two parts of pairs, whose bounds fall between the pairs of one point.
class Corner {
 public:
  static constexpr std::size_t count = 900;
  static constexpr double radius = 1e-3, window = 1e-6;

  /// size: of them, from `first` on.
  explicit Corner(std::size_t first = 0, std::size_t size = count) : contact_(settings(first, size)) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> height(0.6 * radius, 1.2 * radius), speed(-0.2, 0.2);
    for (std::size_t i = 0; i < count; ++i) {
      const double x = height(random), y = height(random), z = height(random), u = speed(random),
                   v = speed(random), w = speed(random);
      if (i < first || i >= first + size) continue;
      position_.push_back({x, y, z});
      velocity_.push_back({u, v, w});
    }
    radii_.assign(size, radius), mass_.assign(size, 1e-5);
    for (int d = 0; d < 3; ++d) {
      RigidBody body;
      body.shape = HalfSpace{Vec3::Unit(d)};
      bodies_.push_back(body);
    }
    contact_.search(view(), bodies_, radius, false);
  }
  [[nodiscard]] ParticleView view() const {
    ParticleView points;
    points.x = position_.x, points.y = position_.y, points.z = position_.z;
    points.vx = velocity_.x, points.vy = velocity_.y, points.vz = velocity_.z;
    points.radius = radii_;
    points.mass = mass_;
    return points;
  }
  void evaluate() {
    on_points.assign(position_.size(), 0);
    on_bodies.reset(bodies_.size());
    contact_.evaluate(view(), bodies_, 0, window, 0, 0, window, on_points, nullptr, on_bodies);
  }
  [[nodiscard]] std::size_t pairs() const { return contact_.pair_count(); }
  [[nodiscard]] double energy() const {
    const ContactEnergy& e = contact_.energy();
    return e.elastic + e.friction + e.damped + e.released;
  }
  [[nodiscard]] double least_step(bool with_dashpots) const {
    return contact_.least_stable_step(view(), approaches(), 1e-4, with_dashpots);
  }
  [[nodiscard]] std::vector<double> steps(bool with_dashpots) const {
    return contact_.stable_steps(view(), approaches(), 1e-4, with_dashpots);
  }
  [[nodiscard]] std::vector<BodyContact::Approach> approaches() const {
    std::vector<BodyContact::Approach> found;
    contact_.look(view(), bodies_, found);
    return found;
  }

  Vec3Array on_points;  ///< N s
  BodyImpulses on_bodies;

 private:
  static BodyContactSettings settings(std::size_t first, std::size_t size) {
    BodyContactSettings settings;
    for (std::size_t i = first; i < first + size; ++i) {
      settings.spring.push_back({2e4, i % 2 == 0 ? 0.0 : 300.0, 1e-3});
      settings.damping_ratio.push_back(0.1);
      settings.friction.push_back({0.3, 0.3, 0});
    }
    return settings;
  }
  BodyContact contact_;
  std::vector<RigidBody> bodies_;
  Vec3Array position_, velocity_;
  std::vector<double> radii_, mass_;
};

TEST(BodyContact, GivesPointsAndBodiesOppositeImpulsesWhereAPartEndsToo) {
  Corner corner;
  ASSERT_GT(corner.pairs(), 4 * sum_block);
  corner.evaluate();
  Vec3 points(0, 0, 0), bodies(0, 0, 0);
  for (std::size_t i = 0; i < Corner::count; ++i) points += corner.on_points[i];
  for (const Vec3& impulse : corner.on_bodies.impulse) bodies += impulse;
  EXPECT_EQ(corner.on_bodies.measured, corner.on_bodies.impulse) << "all are kicked in every window";
  EXPECT_GT(points.minCoeff(), 0) << "each pushes along its own axis";
  EXPECT_LT((points + bodies).norm(), 1e-13 * points.norm());
  for (Eigen::Index d = 0; d < 3; ++d) EXPECT_LT(corner.on_bodies.impulse[static_cast<std::size_t>(d)][d], 0);
}

TEST(BodyContact, OfManyPointsIsThatOfEachByItself) {
  Corner all;
  all.evaluate();
  std::vector<Vec3> bodies(3, Vec3::Zero());
  double energy = 0;
  for (std::size_t i = 0; i < Corner::count; ++i) {
    Corner one(i, 1);
    one.evaluate();
    EXPECT_EQ(all.on_points[i], one.on_points[0]) << i;
    for (std::size_t b = 0; b < bodies.size(); ++b) bodies[b] += one.on_bodies.impulse[b];
    energy += one.energy();
  }
  for (std::size_t b = 0; b < bodies.size(); ++b)
    EXPECT_LT((bodies[b] - all.on_bodies.impulse[b]).norm(), 1e-13 * bodies[b].norm());
  EXPECT_NEAR(all.energy(), energy, 1e-12 * energy);
}

TEST(BodyContact, IsTheSameToTheLastBitForAnyNumberOfThreads) {
  const int threads = omp_get_max_threads();
  Corner one, three;
  for (int k = 0; k < 3; ++k) {
    set_threads(1);
    one.evaluate();
    set_threads(3);
    three.evaluate();
  }
  set_threads(threads);
  EXPECT_EQ(one.on_points.x, three.on_points.x);
  EXPECT_EQ(one.on_points.z, three.on_points.z);
  for (std::size_t b = 0; b < 3; ++b) EXPECT_EQ(one.on_bodies.impulse[b], three.on_bodies.impulse[b]);
  EXPECT_EQ(one.energy(), three.energy());
  EXPECT_NE(one.energy(), 0);
}

TEST(BodyContact, LeastStableStepIsTheLeastOfAllPoints) {
  const Corner corner;
  for (const bool with_dashpots : {false, true}) {
    const std::vector<double> steps = corner.steps(with_dashpots);
    EXPECT_EQ(corner.least_step(with_dashpots), *std::min_element(steps.begin(), steps.end()));
  }
}

/// A ball pressed 0.1 mm into bodies that stand to each other as their normals do; the springs are linear.
class Pressed {
 public:
  static constexpr double mass = 1e-5, stiffness = 2e4, overlap = 1e-4, radius = 1e-3;

  explicit Pressed(const std::vector<Vec3>& normals, double damping_ratio = 0)
      : contact_({{{stiffness}}, {damping_ratio}, {{1e3, 1e3, 0}}}) {
    for (const Vec3& normal : normals) {
      RigidBody& body = bodies_.emplace_back();
      body.shape = HalfSpace{normal};
      body.position = (overlap - radius) * normal;
      load_ -= stiffness * overlap * normal;
    }
    contact_.search(view(), bodies_, radius, false);
  }
  [[nodiscard]] double stable_step() const {
    std::vector<BodyContact::Approach> approaches;
    contact_.look(view(), bodies_, approaches);
    return contact_.least_stable_step(view(), approaches, 1e-4, true);
  }
  /// How far it is off the place in which a load holds it, over how far it was pushed off, after 300 steps.
  double swings(double step) {
    constexpr double pushed = 1e-9;
    position_.add(0, Vec3(pushed, 0, 0));
    double farthest = 0;
    for (int k = 0; k < 300; ++k) {
      Vec3Array force;
      force.assign(1, 0);
      BodyImpulses on_bodies;
      on_bodies.reset(bodies_.size());
      contact_.evaluate(view(), bodies_, 0, step, 0, 0, 1, force, nullptr, on_bodies);
      velocity_.add(0, step / mass * (force[0] + load_));
      position_.add(0, step * velocity_[0]);
      if (k >= 250) farthest = std::max(farthest, position_[0].norm());
    }
    return farthest / pushed;
  }

 private:
  [[nodiscard]] ParticleView view() const {
    ParticleView points;
    points.x = position_.x, points.y = position_.y, points.z = position_.z;
    points.vx = velocity_.x, points.vy = velocity_.y, points.vz = velocity_.z;
    points.radius = radii_, points.mass = masses_;
    return points;
  }
  BodyContact contact_;
  std::vector<RigidBody> bodies_;
  Vec3 load_{0, 0, 0};  ///< N
  Vec3Array position_ = still(), velocity_ = still();
  std::vector<double> radii_{radius}, masses_{mass};
  static Vec3Array still() {
    Vec3Array one;
    one.assign(1, 0);
    return one;
  }
};

double stable_step_between(const std::vector<Vec3>& normals) {
  return Pressed(normals).stable_step();
}

TEST(BodyContact, BearsTheStableStepBetweenBodiesWithTheirDashpotsAndNoLongerOne) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const std::vector<std::vector<Vec3>> arrangements{{x}, {x, z}, {x, y, z}, {x, -x}};
  for (const double damping_ratio : {0.0, 0.2, 0.5})
    for (const std::vector<Vec3>& normals : arrangements) {
      const double step = Pressed(normals, damping_ratio).stable_step();
      EXPECT_LT(Pressed(normals, damping_ratio).swings(0.98 * step), 10) << damping_ratio << normals.size();
      EXPECT_GT(Pressed(normals, damping_ratio).swings(1.02 * step), 100) << damping_ratio << normals.size();
    }
}

TEST(BodyContact, StableStepBetweenBodiesIsThatOfTheStiffestDirection) {
  const double one = 2 * std::sqrt(1e-5 / 2e4), tangential = ContactParameters{}.tangential_ratio;
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  EXPECT_NEAR(stable_step_between({z}), one, 1e-12 * one);
  // At right angles the others' tangential springs act along with a normal one.
  EXPECT_NEAR(stable_step_between({x, z}), one / std::sqrt(1 + tangential), 1e-12 * one);
  EXPECT_NEAR(stable_step_between({x, y, z}), one / std::sqrt(1 + 2 * tangential), 1e-12 * one);
  // Between two faces both normal springs do.
  EXPECT_NEAR(stable_step_between({z, -z}), one / std::sqrt(2), 1e-12 * one);
  const Vec3 slanting = Vec3(1, 0, 1).normalized();
  const double stiffest = 2 * tangential + (1 - tangential) * (1 + std::sqrt(0.5));
  EXPECT_NEAR(stable_step_between({z, slanting}), one / std::sqrt(stiffest), 1e-12 * one);
}

}  // namespace
}  // namespace tuft::coupler
