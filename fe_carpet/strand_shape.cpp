#include "fe_carpet/strand_shape.h"

#include <algorithm>
#include <cmath>

namespace tuft::fe {
namespace {

constexpr double bend_share = 0.25;
constexpr double twist_deviation = 0.5;  ///< rad at the tip
constexpr double largest_normal = 2;     ///< draws are cut off at two standard deviations
constexpr int straightening_rounds = 40;
constexpr double straightening = 0.85;

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

bool inside(const std::vector<StrandRow>& rows, const StrandBounds& bounds, double floor) {
  const auto node_inside = [&](const Vec3& p) {
    return std::abs(p.x()) <= bounds.half_size[0] && std::abs(p.y()) <= bounds.half_size[1] && p.z() > floor;
  };
  return std::all_of(rows.begin() + 1, rows.end(),
                     [&](const StrandRow& row) { return node_inside(row.left) && node_inside(row.right); });
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
  for (StrandAngles& s : strands) {
    s.forward = std::clamp(s.forward, -largest_tilt, largest_tilt);
    s.sideways = std::clamp(s.sideways, -largest_tilt / 2, largest_tilt / 2);
  }
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

std::vector<StrandRow> strand_inside(const CarpetDesign& design, const Vec3& root, StrandAngles angles,
                                     const StrandBounds& bounds) {
  std::vector<StrandRow> rows = strand_rows(design, root, angles);
  for (int round = 0; round < straightening_rounds && !inside(rows, bounds, root.z()); ++round) {
    // Away from the nearer wall first, then ever straighter; upright it always fits, tufts keep that far from
    // the walls.
    if (round == 0 && bounds.half_size[1] - std::abs(root.y()) < design.pile_length)
      angles.forward = -std::copysign(angles.forward, root.y());
    if (round == 0 && bounds.half_size[0] - std::abs(root.x()) < design.pile_length)
      angles.sideways = -std::copysign(angles.sideways, root.x());
    if (round > 0) {
      angles.forward *= straightening;
      angles.sideways *= straightening;
      angles.twist *= straightening;
    }
    rows = strand_rows(design, root, angles);
  }
  return rows;
}

}  // namespace tuft::fe
