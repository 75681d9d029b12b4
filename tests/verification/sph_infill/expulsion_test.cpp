/// Particles that leave the turf take no part in it any more, and the books still balance.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <memory>

#include "core/parallel.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;
constexpr int width = 8, rows = 6;

/// A block of which the upper two rows are torn off and thrown up, most of them out of the box.
struct ThrownBlock {
  SphInfill infill;

  ThrownBlock(double gravity, double ceiling, bool in_tray = false)
      : infill(test::block(width, width, rows, pitch), test::single_material(test::mixture_material()),
               settings(gravity, ceiling)),
        in_tray_(in_tray) {
    const ParticleView p = infill.particles();
    for (std::size_t i = 0; i < p.size(); ++i)
      if (is_thrown(p, i)) infill.set_velocity(i, {0.3, 0.1, 8 + 300 * p.x[i]});
  }
  [[nodiscard]] static bool is_thrown(const ParticleView& p, std::size_t i) {
    return p.z[i] > (rows - 2) * pitch;
  }
  void run(int windows) {
    const test::Tray tray(width * pitch, width * pitch, 10 * 4e6 * pitch, 0.1);
    ContactImpulses contact;
    for (int k = 0; k < windows; ++k) {
      const double window = 0.4 * infill.stable_step();
      if (in_tray_) tray.push(infill.particles(), window, contact);
      infill.advance(window, 1, contact);
      largest_imbalance = std::max(largest_imbalance, std::abs(balance() - start()));
    }
  }
  [[nodiscard]] double balance() const {
    const InfillEnergy e = infill.energy();
    return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled -
           e.contact_work;
  }
  double largest_imbalance = 0;  ///< J, after the first window

 private:
  double start() {
    if (!started_) start_ = balance(), started_ = true;
    return start_;
  }
  static SphSettings settings(double gravity, double ceiling) {
    SphSettings settings;
    settings.options = test::options_of(test::Preset::accurate, pitch);
    settings.gravity = {0, 0, -gravity};
    settings.zero_energy_control = true;
    settings.box.high.z() = ceiling;
    return settings;
  }
  bool in_tray_, started_ = false;
  double start_ = 0;
};

constexpr double ceiling = 12 * pitch;
constexpr int windows = 300;

Vec3 momentum_of(const Infill& infill) {
  const ParticleView p = infill.particles();
  Vec3 sum = infill.expelled().momentum;
  for (std::size_t i = 0; i < p.size(); ++i) sum += p.mass[i] * p.velocity(i);
  return sum;
}

TEST(Expulsion, CountsMassAndMomentumOfWhatLeft) {
  ThrownBlock thrown(0, ceiling);
  const Vec3 before = momentum_of(thrown.infill);
  thrown.run(windows);
  const Expelled left = thrown.infill.expelled();
  const ParticleView p = thrown.infill.particles();
  std::uint64_t beyond = 0;
  double mass = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_EQ(p.is_expelled(i), p.z[i] > ceiling) << i;
    if (!p.is_expelled(i)) continue;
    ++beyond, mass += p.mass[i];
    EXPECT_EQ(p.velocity(i), Vec3(0, 0, 0));
  }
  EXPECT_GT(left.particles, width * width / 2);
  EXPECT_LT(left.particles, p.size());
  EXPECT_EQ(left.particles, beyond);
  EXPECT_NEAR(left.mass / mass, 1, 1e-12);
  EXPECT_LT((momentum_of(thrown.infill) - before).norm(), 1e-9 * before.norm());
}

/// Particles in free flight, too far apart to feel each other, some of which leave.
TEST(Expulsion, OfWhatFliesAloneKeepsTheEnergyToRounding) {
  Lattice lattice = test::block(3, 3, 3, 10 * pitch);
  SphSettings settings;
  settings.options = test::options_of(test::Preset::accurate, pitch);
  settings.box.high = {12 * pitch, 1, 40 * pitch};
  SphInfill infill(lattice, test::single_material(test::mixture_material()), settings);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    infill.set_velocity(i, {1 + 0.1 * static_cast<double>(i % 7), 0, 5 - 0.3 * static_cast<double>(i % 5)});
  const auto balance = [&] {
    const InfillEnergy e = infill.energy();
    return e.kinetic + e.gravity_potential + e.expelled;
  };
  for (int k = 0; k < 2; ++k) infill.advance(1e-5, 1, {});  // the first kick is half a step
  const double start = balance();
  for (int k = 0; k < 1000; ++k) {
    infill.advance(1e-5, 1, {});
    ASSERT_NEAR(balance() / start, 1, 1e-12) << k;
  }
  EXPECT_GT(infill.expelled().particles, 5);
  EXPECT_LT(infill.expelled().particles, lattice.position.size());
  EXPECT_NEAR(infill.energy().expelled / infill.expelled().kinetic_energy, 1, 1e-12);
}

