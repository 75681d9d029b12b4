#pragma once
/// The shape of one strand: a ribbon that starts on the tuft's edge (along x) and rises along a gently bent,
/// slightly twisted line.
#include <array>
#include <functional>
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
/// the ribbon twists from zero to `twist`. Curl turns the tangent once about its mean line in a pile length,
/// on a helix that starts in the root's direction. A strand that is split off a tape follows the tape up to
/// `split` and grows away from it above, to the same means.
struct StrandAngles {
  double forward = 0;   ///< mean of a
  double sideways = 0;  ///< mean of b
  double twist = 0;     ///< at the tip
  double curl = 0;      ///< turn of the tangent in a pile length
  double phase = 0;     ///< of the helix
  double hand = 1;      ///< of the helix: 1 or -1
  double length = 1;    ///< over pile_length
  double split = 0;     ///< over pile_length: where the strand leaves its tape
  double tape = 0;      ///< mean tilt of the tape up to there
  double fold = 0;      ///< of the ribbon about its tangent where it begins
};

/// Two nodes of the ribbon at one height.
struct StrandRow {
  Vec3 left, right;  ///< m
};

/// Largest |x| and |y| of a strand's nodes, m.
struct StrandBounds {
  std::array<double, 2> half_size{};
};

[[nodiscard]] int count_elements(double length, double element_length);

/// Tilt `a` of a tape, or of a strand straight from the root, at a share of the pile length.
[[nodiscard]] double bent_tilt(double mean, double share);

/// Angles of a tuft's strands: forward tilts have mean `lean` and standard deviation `fan_out`, sideways
/// tilts mean zero and the same deviation. Both are drawn stratified (Latin hypercube, McKay et al. 1979):
/// one strand per slice of equal probability, so that strands of a tuft never coincide and even few of them
/// show the whole spread.
[[nodiscard]] std::vector<StrandAngles> draw_tuft(const CarpetDesign& design, Random& random);

/// One value per slice of equal probability, ascending, in the middle half of its slice; standard normal, cut
/// off at two deviations.
[[nodiscard]] std::vector<double> stratified_normals(std::size_t count, Random& random);
[[nodiscard]] double draw_twist(Random& random);  ///< rad
void shuffle(std::vector<double>& values, Random& random);
void limit_tilt(StrandAngles& strand);

/// Curl and length of each strand. They have a source of chance of their own, so that switching them on
/// leaves lean and fan-out as they were.
void draw_curl_and_length(const CarpetDesign& design, Random& random, std::vector<StrandAngles>& strands);

/// Rows of nodes from where the strand begins (row 0: the root, or the tape's upper edge) to the tip,
/// element_length apart along the centre line.
[[nodiscard]] std::vector<StrandRow> strand_rows(const CarpetDesign& design, const Vec3& start,
                                                 const StrandAngles& angles);

/// How far a tuft stands out of the bounds on each side, m; 0 where it does not.
struct Overshoot {
  std::array<double, 2> low{}, high{};  ///< in x and y
  bool sunk = false;                    ///< a node lies at the root's height or below
  [[nodiscard]] bool any() const { return sunk || low[0] + low[1] + high[0] + high[1] > 0; }
  void add(const Vec3& node, const StrandBounds& bounds, double floor);
  void add(const std::vector<StrandRow>& rows, const StrandBounds& bounds, double floor);  ///< all but row 0
};

/// Turns the strands of a tuft away from walls (all by the same angle, so that they keep their distances)
/// and, where that is not enough, straightens them until `build` finds nothing out of bounds.
void turn_inside(const CarpetDesign& design, std::vector<StrandAngles>& angles,
                 const std::function<Overshoot(const std::vector<StrandAngles>&)>& build);

/// The strands of a tuft that all start on one edge, within the bounds and above the root.
[[nodiscard]] std::vector<std::vector<StrandRow>> tuft_inside(const CarpetDesign& design, const Vec3& root,
                                                              std::vector<StrandAngles> angles,
                                                              const StrandBounds& bounds);

}  // namespace tuft::fe
