#include "sph_infill/sph_infill.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "sph_infill/sph_infill_impl.h"

namespace tuft::sph {
namespace {

/// Skin of the neighbour list over the pitch, at first: see best_skin in sph_stepping.cpp.
constexpr double skin_over_pitch = 0.2;

void check_settings(const Lattice& lattice, const SphSettings& settings) {
  const SphOptions& options = settings.options;
  if (lattice.position.size() == 0) throw_input_error("SPH infill has no particles");
  if (!(options.smoothing_length > 0) || !std::isfinite(options.smoothing_length))
    throw_input_error("infill.sph.smoothing_length is {} m; it must be above 0", options.smoothing_length);
  if (!(lattice.pitch > 0))
    throw_input_error("lattice of SPH infill has pitch {} m; it must be above 0", lattice.pitch);
  for (std::size_t i = 0; i < lattice.position.size(); ++i)
    if (!lattice.position[i].allFinite() || !(lattice.volume[i] > 0) || !std::isfinite(lattice.volume[i]))
      throw_input_error("lattice of SPH infill: particle {} has position ({}, {}, {}) m and volume {} m^3", i,
                        lattice.position.x[i], lattice.position.y[i], lattice.position.z[i],
                        lattice.volume[i]);
  for (const double viscosity :
       {options.viscosity_linear, options.viscosity_quadratic, options.zero_energy_viscosity})
    if (!(viscosity >= 0) || !std::isfinite(viscosity))
      throw_input_error("infill.sph viscosity is {}; it must be at least 0", viscosity);
}

SoilLaw law_of(const std::vector<Material>& materials, Index index, const SphSettings& settings) {
  if (index < 0 || static_cast<std::size_t>(index) >= materials.size())
    throw_input_error("SPH infill names material number {}, but there are {}", index, materials.size());
  const Material& material = materials[static_cast<std::size_t>(index)];
  if (!material.continuum)
    throw_input_error("{}: material \"{}\" has no [continuum] block, which SPH infill needs", material.file,
                      material.name);
  try {
    return make_soil_law(*material.continuum, settings.tension_cutoff, settings.soil_effects);
  } catch (const InputError& error) {
    throw_input_error("{}: material \"{}\", continuum: {}", material.file, material.name, error.what());
  }
}

}  // namespace

SphInfill::SphInfill(const Lattice& lattice, const std::vector<Material>& materials,
                     const SphSettings& settings)
    : impl_(std::make_unique<Impl>()) {
  impl_->set_up(lattice, materials, settings);
  impl_->begin(lattice.pitch, settings.sleep_tolerance);
}

SphInfill::SphInfill(const Lattice& lattice, const std::vector<Material>& materials,
                     const SphSettings& settings, const CompactedBed& bed, ConditionedState state)
    : impl_(std::make_unique<Impl>()) {
  impl_->set_up(lattice, materials, settings);
  try {
    impl_->take_over(bed, state);
  } catch (const InputError& error) {
    throw_input_error("conditioning: {}, or set conditioning.state = \"initial\"", error.what());
  }
  impl_->begin(lattice.pitch, settings.sleep_tolerance);
}

void SphInfill::Impl::set_up(const Lattice& lattice, const std::vector<Material>& materials,
                             const SphSettings& given) {
  check_settings(lattice, given);
  settings.options = given.options;
  settings.artificial_viscosity = given.artificial_viscosity;
  settings.soil_effects = given.soil_effects;
  settings.zero_energy_control = given.zero_energy_control;
  settings.step_limit =
      make_step_limit(given.options, lattice.pitch, given.artificial_viscosity, given.zero_energy_control);
  // Particles on walls stand for parts of a cell, as specimens give them: they are not squeezed.
  if (lattice.stands_on_walls) settings.step_limit.lattice_volume = 0;
  gravity = given.gravity;
  box = given.box;
  kick_length = given.kick_length;

  Particles& p = particles;
  const std::size_t n = lattice.position.size();
  p.assign(n, given.options.smoothing_length);
  if (given.zero_energy_control) p.residual.assign(n, {});
  steps = IndividualSteps(given.individual_steps, given.step_safety, n);
  if (steps.enabled()) p.own_step.assign(n, 0);
  p.position = lattice.position;
  if (given.soil_effects.strength_softening) p.lost_strength.assign(n, 0);
  p.volume = lattice.volume;
  if (!lattice.strained_share.empty()) p.strained_share = lattice.strained_share;
  p.layer = lattice.layer;
  p.material = lattice.material;

  settings.laws.resize(materials.size());
  std::vector<bool> known(materials.size(), false);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(p.material[i]);
    if (k >= known.size() || !known[k]) {
      SoilLaw law = law_of(materials, p.material[i], given);
      settings.laws[k] = std::move(law);
      known[k] = true;
    }
    const SoilLaw& law = settings.laws[k];
    p.set_soil_state(i, reference_state(law));
    p.mass[i] = law.density * lattice.volume[i];
    p.reference_volume[i] = p.mass[i] / law.density;
  }
  ContactRadii radii = contact_radii(lattice);
  p.radius = std::move(radii.radius), p.half_height = std::move(radii.half_height);
}

