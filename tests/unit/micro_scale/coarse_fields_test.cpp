/// Coarse-grained fields against what is known exactly.
#include "micro_scale/coarse_fields.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/micro_scale/particle_sample.h"

namespace tuft::micro {
namespace {

using test::Sample;

constexpr double size = 0.04;  // m, of the cube about the origin that most grids fill

CoarseGrid cube(double cell) {
  return make_grid(Vec3::Constant(-0.5 * size), Vec3::Constant(0.5 * size), cell);
}

CoarseFields fields_of(const Sample& sample, const CoarseGrid& grid, double width) {
  return coarse_grain(grid, lucy_kernel(width), sample.view(), {}, sample.network);
}

template <class Value>
Value integral(const std::vector<Value>& field, const CoarseGrid& grid) {
  Value sum = grid.cell_volume() * field[0];
  for (std::size_t c = 1; c < field.size(); ++c) sum += grid.cell_volume() * field[c];
  return sum;
}

double largest(const std::vector<Mat3>& field) {
  double value = 0;
  for (const Mat3& m : field) value = std::max(value, m.norm());
  return value;
}

TEST(LucyKernel, HasTheIntegralOneAndEndsAtItsCutoff) {
  const Kernel kernel = lucy_kernel(0.003);
  EXPECT_EQ(kernel.cutoff, 0.006);
  EXPECT_EQ(kernel(0.006), 0);
  double sum = 0;
  constexpr int steps = 2000;
  for (int n = 0; n < steps; ++n) {
    const double r = (n + 0.5) * kernel.cutoff / steps;
    sum += 4 * std::numbers::pi * r * r * kernel(r) * kernel.cutoff / steps;
  }
  EXPECT_NEAR(sum, 1, 1e-6);
}

TEST(CoarseFields, OnAFineGridAreThoseOfTheContinuousKernel) {
  Sample sample;
  sample.add(Vec3(0.0003, -0.0002, 0.0004), Vec3::Zero(), 2e-6);
  const CoarseGrid grid = cube(0.001);
  const Kernel kernel = lucy_kernel(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.004);
  const double at_centre = 2e-6 * kernel((grid.centre(22, 20, 21) - sample.position[0]).norm());
  EXPECT_NEAR(fields.density[grid.index(22, 20, 21)], at_centre, 1e-3 * at_centre);
}

TEST(CoarseFields, KeepMassAndMomentumToRounding) {
  const Sample sample = test::cloud(300, 0.5 * size);  // up to the rim
  const CoarseGrid grid = cube(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.005);
  EXPECT_EQ(fields.outside, 0u);
  double mass = 0;
  Vec3 momentum(0, 0, 0);
  for (std::size_t i = 0; i < 300; ++i) {
    mass += sample.mass[i];
    momentum += sample.mass[i] * sample.velocity[i];
  }
  EXPECT_NEAR(integral(fields.density, grid), mass, 1e-14 * mass);
  Vec3 sum(0, 0, 0);
  for (std::size_t c = 0; c < grid.size(); ++c)
    sum += grid.cell_volume() * fields.density[c] * fields.velocity[c];
  EXPECT_LT((sum - momentum).norm(), 1e-14 * mass);  // speeds are about 1 m/s
}

TEST(CoarseFields, OfTwoGrainsInContactHoldTheStressForceTimesBranch) {
  const CoarseGrid grid = cube(0.004);
  for (const Vec3& middle :
       {Vec3(0.0011, 0.0003, -0.0007), Vec3(0.0195, 0.0195, 0.0193)}) {  // and in a corner
    Sample sample;
    const Vec3 l(0.0008, -0.0005, 0.0004);  // from the second centre to the first
    sample.add(middle + 0.5 * l, Vec3::Zero(), 1e-6);
    sample.add(middle - 0.5 * l, Vec3::Zero(), 1e-6);
    const Vec3 force(0.3, -0.1, 0.2);  // repulsion and some friction
    sample.touch(0, 1, force);
    const Mat3 total = integral(fields_of(sample, grid, 0.004).stress, grid),
               expected = -force * l.transpose();
    EXPECT_LT((total - expected).norm(), 1e-14 * expected.norm());
    EXPECT_LT(total.trace(), 0) << "compression is negative";
  }
}

TEST(CoarseFields, OfALatticeUnderUniaxialLoadHoldTheAppliedStress) {
  constexpr int side = 16;
  constexpr double pitch = 0.002, load = 0.05;
  const Sample sample = test::cubic_lattice(side, pitch, Vec3(0, 0, load));
  // One cell a particle: inside, the shares of all particles in one cell add up to 1 as those of one in all.
  const CoarseGrid grid = make_grid(Vec3::Zero(), Vec3::Constant(side * pitch), pitch);
  const CoarseFields fields = fields_of(sample, grid, pitch);
  const double applied = load / (pitch * pitch);
  for (int k = 4; k < 12; ++k) {
    const Mat3 stress = fields.stress[grid.index(8, 7, k)];
    EXPECT_NEAR(stress(2, 2), -applied, 1e-12 * applied);
    EXPECT_LT((stress - Vec3(0, 0, stress(2, 2)).asDiagonal().toDenseMatrix()).norm(), 1e-12 * applied);
    EXPECT_NEAR(fields.density[grid.index(8, 7, k)], 1e-6 / (pitch * pitch * pitch), 1e-8);
  }
}

TEST(CoarseFields, OfUniformFlowHoldItsVelocityAndNoKineticStress) {
  Sample sample = test::cloud(300, 0.5 * size);
  const Vec3 flow(3, -2, 5);
  for (std::size_t i = 0; i < 300; ++i) sample.velocity.set(i, flow);
  const CoarseGrid grid = cube(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.004);
  double density = 0;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    density = std::max(density, fields.density[c]);
    if (fields.density[c] > 0) {
      EXPECT_LT((fields.velocity[c] - flow).norm(), 1e-14 * flow.norm());
    }
  }
  EXPECT_LT(largest(fields.kinetic_stress), 1e-27 * density * flow.squaredNorm());
}

TEST(CoarseFields, OfTwoBeamsThroughOnePlaceHoldTheKineticStressOfBoth) {
  Sample sample;
  const Vec3 u(0.3, 0.4, -0.2);
  sample.add(Vec3::Zero(), u, 1e-6);
  sample.add(Vec3::Zero(), -u, 1e-6);
  const CoarseGrid grid = cube(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.004);
  const Mat3 expected = -2e-6 * u * u.transpose();
  EXPECT_LT((integral(fields.kinetic_stress, grid) - expected).norm(), 1e-14 * expected.norm());
}

TEST(CoarseFields, DoNotDependOnTheObserversVelocity) {
  const Sample sample = test::cloud(300, 0.5 * size);
  Sample moving = sample;
  const Vec3 boost(7, -3, 4);
  for (std::size_t i = 0; i < 300; ++i) moving.velocity.add(i, boost);
  const CoarseGrid grid = cube(0.004);
  const CoarseFields a = fields_of(sample, grid, 0.004), b = fields_of(moving, grid, 0.004);
  const double scale = largest(a.kinetic_stress);
  ASSERT_GT(scale, 0);
  for (std::size_t c = 0; c < grid.size(); ++c) {
    EXPECT_LT((a.kinetic_stress[c] - b.kinetic_stress[c]).norm(), 1e-12 * scale);
    EXPECT_EQ(a.stress[c], b.stress[c]);
  }
}

TEST(CoarseFields, TurnWithTheFrame) {
  const Sample sample = test::cloud(200, 0.45 * size);
  const CoarseGrid grid = cube(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.005);
  Mat3 quarter;  // x to y, y to z, z to x: the grid turns into itself
  quarter << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  const CoarseFields turned = fields_of(sample.turned(quarter), grid, 0.005);
  const double scale = largest(fields.stress);
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 10; ++i) {
        const std::size_t here = grid.index(i, j, k), there = grid.index(k, i, j);
        EXPECT_LT((turned.stress[there] - quarter * fields.stress[here] * quarter.transpose()).norm(),
                  1e-12 * scale);
        EXPECT_LT((turned.velocity[there] - quarter * fields.velocity[here]).norm(), 1e-12);
      }
  // Any other turn: the whole stress turns.
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const CoarseGrid wide = make_grid(Vec3::Constant(-size), Vec3::Constant(size), 0.004);
  const Mat3 before = integral(fields_of(sample, wide, 0.005).stress, wide),
             after = integral(fields_of(sample.turned(turn), wide, 0.005).stress, wide);
  EXPECT_LT((after - turn * before * turn.transpose()).norm(), 1e-12 * before.norm());
}

