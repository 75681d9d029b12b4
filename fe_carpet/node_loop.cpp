#include <algorithm>
#include <array>

#include "fe_carpet/erosion.h"
#include "fe_carpet/node_arrays.h"

namespace tuft::fe {

namespace {

void add_true_weights(const ShellMesh& mesh, const ElementArrays& elements, NodeArrays& nodes) {
  nodes.true_mass.assign(nodes.size(), 0.0);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    for (const Index n : mesh.quads[e])
      nodes.true_mass[static_cast<std::size_t>(n)] +=
          elements.true_mass[static_cast<std::size_t>(elements.slot[e])] / 4;
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t n = 0; n < nodes.size(); ++n)
      nodes.weight[c].push_back(nodes.free_of(c)[n] * nodes.true_mass[n] / nodes.mass[n]);
}

}  // namespace

NodeArrays make_node_arrays(const ShellMesh& mesh, const ElementArrays& elements) {
  NodeArrays nodes;
  const std::size_t count = mesh.nodes.size();
  nodes.motion.position = positions_with_spares(mesh, elements);
  nodes.motion.velocity.assign(nodes.motion.position.size(), 0.0);
  nodes.motion.angular_velocity.assign(nodes.motion.position.size(), 0.0);
  nodes.clamped = mesh.clamped;
  nodes.mass.assign(count, 0.0);
  nodes.inertia.assign(count, 0.0);
  nodes.first_corner.assign(count + 1, 0);
  for (const auto& quad : mesh.quads)
    for (const Index n : quad) ++nodes.first_corner[static_cast<std::size_t>(n) + 1];
  for (std::size_t n = 0; n < count; ++n) nodes.first_corner[n + 1] += nodes.first_corner[n];
  nodes.corner_offset.resize(4 * mesh.quads.size());
  std::vector<Index> next(nodes.first_corner.begin(), nodes.first_corner.end() - 1);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]);
    const double mass = elements.mass[slot] / 4;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto n = static_cast<std::size_t>(mesh.quads[e][corner]);
      nodes.mass[n] += mass;
      nodes.inertia[n] += mass * elements.inertia_ratio[slot];
      const std::size_t offset = slot / lanes * batch_values + corner * corner_values + slot % lanes;
      nodes.corner_offset[static_cast<std::size_t>(next[n]++)] = static_cast<Index>(offset);
    }
  }
  for (std::size_t n = 0; n < count; ++n) {
    const double is_free = mesh.clamped[n] ? 0.0 : 1.0;
    nodes.free.push_back(is_free);
    nodes.inverse_mass.push_back(is_free / nodes.mass[n]);
    nodes.inverse_inertia.push_back(is_free / nodes.inertia[n]);
  }
  for (std::size_t c = 0; c < 6 && !mesh.constraints.empty(); ++c)
    for (std::size_t n = 0; n < count; ++n) {
      const double is_free = mesh.clamped[n] || (mesh.constraints[n] >> c & 1) ? 0.0 : 1.0;
      nodes.component_free[c].push_back(is_free);
      nodes.component_inverse[c].push_back(is_free / (c < 3 ? nodes.mass[n] : nodes.inertia[n]));
    }
  if (!elements.true_mass.empty()) add_true_weights(mesh, elements, nodes);
  nodes.sums.resize((count + nodes_per_block - 1) / nodes_per_block);
  return nodes;
}

