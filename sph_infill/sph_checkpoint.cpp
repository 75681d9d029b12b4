#include <cmath>
#include <string>

#include "core/error.h"
#include "sph_infill/sph_infill_impl.h"

namespace tuft::sph {
namespace {

/// Every array that a checkpoint holds, by name, for `visit(name, std::vector<double>&)`.
template <class ParticlesType, class Visit>
void visit_state(ParticlesType& p, Visit&& visit) {
  visit("x", p.position.x), visit("y", p.position.y), visit("z", p.position.z);
  visit("vx", p.velocity.x), visit("vy", p.velocity.y), visit("vz", p.velocity.z);
  visit("compression", p.compression);
  visit("largest_compression", p.largest_compression);
  visit("plastic_compression", p.plastic_compression);
  visit("pressure", p.pressure);
  visit("bulk_modulus", p.bulk_modulus);
  visit("volume", p.volume);
  constexpr std::array names{"sxx", "syy", "szz", "sxy", "syz", "szx"};
  for (std::size_t c = 0; c < names.size(); ++c) visit(names[c], p.deviator[c]);
  if (!p.lost_strength.empty()) visit("lost_strength", p.lost_strength);
}

/// Every number that a checkpoint holds.
template <class ImplType, class Visit>
void visit_numbers(ImplType& m, Visit&& visit) {
  visit("time", m.time);
  visit("step_before", m.step_before);
  visit("damping", m.damping);
  visit("stable_step", m.stable_step);
  visit("energy_kinetic", m.energy.kinetic);
  visit("energy_stored", m.energy.stored);
  visit("energy_dissipated", m.energy.dissipated);
  visit("energy_gravity", m.energy.gravity_potential);
  visit("energy_damping", m.energy.damping);
  visit("energy_contact", m.energy.contact_work);
  visit("pending_viscous", m.pending.viscous);
  visit("pending_damping", m.pending.damping);
  visit("pending_contact", m.pending.contact);
}

std::vector<double> read_array(const h5::Group& group, const std::string& name, std::size_t count) {
  std::vector<double> values = group.read_doubles(name);
  if (values.size() != count)
    throw_input_error(
        "checkpoint of SPH infill holds {} values of {}, but the scene has {} particles; it belongs to "
        "another scene",
        values.size(), name, count);
  return values;
}

}  // namespace

void SphInfill::save(h5::Group& group) {
  Impl& m = *impl_;
  visit_state(m.particles,
              [&](const char* name, const std::vector<double>& values) { group.write(name, values); });
  visit_numbers(m, [&](const char* name, double value) { group.write_scalar(name, value); });
  group.write_scalar("particle_steps", m.particle_steps);
}

void SphInfill::load(const h5::Group& group) {
  Impl& m = *impl_;
  const std::size_t n = m.particles.size();
  visit_state(m.particles,
              [&](const char* name, std::vector<double>& values) { values = read_array(group, name, n); });
  visit_numbers(m, [&](const char* name, double& value) { value = group.read_double(name); });
  m.particle_steps = group.read_count("particle_steps");
  m.particles.record_motion();
  m.build_list();
}

}  // namespace tuft::sph
