// The files in inputs/: they read, come back bit for bit, and their curves are what their comments say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/point_test.h"
#include "core/scene_reader.h"
#include "scratch_folder.h"

namespace tuft {
namespace {

namespace fs = std::filesystem;

/// Files of inputs/: tests of a point by their name, or scenes.
std::vector<fs::path> files(bool of_points) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::directory_iterator("inputs"))
    if (entry.path().extension() == ".toml" &&
        entry.path().filename().string().starts_with("point_") == of_points)
      found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}
std::vector<fs::path> scenes() {
  return files(false);
}

TEST(Inputs, EverySceneReadsWithBothApproaches) {
  ASSERT_GE(scenes().size(), 2u);
  for (const fs::path& file : scenes()) {
    const Rig rig = read_scene(file).rig;
    if (rig.is_component() || rig.is_specimen()) continue;  // no infill, or none of grains, to choose
    for (const std::string approach : {"sph", "dem"})
      EXPECT_NO_THROW((void)read_scene(file, {{"infill.approach", approach}})) << file << " " << approach;
  }
}

TEST(Inputs, EverySceneComesBackBitForBitFromItsResolvedText) {
  for (const fs::path& file : scenes()) {
    const Scene scene = read_scene(file);
    const std::string text = write_scene(scene);
    const Scene again = read_scene_text(text, "/nowhere/scene.toml");
    EXPECT_EQ(write_scene(again), text) << file;
    // The text holds doubles in full: spot checks that it is not the text alone that agrees.
    EXPECT_EQ(again.infill.sph.smoothing_length, scene.infill.sph.smoothing_length);
    EXPECT_EQ(again.turf.carpet.lean, scene.turf.carpet.lean);
    EXPECT_EQ(again.turf.carpet.fibre.young_modulus, scene.turf.carpet.fibre.young_modulus);
    EXPECT_EQ(again.turf.design, scene.turf.design);
    ASSERT_EQ(again.materials.size(), scene.materials.size());
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
      EXPECT_EQ(again.materials[i].name, scene.materials[i].name);
      EXPECT_EQ(again.materials[i].file, scene.materials[i].file);
      ASSERT_EQ(again.materials[i].continuum.has_value(), scene.materials[i].continuum.has_value());
      EXPECT_EQ(again.materials[i].continuum->pressure.x, scene.materials[i].continuum->pressure.x);
      EXPECT_EQ(again.materials[i].continuum->pressure.y, scene.materials[i].continuum->pressure.y);
      EXPECT_EQ(again.materials[i].continuum->unloading.y, scene.materials[i].continuum->unloading.y);
      EXPECT_EQ(again.materials[i].grain_shares.size(), scene.materials[i].grain_shares.size());
    }
  }
}

TEST(Inputs, EveryPointTestComesBackFromItsResolvedText) {
  ASSERT_EQ(files(true).size(), 3u);
  const test::ScratchFolder folder;
  for (const fs::path& file : files(true)) {
    const PointTest test = read_point_test(file);
    const std::string text = write_point_test(test);
    std::ofstream(folder.path() / "point.toml") << text;
    const PointTest again = read_point_test(folder.path() / "point.toml");
    EXPECT_EQ(write_point_test(again), text) << file;
    EXPECT_EQ(again.segments.size(), test.segments.size());
    EXPECT_EQ(again.tested().continuum->density_hardening->modulus_exponent,
              test.tested().continuum->density_hardening->modulus_exponent);
  }
}

TEST(Inputs, AwkwardValuesComeBackToo) {
  const Scene scene = read_scene("inputs/clegg_small.toml", {{"scene.name", "a \"quoted\"\tname\\"},
                                                             {"infill.sph.pitch", "3.3333333333333335 mm"},
                                                             {"numerics.seed", "9007199254740993"},
                                                             {"output.histories", "1e-7 s"},
                                                             {"effects.friction_rate", "false"}});
  const Scene again = read_scene_text(write_scene(scene), "b.toml");
  EXPECT_EQ(again.info.name, scene.info.name);
  EXPECT_EQ(again.infill.sph.pitch, scene.infill.sph.pitch);
  EXPECT_EQ(again.numerics.seed, 9007199254740993u);
  EXPECT_EQ(again.output.histories, 1e-7);
  EXPECT_EQ(again.effects.choice.at("friction_rate"), Switch::off);
}

