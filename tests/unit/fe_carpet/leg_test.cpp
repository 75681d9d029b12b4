// Tufts as they are stitched: two legs, tapes that split, filaments, curl, scatter of length.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "fe_carpet/leg_shape.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/unit/fe_carpet/mesh_parts.h"

namespace tuft::fe::test {
namespace {

constexpr std::array<double, 2> patch{0.06, 0.06};

CarpetDesign slit_film() {
  CarpetDesign d;
  d.yarn = Yarn::slit_film;
  d.gauge = 0.0127;
  d.stitch_spacing = 0.0085;
  d.legs_per_tuft = 2;
  d.leg_spacing = 0.0021;
  d.leg_width = 0.006;
  d.strands_per_tuft = 12;
  d.pile_length = 0.06;
  d.unsplit_length = 0.015;
  d.strand_width = 0.0013;
  d.strand_thickness = 0.0001;
  d.lean = 0.1;
  d.fan_out = 0.15;
  d.curl = 0.8;
  d.length_scatter = 0.05;
  d.element_length = 0.003;
  d.backing_thickness = 0.002;
  d.backing_element = 0.003;
  return d;
}

CarpetDesign monofilament() {
  CarpetDesign d = slit_film();
  d.yarn = Yarn::monofilament;
  d.unsplit_length = 0;
  return d;
}

TEST(Legs, AreTwoATuftAtBothEndsOfTheStitch) {
  for (const CarpetDesign& d : {slit_film(), monofilament()}) {
    const RootLayout layout = root_layout(d);
    ASSERT_EQ(layout.legs, 2);
    const ShellMesh mesh = generate_carpet(d, patch, 1, true);
    const std::set<Index> backing = nodes_of_backing(mesh);
    // Roots of the first tuft: two groups of seven nodes, leg_spacing apart along the row, leg_width across
    // it.
    const int surfaces_per_leg = 6 + (d.unsplit_length > 0 ? 1 : 0);
    std::array<std::set<Index>, 2> roots;
    for (std::size_t e = 0; e < mesh.quads.size(); ++e)
      if (mesh.surface[e] > 0 && mesh.surface[e] <= 2 * surfaces_per_leg)
        for (const Index n : mesh.quads[e])
          if (backing.contains(n))
            roots[static_cast<std::size_t>((mesh.surface[e] - 1) / surfaces_per_leg)].insert(n);
    std::array<Box, 2> box{bounding_box(mesh, roots[0]), bounding_box(mesh, roots[1])};
    for (int leg = 0; leg < 2; ++leg) {
      EXPECT_EQ(roots[leg].size(), 7U);
      EXPECT_NEAR(box[leg].high.y() - box[leg].low.y(), d.leg_width, 1e-12);
    }
    EXPECT_NEAR(box[1].low.x() - box[0].low.x(), d.leg_spacing, 1e-12);
    EXPECT_GT(box[1].low.x() - box[0].high.x(), 0.25 * d.strand_width) << "legs must not start on each other";
  }
}

TEST(Legs, StandAQuarterOfTheStitchApartUnlessAskedOtherwise) {
  CarpetDesign d = slit_film();
  d.leg_spacing = 0;
  EXPECT_NEAR(root_layout(d).spacing, 0.25 * d.stitch_spacing, 1e-15);
}

TEST(Legs, AreFlatWithoutALegWidth) {
  CarpetDesign d = slit_film();
  d.leg_width = 0;
  EXPECT_EQ(root_layout(d).depth, 0);
  EXPECT_NEAR(root_layout(d).width(), 6 * d.strand_width, 1e-15);
  EXPECT_NO_THROW(check_mesh(generate_carpet(d, patch, 1, true)));
}

TEST(Tape, IsOneConnectedSurfaceAsWideAsItsStrandsThatSplitsIntoOneSurfaceEach) {
  const CarpetDesign d = slit_film();
  const ShellMesh mesh = generate_carpet(d, patch, 1, true);
  const std::set<Index> backing = nodes_of_backing(mesh);
  constexpr int strands = 6, tape_elements = 5;
  ASSERT_EQ((mesh.surface_count - 1) % (strands + 1), 0);
  const std::map<Index, std::set<Index>> nodes = nodes_by_surface(mesh);
  std::map<Index, double> areas;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) areas[mesh.surface[e]] += area(mesh, e);
  for (Index tape = 1; tape < mesh.surface_count; tape += strands + 1) {
    EXPECT_EQ(nodes.at(tape).size(), static_cast<std::size_t>((strands + 1) * (tape_elements + 1)));
    EXPECT_NEAR(areas[tape] / (d.unsplit_length * strands * d.strand_width), 1, 0.02);
    EXPECT_EQ(shared(nodes.at(tape), backing).size(), static_cast<std::size_t>(strands + 1));
    for (Index s = tape + 1; s <= tape + strands; ++s) {
      EXPECT_EQ(shared(nodes.at(s), nodes.at(tape)).size(), 2U) << "a strand goes on from the tape's edge";
      EXPECT_TRUE(shared(nodes.at(s), backing).empty());
      if (s > tape + 1) {  // split: neighbours share the node where the slit begins and no other
        EXPECT_EQ(shared(nodes.at(s), nodes.at(s - 1)).size(), 1U);
      }
    }
  }
}

TEST(Filaments, AreSeparateFromTheRootAndTouchThereSideBySide) {
  const CarpetDesign d = monofilament();
  const ShellMesh mesh = generate_carpet(d, patch, 1, true);
  const std::set<Index> backing = nodes_of_backing(mesh);
  const std::map<Index, std::set<Index>> nodes = nodes_by_surface(mesh);
  ASSERT_EQ((mesh.surface_count - 1) % d.strands_per_tuft, 0);
  for (Index s = 1; s < mesh.surface_count; ++s) {
    const std::set<Index> root = shared(nodes.at(s), backing);
    ASSERT_EQ(root.size(), 2U);
    EXPECT_NEAR((node(mesh, *root.begin()) - node(mesh, *root.rbegin())).norm(), d.strand_width, 1e-12);
    if ((s - 1) % 6 == 0) continue;
    const std::set<Index> common = shared(nodes.at(s), nodes.at(s - 1));
    ASSERT_EQ(common.size(), 1U);
    EXPECT_TRUE(backing.contains(*common.begin()));
    // Side by side: across the row one ends where the next begins.
    const Box box = bounding_box(mesh, root), before = bounding_box(mesh, shared(nodes.at(s - 1), backing));
    EXPECT_NEAR(box.low.y(), before.high.y(), 1e-12);
  }
}

TEST(Legs, OfTheSameSeedAreTheSameAndOfAnotherSeedOthers) {
  for (const CarpetDesign& d : {slit_film(), monofilament()}) {
    const ShellMesh a = generate_carpet(d, patch, 42, true), b = generate_carpet(d, patch, 42, true),
                    c = generate_carpet(d, patch, 43, true);
    EXPECT_EQ(a.nodes.x, b.nodes.x);
    EXPECT_EQ(a.nodes.y, b.nodes.y);
    EXPECT_EQ(a.nodes.z, b.nodes.z);
    EXPECT_EQ(a.quads, b.quads);
    EXPECT_NE(a.nodes.x, c.nodes.x);
  }
}

TEST(Legs, AreSoundMeshesInsideThePatchOverManySeedsEvenWhenWild) {
  for (CarpetDesign d : {slit_film(), monofilament()})
    for (const bool wild : {false, true}) {
      if (wild) d.lean = 0.5, d.fan_out = 0.4, d.curl = 2, d.length_scatter = 0.15;
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const ShellMesh mesh = generate_carpet(d, patch, seed, true);
        ASSERT_NO_THROW(check_mesh(mesh)) << seed;
        for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
          if (mesh.surface[e] == 0) continue;
          const Vec3 normal = normal_of(mesh, e);
          for (std::size_t i = 0; i < 4; ++i) {
            const Vec3 p = corner(mesh, e, i), forward = corner(mesh, e, (i + 1) % 4) - p,
                       backward = corner(mesh, e, (i + 3) % 4) - p;
            // Sine of the corner's angle: 1 is a rectangle, 0 degenerate, negative turned over.
            ASSERT_GT(forward.cross(backward).dot(normal) / forward.norm() / backward.norm(),
                      wild ? 0.75 : 0.9)
                << "seed " << seed << ", element " << e;
            if (i % 2 == 0) {
              ASSERT_NEAR(forward.norm() / d.strand_width, 1, 1e-3) << "seed " << seed << ", element " << e;
            } else {
              ASSERT_NEAR(forward.norm() / d.element_length, 1, wild ? 0.25 : 0.15)
                  << "seed " << seed << ", element " << e;
            }
            ASSERT_LE(std::abs(p.x()), patch[0] / 2 - d.strand_width + 1e-12);
            ASSERT_LE(std::abs(p.y()), patch[1] / 2 - d.strand_width + 1e-12);
            ASSERT_GE(p.z(), d.backing_thickness / 2 * (1 - 1e-12));
          }
        }
      }
    }
}