namespace {

/// Internal forces and moments of a block of nodes.
struct BlockForces {
  std::array<std::array<double, nodes_per_block>, 6> component;
};

void gather_forces(const Index* first_corner, const Index* corner_offset, const PackedDoubles& corners,
                   std::size_t begin, std::size_t end, BlockForces& block) {
  for (std::size_t n = begin; n < end; ++n) {
    std::array<double, 6> sum{};
    for (Index k = first_corner[n]; k < first_corner[n + 1]; ++k) {
      const double* corner = &corners[static_cast<std::size_t>(corner_offset[k])];
      for (std::size_t c = 0; c < 6; ++c) sum[c] += corner[c * lanes];
    }
    for (std::size_t c = 0; c < 6; ++c) block.component[c][n - begin] = sum[c];
  }
}

struct ComponentSums {
  double kinetic = 0, external_work = 0, damping_work = 0, impulse = 0, clamp_impulse = 0;
};

/// One translational component: m (v+ - v-)/dt = f - f_int - c m (v+ + v-)/2, so that the damping's work over
/// the step is exactly c m ((v+ + v-)/2)^2 dt and the load's f (v+ + v-)/2 dt.
ComponentSums move_component(const NodeArrays& nodes, std::size_t c, const double* internal,
                             const double* load, double gravity, const NodeStep& step, std::size_t begin,
                             std::size_t end, double* velocity, double* position) {
  const double dt = step.length, damping = step.damping, scale = 1 / (1 + 0.5 * damping * dt);
  const double kept = (1 - 0.5 * damping * dt) * scale, kick = dt * scale, taken_off = step.taken_off * kick;
  const double *is_free = nodes.free_of(c), *inverse = nodes.inverse_of(c), *weight = nodes.weight_of(c);
  double kinetic = 0, external_work = 0, damping_work = 0, impulse = 0, clamp_impulse = 0;
#pragma omp simd reduction(+ : kinetic, external_work, damping_work, impulse, clamp_impulse)
  for (std::size_t n = begin; n < end; ++n) {
    const double given = load[n];
    const double acceleration = (given - internal[n - begin]) * inverse[n] + gravity * weight[n];
    const double before = velocity[n] - taken_off * acceleration;
    const double after = kept * before + kick * acceleration;
    const double mean = 0.5 * (before + after);
    velocity[n] = after;
    position[n] += dt * after;
    kinetic += nodes.mass[n] * (before * before + after * after);
    external_work += given * mean;
    damping_work += nodes.mass[n] * mean * mean;
    impulse += given * is_free[n];
    clamp_impulse += given * (1 - is_free[n]);
  }
  return {0.25 * kinetic, dt * external_work, dt * damping * damping_work, dt * impulse, dt * clamp_impulse};
}

template <bool Loaded>
ComponentSums turn_component(const NodeArrays& nodes, std::size_t c, const double* internal,
                             const double* load, const NodeStep& step, std::size_t begin, std::size_t end,
                             double* velocity) {
  const double* inverse = nodes.inverse_of(c + 3);
  const double dt = step.length, damping = step.damping, scale = 1 / (1 + 0.5 * damping * dt);
  const double kept = (1 - 0.5 * damping * dt) * scale, kick = dt * scale, taken_off = step.taken_off * kick;
  double kinetic = 0, external_work = 0, damping_work = 0;
#pragma omp simd reduction(+ : kinetic, external_work, damping_work)
  for (std::size_t n = begin; n < end; ++n) {
    const double given = Loaded ? load[n] : 0.0;
    const double acceleration = (given - internal[n - begin]) * inverse[n];
    const double before = velocity[n] - taken_off * acceleration;
    const double after = kept * before + kick * acceleration;
    const double mean = 0.5 * (before + after);
    velocity[n] = after;
    kinetic += nodes.inertia[n] * (before * before + after * after);
    external_work += given * mean;
    damping_work += nodes.inertia[n] * mean * mean;
  }
  return {0.25 * kinetic, dt * external_work, dt * damping * damping_work, 0, 0};
}

double largest_speed_squared(const Vec3Array& velocity, std::size_t begin, std::size_t end) {
  const double *vx = velocity.x.data(), *vy = velocity.y.data(), *vz = velocity.z.data();
  double largest = 0;
#pragma omp simd reduction(max : largest)
  for (std::size_t n = begin; n < end; ++n)
    largest = std::max(largest, vx[n] * vx[n] + vy[n] * vy[n] + vz[n] * vz[n]);
  return largest;
}

}  // namespace

void update_node_block(NodeArrays& nodes, const ElementArrays& elements, const Vec3Array& force,
                       const Vec3Array* moment, const NodeStep& step, std::size_t block) {
  const std::size_t begin = block * nodes_per_block, end = std::min(nodes.size(), begin + nodes_per_block);
  BlockForces internal;
  const bool some = step.first_corner != nullptr;
  gather_forces(some ? step.first_corner : nodes.first_corner.data(),
                some ? step.corner_offset : nodes.corner_offset.data(), elements.forces, begin, end,
                internal);

  NodeMotion& motion = nodes.motion;
  const std::array<double*, 3> position{motion.position.x.data(), motion.position.y.data(),
                                        motion.position.z.data()};
  const std::array<double*, 3> velocity{motion.velocity.x.data(), motion.velocity.y.data(),
                                        motion.velocity.z.data()};
  const std::array<double*, 3> spin{motion.angular_velocity.x.data(), motion.angular_velocity.y.data(),
                                    motion.angular_velocity.z.data()};
  const std::array<const double*, 3> load{force.x.data(), force.y.data(), force.z.data()};
  std::array<const double*, 3> couple{};
  if (moment) couple = {moment->x.data(), moment->y.data(), moment->z.data()};

  NodeSums& sums = nodes.sums[block];
  sums.kinetic = sums.last_external_work = sums.last_damping_work = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const ComponentSums linear = move_component(nodes, c, internal.component[c].data(), load[c],
                                                step.gravity[static_cast<Eigen::Index>(c)], step, begin, end,
                                                velocity[c], position[c]);
    const ComponentSums angular =
        (moment ? turn_component<true> : turn_component<false>)(nodes, c, internal.component[c + 3].data(),
                                                                couple[c], step, begin, end, spin[c]);
    sums.kinetic += linear.kinetic + angular.kinetic;
    sums.last_external_work += linear.external_work + angular.external_work;
    sums.last_damping_work += linear.damping_work + angular.damping_work;
    sums.impulse_received[c] += linear.impulse;
    sums.impulse_to_clamps[c] += linear.clamp_impulse;
  }
  sums.external_work += sums.last_external_work;
  sums.damping_work += sums.last_damping_work;
  sums.largest_speed_squared = largest_speed_squared(motion.velocity, begin, end);
}

}  // namespace tuft::fe
