/// Slow elements evaluated every m-th step.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "core/parallel.h"
#include "fe_carpet/subcycling.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

/// One half of material 0, the other of material 1: no spectrum is more regular.
ShellMesh two_part_strip(bool clamp_root, bool swapped) {
  Strip strip = make_strip({0.06, 0.006, 0.0005, 20, 2}, clamp_root);
  for (std::size_t e = 0; e < strip.mesh.quads.size(); ++e)
    strip.mesh.material[e] = (e < 20) == swapped ? 1 : 0;
  return strip.mesh;
}

/// Materials of which `slow` (0 or 1) bears `ratio` times the other's step on the mesh.
std::vector<ShellMaterial> materials_of_ratio(const ShellMesh& mesh, std::size_t slow, double ratio) {
  std::vector<ShellMaterial> materials{{0.2e9, 0.3, 900}, {0.2e9, 0.3, 900}};
  const std::vector<double> step = Carpet(mesh, materials, no_gravity()).stable_steps_of_materials();
  materials[slow].young_modulus *= std::pow(step[slow] / step[1 - slow] / (ratio * 1.0001), 2);
  return materials;
}

CarpetOptions subcycled(CarpetOptions options = no_gravity()) {
  options.subcycle = true;
  return options;
}

void shake(Carpet& carpet, double speed) {
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n) {
    if (nodes.clamped[n]) continue;
    const auto wave = [n, speed](double k) { return speed * std::sin(k * static_cast<double>(n) + k); };
    carpet.set_velocity(n, Vec3(wave(1.1), wave(2.3), wave(3.7)),
                        100 * Vec3(wave(0.7), wave(1.9), wave(2.9)));
  }
}

/// Every node the faster the higher, or the farther along x.
void whip(Carpet& carpet, double speed) {
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < nodes.x.size(); ++n)
    if (!nodes.clamped[n]) {
      const double far = std::max(nodes.z[n] / 0.03, nodes.x[n] / 0.06);
      carpet.set_velocity(n, speed * far * far * Vec3(0, 1, 0.5), Vec3(0, 0, 0));
    }
}

class Subcycling : public testing::Test {
 protected:
  void SetUp() override { set_threads(1); }
  void TearDown() override { set_threads(all_threads_); }

 private:
  int all_threads_ = omp_get_max_threads();
};

TEST_F(Subcycling, EvaluatesSlowElementsOnceAWindowAndTheFastOnesEveryStep) {
  const ShellMesh mesh = two_part_strip(true, false);
  Carpet carpet(mesh, materials_of_ratio(mesh, 0, 5.2), subcycled());
  ASSERT_EQ(carpet.subcycle(), 4);
  EXPECT_EQ(carpet.subcycle_ratio(), 4);
  const Vec3Array load = no_load(mesh.nodes.size());
  for (int i = 0; i < 40; ++i) carpet.step(1e-7, load);
  // 20 columns of two: ten are slow by their material, one of them is next to the fast ones.
  EXPECT_EQ(carpet.element_steps(), 40U * 22 + 10U * 18);
}

TEST_F(Subcycling, OfMaterialsWhoseStepsAreLessThanTwiceApartIsTheSameToTheBitAsNone) {
  const ShellMesh mesh = two_part_strip(true, false);
  const std::vector<ShellMaterial> materials = materials_of_ratio(mesh, 0, 1.9);
  Carpet with(mesh, materials, subcycled()), without(mesh, materials, no_gravity());
  EXPECT_EQ(with.subcycle(), 1);
  shake(with, 0.1);
  shake(without, 0.1);
  const Vec3Array load = no_load(mesh.nodes.size());
  const double dt = 0.8 * with.stable_step();
  for (int i = 0; i < 200; ++i) {
    with.step(dt, load);
    without.step(dt, load);
  }
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) EXPECT_EQ(with.nodes().z[n], without.nodes().z[n]);
  EXPECT_EQ(with.element_steps(), without.element_steps());
}

/// Largest energy over the first, at evaluations of the slow elements, in the first and the second half.
std::array<double, 2> largest_energies(Carpet& carpet, double dt, int steps) {
  const double start = carpet.energy().kinetic;
  const Vec3Array load = no_load(carpet.nodes().x.size());
  std::array<double, 2> largest{};
  for (int i = 0; i < steps; ++i) {
    carpet.step(dt, load);
    if ((i + 1) % carpet.subcycle() != 0) continue;
    const CarpetEnergy e = carpet.energy();
    double& half = largest[i < steps / 2 ? 0 : 1];
    half = std::max(half, (e.kinetic + e.strain + e.hourglass) / start);
  }
  return largest;
}

