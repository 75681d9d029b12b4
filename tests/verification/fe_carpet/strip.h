#pragma once
/// Flat strips and patches for tests, and loads on them.
#include <cmath>
#include <functional>
#include <vector>

#include "fe_carpet/carpet.h"

namespace tuft::fe::test {

struct StripShape {
  double length = 0.06, width = 0.0013, thickness = 0.0001;  ///< m
  Index along = 20, across = 1;                              ///< elements
};

/// In the x-y plane from the origin; node(i, j) = i * (across + 1) + j with i along x.
struct Strip {
  ShellMesh mesh;
  StripShape shape;
  [[nodiscard]] Index node(Index i, Index j) const { return i * (shape.across + 1) + j; }
  [[nodiscard]] std::size_t node_count() const { return mesh.nodes.size(); }
};

inline Strip make_strip(const StripShape& shape, bool clamp_root) {
  Strip strip{{}, shape};
  ShellMesh& mesh = strip.mesh;
  mesh.surface_count = 1;
  for (Index i = 0; i <= shape.along; ++i)
    for (Index j = 0; j <= shape.across; ++j) {
      mesh.nodes.push_back({shape.length * i / shape.along, shape.width * j / shape.across, 0});
      mesh.clamped.push_back(clamp_root && i == 0);
    }
  for (Index i = 0; i < shape.along; ++i)
    for (Index j = 0; j < shape.across; ++j) {
      mesh.quads.push_back(
          {strip.node(i, j), strip.node(i + 1, j), strip.node(i + 1, j + 1), strip.node(i, j + 1)});
      mesh.thickness.push_back(shape.thickness);
      mesh.material.push_back(0);
      mesh.surface.push_back(0);
    }
  return strip;
}

inline ShellMaterial polyethylene() {
  return {0.5e9, 0.4, 920};
}

/// For names of parameterised tests.
inline std::string name_of(ElementKind element) {
  return element == ElementKind::one_point ? "one_point" : "fully_integrated";
}
inline std::string name_of(const ShellSection& section) {
  return name_of(section.element) + "_" + std::to_string(section.thickness_points);
}

inline CarpetOptions no_gravity() {
  CarpetOptions options;
  options.gravity = Vec3(0, 0, 0);
  return options;
}

inline Vec3Array no_load(std::size_t nodes) {
  Vec3Array load;
  load.assign(nodes, 0.0);
  return load;
}

inline Vec3 position(const Carpet& carpet, Index node) {
  const NodeView view = carpet.nodes();
  const auto n = static_cast<std::size_t>(node);
  return {view.x[n], view.y[n], view.z[n]};
}

inline double total(const CarpetEnergy& e) {
  return e.balance();
}

/// Of all nodes, N s.
inline Vec3 momentum(const Carpet& carpet) {
  const NodeView v = carpet.nodes();
  Vec3 sum(0, 0, 0);
  for (std::size_t n = 0; n < v.x.size(); ++n) sum += v.mass[n] * Vec3(v.vx[n], v.vy[n], v.vz[n]);
  return sum;
}

/// Strips standing up from a square patch of backing, with shared root nodes and two thicknesses.
inline ShellMesh small_turf(double side) {
  CarpetDesign d;
  d.gauge = 0.008;
  d.stitch_spacing = 0.006;
  d.strands_per_tuft = 3;
  d.pile_length = 0.03;
  d.strand_width = 0.0013;
  d.strand_thickness = 0.0001;
  d.lean = 0.2;
  d.fan_out = 0.2;
  d.element_length = 0.003;
  d.backing_thickness = 0.001;
  d.backing_element = 0.004;
  return generate_carpet(d, {side, side}, 7, true);
}

}  // namespace tuft::fe::test
