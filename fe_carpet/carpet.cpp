#include "fe_carpet/carpet.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fe_carpet/carpet_impl.h"
#include "fe_carpet/erosion.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe {
namespace {

/// Below this many elements (a step of some 0.1 ms) threads would gain less than they may lose waiting for
/// each other. Results do not depend on it.
constexpr std::size_t threads_pay_above = 1000;

void check_orthotropic(const ShellMaterial& material, std::size_t m) {
  const double e1 = material.young_modulus, e2 = material.across_young_modulus, nu = material.poisson_ratio;
  if (!std::isfinite(e2))
    throw_input_error("shell material {}: Young's modulus across is {} Pa; it must be positive", m, e2);
  if (!(material.shear_modulus > 0) || !std::isfinite(material.shear_modulus))
    throw_input_error(
        "shell material {}: it is orthotropic, and its shear modulus is {} Pa; give a positive one", m,
        material.shear_modulus);
  if (!(4 * nu * nu * e2 < e1))
    throw_input_error(
        "shell material {}: Poisson's ratio {} with moduli {} and {} Pa along and across: the mean of both "
        "ratios, "
        "nu sqrt(across / along), is {}; it must be under 0.5",
        m, nu, e1, e2, nu * std::sqrt(e2 / e1));
  if (!material.relaxation.empty())
    throw_input_error("shell material {}: orthotropic and relaxing at once is not supported; leave one out",
                      m);
  const auto& a = material.along;
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  if (!(length > 0) || !std::isfinite(length))
    throw_input_error("shell material {}: its direction along has no length", m);
}

void check_relaxation(const ShellMaterial& material, std::size_t m) {
  const double shear = material.young_modulus / (2 * (1 + material.poisson_ratio));
  double sum = 0;
  for (const PronyTerm& term : material.relaxation) {
    if (!(term.modulus > 0) || !std::isfinite(term.modulus))
      throw_input_error("shell material {}: a relaxation modulus is {} Pa; it must be positive", m,
                        term.modulus);
    if (!(term.decay >= 0) || !std::isfinite(term.decay))
      throw_input_error("shell material {}: a relaxation decay is {} 1/s; it must be zero or more", m,
                        term.decay);
    sum += term.modulus;
  }
  if (sum > shear * (1 + 1e-9))
    throw_input_error(
        "shell material {}: the relaxation moduli add up to {} Pa, more than the instantaneous shear modulus "
        "of {} Pa; raise young_modulus or lower them",
        m, sum, shear);
}

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
    check_relaxation(material, m);
    if (!(material.failure_strain >= 0) || !std::isfinite(material.failure_strain))
      throw_input_error("shell material {}: failure strain is {}; it must be positive, or 0 for none", m,
                        material.failure_strain);
    if (material.orthotropic()) check_orthotropic(material, m);
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

void check_section(const ShellSection& section) {
  if (section.thickness_points < 1 || section.thickness_points > 5)
    throw_input_error("carpet: {} thickness points; choose 1 to 5", section.thickness_points);
  if (!(section.hourglass_coefficient >= 0 && section.hourglass_coefficient <= 1))
    throw_input_error("carpet: hourglass coefficient {}; it must be in [0, 1]",
                      section.hourglass_coefficient);
}

void check_options(const CarpetOptions& options) {
  check_section(options.section);
  for (const ShellSection& section : options.sections) check_section(section);
  check_damping(options.damping);
  if (!options.gravity.allFinite()) throw_input_error("carpet: gravity is not finite");
  if (!(options.mass_scaling_limit >= 0 && options.mass_scaling_limit < 1))
    throw_input_error("carpet: mass_scaling_limit is {}; it must be in [0, 1)", options.mass_scaling_limit);
}

/// Per node the sum over its elements of (m_e / 4) / dt_e^2, with dt_e = 2 / frequency bound of the element.
/// Never more than the node's mass over the square of the stable step of the mesh.
std::vector<double> contact_stiffness_of_nodes(const ElementArrays& elements, const ShellMesh& mesh,
                                               const Vec3Array& position) {
  std::vector<double> stiffness(mesh.nodes.size(), 0.0);
  std::vector<double> frequency_squared(elements.element.size());
  for (std::size_t batch = 0; batch < elements.batch_count; ++batch) {
    const Pack bound = batch_frequency_squared(elements, position, batch);
    for (std::size_t lane = 0; lane < lanes; ++lane) frequency_squared[batch * lanes + lane] = bound[lane];
  }
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]);
    for (const Index node : mesh.quads[e])
      stiffness[static_cast<std::size_t>(node)] += elements.mass[slot] / 4 * frequency_squared[slot] / 4;
  }
  return stiffness;
}

