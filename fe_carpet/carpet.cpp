#include "fe_carpet/carpet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fe_carpet/carpet_impl.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe {
namespace {

/// Below this many elements (a step of some 0.1 ms) threads would gain less than they may lose waiting for
/// each other. Results do not depend on it.
constexpr std::size_t threads_pay_above = 1000;

void check_materials(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials) {
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const ShellMaterial& material = materials[m];
    if (!(material.young_modulus > 0) || !std::isfinite(material.young_modulus))
      throw_input_error("shell material {}: Young's modulus is {} Pa; it must be positive", m,
                        material.young_modulus);
    if (!(material.density > 0) || !std::isfinite(material.density))
      throw_input_error("shell material {}: density is {} kg/m^3; it must be positive", m, material.density);
    if (!(material.poisson_ratio >= 0 && material.poisson_ratio < 0.5))
      throw_input_error("shell material {}: Poisson's ratio is {}; it must be in [0, 0.5)", m,
                        material.poisson_ratio);
  }
  for (std::size_t e = 0; e < mesh.material.size(); ++e)
    if (static_cast<std::size_t>(mesh.material[e]) >= materials.size())
      throw_input_error("carpet mesh: element {} has material {}, but only {} are given", e, mesh.material[e],
                        materials.size());
}

void check_damping(double rate) {
  if (!(rate >= 0) || !std::isfinite(rate))
    throw_input_error("carpet damping is {} 1/s; it must be zero or more", rate);
}

void check_options(const CarpetOptions& options) {
  if (options.thickness_points < 1 || options.thickness_points > 5)
    throw_input_error("carpet: {} thickness points; choose 1 to 5", options.thickness_points);
  if (!(options.hourglass_coefficient >= 0 && options.hourglass_coefficient <= 0.2))
    throw_input_error("carpet: hourglass coefficient {}; it must be in [0, 0.2]",
                      options.hourglass_coefficient);
  check_damping(options.damping);
  if (!options.gravity.allFinite()) throw_input_error("carpet: gravity is not finite");
}

/// Per node the sum over its elements of (m_e / 4) / dt_e^2, with dt_e = 2 / frequency bound of the element.
/// Never more than the node's mass over the square of the stable step of the mesh.
std::vector<double> contact_stiffness_of_nodes(const ElementArrays& elements, const ShellMesh& mesh) {
  std::vector<double> stiffness(mesh.nodes.size(), 0.0);
  std::vector<double> frequency_squared(elements.element.size());
  for (std::size_t batch = 0; batch < elements.batch_count; ++batch) {
    const Pack bound = batch_frequency_squared(elements, mesh.nodes, batch);
    for (std::size_t lane = 0; lane < lanes; ++lane) frequency_squared[batch * lanes + lane] = bound[lane];
  }
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]);
    for (const Index node : mesh.quads[e])
      stiffness[static_cast<std::size_t>(node)] += elements.mass[slot] / 4 * frequency_squared[slot] / 4;
  }
  return stiffness;
}

ShellMesh checked(ShellMesh mesh, const std::vector<ShellMaterial>& materials, const CarpetOptions& options) {
  check_mesh(mesh);
  check_materials(mesh, materials);
  check_options(options);
  return mesh;
}

}  // namespace

Carpet::Impl::Impl(ShellMesh mesh_in, std::vector<ShellMaterial> materials_in,
                   const CarpetOptions& options_in)
    : mesh(checked(std::move(mesh_in), materials_in, options_in)),
      materials(std::move(materials_in)),
      options(options_in),
      elements(make_element_arrays(mesh, materials, options)),
      nodes(make_node_arrays(mesh, elements)),
      update_elements(element_block_function(options.thickness_points)),
      contact_stiffness(contact_stiffness_of_nodes(elements, mesh)) {
  for (std::size_t m = 0; m < materials.size(); ++m)
    wave_speed = std::max(wave_speed, std::sqrt(elements.law[m].direct / materials[m].density));
  initial_stable_step = 2 / std::sqrt(largest_frequency_squared());
}

double Carpet::Impl::largest_frequency_squared() const {
  double largest = 0;
#pragma omp parallel for schedule(static) \
    reduction(max                         \
              : largest) if (elements.element_count > threads_pay_above)
  for (std::size_t batch = 0; batch < elements.batch_count; ++batch)
    largest = std::max(largest, stdx::hmax(batch_frequency_squared(elements, nodes.motion.position, batch)));
  return largest;
}