/// Torn off and let go by layers: what their neighbours lose with them is not in the books.
TEST(Expulsion, OfATornBlockKeepsTheEnergyAsWellAsIfNoneLeft) {
  ThrownBlock thrown(9.81, ceiling), kept(9.81, 1e9);
  thrown.run(windows);
  kept.run(windows);
  const double left = thrown.infill.energy().expelled;
  EXPECT_EQ(kept.infill.energy().expelled, 0);
  ASSERT_GT(left, 1e-3);
  RecordProperty("thrown", testing::PrintToString(thrown.largest_imbalance / left));
  RecordProperty("kept", testing::PrintToString(kept.largest_imbalance / left));
  EXPECT_LT(thrown.largest_imbalance, kept.largest_imbalance + 1e-3 * left);
}

TEST(Expulsion, OfWhatIsFarAwayChangesNoBitOfWhatStays) {
  const auto bed_and_flyer = [](double height) {
    Lattice lattice = test::block(width, width, rows, pitch);
    const std::size_t bed = lattice.position.size();
    lattice.position.push_back({0, 0, 20 * pitch});
    lattice.volume.push_back(lattice.volume[0]);
    lattice.layer.push_back(0), lattice.material.push_back(0);
    if (!lattice.radius.empty()) lattice.radius.push_back(lattice.radius[0]);
    if (!lattice.half_height.empty()) lattice.half_height.push_back(lattice.half_height[0]);
    SphSettings settings;
    settings.options = test::options_of(test::Preset::accurate, pitch);
    settings.box.high.z() = height;
    auto infill =
        std::make_unique<SphInfill>(lattice, test::single_material(test::mixture_material()), settings);
    infill->set_velocity(bed, {0, 0, 20});
    const test::Tray tray(width * pitch, width * pitch, 10 * 4e6 * pitch, 0.1);
    ContactImpulses contact;
    for (int k = 0; k < 200; ++k) {
      const double window = 0.4 * infill->stable_step();
      tray.push(infill->particles(), window, contact);
      contact.linear.set(bed, Vec3::Zero());
      infill->advance(window, 1, contact);
    }
    return infill;
  };
  const auto leaves = bed_and_flyer(22 * pitch), stays = bed_and_flyer(1e9);
  ASSERT_EQ(leaves->expelled().particles, 1);
  ASSERT_EQ(stays->expelled().particles, 0);
  const ParticleView a = leaves->particles(), b = stays->particles();
  for (std::size_t i = 0; i + 1 < a.size(); ++i) {
    ASSERT_EQ(a.position(i), b.position(i)) << i;
    ASSERT_EQ(a.velocity(i), b.velocity(i)) << i;
  }
}

void expect_same(const SphInfill& a, const SphInfill& b) {
  const ParticleView p = a.particles(), q = b.particles();
  for (std::size_t i = 0; i < p.size(); ++i) {
    ASSERT_EQ(p.position(i), q.position(i)) << i;
    ASSERT_EQ(p.velocity(i), q.velocity(i)) << i;
    ASSERT_EQ(p.is_expelled(i), q.is_expelled(i)) << i;
  }
  const Expelled e = a.expelled(), f = b.expelled();
  EXPECT_GT(e.particles, 0);
  EXPECT_EQ(e.particles, f.particles);
  EXPECT_EQ(e.mass, f.mass);
  EXPECT_EQ(e.momentum, f.momentum);
  EXPECT_EQ(e.kinetic_energy, f.kinetic_energy);
  EXPECT_EQ(a.energy().expelled, b.energy().expelled);
}

TEST(Expulsion, IsTheSameForOneAndTwoThreads) {
  const int threads = omp_get_max_threads();
  ThrownBlock one(9.81, ceiling, true), two(9.81, ceiling, true);
  set_threads(1);
  one.run(windows);
  set_threads(2);
  two.run(windows);
  set_threads(threads);
  expect_same(one.infill, two.infill);
}

TEST(Expulsion, OutlivesACheckpoint) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("tuft_expulsion_{}.h5", getpid());
  ThrownBlock whole(9.81, ceiling, true), resumed(9.81, ceiling, true);
  whole.run(windows / 2);
  ASSERT_GT(whole.infill.expelled().particles, 0);
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group root = file.root();
    whole.infill.save(root);
    file.commit();
  }
  resumed.infill.load(h5::File::open(path).root());
  std::filesystem::remove(path);
  whole.run(windows / 2);
  resumed.run(windows / 2);
  expect_same(whole.infill, resumed.infill);
}

}  // namespace
}  // namespace tuft::sph
