/// How SphInfill steps: what is done before, in and after a step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "sph_infill/sph_infill_impl.h"

namespace tuft::sph {
namespace {

/// Bounds of the neighbour list's skin over the pitch. Wider: fewer rebuilds, more pairs out of reach to pass
/// over. Results do not depend on it, but for periods of individual steps. Where nothing sleeps it follows
/// the motion.
constexpr double least_skin_over_pitch = 0.02, largest_skin_over_pitch = 0.3;
/// Where only part of the list is renewed, its skin changes once another is better by this factor: that takes
/// a build of all of it.
constexpr double skin_growth_noted = 1.5;
/// A list that serves this many steps may be replaced before it is out of date, by one with half the skin or
/// less.
constexpr std::uint64_t long_service = 50;

/// Of all pairs, those that a step goes over where steps are individual and most of a bed is in motion.
constexpr double share_with_own_steps = 0.4;

/// What there is to do where a particle's state is no more what it can be.
constexpr std::string_view advice =
    "the run is unstable: lower numerics.step_safety, or look at what loads this particle (frames of run.h5)";

/// A step's pairs cost (reach + skin)^3, its share of a rebuild 2 move/skin times what a rebuild costs, some
/// 1.5 times all pairs (1.3 to 1.5 at 75 neighbours, 1.7 at 17): the sum is least at this skin. move: m a
/// step. share: of all pairs, that a step goes over.
double best_skin(double reach, double move, double pitch, double share) {
  return std::clamp(std::sqrt(1.0 / share * reach * move), least_skin_over_pitch * pitch,
                    largest_skin_over_pitch * pitch);
}

}  // namespace

KickSums SphInfill::Impl::step(double dt, const Vec3Array* impulse, double impulse_share) {
  const Sleep* sleeping = sleep.enabled() ? &sleep : nullptr;
  IndividualSteps* individual = steps.enabled() ? &steps : nullptr;
  if (individual)
    choose_sleepers(impulse, dt / impulse_share);
  else
    prepare(impulse, dt / impulse_share);

  const StressSums stress = update_stress(settings, list, individual ? dt : step_before, particles,
                                          stress_blocks, sleeping, individual);
  if (!stress.valid) report_invalid_stress();
  stable_step = stress.stable_step;

  const bool as_begun = kick_length == KickLength::step_begun && step_before > 0;
  const double duration = as_begun ? dt : 0.5 * (step_before + dt);
  const Kick now{std::min(2.0, step_before / duration), duration, gravity, damping, impulse, impulse_share};
  const KickSums kicked = kick(settings, list, now, particles, kick_blocks, sleeping, individual);
  record_energy(stress, kicked);

  // What has been expelled stays where it left.
  for (const Index i : expelled_index) particles.velocity.set(static_cast<std::size_t>(i), Vec3::Zero());
  const DriftCheck moved = drift(dt, frame, box, particles, drift_blocks, sleeping);
  if (!moved.valid) report_invalid_motion();
  displacement += dt * std::sqrt(moved.largest_speed_squared);
  frame = moved.velocity_sum / static_cast<double>(particles.size());
  time += dt;
  step_before = dt;
  particle_steps += computed_particles();
  if (sleeping)
    sleep.update([&](std::size_t b) { return kick_blocks[b].unrest; },
                 [&](std::size_t b) {
                   return static_cast<std::uint32_t>(steps.longest_period_of(
                       b * block_size, std::min(particles.size(), (b + 1) * block_size)));
                 });
  if (individual) steps.end(dt), begun = own_kicks = false;
  if (moved.outside) expel(dt);
  return kicked;
}

/// In the step under way.
std::size_t SphInfill::Impl::computed_particles() const {
  if (!steps.enabled()) return sleep.computed_particles();
  if (!sleep.enabled()) return steps.kicked_particles();
  std::size_t count = 0;
  for (const Index block : sleep.computed()) {
    const std::size_t begin = static_cast<std::size_t>(block) * block_size;
    count += steps.kicked_particles(begin, std::min(particles.size(), begin + block_size));
  }
  return count;
}

void SphInfill::Impl::begin_steps(double dt, int substeps, bool energy_wanted) {
  if (substeps > 1) steps.take_every_step();  // contact is not evaluated between them
  const bool rests = sleep.enabled() && !sleep.anything_moves();
  const bool choose = substeps == 1 && steps.to_be_chosen() && !rests, stale = list_has_served();
  if (stale) renew_list();
  // Of all that may come within the support before the list is built anew.
  const double reach = 2 * (settings.options.smoothing_length + list.allowed_displacement() - displacement);
  if (choose)
    steps.choose(list, particles, dt);
  else if (stale)
    steps.look_around(list, particles, dt);
  steps.shorten(list, particles, reach, dt);
  steps.begin(dt, energy_wanted, kick_length == KickLength::step_begun);
  begun = true;
  own_kicks = substeps == 1;
}

/// Energies of t_k: the kick's part before that moment counts, the rest is kept for the next.
void SphInfill::Impl::record_energy(const StressSums& stress, const KickSums& kicked) {
  energy.kinetic = kicked.kinetic;  // of those kicked, where steps are individual
  energy.gravity_potential = kicked.gravity_potential;
  energy.expelled += std::exchange(pending.expelled, 0);
  energy.stored += stress.work - stress.plastic;
  const auto account = [](double& sum, double& pending_work, const KickWork& work) {
    sum += pending_work + work.until_now;
    pending_work = work.whole - work.until_now;
  };
  energy.dissipated += stress.plastic;
  account(energy.dissipated, pending.viscous, kicked.viscous);
  account(energy.dissipated, pending.holding, kicked.holding);
  account(energy.damping, pending.damping, kicked.damping);
  account(energy.contact_work, pending.contact, kicked.contact);
  if (steps.enabled() && steps.is_in_step()) energy_in_step = energy;
}

void SphInfill::Impl::expel(double dt) {
  Particles& p = particles;
  for (std::size_t b = 0; b < drift_blocks.size(); ++b) {
    if (!drift_blocks[b].outside) continue;
    for (std::size_t i = b * block_size; i < std::min(p.size(), (b + 1) * block_size); ++i) {
      const Vec3 x = p.position[i], v = p.velocity[i];
      if ((x.array() >= box.low.array() && x.array() <= box.high.array()).all()) continue;
      if (!expelled_mask.empty() && expelled_mask[i] != 0) continue;
      // As KickSums counts it: of the velocities half a step before and, falling freely, half a step after.
      const double kinetic = 0.5 * p.mass[i] * v.dot(v + dt * gravity);
      ++expelled.particles;
      expelled.mass += p.mass[i];
      expelled.momentum += p.mass[i] * v;
      expelled.kinetic_energy += kinetic;
      pending.expelled += kinetic;
      take_out(static_cast<Index>(i));
    }
  }
}

void SphInfill::Impl::take_out(Index particle) {
  const auto i = static_cast<std::size_t>(particle);
  if (expelled_mask.empty()) expelled_mask.assign(particles.size(), 0);
  expelled_mask[i] = 1;
  expelled_index.push_back(particle);
  particles.velocity.set(i, Vec3::Zero());
  particles.record_motion(i);
  list.leave_out(particle, particles.size());
  displacement = std::numeric_limits<double>::infinity();  // the list is to be built anew
}

void SphInfill::Impl::note_neighbours() {
  sleep.find_moving();
  sleep.set_neighbours(list, sleep.moving());
}

bool SphInfill::Impl::list_has_served() {
  bool served = displacement > list.allowed_displacement();
  if (list_steps > 0 && std::isfinite(displacement)) {
    const double moved = displacement - moved_before;
    const double skin =
        best_skin(2 * settings.options.smoothing_length, moved / static_cast<double>(list_steps), pitch,
                  steps.enabled() ? share_with_own_steps : 1);
    served = served || (list_steps >= long_service && skin <= 0.5 * list.skin());
    list.set_skin(skin);
  }
  ++list_steps;
  return served;
}

void SphInfill::Impl::build_list() {
  list.build(particles.position);
  sleep.forget_neighbours();
  displacement = moved_before = 0, list_steps = 1;
}

void SphInfill::Impl::renew_list() {
  const double growth = list.next_skin() / list.skin();
  if (!std::isfinite(displacement) || growth > skin_growth_noted || growth < 1 / skin_growth_noted) {
    build_list();
    return;
  }
  const NeighbourList::Renewal renewal = list.renew(particles.position);
  sleep.forget_neighbours();
  displacement = moved_before = renewal.farthest, list_steps = 1;
}

double SphInfill::set_sheets(std::span<const std::array<Vec3, 4>> sheets) {
  Impl& m = *impl_;
  // Pairs farther apart than the support now may come within it until the next call.
  constexpr double look_ahead = 1.15;
  const double support = 2 * m.settings.options.smoothing_length;
  SeparatedPairs pairs(m.particles.position, sheets, look_ahead * support);
  if (pairs != m.list.separated()) {
    m.list.separate(std::move(pairs));
    m.displacement = std::numeric_limits<double>::infinity();  // the list is out of date
  }
  return 0.5 * (look_ahead - 1) * support;
}

void SphInfill::Impl::prepare(const Vec3Array* impulse, double window) {
  if (!sleep.enabled()) {
    if (list_has_served()) build_list();
    return;
  }
  const bool stale = displacement > list.allowed_displacement();
  if (stale) displacement = 0;
  // Rows of sleeping blocks are made when they are needed. Of what moves first: it decides which are on
  // guard.
  if (stale) list.begin(particles.position);
  sleep.find_moving();
  sleep.set_neighbours(list, list.complete(particles.position, sleep.moving()));
  sleep.choose(list, particles, impulse, window);
  sleep.set_neighbours(list, list.complete(particles.position, sleep.computed()));
}

void SphInfill::Impl::choose_sleepers(const Vec3Array* impulse, double window) {
  if (!sleep.enabled()) return;
  sleep.find_moving();
  sleep.choose(list, particles, impulse, window, own_kicks ? steps.kicks() : ParticleKicks{});
}

void SphInfill::Impl::report_invalid_stress() const {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const SoilState s = particles.soil_state(i);
    const double ratio = std::exp(s.compression);
    if (!(ratio > smallest_density_ratio && ratio < largest_density_ratio))
      throw_run_error(
          "SPH infill: particle {} at t = {:.6g} s: density is {:.6g} times the reference, outside [{}, {}]; "
          "{}",
          i, time, ratio, smallest_density_ratio, largest_density_ratio, advice);
    if (!std::isfinite(s.pressure))
      throw_run_error("SPH infill: particle {} at t = {:.6g} s: pressure is {} Pa; {}", i, time, s.pressure,
                      advice);
    if (!std::isfinite(double_dot(s.deviator, s.deviator)))
      throw_run_error("SPH infill: particle {} at t = {:.6g} s: deviatoric stress is not finite; {}", i, time,
                      advice);
  }
  throw_run_error("SPH infill at t = {:.6g} s: an invalid stress was found, then not again; {}", time,
                  advice);
}

void SphInfill::Impl::report_invalid_motion() const {
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3 v = particles.velocity[i], x = particles.position[i];
    if (!v.allFinite())
      throw_run_error("SPH infill: particle {} at t = {:.6g} s: velocity is ({}, {}, {}) m/s; {}", i, time,
                      v.x(), v.y(), v.z(), advice);
    if (!x.allFinite())
      throw_run_error("SPH infill: particle {} at t = {:.6g} s: position is ({}, {}, {}) m; {}", i, time,
                      x.x(), x.y(), x.z(), advice);
  }
  throw_run_error("SPH infill at t = {:.6g} s: speeds are too large to square; {}", time, advice);
}

}  // namespace tuft::sph
