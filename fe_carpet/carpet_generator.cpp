#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "fe_carpet/carpet.h"
#include "fe_carpet/leg_shape.h"
#include "fe_carpet/strand_shape.h"

namespace tuft::fe {
namespace {

constexpr double rounding =
    1e-9;  ///< relative, so that lengths that divide evenly in decimals do so in binary

void require_positive(const char* name, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw_input_error("carpet design: {} is {}; it must be positive", name, value);
}

void check_design(const CarpetDesign& d, std::array<double, 2> size, bool with_fibres) {
  require_positive("patch size in x", size[0]);
  require_positive("patch size in y", size[1]);
  require_positive("backing_thickness", d.backing_thickness);
  require_positive("backing_element", d.backing_element);
  require_positive("gauge", d.gauge);
  require_positive("stitch_spacing", d.stitch_spacing);
  require_positive("strand_width", d.strand_width);
  if (!with_fibres) return;
  require_positive("pile_length", d.pile_length);
  require_positive("strand_thickness", d.strand_thickness);
  require_positive("element_length", d.element_length);
  if (d.strands_per_tuft < 1)
    throw_input_error("carpet design: strands_per_tuft is {}; it must be at least 1", d.strands_per_tuft);
  if (!(std::abs(d.lean) <= largest_tilt))
    throw_input_error("carpet design: lean is {} rad; it must be within {} rad", d.lean, largest_tilt);
  if (!(d.fan_out >= 0 && d.fan_out <= largest_tilt))
    throw_input_error("carpet design: fan_out is {} rad; it must be in [0, {}] rad", d.fan_out, largest_tilt);
  check_legs(d);
  if (root_layout(d).shared_edge && d.stitch_spacing < 1.5 * d.strand_width)
    throw_input_error(
        "carpet design: stitch_spacing {} m is under 1.5 strand widths ({} m): tufts of a row would run into "
        "each other",
        d.stitch_spacing, 1.5 * d.strand_width);
}

/// Centres of tufts along one direction, centred on zero, `margin` or half a spacing free at both ends.
std::vector<double> tuft_centres(double length, double spacing, double margin) {
  const double free_length = length - 2 * std::max(margin, spacing / 2);
  if (free_length < -rounding * length) return {};
  const auto count =
      static_cast<std::size_t>(std::floor(free_length / spacing * (1 + rounding) + rounding)) + 1;
  std::vector<double> centres(count);
  for (std::size_t i = 0; i < count; ++i)
    centres[i] = (static_cast<double>(i) - 0.5 * static_cast<double>(count - 1)) * spacing;
  return centres;
}

/// Grid lines that must be there, ascending. A gap that is the root of strands stays one element, even if
/// backing_element is smaller.
struct Stops {
  std::vector<double> at;
  std::vector<bool> root_before;

  void add(double value, bool root = false) {
    at.push_back(value);
    root_before.push_back(root);
  }
};

/// Grid lines through all stops, each gap divided evenly into sides of at most `largest`.
std::vector<double> divide(const Stops& stops, double largest) {
  std::vector<double> lines{stops.at.front()};
  for (std::size_t i = 1; i < stops.at.size(); ++i) {
    const double start = stops.at[i - 1], gap = stops.at[i] - start;
    const auto parts = static_cast<std::size_t>(
        stops.root_before[i] ? 1.0 : std::max(1.0, std::ceil(gap / largest * (1 - rounding))));
    for (std::size_t k = 1; k < parts; ++k)
      lines.push_back(start + gap * static_cast<double>(k) / static_cast<double>(parts));
    lines.push_back(stops.at[i]);
  }
  return lines;
}

/// Backing nodes, numbered row by row: node(i, j) = j * columns + i.
struct BackingGrid {
  std::vector<double> x, y;
  [[nodiscard]] Index node(std::size_t i, std::size_t j) const {
    return static_cast<Index>(j * x.size() + i);
  }
};

std::size_t line_at(const std::vector<double>& lines, double value) {
  return static_cast<std::size_t>(std::lower_bound(lines.begin(), lines.end(), value) - lines.begin());
}

Stops stops_along_rows(const CarpetDesign& d, const RootLayout& layout, double size,
                       const std::vector<double>& tufts) {
  Stops stops;
  stops.add(-size / 2);
  for (const double x : tufts) {
    if (layout.shared_edge) {
      stops.add(x - d.strand_width / 2);
      stops.add(x + d.strand_width / 2, true);
      continue;
    }
    for (int leg = 0; leg < layout.legs; ++leg) {
      stops.add(x + layout.leg_x(leg) + layout.node_x(0));
      if (layout.depth > 0) stops.add(x + layout.leg_x(leg) + layout.node_x(1), true);
    }
  }
  stops.add(size / 2);
  return stops;
}

Stops stops_across_rows(const RootLayout& layout, double size, const std::vector<double>& tufts) {
  Stops stops;
  stops.add(-size / 2);
  for (const double y : tufts) {
    if (layout.shared_edge) {
      stops.add(y);
      continue;
    }
    for (int n = 0; n <= layout.strands_per_leg; ++n) stops.add(y + layout.node_y(n), n > 0);
  }
  stops.add(size / 2);
  return stops;
}

void add_quad(ShellMesh& mesh, const std::array<Index, 4>& quad, double thickness, Index material,
              Index surface) {
  mesh.quads.push_back(quad);
  mesh.thickness.push_back(thickness);
  mesh.material.push_back(material);
  mesh.surface.push_back(surface);
}

void add_backing(const CarpetDesign& d, const BackingGrid& grid, ShellMesh& mesh) {
  const std::size_t columns = grid.x.size(), rows = grid.y.size();
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      mesh.nodes.push_back({grid.x[i], grid.y[j], d.backing_thickness / 2});
      mesh.clamped.push_back(i == 0 || j == 0 || i + 1 == columns || j + 1 == rows);
    }
  for (std::size_t j = 0; j + 1 < rows; ++j)
    for (std::size_t i = 0; i + 1 < columns; ++i)
      add_quad(mesh, {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1), grid.node(i, j + 1)},
               d.backing_thickness, 0, ShellMesh::backing_surface);
}