TEST(Scatter, OfLengthHasTheMeanAndDeviationAskedForAndIsCutOffAtTwoDeviations) {
  CarpetDesign d = monofilament();
  d.length_scatter = 0.1;
  d.pile_length = 0.012;  // short: many strands, quickly made
  d.element_length = 0.0015;
  double mean = 0, square = 0, count = 0;
  for (const Strand& strand : strands_of(generate_carpet(d, {0.2, 0.2}, 5, true))) {
    const double relative = strand.length / d.pile_length;
    mean += relative, square += relative * relative, ++count;
    EXPECT_GE(relative, 1 - 2.05 * d.length_scatter);  // lengths are measured along chords
    EXPECT_LE(relative, 1 + 2.05 * d.length_scatter);
  }
  ASSERT_GT(count, 2000);
  mean /= count;
  EXPECT_NEAR(mean, 1, 0.01);
  // Cutting off takes 4 percent off the deviation.
  EXPECT_NEAR(std::sqrt(square / count - mean * mean), 0.96 * d.length_scatter, 0.04 * d.length_scatter);
}

struct Tilt {
  double along = 0, across = 0, along_deviation = 0, across_deviation = 0;
};

Tilt tilt_of(const std::vector<Strand>& strands) {
  double x = 0, y = 0, xx = 0, yy = 0, count = 0;
  for (const Strand& strand : strands) {
    const Vec3 t = (strand.tip - strand.start).normalized();
    const double along = std::atan2(t.x(), t.z()), across = std::asin(t.y());
    x += along, y += across, xx += along * along, yy += across * across, ++count;
  }
  x /= count, y /= count;
  return {x, y, std::sqrt(xx / count - x * x), std::sqrt(yy / count - y * y)};
}

