/// A block of particles in simple shear, to large strains, against the closed form of the Jaumann rate.
#include <gtest/gtest.h>

#include <numbers>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002, bulk_modulus = 1e6, shear_ratio = 0.5;

/// With x moved by gamma z: s_xz = G sin(gamma), s_xx = -s_zz = G (1 - cos(gamma)).
///
/// Largest error over G among the particles whose neighbourhood determines L. (A sheared block ends in
/// wedges; at their tips a particle may see its neighbours in a plane.)
struct ShearError {
  double stress = 0;   ///< over G
  double density = 0;  ///< |e|
  double power = 0;    ///< work of the step sums against G (1 - cos gamma) of the closed form, relative
  double share = 0;    ///< of particles that are compared
};

ShearError shear(test::Preset preset, double gamma, int steps) {
  const Lattice lattice = test::block(12, 5, 6, pitch);
  const std::size_t n = lattice.position.size();
  LoopSettings settings;
  settings.options = test::options_of(preset, pitch);
  settings.laws = {make_soil_law(test::elastic_material(bulk_modulus, 1000, shear_ratio))};
  settings.artificial_viscosity = false;
  Particles p;
  p.assign(n, settings.options.smoothing_length);
  p.position = lattice.position;
  p.volume = p.reference_volume = lattice.volume;
  for (std::size_t i = 0; i < n; ++i) {
    p.mass[i] = 1000 * lattice.volume[i];
    p.set_soil_state(i, reference_state(settings.laws[0]));
  }
  const double dt = 1e-4, rate = gamma / steps / dt;
  for (std::size_t i = 0; i < n; ++i) p.velocity.set(i, {rate * lattice.position.z[i], 0, 0});
  NeighbourList list(p.position, 2 * settings.options.smoothing_length, 0.1 * pitch);
  std::vector<StressSums> blocks(block_count(p));
  std::vector<bool> exact(n, true);
  double work = 0;
  for (int k = 1; k <= steps; ++k) {
    for (std::size_t i = 0; i < n; ++i)
      p.position.x[i] = lattice.position.x[i] + gamma * k / steps * lattice.position.z[i];
    p.record_motion();
    list.build(p.position);
    for (std::size_t i = 0; i < n; ++i)
      exact[i] = exact[i] && correction_of(sum_gradients(settings, list, p, i).moment).exact;
    work += update_stress(settings, list, dt, p, blocks).work;
  }
  const double g = shear_ratio * bulk_modulus;
  ShearError error;
  double energy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!exact[i]) continue;
    error.share += 1.0 / static_cast<double>(n);
    const SoilState s = p.soil_state(i);
    const double wrong[]{s.deviator.zx - g * std::sin(gamma),
                         s.deviator.xx - g * (1 - std::cos(gamma)),
                         s.deviator.zz + g * (1 - std::cos(gamma)),
                         s.deviator.yy,
                         s.deviator.xy,
                         s.deviator.yz};
    for (const double w : wrong) error.stress = std::max(error.stress, std::abs(w) / g);
    error.density = std::max(error.density, std::abs(s.compression));
  }
  for (const double volume : lattice.volume) energy += volume * g * (1 - std::cos(gamma));
  error.power = std::abs(work / energy - 1);
  return error;
}

class SimpleShear : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, SimpleShear, testing::Values(test::Preset::accurate, test::Preset::paper));

TEST_P(SimpleShear, FollowsTheJaumannRatesClosedFormToLargeStrains) {
  for (const double gamma : {1.0, std::numbers::pi}) {
    const ShearError error = shear(GetParam(), gamma, 150);
    RecordProperty("stress_error", testing::PrintToString(error.stress));
    RecordProperty("share_compared", testing::PrintToString(error.share));
    EXPECT_LT(error.stress, 1e-4) << gamma;
    EXPECT_LT(error.density, 5e-7) << gamma;
    EXPECT_GT(error.share, 0.9) << gamma;
    EXPECT_LT(error.power, 0.04) << gamma;  // those at the tips are in it
  }
}

TEST_P(SimpleShear, ItsErrorFallsWithTheSquareOfTheStep) {
  const double coarse = shear(GetParam(), 2, 40).stress, fine = shear(GetParam(), 2, 80).stress;
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1);
}

}  // namespace
}  // namespace tuft::sph