TEST_F(Subcycling, DoesNotGrowAtNineTenthsOfTheFastStepWhateverTheRatio) {
  for (const int kind : {0, 1, 2, 3}) {
    const ShellMesh mesh = kind < 2 ? small_turf(0.03) : two_part_strip(true, kind == 2);
    for (double ratio = 2.9; ratio < 12; ratio *= kind < 2 ? 1.4 : 1.09) {
      const std::vector<ShellMaterial> materials = materials_of_ratio(mesh, kind % 2 == 0 ? 1 : 0, ratio);
      for (const double safety : {0.8, 0.9}) {
        Carpet carpet(mesh, materials, subcycled());
        EXPECT_GT(carpet.subcycle(), 1);
        shake(carpet, 0.01);
        const auto [early, late] =
            largest_energies(carpet, safety * carpet.stable_step(), kind < 2 ? 3000 : 20000);
        EXPECT_LT(late, 1.05 * early) << "kind " << kind << ", ratio " << ratio << ", safety " << safety;
        EXPECT_LT(early, 3) << "kind " << kind << ", ratio " << ratio << ", safety " << safety;
      }
    }
  }
}

/// A strip whose nodes fly apart fails in its slow part as in its fast one; its books stay closed.
TEST_F(Subcycling, KeepsMomentumAndTheBooksWhileShellsOfBothGroupsFail) {
  const ShellMesh mesh = two_part_strip(false, false);
  std::vector<ShellMaterial> materials = materials_of_ratio(mesh, 0, 5.2);
  for (ShellMaterial& material : materials) material.failure_strain = 0.05;
  Carpet carpet(mesh, materials, subcycled());
  ASSERT_EQ(carpet.subcycle(), 4);
  constexpr double rate = 4000;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    carpet.set_velocity(n, rate * Vec3(carpet.nodes().x[n] - 0.03, 0, 0), Vec3(0, 0, 0));
  const Vec3 before = momentum(carpet);
  const double start = carpet.energy().balance(), dt = 0.5 * carpet.stable_step();
  const Vec3Array load = no_load(mesh.nodes.size());
  double largest = 0;
  for (int i = 0; i < 4000; ++i) {
    carpet.step(dt, load);
    if ((i + 1) % 4 == 0) largest = std::max(largest, std::abs(carpet.energy().balance() - start) / start);
  }
  std::array<std::size_t, 2> failed{};
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    failed[static_cast<std::size_t>(mesh.material[e])] += carpet.eroded()[e];
  EXPECT_GT(failed[0], 1u);
  EXPECT_GT(failed[1], 1u);
  EXPECT_LT(largest, 4e-3);
  const double scale = 1.6e-4 * 0.03 * rate;  // kg of the strip, m/s of its ends
  EXPECT_LT((momentum(carpet) - before).norm(), 1e-12 * scale);
}

TEST_F(Subcycling, KeepsMomentumToRoundingUnderChangingStepsAndWindows) {
  const ShellMesh mesh = two_part_strip(false, false);
  Carpet carpet(mesh, materials_of_ratio(mesh, 0, 5), subcycled());
  shake(carpet, 0.1);
  const auto momentum = [&] {
    const NodeView v = carpet.nodes();
    Vec3 sum(0, 0, 0);
    for (std::size_t n = 0; n < v.x.size(); ++n) sum += v.mass[n] * Vec3(v.vx[n], v.vy[n], v.vz[n]);
    return sum;
  };
  const Vec3 before = momentum();
  double scale = 0;
  for (const double m : carpet.nodes().mass) scale += 0.1 * m;
  const double dt = carpet.stable_step();
  const Vec3Array load = no_load(mesh.nodes.size());
  const int longest = carpet.subcycle();
  for (int window = 0, i = 0; window < 1500; ++window) {
    if (window % 20 == 0) carpet.set_subcycle(1 + window / 20 % longest);
    for (int k = 0; k < carpet.subcycle(); ++k) carpet.step((0.5 + 0.1 * std::sin(0.01 * ++i)) * dt, load);
  }
  EXPECT_LT((momentum() - before).norm(), 1e-11 * scale);
}

