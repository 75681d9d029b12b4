/// Shells that fail: when, with what energy, and what is left.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <string>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "core/parallel.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

constexpr double safety = 0.8;

double mass(const Carpet& carpet) {
  double sum = 0;
  for (const double m : carpet.nodes().mass) sum += m;
  return sum;
}

bool all_finite(const Carpet& carpet) {
  const NodeView v = carpet.nodes();
  for (const auto values : {v.x, v.y, v.z, v.vx, v.vy, v.vz})
    for (const double value : values)
      if (!std::isfinite(value)) return false;
  return true;
}

ShellSection section(ElementKind kind, int points) {
  ShellSection s;
  s.element = kind;
  s.thickness_points = points;
  return s;
}

/// A strip whose nodes fly apart along x: every element is stretched at the same rate, 1/s.
std::unique_ptr<Carpet> flying_apart(double rate, double failure_strain, const ShellSection& s,
                                     Index along = 20) {
  StripShape shape;
  shape.along = along;
  const Strip strip = make_strip(shape, false);
  ShellMaterial material = polyethylene();
  material.failure_strain = failure_strain;
  CarpetOptions options = no_gravity();
  options.section = s;
  auto carpet = std::make_unique<Carpet>(strip.mesh, std::vector{material}, options);
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    carpet->set_velocity(n, rate * Vec3(carpet->nodes().x[n] - 0.5 * shape.length, 0, 0), Vec3(0, 0, 0));
  return carpet;
}

struct Kind {
  const char* name;
  ElementKind element;
  int points;
};

class Erosion : public testing::TestWithParam<Kind> {
 protected:
  [[nodiscard]] static ShellSection shells() { return section(GetParam().element, GetParam().points); }
};

INSTANTIATE_TEST_SUITE_P(, Erosion,
                         testing::Values(Kind{"OnePoint", ElementKind::one_point, 1},
                                         Kind{"OnePointThreeLayers", ElementKind::one_point, 3},
                                         Kind{"Full", ElementKind::fully_integrated, 1},
                                         Kind{"FullThreeLayers", ElementKind::fully_integrated, 3}),
                         [](const auto& of) { return of.param.name; });

/// A single element whose ends fly apart has strain ln(L/L0), and goes as this passes its limit.
TEST_P(Erosion, ComesAtTheLogarithmicFailureStrain) {
  constexpr double limit = 0.2, length = 0.06, ends_apart_at = 600;  // m/s, enough for the stretch
  auto carpet = flying_apart(ends_apart_at / length, limit, shells(), 1);
  const double dt = 0.2 * carpet->stable_step();
  double before = 0, strain = 0;
  for (int i = 0; i < 10000 && carpet->eroded_count() == 0; ++i) {
    before = strain;
    strain = std::log((carpet->nodes().x[2] - carpet->nodes().x[0]) / length);
    carpet->step(dt, no_load(4));
  }
  ASSERT_EQ(carpet->eroded_count(), 1u);
  EXPECT_LE(before, limit);
  EXPECT_GE(strain, limit * (1 - 1e-6));
  EXPECT_LT(strain, limit * 1.02);
}

TEST_P(Erosion, KeepsMassMomentumAndTheBooks) {
  auto carpet = flying_apart(4000, 0.05, shells());
  const double m = mass(*carpet), energy = total(carpet->energy());
  carpet->set_velocity(0, Vec3(3, -2, 1), Vec3(0, 0, 0));  // some bending and shear too
  const Vec3 p = momentum(*carpet);
  const double start = total(carpet->energy());
  ASSERT_GT(energy, 0);
  const double dt = safety * carpet->stable_step();
  for (int i = 0; i < 3000; ++i) carpet->step(dt, no_load(42));
  ASSERT_GT(carpet->eroded_count(), 3u);
  ASSERT_LT(carpet->eroded_count(), 20u);
  EXPECT_GT(carpet->energy().eroded, 0.001 * start);
  EXPECT_EQ(mass(*carpet), m);
  EXPECT_LT((momentum(*carpet) - p).norm(), 1e-12 * m * 100);
  EXPECT_NEAR(total(carpet->energy()), start, 3e-3 * start);
  EXPECT_TRUE(all_finite(*carpet));
}