double stiffest_direct(const ShellMaterial& material) {
  return (material.orthotropic() ? stiffer_isotropic_law(material) : instantaneous_law(material)).direct;
}

ShellMesh checked(ShellMesh mesh, const std::vector<ShellMaterial>& materials, const CarpetOptions& options) {
  const bool no_carpet = mesh.nodes.size() == 0 && mesh.quads.empty();
  if (!no_carpet) check_mesh(mesh);
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
      mass_scaling(scale_masses(elements, positions_with_spares(mesh, elements), options.mass_scaling_limit)),
      nodes(make_node_arrays(mesh, elements)),
      contact_stiffness(contact_stiffness_of_nodes(elements, mesh, nodes.motion.position)) {
  for (std::size_t m = 0; m < materials.size(); ++m)
    wave_speed = std::max(wave_speed, std::sqrt(stiffest_direct(materials[m]) / materials[m].density));
  initial_stable_step = 2 / std::sqrt(largest_frequency_squared());
  if (options.subcycle) split_off_slow_elements();
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

/// Strains and stresses up to the present positions, so that velocities may change.
void Carpet::Impl::settle_elements() {
  if (subcycling) {
    update_groups(true, 1);
    subcycling->drifted = 0;
  } else {
    update_elements();
  }
  stop_on_inverted_element();
  last_step = 0;
}

void Carpet::Impl::update_elements() {
  for (ElementFamily& family : elements.family)
    if (auto* law = std::get_if<ViscoelasticLaw>(&family.law)) law->set_step(last_step);
#pragma omp parallel for schedule(static) if (elements.element_count > threads_pay_above)
  for (std::size_t b = 0; b < elements.block.size(); ++b) {
    const ElementBlock& block = elements.block[b];
    const ElementFamily& family = elements.family[block.family];
    family.update(elements, family, nodes.motion, last_step, block.first_batch, block.last_batch, b);
  }
  take_out_failed();
}

void Carpet::Impl::take_out_failed() {
  if (std::none_of(elements.failing.begin(), elements.failing.end(), [](std::uint8_t f) { return f != 0; }))
    return;
  const ErodedWork taken = erode_marked(elements, static_cast<Index>(nodes.size()));
  eroded_energy += taken.strain + taken.hourglass;
}

/// Elements write their own corners, then nodes gather them: no two threads write one value.
void Carpet::Impl::move(double dt, const Vec3Array& force, const Vec3Array* moment) {
  if (subcycling) return move_subcycled(dt, force, moment);
  const NodeStep node_step{dt, options.damping, options.gravity, from_rest ? 0.5 : 0.0};
  const bool starts = std::exchange(from_rest, false);
  update_elements();
  stop_on_inverted_element();
#pragma omp parallel for schedule(static) if (elements.element_count > threads_pay_above)
  for (std::size_t block = 0; block < nodes.sums.size(); ++block)
    update_node_block(nodes, elements, force, moment, node_step, block);
  if (starts) book_start_from_rest();
}

/// At rest, the mean of the kinetic energies half a step before and after is not zero but that of half a
/// kick: it is no energy that anything gave, but goes back to what the stop has taken.
void Carpet::Impl::book_start_from_rest() {
  for (NodeSums& sums : nodes.sums)
    sums.damping_work -= sums.kinetic + 0.5 * (sums.last_damping_work - sums.last_external_work);
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
  for (std::size_t e = 0; e < elements.element_count; ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]), batch = slot / lanes;
    const double* first = &elements.state[elements.state_of_batch(batch) + slot % lanes];
    const std::size_t rows = elements.family[static_cast<std::size_t>(elements.batch_family[batch])].rows;
    for (std::size_t row = 0; row < rows; ++row)
      if (!std::isfinite(first[row * lanes])) return static_cast<Index>(e);
  }
  return -1;
}

}  // namespace

