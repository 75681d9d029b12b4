#include "fe_carpet/strand_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::fe {
namespace {

constexpr double bend_share = 0.25;
constexpr double twist_deviation = 0.5;  ///< rad at the tip
constexpr double largest_normal = 2;     ///< draws are cut off at two standard deviations
constexpr int shifting_rounds = 12;      ///< of correction near walls, before strands are straightened
constexpr int correction_rounds = 72;
constexpr double straightening = 0.9;   ///< of all angles, per round
constexpr double overcorrection = 1.3;  ///< a tilt moves the tip by less than tilt x length

double cut_normal(double p) {
  return std::clamp(normal_quantile(p), -largest_normal, largest_normal);
}

struct RibbonFrame {
  Vec3 tangent, width;
};

/// At a share of the pile length. Above a split, a - tape and b grow from zero in proportion to the way u
/// that is left, so that their means over the whole pile length are those asked for.
RibbonFrame ribbon_frame(const StrandAngles& angles, double share) {
  const double free = 1 - angles.split, u = (share - angles.split) / free;
  double a = angles.split > 0 ? bent_tilt(angles.tape, share) + 2 * u / free * (angles.forward - angles.tape)
                              : bent_tilt(angles.forward, share);
  double b = angles.sideways * 2 * u / free;
  if (angles.curl > 0) {
    const double turn = 2 * std::numbers::pi, amplitude = angles.curl / turn;
    const double at = angles.phase + angles.hand * turn * (share - angles.split);
    a += amplitude * (std::cos(at) - std::cos(angles.phase));
    b += amplitude * (std::sin(at) - std::sin(angles.phase));
  }
  const double twist = angles.fold + angles.twist * u;
  const Vec3 tangent(std::sin(b), std::cos(b) * std::sin(a), std::cos(b) * std::cos(a));
  const Vec3 untwisted(std::cos(b), -std::sin(b) * std::sin(a), -std::sin(b) * std::cos(a));
  const Vec3 normal(0, std::cos(a), -std::sin(a));
  return {tangent, std::cos(twist) * untwisted + std::sin(twist) * normal};
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

int count_elements(double length, double element_length) {
  return std::max(1, static_cast<int>(std::lround(length / element_length)));
}

double bent_tilt(double mean, double share) {
  return mean * (1 + bend_share * (2 * share - 1));
}

double draw_twist(Random& random) {
  return twist_deviation * cut_normal(0.02 + 0.96 * random.uniform());
}

void limit_tilt(StrandAngles& strand) {
  strand.forward = std::clamp(strand.forward, -largest_tilt, largest_tilt);
  strand.sideways = std::clamp(strand.sideways, -largest_tilt / 2, largest_tilt / 2);
}

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

void draw_curl_and_length(const CarpetDesign& design, Random& random, std::vector<StrandAngles>& strands) {
  for (StrandAngles& strand : strands) {
    strand.curl = design.curl;
    strand.phase = 2 * std::numbers::pi * random.uniform();
    strand.hand = random.uniform() < 0.5 ? -1 : 1;
    strand.length = 1 + design.length_scatter * cut_normal(0.5e-3 + 0.999 * random.uniform());
  }
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
    strands[i].twist = draw_twist(random);
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

std::vector<StrandRow> strand_rows(const CarpetDesign& design, const Vec3& start,
                                   const StrandAngles& angles) {
  const double length = design.pile_length * (angles.length - angles.split);
  const int elements = count_elements(length, design.element_length);
  const auto frame = [&](double k) {
    return ribbon_frame(angles, angles.split + k / elements * (angles.length - angles.split));
  };
  std::vector<StrandRow> rows;
  Vec3 centre = start;
  for (int k = 0; k <= elements; ++k) {
    // The tangent halfway along each element keeps the element's length; the width is the node row's own.
    if (k > 0) centre += length / elements * frame(k - 0.5).tangent;
    const Vec3 half_width = 0.5 * design.strand_width * frame(k).width;
    rows.push_back({centre - half_width, centre + half_width});
  }
  return rows;
}

void Overshoot::add(const Vec3& node, const StrandBounds& bounds, double floor) {
  for (std::size_t c = 0; c < 2; ++c) {
    const double at = node[static_cast<Eigen::Index>(c)];
    low[c] = std::max(low[c], -bounds.half_size[c] - at);
    high[c] = std::max(high[c], at - bounds.half_size[c]);
  }
  sunk = sunk || node.z() <= floor;
}

void Overshoot::add(const std::vector<StrandRow>& rows, const StrandBounds& bounds, double floor) {
  for (std::size_t k = 1; k < rows.size(); ++k)
    for (const Vec3& p : {rows[k].left, rows[k].right}) add(p, bounds, floor);
}

void turn_inside(const CarpetDesign& design, std::vector<StrandAngles>& angles,
                 const std::function<Overshoot(const std::vector<StrandAngles>&)>& build) {
  for (int round = 0; round < correction_rounds; ++round) {
    const Overshoot out = build(angles);
    if (!out.any()) break;
    // Upright strands always fit, since tufts keep their distance from the walls.
    const bool straighten = round >= shifting_rounds;
    correct_angles(angles, &StrandAngles::sideways, out.low[0], out.high[0], design.pile_length, straighten);
    correct_angles(angles, &StrandAngles::forward, out.low[1], out.high[1], design.pile_length,
                   straighten || out.sunk);
    for (StrandAngles& strand : angles) {
      limit_tilt(strand);
      if (straighten || out.sunk) strand.twist *= straightening;
      if (straighten || out.sunk) strand.curl *= straightening;
    }
  }
}

std::vector<std::vector<StrandRow>> tuft_inside(const CarpetDesign& design, const Vec3& root,
                                                std::vector<StrandAngles> angles,
                                                const StrandBounds& bounds) {
  std::vector<std::vector<StrandRow>> strands;
  turn_inside(design, angles, [&](const std::vector<StrandAngles>& now) {
    Overshoot out;
    strands.clear();
    for (const StrandAngles& strand : now) {
      strands.push_back(strand_rows(design, root, strand));
      out.add(strands.back(), bounds, root.z());
    }
    return out;
  });
  return strands;
}

}  // namespace tuft::fe