/// Elements write their own corners, then nodes gather them: no two threads write one value.
void Carpet::Impl::move(double dt, const Vec3Array& force) {
  const NodeStep node_step{dt, options.damping, options.gravity};
#pragma omp parallel if (elements.element_count > threads_pay_above)
  {
#pragma omp for schedule(static)
    for (std::size_t block = 0; block < elements.block_count; ++block)
      update_elements(elements, nodes.motion, last_step, block);
#pragma omp for schedule(static)
    for (std::size_t block = 0; block < nodes.sums.size(); ++block)
      update_node_block(nodes, elements, force, node_step, block);
  }
}

namespace {

constexpr std::array<char, 3> axis_name{'x', 'y', 'z'};

/// Beyond this a square overflows: as good as not finite.
constexpr double overflow = 1e150;

/// A value of an array of vectors that is not finite.
struct BadValue {
  std::size_t node = 0;
  char axis = 0;
  double value = 0;
};

bool find_bad_value(const Vec3Array& values, BadValue& bad) {
  const std::array<const std::vector<double>*, 3> components{&values.x, &values.y, &values.z};
  for (std::size_t n = 0; n < values.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c)
      if (const double value = (*components[c])[n]; !(std::abs(value) < overflow)) {
        bad = {n, axis_name[c], value};
        return true;
      }
  return false;
}

/// First element with a stress or hourglass force that is not finite, or -1.
Index find_bad_element(const ElementArrays& elements) {
  const std::size_t values = state_values(elements.thickness_points);
  for (std::size_t e = 0; e < elements.element_count; ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]);
    const double* first = &elements.state[slot / lanes * values * lanes + slot % lanes];
    for (std::size_t v = 0; v < values; ++v)
      if (!std::isfinite(first[v * lanes])) return static_cast<Index>(e);
  }
  return -1;
}

}  // namespace

/// The kinetic energy of every node is in the sums: a value that is not finite anywhere shows there at the
/// latest one step after it arose. Faster than the wave speed, a node strains its elements by more than 1: no
/// step of this carpet that is still stable does that.
void Carpet::Impl::stop_on_instability(double dt, const Vec3Array& force) const {
  double kinetic = 0, speed_squared = 0;
  for (const NodeSums& sums : nodes.sums) {
    kinetic += sums.kinetic;
    speed_squared = std::max(speed_squared, sums.largest_speed_squared);
  }
  if (std::isfinite(kinetic) && speed_squared <= wave_speed * wave_speed) return;

  const std::string when =
      fmt::format("at t = {:.9g} s (carpet step {} of {:.4g} s; stable step as built {:.4g} s)", time, steps,
                  dt, initial_stable_step);
  BadValue bad;
  if (find_bad_value(force, bad))
    throw_run_error("carpet: load {} on node {} is {} N {}; the contact or load that gave it is at fault",
                    bad.axis, bad.node, bad.value, when);
  if (const Index element = find_bad_element(elements); element >= 0)
    throw_run_error(
        "carpet: stress of element {} (surface {}) is not finite {}; take a smaller step or softer contact",
        element, mesh.surface[static_cast<std::size_t>(element)], when);
  if (find_bad_value(nodes.motion.velocity, bad))
    throw_run_error("carpet: velocity {} of node {} is {} m/s {}; take a smaller step or softer contact",
                    bad.axis, bad.node, bad.value, when);
  if (find_bad_value(nodes.motion.angular_velocity, bad))
    throw_run_error(
        "carpet: angular velocity {} of node {} is {} rad/s {}; take a smaller step or softer contact",
        bad.axis, bad.node, bad.value, when);
  std::size_t fastest = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes.motion.velocity[n].squaredNorm() > nodes.motion.velocity[fastest].squaredNorm()) fastest = n;
  throw_run_error(
      "carpet: node {} moves at {:.4g} m/s, faster than the wave speed of {:.4g} m/s, {}: unstable; take a "
      "smaller step or softer contact",
      fastest, nodes.motion.velocity[fastest].norm(), wave_speed, when);
}

