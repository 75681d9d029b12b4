#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_parts.h"

namespace tuft::fe::test {
namespace {

CarpetDesign football() {
  CarpetDesign d;
  d.gauge = 0.0095;
  d.stitch_spacing = 0.010;
  d.strands_per_tuft = 8;
  d.pile_length = 0.063;
  d.strand_width = 0.0013;
  d.strand_thickness = 0.0001;
  d.lean = 0.15;
  d.fan_out = 0.15;
  d.element_length = 0.003;
  d.backing_thickness = 0.0012;
  d.backing_element = 0.005;
  return d;
}

constexpr std::array<double, 2> patch{0.08, 0.06};
constexpr int tufts_along_x = 8, tufts_along_y = 6;  // floor(80/10), floor(60/9.5)

TEST(Generator, GivesASoundMesh) {
  EXPECT_NO_THROW(check_mesh(generate_carpet(football(), patch, 1, true)));
}

TEST(Generator, TheSameSeedGivesTheSameMeshAndAnotherSeedAnother) {
  const ShellMesh a = generate_carpet(football(), patch, 42, true),
                  b = generate_carpet(football(), patch, 42, true);
  EXPECT_EQ(a.nodes.x, b.nodes.x);
  EXPECT_EQ(a.nodes.y, b.nodes.y);
  EXPECT_EQ(a.nodes.z, b.nodes.z);
  EXPECT_EQ(a.quads, b.quads);
  const ShellMesh c = generate_carpet(football(), patch, 43, true);
  EXPECT_NE(a.nodes.y, c.nodes.y);
  EXPECT_EQ(a.quads, c.quads);
}

TEST(Generator, HasAsManyStrandsAndElementsAsTheDesignSays) {
  const ShellMesh mesh = generate_carpet(football(), patch, 1, true);
  const int strands = tufts_along_x * tufts_along_y * football().strands_per_tuft;
  EXPECT_EQ(mesh.surface_count, strands + 1);
  std::map<Index, int> elements;
  for (const Index surface : mesh.surface) ++elements[surface];
  ASSERT_EQ(elements.size(), static_cast<std::size_t>(strands + 1));
  for (const auto& [surface, count] : elements)
    if (surface > 0) {
      EXPECT_EQ(count, 21) << surface;
    }
}

TEST(Generator, StrandsOfATuftShareTwoRootNodesWithTheBacking) {
  const ShellMesh mesh = generate_carpet(football(), patch, 1, true);
  std::set<Index> backing;
  std::map<Index, std::set<Index>> strands;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (const Index n : mesh.quads[e]) {
      if (mesh.surface[e] == 0)
        backing.insert(n);
      else
        strands[mesh.surface[e]].insert(n);
    }
  std::map<std::set<Index>, int> strands_at;
  for (const auto& [surface, nodes] : strands) {
    std::set<Index> shared;
    for (const Index n : nodes)
      if (backing.contains(n)) shared.insert(n);
    ASSERT_EQ(shared.size(), 2U) << surface;
    const Vec3 edge = mesh.nodes[static_cast<std::size_t>(*shared.rbegin())] -
                      mesh.nodes[static_cast<std::size_t>(*shared.begin())];
    EXPECT_NEAR(std::abs(edge.x()), football().strand_width, 1e-12);
    EXPECT_NEAR(edge.y(), 0, 1e-12);
    ++strands_at[shared];
  }
  EXPECT_EQ(strands_at.size(), static_cast<std::size_t>(tufts_along_x * tufts_along_y));
  for (const auto& [root, count] : strands_at) EXPECT_EQ(count, football().strands_per_tuft);
}

TEST(Generator, AreasAreThoseOfTheDesign) {
  const ShellMesh mesh = generate_carpet(football(), patch, 1, true);
  std::map<Index, double> areas;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) areas[mesh.surface[e]] += area(mesh, e);
  EXPECT_NEAR(areas[0], patch[0] * patch[1], 1e-12);
  for (const auto& [surface, value] : areas)
    if (surface > 0) {
      EXPECT_NEAR(value / (football().pile_length * football().strand_width), 1, 0.01) << surface;
    }
}

TEST(Generator, WeighsWhatTheDesignSays) {
  const CarpetDesign d = football();
  const Carpet carpet(generate_carpet(d, patch, 1, true), {{0.2e9, 0.3, 900}, {0.5e9, 0.4, 920}}, {});
  double mass = 0;
  for (const double m : carpet.nodes().mass) mass += m;
  const double strands = tufts_along_x * tufts_along_y * d.strands_per_tuft;
  const double expected = 900 * patch[0] * patch[1] * d.backing_thickness +
                          920 * strands * d.pile_length * d.strand_width * d.strand_thickness;
  EXPECT_NEAR(mass / expected, 1, 0.005);
}

TEST(Generator, ElementsAreWellShaped) {
  const CarpetDesign d = football();
  const ShellMesh mesh = generate_carpet(d, patch, 1, true);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (mesh.surface[e] == 0) continue;
    const Vec3 normal =
        (corner(mesh, e, 2) - corner(mesh, e, 0)).cross(corner(mesh, e, 3) - corner(mesh, e, 1)).normalized();
    for (std::size_t i = 0; i < 4; ++i) {
      const Vec3 forward = corner(mesh, e, (i + 1) % 4) - corner(mesh, e, i);
      const Vec3 backward = corner(mesh, e, (i + 3) % 4) - corner(mesh, e, i);
      // Sine of the corner's angle seen along the normal: 1 is a rectangle.
      EXPECT_GT(forward.cross(backward).dot(normal) / forward.norm() / backward.norm(), 0.9)
          << "element " << e;
      const double wanted = i % 2 == 0 ? d.strand_width : d.pile_length / 21;
      EXPECT_NEAR(forward.norm() / wanted, 1, 0.06) << "element " << e;
    }
  }
}