TEST(Inputs, ARelaxingFibreComesBackFromItsResolvedText) {
  const Scene scene = read_scene("inputs/clegg_small.toml", {{"turf.design", "slit_film_nfl"}});
  const CarpetDesign &c = scene.turf.carpet,
                     again = read_scene_text(write_scene(scene), "b.toml").turf.carpet;
  ASSERT_EQ(again.fibre.relaxation.size(), c.fibre.relaxation.size());
  for (std::size_t i = 0; i < c.fibre.relaxation.size(); ++i) {
    EXPECT_EQ(again.fibre.relaxation[i].modulus, c.fibre.relaxation[i].modulus);
    EXPECT_EQ(again.fibre.relaxation[i].decay, c.fibre.relaxation[i].decay);
  }
  EXPECT_EQ(again.fibre_section.element, c.fibre_section.element);
  EXPECT_EQ(again.fibre_section.thickness_points, c.fibre_section.thickness_points);
}

TEST(Inputs, EveryDesignReads) {
  for (const auto& entry : fs::directory_iterator("inputs/turfs")) {
    const std::string name = entry.path().stem().string();
    const Scene scene = read_scene("inputs/clegg_small.toml", {{"turf.design", name}});
    EXPECT_EQ(scene.turf.design, name);
  }
}

TEST(Inputs, CoarsenedCarpetHasTheSameCrossSectionPerTuft) {
  const CarpetDesign fine = read_scene("inputs/clegg_paper.toml").turf.carpet;
  const CarpetDesign coarse = read_scene("inputs/clegg_small.toml").turf.carpet;
  const auto section = [](const CarpetDesign& c) {
    return c.strands_per_tuft * c.strand_width * c.strand_thickness;
  };
  EXPECT_NEAR(section(coarse), section(fine), 1e-12 * section(fine));
  EXPECT_EQ(coarse.gauge, fine.gauge);
  EXPECT_EQ(coarse.stitch_spacing, fine.stitch_spacing);
  EXPECT_EQ(coarse.pile_length, fine.pile_length);
  // Elastic, of what has not relaxed within a few ms.
  double shear = fine.fibre.young_modulus / (2 * (1 + fine.fibre.poisson_ratio));
  for (const PronyTerm& term : fine.fibre.relaxation)
    if (term.decay > 100) shear -= term.modulus;
  EXPECT_NEAR(coarse.fibre.young_modulus / (2 * (1 + fine.fibre.poisson_ratio) * shear), 1, 1e-3);
}

TEST(Inputs, FibresOfSlitFilmHaveThePublishedRelaxation) {
  for (const std::string design : {"slit_film", "slit_film_nfl"}) {
    const CarpetDesign c = read_scene("inputs/clegg_small.toml", {{"turf.design", design}}).turf.carpet;
    ASSERT_EQ(c.fibre.relaxation.size(), 2U) << design;
    double long_term = c.fibre.young_modulus / (2 * (1 + c.fibre.poisson_ratio));
    for (const PronyTerm& term : c.fibre.relaxation) long_term -= term.modulus;
    EXPECT_NEAR(long_term, 0.061e9, 1e3) << design;
    EXPECT_EQ(c.fibre_section.element, ElementKind::fully_integrated) << design;
    EXPECT_EQ(c.fibre_section.thickness_points, 3) << design;
  }
}

