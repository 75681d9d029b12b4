#include "fe_carpet/strand_shape.h"

#include <algorithm>
#include <cmath>

namespace tuft::fe {
namespace {

constexpr double bend_share = 0.25;
constexpr double twist_deviation = 0.5;  ///< rad at the tip
constexpr double largest_normal = 2;     ///< draws are cut off at two standard deviations
constexpr int shifting_rounds = 12;      ///< of correction near walls, before strands are straightened
constexpr int correction_rounds = 72;
constexpr double straightening = 0.9;   ///< of all angles, per round
constexpr double overcorrection = 1.3;  ///< a tilt moves the tip by less than tilt x length

void limit_tilt(StrandAngles& strand) {
  strand.forward = std::clamp(strand.forward, -largest_tilt, largest_tilt);
  strand.sideways = std::clamp(strand.sideways, -largest_tilt / 2, largest_tilt / 2);
}

double cut_normal(double p) {
  return std::clamp(normal_quantile(p), -largest_normal, largest_normal);
}

/// One value per slice of equal probability, in the middle half of its slice, so that neighbours stay apart.
std::vector<double> stratified_normals(std::size_t count, Random& random) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i)
    values[i] =
        cut_normal((static_cast<double>(i) + 0.25 + 0.5 * random.uniform()) / static_cast<double>(count));
  return values;
}

void shuffle(std::vector<double>& values, Random& random) {
  for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

struct RibbonFrame {
  Vec3 tangent, width;
};

RibbonFrame ribbon_frame(const StrandAngles& angles, double share) {
  const double a = angles.forward * (1 + bend_share * (2 * share - 1));
  const double b = angles.sideways * 2 * share, twist = angles.twist * share;
  const Vec3 tangent(std::sin(b), std::cos(b) * std::sin(a), std::cos(b) * std::cos(a));
  const Vec3 untwisted(std::cos(b), -std::sin(b) * std::sin(a), -std::sin(b) * std::cos(a));
  const Vec3 normal(0, std::cos(a), -std::sin(a));
  return {tangent, std::cos(twist) * untwisted + std::sin(twist) * normal};
}

/// How far the strands of a tuft stand out of the bounds on each side, m; 0 where they do not.
struct Overshoot {
  std::array<double, 2> low{}, high{};  ///< in x and y
  bool sunk = false;                    ///< a node lies at the root's height or below
  [[nodiscard]] bool any() const { return sunk || low[0] + low[1] + high[0] + high[1] > 0; }
};

Overshoot find_overshoot(const std::vector<std::vector<StrandRow>>& strands, const StrandBounds& bounds,
                         double floor) {
  Overshoot out;
  for (const std::vector<StrandRow>& rows : strands)
    for (std::size_t k = 1; k < rows.size(); ++k)
      for (const Vec3& p : {rows[k].left, rows[k].right}) {
        for (std::size_t c = 0; c < 2; ++c) {
          const double at = p[static_cast<Eigen::Index>(c)];
          out.low[c] = std::max(out.low[c], -bounds.half_size[c] - at);
          out.high[c] = std::max(out.high[c], at - bounds.half_size[c]);
        }
        out.sunk = out.sunk || p.z() <= floor;
      }
  return out;
}

/// New angles of one direction: all shifted away from the wall that is touched, so that the strands keep
/// their distances; straightened where shifting cannot help.
void correct_angles(std::vector<StrandAngles>& angles, double StrandAngles::*angle, double low, double high,
                    double pile_length, bool straighten) {
  const double shift = straighten || low * high > 0 ? 0 : overcorrection * (low - high) / pile_length;
  const double scale = straighten || low * high > 0 ? straightening : 1;
  for (StrandAngles& strand : angles) strand.*angle = scale * strand.*angle + shift;
}

}  // namespace

int strand_elements(const CarpetDesign& design) {
  return std::max(1, static_cast<int>(std::lround(design.pile_length / design.element_length)));
}

std::vector<StrandAngles> draw_tuft(const CarpetDesign& design, Random& random) {
  const auto count = static_cast<std::size_t>(design.strands_per_tuft);
  std::vector<double> forward = stratified_normals(count, random),
                      sideways = stratified_normals(count, random);
  shuffle(sideways, random);
  std::vector<StrandAngles> strands(count);
  for (std::size_t i = 0; i < count; ++i) {
    strands[i].forward = design.lean + design.fan_out * forward[i];
    strands[i].sideways = design.fan_out * sideways[i];
    strands[i].twist = twist_deviation * cut_normal(0.02 + 0.96 * random.uniform());
  }
  // Neighbours at least a strand thickness apart at the end of their first element, even without any fan-out;
  // what that adds on average is taken off again.
  const double apart = design.strand_thickness / design.element_length;
  double added = 0;
  for (std::size_t i = 1; i < count; ++i) {
    const double wanted = std::max(strands[i].forward, strands[i - 1].forward + apart);
    added += wanted - strands[i].forward;
    strands[i].forward = wanted;
  }
  for (StrandAngles& s : strands) s.forward -= added / static_cast<double>(count);
  for (StrandAngles& s : strands) limit_tilt(s);
  return strands;
}

std::vector<StrandRow> strand_rows(const CarpetDesign& design, const Vec3& root, const StrandAngles& angles) {
  const int elements = strand_elements(design);
  const double length = design.pile_length / elements;
  std::vector<StrandRow> rows;
  Vec3 centre = root;
  for (int k = 0; k <= elements; ++k) {
    // The tangent halfway along each element keeps the element's length; the width is the node row's own.
    if (k > 0) centre += length * ribbon_frame(angles, (k - 0.5) / elements).tangent;
    const Vec3 half_width =
        0.5 * design.strand_width * ribbon_frame(angles, static_cast<double>(k) / elements).width;
    rows.push_back({centre - half_width, centre + half_width});
  }
  return rows;
}

std::vector<std::vector<StrandRow>> tuft_inside(const CarpetDesign& design, const Vec3& root,
                                                std::vector<StrandAngles> angles,
                                                const StrandBounds& bounds) {
  std::vector<std::vector<StrandRow>> strands;
  for (int round = 0; round < correction_rounds; ++round) {
    strands.clear();
    for (const StrandAngles& strand : angles) strands.push_back(strand_rows(design, root, strand));
    const Overshoot out = find_overshoot(strands, bounds, root.z());
    if (!out.any()) break;
    // Upright strands always fit, since tufts keep their distance from the walls.
    const bool straighten = round >= shifting_rounds;
    correct_angles(angles, &StrandAngles::sideways, out.low[0], out.high[0], design.pile_length, straighten);
    correct_angles(angles, &StrandAngles::forward, out.low[1], out.high[1], design.pile_length,
                   straighten || out.sunk);
    for (StrandAngles& strand : angles) {
      limit_tilt(strand);
      if (straighten || out.sunk) strand.twist *= straightening;
    }
  }
  return strands;
}

}  // namespace tuft::fe