void SphInfill::Impl::take_over(const CompactedBed& bed, ConditionedState start) {
  Particles& p = particles;
  const std::size_t n = p.size();
  if (bed.position.size() != n || bed.velocity.size() != n || bed.density_ratio.size() != n)
    throw_run_error("SPH infill: a bed of {} particles cannot take the place of {}", bed.position.size(), n);
  took_over = true;
  p.position = bed.position;
  p.velocity = bed.velocity;
  energy = energy_in_step = bed.energy;
  time = bed.time;
  damping = bed.damping;
  for (std::size_t i = 0; i < n; ++i) {
    const double ratio = bed.density_ratio[i];
    if (!(ratio > smallest_density_ratio && ratio < largest_density_ratio))
      throw_run_error(
          "SPH infill: particle {} of a compacted bed has {:.6g} times its density as placed, outside [{}, "
          "{}]",
          i, ratio, smallest_density_ratio, largest_density_ratio);
    const SoilLaw& law = settings.laws[static_cast<std::size_t>(p.material[i])];
    if (ratio < 1) ++loosest_started;
    const double reached = std::max(1.0, ratio);
    if (!is_left_compacted(law, start)) {
      p.volume[i] = p.reference_volume[i] = p.mass[i] / (law.density * reached);
      continue;
    }
    p.set_soil_state(i, compacted_state(law, std::log(reached)));
    p.volume[i] = p.reference_volume[i] * std::exp(-p.compression[i]);
  }
}

void SphInfill::Impl::begin(double lattice_pitch, double sleep_tolerance) {
  pitch = lattice_pitch;
  Particles& p = particles;
  p.record_motion();
  stress_blocks.resize(block_count(p));
  kick_blocks.resize(block_count(p));
  drift_blocks.resize(block_count(p));
  list = NeighbourList(p.position, 2 * settings.options.smoothing_length, skin_over_pitch * pitch);
  sleep = Sleep(sleep_tolerance, settings.options.smoothing_length, p.size(),
                static_cast<std::uint32_t>(steps.largest()));
  if (steps.enabled()) list.keep_places();
  list.build(p.position);
  note_neighbours();
  stable_step = update_stress(settings, list, 0, p, stress_blocks).stable_step;
}

SphInfill::~SphInfill() = default;

ParticleView SphInfill::particles() const {
  const Particles& p = impl_->particles;
  return {p.position.x,
          p.position.y,
          p.position.z,
          p.velocity.x,
          p.velocity.y,
          p.velocity.z,
          {},
          {},
          {},
          p.radius,
          p.mass,
          p.layer,
          p.material,
          impl_->expelled_mask,
          impl_->own_kicks ? impl_->steps.kicks() : ParticleKicks{},
          p.half_height};
}

void SphInfill::begin_window(double window, int substeps, bool energy_wanted) {
  if (impl_->steps.enabled()) impl_->begin_steps(window / substeps, substeps, energy_wanted);
}

bool SphInfill::has_individual_steps() const {
  return impl_->steps.enabled();
}

void SphInfill::set_contact_rates(std::span<const float> rates) {
  impl_->steps.set_contact_rates(rates);
}

