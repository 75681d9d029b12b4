#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/checkpoint_values.h"
#include "sph_infill/sph_infill_impl.h"

namespace tuft::sph {
namespace {

/// Every array that a checkpoint holds, by name and with what is allowed, for `visit(name, bounds,
/// std::vector<double>&)`.
template <class ParticlesType, class Visit>
void visit_state(ParticlesType& p, Visit&& visit) {
  const h5::Bounds compression{std::log(smallest_density_ratio), std::log(largest_density_ratio)};
  const auto finite = [&](const char* name, auto& values) { visit(name, h5::finite, values); };
  finite("x", p.position.x), finite("y", p.position.y), finite("z", p.position.z);
  finite("vx", p.velocity.x), finite("vy", p.velocity.y), finite("vz", p.velocity.z);
  visit("compression", compression, p.compression);
  finite("largest_compression", p.largest_compression);
  finite("plastic_compression", p.plastic_compression);
  finite("pressure", p.pressure);
  visit("bulk_modulus", h5::not_negative, p.bulk_modulus);
  visit("volume", h5::positive, p.volume);
  constexpr std::array names{"sxx", "syy", "szz", "sxy", "syz", "szx"};
  for (std::size_t c = 0; c < names.size(); ++c) finite(names[c], p.deviator[c]);
  if (!p.lost_strength.empty()) visit("lost_strength", h5::Bounds{0, 1}, p.lost_strength);
}

/// Every number that a checkpoint holds.
template <class ImplType, class Visit>
void visit_numbers(ImplType& m, Visit&& visit) {
  const auto finite = [&](const char* name, auto& value) { visit(name, h5::finite, value); };
  finite("time", m.time);
  visit("step_before", h5::not_negative, m.step_before);
  visit("damping", h5::not_negative, m.damping);
  visit("stable_step", h5::Bounds{h5::positive.least, h5::unbounded}, m.stable_step);
  finite("energy_kinetic", m.energy.kinetic);
  finite("energy_stored", m.energy.stored);
  finite("energy_dissipated", m.energy.dissipated);
  finite("energy_gravity", m.energy.gravity_potential);
  finite("energy_damping", m.energy.damping);
  finite("energy_contact", m.energy.contact_work);
  finite("energy_expelled", m.energy.expelled);
  visit("expelled_mass", h5::not_negative, m.expelled.mass);
  finite("expelled_momentum_x", m.expelled.momentum.x());
  finite("expelled_momentum_y", m.expelled.momentum.y());
  finite("expelled_momentum_z", m.expelled.momentum.z());
  finite("expelled_kinetic_energy", m.expelled.kinetic_energy);
  finite("energy_let_go", m.energy.let_go);
  finite("pending_viscous", m.pending.viscous);
  finite("pending_damping", m.pending.damping);
  finite("pending_contact", m.pending.contact);
  finite("pending_holding", m.pending.holding);
  finite("pending_expelled", m.pending.expelled);
}

/// What is no particle any more may be anywhere; the rest is where it belongs, or the list of neighbours
/// would reach as far.
void check_places(const h5::Group& group, const std::array<const char*, 3>& names, const Vec3Array& places,
                  const TurfBox& box, const std::vector<std::uint8_t>& expelled) {
  const std::array<const std::vector<double>*, 3> axes{&places.x, &places.y, &places.z};
  for (std::size_t d = 0; d < axes.size(); ++d)
    for (std::size_t i = 0; i < axes[d]->size(); ++i)
      if (expelled.empty() || expelled[i] == 0)
        h5::check_value(group, names[d], i, (*axes[d])[i],
                        {box.low[static_cast<Eigen::Index>(d)], box.high[static_cast<Eigen::Index>(d)]});
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
  visit_state(m.particles, [&](const char* name, h5::Bounds, const std::vector<double>& values) {
    group.write(name, values);
  });
  visit_numbers(m, [&](const char* name, h5::Bounds, double value) { group.write_scalar(name, value); });
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
  const std::size_t n = particles.size();
  // As `best_skin` bounds it, and rounding.
  const h5::Bounds skins{h5::positive.least, 2 * pitch};
  list.set_skin(h5::read_number(group, "list_skin", skins));
  Vec3Array places = h5::read_vectors(group, "list_place", n);
  check_places(group, {"list_place_x", "list_place_y", "list_place_z"}, places, box, expelled_mask);
  list.build(places);
  // A list that is to be built for another reason than motion takes the skin that was found last.
  list.set_skin(h5::read_number(group, "list_next_skin", skins));
  list_steps = h5::read_count(group, "list_steps");
  moved_before = h5::read_number(group, "list_moved_before", h5::not_negative);
  const std::vector<double> own = h5::read_checked(group, "own_step", n, {0, h5::unbounded});
  std::transform(own.begin(), own.end(), particles.own_step.begin(),
                 [](double v) { return static_cast<float>(v); });
  const std::vector<double> e = h5::read_checked(group, "energy_in_step", 8);
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
  displacement = h5::read_number(group, "displacement", {0, h5::unbounded});
  const std::vector<double> moving = h5::read_checked(group, "frame", 3);
  frame = Vec3(moving[0], moving[1], moving[2]);
  const auto read = [&](const char* name, auto& records) {
    using Record = typename std::remove_reference_t<decltype(records)>::value_type;
    set_values(h5::read_checked(group, name, records.size() * Record::values, h5::single_precision), records);
  };
  read("stress_records", particles.stress);
  read("residual_records", particles.residual);
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
  const std::vector<double> potential =
      h5::read_checked(group, "block_gravity_potential", kick_blocks.size());
  const std::vector<double> stable =
      h5::read_checked(group, "block_stable_step", stress_blocks.size(), {h5::positive.least, h5::unbounded});
  for (std::size_t b = 0; b < potential.size(); ++b) {
    kick_blocks[b] = {};
    kick_blocks[b].gravity_potential = potential[b];
    stress_blocks[b].stable_step = stable[b];
  }
}

/// In the order in which they left.
void SphInfill::Impl::load_expelled(const h5::Group& group) {
  expelled.particles = 0;
  const auto last = static_cast<double>(particles.size()) - 1;
  const std::vector<double> indices = h5::read_all_whole(group, "expelled", {0, last});
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    if (!expelled_mask.empty() && expelled_mask[i] != 0)
      h5::refuse(group, "expelled", fmt::format("[{}] is {}, as one before it", k, i));
    take_out(static_cast<Index>(i));
    ++expelled.particles;
  }
}

void SphInfill::Impl::load_separated(const h5::Group& group) {
  SeparatedPairs pairs;
  if (group.has("separated_pairs")) {
    const auto last = static_cast<double>(particles.size()) - 1;
    const std::vector<double> values = h5::read_all_whole(group, "separated_pairs", {0, last});
    if (values.size() % 2 != 0)
      h5::refuse(group, "separated_pairs", fmt::format("holds {} values, which are no pairs", values.size()));
    for (std::size_t k = 0; k < values.size(); k += 2)
      if (!(values[k] < values[k + 1]))
        h5::refuse(
            group, "separated_pairs",
            fmt::format("[{}] is {} and the next {}; the lower comes first", k, values[k], values[k + 1]));
    pairs = SeparatedPairs(values, particles.size());
  }
  list.separate(std::move(pairs));
}

void SphInfill::load(const h5::Group& group) {
  Impl& m = *impl_;
  const std::size_t n = m.particles.size();
  visit_state(m.particles, [&](const char* name, h5::Bounds bounds, std::vector<double>& values) {
    values = h5::read_checked(group, name, n, bounds);
  });
  visit_numbers(m, [&](const char* name, h5::Bounds bounds, double& value) {
    value = h5::read_number(group, name, bounds);
  });
  m.particle_steps = h5::read_count(group, "particle_steps");
  m.took_over = group.has("reference_volume");
  if (m.took_over) {
    m.particles.reference_volume = h5::read_checked(group, "reference_volume", n, h5::positive);
    m.loosest_started = h5::read_count(group, "loosest_started");
  }
  m.particles.record_motion();
  m.load_expelled(group);
  check_places(group, {"x", "y", "z"}, m.particles.position, m.box, m.expelled_mask);
  m.load_separated(group);
  m.list.build(m.particles.position);
  if (m.sleep.enabled()) m.load_sleep(group);
  if (m.steps.enabled()) m.load_steps(group);
  if (m.sleep.enabled() || m.steps.enabled()) m.load_records(group);
}

}  // namespace tuft::sph
