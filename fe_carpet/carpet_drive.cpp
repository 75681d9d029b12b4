/// Driven nodes: grips that pull at a given speed, the forces they bear and the work they do.
#include <algorithm>
#include <stdexcept>

#include "core/error.h"
#include "fe_carpet/carpet_impl.h"

namespace tuft::fe {

void Carpet::drive(std::size_t node, const Vec3& velocity) {
  Impl& c = *impl_;
  if (node >= c.nodes.size()) throw std::logic_error(fmt::format("carpet: no node {}", node));
  if (c.subcycling) throw std::logic_error("carpet: nodes of a subcycled carpet cannot be driven");
  if (c.options.damping > 0) throw std::logic_error("carpet: nodes cannot be driven under damping");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (c.nodes.free_of(axis)[node] != 0 && velocity[static_cast<Eigen::Index>(axis)] != 0)
      throw std::logic_error(
          fmt::format("carpet: node {} is free along axis {}: hold it to drive it", node, axis));
  // A held component has inverse mass 0: it keeps its velocity.
  Vec3 kept = c.nodes.motion.velocity[node];
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (c.nodes.free_of(axis)[node] == 0)
      kept[static_cast<Eigen::Index>(axis)] = velocity[static_cast<Eigen::Index>(axis)];
  c.nodes.motion.velocity.set(node, kept);
  if (std::find(c.grips.nodes.begin(), c.grips.nodes.end(), node) != c.grips.nodes.end()) return;
  c.grips.nodes.push_back(node);
  c.grips.force.emplace_back(0, 0, 0);
}

Vec3 Carpet::Impl::holding_force(std::size_t node, const Vec3Array& force) const {
  Vec3 sum(0, 0, 0);
  for (Index k = nodes.first_corner[node]; k < nodes.first_corner[node + 1]; ++k) {
    const auto corner = static_cast<std::size_t>(nodes.corner_offset[static_cast<std::size_t>(k)]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      sum[static_cast<Eigen::Index>(axis)] += elements.forces[corner + axis * lanes];
  }
  sum -= force[node] + nodes.true_mass_of()[node] * options.gravity;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (nodes.free_of(axis)[node] != 0) sum[static_cast<Eigen::Index>(axis)] = 0;
  return sum;
}

/// Forces are those of the step just made, velocities of held components those during it.
void Carpet::Impl::book_grips(double dt, const Vec3Array& force) {
  grips.last_work = 0;
  for (std::size_t i = 0; i < grips.nodes.size(); ++i) {
    const std::size_t node = grips.nodes[i];
    grips.force[i] = holding_force(node, force);
    grips.last_work += dt * grips.force[i].dot(nodes.motion.velocity[node]);
    grips.impulse += dt * grips.force[i];
    grips.exchanged += dt * grips.force[i].norm();
  }
  grips.work += grips.last_work;
}

Vec3 Carpet::holding_force(std::size_t node) const {
  const Impl::Grips& grips = impl_->grips;
  const auto found = std::find(grips.nodes.begin(), grips.nodes.end(), node);
  if (found == grips.nodes.end()) throw std::logic_error(fmt::format("carpet: node {} is not driven", node));
  return grips.force[static_cast<std::size_t>(found - grips.nodes.begin())];
}

Carpet::GripSums Carpet::grips() const {
  return {impl_->grips.impulse, impl_->grips.exchanged, impl_->grips.work - 0.5 * impl_->grips.last_work};
}

double Carpet::last_step() const {
  return impl_->last_step;
}

}  // namespace tuft::fe
