#include "fe_carpet/leg_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"

namespace tuft::fe {
namespace {

constexpr double default_spacing = 0.25;  ///< of the stitch: both legs come through one hole of the needle
constexpr double closest = 0.25;          ///< strand widths between legs, and between tufts
constexpr double narrowest_pitch =
    0.4;  ///< strand widths; folds deeper than that make slivers of the backing
constexpr double largest_scatter = 0.3;
constexpr double rounding = 1e-9;

/// Legs are shaped with the strands' width along x, as strand_shape.h has it, and stand with it along y.
Vec3 swap_axes(const Vec3& p) {
  return {p.y(), p.x(), p.z()};
}

double mean_forward(const std::vector<StrandAngles>& angles) {
  return std::accumulate(angles.begin(), angles.end(), 0.0,
                         [](double sum, const StrandAngles& s) { return sum + s.forward; }) /
         static_cast<double>(angles.size());
}

std::vector<Vec3> tape_row(const RootLayout& layout, const Vec3& centre, double tilt) {
  std::vector<Vec3> row;
  for (int n = 0; n <= layout.strands_per_leg; ++n)
    row.push_back(centre + Vec3(layout.node_y(n), layout.node_x(n) * std::cos(tilt),
                                -layout.node_x(n) * std::sin(tilt)));
  return row;
}

/// In shaping axes: width along x.
LegShape shape_leg(const CarpetDesign& design, const RootLayout& layout, const Vec3& root,
                   std::vector<StrandAngles> angles) {
  LegShape leg;
  Vec3 centre = root;
  const double tilt = mean_forward(angles), split = design.unsplit_length / design.pile_length;
  if (split > 0) {
    const int elements = count_elements(design.unsplit_length, design.element_length);
    leg.tape.push_back(tape_row(layout, root, 0));
    for (int k = 1; k <= elements; ++k) {
      const double middle = bent_tilt(tilt, (k - 0.5) / elements * split);
      centre += design.unsplit_length / elements * Vec3(0, std::sin(middle), std::cos(middle));
      leg.tape.push_back(
          tape_row(layout, centre, bent_tilt(tilt, static_cast<double>(k) / elements * split)));
    }
  }
  for (int i = 0; i < layout.strands_per_leg; ++i) {
    StrandAngles& strand = angles[static_cast<std::size_t>(i)];
    strand.split = split;
    strand.tape = tilt;
    strand.fold = std::atan2(layout.node_x(i + 1) - layout.node_x(i), layout.pitch);
    const Vec3 middle(0.5 * (layout.node_y(i) + layout.node_y(i + 1)), 0, 0);
    leg.strands.push_back(strand_rows(design, centre + middle, strand));
  }
  return leg;
}

void swap_axes(LegShape& leg) {
  for (std::vector<Vec3>& row : leg.tape)
    for (Vec3& p : row) p = swap_axes(p);
  for (std::vector<StrandRow>& rows : leg.strands)
    for (StrandRow& row : rows) row = {swap_axes(row.left), swap_axes(row.right)};
}

void check_root_gaps(const CarpetDesign& d, const RootLayout& layout) {
  const double gap = closest * d.strand_width, along = layout.spacing + layout.depth;
  if (layout.legs == 2 && layout.spacing - layout.depth < gap)
    throw_input_error(
        "carpet design: leg_spacing is {} m, but legs are {} m deep and must stand {} m apart: space them "
        "wider, "
        "or make leg_width larger",
        layout.spacing, layout.depth, gap);
  if (d.stitch_spacing - along < gap)
    throw_input_error(
        "carpet design: stitch_spacing is {} m, but a tuft is {} m long and tufts must stand {} m apart",
        d.stitch_spacing, along, gap);
  if (d.gauge - layout.width() < gap)
    throw_input_error(
        "carpet design: gauge is {} m, but a leg is {} m wide and rows must stand {} m apart: make leg_width "
        "smaller, so that the yarn is gathered",
        d.gauge, layout.width(), gap);
}

}  // namespace

RootLayout root_layout(const CarpetDesign& d) {
  RootLayout layout;
  layout.legs = d.legs_per_tuft;
  layout.shared_edge = d.yarn == Yarn::slit_film && d.legs_per_tuft == 1 && !(d.unsplit_length > 0);
  if (d.legs_per_tuft != 1 && d.legs_per_tuft != 2)
    throw_input_error("carpet design: legs_per_tuft is {}; it must be 1 or 2", d.legs_per_tuft);
  if (d.legs_per_tuft == 1 && d.leg_spacing != 0)
    throw_input_error("carpet design: leg_spacing is {} m, but legs_per_tuft is 1; leave it out",
                      d.leg_spacing);
  if (layout.shared_edge) {
    if (d.leg_width != 0)
      throw_input_error(
          "carpet design: leg_width is {} m, but the strands of a tuft share one edge with slit_film, one "
          "leg "
          "and no unsplit_length; leave it out",
          d.leg_width);
    return layout;
  }
  if (d.strands_per_tuft < d.legs_per_tuft || d.strands_per_tuft % d.legs_per_tuft != 0)
    throw_input_error("carpet design: strands_per_tuft is {}; two legs need an even number",
                      d.strands_per_tuft);
  layout.strands_per_leg = d.strands_per_tuft / d.legs_per_tuft;
  if (!(d.leg_spacing >= 0) || !std::isfinite(d.leg_spacing))
    throw_input_error("carpet design: leg_spacing is {} m; it must not be negative", d.leg_spacing);
  if (d.legs_per_tuft == 2)
    layout.spacing = d.leg_spacing > 0 ? d.leg_spacing : default_spacing * d.stitch_spacing;
  const double flat = layout.strands_per_leg * d.strand_width;
  const double width = d.leg_width == 0 ? flat : d.leg_width;
  if (!(width >= narrowest_pitch * flat && width <= flat * (1 + rounding)))
    throw_input_error(
        "carpet design: leg_width is {} m; {} strands of {} m need {} m (folded) to {} m (flat)", d.leg_width,
        layout.strands_per_leg, d.strand_width, narrowest_pitch * flat, flat);
  layout.pitch = width / layout.strands_per_leg;
  const double square = d.strand_width * d.strand_width - layout.pitch * layout.pitch;
  layout.depth = square > rounding * d.strand_width * d.strand_width ? std::sqrt(square) : 0;
  check_root_gaps(d, layout);
  return layout;
}

void check_legs(const CarpetDesign& d) {
  if (!(d.curl >= 0 && d.curl <= std::numbers::pi))
    throw_input_error("carpet design: curl is {} rad; it must be in [0, pi] rad", d.curl);
  if (!(d.length_scatter >= 0 && d.length_scatter <= largest_scatter))
    throw_input_error("carpet design: length_scatter is {}; it must be in [0, {}]", d.length_scatter,
                      largest_scatter);
  if (d.yarn == Yarn::monofilament && d.unsplit_length != 0)
    throw_input_error(
        "carpet design: unsplit_length is {} m, but monofilament strands are separate from the root; leave "
        "it "
        "out",
        d.unsplit_length);
  const double longest = d.pile_length * (1 - 2 * d.length_scatter) - d.element_length;
  if (d.unsplit_length != 0 && !(d.unsplit_length > 0 && d.unsplit_length <= longest))
    throw_input_error(
        "carpet design: unsplit_length is {} m; it must be positive and leave one element of the shortest "
        "strand "
        "free, so at most {} m",
        d.unsplit_length, longest);
}

std::vector<StrandAngles> draw_legs(const CarpetDesign& design, const RootLayout& layout, Random& random) {
  const auto per_leg = static_cast<std::size_t>(layout.strands_per_leg);
  const std::vector<double> forward =
      stratified_normals(per_leg * static_cast<std::size_t>(layout.legs), random);
  std::vector<StrandAngles> strands(forward.size());
  for (std::size_t first = 0; first < strands.size(); first += per_leg) {
    const auto begin = forward.begin() + static_cast<std::ptrdiff_t>(first);
    std::vector<double> of_leg(begin, begin + static_cast<std::ptrdiff_t>(per_leg));
    shuffle(of_leg, random);
    const std::vector<double> sideways = stratified_normals(per_leg, random);
    for (std::size_t i = 0; i < per_leg; ++i) {
      StrandAngles& strand = strands[first + i];
      strand.forward = design.lean + design.fan_out * of_leg[i];
      strand.sideways = design.fan_out * sideways[i];
      strand.twist = draw_twist(random);
      limit_tilt(strand);
    }
  }
  return strands;
}

std::vector<LegShape> legs_inside(const CarpetDesign& design, const RootLayout& layout, const Vec3& root,
                                  std::vector<StrandAngles> angles, const StrandBounds& bounds) {
  const StrandBounds swapped{{bounds.half_size[1], bounds.half_size[0]}};
  const auto per_leg = static_cast<std::ptrdiff_t>(layout.strands_per_leg);
  std::vector<LegShape> legs;
  turn_inside(design, angles, [&](const std::vector<StrandAngles>& now) {
    Overshoot out;
    legs.clear();
    for (int l = 0; l < layout.legs; ++l) {
      const auto first = now.begin() + l * per_leg;
      const Vec3 at = swap_axes(root) + Vec3(0, layout.leg_x(l), 0);
      const LegShape& leg = legs.emplace_back(shape_leg(design, layout, at, {first, first + per_leg}));
      for (std::size_t k = 1; k < leg.tape.size(); ++k)
        for (const Vec3& p : leg.tape[k]) out.add(p, swapped, root.z());
      for (const std::vector<StrandRow>& rows : leg.strands) out.add(rows, swapped, root.z());
    }
    return out;
  });
  for (LegShape& leg : legs) swap_axes(leg);
  return legs;
}

}  // namespace tuft::fe
