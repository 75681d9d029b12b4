/// Loops over pairs work in single precision (sph_infill/particles.h): what they find is compared with the
/// definitions of sph_loops.h, evaluated pair by pair in double precision.
#include <gtest/gtest.h>

#include <vector>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/kernel.h"
#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002, density = 1000, bulk_modulus = 1e6;

/// A disordered block with random stresses and velocities of some metres a second.
struct RandomBlock {
  LoopSettings settings;
  Particles particles;
  NeighbourList list;

  RandomBlock(test::Preset preset, const Vec3& origin, const Vec3& drift = {0, 0, 0}) {
    Lattice lattice = test::block(8, 7, 6, pitch);
    test::jitter(lattice, 0.1);
    const std::size_t n = lattice.position.size();
    settings.options = test::options_of(preset, pitch);
    settings.laws = {make_soil_law(test::elastic_material(bulk_modulus, density))};
    Particles& p = particles;
    p.assign(n, settings.options.smoothing_length);
    p.volume = p.reference_volume = lattice.volume;
    std::mt19937_64 random(7);
    std::normal_distribution<double> any;
    p.bulk_modulus.assign(n, bulk_modulus);
    for (std::size_t i = 0; i < n; ++i) {
      p.position.set(i, origin + lattice.position[i]);
      p.mass[i] = density * lattice.volume[i];
      p.pressure[i] = 1e4 * any(random);
      for (auto& values : p.deviator) values[i] = 1e4 * any(random);
      p.deviator[2][i] = -p.deviator[0][i] - p.deviator[1][i];
      p.velocity.set(i, drift + Vec3(any(random), any(random), any(random)));
    }
    list = NeighbourList(p.position, 2 * settings.options.smoothing_length, 0);
    list.build(p.position);
    p.record_motion();
  }

  [[nodiscard]] double slope(double distance_squared) const {
    const double h = settings.options.smoothing_length;
    return settings.options.kernel == Kernel::cubic_spline
               ? CubicSpline(h).slope_over_distance(distance_squared)
               : WendlandC2(h).slope_over_distance(distance_squared);
  }

  struct Found {
    std::vector<Mat3> gradient;  ///< 1/s
    std::vector<Vec3> force;     ///< N
  };

  [[nodiscard]] Found by_definition() const {
    const Particles& p = particles;
    const SphOptions& o = settings.options;
    const double h = o.smoothing_length;
    const double c_squared = bulk_modulus * (1 + 4.0 / 3.0 * settings.laws[0].shear_ratio);
    std::vector<Mat3> stress_b;
    Found found;
    for (std::size_t i = 0; i < p.size(); ++i) {
      Mat3 moment = Mat3::Zero(), velocity = Mat3::Zero();
      for_row(i, [&](std::size_t j, const Vec3& d, const Vec3& g) {
        moment -= p.volume[j] * d * g.transpose();
        velocity += p.volume[j] * (p.velocity[j] - p.velocity[i]) * g.transpose();
      });
      const Mat3 b = to_matrix(correction_matrix(symmetric_part(moment)));
      const SoilState s = p.soil_state(i);
      found.gradient.emplace_back(velocity * b);
      stress_b.emplace_back((to_matrix(s.deviator) - s.pressure * Mat3::Identity()) * b);
    }
    for (std::size_t i = 0; i < p.size(); ++i) {
      Vec3 force(0, 0, 0);
      for_row(i, [&](std::size_t j, const Vec3& d, const Vec3& g) {
        const double v = p.volume[i] * p.volume[j];
        force += v * (stress_b[i] + stress_b[j]) * g;
        const double approach = (p.velocity[j] - p.velocity[i]).dot(d);
        const double mu = h * std::max(0.0, approach) / (d.squaredNorm() + 0.01 * h * h);
        const double rho = std::sqrt(p.mass[i] / p.volume[i] * p.mass[j] / p.volume[j]);
        const double c = std::sqrt(c_squared / rho);
        if (settings.artificial_viscosity)
          force -= v * rho * mu * (o.viscosity_linear * c + o.viscosity_quadratic * mu) * g;
      });
      found.force.push_back(force);
    }
    return found;
  }

