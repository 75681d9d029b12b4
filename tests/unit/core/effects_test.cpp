#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/effect_names.h"
#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft {
namespace {

using testing::AllOf;
using testing::HasSubstr;

EffectDecision decide(const std::string& name, const Overrides& overrides) {
  for (const EffectDecision& decision : decide_effects(read_scene("inputs/clegg_small.toml", overrides)))
    if (decision.name == name) return decision;
  ADD_FAILURE() << "no effect " << name;
  return {};
}

TEST(Effects, EveryEffectIsDecidedWithAReason) {
  for (const std::string approach : {"sph", "dem"}) {
    const auto decisions =
        decide_effects(read_scene("inputs/clegg_small.toml", {{"infill.approach", approach}}));
    ASSERT_EQ(decisions.size(), effect_names.size());
    for (const EffectDecision& decision : decisions) EXPECT_GT(decision.why.size(), 10u) << decision.name;
  }
}

TEST(Effects, OfTheOtherApproachAreOffEvenWhenAskedFor) {
  const EffectDecision rolling = decide("rolling_resistance", {{"effects.rolling_resistance", "true"}});
  EXPECT_FALSE(rolling.on);
  EXPECT_EQ(rolling.why, "only for dem infill");
  const EffectDecision viscosity =
      decide("artificial_viscosity", {{"infill.approach", "dem"}, {"effects.artificial_viscosity", "true"}});
  EXPECT_FALSE(viscosity.on);
  EXPECT_EQ(viscosity.why, "only for sph infill");
}

TEST(Effects, FollowTheSceneUnlessSwitched) {
  EXPECT_TRUE(decide("fibres", {}).on);
  const EffectDecision off = decide("fibres", {{"effects.fibres", "false"}});
  EXPECT_FALSE(off.on);
  EXPECT_EQ(off.why, "switched off in the scene");
  EXPECT_FALSE(decide("artificial_viscosity",
                      {{"infill.sph.viscosity_linear", "0"}, {"infill.sph.viscosity_quadratic", "0"}})
                   .on);
  EXPECT_TRUE(decide("zero_energy_control", {}).on);
  EXPECT_FALSE(decide("zero_energy_control", {{"infill.sph.preset", "paper"}}).on)
      << "the published model has none";
  EXPECT_TRUE(decide("zero_energy_control",
                     {{"infill.sph.preset", "paper"}, {"infill.sph.zero_energy_viscosity", "0.05"}})
                  .on);
  EXPECT_FALSE(decide("overlap_release", {{"numerics.contact_release_time", "0 s"}}).on);
  EXPECT_TRUE(decide("rolling_resistance", {{"infill.approach", "dem"}}).on);
}

TEST(Effects, TheBackingIsThereForTheStrandsThatStandInIt) {
  EXPECT_THAT(decide("backing", {}).why, HasSubstr("strands stand in it"));
  EXPECT_TRUE(decide("backing", {}).on);
  const Overrides bare{{"effects.fibres", "false"}};
  EXPECT_FALSE(decide("backing", bare).on);
  EXPECT_THAT(decide("backing", bare).why, HasSubstr("rigid floor"));
  EXPECT_TRUE(decide("backing", {{"effects.fibres", "false"}, {"effects.backing", "true"}}).on);
  try {
    (void)read_scene("inputs/clegg_small.toml", {{"effects.backing", "false"}});
    ADD_FAILURE() << "strands without a backing were accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("effects.backing"));
    EXPECT_THAT(error.what(), HasSubstr("effects.fibres stands on it; switch that off too"));
  }
}

TEST(Effects, ErosionNeedsShellsThatCanFail) {
  Overrides brittle{{"turf.carpet.backing.failure_strain", "0.3"}};
  EXPECT_TRUE(decide("erosion", brittle).on);
  brittle.emplace_back("effects.fibres", "false");
  EXPECT_THAT(decide("erosion", brittle).why, HasSubstr("neither strands nor backing"));
  brittle.emplace_back("effects.backing", "true");
  EXPECT_TRUE(decide("erosion", brittle).on);
}

TEST(Effects, CohesionIsOnWhereGrainsOfTheLayersOrAPairOfThemHaveIt) {
  Overrides dem{{"infill.approach", "dem"}};
  const auto with = [&](const std::string& key, const std::string& value) {
    Overrides overrides = dem;
    overrides.emplace_back(key, value);
    return decide("grain_cohesion", overrides);
  };
  EXPECT_FALSE(decide("grain_cohesion", dem).on);
  EXPECT_FALSE(decide("grain_cohesion", {{"materials.sbr.grain.cohesion_energy_density", "1 kJ/m^3"}}).on)
      << "sph";
  EXPECT_THAT(with("materials.sbr.grain.cohesion_energy_density", "1 kJ/m^3").why,
              HasSubstr("grains of sbr"));
  EXPECT_THAT(
      with("infill.dem.pairs", R"([{ materials = ["sand", "sbr"], cohesion_energy_density = "1 kJ/m^3" }])")
          .why,
      HasSubstr("grains of sand on sbr hold"));
  EXPECT_FALSE(with("infill.dem.pairs", R"([{ materials = ["sand", "sbr"], friction = 0.4 }])").on);
  EXPECT_FALSE(with("infill.dem.pairs",
                    R"([{ materials = ["sand", "sbr_calibrated"], cohesion_energy_density = "1 kJ/m^3" }])")
                   .on)
      << "of grains that no layer has";
  dem.emplace_back("effects.grain_cohesion", "true");
  try {
    (void)read_scene("inputs/clegg_small.toml", dem);
    ADD_FAILURE() << "an effect with nothing to act on was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no grain material or pair has a cohesion_energy_density above 0"));
  }
}

