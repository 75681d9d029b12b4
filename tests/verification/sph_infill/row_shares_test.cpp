/// Beds between a floor and a plate whose contact is half a row deep: what their rows strain themselves makes
/// them neither too stiff nor too soft, however many they are.
#include <gtest/gtest.h>

#include <numeric>

#include "sph_infill/row_shares.h"
#include "sph_infill/sph_infill_impl.h"
#include "tests/unit/sph_infill/sph_test_support.h"
#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph {
namespace {

constexpr double width_in_rows = 16;

Turf turf_of(std::initializer_list<double> depths) {
  Turf turf;
  for (Index k = 0; const double depth : depths) turf.layers.push_back({k++, depth});
  return turf;
}

/// Elastic, without lateral stress, so that walls bear none.
std::vector<Material> springy_materials(std::initializer_list<double> moduli) {
  std::vector<Material> materials;
  for (const double modulus : moduli) {
    SoilFoamMaterial elastic = test::elastic_material(modulus / 3, 1000);  // M = K + 4/3 G = 3 K at nu = 0
    elastic.shear_ratio = 1.5;
    materials.push_back(test::single_material(elastic).front());
  }
  return materials;
}

class RowShares : public testing::TestWithParam<test::Preset> {};
INSTANTIATE_TEST_SUITE_P(Presets, RowShares,
                         testing::Values(test::Preset::accurate, test::Preset::fast, test::Preset::paper));

/// The patch test, by the loops of a run: a uniform vertical stress of 1 kPa in rows of unlike thickness.
TEST_P(RowShares, LeaveAUniformStressInEquilibriumButForTheOutermostRowsWhichBearAllOfIt) {
  constexpr double pitch = 0.004, stress = 1000;
  const SphOptions options = test::options_of(GetParam(), pitch);
  const double width = width_in_rows * pitch;
  const Lattice bed = make_bed(turf_of({0.005, 0.022, 0.023}), {{width, width}, 0}, options);
  LoopSettings settings;
  settings.options = options;
  settings.artificial_viscosity = false;
  for (int k = 0; k < 3; ++k) settings.laws.push_back(make_soil_law(test::elastic_material(1e6, 1000)));
  Particles p;
  const std::size_t n = bed.position.size();
  p.assign(n, options.smoothing_length);
  p.position = bed.position, p.volume = p.reference_volume = bed.volume;
  p.strained_share = bed.strained_share;
  p.material = p.layer = bed.layer;
  for (std::size_t i = 0; i < n; ++i) {
    p.mass[i] = 1000 * bed.volume[i];
    SoilState state = reference_state(settings.laws[0]);
    state.pressure = stress / 3;
    state.deviator = {stress / 3, stress / 3, -2 * stress / 3, 0, 0, 0};
    p.set_soil_state(i, state);
  }
  NeighbourList list(p.position, 2 * options.smoothing_length, 0);
  list.build(p.position);
  p.record_motion();
  std::vector<StressSums> stress_blocks(block_count(p));
  std::vector<KickSums> kick_blocks(block_count(p));
  update_stress(settings, list, 0, p, stress_blocks);
  kick(settings, list, {1, 1, Vec3(0, 0, 0), 0, nullptr, 0}, p, kick_blocks);

  const double area = bed.pitch * bed.pitch, top = p.position.z[n - 1];
  double inner = 0, outer = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 x = p.position[i];
    if (std::max(std::abs(x.x()), std::abs(x.y())) > 1.5 * pitch) continue;  // walls are felt there
    const double force = p.mass[i] * p.velocity.z[i] / (stress * area);
    if (x.z() < 0.0045)
      outer = std::max(outer, std::abs(force + 1));  // downwards: the floor is to bear it
    else if (x.z() > top - 1e-6)
      outer = std::max(outer, std::abs(force - 1));
    else
      inner = std::max(inner, std::abs(force));
  }
  RecordProperty("inner", testing::PrintToString(inner));
  RecordProperty("outer", testing::PrintToString(outer));
  EXPECT_LT(inner, 1e-5);
  EXPECT_LT(outer, 1e-5);
}

