#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "sph_infill/row_shares.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

/// Columns of particles across a tile or a strip, see make_lattice.
constexpr long tile_width = 16;

/// Rows of one layer: a whole number, spaced so that they fill its depth.
struct LayerRows {
  double bottom, spacing;
  int count;
};

std::vector<LayerRows> divide_layers(const Turf& turf, double floor, double pitch) {
  std::vector<LayerRows> rows;
  double bottom = floor;
  for (std::size_t k = 0; k < turf.layers.size(); ++k) {
    const double depth = turf.layers[k].depth;
    if (!(depth >= 0.5 * pitch))
      throw_input_error(
          "turf.layers[{}]: depth {} m is less than half the SPH pitch of {} m; make the layer deeper or "
          "infill.sph.pitch smaller",
          k, depth, pitch);
    const int count = std::max(1, static_cast<int>(std::lround(depth / pitch)));
    rows.push_back({bottom, depth / count, count});
    bottom += depth;
  }
  return rows;
}

/// How a box is divided.
struct Cells {
  std::vector<LayerRows> layers;
  std::array<long, 2> count;      ///< in x and y
  std::array<double, 2> spacing;  ///< m
};

Cells divide_box(const Turf& turf, const LatticeBox& box, double pitch) {
  if (!(pitch > 0) || !std::isfinite(pitch))
    throw_input_error("infill.sph.pitch is {} m; it must be above 0", pitch);
  for (const double side : box.size)
    if (!(side >= pitch) || !std::isfinite(side))
      throw_input_error("turf.size: a side of {} m is shorter than the SPH pitch of {} m", side, pitch);
  if (turf.layers.empty()) throw_input_error("turf.layers is empty; SPH infill needs at least one layer");

  Cells cells{divide_layers(turf, box.floor, pitch), {}, {}};
  for (std::size_t d = 0; d < 2; ++d) {
    cells.count[d] = std::lround(box.size[d] / pitch);
    cells.spacing[d] = box.size[d] / static_cast<double>(cells.count[d]);
  }
  return cells;
}

double box_depth(const std::vector<LayerRows>& layers) {
  double depth = 0;
  for (const LayerRows& layer : layers) depth += layer.count * layer.spacing;
  return depth;
}

/// From the floor upwards.
std::vector<double> shares_of_rows(const Cells& cells, const SphOptions& options) {
  std::vector<double> place, thickness;
  for (const LayerRows& layer : cells.layers)
    for (int k = 0; k < layer.count; ++k) {
      place.push_back(layer.bottom + (k + 0.5) * layer.spacing);
      thickness.push_back(layer.spacing);
    }
  return row_shares(place, thickness, cells.spacing, options);
}

}  // namespace

Lattice make_lattice(const Turf& turf, const LatticeBox& box, double pitch) {
  const auto [rows, count, spacing] = divide_box(turf, box, pitch);
  const auto [nx, ny] = count;
  const auto [px, py] = spacing;

  Lattice lattice;
  lattice.pitch = std::sqrt(px * py);
  const auto add = [&](std::size_t k, long ix, long iy, int iz) {
    lattice.position.push_back({(static_cast<double>(ix) + 0.5) * px - 0.5 * box.size[0],
                                (static_cast<double>(iy) + 0.5) * py - 0.5 * box.size[1],
                                rows[k].bottom + (iz + 0.5) * rows[k].spacing});
    lattice.volume.push_back(px * py * rows[k].spacing);
    lattice.radius.push_back(0.5 * lattice.pitch);
    lattice.half_height.push_back(0.5 * rows[k].spacing);
    lattice.layer.push_back(static_cast<Index>(k));
    lattice.material.push_back(turf.layers[k].material);
  };
  // Two columns at a time, to and fro: eight in sequence lie two by four, so that few others are near them.
  const auto add_row = [&](std::size_t k, int iz, long x_begin, long y_begin) {
    const long x_end = std::min(nx, x_begin + tile_width), y_end = std::min(ny, y_begin + tile_width);
    bool back = false;
    for (long pair = x_begin; pair < x_end; pair += 2, back = !back)
      for (long n = 0; n < y_end - y_begin; ++n)
        for (long ix = pair; ix < std::min(x_end, pair + 2); ++ix)
          add(k, ix, back ? y_end - 1 - n : y_begin + n, iz);
  };
  // What one particle's neighbours read stays in a core's second-level cache: one layer by strips of columns,
  // which is the faster of the two. Several by tiles, row upon row, so that particles with consecutive
  // indices lie at one height of one layer, and their steps (individual_steps.h) are alike.
  for (long iy = 0; iy < ny; iy += tile_width) {
    if (rows.size() == 1) {
      for (long ix = 0; ix < nx; ++ix)
        for (long k = iy; k < std::min(ny, iy + tile_width); ++k)
          for (int iz = 0; iz < rows[0].count; ++iz) add(0, ix, k, iz);
      continue;
    }
    for (long ix = 0; ix < nx; ix += tile_width)
      for (std::size_t k = 0; k < rows.size(); ++k)
        for (int iz = 0; iz < rows[k].count; ++iz) add_row(k, iz, ix, iy);
  }
  return lattice;
}

double mean_spacing(const Turf& turf, const LatticeBox& box, double pitch) {
  const Cells cells = divide_box(turf, box, pitch);
  double rows = 0;
  for (const LayerRows& layer : cells.layers) rows += layer.count;
  return std::cbrt(cells.spacing[0] * cells.spacing[1] * box_depth(cells.layers) / rows);
}

Lattice make_bed(const Turf& turf, const LatticeBox& box, const SphOptions& options) {
  Lattice lattice = make_lattice(turf, box, options.pitch);
  const Cells cells = divide_box(turf, box, options.pitch);
  const std::vector<double> share = shares_of_rows(cells, options);
  std::vector<std::size_t> first_row;
  for (std::size_t rows = 0; const LayerRows& layer : cells.layers) {
    first_row.push_back(rows);
    rows += static_cast<std::size_t>(layer.count);
  }
  for (std::size_t i = 0; i < lattice.position.size(); ++i) {
    const auto k = static_cast<std::size_t>(lattice.layer[i]);
    const LayerRows& layer = cells.layers[k];
    const double above = (lattice.position[i].z() - layer.bottom) / layer.spacing;
    lattice.strained_share.push_back(share[first_row[k] + static_cast<std::size_t>(above)]);
  }
  return lattice;
}

ContactRadii contact_radii(const Lattice& lattice) {
  if (lattice.half_height != lattice.radius) return {lattice.radius, lattice.half_height};
  ContactRadii radii{lattice.radius, {}};
  if (radii.radius.empty()) {
    radii.radius.reserve(lattice.volume.size());
    for (const double volume : lattice.volume) radii.radius.push_back(0.5 * std::cbrt(volume));
  }
  return radii;
}

}  // namespace tuft::sph