TEST(Lean, IsTheMeanTiltAlongTheRowWhateverTheCurl) {
  for (const double curl : {0.0, 1.0}) {
    CarpetDesign d = monofilament();
    d.curl = curl;
    d.length_scatter = 0;
    d.pile_length = 0.012;  // short against the patch: walls bend few strands
    const Tilt tilt = tilt_of(strands_of(generate_carpet(d, {0.2, 0.2}, 5, true)));
    EXPECT_NEAR(tilt.along, d.lean, 0.02) << curl;
    EXPECT_NEAR(tilt.across, 0, 0.01) << curl;
    EXPECT_NEAR(tilt.along_deviation, d.fan_out, curl > 0 ? 0.06 : 0.03);
    EXPECT_NEAR(tilt.across_deviation, d.fan_out, curl > 0 ? 0.06 : 0.03);
  }
}

TEST(Lean, IsTheMeanTiltOfSplitStrandsFromTheRootOfTheirTape) {
  CarpetDesign d = slit_film();
  d.curl = d.length_scatter = 0;
  d.pile_length = 0.012;
  d.element_length = 0.0015;
  d.unsplit_length = 0.003;
  const ShellMesh mesh = generate_carpet(d, {0.2, 0.2}, 5, true);
  std::vector<Strand> all = strands_of(mesh), split;
  for (std::size_t tape = 0; tape < all.size(); tape += 7) {
    // The first six shells of a tape stand on the backing, one below each strand.
    const auto first = static_cast<std::size_t>(
        std::find(mesh.surface.begin(), mesh.surface.end(), static_cast<Index>(tape + 1)) -
        mesh.surface.begin());
    for (std::size_t i = 0; i < 6; ++i) {
      all[tape + 1 + i].start = 0.5 * (corner(mesh, first + i, 0) + corner(mesh, first + i, 1));
      split.push_back(all[tape + 1 + i]);
    }
  }
  const Tilt tilt = tilt_of(split);
  EXPECT_NEAR(tilt.along, d.lean, 0.02);
  EXPECT_NEAR(tilt.across, 0, 0.01);
  EXPECT_NEAR(tilt.along_deviation, d.fan_out, 0.03);
  EXPECT_NEAR(tilt.across_deviation, d.fan_out, 0.03);
}

TEST(Curl, TurnsTheTangentByItsAngleInAPileLength) {
  CarpetDesign d = monofilament();
  d.lean = d.fan_out = d.length_scatter = 0;
  d.curl = 0.8;
  d.pile_length = 0.03;
  d.element_length = 0.0005;
  for (const Strand& strand : strands_of(generate_carpet(d, {0.03, 0.03}, 1, true))) {
    double turn = 0;
    for (std::size_t k = 1; k < strand.tangents.size(); ++k)
      turn += std::acos(std::min(1.0, strand.tangents[k].dot(strand.tangents[k - 1])));
    EXPECT_NEAR(turn / d.curl, 1, 0.05);
  }
}