TEST_F(Subcycling, KeepsTheEnergyOfAWhippedCarpetWithinHalfAPercentOverHundredThousandSteps) {
  const ShellMesh mesh = two_part_strip(true, false);
  for (const int m : {2, 3, 4, 6, 8})
    for (const std::size_t slow : {std::size_t{0}, std::size_t{1}}) {
      Carpet carpet(mesh, materials_of_ratio(mesh, slow, 12), subcycled());
      carpet.set_subcycle(m);
      whip(carpet, 0.5);
      const double start = total(carpet.energy()), dt = 0.8 * carpet.stable_step();
      const Vec3Array load = no_load(mesh.nodes.size());
      double largest = 0;
      for (int i = 1; i <= 100000; ++i) {
        carpet.step(dt, load);
        if (i % (10 * m) == 0) largest = std::max(largest, std::abs(total(carpet.energy()) / start - 1));
      }
      RecordProperty("slow_" + std::to_string(slow) + "_m_" + std::to_string(m), std::to_string(largest));
      EXPECT_LT(largest, m < 6 ? 2e-3 : 5e-3) << "material " << slow << " every " << m;
    }
}

TEST_F(Subcycling, HasAnEnergyErrorOfSecondOrderInTheStep) {
  const ShellMesh mesh = small_turf(0.03);
  const std::vector<ShellMaterial> materials = materials_of_ratio(mesh, 1, 6);
  const auto error = [&](double safety) {
    Carpet carpet(mesh, materials, subcycled());
    whip(carpet, 0.2);
    const double start = total(carpet.energy()), dt = safety * carpet.stable_step();
    const Vec3Array load = no_load(mesh.nodes.size());
    const int windows = static_cast<int>(4e-4 / dt) / carpet.subcycle();
    double largest = 0;
    for (int w = 0; w < windows; ++w) {
      for (int k = 0; k < carpet.subcycle(); ++k) carpet.step(dt, load);
      largest = std::max(largest, std::abs(total(carpet.energy()) / start - 1));
    }
    return largest;
  };
  const double whole = error(0.8), half = error(0.4);
  RecordProperty("whole", std::to_string(whole));
  RecordProperty("half", std::to_string(half));
  EXPECT_LT(half, 0.4 * whole);
}

/// Tip of a strip that swings: where it is at a time, with the fast part's step.
Vec3 tip_after(const std::vector<ShellMaterial>& materials, const CarpetOptions& options, double safety,
               double time) {
  const ShellMesh mesh = two_part_strip(true, false);
  Carpet carpet(mesh, materials, options);
  whip(carpet, 0.5);
  const int m = carpet.subcycle();
  const int steps = m * static_cast<int>(std::ceil(time / (safety * carpet.stable_step() * m)));
  const Vec3Array load = no_load(mesh.nodes.size());
  for (int i = 0; i < steps; ++i) carpet.step(time / steps, load);
  return position(carpet, static_cast<Index>(mesh.nodes.size()) - 1);
}

TEST_F(Subcycling, MovesACarpetAsSteppingAllOfItDoesElasticOrRelaxing) {
  const ShellMesh mesh = two_part_strip(true, false);
  std::vector<ShellMaterial> materials = materials_of_ratio(mesh, 0, 6);
  for (const bool relaxing : {false, true}) {
    const double shear = materials[0].young_modulus / (2 * 1.3);
    if (relaxing) materials[0].relaxation = {{0.5 * shear, 300}, {0.3 * shear, 5}};
    const Vec3 all = tip_after(materials, no_gravity(), 0.2, 4e-3),
               some = tip_after(materials, subcycled(), 0.8, 4e-3);
    const double moved = (all - Vec3(0.06, 0.006, 0)).norm();
    EXPECT_GT(moved, 1e-4);
    EXPECT_LT((some - all).norm(), 0.01 * moved) << (relaxing ? "relaxing" : "elastic");
  }
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

void expect_same_state(const Carpet& a, const Carpet& b) {
  const NodeView u = a.nodes(), v = b.nodes();
  EXPECT_TRUE(same_bits(u.x, v.x) && same_bits(u.y, v.y) && same_bits(u.z, v.z));
  EXPECT_TRUE(same_bits(u.vx, v.vx) && same_bits(u.vy, v.vy) && same_bits(u.vz, v.vz));
  EXPECT_TRUE(a.energy() == b.energy());
  EXPECT_EQ(a.element_steps(), b.element_steps());
}

TEST_F(Subcycling, GoesOnBitForBitFromACheckpointWithinAWindowAndOnTwoThreads) {
  const ShellMesh mesh = small_turf(0.03);
  const std::vector<ShellMaterial> materials = materials_of_ratio(mesh, 1, 5);
  Carpet whole(mesh, materials, subcycled()), first(mesh, materials, subcycled());
  ASSERT_GT(whole.subcycle(), 2);
  const double dt = 0.8 * whole.stable_step();
  const Vec3Array load = no_load(mesh.nodes.size());
  const auto run = [&](Carpet& carpet, int steps) {
    for (int i = 0; i < steps; ++i) carpet.step(dt, load);
  };
  shake(whole, 0.1);
  shake(first, 0.1);
  run(whole, 83);
  run(first, 41);  // a window of 3 or more is open
  EXPECT_THROW(first.set_subcycle(2), std::logic_error);
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "tuft_fe_carpet_subcycling.h5";
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("carpet");
    first.save(group);
    file.commit();
  }
  Carpet second(mesh, materials, subcycled());
  second.load(h5::File::open(path).root().open_group("carpet"));
  set_threads(2);
  run(second, 42);
  expect_same_state(whole, second);
  std::filesystem::remove(path);
}