/// Positions that are not finite are for the check that follows the step.
void Carpet::Impl::stop_on_inverted_element() const {
  if (*std::min_element(elements.uprightness.begin(), elements.uprightness.end()) > 0) return;
  // The window of the slow elements is up to date at their own nodes alone.
  std::vector<std::uint8_t> fast(elements.family.size(), 1);
  if (subcycling)
    std::transform(subcycling->slow.begin(), subcycling->slow.end(), fast.begin(), std::logical_not<>());
  Index element = find_inverted_element(elements, nodes.motion, last_step, fast);
  if (element < 0 && subcycling)
    element = find_inverted_element(elements, subcycling->window, subcycling->drifted, subcycling->slow);
  if (element < 0 ||
      !nodes.motion.position[static_cast<std::size_t>(mesh.quads[static_cast<std::size_t>(element)][0])]
           .allFinite())
    return;
  throw_run_error(
      "carpet: element {} (surface {}) is turned inside out at t = {:.9g} s (carpet step {}); take smaller "
      "elements, a smaller step or softer contact",
      element, mesh.surface[static_cast<std::size_t>(element)], time, steps);
}

/// The kinetic energy of every node is in the sums: a value that is not finite anywhere shows there at the
/// latest one step after it arose. Faster than the wave speed, a node strains its elements by more than 1: no
/// step of this carpet that is still stable does that.
void Carpet::Impl::stop_on_instability(double dt, const Vec3Array& force, const Vec3Array* moment) const {
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
  if (moment && find_bad_value(*moment, bad))
    throw_run_error("carpet: moment {} on node {} is {} N m {}; the load that gave it is at fault", bad.axis,
                    bad.node, bad.value, when);
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
  const auto own = [this](const std::vector<double>& values) {
    return std::span<const double>(values.data(), impl_->nodes.size());
  };
  return {own(motion.position.x), own(motion.position.y), own(motion.position.z), own(motion.velocity.x),
          own(motion.velocity.y), own(motion.velocity.z), impl_->nodes.mass,      impl_->nodes.clamped};
}

double Carpet::stable_step() const {
  const double largest = impl_->largest_frequency_squared();  // 0: all elements are gone
  const double step = largest > 0 ? 2 / std::sqrt(largest) : impl_->initial_stable_step;
  // Nodes whose elements are gone still meet bodies, with the stiffness that suited the carpet as built.
  return impl_->elements.eroded_count > 0 ? std::min(step, impl_->initial_stable_step) : step;
}

std::vector<double> Carpet::stable_steps_of_materials() const {
  std::vector<double> steps = impl_->steps_of_families();
  for (std::size_t f = impl_->materials.size(); f < steps.size(); ++f) {
    double& all = steps[impl_->subcycling->material[f - impl_->materials.size()]];
    all = std::min(all, steps[f]);
  }
  steps.resize(impl_->materials.size());
  return steps;
}

int Carpet::subcycle_ratio() const {
  return impl_->subcycling ? fe::subcycle_ratio(*impl_->subcycling, impl_->steps_of_families()) : 1;
}

void Carpet::set_subcycle(int steps) {
  if (!impl_->subcycling && steps == 1) return;
  if (steps < 1 || !impl_->subcycling || impl_->subcycling->steps != 0)
    throw std::logic_error(fmt::format("carpet: subcycling of {} steps cannot be set here", steps));
  impl_->subcycling->every = steps;
}

int Carpet::subcycle() const {
  return impl_->subcycling ? impl_->subcycling->every : 1;
}

const MassScaling& Carpet::mass_scaling() const {
  return impl_->mass_scaling;
}

std::span<const double> Carpet::node_contact_stiffness() const {
  return impl_->contact_stiffness;
}

void Carpet::Impl::step(double dt, const Vec3Array& force, const Vec3Array* moment) {
  if (!(dt > 0) || !std::isfinite(dt)) throw std::logic_error(fmt::format("carpet step of {} s", dt));
  for (const Vec3Array* load : {&force, moment})
    if (load &&
        (load->x.size() != nodes.size() || load->y.size() != nodes.size() || load->z.size() != nodes.size()))
      throw std::logic_error(fmt::format("carpet: {} loads for {} nodes", load->x.size(), nodes.size()));
  move(dt, force, moment);
  stop_on_instability(dt, force, moment);
  if (!grips.nodes.empty()) book_grips(dt, force);
  last_step = dt;
  time += dt;
  ++steps;
}