/// Grains on each other under gravity, the lowest on a floor: 0 = div(stress) + boundary force + rho g.
double imbalance_of_column(double cell) {
  constexpr double pitch = 0.0019, mass = 4e-6, g = 9.81;
  constexpr int grains = 12;
  Sample sample;
  for (int n = 0; n < grains; ++n) sample.add(Vec3(0, 0, -0.012 + pitch * n), Vec3::Zero(), mass);
  for (int n = 0; n + 1 < grains; ++n) sample.touch(n, n + 1, Vec3(0, 0, -mass * g * (grains - 1 - n)));
  sample.lean(0, Vec3(0, 0, -0.00095), Vec3(0, 0, mass * g * grains));
  const CoarseGrid grid = cube(cell);
  const CoarseFields fields = fields_of(sample, grid, 0.003);
  double worst = 0, scale = 0;
  for (int k = 1; k + 1 < grid.cells[2]; ++k) {  // over the whole cross-section
    double change = 0, given = 0, weight = 0;
    for (int j = 0; j < grid.cells[1]; ++j)
      for (int i = 0; i < grid.cells[0]; ++i) {
        change += fields.stress[grid.index(i, j, k + 1)](2, 2) - fields.stress[grid.index(i, j, k - 1)](2, 2);
        given += fields.boundary_force[grid.index(i, j, k)].z();
        weight += g * fields.density[grid.index(i, j, k)];
      }
    worst = std::max(worst, std::abs(change / (2 * grid.spacing.z()) + given - weight));
    scale = std::max(scale, given);
  }
  return worst / scale;
}