TEST(Curl, LeavesLeanAndFanOutAsTheyWere) {
  CarpetDesign d = monofilament();
  d.curl = 0;
  d.length_scatter = 0;
  const std::vector<StrandAngles> straight = [&] {
    Random random(7);
    return draw_legs(d, root_layout(d), random);
  }();
  d.curl = 1;
  Random random(7);
  const std::vector<StrandAngles> curled = draw_legs(d, root_layout(d), random);
  for (std::size_t i = 0; i < straight.size(); ++i) {
    EXPECT_EQ(straight[i].forward, curled[i].forward);
    EXPECT_EQ(straight[i].sideways, curled[i].sideways);
  }
}

TEST(FanOut, SpreadsNeighboursApartAcrossTheRow) {
  const CarpetDesign d = slit_film();
  Random random(3);
  const std::vector<StrandAngles> strands = draw_legs(d, root_layout(d), random);
  for (const std::size_t leg : {0U, 6U})
    for (std::size_t i = leg + 1; i < leg + 6; ++i) EXPECT_GT(strands[i].sideways, strands[i - 1].sideways);
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = 6; j < 12; ++j) EXPECT_LT(strands[i].forward, strands[j].forward);
}

TEST(Legs, LeaveTheBackingTheSameWithAndWithoutFibres) {
  const ShellMesh bare = generate_carpet(slit_film(), patch, 1, false),
                  full = generate_carpet(slit_film(), patch, 1, true);
  ASSERT_LT(bare.nodes.size(), full.nodes.size());
  for (std::size_t n = 0; n < bare.nodes.size(); ++n) ASSERT_EQ(bare.nodes[n], full.nodes[n]);
}

TEST(Legs, NameWhatIsUnusable) {
  const auto rejected = [](CarpetDesign d, auto&& change, std::initializer_list<const char*> words) {
    change(d);
    expect_error<InputError>([&] { (void)generate_carpet(d, patch, 1, true); }, words);
  };
  const CarpetDesign tape = slit_film(), mono = monofilament();
  rejected(tape, [](CarpetDesign& d) { d.legs_per_tuft = 3; }, {"legs_per_tuft is 3", "1 or 2"});
  rejected(tape, [](CarpetDesign& d) { d.strands_per_tuft = 11; }, {"strands_per_tuft is 11", "even"});
  rejected(tape, [](CarpetDesign& d) { d.unsplit_length = 0.058; }, {"unsplit_length is 0.058", "at most"});
  rejected(tape, [](CarpetDesign& d) { d.unsplit_length = -1; }, {"unsplit_length is -1"});
  rejected(mono, [](CarpetDesign& d) { d.unsplit_length = 0.01; },
           {"monofilament", "separate from the root"});
  rejected(tape, [](CarpetDesign& d) { d.curl = 4; }, {"curl is 4"});
  rejected(tape, [](CarpetDesign& d) { d.length_scatter = 0.5; }, {"length_scatter is 0.5"});
  rejected(tape, [](CarpetDesign& d) { d.leg_width = 0.02; }, {"leg_width is 0.02", "flat"});
  rejected(tape, [](CarpetDesign& d) { d.leg_width = 0.001; }, {"leg_width is 0.001", "folded"});
  rejected(tape, [](CarpetDesign& d) { d.leg_spacing = 0.001; },
           {"leg_spacing is 0.001", "space them wider"});
  rejected(tape, [](CarpetDesign& d) { d.leg_spacing = std::nan(""); }, {"leg_spacing is nan"});
  rejected(tape, [](CarpetDesign& d) { d.stitch_spacing = 0.003; }, {"stitch_spacing is 0.003"});
  rejected(tape, [](CarpetDesign& d) { d.gauge = 0.006; }, {"gauge is 0.006", "leg_width"});
  rejected(tape, [](CarpetDesign& d) { d.legs_per_tuft = 1; }, {"leg_spacing", "legs_per_tuft is 1"});
  rejected(tape, [](CarpetDesign& d) { d.legs_per_tuft = 1, d.leg_spacing = d.unsplit_length = 0; },
           {"leg_width is 0.006", "share one edge"});
}

}  // namespace
}  // namespace tuft::fe::test
