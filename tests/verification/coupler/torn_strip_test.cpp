// Contact with shells that fail: what touched them is let go, and the books stay closed.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>

#include "core/hdf5_file.h"
#include "strip_case.h"

namespace tuft::coupler {
namespace {

/// One ball on a spring to held facets, moved by hand: leapfrog keeps kinetic energy (of the velocities
/// before and after a kick) and that of a linear spring to rounding.
class BallOnFacets {
 public:
  BallOnFacets(int facets, double friction) : mesh_(strip(facets, 0.004 * facets, 0.004, thickness, true)) {
    const std::size_t count = mesh_.nodes.size();
    mesh_.clamped.assign(count, 1);
    ParticleShellSettings settings;
    settings.stiffness = {20};
    settings.damping_ratio = {0};
    settings.friction = {{friction, friction, 0}};
    still_.assign(count, 0.0);
    mass_.assign(count, 1e-5);
    position_ = mesh_.nodes;
    contact_.emplace(mesh_, std::vector<double>(count, 1e4), mass_, settings);
    ball_.add(Vec3(-0.002 * (facets - 1) + 1e-4, 3e-4, 0.0024), Vec3(0.3, -0.2, -3), radius, ball_mass);
    contact_->search(ball_.particles(), nodes(), 0.005, false);
  }

  /// Energy at the forces, J; then moves on.
  double step() {
    impulses_.linear.assign(1, 0.0);
    impulses_.angular.assign(1, 0.0);
    Vec3Array force;
    force.assign(mesh_.nodes.size(), 0.0);
    contact_->evaluate(ball_.particles(), 0, nodes(), dt, 0, 0, force, impulses_);
    const Vec3 before = ball_.velocity[0], after = before + impulses_.linear[0] / ball_mass;
    const ContactEnergy& e = contact_->energy();
    ball_.velocity.set(0, after);
    ball_.position.add(0, dt * after);
    return 0.5 * ball_mass * before.dot(after) + e.elastic + e.damped + e.friction;
  }
  void lose_first_facet() {
    std::vector<std::uint8_t> eroded(mesh_.quads.size(), 0);
    eroded[0] = 1;
    contact_->leave_out(eroded, ball_.particles(), 0, nodes(), dt, 0);
  }
  [[nodiscard]] double height() const { return ball_.position.z[0]; }
  [[nodiscard]] const ParticleShellContact& contact() const { return *contact_; }

 private:
  static constexpr double thickness = 5e-4, radius = 0.002, ball_mass = 2e-5, dt = 1e-6;

  [[nodiscard]] fe::NodeView nodes() const {
    return {position_.x, position_.y, position_.z, still_, still_, still_, mass_, mesh_.clamped};
  }

