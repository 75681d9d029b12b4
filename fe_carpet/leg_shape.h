#pragma once
/// The shape of a tuft as it is stitched: one or two legs, each a tape that splits, or filaments side by
/// side.
#include <array>
#include <vector>

#include "core/scene.h"
#include "core/vector.h"
#include "fe_carpet/random.h"
#include "fe_carpet/strand_shape.h"

namespace tuft::fe {

/// Where the strands of a tuft leave the backing. The face of a leg's tape looks along the row (x), as that
/// of a tape bent round a stitch does: strands stand side by side across the row (y). A leg narrower than its
/// strands is gathered in accordion folds, `depth` deep: its nodes alternate between two lines along y.
struct RootLayout {
  bool shared_edge = true;  ///< the coarse model: all strands of a tuft start on one edge along the row
  int legs = 1;
  int strands_per_leg = 1;
  double spacing = 0;  ///< m, of two legs along the row
  double pitch = 0;    ///< m across the row from one root node to the next
  double depth = 0;    ///< m along the row between the two lines of root nodes; 0: flat

  [[nodiscard]] double width() const { return strands_per_leg * pitch; }  ///< m, across the row
  /// Relative to the tuft's centre, m. Root nodes of a leg: 0 .. strands_per_leg.
  [[nodiscard]] double leg_x(int leg) const { return legs == 1 ? 0 : (leg - 0.5) * spacing; }
  [[nodiscard]] double node_x(int node) const { return (node % 2 - 0.5) * depth; }
  [[nodiscard]] double node_y(int node) const { return (node - 0.5 * strands_per_leg) * pitch; }
};

/// Throws InputError on a design whose legs cannot be laid out.
[[nodiscard]] RootLayout root_layout(const CarpetDesign& design);

/// Throws InputError on an unusable split, curl or scatter.
void check_legs(const CarpetDesign& design);

struct LegShape {
  std::vector<std::vector<Vec3>> tape;  ///< rows of nodes from the root (row 0) to the split; may be empty
  std::vector<std::vector<StrandRow>> strands;  ///< row 0: the root, or the tape's last row
};

/// Angles of a tuft's strands, leg by leg. Forward tilts, along the row, and sideways tilts, across it, have
/// the means and deviations of draw_tuft. The leg in front takes the larger forward tilts, and across a leg
/// sideways tilts ascend, so that neither legs nor neighbours cross where they begin.
[[nodiscard]] std::vector<StrandAngles> draw_legs(const CarpetDesign& design, const RootLayout& layout,
                                                  Random& random);

/// The legs of a tuft, within the bounds and above the root.
[[nodiscard]] std::vector<LegShape> legs_inside(const CarpetDesign& design, const RootLayout& layout,
                                                const Vec3& root, std::vector<StrandAngles> angles,
                                                const StrandBounds& bounds);

}  // namespace tuft::fe
