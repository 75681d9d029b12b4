/// A host that listens at a TCP port: the same bits as with shared memory, and a clear line when it is gone.
#include "tests/hard_cases/dem_bridge/network.h"
#include "tests/verification/dem_bridge/clump_scene.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

TEST_F(Network, GivesTheBitsOfSharedMemoryAndResumes) {
  expect_the_bits_of_shared_memory_and_resume();
}

/// Each end has a memory of its own: what is counted anew here must not come back from there.
TEST_F(Network, CountsOverlapsAnewAsWithSharedMemory) {
  listen();
  const auto shared = local();
  const auto over_tcp = remote();
  const auto largest = [](const DemInfill& infill) { return infill.largest_overlaps()[0].largest_of_run; };
  double before = 0;
  for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
    const double window = 0.5 * infill->stable_step();
    const auto advance_in_sight = [&](int windows) {
      for (int k = 0; k < windows; ++k) {
        infill->begin_window(window, 1, true);
        infill->advance(window, 1, block_.confine(*infill, window));
      }
    };
    block_.shake(*infill, 0.5);
    advance_in_sight(100);
    before = largest(*infill);
    infill->count_overlaps_from_now(0);
    advance_in_sight(1);
    EXPECT_GT(largest(*infill), 0);
    EXPECT_LT(largest(*infill), before);
  }
  EXPECT_EQ(largest(*over_tcp), largest(*shared));
}

/// Two clumps meet and then leave, and so does a sphere; loads come and go.
TEST_F(Network, GivesTheBitsOfSharedMemoryForClumpsAndGrainsThatLeave) {
  block_.materials = {clumped(Clump{}), rubber()};
  Grains& grains = block_.grains;
  grains = {};
  add_clump(grains, block_.materials[0], Vec3(0.0475, 0, 0), 0.002, turn_about(Vec3(1, 2, 3), 0.7));
  add_clump(grains, block_.materials[0], Vec3(0.0445, 0.0002, 0), 0.002);
  for (const double height : {0.0492, -0.02}) {
    add_grain(grains, Vec3(0, 0, height), 0.001, 1150);
    grains.body.push_back(-1);
    grains.material.back() = 1;
  }
  listen();
  const auto shared = local();
  const auto over_tcp = remote();
  for (DemInfill* infill : {shared.get(), over_tcp.get()}) {
    for (std::size_t i = 4; i < 8; ++i) infill->set_velocity(i, Vec3(8, 0, 0), Vec3(0, 0, 0));
    infill->set_velocity(8, Vec3(0, 0, 4), Vec3(0, 100, 0));
    ContactImpulses contact = no_impulses(grains.size());
    const double window = infill->stable_step();
    for (int k = 0; k < 500; ++k) {
      const double push = k % 3 == 0 ? 1e-8 : 0;
      for (const std::size_t i : {1, 9}) {
        contact.linear.set(i, push * Vec3(1, 2, 0));
        contact.angular.set(i, 1e-3 * push * Vec3(0, 1, 1));
      }
      infill->advance(window, 2, contact);
    }
  }
  expect_same_bits(*shared, *over_tcp);
  EXPECT_GT(shared->energy().dissipated, 0) << "the clumps have met";
  EXPECT_EQ(shared->expelled().particles, 3u) << "a sphere, and clumps as one each";
  EXPECT_EQ(over_tcp->expelled().particles, shared->expelled().particles);
  EXPECT_EQ(over_tcp->expelled().momentum, shared->expelled().momentum);
  EXPECT_EQ(over_tcp->expelled().kinetic_energy, shared->expelled().kinetic_energy);
}

TEST_F(Network, AHostThatIsKilledIsOneClearLineAndTheNextRunIsServed) {
  listen();
  auto infill = remote();
  advance(*infill, 2);
  ::kill(server(), SIGKILL);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(endpoint_ + " can no longer be reached"), std::string::npos) << message;
  infill.reset();
  infill = remote();
  advance(*infill, 2);
}

TEST_F(Network, AHostThatHangsOrIsNotThereIsReportedAfterTheTimeout) {
  settings_.options.answer_timeout = 0.5;
  const std::string nobody = message_of<RunError>([&] { (void)remote(); });
  EXPECT_NE(nobody.find("did not answer for 0.5 s"), std::string::npos) << nobody;
  EXPECT_NE(nobody.find("--listen tcp://*:"), std::string::npos) << nobody;
  settings_.options.answer_timeout = 10;
  listen();
  const auto infill = remote();
  advance(*infill, 1);
  const int host = server();
  ::kill(host, SIGSTOP);
  const std::string message = message_of<RunError>([&] { advance(*infill, 1); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find(endpoint_), std::string::npos) << message;
  ::kill(host, SIGCONT);
  EXPECT_TRUE(gone_within(host, 5.0)) << "a host whose driver has hung up ends";
}

/// Not even its watch on the driver runs then.
TEST_F(Network, AHostThatStaysFrozenIsEndedAndTheNextDriverServed) {
  listen({"--frozen-after", "5"});
  int host = 0;
  {
    const auto infill = remote();
    advance(*infill, 1);
    host = server();
    ::kill(host, SIGSTOP);
    EXPECT_NE(message_of<RunError>([&] { advance(*infill, 1); }), "");
  }
  EXPECT_TRUE(gone_within(host, 20.0)) << "it is still there";
  const auto next = remote();
  advance(*next, 1);
  EXPECT_NE(said().find("frozen for 5 s and was ended"), std::string::npos) << said();
}

TEST_F(Network, AnErrorOfLiggghtsComesWithItsWords) {
  listen();
  block_.materials[0].grain->restitution = 0.01;  // LIGGGHTS wants 0.05 to 1
  const std::string message = message_of<RunError>([&] { (void)remote(); });
  EXPECT_TRUE(is_one_line(message)) << message;
  EXPECT_NE(message.find("oefficientRestitution"), std::string::npos) << message;
}

}  // namespace
}  // namespace tuft::dem::test
