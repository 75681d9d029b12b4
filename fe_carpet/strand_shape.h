#pragma once
/// The shape of one strand: a ribbon that starts on the tuft's edge (along x) and rises along a gently bent,
/// slightly twisted line.
#include <array>
#include <vector>

#include "core/scene.h"
#include "core/vector.h"
#include "fe_carpet/random.h"

namespace tuft::fe {

/// Mean tilt of a strand never exceeds this, rad: with the bend of bend_share its tip still points upwards.
inline constexpr double largest_tilt = 1.1;

/// rad. The strand's tangent is (sin b, cos b sin a, cos b cos a): `a` tilts it about the tuft's edge, in the
/// y-z plane, and grows linearly along the strand from (1 - bend_share) to (1 + bend_share) of its mean; `b`
/// tilts it sideways, in x, and grows from zero to twice its mean, because the root edge is fixed along x;
/// the ribbon twists from zero to `twist`.
struct StrandAngles {
  double forward = 0;   ///< mean of a
  double sideways = 0;  ///< mean of b
  double twist = 0;     ///< at the tip
};

/// Two nodes of the ribbon at one height.
struct StrandRow {
  Vec3 left, right;  ///< m
};

/// Largest |x| and |y| of a strand's nodes, m.
struct StrandBounds {
  std::array<double, 2> half_size{};
};

[[nodiscard]] int strand_elements(const CarpetDesign& design);

/// Angles of a tuft's strands: forward tilts have mean `lean` and standard deviation `fan_out`, sideways
/// tilts mean zero and the same deviation. Both are drawn stratified (Latin hypercube, McKay et al. 1979):
/// one strand per slice of equal probability, so that strands of a tuft never coincide and even few of them
/// show the whole spread.
[[nodiscard]] std::vector<StrandAngles> draw_tuft(const CarpetDesign& design, Random& random);

/// Rows of nodes from the root (row 0) to the tip, element_length apart along the centre line.
[[nodiscard]] std::vector<StrandRow> strand_rows(const CarpetDesign& design, const Vec3& root,
                                                 const StrandAngles& angles);

/// The strands of a tuft, leaning away from a wall that one of them would touch (all by the same angle, so
/// that they keep their distances) and, where that is not enough, straightened until they stay within the
/// bounds and above the root.
[[nodiscard]] std::vector<std::vector<StrandRow>> tuft_inside(const CarpetDesign& design, const Vec3& root,
                                                              std::vector<StrandAngles> angles,
                                                              const StrandBounds& bounds);

}  // namespace tuft::fe
