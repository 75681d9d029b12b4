#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

Turf layered_turf(std::vector<Layer> layers) {
  Turf turf;
  turf.layers = std::move(layers);
  return turf;
}

TEST(Lattice, LayersFillTheirVolumeExactly) {
  const Turf turf = layered_turf({{2, 0.005}, {0, 0.022}, {1, 0.023}});
  const Lattice lattice = make_lattice(turf, {{0.0803, 0.061}, 0.0012}, 0.002);
  std::map<Index, double> volume;
  for (std::size_t i = 0; i < lattice.position.size(); ++i) volume[lattice.layer[i]] += lattice.volume[i];
  for (Index k = 0; k < 3; ++k)
    EXPECT_NEAR(volume[k], 0.0803 * 0.061 * turf.layers[static_cast<std::size_t>(k)].depth,
                1e-12 * volume[k]);
}

TEST(Lattice, BoundariesOfLayersFallMidwayBetweenRows) {
  const Turf turf =
      layered_turf({{0, 0.005}, {1, 0.0047}});  // 2.5 and 2.35 pitches: rows are stretched to fit
  const double floor = 0.003;
  const Lattice lattice = make_lattice(turf, {{0.01, 0.01}, floor}, 0.002);
  double top_of_lower = 0, bottom_of_upper = 1, lowest = 1, highest = 0;
  std::map<Index, double> spacing;
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    const double z = lattice.position.z[i], dz = lattice.volume[i] / (0.002 * 0.002);
    spacing[lattice.layer[i]] = dz;
    if (lattice.layer[i] == 0) top_of_lower = std::max(top_of_lower, z + dz / 2);
    if (lattice.layer[i] == 1) bottom_of_upper = std::min(bottom_of_upper, z - dz / 2);
    lowest = std::min(lowest, z - dz / 2);
    highest = std::max(highest, z + dz / 2);
  }
  EXPECT_NEAR(lowest, floor, 1e-15);
  EXPECT_NEAR(top_of_lower, floor + 0.005, 1e-15);
  EXPECT_NEAR(bottom_of_upper, floor + 0.005, 1e-15);
  EXPECT_NEAR(highest, floor + 0.0097, 1e-15);
  EXPECT_NEAR(spacing[0], 0.005 / 3, 1e-15);
  EXPECT_NEAR(spacing[1], 0.0047 / 2, 1e-15);
}

TEST(Lattice, ContactRadiiAreSuchThatABedJustTouchesItsTrayWhateverItsRows) {
  const Turf turf = layered_turf({{0, 0.005}, {1, 0.0047}});  // rows 1.25 and 1.175 pitches high
  const double width = 0.021, floor = 0.003;
  const Lattice lattice = make_lattice(turf, {{width, width}, floor}, 0.004);
  const ContactRadii radii = contact_radii(lattice);
  double lowest = 1, highest = 0, west = 1, east = -1;
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    west = std::min(west, lattice.position.x[i] - radii.radius[i]);
    east = std::max(east, lattice.position.x[i] + radii.radius[i]);
    lowest = std::min(lowest, lattice.position.z[i] - radii.half_height[i]);
    highest = std::max(highest, lattice.position.z[i] + radii.half_height[i]);
  }
  EXPECT_NEAR(west, -0.5 * width, 1e-15);
  EXPECT_NEAR(east, 0.5 * width, 1e-15);
  EXPECT_NEAR(lowest, floor, 1e-15);
  EXPECT_NEAR(highest, floor + 0.0097, 1e-15);
}

TEST(Lattice, ContactRadiiOfALatticeWithoutThemAreThoseOfCubes) {
  Lattice lattice;
  lattice.position.push_back({0, 0, 0});
  lattice.volume = {8e-9};
  const ContactRadii radii = contact_radii(lattice);
  EXPECT_DOUBLE_EQ(radii.radius.at(0), 1e-3);
  EXPECT_TRUE(radii.half_height.empty());
}

TEST(Lattice, FillsThePatchCentredOnTheOriginWithAWholeNumberOfColumns) {
  const Lattice lattice = make_lattice(layered_turf({{0, 0.004}}), {{0.0211, 0.0489}, 0}, 0.002);
  EXPECT_EQ(lattice.position.size(), 11u * 24u * 2u);
  double sum_x = 0, sum_y = 0, lowest_x = 1;
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    sum_x += lattice.position.x[i];
    sum_y += lattice.position.y[i];
    lowest_x = std::min(lowest_x, lattice.position.x[i]);
  }
  EXPECT_NEAR(sum_x, 0, 1e-15 * 528);
  EXPECT_NEAR(sum_y, 0, 1e-15 * 528);
  EXPECT_NEAR(lowest_x, -0.0211 / 2 + 0.0211 / 11 / 2, 1e-15);
}

TEST(Lattice, OfSeveralLayersHasGroupsOfEightThatLieTwoByFourInOneRow) {
  constexpr double pitch = 0.002;
  const auto compact_groups = [](double width) {
    const Lattice lattice = make_lattice(layered_turf({{0, 0.004}, {1, 0.006}}), {{width, width}, 0}, pitch);
    const auto span = [&](const std::vector<double>& along, std::size_t first) {
      const auto begin = along.begin() + static_cast<std::ptrdiff_t>(first);
      const auto [low, high] = std::minmax_element(begin, begin + 8);
      return std::lround((*high - *low) / pitch) + 1;
    };
    std::size_t compact = 0;
    const std::size_t groups = lattice.position.size() / 8;
    for (std::size_t g = 0; g < groups; ++g) {
      const auto [short_side, long_side] =
          std::minmax({span(lattice.position.x, 8 * g), span(lattice.position.y, 8 * g)});
      compact += span(lattice.position.z, 8 * g) == 1 && short_side <= 2 && long_side <= 4;
    }
    return static_cast<double>(compact) / static_cast<double>(groups);
  };
  EXPECT_EQ(compact_groups(0.032), 1) << "one tile";
  EXPECT_GT(compact_groups(0.084), 0.99)
      << "tiles of ten columns: a group in one corner goes on in the next row";
  EXPECT_GT(compact_groups(0.078), 0.9) << "tiles of seven: so does one in most rows";
}

TEST(Lattice, KeepsMaterialsOfLayers) {
  const Lattice lattice = make_lattice(layered_turf({{2, 0.004}, {0, 0.004}}), {{0.01, 0.01}, 0}, 0.002);
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    EXPECT_EQ(lattice.layer[i], lattice.position.z[i] < 0.004 ? 0 : 1);
    EXPECT_EQ(lattice.material[i], lattice.position.z[i] < 0.004 ? 2 : 0);
  }
}

void expect_input_error(const Turf& turf, const LatticeBox& box, double pitch, const std::string& words) {
  try {
    (void)make_lattice(turf, box, pitch);
    FAIL() << "no error for " << words;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Lattice, RejectsWhatItCannotFill) {
  const Turf thin = layered_turf({{0, 0.004}, {1, 0.0009}});
  expect_input_error(thin, {{0.1, 0.1}, 0}, 0.002, "turf.layers[1]: depth 0.0009 m is less than half");
  const Turf good = layered_turf({{0, 0.004}});
  expect_input_error(good, {{0.1, 0.001}, 0}, 0.002, "a side of 0.001 m");
  expect_input_error(good, {{0.1, 0.1}, 0}, 0, "infill.sph.pitch is 0 m");
  expect_input_error(layered_turf({}), {{0.1, 0.1}, 0}, 0.002, "turf.layers is empty");
}

}  // namespace
}  // namespace tuft::sph