void Carpet::step(double dt, const Vec3Array& force) {
  impl_->step(dt, force, nullptr);
}

void Carpet::step(double dt, const Vec3Array& force, const Vec3Array& moment) {
  impl_->step(dt, force, &moment);
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
  energy.eroded = c.eroded_energy;
  energy.external_work += c.grips.work - 0.5 * c.grips.last_work;
  for (const NodeSums& sums : c.nodes.sums) {
    energy.kinetic += sums.kinetic;
    energy.external_work += sums.external_work - 0.5 * sums.last_external_work;
    energy.damping += sums.damping_work - 0.5 * sums.last_damping_work;
  }
  for (std::size_t n = 0; n < c.nodes.size(); ++n) {
    const Vec3 velocity = c.nodes.motion.velocity[n],
               at_forces = c.nodes.motion.position[n] - c.last_step * velocity;
    energy.gravity_potential -= c.nodes.true_mass_of()[n] * c.options.gravity.dot(at_forces);
    if (c.steps == 0)
      energy.kinetic += 0.5 * c.nodes.mass[n] * velocity.squaredNorm() +
                        0.5 * c.nodes.inertia[n] * c.nodes.motion.angular_velocity[n].squaredNorm();
  }
  return energy;
}

double Carpet::kinetic_energy() const {
  double kinetic = 0;
  for (const NodeSums& sums : impl_->nodes.sums) kinetic += sums.kinetic;
  return kinetic;
}

void Carpet::stop() {
  Impl& c = *impl_;
  const double before = energy().balance();
  // What these velocities have done since the last forces must not be lost: the elements have yet to see it.
  c.settle_elements();
  for (Vec3Array* velocity : {&c.nodes.motion.velocity, &c.nodes.motion.angular_velocity})
    velocity->assign(velocity->size(), 0.0);
  for (NodeSums& sums : c.nodes.sums) {
    sums.external_work += 0.5 * sums.last_external_work;
    sums.damping_work -= 0.5 * sums.last_damping_work;
    sums.kinetic = sums.last_external_work = sums.last_damping_work = 0;
  }
  c.nodes.sums.front().damping_work += before - energy().balance();
  c.from_rest = true;
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

std::span<const std::uint8_t> Carpet::eroded() const {
  return impl_->elements.eroded;
}

std::size_t Carpet::eroded_count() const {
  return impl_->elements.eroded_count;
}

std::uint64_t Carpet::element_steps() const {
  const Impl& c = *impl_;
  if (!c.subcycling) return c.steps * c.elements.element_count;
  return c.steps * (c.elements.element_count - c.subcycling->slow_elements) +
         c.subcycling->slow_evaluations * c.subcycling->slow_elements;
}

void Carpet::set_velocity(std::size_t node, const Vec3& linear, const Vec3& angular) {
  if (node >= impl_->nodes.size()) throw std::logic_error(fmt::format("carpet: no node {}", node));
  if (impl_->nodes.clamped[node])
    throw std::logic_error(fmt::format("carpet: node {} is clamped, it cannot move", node));
  for (std::size_t c = 0; c < 6; ++c)
    if (impl_->nodes.free_of(c)[node] == 0 &&
        (c < 3 ? linear : angular)[static_cast<Eigen::Index>(c % 3)] != 0)
      throw std::logic_error(fmt::format("carpet: node {} is held, it cannot move so", node));
  impl_->nodes.motion.velocity.set(node, linear);
  impl_->nodes.motion.angular_velocity.set(node, angular);
}

void Carpet::set_position(std::size_t node, const Vec3& position) {
  if (node >= impl_->nodes.size()) throw std::logic_error(fmt::format("carpet: no node {}", node));
  if (impl_->steps > 0) throw std::logic_error("carpet: positions can be set before the first step only");
  impl_->nodes.motion.position.set(node, position);
  if (impl_->subcycling) impl_->subcycling->window.position.set(node, position);
}

}  // namespace tuft::fe
