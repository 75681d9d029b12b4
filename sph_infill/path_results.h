#pragma once
/// What is read off the path of a material point: the ends of its segments, and the measures that its test
/// names.
#include <optional>
#include <string>
#include <vector>

#include "core/loading_branch.h"
#include "core/mohr_coulomb_line.h"
#include "sph_infill/strain_path.h"

namespace tuft::sph {

/// One result by its name, in the unit given ("Pa", "1", "deg", "J/m^3").
struct PathResult {
  std::string name, unit;
  double value = 0;
};

/// A curve of one segment, as an experimenter would draw it: `segment_2_stress`.
struct PathCurve {
  std::string name;
  std::string x_unit, y_unit;
  std::string x_label, y_label;  ///< in words
  std::vector<double> x, y;
};

/// Axial stress against compression over the height as placed, 1 - exp(-e), of one segment (from 1) and the
/// row that it begins with.
[[nodiscard]] std::vector<BranchPoint> axial_branch(const PathRecord& record, std::size_t segment);

/// Share of the work of `segment` (from 1) that the one after it does not give back. Per area and height as
/// placed, for a point that is strained along z alone; empty where no work was done.
[[nodiscard]] std::optional<double> loop_loss(const PathRecord& record, std::size_t segment);

/// The line through the ends of the direct_shear segments: shear stress against the normal stress kept.
[[nodiscard]] std::optional<MohrCoulombLine> shear_line(const PointTest& test, const PathRecord& record);

/// Results of the segments that came to their end: `segment_<k>_...`, then the measures. A measure whose
/// segments do not pass what it needs is left out.
[[nodiscard]] std::vector<PathResult> path_results(const PointTest& test, const PathRecord& record);

/// Names and units of all results that a test gives when nothing fails; values are 0.
[[nodiscard]] std::vector<PathResult> path_result_names(const PointTest& test);

/// One curve a segment: pressure against compression ln(rho/rho0) (isotropic), axial stress against
/// compression over the height as placed (oedometric), q against logarithmic strain along z (triaxial), shear
/// stress against shear strain. Of a velocity_gradient none.
[[nodiscard]] std::vector<PathCurve> path_curves(const PointTest& test, const PathRecord& record);

/// Names and units of the curves of a test, without points.
[[nodiscard]] std::vector<PathCurve> path_curve_names(const PointTest& test);

}  // namespace tuft::sph
