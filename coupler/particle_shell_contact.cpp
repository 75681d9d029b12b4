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

std::size_t ParticleShellContact::find_parts(std::size_t pair, const Vec3& centre, double radius,
                                             const fe::NodeView& nodes, Parts& parts,
                                             double& soft_distance) const {
  std::size_t count = 0;
  for (std::size_t s = first_element_[pair]; s < first_element_[pair + 1]; ++s) {
    Part candidate;
    candidate.element = elements_[s];
    candidate.at = closest_point_on_facet(centre, corners(nodes, mesh_.quads[candidate.element]));
    candidate.nearness = std::sqrt(candidate.at.distance_squared);
    std::size_t place = count;
    while (place > 0 && candidate.nearness < parts[place - 1].nearness) --place;
    if (place == most_parts) continue;
    count = std::min(count + 1, most_parts);
    for (std::size_t i = count - 1; i > place; --i) parts[i] = parts[i - 1];
    parts[place] = candidate;
  }
  const double touching = radius + 0.5 * mesh_.thickness[parts[0].element];
  const double width = 0.05 * touching;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    parts[i].share = std::exp((parts[0].nearness - parts[i].nearness) / width);
    sum += parts[i].share;
  }
  for (std::size_t i = 0; i < count; ++i) {
    parts[i].share /= sum;
    // A particle whose centre lies on a facet has no direction from it: the facet's own normal serves.
    parts[i].normal = parts[i].nearness > 1e-9 * touching
                          ? Vec3((centre - parts[i].at.point) / parts[i].nearness)
                          : facet_normal(corners(nodes, mesh_.quads[parts[i].element]));
  }
  soft_distance = parts[0].nearness - width * std::log(sum);
  return count;
}

ParticleShellContact::Result ParticleShellContact::evaluate_pair(std::size_t pair,
                                                                 const ParticleView& particles, double ahead,
                                                                 const fe::NodeView& nodes, double dt,
                                                                 double release, double release_before) {
  Result result;
  ContactHistory& history = histories_[pair];
  const Index p = key_point(keys_[pair]);
  const Vec3 centre = particles.position(p) + ahead * particles.velocity(p);
  const double radius = particles.radius[p] * settings_.radius_factor;
  double distance = 0;
  std::size_t count = find_parts(pair, centre, radius, nodes, result.parts, distance);
  const Part& nearest = result.parts[0];
  const double touching = radius + 0.5 * mesh_.thickness[nearest.element];
  const double cover =
      std::min(1.0, 4 * particles.radius[p] * particles.radius[p] / element_area_[nearest.element]);
  const ContactParameters parameters{
      std::min(settings_.stiffness[p], cover * element_stiffness_[nearest.element]),
      settings_.damping_ratio[p], 0.5, settings_.friction[p]};
  if (distance >= touching) {
    result.contact.friction = release_spring(parameters, history);
    history.side = 0;
    history.offset = 0;
    return result;
  }

  // The side a particle came from is remembered: when a thin, soft strand is overrun the push stays on that
  // side. Round the rim of a strand a particle is free to change sides. So is one that leaves a fold of the
  // strand for another: the nearest point jumps then, while the distance of a particle that passes through
  // the sheet goes through zero.
  const Vec3 facet = facet_normal(corners(nodes, mesh_.quads[nearest.element]));
  const double present_side = nearest.normal.dot(facet) >= 0 ? 1 : -1;
  const bool passed = present_side != history.side && history.distance < 0.25 * touching;
  if (history.side == 0 || on_rim(nearest.element, nearest.at.weight) || !passed) history.side = present_side;
  ContactKinematics kinematics;
  if (present_side != history.side) {
    count = 1;
    result.parts[0].share = 1;
    result.parts[0].normal = -result.parts[0].normal;
    distance = -nearest.nearness;
  }
  history.distance = distance;
  Vec3 gradient(0, 0, 0);
  for (std::size_t i = 0; i < count; ++i) gradient += result.parts[i].share * result.parts[i].normal;
  const double steepness = gradient.norm();
  kinematics.overlap = touching - distance - history.offset * release;
  if (!(kinematics.overlap > 0) || !(steepness > 1e-6)) {
    result.contact.friction = release_spring(parameters, history);
    return result;
  }
  kinematics.gradient = steepness;
  kinematics.normal = gradient / steepness;

  Vec3 shell_velocity(0, 0, 0);
  double inverse_shell_mass = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Part& part = result.parts[i];
    const auto& quad = mesh_.quads[part.element];
    for (int c = 0; c < 4; ++c) {
      const double w = part.at.weight[c];
      shell_velocity += part.share * w * Vec3(nodes.vx[quad[c]], nodes.vy[quad[c]], nodes.vz[quad[c]]);
      inverse_shell_mass += part.share * w * w / node_mass_[quad[c]];
    }
  }
  result.arm = -radius * kinematics.normal;
  kinematics.velocity = particles.velocity(p) + particles.spin(p).cross(result.arm) - shell_velocity;
  kinematics.effective_mass = 1.0 / (1.0 / particles.mass[p] + inverse_shell_mass);
  result.contact = compute_contact_force(parameters, kinematics, dt, history);
  result.released =
      release_work(parameters.stiffness, kinematics.overlap, history.offset * (release_before - release));
  result.softening = settings_.stiffness[p] / parameters.stiffness;
  result.normal = kinematics.normal;
  result.gradient = steepness;
  result.part_count = count;
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
    if (r.part_count == 0) continue;
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
    // Each facet takes its own normal's part of the push, which is what the soft minimum's energy asks for.
    const double push = r.contact.force.dot(r.normal);
    const Vec3 along = r.contact.force - push * r.normal;
    for (std::size_t i = 0; i < r.part_count; ++i) {
      const Part& part = r.parts[i];
      const Vec3 force = part.share * (push / r.gradient * part.normal + along);
      const auto& quad = mesh_.quads[part.element];
      for (int c = 0; c < 4; ++c) node_force.add(quad[c], -part.at.weight[c] * force);
    }
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