TEST(Generator, KeepsEverythingInsideThePatchAndAboveTheBacking) {
  CarpetDesign d = football();
  d.lean = 0.5;
  d.fan_out = 0.4;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const ShellMesh mesh = generate_carpet(d, patch, seed, true);
    for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
      if (mesh.surface[e] == 0) continue;
      for (std::size_t i = 0; i < 4; ++i) {
        const Vec3 p = corner(mesh, e, i);
        EXPECT_LE(std::abs(p.x()), patch[0] / 2 - d.strand_width + 1e-12);
        EXPECT_LE(std::abs(p.y()), patch[1] / 2 - d.strand_width + 1e-12);
        EXPECT_GE(p.z(), d.backing_thickness / 2 * (1 - 1e-12));
        if (i >= 2) {
          EXPECT_GT(p.z(), d.backing_thickness / 2);
        }
      }
    }
  }
}

/// Directions from root to tip of all strands.
std::vector<Vec3> directions(const ShellMesh& mesh) {
  std::map<Index, std::pair<Vec3, Vec3>> ends;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (mesh.surface[e] == 0) continue;
    const Vec3 low = 0.5 * (corner(mesh, e, 0) + corner(mesh, e, 1)),
               high = 0.5 * (corner(mesh, e, 2) + corner(mesh, e, 3));
    ends.try_emplace(mesh.surface[e], low, high).first->second.second = high;
  }
  std::vector<Vec3> result;
  result.reserve(ends.size());
  for (const auto& [surface, end] : ends) result.push_back((end.second - end.first).normalized());
  return result;
}

TEST(Generator, TiltsHaveTheMeanAndDeviationAskedFor) {
  CarpetDesign d = football();
  d.lean = 0.1;
  d.pile_length = 0.012;  // short against the patch: walls bend few strands
  double mean_y = 0, mean_x = 0, square_y = 0, square_x = 0, count = 0;
  for (const Vec3& t : directions(generate_carpet(d, {0.3, 0.3}, 5, true))) {
    const double forward = std::atan2(t.y(), t.z()), sideways = std::asin(t.x());
    mean_y += forward;
    mean_x += sideways;
    square_y += forward * forward;
    square_x += sideways * sideways;
    ++count;
  }
  mean_y /= count;
  mean_x /= count;
  EXPECT_NEAR(mean_y, d.lean, 0.02);
  EXPECT_NEAR(mean_x, 0, 0.01);
  EXPECT_NEAR(std::sqrt(square_y / count - mean_y * mean_y), d.fan_out, 0.03);
  EXPECT_NEAR(std::sqrt(square_x / count - mean_x * mean_x), d.fan_out, 0.03);
}

