// Specimens' lattices: exact volumes, rows on the walls, and weights for which a uniform stress is in
// balance.
#include "sph_infill/specimen_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"

namespace tuft::sph {
namespace {

SphOptions options(double pitch, double over_pitch, Kernel kernel) {
  SphOptions o;
  o.pitch = pitch;
  o.smoothing_length = over_pitch * pitch;
  o.kernel = kernel;
  return o;
}

double total(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(SpecimenLattice, OfARingHasTheCylindersVolumeAndStandsOnItsWalls) {
  const double radius = 0.02675, height = 0.0127;
  for (const double pitch : {0.0032, 0.0025, 0.0019}) {
    const Lattice ring = fill_ring({radius, height}, 3, options(pitch, 0.9, Kernel::cubic_spline));
    EXPECT_NEAR(total(ring.volume) / (std::numbers::pi * radius * radius * height), 1, 1e-13);
    double widest = 0, highest = 0, lowest = 1, narrowest = 1;
    for (std::size_t i = 0; i < ring.position.size(); ++i) {
      widest = std::max(widest, std::hypot(ring.position.x[i], ring.position.y[i]));
      highest = std::max(highest, ring.position.z[i]);
      lowest = std::min(lowest, ring.position.z[i]);
      narrowest = std::min(narrowest, ring.volume[i]);
      EXPECT_EQ(ring.material[i], 3);
    }
    EXPECT_NEAR(widest, radius, 1e-15);
    EXPECT_EQ(lowest, 0);
    EXPECT_NEAR(highest, height, 1e-15);
    EXPECT_GT(narrowest, 0.2 * *std::max_element(ring.volume.begin(), ring.volume.end()));
  }
}

TEST(SpecimenLattice, OfABoxHasItsVolumeAndNoRowOnThePlaneOfHalvedHeight) {
  for (const double pitch : {0.0039, 0.0033, 0.0049}) {
    const Lattice box = fill_box({{0.05, 0.04}, 0.0195}, 0, options(pitch, 0.9, Kernel::cubic_spline));
    EXPECT_NEAR(total(box.volume) / (0.05 * 0.04 * 0.0195), 1, 1e-13);
    double nearest = 1;
    for (std::size_t i = 0; i < box.position.size(); ++i)
      nearest = std::min(nearest, std::abs(box.position.z[i] - 0.00975));
    EXPECT_NEAR(nearest, box.radius.front(), 1e-12) << "half a spacing";
  }
}

/// Force on each row under a uniform unit stress, summed here pair by pair over a lattice of particles.
std::vector<double> forces(const std::vector<double>& weight, double spacing, double h) {
  const auto rows = static_cast<int>(weight.size());
  const auto slope = [h](double r) {  // dW/dr of Wendland C2
    const double q = r / h;
    return q < 2 ? 21 / (16 * std::numbers::pi * h * h * h) * -5 * q * std::pow(1 - q / 2, 3) / h : 0.0;
  };
  const auto pair = [&](int i, int j) {  // component along the rows of grad_i W_ij, summed over a row
    double sum = 0;
    const double z = (j - i) * spacing;
    for (int a = -4; a <= 4; ++a)
      for (int b = -4; b <= 4; ++b) {
        const double r = std::sqrt((a * a + b * b) * spacing * spacing + z * z);
        if (r > 0) sum -= slope(r) * z / r;
      }
    return sum;
  };
  std::vector<double> force(weight.size(), 0.0);
  for (int i = 0; i < rows; ++i) {
    double moment = 0;
    for (int j = 0; j < rows; ++j)
      moment += weight[static_cast<std::size_t>(j)] * pair(i, j) * (j - i) * spacing;
    for (int j = 0; j < rows; ++j) {
      const double f =
          weight[static_cast<std::size_t>(i)] * weight[static_cast<std::size_t>(j)] * pair(i, j) / moment;
      force[static_cast<std::size_t>(j)] += f;
      force[static_cast<std::size_t>(i)] -= f;
    }
  }
  return force;
}

TEST(RowWeights, LeaveEveryRowButThoseAtTheWallsInBalance) {
  const double spacing = 0.002;
  for (const double over_pitch : {0.9, 1.3})
    for (const int rows : {5, 6, 9, 14}) {
      const SphOptions o = options(spacing, over_pitch, Kernel::wendland_c2);
      const std::vector<double> weight = row_weights(rows, spacing, {spacing, spacing}, o);
      EXPECT_NEAR(total(weight), rows - 1, 1e-9);
      const std::vector<double> force = forces(weight, spacing, o.smoothing_length);
      for (std::size_t k = 1; k + 1 < force.size(); ++k)
        EXPECT_LT(std::abs(force[k] / force.back()), 1e-8) << rows << " rows, row " << k;
      // Even volumes are far from it.
      std::vector<double> even(weight.size(), 1.0);
      even.front() = even.back() = 0.5;
      EXPECT_GT(std::abs(forces(even, spacing, o.smoothing_length)[1] / force.back()), 0.2);
    }
}

TEST(SpecimenLattice, RefusesAPitchThatLeavesNoRowAwayFromTheWalls) {
  try {
    (void)fill_ring({0.02675, 0.0127}, 0, options(0.005, 0.9, Kernel::cubic_spline));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("make it 3.17 mm or less"), std::string::npos) << error.what();
  }
  EXPECT_THROW((void)fill_box({{0.05, 0.05}, 0.0195}, 0, options(0, 0.9, Kernel::cubic_spline)), InputError);
}

}  // namespace
}  // namespace tuft::sph