/// The half step at failure is booked right: the error falls with the square of the step.
TEST_P(Erosion, ErrorOfTheBooksFallsWithTheSquareOfTheStep) {
  const auto error = [](double share) {
    auto carpet = flying_apart(4000, 0.05, shells());
    const double start = total(carpet->energy()), dt = share * carpet->stable_step();
    const int steps = static_cast<int>(400 / share);
    double largest = 0;
    for (int i = 0; i < steps; ++i) {
      carpet->step(dt, no_load(42));
      largest = std::max(largest, std::abs(total(carpet->energy()) - start) / start);
    }
    EXPECT_GT(carpet->eroded_count(), 3u);
    return largest;
  };
  const double coarse = error(0.8), fine = error(0.2);
  EXPECT_LT(coarse, 4e-3);
  EXPECT_LT(fine, 0.2 * coarse);
}

TEST_P(Erosion, OfEverythingLeavesNodesThatFlyOn) {
  auto carpet = flying_apart(20000, 0.01, shells());
  const double dt = safety * carpet->stable_step();
  for (int i = 0; i < 2000; ++i) carpet->step(dt, no_load(42));
  EXPECT_EQ(carpet->eroded_count(), 20u);
  EXPECT_TRUE(all_finite(*carpet));
  EXPECT_TRUE(std::isfinite(carpet->stable_step()));
  const CarpetEnergy e = carpet->energy();
  EXPECT_NEAR(e.strain + e.hourglass, 0, 1e-9 * e.kinetic);
}

TEST_P(Erosion, FollowedButNotReachedGivesTheSameBitsAsNone) {
  auto with = flying_apart(300, 1e3, shells()), without = flying_apart(300, 0, shells());
  with->set_velocity(5, Vec3(1, 2, 3), Vec3(100, 200, 300));
  without->set_velocity(5, Vec3(1, 2, 3), Vec3(100, 200, 300));
  const double dt = safety * without->stable_step();
  EXPECT_EQ(with->stable_step(), without->stable_step());
  for (int i = 0; i < 500; ++i) {
    with->step(dt, no_load(42));
    without->step(dt, no_load(42));
  }
  const NodeView a = with->nodes(), b = without->nodes();
  ASSERT_EQ(a.x.size(), b.x.size());
  EXPECT_EQ(std::memcmp(a.x.data(), b.x.data(), a.x.size_bytes()), 0);
  EXPECT_EQ(std::memcmp(a.vz.data(), b.vz.data(), a.vz.size_bytes()), 0);
  EXPECT_TRUE(without->eroded().empty());
}

TEST_P(Erosion, ResumesWithTheSameBits) {
  auto whole = flying_apart(4000, 0.05, shells());
  const double dt = safety * whole->stable_step();
  for (int i = 0; i < 300; ++i) whole->step(dt, no_load(42));
  ASSERT_GT(whole->eroded_count(), 0u);
  const auto path = std::filesystem::temp_directory_path() /
                    (std::string("tuft_erosion_") + GetParam().name + std::to_string(::getpid()) + ".h5");
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("carpet");
    whole->save(group);
    file.commit();
  }
  auto resumed = flying_apart(4000, 0.05, shells());
  resumed->load(h5::File::open(path).root().open_group("carpet"));
  std::filesystem::remove(path);
  EXPECT_EQ(resumed->eroded_count(), whole->eroded_count());
  for (int i = 0; i < 300; ++i) {
    whole->step(dt, no_load(42));
    resumed->step(dt, no_load(42));
  }
  const NodeView a = whole->nodes(), b = resumed->nodes();
  EXPECT_EQ(std::memcmp(a.x.data(), b.x.data(), a.x.size_bytes()), 0);
  EXPECT_EQ(std::memcmp(a.vx.data(), b.vx.data(), a.vx.size_bytes()), 0);
  EXPECT_EQ(whole->energy().eroded, resumed->energy().eroded);
}

TEST_P(Erosion, GivesTheSameBitsWithOneAndTwoThreads) {
  constexpr Index along = 1200;  // enough for threads to be used
  std::array<std::unique_ptr<Carpet>, 2> carpets;
  for (int threads = 1; threads <= 2; ++threads) {
    set_threads(threads);
    auto& carpet = carpets[static_cast<std::size_t>(threads) - 1];
    carpet = flying_apart(4000, 0.05, shells(), along);
    const double dt = safety * carpet->stable_step();
    for (int i = 0; i < 300; ++i) carpet->step(dt, no_load(2 * (along + 1)));
  }
  set_threads(1);
  const NodeView a = carpets[0]->nodes(), b = carpets[1]->nodes();
  EXPECT_GT(carpets[0]->eroded_count(), 0u);
  EXPECT_EQ(carpets[0]->eroded_count(), carpets[1]->eroded_count());
  EXPECT_EQ(std::memcmp(a.x.data(), b.x.data(), a.x.size_bytes()), 0);
  EXPECT_EQ(carpets[0]->energy().eroded, carpets[1]->energy().eroded);
}

