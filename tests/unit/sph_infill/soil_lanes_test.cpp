// The templates over lanes against the same for one point.
#include <gtest/gtest.h>

#include <random>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/soil_update.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph::test {
namespace {

template <class Draw>
SymmetricTensorOf<Pack> random_tensor(Draw&& draw) {
  return {Pack(draw), Pack(draw), Pack(draw), Pack(draw), Pack(draw), Pack(draw)};
}

SymmetricTensor lane_of(const SymmetricTensorOf<Pack>& t, std::size_t l) {
  return {t.xx[l], t.yy[l], t.zz[l], t.xy[l], t.yz[l], t.zx[l]};
}

void expect_near(const SymmetricTensor& a, const SymmetricTensor& b, double bound) {
  EXPECT_LE(std::sqrt(double_dot(a - b, a - b)), bound);
}

/// First loading, unloading, yield, tension and back, in all lanes at different times.
template <SoilEffects on>
void expect_paths_of_single_points(const SoilFoamMaterial& material) {
  const SoilLaw soft = make_soil_law(material, true, on),
                elastic = make_soil_law(elastic_material(2e6, 1500), true, on);
  std::array<const SoilLaw*, lanes> of_lane;
  for (std::size_t l = 0; l < lanes; ++l) of_lane[l] = l % 3 == 1 ? &elastic : &soft;
  SoilStateOf<Pack> state;
  std::array<SoilState, lanes> one;
  for (std::size_t l = 0; l < lanes; ++l) one[l] = reference_state(*of_lane[l]);
  state.bulk_modulus = Pack([&](auto l) { return one[l].bulk_modulus; });

  std::mt19937_64 random(3);
  std::normal_distribution<double> any;
  int yielded = 0, torn = 0;
  for (int k = 0; k < 3000; ++k) {
    StrainStepOf<Pack> step;
    step.strain = random_tensor([&](auto) { return 1e-3 * any(random); });
    for (Pack& turn : step.rotation) turn = Pack([&](auto) { return 1e-2 * any(random); });
    step.duration = 1e-4;
    const SoilWorkOf<Pack> work = update_soil_state<on>(LawOfLanes(of_lane), step, state);
    for (std::size_t l = 0; l < lanes; ++l) {
      const StrainStep of_one{lane_of(step.strain, l),
                              {step.rotation[0][l], step.rotation[1][l], step.rotation[2][l]},
                              step.duration};
      const SoilWork expected = update_soil(*of_lane[l], of_one, one[l]);
      const double stress = 1e3 + std::abs(one[l].pressure);
      ASSERT_NEAR(state.compression[l], one[l].compression, 1e-13);
      ASSERT_NEAR(state.largest_compression[l], one[l].largest_compression, 1e-13);
      ASSERT_NEAR(state.plastic_compression[l], one[l].plastic_compression, 1e-11);
      ASSERT_NEAR(state.lost_strength[l], one[l].lost_strength, 1e-9);
      ASSERT_NEAR(state.pressure[l], one[l].pressure, 1e-9 * stress) << "lane " << l << ", step " << k;
      ASSERT_NEAR(state.bulk_modulus[l], one[l].bulk_modulus, 1e-9 * one[l].bulk_modulus);
      expect_near(lane_of(state.deviator, l), one[l].deviator, 1e-8 * (stress + one[l].bulk_modulus * 1e-2));
      ASSERT_NEAR(work.total[l], expected.total, 1e-7 * stress);
      ASSERT_NEAR(work.dissipated[l], expected.dissipated, 1e-7 * stress);
      yielded += expected.dissipated > 0;
      torn += one[l].pressure == -of_lane[l]->tension_cutoff;
    }
  }
  EXPECT_GT(yielded, 1000);
  EXPECT_GT(torn, 100);
}

TEST(SoilLanes, FollowThePathsOfSinglePointsEachUnderItsOwnLaw) {
  expect_paths_of_single_points<SoilEffects{}>(mixture_material());
}

TEST(SoilLanes, FollowThemWithEachEffectAndWithAllOfThem) {
  const SoilFoamMaterial m = mixture_with_effects();
  expect_paths_of_single_points<SoilEffects{.density_hardening = true}>(m);
  expect_paths_of_single_points<SoilEffects{.strength_softening = true}>(m);
  expect_paths_of_single_points<SoilEffects{.strength_softening = true, .strength_recovery = true}>(m);
  expect_paths_of_single_points<SoilEffects{.strength_rate = true}>(m);
  expect_paths_of_single_points<SoilEffects{.inertial_friction = true}>(m);
  expect_paths_of_single_points<SoilEffects{.dilation = true}>(m);
  expect_paths_of_single_points<SoilEffects{.shear_energy = true}>(m);
  expect_paths_of_single_points<all_soil_effects>(m);
}

TEST(SoilLanes, StrainAndTurnOfAStepAreThoseOfASinglePoint) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> any;
  const auto draw = [&](auto) { return 100 * any(random); };
  const TensorOf<Pack> l{Pack(draw), Pack(draw), Pack(draw), Pack(draw), Pack(draw),
                         Pack(draw), Pack(draw), Pack(draw), Pack(draw)};
  const StrainStepOf<Pack> step = strain_step_of(l, 1e-4);
  for (std::size_t k = 0; k < lanes; ++k) {
    Mat3 m;
    m << l.xx[k], l.xy[k], l.xz[k], l.yx[k], l.yy[k], l.yz[k], l.zx[k], l.zy[k], l.zz[k];
    // By definition: L (1 - L dt/2)^-1 dt.
    const Mat3 middle = 1e-4 * m * (Mat3::Identity() - 0.5e-4 * m).inverse();
    expect_near(lane_of(step.strain, k), symmetric_part(middle), 1e-15);
    EXPECT_NEAR(step.rotation[2][k], (middle(1, 0) - middle(0, 1)) / 2, 1e-15);
    EXPECT_NEAR(step.rotation[0][k], (middle(2, 1) - middle(1, 2)) / 2, 1e-15);
  }
}

TEST(SoilLanes, PoorlySupportedLanesAreCorrectedAsSingleParticlesAre) {
  SymmetricTensorOf<Pack> moment;
  moment.xx = Pack([](auto l) { return l % 2 == 0 ? 1.1 : 1e-6; });
  moment.yy = Pack(0.9);
  moment.zz = Pack([](auto l) { return l % 4 == 3 ? 0.0 : 1.0; });
  moment.xy = Pack([](auto l) { return l % 2 == 0 ? 0.1 : 0.0; });
  const SymmetricTensorOf<Pack> b = correction_matrices(moment).b;
  for (std::size_t l = 0; l < lanes; ++l)
    expect_near(lane_of(b, l), correction_matrix(lane_of(moment, l)), 1e-13);
}

}  // namespace
}  // namespace tuft::sph::test