TEST(Effects, ClumpsAreOnWhereGrainsOfTheLayersAreClumps) {
  const Overrides none{{"infill.approach", "dem"}};
  EXPECT_FALSE(decide("clumps", none).on);
  Overrides pair = none;
  pair.emplace_back("materials.sbr.grain.clump", R"({ shape = "pair" })");
  EXPECT_TRUE(decide("clumps", pair).on);
  EXPECT_THAT(decide("clumps", pair).why, HasSubstr("grains of sbr are clumps"));
  pair.emplace_back("effects.clumps", "false");
  EXPECT_FALSE(decide("clumps", pair).on);
}

TEST(Effects, FrictionRateNeedsALawThatChangesWithSpeed) {
  Overrides overrides;
  EXPECT_THAT(decide("friction_rate", overrides).why,
              HasSubstr("friction of sand changes with sliding speed"));
  for (const std::string material : {"sand", "mixture", "sbr"})
    overrides.emplace_back("materials." + material + ".friction.fibre.decay", "0 s/m");
  EXPECT_FALSE(decide("friction_rate", overrides).on);
  overrides.emplace_back("turf.carpet.body_friction.decay", "100 s/m");
  EXPECT_FALSE(decide("friction_rate", overrides).on) << "static and dynamic are the same";
  overrides.emplace_back("turf.carpet.body_friction.dynamic", "0.5");
  EXPECT_THAT(decide("friction_rate", overrides).why, HasSubstr("friction of the carpet"));
}

TEST(Effects, ContactDampingNeedsARestitutionBelowOne) {
  Overrides overrides{{"turf.carpet.contact_restitution", "1.0"}};
  EXPECT_TRUE(decide("contact_damping", overrides).on);
  for (const std::string material : {"sand", "mixture", "sbr"})
    overrides.emplace_back("materials." + material + ".material.contact_restitution", "1.0");
  EXPECT_FALSE(decide("contact_damping", overrides).on);
}

const std::string continuum = "materials.sbr.continuum.";