TEST(Generator, StrandsOfATuftDoNotCoincideEvenWithoutFanOut) {
  for (const double fan_out : {0.0, 0.15}) {
    CarpetDesign d = football();
    d.fan_out = fan_out;
    const ShellMesh mesh = generate_carpet(d, patch, 1, true);
    std::map<std::set<Index>, std::vector<Vec3>>
        first_rows;  // by root edge: where the strands' first elements end
    for (std::size_t e = 1; e < mesh.quads.size(); ++e)
      if (mesh.surface[e] > 0 && mesh.surface[e] != mesh.surface[e - 1])
        first_rows[{mesh.quads[e][0], mesh.quads[e][1]}].push_back(0.5 *
                                                                   (corner(mesh, e, 2) + corner(mesh, e, 3)));
    for (const auto& [root, ends] : first_rows)
      for (std::size_t i = 0; i < ends.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GT((ends[i] - ends[j]).norm(), 0.2 * d.strand_thickness);
  }
}

TEST(Generator, BackingIsTheSameWithAndWithoutFibresAndClampedAtItsEdge) {
  const ShellMesh bare = generate_carpet(football(), patch, 1, false),
                  full = generate_carpet(football(), patch, 1, true);
  EXPECT_EQ(bare.surface_count, 1);
  for (std::size_t n = 0; n < bare.nodes.size(); ++n) {
    EXPECT_EQ(bare.nodes[n], full.nodes[n]);
    EXPECT_EQ(bare.nodes.z[n], football().backing_thickness / 2);
    const bool edge = std::abs(std::abs(bare.nodes.x[n]) - patch[0] / 2) < 1e-12 ||
                      std::abs(std::abs(bare.nodes.y[n]) - patch[1] / 2) < 1e-12;
    EXPECT_EQ(bare.clamped[n] != 0, edge) << n;
  }
  for (std::size_t n = bare.nodes.size(); n < full.nodes.size(); ++n) EXPECT_EQ(full.clamped[n], 0);
}

TEST(Generator, BackingSidesAreNoLongerThanAskedFor) {
  const ShellMesh mesh = generate_carpet(football(), patch, 1, false);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (std::size_t i = 0; i < 4; ++i)
      EXPECT_LE((corner(mesh, e, (i + 1) % 4) - corner(mesh, e, i)).norm(),
                football().backing_element * (1 + 1e-9));
}

TEST(Generator, BuildsThePatchOfTheClegg) {
  const ShellMesh mesh = generate_carpet(football(), {0.232, 0.232}, 1, true);
  EXPECT_EQ(mesh.surface_count, 23 * 24 * 8 + 1);
}

TEST(Generator, NamesWhatIsUnusable) {
  const auto rejected = [](auto&& change, std::initializer_list<const char*> words) {
    CarpetDesign d = football();
    change(d);
    expect_error<InputError>([&] { (void)generate_carpet(d, patch, 1, true); }, words);
  };
  rejected([](CarpetDesign& d) { d.gauge = 0; }, {"gauge is 0"});
  rejected([](CarpetDesign& d) { d.pile_length = std::nan(""); }, {"pile_length is nan"});
  rejected([](CarpetDesign& d) { d.strands_per_tuft = 0; }, {"strands_per_tuft is 0"});
  rejected([](CarpetDesign& d) { d.element_length = -1; }, {"element_length is -1"});
  rejected([](CarpetDesign& d) { d.stitch_spacing = 0.0015; }, {"stitch_spacing", "strand width"});
  rejected([](CarpetDesign& d) { d.lean = 1.5; }, {"lean is 1.5"});
  rejected([](CarpetDesign& d) { d.gauge = 0.07; }, {"holds no tuft", "gauge of 0.07"});
}

}  // namespace
}  // namespace tuft::fe::test