  [[nodiscard]] Found by_loops() {
    Particles& p = particles;
    Found found;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const GradientSums sums = sum_gradients(settings, list, p, i);
      found.gradient.emplace_back(sums.velocity * to_matrix(correction_matrix(sums.moment)));
    }
    std::vector<StressSums> stress_blocks(block_count(p));
    std::vector<KickSums> kick_blocks(block_count(p));
    update_stress(settings, list, 0, p, stress_blocks);
    const Vec3Array before = p.velocity;
    const double duration = 0.1;
    kick(settings, list, {duration, duration, Vec3(0, 0, 0), 0, nullptr, 0}, p, kick_blocks);
    for (std::size_t i = 0; i < p.size(); ++i)
      found.force.emplace_back(p.mass[i] * (p.velocity[i] - before[i]) / duration);
    return found;
  }

 private:
  /// Of each neighbour j: x_i - x_j and g_ij.
  template <class Visit>
  void for_row(std::size_t i, Visit&& visit) const {
    for (const Index k : list.row(i)) {
      const auto j = static_cast<std::size_t>(k);
      const Vec3 d = particles.position[i] - particles.position[j];
      visit(j, d, slope(d.squaredNorm()) * d);
    }
  }
};

struct Difference {
  double gradient = 0, force = 0;  ///< largest, over the largest value
};
Difference between(const RandomBlock::Found& a, const RandomBlock::Found& b) {
  Difference largest, scale;
  for (std::size_t i = 0; i < a.force.size(); ++i) {
    largest.gradient = std::max(largest.gradient, (a.gradient[i] - b.gradient[i]).norm());
    largest.force = std::max(largest.force, (a.force[i] - b.force[i]).norm());
    scale.gradient = std::max(scale.gradient, b.gradient[i].norm());
    scale.force = std::max(scale.force, b.force[i].norm());
  }
  return {largest.gradient / scale.gradient, largest.force / scale.force};
}

class SinglePrecision : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, SinglePrecision,
                         testing::Values(test::Preset::accurate, test::Preset::fast, test::Preset::paper));

TEST_P(SinglePrecision, GivesGradientsAndForcesOfDoublePrecisionToAMillionth) {
  for (const bool viscous : {false, true}) {
    RandomBlock block(GetParam(), {0, 0, 0});
    block.settings.artificial_viscosity = viscous;
    const RandomBlock::Found expected = block.by_definition();
    const Difference d = between(block.by_loops(), expected);
    RecordProperty("gradient", testing::PrintToString(d.gradient));
    RecordProperty("force", testing::PrintToString(d.force));
    EXPECT_LT(d.gradient, 1e-6);
    EXPECT_LT(d.force, 1e-6);
  }
}

/// Records count positions modulo 2^32 units of h/2^22, 1024 h: here the count begins anew amid the block.
TEST_P(SinglePrecision, IsAsGoodFarFromTheOriginAndWhereRecordsBeginToCountAnew) {
  const double h = test::options_of(GetParam(), pitch).smoothing_length;
  for (const Vec3& origin : {Vec3(512 * h - 3 * pitch, -512 * h, 1536 * h), Vec3(7.1, -40.3, 12.9)}) {
    RandomBlock block(GetParam(), origin);
    const RandomBlock::Found expected = block.by_definition();
    const Difference d = between(block.by_loops(), expected);
    EXPECT_LT(d.gradient, 1e-6) << origin.transpose();
    EXPECT_LT(d.force, 1e-6) << origin.transpose();
  }
}

/// A velocity is off by at most 2^-24 of its size.
TEST_P(SinglePrecision, OfABlockThatMovesAsAWholeLosesTheShareOfItsVelocityThatRoundingTakes) {
  RandomBlock block(GetParam(), {0, 0, 0}, {100, 0, 0});
  const RandomBlock::Found expected = block.by_definition();
  const Difference d = between(block.by_loops(), expected);
  EXPECT_LT(d.gradient, 100 * 1e-6);
}

TEST_P(SinglePrecision, KeepsMomentumToDoublePrecision) {
  for (const bool controlled : {false, true}) {
    RandomBlock block(GetParam(), {0.3, 0.2, 0.1});
    block.settings.zero_energy_control = controlled;
    block.settings.options.zero_energy_viscosity = 0.05;
    if (controlled) block.particles.residual.assign(block.particles.size(), {});
    Vec3 sum(0, 0, 0);
    double scale = 0;
    for (const Vec3& force : block.by_loops().force) sum += force, scale += force.norm();
    EXPECT_LT(sum.norm(), 1e-14 * scale);
  }
}

}  // namespace
}  // namespace tuft::sph