TEST_F(Subcycling, NamesASlowElementThatTurnsInsideOut) {
  const ShellMesh mesh = two_part_strip(true, false);
  Carpet carpet(mesh, materials_of_ratio(mesh, 0, 5), subcycled());
  ASSERT_GT(carpet.subcycle(), 2);
  // The sixth column of nodes, in the slow half, is thrown through the fifth: elements 8 and 9 lie between.
  for (const std::size_t n : {std::size_t{15}, std::size_t{16}, std::size_t{17}})
    carpet.set_velocity(n, Vec3(-300, 0, 0), Vec3(0, 0, 0));
  const Vec3Array load = no_load(mesh.nodes.size());
  const double dt = 0.3 * carpet.stable_step();
  try {
    for (int i = 0; i < 50; ++i) carpet.step(dt, load);
    ADD_FAILURE() << "not noticed";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(),
                testing::AnyOf(testing::HasSubstr("element 8 "), testing::HasSubstr("element 9 ")));
    EXPECT_THAT(std::string(error.what()), testing::HasSubstr("inside out"));
  }
}

/// A slow shell that folds over as it fails is gone; the buffer of shells about the slow ones, whose other
/// corners the window of the slow ones does not follow, is not to be blamed however fast all of it moves.
TEST_F(Subcycling, AccusesNoShellWhenASlowOneFailsInsideOut) {
  for (const double lift : {0.0, 0.001, 0.002, 0.003, 0.005}) {
    Strip strip = make_strip({0.03, 0.03, 0.0005, 10, 10}, false);
    for (std::size_t e = 0; e < 100; ++e) strip.mesh.material[e] = e / 10 >= 6 && e % 10 >= 6 ? 1 : 0;
    std::vector<ShellMaterial> materials{{2e6, 0.3, 900}, {0.2e9, 0.3, 900}};
    for (ShellMaterial& m : materials) m.failure_strain = 0.02;
    Carpet carpet(strip.mesh, materials, subcycled());
    ASSERT_GT(carpet.subcycle(), 2);
    const Vec3 drift(40, -40, 0);
    for (std::size_t n = 0; n < strip.node_count(); ++n) carpet.set_velocity(n, drift, Vec3(0, 0, 0));
    const Vec3Array load = no_load(strip.node_count());
    const double dt = 0.4 * carpet.stable_step(), window = carpet.subcycle() * dt;
    for (int i = 0; i < 50 * carpet.subcycle(); ++i) carpet.step(dt, load);
    // The corner crosses its shell within one window.
    carpet.set_velocity(0, drift + Vec3(0.006, lift - 0.003, 0.001) / window, Vec3(0, 0, 0));
    EXPECT_NO_THROW({
      for (int i = 0; i < carpet.subcycle(); ++i) carpet.step(dt, load);
    });
    EXPECT_EQ(carpet.eroded_count(), 1U);
  }
}

TEST(SubcycleRatio, IsNeverBelowOne) {
  fe::Subcycling s;
  s.slow = {0, 1};
  const auto ratio = [&s](double fast, double slow) { return subcycle_ratio(s, std::array{fast, slow}); };
  EXPECT_EQ(ratio(1, 1.2), 1);
  EXPECT_EQ(ratio(1, 0.5), 1);
  EXPECT_EQ(ratio(1, 2.5), 2);
  EXPECT_EQ(ratio(1, 1e9), 32);
  EXPECT_EQ(ratio(1, std::numeric_limits<double>::infinity()), 32);
}

}  // namespace
}  // namespace tuft::fe::test
