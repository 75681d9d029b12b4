// The carpets of inputs/turfs/: their numbers must not contradict each other, and meshes of the older ones
// stay.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/scene_reader.h"
#include "fe_carpet/carpet.h"
#include "tests/unit/fe_carpet/mesh_parts.h"

namespace tuft::fe::test {
namespace {

CarpetDesign read_design(const std::string& name) {
  return read_scene("inputs/clegg_small.toml", {{"turf.design", name}}).turf.carpet;
}

struct Preset {
  const char* name;
  Yarn yarn;
  double denier;       ///< g per 9000 m of yarn, that is of one leg
  double tufts;        ///< 1/m^2
  double pile_weight;  ///< kg/m^2 above the backing
  double stitches;     ///< per inch
  double gauge_inches;
};
constexpr Preset presets[] = {
    {"slit_film_nfl", Yarn::slit_film, 10000, 9300, 1.27, 3, 0.5},
    {"monofilament", Yarn::monofilament, 10800, 8680, 1.26, 3.5, 0.625},
};

/// kg/m of one leg's yarn.
double yarn_mass(const CarpetDesign& d) {
  return d.fibre.density * d.strand_width * d.strand_thickness * d.strands_per_tuft / d.legs_per_tuft;
}

TEST(Presets, HaveTheDenierOfTheirYarnWithinFivePercent) {
  for (const Preset& p : presets) {
    const CarpetDesign d = read_design(p.name);
    EXPECT_EQ(d.yarn, p.yarn);
    EXPECT_EQ(d.legs_per_tuft, 2);
    // Five percent: strands are whole, and their widths and thicknesses known to one digit after the point.
    EXPECT_NEAR(9000 * 1000 * yarn_mass(d) / p.denier, 1, 0.05) << p.name;
  }
}

TEST(Presets, HaveTheTuftsOfTheirGaugeAndStitchRateWithinHalfAPercent) {
  constexpr double inch = 0.0254;
  for (const Preset& p : presets) {
    const CarpetDesign d = read_design(p.name);
    EXPECT_NEAR(1 / (d.gauge * d.stitch_spacing) / p.tufts, 1, 0.005) << p.name;
    EXPECT_NEAR(inch / d.stitch_spacing / p.stitches, 1, 0.005) << p.name;
    EXPECT_NEAR(d.gauge / inch / p.gauge_inches, 1, 0.005) << p.name;
  }
}

TEST(Presets, WeighWhatTheirYarnAndTuftsSayWithinOnePercent) {
  for (const Preset& p : presets) {
    const CarpetDesign d = read_design(p.name);
    const double pile_weight = yarn_mass(d) * d.legs_per_tuft * d.pile_length / (d.gauge * d.stitch_spacing);
    EXPECT_NEAR(pile_weight / p.pile_weight, 1, 0.01) << p.name;
    // A patch of whole gauges and stitches holds exactly its share of tufts.
    const std::array<double, 2> size{20 * d.stitch_spacing, 14 * d.gauge};
    const ShellMesh mesh = generate_carpet(d, size, 1, true);
    double fibre = 0;
    for (std::size_t e = 0; e < mesh.quads.size(); ++e)
      if (mesh.surface[e] > 0) fibre += d.fibre.density * mesh.thickness[e] * area(mesh, e);
    EXPECT_NEAR(fibre / (size[0] * size[1]) / pile_weight, 1, 0.01) << p.name;
  }
}

TEST(Presets, AreSoundMeshes) {
  for (const Preset& p : presets)
    for (std::uint64_t seed = 1; seed <= 4; ++seed)
      EXPECT_NO_THROW(check_mesh(generate_carpet(read_design(p.name), {0.06, 0.06}, seed, true))) << p.name;
}

/// Sums over all nodes, each weighted by its number, so that an exchange shows as well as a move.
Vec3 fingerprint(const ShellMesh& mesh) {
  Vec3 sum(0, 0, 0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    sum += (1.0 + static_cast<double>(n % 7)) * mesh.nodes[n];
  return sum;
}

// Kept from the generator before tufts had legs. Positions agreed then bit for bit; the tolerance, 0.1 nm a
// node, is for other compilers' sines.
TEST(OlderDesigns, KeepTheirMeshes) {
  struct Kept {
    const char* name;
    std::uint64_t seed;
    std::size_t nodes, quads;
    Vec3 sum;
  };
  const Kept kept[] = {
      {"slit_film", 1, 28356, 14681, {-1.1115131746408318, 165.66674750734529, 3613.0954788257791}},
      {"slit_film", 7, 28356, 14681, {2.7674162386909029, 172.60378335182415, 3615.8254131487697}},
      {"slit_film_coarse", 1, 6782, 3660, {0.9608370791208134, 29.170592955101604, 830.95538991552928}},
      {"slit_film_coarse", 7, 6782, 3660, {-0.45882821949104668, 25.486579382200208, 829.69518422462806}},
  };
  for (const Kept& k : kept) {
    const ShellMesh mesh = generate_carpet(read_design(k.name), {0.08, 0.08}, k.seed, true);
    ASSERT_EQ(mesh.nodes.size(), k.nodes) << k.name;
    EXPECT_EQ(mesh.quads.size(), k.quads) << k.name;
    EXPECT_LT((fingerprint(mesh) - k.sum).norm(), 1e-10 * static_cast<double>(k.nodes)) << k.name;
  }
}

}  // namespace
}  // namespace tuft::fe::test