void add_strand(const std::vector<StrandRow>& rows, double thickness, Index root_left, Index root_right,
                ShellMesh& mesh) {
  const Index surface = mesh.surface_count++;
  Index left = root_left, right = root_right;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const auto next_left = static_cast<Index>(mesh.nodes.size());
    mesh.nodes.push_back(rows[k].left);
    mesh.nodes.push_back(rows[k].right);
    mesh.clamped.insert(mesh.clamped.end(), {0, 0});
    add_quad(mesh, {left, right, next_left + 1, next_left}, thickness, 1, surface);
    left = next_left;
    right = next_left + 1;
  }
}

void add_leg(const LegShape& leg, double thickness, std::vector<Index> roots, ShellMesh& mesh) {
  if (!leg.tape.empty()) {
    const Index surface = mesh.surface_count++;
    for (std::size_t k = 1; k < leg.tape.size(); ++k) {
      std::vector<Index> next(roots.size());
      for (std::size_t n = 0; n < roots.size(); ++n) {
        next[n] = static_cast<Index>(mesh.nodes.size());
        mesh.nodes.push_back(leg.tape[k][n]);
        mesh.clamped.push_back(0);
      }
      for (std::size_t n = 0; n + 1 < roots.size(); ++n)
        add_quad(mesh, {roots[n], roots[n + 1], next[n + 1], next[n]}, thickness, 1, surface);
      roots = std::move(next);
    }
  }
  for (std::size_t n = 0; n < leg.strands.size(); ++n)
    add_strand(leg.strands[n], thickness, roots[n], roots[n + 1], mesh);
}

std::vector<Index> leg_roots(const BackingGrid& grid, const RootLayout& layout, double x, double y, int leg) {
  std::vector<Index> roots;
  for (int n = 0; n <= layout.strands_per_leg; ++n)
    roots.push_back(grid.node(line_at(grid.x, x + layout.leg_x(leg) + layout.node_x(n)),
                              line_at(grid.y, y + layout.node_y(n))));
  return roots;
}

}  // namespace

ShellMesh generate_carpet(const CarpetDesign& design, std::array<double, 2> size, std::uint64_t seed,
                          bool with_fibres) {
  check_design(design, size, with_fibres);
  // The backing is the same with and without fibres, so that the two can be compared. Margins: room for
  // upright strands, however they are twisted, within the bounds below.
  const RootLayout layout = root_layout(design);
  const std::vector<double> tuft_x = tuft_centres(
                                size[0], design.stitch_spacing,
                                1.6 * design.strand_width + 0.5 * (layout.spacing + layout.depth)),
                            tuft_y = tuft_centres(size[1], design.gauge,
                                                  1.1 * design.strand_width + 0.5 * layout.width());
  if (with_fibres && (tuft_x.empty() || tuft_y.empty()))
    throw_input_error(
        "carpet: a patch of {} x {} m holds no tuft at a stitch spacing of {} m and a gauge of {} m; enlarge "
        "the patch",
        size[0], size[1], design.stitch_spacing, design.gauge);
  const BackingGrid grid{divide(stops_along_rows(design, layout, size[0], tuft_x), design.backing_element),
                         divide(stops_across_rows(layout, size[1], tuft_y), design.backing_element)};

  ShellMesh mesh;
  mesh.surface_count = 1;
  add_backing(design, grid, mesh);
  if (!with_fibres) return mesh;

  // Curl and length draw from their own numbers: see draw_curl_and_length.
  Random random(seed), extra(seed ^ 0x9e3779b97f4a7c15U);
  const StrandBounds bounds{{size[0] / 2 - design.strand_width, size[1] / 2 - design.strand_width}};
  for (const double y : tuft_y)
    for (const double x : tuft_x) {
      const Vec3 root(x, y, design.backing_thickness / 2);
      std::vector<StrandAngles> angles =
          layout.shared_edge ? draw_tuft(design, random) : draw_legs(design, layout, random);
      draw_curl_and_length(design, extra, angles);
      if (layout.shared_edge) {
        const std::size_t i = line_at(grid.x, x - design.strand_width / 2), j = line_at(grid.y, y);
        for (const std::vector<StrandRow>& rows : tuft_inside(design, root, angles, bounds))
          add_strand(rows, design.strand_thickness, grid.node(i, j), grid.node(i + 1, j), mesh);
        continue;
      }
      const std::vector<LegShape> legs = legs_inside(design, layout, root, angles, bounds);
      for (int leg = 0; leg < layout.legs; ++leg)
        add_leg(legs[static_cast<std::size_t>(leg)], design.strand_thickness,
                leg_roots(grid, layout, x, y, leg), mesh);
    }
  return mesh;
}

}  // namespace tuft::fe