TEST(CoarseFields, OfAColumnAtRestAreInBalanceWithItsWeightAndItsFloor) {
  const double coarse = imbalance_of_column(0.001), fine = imbalance_of_column(0.0005);
  EXPECT_LT(coarse, 0.05);
  EXPECT_LT(fine, 0.3 * coarse) << "what is left is the error of central differences";
}

TEST(CoarseFields, LeaveOutWhatIsBeyondTheGridAndSaySo) {
  Sample sample;
  sample.add(Vec3::Zero(), Vec3::Zero(), 1e-6);
  sample.add(Vec3(0, 0, 0.0201), Vec3::Zero(), 3e-6);
  sample.touch(0, 1, Vec3(0, 0, -1));
  const CoarseGrid grid = cube(0.004);
  const CoarseFields fields = fields_of(sample, grid, 0.004);
  EXPECT_EQ(fields.outside, 1u);
  EXPECT_EQ(fields.outside_mass, 3e-6);
  EXPECT_NEAR(integral(fields.density, grid), 1e-6, 1e-20);
  EXPECT_EQ(largest(fields.stress), 0);
}

TEST(CoarseFields, CountWhatIsBeyondTheRimByLessThanTheMarginAsOnIt) {
  Sample beyond, on;
  beyond.add(Vec3(0, 0, 0.0201), Vec3(0.1, 0, 0), 3e-6);
  on.add(Vec3(0, 0, 0.02), Vec3(0.1, 0, 0), 3e-6);
  CoarseGrid grid = cube(0.004);
  ASSERT_EQ(grid.high().z(), 0.02);
  grid.margin = 0.00011;
  const CoarseFields fields = fields_of(beyond, grid, 0.004), at_rim = fields_of(on, grid, 0.004);
  EXPECT_EQ(fields.outside, 0u);
  EXPECT_NEAR(integral(fields.density, grid), 3e-6, 1e-20);
  EXPECT_EQ(fields.density, at_rim.density);
  grid.margin = 0.00009;
  EXPECT_EQ(fields_of(beyond, grid, 0.004).outside, 1u);
}

TEST(CoarseFields, TakeStressFromParticlesWhereTheyHaveIt) {
  Sample sample;
  sample.add(Vec3(0.001, 0.002, -0.003), Vec3::Zero(), 1e-6);
  sample.lean(0, Vec3(0, 0, -0.001), Vec3(0, 0, 2));
  const CoarseGrid grid = cube(0.004);
  const std::vector<std::array<double, 6>> moment{{1, 2, 3, 4, 5, 6}};
  const std::vector<double> solid{4e-9}, contacts{5};
  const CoarseFields fields =
      coarse_grain(grid, lucy_kernel(0.004), sample.view(), {solid, contacts, moment}, sample.network);
  Mat3 expected;
  expected << 1, 4, 6, 4, 2, 5, 6, 5, 3;
  EXPECT_LT((integral(fields.stress, grid) - expected).norm(), 1e-13);
  EXPECT_NEAR(integral(fields.boundary_force, grid).z(), 2, 1e-13);
  double filled = 0;
  for (std::size_t c = 0; c < grid.size(); ++c) {
    filled += (1 - fields.porosity[c]) * grid.cell_volume();
    if (fields.density[c] > 0) {
      EXPECT_NEAR(fields.coordination[c], 5, 1e-12);
    }
  }
  EXPECT_NEAR(filled, 4e-9, 1e-17);
}

}  // namespace
}  // namespace tuft::micro
