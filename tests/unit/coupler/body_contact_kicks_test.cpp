/// Contact of points that have kicks of their own with bodies.
#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

#include "coupler/body_contact.h"

namespace tuft::coupler {
namespace {

constexpr double radius = 1e-3, overlap = 1e-4, window = 1e-6, stiffness = 2e4, mass = 1e-5;

/// A ball that lies on a body which can move.
class OnAPlate {
 public:
  enum class Search { at_once, not_yet };
  explicit OnAPlate(Search when) : OnAPlate(2, 0, when) {}
  explicit OnAPlate(double of_plate = 2, double speed = 0, Search when = Search::at_once)
      : contact_(settings()) {
    RigidBody plate;
    plate.shape = HalfSpace{Vec3::UnitZ()};
    plate.position = Vec3(0, 0, overlap - radius);
    plate.mass = of_plate;
    plate.velocity = Vec3(0, 0, speed);
    bodies_ = {plate};
    if (when == Search::at_once) search();
  }
  void search(bool keep_overlap = false) { contact_.search(view(), bodies_, radius, keep_overlap); }
  /// Of a window in which the ball has a kick of `length` (s); 0: none.
  BodyImpulses evaluate(double length) {
    kick_ = length;
    on_ball.assign(1, 0);
    BodyImpulses on_bodies;
    on_bodies.reset(1);
    ParticleView points = view();
    points.kicks = {1, {&since_, 1}, {&kick_, 1}, {&lag_, 1}};
    contact_.evaluate(points, bodies_, 0, window, 0, 0, window, on_ball, nullptr, on_bodies);
    return on_bodies;
  }
  [[nodiscard]] float rate(double least, double horizon = 0) const {
    std::vector<BodyContact::Approach> approaches;
    contact_.look(view(), bodies_, approaches);
    std::vector<float> rates(1, 0);
    contact_.raise_rates(view(), bodies_, approaches, horizon, true, least, rates);
    return rates[0];
  }
  [[nodiscard]] BodyContact& contact() { return contact_; }

  Vec3Array on_ball;  ///< N s

 private:
  static BodyContactSettings settings() { return {{{stiffness}}, {0}, {{0.3, 0.3, 0}}}; }
  [[nodiscard]] ParticleView view() const {
    ParticleView points;
    points.x = points.y = points.z = points.vx = points.vy = points.vz = zero_;
    points.radius = radii_, points.mass = masses_;
    return points;
  }
  BodyContact contact_;
  std::vector<RigidBody> bodies_;
  std::vector<double> zero_{0}, radii_{radius}, masses_{mass};
  double kick_ = 0, since_ = window, lag_ = 0.5 * window;
};

constexpr double force = stiffness * overlap;

TEST(KicksAtABody, GiveBodyAndPointTheSameAtOnceAndAGaugeItsForceInEveryWindow) {
  OnAPlate ball;
  const BodyImpulses kicked = ball.evaluate(2 * window);
  EXPECT_NEAR(ball.on_ball.z[0], 2 * window * force, 1e-12 * window * force);
  EXPECT_EQ(kicked.impulse[0].z(), -ball.on_ball.z[0]);
  EXPECT_NEAR(kicked.until_now[0].z(), -0.5 * window * force, 1e-12 * window * force);
  EXPECT_NEAR(kicked.measured[0].z(), -window * force, 1e-12 * window * force);
  const BodyImpulses between = ball.evaluate(0);
  EXPECT_EQ(ball.on_ball.z[0], 0);
  EXPECT_EQ(between.impulse[0].z(), 0);
  EXPECT_EQ(between.measured[0], kicked.measured[0]);
}

TEST(KicksAtABody, AreMeasuredOnAfterASearchAndFromACheckpoint) {
  OnAPlate ball, resumed;
  const Vec3 held = ball.evaluate(2 * window).measured[0];
  ASSERT_NE(held.z(), 0);
  ball.search();
  EXPECT_EQ(ball.evaluate(0).measured[0], held);

  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("tuft-test-" + std::to_string(::getpid()) + "-kicks.h5");
  {
    h5::File stored = h5::File::create_atomically(file);
    h5::Group group = stored.root();
    ball.contact().save(group);
    stored.commit();
  }
  resumed.contact().load(h5::File::open(file).root(), 1);
  std::filesystem::remove(file);
  EXPECT_EQ(resumed.evaluate(0).measured[0], held);
}

/// A checkpoint that is older than the first search leaves it to that to see what overlaps as placed.
TEST(BodyContactFromACheckpoint, SeesWhatOverlapsAsPlacedInItsFirstSearchAndInNoOther) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("tuft-test-" + std::to_string(::getpid()) + "-search.h5");
  for (const bool searched : {false, true}) {
    OnAPlate placed(OnAPlate::Search::not_yet), resumed(OnAPlate::Search::not_yet);
    if (searched) placed.search(true);
    {
      h5::File stored = h5::File::create_atomically(file);
      h5::Group group = stored.root();
      placed.contact().save(group);
      stored.commit();
    }
    resumed.contact().load(h5::File::open(file).root(), 1);
    EXPECT_EQ(resumed.contact().initial_overlap().pairs, searched ? 1u : 0u);
    resumed.search(true);
    EXPECT_EQ(resumed.contact().initial_overlap().pairs, 1u) << searched;
  }
  std::filesystem::remove(file);
}

TEST(KicksAtABody, AreAsLongAsContactBearsWhereTheBodyIsHeavy) {
  const double of_contact = 0.5 * std::sqrt(stiffness / mass);
  EXPECT_NEAR(OnAPlate().rate(0), of_contact, 1e-6 * of_contact);
  EXPECT_NEAR(OnAPlate().rate(3 * of_contact), 3 * of_contact, 1e-6 * of_contact) << "the least asked for";
}

TEST(KicksAtABody, TakeATenthOfWhatIsStableForALightOneAndOfTheWayOfAFastOne) {
  constexpr double light = 1e-4;
  const double of_mass = 10 * 0.5 * std::sqrt(stiffness / light);
  EXPECT_NEAR(OnAPlate(light).rate(0), of_mass, 1e-6 * of_mass);
  constexpr double speed = 30;
  EXPECT_NEAR(OnAPlate(2, speed).rate(0), 10 * speed / radius, 1e-6 * 10 * speed / radius);
  EXPECT_LT(OnAPlate(2, -speed).rate(0), speed / radius) << "it leaves";
}

}  // namespace
}  // namespace tuft::coupler
