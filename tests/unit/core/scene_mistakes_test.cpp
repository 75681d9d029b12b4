// The one line that each mistake in a scene gets.
#include "core/scene_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "good_scene.h"

namespace tuft {
namespace {

using test::complaint;
using test::complaint_for;
using test::good;
using test::message_of;
using test::ScratchFolder;
using test::with;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

TEST(SceneMistakes, UnknownKeyNamesTheNearest) {
  EXPECT_EQ(complaint_for("pitch =", "pich ="),
            "a.toml:16: infill.sph.pich: \"4 mm\": unknown key; did you mean \"pitch\"?");
  EXPECT_EQ(complaint_for("[infill.sph]", "[infil.sph]"),
            "a.toml:15: infil: unknown key; did you mean \"infill\"?");
  EXPECT_EQ(complaint_for("approach = \"sph\"", "pitch = \"4 mm\""),
            "a.toml:14: infill.pitch: \"4 mm\": unknown key; did you mean infill.sph.pitch?");
  EXPECT_EQ(complaint_for("depth = \"5 mm\"", "thick = \"5 mm\""),
            "a.toml:9: turf.layers.0.thick: \"5 mm\": unknown key; known here: material, depth");
}

TEST(SceneMistakes, UnknownEffectNamesTheNearest) {
  EXPECT_EQ(complaint_for("fibres = true", "fibers = true"),
            "a.toml:21: effects.fibers: true: unknown key; did you mean \"fibres\"?");
  EXPECT_EQ(complaint_for("fibres = true", "fibres = \"maybe\""),
            "a.toml:21: effects.fibres: \"maybe\": true, false or \"auto\" is needed");
}

TEST(SceneMistakes, MissingKeySaysWhatToAdd) {
  EXPECT_EQ(complaint_for("size = [\"80 mm\", \"90 mm\"]\n", ""),
            "a.toml:3: turf.size: missing; add it: two of a length (m), for example [\"5 mm\", \"5 mm\"]");
  EXPECT_EQ(complaint_for("depth = \"5 mm\"\n", ""),
            "a.toml:7: turf.layers.0.depth: missing; add it: a length (m), for example \"5 mm\"");
  EXPECT_EQ(complaint_for("[scene]\nduration = \"25 ms\"\n", ""),
            "a.toml: scene.duration: missing; add it: a time (s), for example \"10 ms\"");
}

TEST(SceneMistakes, WrongUnit) {
  EXPECT_EQ(complaint_for("depth = \"5 mm\"", "depth = \"2 kg\""),
            "a.toml:9: turf.layers.0.depth: \"2 kg\": \"kg\" is not the unit of a length (m); write for "
            "example \"5 mm\"");
}

TEST(SceneMistakes, WrongType) {
  EXPECT_EQ(complaint_for("pitch = \"4 mm\"", "pitch = 4"),
            "a.toml:16: infill.sph.pitch: 4: a plain number; a length (m) with its unit in quotes is needed, "
            "for example "
            "\"5 mm\"");
  EXPECT_EQ(complaint_for("step_safety = 0.5", "step_safety = \"0.5\""),
            "a.toml:23: numerics.step_safety: \"0.5\": a plain number without quotes is needed");
  EXPECT_EQ(complaint_for("step_safety = 0.5", "threads = 1.5"),
            "a.toml:23: numerics.threads: 1.5: a whole number without quotes is needed");
  EXPECT_EQ(complaint_for("[numerics]\nstep_safety = 0.5\n", "numerics = 3\n").substr(0, 16),
            "a.toml:22: effec");
  EXPECT_EQ(complaint_for("pitch = \"4 mm\"", "pitch = true"),
            "a.toml:16: infill.sph.pitch: true: a length (m) in quotes is needed, for example \"5 mm\"");
}

TEST(SceneMistakes, ListOfWrongLength) {
  EXPECT_THAT(complaint_for("[\"80 mm\", \"90 mm\"]", "[\"80 mm\"]"),
              AllOf(StartsWith("a.toml:5: turf.size: "), EndsWith("is needed, not of 1")));
  EXPECT_THAT(complaint_for("[\"80 mm\", \"90 mm\"]", "\"80 mm\""), HasSubstr("a list of two quantities"));
}

TEST(SceneMistakes, NegativeOrZeroWherePositiveIsNeeded) {
  EXPECT_EQ(complaint_for("\"4 mm\"", "\"-4 mm\""),
            "a.toml:16: infill.sph.pitch: \"-4 mm\": must be above 0 m");
  EXPECT_EQ(complaint_for("\"4 mm\"", "\"0 mm\""),
            "a.toml:16: infill.sph.pitch: \"0 mm\": must be above 0 m");
  EXPECT_EQ(complaint_for("step_safety = 0.5", "step_safety = 1.5"),
            "a.toml:23: numerics.step_safety: 1.5: must be above 0 and at most 1");
}

TEST(SceneMistakes, NotANumber) {
  EXPECT_EQ(complaint_for("\"4 mm\"", "\"nan mm\""),
            "a.toml:16: infill.sph.pitch: \"nan mm\": must be a finite number");
  EXPECT_EQ(complaint_for("step_safety = 0.5", "step_safety = nan"),
            "a.toml:23: numerics.step_safety: nan: must be a finite number");
  EXPECT_EQ(complaint_for("step_safety = 0.5", "step_safety = inf"),
            "a.toml:23: numerics.step_safety: inf: must be a finite number");
}

TEST(SceneMistakes, LayersDeeperThanTheTray) {
  EXPECT_EQ(complaint_for("tray_depth = \"70 mm\"", "tray_depth = \"40 mm\""),
            "a.toml:6: turf.tray_depth: \"40 mm\": layers are 50 mm deep, deeper than the tray; make it "
            "deeper or the layers "
            "thinner");
}

TEST(SceneMistakes, ConditioningThatTheInfillCannotTake) {
  const auto with = [](const std::string& keys) {
    return complaint_for("[rig]", "[conditioning]\nmethod = \"compaction\"\n" + keys + "\n[rig]");
  };
  EXPECT_THAT(with("depth = \"0 mm\""), HasSubstr("conditioning.depth: \"0 mm\": must be above 0 m"));
  EXPECT_THAT(
      with("depth = \"60 mm\""),
      HasSubstr("conditioning.depth: \"60 mm\": the infill is only 50 mm deep; make it less than that"));
  EXPECT_THAT(with("depth = \"20 mm\""), HasSubstr("at most 13.809 mm can be pressed with "
                                                   "conditioning.sphere_diameter = 0.96"));
  // The published volume of 11.87 mm^3 at a pitch of 2 mm.
  EXPECT_THAT(with("sphere_diameter = 1.415"), HasSubstr("spheres fill 1.5 of the room as placed"));
  EXPECT_THAT(with("press_time = \"0 s\""), HasSubstr("must be above 0 s"));
  EXPECT_THAT(with("state = \"loose\""), HasSubstr("\"auto\", \"initial\" or \"compacted\" is needed"));
  EXPECT_THAT(with("tolerance = \"1 mm\""), HasSubstr("give conditioning.presses above 1, or leave it out"));
  EXPECT_THAT(complaint_for("[rig]", "[conditioning]\nmethod = \"compact\"\n[rig]"),
              HasSubstr("did you mean \"compaction\"?"));
}

TEST(SceneMistakes, PatchSmallerThanTheMissile) {
  EXPECT_EQ(complaint_for("\"90 mm\"]", "\"50 mm\"]"),
            "a.toml:5: turf.size.1: \"50 mm\": the patch is smaller than the missile (50 mm wide, 0 mm off "
            "the middle) and 5 "
            "mm on each side; at least 60 mm is needed");
  EXPECT_THAT(complaint_for("speed = \"2.85 m/s\"", "position = [\"20 mm\", \"0 mm\"]"),
              HasSubstr("20 mm off the middle"));
}

TEST(SceneMistakes, UnknownApproachRigMaterialDesign) {
  EXPECT_EQ(
      complaint_for("approach = \"sph\"", "approach = \"sphh\""),
      "a.toml:14: infill.approach: \"sphh\": unknown; did you mean \"sph\"? \"sph\" or \"dem\" is needed");
  EXPECT_EQ(complaint_for("\"clegg\"", "\"beast\""),
            "a.toml:18: rig.type: \"beast\": unknown; \"clegg\", \"strand_tension\", \"backing_tension\", "
            "\"oedometer\", \"direct_shear\" or \"pull_out\" is needed");
  EXPECT_EQ(complaint_for("\"sbr\"", "\"sbrr\""),
            "a.toml:11: turf.layers.1.material: \"sbrr\": no such file in materials/; did you mean \"sbr\"?");
  EXPECT_EQ(complaint_for("\"slit_film_coarse\"", "\"slit_film_course\""),
            "a.toml:4: turf.design: \"slit_film_course\": no such file in turfs/; did you mean "
            "\"slit_film_coarse\"?");
}

TEST(SceneMistakes, UnreadableFileOrNoToml) {
  const ScratchFolder folder;
  EXPECT_EQ(message_of<InputError>([&] { (void)read_scene(folder / "none.toml"); }),
            (folder / "none.toml").string() + ": cannot be read (No such file or directory)");
  EXPECT_EQ(message_of<InputError>([&] { (void)read_scene(folder.path()); }),
            folder.path().string() + ": is a folder; a file is needed");
  EXPECT_THAT(complaint_for("[infill]", "[infill"), StartsWith("a.toml:13: not readable as TOML: "));
  EXPECT_THAT(complaint("\x89PNG\r\n\x1a\n"), StartsWith("a.toml:1: not readable as TOML: "));
  EXPECT_THAT(complaint_for("pitch = \"4 mm\"", "pitch = \"4 mm\"\npitch = \"3 mm\""),
              StartsWith("a.toml:17: not readable as TOML: "));
  EXPECT_THAT(complaint(""), StartsWith("a.toml: scene.duration: missing"));
}

TEST(SceneMistakes, OverrideOfAKeyThatDoesNotExist) {
  EXPECT_EQ(complaint(good, {{"infill.sph.pich", "3 mm"}}),
            "--set: infill.sph.pich: \"3 mm\": unknown key; did you mean \"pitch\"?");
  EXPECT_EQ(complaint(good, {{"infil.approach", "dem"}}),
            "--set: infil: unknown key; did you mean \"infill\"?");
  EXPECT_EQ(complaint(good, {{"turf.layers.7.depth", "3 mm"}}),
            "--set: turf.layers.7.depth: no item 7: the list has 2, counted from 0");
  EXPECT_EQ(complaint(good, {{"rig.speed.x", "3"}}),
            "--set: rig.speed.x: nothing lies below this key: its value is \"2.85 m/s\"");
  EXPECT_EQ(complaint(good, {{"rig..speed", "3"}}),
            "--set: \"rig..speed\": is no key; write --set table.key=value");
}

TEST(SceneMistakes, OverrideWithABadValue) {
  EXPECT_EQ(complaint(good, {{"infill.sph.pitch", "-3 mm"}}),
            "--set: infill.sph.pitch: \"-3 mm\": must be above 0 m");
  EXPECT_EQ(complaint(good, {{"numerics.seed", "x"}}),
            "--set: numerics.seed: \"x\": a whole number without quotes is needed");
  EXPECT_THAT(complaint(good, {{"infill.sph.pitch", "3 mm\nfoo = 1"}}),
              HasSubstr("\"mm foo = 1\" is not a unit"));
}

TEST(SceneMistakes, MaterialThatTheApproachCannotUse) {
  const std::string bare =
      "[materials.felt.material]\nbulk_density = \"100 kg/m^3\"\n"
      "[materials.felt.friction]\nfibre = { static = 0.3, dynamic = 0.3 }\n"
      "body = { static = 0.3, dynamic = 0.3 }\n";
  const std::string scene = with("\"sbr\"", "\"felt\"") + bare;
  EXPECT_EQ(complaint(scene),
            "a.toml:11: turf.layers.1.material: \"felt\": has no [continuum] in a.toml, which approach "
            "\"sph\" needs");
  EXPECT_EQ(complaint(scene, {{"infill.approach", "dem"}}),
            "a.toml:11: turf.layers.1.material: \"felt\": has neither [grain] nor [[grain_shares]] in "
            "a.toml, which approach "
            "\"dem\" needs");
}

TEST(SceneMistakes, GrainShares) {
  const auto shares = [](double sand, const std::string& second) {
    return with("\"sand\"", "\"mixture\"") + fmt::format(
                                                 "[materials.mixture]\ngrain_shares = [{{ material = "
                                                 "\"sand\", mass_fraction = {} }}, {{ material = "
                                                 "\"{}\", mass_fraction = 0.3 }}]\n",
                                                 sand, second);
  };
  EXPECT_THAT(complaint(shares(0.6, "sbr")), AllOf(StartsWith("a.toml:25: materials.mixture.grain_shares: "),
                                                   EndsWith("add up to 0.9; make it 1")));
  EXPECT_EQ(complaint(shares(0.7, "sand")),
            "a.toml:25: materials.mixture.grain_shares.1.material: \"sand\": named twice in this material; "
            "give one share");
}

TEST(SceneMistakes, Curves) {
  const auto curve = [](const std::string& text) {
    return complaint(good + "[materials.sbr.continuum]\npressure = " + text + "\n");
  };
  const std::string at = "a.toml:25: materials.sbr.continuum.pressure";
  EXPECT_EQ(curve("{ unit = \"kg\", strain = [0, 1], values = [0, 1] }"),
            at + ".unit: \"kg\": \"kg\" is not the unit of a pressure or modulus (Pa); write for example "
                 "\"100 kPa\"");
  EXPECT_EQ(curve("{ unit = \"kPa\", strain = [0, 1, 1], values = [0, 1, 2] }"),
            at + ".strain.2: 1: must be above the number before it");
  EXPECT_EQ(curve("{ unit = \"kPa\", strain = [0, 1], values = [0, 1, 2] }"),
            at + ".values: [ 0, 1, 2 ]: 3 numbers, but strain has 2");
  EXPECT_EQ(curve("{ unit = \"kPa\", strain = [0, 1], values = [0, 0] }"),
            at + ".values: [ 0, 0 ]: pressure must rise: value 1 is not above the one before");
  EXPECT_EQ(curve("{ unit = \"kPa\", strain = [0.1, 1], values = [0, 1] }").substr(0, at.size()), at);
  EXPECT_EQ(curve("{ unit = \"kPa\", strain = [0, nan], values = [0, 1] }"),
            at + ".strain.1: nan: must be a finite number");
  EXPECT_THAT(curve("{ unit = \"kPa\", strain = [0, 1] }"), StartsWith(at + ".values: missing"));
  EXPECT_THAT(curve("{ unit = \"kPa\", strain = [0, 1], values = [0, 1], vaules = 1 }"),
              StartsWith(at + ".vaules: 1: unknown key; did you mean \"values\"?"));
  EXPECT_THAT(curve("3"), StartsWith(at + ": 3: a curve is needed"));
}

TEST(SceneMistakes, SleepOfAMaterialThatRecoversWithTime) {
  const auto with = [](const std::string& recovery, const std::string& tolerance) {
    return read_scene_text(
        good +
            "[materials.sbr.continuum]\nstrength_softening = { strain = 0.1, residual_cohesion = "
            "0.5 }\nstrength_recovery = { " +
            recovery + " }\n",
        "a.toml", {{"numerics.sleep_tolerance", tolerance}});
  };
  try {
    (void)with("time = \"2 s\"", "1e-4");
    ADD_FAILURE() << "was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("numerics.sleep_tolerance"), HasSubstr("sbr regains strength with time")));
  }
  EXPECT_NO_THROW((void)with("time = \"2 s\"", "0"));
  EXPECT_NO_THROW((void)with("compression = 0.1", "1e-4")) << "rest does not compress";
}

TEST(SceneMistakes, IndividualStepsThatAreNoPowerOfTwoOrMeetSleep) {
  const auto with = [](const Overrides& overrides) {
    try {
      (void)read_scene_text(good, "a.toml", overrides);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(with({{"numerics.individual_steps", "8"}}), "");
  EXPECT_EQ(with({{"numerics.individual_steps", "16"}}), "");
  EXPECT_THAT(with({{"numerics.individual_steps", "6"}}),
              HasSubstr("numerics.individual_steps: 6: give 1, 2, 4, 8 or 16"));
  EXPECT_THAT(with({{"numerics.individual_steps", "32"}}), HasSubstr("numerics.individual_steps"));
  EXPECT_EQ(with({{"numerics.individual_steps", "2"}, {"numerics.sleep_tolerance", "1e-4"}}), "");
}

TEST(SceneMistakes, PartsOfTheSoilLawGivenTwiceOrNotAtAll) {
  const auto own = [](const std::string& text) {
    return complaint(good + "[materials.sbr.continuum]\n" + text + "\n");
  };
  const std::string at = "a.toml:25: materials.sbr.continuum.";
  EXPECT_THAT(own("pressure_exponential = { modulus = \"1 MPa\", growth = 5 }"),
              AllOf(StartsWith(at + "pressure_exponential: "), HasSubstr("given twice")));
  EXPECT_THAT(own("unloading_ratio = 1.2"),
              AllOf(StartsWith(at + "unloading_ratio: 1.2: "), HasSubstr("given twice")));
  EXPECT_THAT(own("mohr_coulomb = { cohesion = \"5 kPa\", friction_angle = \"30 degree\" }"),
              AllOf(StartsWith(at + "mohr_coulomb: "), HasSubstr("strength is given twice")));
  EXPECT_THAT(own("mohr_coulomb = { cohesion = \"5 kPa\" }"),
              StartsWith(at + "mohr_coulomb.friction_angle: missing"));
  EXPECT_THAT(
      own("mohr_coulomb = { cohesion = \"5 kPa\", friction_angle = \"30 degree\", match = \"simple\" }"),
      HasSubstr("\"pure_shear\", \"plane_strain\" or \"triaxial_compression\" is needed"));
  EXPECT_THAT(own("strength_softening = { strain = 0.1, residual_friction = 0.0 }"),
              AllOf(HasSubstr("residual_friction: "), HasSubstr("above 0 and at most 1")));
  EXPECT_THAT(own("density_hardening = { modulus_exponent = -1.0 }"), HasSubstr("must be at least 0"));
  EXPECT_NO_THROW(
      (void)read_scene_text(good + "[materials.sbr.continuum]\n"
                                   "mohr_coulomb = { cohesion = \"5 kPa\", friction_angle = \"30 degree\" }\n"
                                   "yield_a0 = \"0 Pa^2\"\nyield_a2 = 0.0\n",
                            "a.toml"))
      << "0 where the file gives them";

  const std::string whole =
      "[materials.new.material]\nbulk_density = \"500 kg/m^3\"\n[materials.new.friction]\n"
      "fibre = { static = 0.4, dynamic = 0.4 }\nbody = { static = 0.4, dynamic = 0.4 }\n"
      "[materials.new.continuum]\n";
  EXPECT_THAT(complaint(good + whole + "unloading_ratio = 1.2\n"), HasSubstr("pressure: missing"));
  const std::string loading = "pressure_exponential = { modulus = \"1 MPa\", growth = 5 }\n";
  EXPECT_THAT(complaint(good + whole + loading), HasSubstr("unloading: missing"));
  EXPECT_THAT(complaint(good + whole + loading + "unloading_ratio = 0.8\n"), HasSubstr("at least 1"));
  EXPECT_NO_THROW((void)read_scene_text(good + whole + loading + "unloading_ratio = 1.2\n", "a.toml"));
}

TEST(SceneMistakes, MistakesInNamedFilesNameThatFile) {
  const ScratchFolder folder;
  std::filesystem::create_directories(folder / "materials");
  std::ifstream source("inputs/materials/sand.toml");
  std::string sand{std::istreambuf_iterator<char>(source), {}};
  sand.replace(sand.find("yield_a2"), 8, "yield_a7");
  std::ofstream(folder / "materials/sand.toml") << sand;
  std::ofstream(folder / "a.toml") << good;
  EXPECT_THAT(message_of<InputError>([&] { (void)read_scene(folder / "a.toml"); }),
              AllOf(StartsWith((folder / "materials/sand.toml").string() + ":"),
                    EndsWith("continuum.yield_a7: 0.1225: unknown key; did you mean \"yield_a0\"?")));
}

TEST(SceneMistakes, KeysOfAShellMaterialThatDoNotGoTogetherAreNamed) {
  const auto said = [](const Overrides& overrides) {
    return message_of<InputError>([&] { (void)read_scene("inputs/clegg_small.toml", overrides); });
  };
  EXPECT_THAT(
      said({{"turf.carpet.backing.across_young_modulus", "\"50 MPa\""}}),
      AllOf(HasSubstr("turf.carpet.backing.across_young_modulus"), HasSubstr("give shear_modulus too")));
  EXPECT_THAT(said({{"turf.carpet.backing.shear_modulus", "\"5 MPa\""}}),
              AllOf(HasSubstr("turf.carpet.backing.shear_modulus"), HasSubstr("across_young_modulus too")));
  EXPECT_THAT(said({{"turf.carpet.backing.across_young_modulus", "\"5 GPa\""},
                    {"turf.carpet.backing.shear_modulus", "\"5 MPa\""}}),
              AllOf(HasSubstr("turf.carpet.backing.poisson_ratio"), HasSubstr("under 0.5")));
  EXPECT_THAT(said({{"turf.carpet.fibre.relaxation", "[{ modulus = \"1 GPa\", decay = \"10 Hz\" }]"}}),
              AllOf(HasSubstr("turf.carpet.fibre.relaxation"), HasSubstr("add up to 1e+09 Pa")));
}

}  // namespace
}  // namespace tuft