/// Thrown into a parabola w = c x^2, all of a short strip bends at the rate 2 c, and fails when the strain of
/// the outermost point through the thickness, at the share h of its half, is h t/2 2 c time.
TEST_P(Erosion, InBendingComesAtTheStrainOfTheOutermostPoint) {
  constexpr double limit = 0.002, c = 4e7;  // 1/(m s), too fast for the strip to spring back
  StripShape shape;
  shape.length = 0.002;
  shape.along = 2;
  shape.thickness = 0.001;
  const Strip strip = make_strip(shape, false);
  ShellMaterial material = polyethylene();
  material.failure_strain = limit;
  CarpetOptions options = no_gravity();
  options.section = shells();
  Carpet carpet(strip.mesh, {material}, options);
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    const double x = carpet.nodes().x[n] - 0.5 * shape.length;
    carpet.set_velocity(n, Vec3(0, 0, c * x * x), Vec3(0, -2 * c * x, 0));
  }
  const double dt = 0.001 * carpet.stable_step();
  double time = 0;  // of the positions whose strain is looked at
  while (time < 1e-4) {
    carpet.step(dt, no_load(strip.node_count()));
    if (carpet.eroded_count() > 0) break;
    time += dt;
  }
  ASSERT_EQ(carpet.eroded_count(), 2u);
  const double height = shells().thickness_points == 1 ? 1 : std::sqrt(0.6);
  EXPECT_NEAR(time / (limit / (height * shape.thickness * c)), 1, 0.03);
}

TEST(ErosionErrors, NegativeFailureStrainIsRefusedWithItsValue) {
  ShellMaterial material = polyethylene();
  material.failure_strain = -0.1;
  try {
    Carpet carpet(make_strip({}, false).mesh, {material}, no_gravity());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("failure strain is -0.1"), std::string::npos) << error.what();
  }
}

/// Nodes whose shells are gone still meet bodies with the stiffness that suited the carpet as built.
TEST(FailedShells, LeaveAStepNoLargerThanThatOfTheCarpetAsBuilt) {
  StripShape shape;
  shape.along = 20;
  Strip strip = make_strip(shape, false);
  const std::size_t quads = strip.mesh.quads.size();
  for (std::size_t e = 0; e < quads; ++e) strip.mesh.material[e] = e < quads / 2 ? 0 : 1;
  std::vector<ShellMaterial> materials{polyethylene(), polyethylene()};
  materials[0].failure_strain = 0.001;
  materials[1].young_modulus /= 100;
  Carpet carpet(strip.mesh, materials, no_gravity());
  const double as_built = carpet.stable_step();
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    carpet.set_velocity(n, 2000 * Vec3(carpet.nodes().x[n], 0, 0), Vec3(0, 0, 0));
  const Vec3Array load = no_load(strip.node_count());
  for (int i = 0; i < 20; ++i) carpet.step(safety * carpet.stable_step(), load);
  ASSERT_GE(carpet.eroded_count(), quads / 2) << "the stiff half has failed";
  ASSERT_GT(carpet.stable_steps_of_materials()[1], 5 * as_built) << "the soft one would bear far more";
  EXPECT_LE(carpet.stable_step(), as_built);
}

TEST(FailedShells, AreNotBroughtBackByACheckpoint) {
  auto carpet = flying_apart(3000, 0.01, {});
  const Vec3Array load = no_load(carpet->nodes().x.size());
  const auto path =
      std::filesystem::temp_directory_path() / ("tuft_failed_shells_" + std::to_string(::getpid()) + ".h5");
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("carpet");
    carpet->save(group);
    file.commit();
  }
  for (int i = 0; i < 200 && carpet->eroded_count() == 0; ++i)
    carpet->step(safety * carpet->stable_step(), load);
  ASSERT_GT(carpet->eroded_count(), 0U);
  EXPECT_THROW(carpet->load(h5::File::open(path).root().open_group("carpet")), std::logic_error);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tuft::fe::test
