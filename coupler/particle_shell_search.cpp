// Which particles may touch which surfaces, and what a surface is made of.
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/parallel.h"
#include "coupler/particle_grid.h"
#include "coupler/particle_shell_contact.h"

namespace tuft::coupler {
namespace {

struct Candidate {
  PairKey key;
  Index element;
  bool operator<(const Candidate& other) const {
    return std::tie(key, element) < std::tie(other.key, other.element);
  }
};

}  // namespace

std::vector<std::array<bool, 4>> find_outer_edges(const fe::ShellMesh& mesh,
                                                  std::span<const std::uint8_t> eroded) {
  std::map<std::tuple<Index, Index, Index>, int> users;
  const auto edge = [&](std::size_t e, int c) {
    const Index a = mesh.quads[e][c], b = mesh.quads[e][(c + 1) % 4];
    return std::make_tuple(mesh.surface[e], std::min(a, b), std::max(a, b));
  };
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (int c = 0; c < 4 && (eroded.empty() || !eroded[e]); ++c) ++users[edge(e, c)];
  std::vector<std::array<bool, 4>> outer(mesh.quads.size());
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (int c = 0; c < 4; ++c) outer[e][c] = users[edge(e, c)] == 1;
  return outer;
}

ParticleShellContact::ParticleShellContact(const fe::ShellMesh& mesh, std::span<const double> node_stiffness,
                                           std::span<const double> node_mass, ParticleShellSettings settings)
    : mesh_(mesh),
      outer_edge_(find_outer_edges(mesh, {})),
      node_mass_(node_mass.begin(), node_mass.end()),
      settings_(std::move(settings)) {
  element_stiffness_.reserve(mesh.quads.size());
  for (const auto& quad : mesh.quads) {
    double softest = node_stiffness[quad[0]];
    for (int c = 1; c < 4; ++c) softest = std::min(softest, node_stiffness[quad[c]]);
    element_stiffness_.push_back(settings_.shell_share * softest);
    const Vec3 diagonal_a = mesh.nodes[quad[2]] - mesh.nodes[quad[0]],
               diagonal_b = mesh.nodes[quad[3]] - mesh.nodes[quad[1]];
    element_area_.push_back(0.5 * diagonal_a.cross(diagonal_b).norm());
  }
}

void ParticleShellContact::search(const ParticleView& particles, const fe::NodeView& nodes, double skin,
                                  bool keep_overlap) {
  double largest_radius = 0;
  for (std::size_t p = 0; p < particles.size(); ++p)
    largest_radius = std::max(largest_radius, particles.largest_radius(p));
  const ParticleGrid grid(particles, 2 * (largest_radius + skin));

  const std::size_t elements = mesh_.quads.size();
  std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel
  {
    auto& mine = found[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t e = 0; e < elements; ++e) {
      if (!eroded_.empty() && eroded_[e]) continue;
      const auto corner = facet_corners(nodes, mesh_.quads[e]);
      const double thin = 0.5 * mesh_.thickness[e] + skin;
      const Vec3 low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2].cwiseMin(corner[3]));
      const Vec3 high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2].cwiseMax(corner[3]));
      const Vec3 reach = Vec3::Constant(thin + largest_radius);
      grid.for_each_in_box(low - reach, high + reach, [&](Index p) {
        const double touching = contact_radius(p, mesh_.surface[e], particles) + thin;
        if (particles.is_expelled(static_cast<std::size_t>(p))) return;
        if (closest_point_on_facet(particles.position(p), corner).distance_squared < touching * touching)
          mine.push_back({make_key(p, mesh_.surface[e]), static_cast<Index>(e)});
      });
    }
  }
  std::vector<Candidate> candidates;
  for (const auto& part : found) candidates.insert(candidates.end(), part.begin(), part.end());
  std::sort(candidates.begin(), candidates.end());  // a total order: the same list for any thread count

  std::vector<PairKey> keys;
  first_element_.clear();
  elements_.clear();
  for (const Candidate& candidate : candidates) {
    if (keys.empty() || keys.back() != candidate.key) {
      keys.push_back(candidate.key);
      first_element_.push_back(elements_.size());
    }
    elements_.push_back(candidate.element);
  }
  first_element_.push_back(elements_.size());
  histories_ = carry_over(keys_, histories_, keys);
  keys_ = std::move(keys);
  apart_until_.assign(keys_.size(), 0.0);
  travel_ = {};
  blocks_.resize((keys_.size() + block_pairs - 1) / block_pairs);
  if (!searched_ && keep_overlap) record_initial_overlap(particles, nodes);
  searched_ = true;
}

void ParticleShellContact::record_initial_overlap(const ParticleView& particles, const fe::NodeView& nodes) {
  SoftOverlap overlap;
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    find_overlap(g, particles.position(key_point(keys_[g])), particles, nodes, overlap);
    if (overlap.count == 0) continue;
    histories_[g].offset = overlap.parts[0].root * overlap.value;
    ++initial_overlap_.pairs;
    initial_overlap_.largest = std::max(initial_overlap_.largest, overlap.parts[0].overlap);
  }
}

}  // namespace tuft::coupler
