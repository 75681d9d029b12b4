#include "fe_carpet/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tuft::fe {
namespace {

/// Disjoint sets of 0 .. count - 1 (union by the smaller representative, paths halved).
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::size_t a, std::size_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

bool is_backing(const ShellMesh& mesh, std::size_t e) {
  return mesh.material[e] == 0;
}

constexpr auto nobody = static_cast<std::size_t>(-1);

}  // namespace

std::vector<std::uint8_t> nodes_of_backing(const ShellMesh& mesh) {
  std::vector<std::uint8_t> marks(mesh.nodes.size(), 0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    if (is_backing(mesh, e))
      for (const Index node : mesh.quads[e]) marks[static_cast<std::size_t>(node)] = 1;
  return marks;
}

void number_surfaces(ShellMesh& mesh) {
  const std::vector<std::uint8_t> shared = nodes_of_backing(mesh);
  Groups groups(mesh.quads.size());
  std::vector<std::size_t> first_at(mesh.nodes.size(), nobody);  // first fibre quad met at a node
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (is_backing(mesh, e)) continue;
    for (const Index corner : mesh.quads[e]) {
      const auto node = static_cast<std::size_t>(corner);
      if (shared[node]) continue;
      if (first_at[node] == nobody)
        first_at[node] = e;
      else
        groups.join(e, first_at[node]);
    }
  }
  std::vector<Index> number(mesh.quads.size(), -1);
  mesh.surface.assign(mesh.quads.size(), ShellMesh::backing_surface);
  mesh.surface_count = 1;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (is_backing(mesh, e)) continue;
    Index& surface = number[groups.find(e)];
    if (surface < 0) surface = mesh.surface_count++;
    mesh.surface[e] = surface;
  }
}

void clamp_backing_edge(ShellMesh& mesh) {
  std::vector<std::pair<Index, Index>> sides;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (!is_backing(mesh, e)) continue;
    for (std::size_t i = 0; i < 4; ++i)
      sides.push_back(std::minmax({mesh.quads[e][i], mesh.quads[e][(i + 1) % 4]}));
  }
  std::sort(sides.begin(), sides.end());
  mesh.clamped.assign(mesh.nodes.size(), 0);
  for (std::size_t i = 0; i < sides.size();) {
    const std::size_t first = i;
    while (i < sides.size() && sides[i] == sides[first]) ++i;
    if (i - first > 1) continue;
    mesh.clamped[static_cast<std::size_t>(sides[first].first)] = 1;
    mesh.clamped[static_cast<std::size_t>(sides[first].second)] = 1;
  }
}

ShellMesh without_fibres(const ShellMesh& mesh) {
  const std::vector<std::uint8_t> kept = nodes_of_backing(mesh);
  ShellMesh bare;
  bare.surface_count = 1;
  std::vector<Index> renumbered(kept.size(), -1);
  for (std::size_t n = 0; n < kept.size(); ++n) {
    if (!kept[n]) continue;
    renumbered[n] = static_cast<Index>(bare.nodes.size());
    bare.nodes.push_back(mesh.nodes[n]);
    bare.clamped.push_back(mesh.clamped[n]);
  }
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (!is_backing(mesh, e)) continue;
    std::array<Index, 4> quad = mesh.quads[e];
    for (Index& node : quad) node = renumbered[static_cast<std::size_t>(node)];
    bare.quads.push_back(quad);
    bare.thickness.push_back(mesh.thickness[e]);
    bare.material.push_back(0);
    bare.surface.push_back(ShellMesh::backing_surface);
  }
  return bare;
}

MeshSummary summarise(const ShellMesh& mesh, std::span<const ShellMaterial> materials) {
  MeshSummary sum;
  sum.nodes = mesh.nodes.size();
  sum.clamped_nodes = static_cast<std::size_t>(
      std::count_if(mesh.clamped.begin(), mesh.clamped.end(), [](std::uint8_t mark) { return mark != 0; }));
  sum.strands = static_cast<std::size_t>(mesh.surface_count) - 1;
  const std::vector<std::uint8_t> shared = nodes_of_backing(mesh);
  Groups groups(static_cast<std::size_t>(mesh.surface_count));
  std::vector<std::size_t> first_at(mesh.nodes.size(), nobody);  // first strand met at a node of the backing
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    std::array<Vec3, 4> corner;
    for (std::size_t i = 0; i < 4; ++i) corner[i] = mesh.nodes[static_cast<std::size_t>(mesh.quads[e][i])];
    const double area = 0.5 * (corner[2] - corner[0]).cross(corner[3] - corner[1]).norm();
    const double mass =
        area * mesh.thickness[e] * materials[static_cast<std::size_t>(mesh.material[e])].density;
    (is_backing(mesh, e) ? sum.backing_mass : sum.fibre_mass) += mass;
    ++(is_backing(mesh, e) ? sum.backing_elements : sum.fibre_elements);
    if (is_backing(mesh, e)) continue;
    const auto strand = static_cast<std::size_t>(mesh.surface[e]);
    for (const Index corner_node : mesh.quads[e]) {
      const auto node = static_cast<std::size_t>(corner_node);
      if (!shared[node]) continue;
      if (first_at[node] == nobody)
        first_at[node] = strand;
      else
        groups.join(strand, first_at[node]);
    }
  }
  for (std::size_t s = 1; s < static_cast<std::size_t>(mesh.surface_count); ++s)
    sum.tufts += groups.find(s) == s;
  return sum;
}

}  // namespace tuft::fe