double interpolate(const Curve& curve, double x) {
  std::size_t i = 1;
  while (i + 1 < curve.x.size() && x > curve.x[i]) ++i;
  return curve.y[i - 1] +
         (curve.y[i] - curve.y[i - 1]) * (x - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
}

struct ClosedForm {
  const char* material;
  double k0, b;  // Pa, -
};
constexpr ClosedForm closed_forms[] = {{"sand", 10e6, 60}, {"mixture", 1.5e6, 10}, {"sbr", 0.4e6, 6}};

TEST(Inputs, VirginCurvesMatchTheirClosedFormWithinOnePercent) {
  const Scene scene = read_scene("inputs/clegg_small.toml");
  for (const ClosedForm& form : closed_forms) {
    const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                    [&](const Material& m) { return m.name == form.material; });
    ASSERT_NE(found, scene.materials.end());
    const Curve& curve = found->continuum->pressure;
    EXPECT_GE(curve.y.back(), 3e6) << form.material;
    for (int k = 1; k <= 4000; ++k) {
      const double strain = curve.x.back() * k / 4000.0;
      const double exact = form.k0 / form.b * std::expm1(form.b * strain);
      ASSERT_NEAR(interpolate(curve, strain), exact, 0.01 * exact) << form.material << " at " << strain;
    }
  }
}

TEST(Inputs, UnloadingIsStifferThanLoadingAtEveryPressure) {
  // Else a cycle would create energy.
  const Scene scene = read_scene("inputs/clegg_small.toml");
  for (const Material& material : scene.materials) {
    const Curve& virgin = material.continuum->pressure;
    for (std::size_t i = 1; i < virgin.x.size(); ++i) {
      const double tangent = (virgin.y[i] - virgin.y[i - 1]) / (virgin.x[i] - virgin.x[i - 1]);
      EXPECT_GT(interpolate(material.continuum->unloading, virgin.y[i - 1]), tangent)
          << material.name << " " << i;
    }
  }
}

TEST(Inputs, EveryNumberHasAProvenance) {
  // Each line with a number belongs to a block of lines under a comment with one of the words, or to a file
  // that says for all of its lines where its numbers come from.
  const std::vector<std::string> words{"ublished",  "erived",   "iterature", "ssumed",
                                       "alibrated", "oarsened", "easured"};
  const auto has_word = [&](const std::string& line) {
    return std::any_of(words.begin(), words.end(),
                       [&](const auto& w) { return line.find(w) != std::string::npos; });
  };
  for (const auto& entry : fs::recursive_directory_iterator("inputs")) {
    if (entry.path().extension() != ".toml") continue;
    std::ifstream file(entry.path());
    bool covered = false, whole_file = false, in_comment = false;
    int number = 0;
    for (std::string line; std::getline(file, line);) {
      ++number;
      if (line.find("with its provenance there") != std::string::npos) whole_file = true;
      if (line.starts_with("#")) {
        covered = (in_comment && covered) || has_word(line);
        in_comment = true;
        continue;
      }
      in_comment = false;
      const std::size_t equals = line.find('=');
      if (equals == std::string::npos || line.find_first_of("0123456789", equals) == std::string::npos)
        continue;
      EXPECT_TRUE(covered || whole_file) << entry.path() << ":" << number << ": " << line;
    }
  }
}

TEST(SceneReference, ListsEveryKeyWithItsMeaning) {
  const std::string reference = scene_reference();
  for (const char* key :
       {"| `turf.layers[].depth` | m | required | above 0 |", "| `infill.sph.pitch` | m | 0.002 m |",
        "| `effects.fibres` |", "| `continuum.yield_a0` | Pa^2 |", "| `turf.carpet.fibre.density` |"})
    EXPECT_THAT(reference, testing::HasSubstr(key));
  EXPECT_THAT(reference, testing::Not(testing::HasSubstr("|  |\n"))) << "a key without a meaning";
}

TEST(ContentHash, IsFnv1a) {
  // Published test vectors (Fowler, Noll, Vo).
  EXPECT_EQ(content_hash(""), "cbf29ce484222325");
  EXPECT_EQ(content_hash("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(content_hash("foobar"), "85944171f73967e8");
}

}  // namespace
}  // namespace tuft
