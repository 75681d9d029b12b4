#include "coupler/particle_shell_contact.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/geometry.h"
#include "core/parallel.h"
#include "coupler/contact_state_io.h"
#include "coupler/particle_grid.h"

namespace tuft::coupler {
namespace {

struct Candidate {
  PairKey key;
  Index element;
  bool operator<(const Candidate& other) const {
    return std::tie(key, element) < std::tie(other.key, other.element);
  }
};

std::array<Vec3, 4> corners(const fe::NodeView& nodes, const std::array<Index, 4>& quad) {
  std::array<Vec3, 4> result;
  for (int c = 0; c < 4; ++c) result[c] = Vec3(nodes.x[quad[c]], nodes.y[quad[c]], nodes.z[quad[c]]);
  return result;
}

/// Unit normal of a facet from its diagonals; its sense only tells the two sides apart.
Vec3 facet_normal(const std::array<Vec3, 4>& corner) {
  return (corner[2] - corner[0]).cross(corner[3] - corner[1]).normalized();
}

/// Edges that no second element of the same surface shares.
std::vector<std::array<bool, 4>> find_outer_edges(const fe::ShellMesh& mesh) {
  std::map<std::tuple<Index, Index, Index>, int> users;
  const auto edge = [&](std::size_t e, int c) {
    const Index a = mesh.quads[e][c], b = mesh.quads[e][(c + 1) % 4];
    return std::make_tuple(mesh.surface[e], std::min(a, b), std::max(a, b));
  };
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (int c = 0; c < 4; ++c) ++users[edge(e, c)];
  std::vector<std::array<bool, 4>> outer(mesh.quads.size());
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (int c = 0; c < 4; ++c) outer[e][c] = users[edge(e, c)] == 1;
  return outer;
}

}  // namespace

ParticleShellContact::ParticleShellContact(const fe::ShellMesh& mesh, std::span<const double> node_stiffness,
                                           std::span<const double> node_mass, ParticleShellSettings settings)
    : mesh_(mesh),
      outer_edge_(find_outer_edges(mesh)),
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
  for (const double r : particles.radius)
    largest_radius = std::max(largest_radius, r * settings_.radius_factor);
  const ParticleGrid grid(particles, 2 * (largest_radius + skin));