bool SphInfill::energy_is_current() const {
  return !impl_->steps.enabled() || impl_->steps.is_in_step();
}

int SphInfill::period_of(std::size_t particle) const {
  return impl_->steps.period_of(particle);
}

double SphInfill::stable_step() const {
  return impl_->stable_step;
}

InfillEnergy SphInfill::energy() const {
  return impl_->steps.enabled() ? impl_->energy_in_step : impl_->energy;
}

Expelled SphInfill::expelled() const {
  return impl_->expelled;
}

std::uint64_t SphInfill::particle_steps() const {
  return impl_->particle_steps;
}

void SphInfill::set_damping(double rate) {
  if (!(rate >= 0) || !std::isfinite(rate))
    throw_input_error("damping rate of the infill is {} 1/s; it must be at least 0", rate);
  impl_->damping = rate;
}

void SphInfill::set_velocity(std::size_t i, const Vec3& v) {
  impl_->particles.velocity.set(i, v);
  impl_->particles.record_motion(i);
  impl_->sleep.wake(i / block_size);
}

std::size_t SphInfill::loosest_started() const {
  return impl_->loosest_started;
}

double SphInfill::mean_neighbours() const {
  const Impl& m = *impl_;
  const Particles& p = m.particles;
  const double support = 2 * m.settings.options.smoothing_length;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (const Index j : m.list.row(i)) {
      const double distance_squared = (p.position[i] - p.position[static_cast<std::size_t>(j)]).squaredNorm();
      if (distance_squared < support * support) ++pairs;
    }
  return static_cast<double>(pairs) / static_cast<double>(p.size());
}

AdvanceReport SphInfill::advance(double window, int substeps, const ContactImpulses& contact) {
  Impl& m = *impl_;
  const std::size_t n = m.particles.size(), given = contact.linear.size();
  if (!(window > 0) || !std::isfinite(window) || substeps < 1)
    throw_run_error("SPH infill: a window of {} s in {} substeps cannot be advanced", window, substeps);
  if (given != 0 && given != n)
    throw_run_error("SPH infill: contact impulses for {} particles, but there are {}", given, n);

  AdvanceReport report;
  for (int s = 0; s < substeps; ++s) {
    if (m.steps.enabled() && !m.begun) m.begin_steps(window / substeps, substeps, true);
    const KickSums kicked = m.step(window / substeps, given ? &contact.linear : nullptr, 1.0 / substeps);
    report.impulse_received += kicked.impulse;
    report.impulse_scale += kicked.impulse_scale;
  }
  report.substeps = substeps;
  return report;
}

std::vector<Infill::Field> SphInfill::fields() const {
  const Particles& p = impl_->particles;
  const std::size_t n = p.size();
  std::vector<double> density(n), shear(n), vertical(n);
  for (std::size_t i = 0; i < n; ++i) {
    const SoilState s = p.soil_state(i);
    density[i] = p.mass[i] / p.volume[i];
    shear[i] = std::sqrt(0.5 * double_dot(s.deviator, s.deviator));
    vertical[i] = s.deviator.zz - s.pressure;
  }
  std::vector<Infill::Field> fields{{"pressure", "Pa", p.pressure},
                                    {"density", "kg/m^3", std::move(density)},
                                    {"shear_stress", "Pa", std::move(shear)},
                                    {"vertical_stress", "Pa", std::move(vertical)},
                                    {"plastic_compression", "1", p.plastic_compression}};
  if (!p.lost_strength.empty()) fields.push_back({"lost_strength", "1", p.lost_strength});
  return fields;
}

std::vector<std::array<double, 6>> SphInfill::stress_moments() const {
  const Particles& p = impl_->particles;
  std::vector<std::array<double, 6>> moments(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const SoilState s = p.soil_state(i);
    const double v = p.strained_share[i] * p.volume[i];
    moments[i] = {v * (s.deviator.xx - s.pressure),
                  v * (s.deviator.yy - s.pressure),
                  v * (s.deviator.zz - s.pressure),
                  v * s.deviator.xy,
                  v * s.deviator.yz,
                  v * s.deviator.zx};
  }
  return moments;
}

}  // namespace tuft::sph
