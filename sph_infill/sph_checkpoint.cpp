#include <algorithm>
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
  visit("energy_expelled", m.energy.expelled);
  visit("expelled_mass", m.expelled.mass);
  visit("expelled_momentum_x", m.expelled.momentum.x());
  visit("expelled_momentum_y", m.expelled.momentum.y());
  visit("expelled_momentum_z", m.expelled.momentum.z());
  visit("expelled_kinetic_energy", m.expelled.kinetic_energy);
  visit("energy_let_go", m.energy.let_go);
  visit("pending_viscous", m.pending.viscous);
  visit("pending_damping", m.pending.damping);
  visit("pending_contact", m.pending.contact);
  visit("pending_holding", m.pending.holding);
  visit("pending_expelled", m.pending.expelled);
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

/// Records of floats as plain values, and back.
template <class Record>
std::vector<double> values_of(const std::vector<Record>& records) {
  std::vector<double> values;
  for (const Record& record : records) {
    const auto* first = reinterpret_cast<const float*>(&record);
    values.insert(values.end(), first, first + Record::values);
  }
  return values;
}
template <class Record>
void set_values(const std::vector<double>& values, std::vector<Record>& records) {
  auto value = values.begin();
  for (Record& record : records) {
    auto* first = reinterpret_cast<float*>(&record);
    for (std::size_t k = 0; k < Record::values; ++k) first[k] = static_cast<float>(*value++);
  }
}

}  // namespace

void SphInfill::save(h5::Group& group) {
  Impl& m = *impl_;
  visit_state(m.particles,
              [&](const char* name, const std::vector<double>& values) { group.write(name, values); });
  visit_numbers(m, [&](const char* name, double value) { group.write_scalar(name, value); });
  group.write_scalar("particle_steps", m.particle_steps);
  if (!m.list.separated().empty()) group.write("separated_pairs", m.list.separated().values());
  group.write("expelled", std::vector<double>(m.expelled_index.begin(), m.expelled_index.end()));
  if (m.took_over) {
    group.write("reference_volume", m.particles.reference_volume);
    group.write_scalar("loosest_started", m.loosest_started);
  }
  if (m.sleep.enabled()) m.save_sleep(group);
  if (m.steps.enabled()) m.save_steps(group);
  if (m.sleep.enabled() || m.steps.enabled()) m.save_records(group);
}

void SphInfill::Impl::save_steps(h5::Group& group) const {
  steps.save(group);
  // Paces are of what its list reaches.
  group.write_scalar("list_skin", list.skin());
  group.write_scalar("list_next_skin", list.next_skin());
  group.write_scalar("list_steps", list_steps);
  group.write_scalar("list_moved_before", moved_before);
  group.write("list_place_x", list.places().x);
  group.write("list_place_y", list.places().y);
  group.write("list_place_z", list.places().z);
  group.write("own_step", std::vector<double>(particles.own_step.begin(), particles.own_step.end()));
  group.write(
      "energy_in_step",
      std::vector<double>{energy_in_step.kinetic, energy_in_step.stored, energy_in_step.dissipated,
                          energy_in_step.gravity_potential, energy_in_step.damping,
                          energy_in_step.contact_work, energy_in_step.let_go, energy_in_step.expelled});
}

void SphInfill::Impl::load_steps(const h5::Group& group) {
  steps.load(group);
  list.set_skin(group.read_double("list_skin"));
  const std::size_t n = particles.size();
  list.build({read_array(group, "list_place_x", n), read_array(group, "list_place_y", n),
              read_array(group, "list_place_z", n)});
  // A list that is to be built for another reason than motion takes the skin that was found last.
  list.set_skin(group.read_double("list_next_skin"));
  list_steps = group.read_count("list_steps");
  moved_before = group.read_double("list_moved_before");
  const std::vector<double> own = read_array(group, "own_step", particles.size());
  std::transform(own.begin(), own.end(), particles.own_step.begin(),
                 [](double v) { return static_cast<float>(v); });
  const std::vector<double> e = read_array(group, "energy_in_step", 8);
  energy_in_step = {e[0], e[1], e[2], e[3], e[4], e[5], e[6], e[7]};
}

/// What is asleep, or not strained in the next step, is not computed again: what its neighbours read of it is
/// part of the state. With what says when the list is to be built anew.
void SphInfill::Impl::save_records(h5::Group& group) const {
  group.write_scalar("displacement", displacement);
  group.write("frame", std::vector<double>(frame.data(), frame.data() + 3));
  group.write("stress_records", values_of(particles.stress));
  group.write("residual_records", values_of(particles.residual));
}

void SphInfill::Impl::load_records(const h5::Group& group) {
  displacement = group.read_double("displacement");
  const std::vector<double> moving = read_array(group, "frame", 3);
  frame = Vec3(moving[0], moving[1], moving[2]);
  set_values(read_array(group, "stress_records", particles.stress.size() * StressRecord::values),
             particles.stress);
  set_values(read_array(group, "residual_records", particles.residual.size() * ResidualRecord::values),
             particles.residual);
}

void SphInfill::Impl::save_sleep(h5::Group& group) const {
  sleep.save(group, list);
  std::vector<double> potential, stable;
  for (const KickSums& block : kick_blocks) potential.push_back(block.gravity_potential);
  for (const StressSums& block : stress_blocks) stable.push_back(block.stable_step);
  group.write("block_gravity_potential", potential);
  group.write("block_stable_step", stable);
}

void SphInfill::Impl::load_sleep(const h5::Group& group) {
  sleep.load(group, list);
  const std::vector<double> potential = read_array(group, "block_gravity_potential", kick_blocks.size()),
                            stable = read_array(group, "block_stable_step", stress_blocks.size());
  for (std::size_t b = 0; b < potential.size(); ++b) {
    kick_blocks[b] = {};
    kick_blocks[b].gravity_potential = potential[b];
    stress_blocks[b].stable_step = stable[b];
  }
}

void SphInfill::load(const h5::Group& group) {
  Impl& m = *impl_;
  const std::size_t n = m.particles.size();
  visit_state(m.particles,
              [&](const char* name, std::vector<double>& values) { values = read_array(group, name, n); });
  visit_numbers(m, [&](const char* name, double& value) { value = group.read_double(name); });
  m.particle_steps = group.read_count("particle_steps");
  m.took_over = group.has("reference_volume");
  if (m.took_over) {
    m.particles.reference_volume = read_array(group, "reference_volume", n);
    m.loosest_started = group.read_count("loosest_started");
  }
  m.particles.record_motion();
  m.expelled.particles = 0;
  for (const double index : group.read_doubles("expelled")) {
    m.take_out(static_cast<Index>(index));
    ++m.expelled.particles;
  }
  m.list.separate(group.has("separated_pairs") ? SeparatedPairs(group.read_doubles("separated_pairs"), n)
                                               : SeparatedPairs());
  m.list.build(m.particles.position);
  if (m.sleep.enabled()) m.load_sleep(group);
  if (m.steps.enabled()) m.load_steps(group);
  if (m.sleep.enabled() || m.steps.enabled()) m.load_records(group);
}

}  // namespace tuft::sph