  const std::size_t elements = mesh_.quads.size();
  std::vector<std::vector<Candidate>> found(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel
  {
    auto& mine = found[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (std::size_t e = 0; e < elements; ++e) {
      const auto corner = corners(nodes, mesh_.quads[e]);
      const double thin = 0.5 * mesh_.thickness[e] + skin;
      const Vec3 low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2].cwiseMin(corner[3]));
      const Vec3 high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2].cwiseMax(corner[3]));
      const Vec3 reach = Vec3::Constant(thin + largest_radius);
      grid.for_each_in_box(low - reach, high + reach, [&](Index p) {
        const double touching = particles.radius[p] * settings_.radius_factor + thin;
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
  results_.assign(keys_.size(), {});

  if (!searched_ && keep_overlap) {
    for (std::size_t g = 0; g < keys_.size(); ++g) {
      const Index p = key_point(keys_[g]);
      double overlap = 0;
      for (std::size_t s = first_element_[g]; s < first_element_[g + 1]; ++s) {
        const Index e = elements_[s];
        const double distance = std::sqrt(
            closest_point_on_facet(particles.position(p), corners(nodes, mesh_.quads[e])).distance_squared);
        overlap = std::max(
            overlap, particles.radius[p] * settings_.radius_factor + 0.5 * mesh_.thickness[e] - distance);
      }
      histories_[g].offset = overlap;
      if (overlap > 0) ++initial_overlap_.pairs;
      initial_overlap_.largest = std::max(initial_overlap_.largest, overlap);
    }
  }
  searched_ = true;
}

bool ParticleShellContact::on_rim(Index element, const std::array<double, 4>& weight) const {
  const auto& outer = outer_edge_[element];
  int corners_in_use = 0, last = 0;
  for (int c = 0; c < 4; ++c)
    if (weight[c] > 0) {
      ++corners_in_use;
      last = c;
    }
  if (corners_in_use == 1) return outer[last] || outer[(last + 3) % 4];
  if (corners_in_use != 2) return false;
  for (int c = 0; c < 4; ++c)
    if (weight[c] > 0 && weight[(c + 1) % 4] > 0) return outer[c];
  return false;  // on the diagonal between the two triangles of the facet
}

ParticleShellContact::Result ParticleShellContact::evaluate_pair(std::size_t pair,
                                                                 const ParticleView& particles, double ahead,
                                                                 const fe::NodeView& nodes, double dt,
                                                                 double release, double release_before) {
  Result result;
  ContactHistory& history = histories_[pair];
  const Index p = key_point(keys_[pair]);
  const Vec3 centre = particles.position(p) + ahead * particles.velocity(p);

  const std::size_t first = first_element_[pair];
  Index element = elements_[first];
  FacetPoint nearest = closest_point_on_facet(centre, corners(nodes, mesh_.quads[element]));
  for (std::size_t s = first + 1; s < first_element_[pair + 1]; ++s) {
    const FacetPoint candidate = closest_point_on_facet(centre, corners(nodes, mesh_.quads[elements_[s]]));
    if (candidate.distance_squared < nearest.distance_squared) {
      nearest = candidate;
      element = elements_[s];
    }
  }
  const double radius = particles.radius[p] * settings_.radius_factor;
  const double touching = radius + 0.5 * mesh_.thickness[element];
  const double cover = std::min(1.0, 4 * particles.radius[p] * particles.radius[p] / element_area_[element]);
  const ContactParameters parameters{std::min(settings_.stiffness[p], cover * element_stiffness_[element]),
                                     settings_.damping_ratio[p], 0.5, settings_.friction[p]};
  if (nearest.distance_squared >= touching * touching) {
    result.contact.friction = release_spring(parameters, history);
    history.side = 0;
    history.offset = 0;
    return result;
  }

  // The side a particle came from is remembered: when a thin, soft strand is overrun the push stays on that
  // side. Round the rim of a strand a particle is free to change sides. So is one that leaves a fold of the
  // strand for another: the nearest point jumps then, while the distance of a particle that passes through
  // the sheet goes through zero.
  const Vec3 facet = facet_normal(corners(nodes, mesh_.quads[element]));
  const Vec3 apart = centre - nearest.point;
  const double nearness = std::sqrt(nearest.distance_squared);
  const double present_side = apart.dot(facet) >= 0 ? 1 : -1;
  const bool fresh = history.side == 0;
  const bool passed = present_side != history.side && history.distance < 0.25 * touching;
  if (fresh || on_rim(element, nearest.weight) || !passed) history.side = present_side;
  const double distance = present_side == history.side ? nearness : -nearness;
  history.distance = distance;
  ContactKinematics kinematics;
  kinematics.normal = nearness > 1e-9 * touching ? Vec3(apart / distance) : Vec3(history.side * facet);
  const double overlap = touching - distance;
  const double kept = history.offset * release;
  kinematics.overlap = overlap - kept;
  if (kinematics.overlap <= 0) {
    result.contact.friction = release_spring(parameters, history);
    return result;
  }

  const auto& quad = mesh_.quads[element];
  Vec3 shell_velocity(0, 0, 0);
  double inverse_shell_mass = 0;
  for (int c = 0; c < 4; ++c) {
    const double w = nearest.weight[c];
    shell_velocity += w * Vec3(nodes.vx[quad[c]], nodes.vy[quad[c]], nodes.vz[quad[c]]);
    inverse_shell_mass += w * w / node_mass_[quad[c]];
  }
  result.arm = -radius * kinematics.normal;
  kinematics.velocity = particles.velocity(p) + particles.spin(p).cross(result.arm) - shell_velocity;
  kinematics.effective_mass = 1.0 / (1.0 / particles.mass[p] + inverse_shell_mass);
  result.contact = compute_contact_force(parameters, kinematics, dt, history);
  result.released =
      release_work(parameters.stiffness, kinematics.overlap, history.offset * (release_before - release));
  result.softening = settings_.stiffness[p] / parameters.stiffness;
  result.weight = nearest.weight;
  result.element = element;
  return result;
}

void ParticleShellContact::evaluate(const ParticleView& particles, double ahead, const fe::NodeView& nodes,
                                    double dt, double release, double release_before, Vec3Array& node_force,
                                    ContactImpulses& impulses) {
  const std::size_t pairs = keys_.size();
#pragma omp parallel for schedule(static) if (pairs > 256)
  for (std::size_t g = 0; g < pairs; ++g)
    results_[g] = evaluate_pair(g, particles, ahead, nodes, dt, release, release_before);

  // Serial: few pairs touch, and the order of additions must not depend on the threads.
  energy_.elastic = 0;
  touching_ = 0;
  double softening = 0;
  Vec3 given(0, 0, 0);
  for (std::size_t g = 0; g < pairs; ++g) {
    const Result& r = results_[g];
    energy_.friction += r.contact.friction;
    if (r.element < 0) continue;
    ++touching_;
    softening += r.softening;
    energy_.elastic += r.contact.elastic;
    energy_.damped += r.contact.damped;
    energy_.released += r.released;
    const Index p = key_point(keys_[g]);
    const Vec3 impulse = r.contact.force * dt;
    impulses.linear.add(p, impulse);
    impulses.angular.add(p, r.arm.cross(impulse));
    given += impulse;
    const auto& quad = mesh_.quads[r.element];
    for (int c = 0; c < 4; ++c) node_force.add(quad[c], -r.weight[c] * r.contact.force);
  }
  impulse_given_ += given;
  softening_ = touching_ > 0 ? softening / static_cast<double>(touching_) : 1.0;
}

void ParticleShellContact::save(h5::Group& group) const {
  save_pairs(group, keys_, histories_);
  save_energy(group, energy_);
  group.write_scalar("initial_overlap_pairs", static_cast<std::uint64_t>(initial_overlap_.pairs));
  group.write_scalar("initial_overlap_largest", initial_overlap_.largest);
}

void ParticleShellContact::load(const h5::Group& group) {
  load_pairs(group, keys_, histories_);
  energy_ = load_energy(group);
  initial_overlap_.pairs = group.read_count("initial_overlap_pairs");
  initial_overlap_.largest = group.read_double("initial_overlap_largest");
  searched_ = true;  // the next search fills in the elements and keeps these histories
}

}  // namespace tuft::coupler