TEST_P(RowShares, SumUpToTheDistanceBetweenTheOutermostRows) {
  const SphOptions options = test::options_of(GetParam(), 1);
  const std::vector<double> thickness{1.2, 1, 1, 1, 0.9, 0.9, 0.9, 1.1, 1.1};
  std::vector<double> place;
  for (double bottom = 0; const double t : thickness) place.push_back(bottom + 0.5 * t), bottom += t;
  const std::vector<double> share = row_shares(place, thickness, {1, 1}, options);
  EXPECT_NEAR(std::inner_product(share.begin(), share.end(), thickness.begin(), 0.0),
              place.back() - place.front(), 1e-9);
}

TEST(RowShares, OfRowsFarFromTheEndsAreOneAndOfFewRowsAll) {
  const SphOptions options = test::options_of(test::Preset::accurate, 1);
  std::vector<double> place, thickness(20, 1.0);
  for (int k = 0; k < 20; ++k) place.push_back(k + 0.5);
  const std::vector<double> share = row_shares(place, thickness, {1, 1}, options);
  for (std::size_t k = 4; k < 16; ++k) EXPECT_NEAR(share[k], 1, 1e-5) << k;
  EXPECT_NEAR(share[0], 0.562, 1e-3);
  const std::vector<double> two{0.5, 1.5};
  EXPECT_EQ(row_shares(two, std::vector<double>{1, 1}, {1, 1}, options), (std::vector<double>{1, 1}));
}

TEST(RowShares, StayPositiveHoweverFewTheRowsAndWideTheKernel) {
  for (const double ratio : {0.71, 1.0, 1.3, 2.0, 3.0})
    for (const std::vector<double>& thickness :
         {std::vector<double>{1, 1, 1}, {1.4, 0.7, 1}, {0.6, 1.4, 0.6, 1.4}, {1, 1, 1, 1, 0.5, 0.5, 1.5}}) {
      SphOptions options = test::options_of(test::Preset::accurate, 1);
      options.smoothing_length = ratio;
      std::vector<double> place;
      for (double bottom = 0; const double t : thickness) place.push_back(bottom + 0.5 * t), bottom += t;
      for (const double share : row_shares(place, thickness, {1, 1}, options)) {
        EXPECT_GE(share, 0.2 - 1e-12) << ratio;
        EXPECT_LE(share, 1.8 + 1e-12) << ratio;
      }
    }
}

struct Pressed {
  double stiffness = 0;     ///< stress under the plate over that of the layers' law
  double energy_error = 0;  ///< over the work of the plate
  double at_floor = 0;      ///< stress of the lowest row in the bed's middle over that under the plate
};