Carpet::Carpet(ShellMesh mesh, std::vector<ShellMaterial> materials, const CarpetOptions& options)
    : impl_(std::make_unique<Impl>(std::move(mesh), std::move(materials), options)) {}

Carpet::~Carpet() = default;

const ShellMesh& Carpet::mesh() const {
  return impl_->mesh;
}

NodeView Carpet::nodes() const {
  const NodeMotion& motion = impl_->nodes.motion;
  return {motion.position.x, motion.position.y, motion.position.z, motion.velocity.x,
          motion.velocity.y, motion.velocity.z, impl_->nodes.mass, impl_->nodes.clamped};
}

double Carpet::stable_step() const {
  return 2 / std::sqrt(impl_->largest_frequency_squared());
}

std::span<const double> Carpet::node_contact_stiffness() const {
  return impl_->contact_stiffness;
}

void Carpet::step(double dt, const Vec3Array& force) {
  if (!(dt > 0) || !std::isfinite(dt)) throw std::logic_error(fmt::format("carpet step of {} s", dt));
  if (force.x.size() != impl_->nodes.size() || force.y.size() != force.x.size() ||
      force.z.size() != force.x.size())
    throw std::logic_error(fmt::format("carpet: {} loads for {} nodes", force.x.size(), impl_->nodes.size()));
  impl_->move(dt, force);
  impl_->stop_on_instability(dt, force);
  impl_->last_step = dt;
  impl_->time += dt;
  ++impl_->steps;
}

void Carpet::set_damping(double rate) {
  check_damping(rate);
  impl_->options.damping = rate;
}

CarpetEnergy Carpet::energy() const {
  const Impl& c = *impl_;
  CarpetEnergy energy;
  for (const double work : c.elements.strain_work) energy.strain += work;
  for (const double work : c.elements.hourglass_work) energy.hourglass += work;
  for (const NodeSums& sums : c.nodes.sums) {
    energy.kinetic += sums.kinetic;
    energy.external_work += sums.external_work - 0.5 * sums.last_external_work;
    energy.damping += sums.damping_work - 0.5 * sums.last_damping_work;
  }
  for (std::size_t n = 0; n < c.nodes.size(); ++n) {
    const Vec3 velocity = c.nodes.motion.velocity[n],
               at_forces = c.nodes.motion.position[n] - c.last_step * velocity;
    energy.gravity_potential -= c.nodes.mass[n] * c.options.gravity.dot(at_forces);
    if (c.steps == 0)
      energy.kinetic += 0.5 * c.nodes.mass[n] * velocity.squaredNorm() +
                        0.5 * c.nodes.inertia[n] * c.nodes.motion.angular_velocity[n].squaredNorm();
  }
  return energy;
}

Vec3 Carpet::impulse_received() const {
  Vec3 sum(0, 0, 0);
  for (const NodeSums& sums : impl_->nodes.sums)
    sum += Vec3(sums.impulse_received[0], sums.impulse_received[1], sums.impulse_received[2]);
  return sum;
}

Vec3 Carpet::impulse_to_clamps() const {
  Vec3 sum(0, 0, 0);
  for (const NodeSums& sums : impl_->nodes.sums)
    sum += Vec3(sums.impulse_to_clamps[0], sums.impulse_to_clamps[1], sums.impulse_to_clamps[2]);
  return sum;
}

std::uint64_t Carpet::element_steps() const {
  return impl_->steps * impl_->elements.element_count;
}

void Carpet::set_velocity(std::size_t node, const Vec3& linear, const Vec3& angular) {
  if (node >= impl_->nodes.size()) throw std::logic_error(fmt::format("carpet: no node {}", node));
  if (impl_->nodes.clamped[node])
    throw std::logic_error(fmt::format("carpet: node {} is clamped, it cannot move", node));
  impl_->nodes.motion.velocity.set(node, linear);
  impl_->nodes.motion.angular_velocity.set(node, angular);
}

void Carpet::set_position(std::size_t node, const Vec3& position) {
  if (node >= impl_->nodes.size()) throw std::logic_error(fmt::format("carpet: no node {}", node));
  if (impl_->steps > 0) throw std::logic_error("carpet: positions can be set before the first step only");
  impl_->nodes.motion.position.set(node, position);
}

}  // namespace tuft::fe