TEST(Effects, OfTheSoilLawAreOnWhereAMaterialGivesTheirParameters) {
  for (const char* name : {"density_hardening", "strength_softening", "strength_recovery", "strength_rate",
                           "inertial_friction", "dilation", "shear_energy"})
    EXPECT_FALSE(decide(name, {}).on) << name;
  const Overrides hardening{{continuum + "density_hardening.modulus_exponent", "2"}},
      softening{{continuum + "strength_softening.strain", "0.1"}},
      rate{{continuum + "strength_rate.coefficient", "0.04"},
           {continuum + "strength_rate.reference", "1 Hz"}},
      inertial{{continuum + "inertial_friction.increase", "0.7"},
               {continuum + "inertial_friction.inertial_number", "0.3"},
               {continuum + "inertial_friction.grain_diameter", "1 mm"},
               {continuum + "inertial_friction.grain_density", "2450 kg/m^3"}},
      dilation{{continuum + "dilation_angle", "5 degree"}};
  EXPECT_THAT(decide("density_hardening", hardening).why, HasSubstr("sbr"));
  EXPECT_TRUE(decide("density_hardening", hardening).on);
  EXPECT_TRUE(decide("shear_energy", hardening).on) << "it makes the shear modulus grow";
  EXPECT_TRUE(decide("strength_softening", softening).on);
  EXPECT_FALSE(decide("strength_recovery", softening).on);
  EXPECT_TRUE(decide("strength_rate", rate).on);
  EXPECT_TRUE(decide("inertial_friction", inertial).on);
  EXPECT_TRUE(decide("dilation", dilation).on);
  Overrides recovery = softening;
  recovery.emplace_back(continuum + "strength_recovery.time", "2 s");
  EXPECT_TRUE(decide("strength_recovery", recovery).on);
  recovery.emplace_back("effects.strength_softening", "false");
  EXPECT_FALSE(decide("strength_recovery", recovery).on) << "nothing is lost";
  Overrides off = hardening;
  off.emplace_back("effects.density_hardening", "false");
  EXPECT_FALSE(decide("shear_energy", off).on);
  off.emplace_back("infill.approach", "dem");
  EXPECT_EQ(decide("dilation", off).why, "only for sph infill");
}

TEST(Effects, AreFoundByName) {
  const std::vector<EffectDecision> decisions{{"a", true, ""}, {"b", false, ""}};
  EXPECT_TRUE(effect_on(decisions, "a"));
  EXPECT_FALSE(effect_on(decisions, "b"));
  EXPECT_FALSE(effect_on(decisions, "c"));
}

TEST(Effects, SwitchedOnWithNothingToActOnAreRefusedByName) {
  const auto said = [](const Overrides& overrides) -> std::string {
    try {
      (void)read_scene("inputs/clegg_small.toml", overrides);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_THAT(said({{"effects.erosion", "true"}}),
              AllOf(HasSubstr("effects.erosion"), HasSubstr("no shell material has a failure_strain")));
  EXPECT_THAT(said({{"effects.overlap_release", "true"}, {"numerics.contact_release_time", "0 s"}}),
              AllOf(HasSubstr("effects.overlap_release"), HasSubstr("contact_release_time is 0")));
  EXPECT_EQ(said({{"effects.erosion", "true"}, {"turf.carpet.fibre.failure_strain", "0.4"}}), "");
  EXPECT_EQ(said({{"effects.erosion", "false"}}), "");
  EXPECT_THAT(said({{"effects.density_hardening", "true"}}),
              AllOf(HasSubstr("effects.density_hardening"), HasSubstr("no material has")));
  EXPECT_THAT(said({{"effects.strength_recovery", "true"}, {continuum + "strength_softening.strain", "0.1"}}),
              AllOf(HasSubstr("effects.strength_recovery"), HasSubstr("time or compression above 0")));
  EXPECT_THAT(said({{"effects.strength_recovery", "true"}, {continuum + "strength_recovery.time", "1 s"}}),
              HasSubstr("no strength is lost"));
  EXPECT_THAT(said({{"effects.strength_rate", "true"}}),
              HasSubstr("no material has a continuum.strength_rate"));
  EXPECT_THAT(said({{"effects.inertial_friction", "true"}}),
              HasSubstr("no material has a continuum.inertial_friction"));
  EXPECT_THAT(said({{"effects.dilation", "true"}}), HasSubstr("dilation_angle above 0"));
  EXPECT_EQ(said({{"effects.shear_energy", "true"}}), "")
      << "unloading moduli of the materials follow pressure";
}

}  // namespace
}  // namespace tuft