/// A bed at rest under a plate that has come down by 0.05 %. Springs of floor and plate are half rows of what
/// they touch.
Pressed press(test::Preset preset, std::initializer_list<double> depths, std::initializer_list<double> moduli,
              double pitch, bool with_shares) {
  constexpr double strain = 5e-4;
  const double width = 8 * pitch;
  const Turf turf = turf_of(depths);
  const SphOptions options = test::options_of(preset, pitch);
  Lattice bed = make_bed(turf, {{width, width}, 0}, options);
  if (!with_shares) bed.strained_share.clear();
  SphSettings settings;
  settings.options = options;
  settings.gravity = {0, 0, 0};
  const auto materials = springy_materials(moduli);
  SphInfill infill(bed, materials, settings);
  double height = 0, compliance = 0, travel_time = 0;
  for (std::size_t k = 0; k < turf.layers.size(); ++k) {
    const double modulus = constrained_modulus(*materials[k].continuum, 0);
    height += turf.layers[k].depth, compliance += turf.layers[k].depth / modulus;
    travel_time += turf.layers[k].depth * std::sqrt(1000 / modulus);
  }
  const auto spring = [&](std::size_t layer, std::size_t i) {
    return constrained_modulus(*materials[layer].continuum, 0) * bed.pitch * bed.pitch / bed.half_height[i];
  };
  const std::size_t n = bed.position.size();
  const double low = spring(0, 0), high = spring(turf.layers.size() - 1, n - 1);
  double bottom = 1, top = 0;
  for (std::size_t i = 0; i < n; ++i)
    bottom = std::min(bottom, bed.position.z[i]), top = std::max(top, bed.position.z[i]);
  const double frequency = std::numbers::pi / travel_time;
  infill.set_damping(2 * frequency);
  ContactImpulses contact;
  double force = 0;
  const double dt = 0.5 * infill.stable_step();
  test::EnergyLedger ledger;
  for (double t = 0; t < 25 / frequency; t += dt) {
    const double share = std::min(1.0, t * frequency / 15),
                 down = strain * height * share * share * (3 - 2 * share);
    const ParticleView p = infill.particles();
    contact.linear.assign(n, 0);
    force = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double h = bed.half_height[i];
      if (bed.position.z[i] < bottom + 1e-9) contact.linear.z[i] = dt * low * std::max(0.0, h - p.z[i]);
      if (bed.position.z[i] < top - 1e-9) continue;
      const double push = high * std::max(0.0, p.z[i] + h - (height - down));
      contact.linear.z[i] = -dt * push;
      force += push;
    }
    infill.advance(dt, 1, contact);
    ledger.enter(infill.energy());
  }
  Pressed result;
  result.energy_error = ledger.worst / infill.energy().stored;
  const double stress = force / (width * width);
  result.stiffness = stress * compliance / (strain * height);
  const auto moments = infill.stress_moments();
  for (std::size_t i = 0; i < n; ++i)
    if (bed.position.z[i] < bottom + 1e-9 && std::abs(bed.position.x[i]) < bed.pitch &&
        std::abs(bed.position.y[i]) < bed.pitch)
      result.at_floor +=
          0.25 * -moments[i][2] / ((with_shares ? bed.strained_share[i] : 1) * bed.volume[i] * stress);
  return result;
}

TEST_P(RowShares, GiveABedBetweenHalfRowsTheStiffnessOfItsLawAndTheFloorItsStress) {
  for (const int rows : {4, 6, 12}) {
    const Pressed with = press(GetParam(), {rows * 0.004}, {3e6}, 0.004, true),
                  without = press(GetParam(), {rows * 0.004}, {3e6}, 0.004, false);
    RecordProperty("stiffness_" + std::to_string(rows), testing::PrintToString(with.stiffness));
    RecordProperty("without_" + std::to_string(rows), testing::PrintToString(without.stiffness));
    RecordProperty("floor_" + std::to_string(rows), testing::PrintToString(with.at_floor));
    RecordProperty("floor_without_" + std::to_string(rows), testing::PrintToString(without.at_floor));
    RecordProperty("energy_" + std::to_string(rows), testing::PrintToString(with.energy_error));
    EXPECT_NEAR(with.stiffness, 1, 0.005) << rows;
    EXPECT_LT(with.energy_error, 1e-5) << "work is not that of the forces";
    EXPECT_NEAR(with.at_floor, 1, 0.02) << rows;
    EXPECT_GT(without.stiffness, 1 + 0.4 / rows) << rows;
    EXPECT_LT(without.at_floor, 0.7) << rows;
  }
}

/// Layers as in the published turf, ten and five times as stiff as the one above. Their rows change in number
/// at 4.18 and 4.6 mm, and at 3.33 mm.
TEST_P(RowShares, KeepTheStiffnessOfALayeredBedAsThePitchPassesWholeNumbersOfRows) {
  double least = 2, most = 0;
  for (const double pitch : {0.0032, 0.0035, 0.004, 0.00415, 0.0042, 0.0046, 0.005}) {
    const double stiffness =
        press(GetParam(), {0.005, 0.022, 0.023}, {50e6, 5e6, 1e6}, pitch, true).stiffness;
    least = std::min(least, stiffness), most = std::max(most, stiffness);
  }
  RecordProperty("least", testing::PrintToString(least));
  RecordProperty("most", testing::PrintToString(most));
  EXPECT_GT(least, 0.99);
  EXPECT_LT(most, 1.015);
}

}  // namespace
}  // namespace tuft::sph