  fe::ShellMesh mesh_;
  Vec3Array position_;
  std::vector<double> still_, mass_;
  PointInfill ball_;
  ContactImpulses impulses_;
  std::optional<ParticleShellContact> contact_;
};

TEST(LostFacet, TheEnergyOfItsSpringsIsBookedOnEitherSideOfTheSurface) {
  for (const double friction : {0.0, 0.6})
    for (const int facets : {1, 2})
      for (const double lost_at : {0.001, -0.0003}) {
        BallOnFacets ball(facets, friction);
        const double thrown = ball.step();
        for (int i = 0; i < 2000 && ball.height() > lost_at; ++i)
          EXPECT_NEAR(ball.step(), thrown, 1e-4 * thrown);
        const ContactEnergy before = ball.contact().energy();
        ASSERT_GT(before.elastic, 0.1 * thrown);
        ball.lose_first_facet();
        for (int i = 0; i < 100; ++i)
          ASSERT_NEAR(ball.step(), thrown, 1e-4 * thrown) << "friction " << friction << ", " << facets
                                                          << " facets, lost at " << lost_at << ", step " << i;
        const ContactEnergy& after = ball.contact().energy();
        EXPECT_GT(after.damped, 0.5 * before.elastic);
        if (facets == 1) {
          EXPECT_EQ(after.friction > before.friction, friction > 0) << "the tangential spring is let go too";
        }
        EXPECT_EQ(ball.contact().pair_count(), facets == 1 ? 0U : 1U);
      }
}

/// A ball that a held strip cannot stop tears it and flies on: what touched a failed shell is let go.
class TornStrip : public ::testing::TestWithParam<double> {};

TEST_P(TornStrip, LetsTheBallThroughWithMomentumAndEnergyInBalance) {
  StripCase setup;
  setup.window = GetParam();
  setup.clamp = true;
  setup.damping_ratio = 0.1;
  setup.failure_strain = 0.05;
  auto infill = std::make_unique<PointInfill>();
  infill->add(Vec3(0.0031, 0.0002, 0.004), Vec3(0, 0, -40), 0.002, 1e-4);
  const double thrown = 0.5 * 1e-4 * 40 * 40;
  Simulation s = make(setup, std::move(infill));
  for (int i = 0; i < 100; ++i) s.advance_interval(1e-5);
  EXPECT_GT(s.carpet().eroded_count(), 0u);
  EXPECT_LT(s.carpet().eroded_count(), 10u);
  EXPECT_GT(s.ledger().last().eroded, 0.01 * thrown);
  EXPECT_LT(s.infill().particles().z[0], -0.01) << "through";
  EXPECT_LT(s.infill().particles().vz[0], -10);
  EXPECT_LT(s.momentum_error(), 1e-12);
  EXPECT_NEAR(s.ledger().imbalance(), 0, 0.005 * thrown);
}

/// A heavy ball and many light ones about it that do not see each other: pairs enough for several blocks.
std::unique_ptr<PointInfill> crowd() {
  auto infill = std::make_unique<PointInfill>();
  infill->add(Vec3(0.0031, 0.0002, 0.004), Vec3(0, 0, -40), 0.002, 1e-4);
  for (int i = 0; i < 700; ++i) {
    const double along = 0.018 * std::sin(1.7 * i), across = 0.0015 * std::sin(2.9 * i);
    infill->add(Vec3(along, across, 9e-4 + 2e-4 * std::sin(4.1 * i)), Vec3(0, 0, -0.5), 5e-4, 1e-7);
  }
  return infill;
}

/// Goes on from a checkpoint made as soon as a shell has failed, beside the run that never stopped.
void expect_same_bits_resumed(const StripCase& setup, double interval, bool expect_subcycles) {
  Simulation whole = make(setup, crowd());
  int intervals = 0;
  std::size_t pairs = 0;
  while (whole.carpet().eroded_count() == 0 && intervals++ < 100) {
    pairs = whole.particle_shell().pair_count();
    whole.advance_interval(interval);
  }
  ASSERT_GT(whole.carpet().eroded_count(), 0u);
  ASSERT_GT(pairs, 500u);
  ASSERT_LT(whole.particle_shell().pair_count(), pairs) << "some touched nothing but what has failed";
  const auto path = std::filesystem::temp_directory_path() /
                    fmt::format("tuft_torn_{}_{}.h5", 1e6 * setup.window, setup.subcycle);
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("state");
    whole.save(group);
    file.commit();
  }
  Simulation resumed = make(setup, crowd());
  auto& points = static_cast<PointInfill&>(resumed.infill());
  const auto& at_checkpoint = static_cast<const PointInfill&>(whole.infill());
  points.position = at_checkpoint.position;  // PointInfill keeps no checkpoint of its own
  points.velocity = at_checkpoint.velocity;
  resumed.load(h5::File::open(path).root().open_group("state"));
  std::filesystem::remove(path);
  int largest_subcycle = 1;
  for (int i = 0; i < 30; ++i) {
    whole.advance_interval(interval);
    resumed.advance_interval(interval);
    largest_subcycle = std::max(largest_subcycle, whole.step_plan().carpet_subcycle);
  }
  EXPECT_EQ(largest_subcycle > 1, expect_subcycles);
  EXPECT_EQ(whole.infill().particles().vz[0], resumed.infill().particles().vz[0]);
  EXPECT_EQ(whole.carpet().eroded_count(), resumed.carpet().eroded_count());
  EXPECT_EQ(whole.particle_shell().pair_count(), resumed.particle_shell().pair_count());
  EXPECT_EQ(whole.ledger().last().values(), resumed.ledger().last().values());
  const fe::NodeView a = whole.carpet().nodes(), b = resumed.carpet().nodes();
  for (std::size_t n = 0; n < a.x.size(); ++n) ASSERT_EQ(a.vz[n], b.vz[n]) << "node " << n;
}

TEST_P(TornStrip, GoesOnFromACheckpointWithTheSameBits) {
  StripCase setup;
  setup.window = GetParam();
  setup.clamp = true;
  setup.failure_strain = 0.05;
  expect_same_bits_resumed(setup, 1e-5, false);
}

/// Half of the strip is soft enough to be evaluated every few steps; shells everywhere can fail.
StripCase two_rates(double window) {
  StripCase setup;
  setup.window = window;
  setup.clamp = true;
  setup.failure_strain = 0.05;
  setup.elements = 20;
  setup.softer_half = 1.0 / 40;
  setup.subcycle = true;
  setup.mass_scaling_limit = 0.2;
  return setup;
}

TEST_P(TornStrip, GoesOnWithTheSameBitsWhenSubcycledAndWithMassesScaled) {
  expect_same_bits_resumed(two_rates(GetParam()), 3.7e-5, true);
}

TEST_P(TornStrip, KeepsItsBooksWhenSubcycledAndWithMassesScaled) {
  StripCase setup = two_rates(GetParam());
  setup.coupling_particle_stiffness = 1e4;
  auto infill = std::make_unique<PointInfill>();
  infill->add(Vec3(0.0071, 0.0002, 0.004), Vec3(0, 0, -40), 0.002, 1e-4);
  infill->add(Vec3(-0.0071, 0.0002, 0.004), Vec3(0, 0, -20), 0.002, 1e-4);
  const double thrown = 0.5 * 1e-4 * (40 * 40 + 20 * 20);
  Simulation s = make(setup, std::move(infill));
  double largest = 0;
  for (int i = 0; i < 80; ++i) {
    s.advance_interval(1e-5);
    largest = std::max(largest, std::abs(s.ledger().imbalance()));
  }
  EXPECT_GT(s.carpet().eroded_count(), 1u);
  EXPECT_LT(s.momentum_error(), 1e-12);
  EXPECT_LT(largest, 0.005 * thrown);
}
INSTANTIATE_TEST_SUITE_P(Windows, TornStrip, ::testing::Values(1e-6, 4e-6));

}  // namespace
}  // namespace tuft::coupler
