#pragma once
/// Looking at a generated mesh: its corners, surfaces and strands.
#include <algorithm>
#include <iterator>
#include <map>
#include <set>
#include <vector>

#include "fe_carpet/carpet.h"

namespace tuft::fe::test {

inline Vec3 node(const ShellMesh& mesh, Index n) {
  return mesh.nodes[static_cast<std::size_t>(n)];
}

inline Vec3 corner(const ShellMesh& mesh, std::size_t e, std::size_t i) {
  return node(mesh, mesh.quads[e][i]);
}

/// Twice the area long.
inline Vec3 area_vector(const ShellMesh& mesh, std::size_t e) {
  return (corner(mesh, e, 2) - corner(mesh, e, 0)).cross(corner(mesh, e, 3) - corner(mesh, e, 1));
}
inline Vec3 normal_of(const ShellMesh& mesh, std::size_t e) {
  return area_vector(mesh, e).normalized();
}
inline double area(const ShellMesh& mesh, std::size_t e) {
  return 0.5 * area_vector(mesh, e).norm();
}

inline std::map<Index, std::set<Index>> nodes_by_surface(const ShellMesh& mesh) {
  std::map<Index, std::set<Index>> nodes;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    nodes[mesh.surface[e]].insert(mesh.quads[e].begin(), mesh.quads[e].end());
  return nodes;
}

inline std::set<Index> nodes_of_backing(const ShellMesh& mesh) {
  return nodes_by_surface(mesh).at(0);
}

inline std::set<Index> shared(const std::set<Index>& a, const std::set<Index>& b) {
  std::set<Index> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::inserter(both, both.begin()));
  return both;
}

struct Box {
  Vec3 low, high;
};
inline Box bounding_box(const ShellMesh& mesh, const std::set<Index>& nodes) {
  Box box{node(mesh, *nodes.begin()), node(mesh, *nodes.begin())};
  for (const Index n : nodes) {
    box.low = box.low.cwiseMin(node(mesh, n));
    box.high = box.high.cwiseMax(node(mesh, n));
  }
  return box;
}

struct Strand {
  Vec3 start, tip;
  double length = 0;           ///< m, along its centre line
  std::vector<Vec3> tangents;  ///< of each element, unit vectors
};

/// Of a mesh without tapes: every surface but the backing is one strand, its shells in order from the root.
inline std::vector<Strand> strands_of(const ShellMesh& mesh) {
  std::vector<Strand> strands(static_cast<std::size_t>(mesh.surface_count - 1));
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (mesh.surface[e] == 0) continue;
    Strand& strand = strands[static_cast<std::size_t>(mesh.surface[e] - 1)];
    const Vec3 low = 0.5 * (corner(mesh, e, 0) + corner(mesh, e, 1)),
               high = 0.5 * (corner(mesh, e, 2) + corner(mesh, e, 3));
    if (strand.tangents.empty()) strand.start = low;
    strand.tip = high;
    strand.length += (high - low).norm();
    strand.tangents.push_back((high - low).normalized());
  }
  return strands;
}

}  // namespace tuft::fe::test
