/// Pass 2 of a step: forces and the kick that they give; and the drift after it.
#include <array>

#include "sph_infill/individual_steps.h"
#include "sph_infill/pair_forces.h"
#include "sph_infill/sph_infill.h"

namespace tuft::sph {
namespace {

using PackVector = std::array<Pack, 3>;

Pack dot(const PackVector& a, const PackVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
PackVector load_vectors(const Vec3Array& v, std::size_t i, std::size_t count) {
  return {load_lanes(v.x, i, count), load_lanes(v.y, i, count), load_lanes(v.z, i, count)};
}
void store_vectors(const PackVector& pack, Vec3Array& v, std::size_t i, std::size_t count) {
  store_lanes(pack[0], v.x, i, count), store_lanes(pack[1], v.y, i, count),
      store_lanes(pack[2], v.z, i, count);
}

/// KickSums of a block, lane by lane.
struct PackSums {
  struct Work {
    Pack until_now = 0, whole = 0;
  };
  Pack kinetic = 0, gravity_potential = 0;
  Work viscous, damping, contact, holding;
  PackVector impulse{}, impulse_scale{};

  [[nodiscard]] KickSums sum() const {
    const auto work = [](const Work& w) { return KickWork{sum_lanes(w.until_now), sum_lanes(w.whole)}; };
    const auto vector = [](const PackVector& v) {
      return Vec3(sum_lanes(v[0]), sum_lanes(v[1]), sum_lanes(v[2]));
    };
    return {sum_lanes(kinetic),
            sum_lanes(gravity_potential),
            work(viscous),
            work(damping),
            work(contact),
            work(holding),
            vector(impulse),
            vector(impulse_scale),
            0};
  }
};

/// Squares of speed and of the acceleration that particles have, or would have if they were not held.
struct Motion {
  Pack speed, acceleration;  ///< (m/s)^2, (m/s^2)^2
};

/// The kick of `count` particles from i on, pack `part` of their group.
template <class Chosen>
Motion kick_particles(const Kick& kick, const GroupForces& forces, std::size_t part, std::size_t i,
                      std::size_t count, bool held, Particles& p, PackSums& total) {
  const Pack mass = load_lanes(p.mass, i, count), per_mass = 1.0 / mass;
  const PackVector before = load_vectors(p.velocity, i, count);
  const double t = kick.duration;
  // Damping by the mean of the velocities before and after: unconditionally stable, and its work is exact.
  const double half_damping = 0.5 * kick.damping * t, scale = 1 / (1 + half_damping),
               kept = (1 - half_damping) * scale;
  PackVector impulse{};
  if (kick.impulse) {
    impulse = load_vectors(*kick.impulse, i, count);
    for (Pack& component : impulse) component *= kick.impulse_share;
  }
  PackVector free, after, mean, change;
  for (std::size_t d = 0; d < 3; ++d) {
    const double fall = t * kick.gravity[static_cast<Eigen::Index>(d)];
    free[d] = kept * before[d] + scale * (per_mass * (t * forces.whole[d][part] + impulse[d]) + fall);
    after[d] = held ? Pack(0.0) : free[d];
    mean[d] = 0.5 * (before[d] + after[d]);
    change[d] = free[d] - before[d];
  }
  store_vectors(after, p.velocity, i, count);

  const auto add = [count](Pack& sum, const Pack& value) { sum += only(value, count); };
  const auto add_work = [&](PackSums::Work& sum, const PackVector& given) {
    add(sum.until_now, 0.5 * kick.share_before * dot(given, before)), add(sum.whole, dot(given, mean));
  };
  // v . (v before and what of the change belongs before t_k)
  add(total.kinetic, mass * ((0.5 - 0.5 * kick.share_before) * dot(before, before) +
                             0.5 * kick.share_before * dot(before, after)));
  const PackVector x = load_vectors(p.position, i, count);
  add(total.gravity_potential,
      -mass * (kick.gravity.x() * x[0] + kick.gravity.y() * x[1] + kick.gravity.z() * x[2]));
  if constexpr (Chosen::dissipative) {
    const auto& f = forces.viscous;
    add_work(total.viscous, {-t * f[0][part], -t * f[1][part], -t * f[2][part]});
  }
  if (kick.damping != 0) {
    const Pack rate = kick.damping * t * mass;
    add_work(total.damping, {rate * mean[0], rate * mean[1], rate * mean[2]});
  }
  if (kick.impulse) {
    add_work(total.contact, impulse);
    for (std::size_t d = 0; d < 3; ++d)
      add(total.impulse[d], impulse[d]), add(total.impulse_scale[d], stdx::abs(impulse[d]));
  }
  if (held) {
    const Pack inertia = mass * (1 + half_damping);
    add_work(total.holding, {inertia * free[0], inertia * free[1], inertia * free[2]});
  }
  return {dot(before, before), dot(change, change) / (t * t)};
}

/// held: velocities become zero. measured: unrest is found.
template <class Chosen, class KernelType>
KickSums kick_block(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                    const Kick& of_step, const IndividualSteps* steps, bool held, bool measured,
                    std::size_t begin, std::size_t end, Particles& p) {
  PackSums total;
  Pack unrest_squared = 0, not_finite = 0;
  for (std::size_t first = begin; first < end; first += group_size) {
    const std::size_t group = first / group_size;
    Kick kick = of_step;
    if (steps) {
      if (!steps->is_kicked(group)) continue;
      kick.duration = steps->kick_length(group);
      kick.share_before = 2 * steps->velocity_lag(group) / kick.duration;
    }
    if constexpr (Chosen::controlled)
      prefetch_records(list, group, p.motion, p.stress, p.residual);
    else
      prefetch_records(list, group, p.motion, p.stress);
    const GroupForces forces = sum_pair_forces<Chosen>(kernel, list, p, group);
    for (std::size_t k = 0, i = first; k < packs_of_single && i < end; ++k, i += lanes) {
      const std::size_t count = std::min(lanes, end - i);
      const Motion motion = kick_particles<Chosen>(kick, forces, k, i, count, held, p, total);
      if (!measured) continue;
      const Pack c([&](std::size_t l) { return double(p.stress[i + (l < count ? l : 0)].wave_speed); });
      const Pack bend = settings.options.smoothing_length / (c * c);
      unrest_squared =
          stdx::max(unrest_squared, stdx::max(motion.speed / (c * c), bend * bend * motion.acceleration));
      not_finite +=
          only(0.0 * motion.acceleration, count);  // 0 unless one is not; a maximum would pass it over
    }
  }
  KickSums sums = total.sum();
  sums.unrest = std::sqrt(-smallest_lane(-unrest_squared)) + sum_lanes(not_finite);
  return sums;
}

/// Kick of a block that is held as long as its unrest allows: as if it were free first, to know it. steps:
/// null, or which of it are kicked.
template <class Chosen, class KernelType>
KickSums kick_held_block(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                         const Kick& kick, const Sleep& sleep, const IndividualSteps* steps,
                         std::size_t begin, std::size_t end, Particles& p) {
  const std::size_t block = begin / block_size;
  const Vec3Array& velocity = p.velocity;
  std::array<Vec3, block_size> before;
  for (std::size_t i = begin; i < end; ++i) before[i - begin] = velocity[i];
  KickSums sums = kick_block<Chosen>(kernel, settings, list, kick, steps, false, true, begin, end, p);
  if (sleep.wakes(sums.unrest)) return sums;
  for (std::size_t i = begin; i < end; ++i) p.velocity.set(i, before[i - begin]);
  if (!sleep.has_settled(block)) {
    const double unrest = sums.unrest;
    sums = kick_block<Chosen>(kernel, settings, list, kick, steps, true, false, begin, end, p);
    sums.unrest = unrest;
    return sums;
  }
  // It had no velocity and has none: no work was done.
  sums.kinetic = 0;
  sums.viscous = sums.damping = sums.contact = sums.holding = {};
  return sums;
}

/// A sleeping block takes what contact gives it, without moving.
void take_impulses(const Kick& kick, std::size_t begin, std::size_t end, KickSums& sums) {
  sums.impulse = sums.impulse_scale = Vec3::Zero();
  if (!kick.impulse) return;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3 given = kick.impulse_share * (*kick.impulse)[i];
    sums.impulse += given;
    sums.impulse_scale += given.cwiseAbs();
  }
}

/// Of a sleeping block, where a kick may have been of a part of it: in steps in which energies are of one
/// moment.
KickSums energy_at_rest(const IndividualSteps& steps, const Vec3& gravity, const Particles& p,
                        std::size_t begin, std::size_t end) {
  KickSums sums;
  if (!steps.is_in_step()) return sums;
  for (std::size_t i = begin; i < end; ++i) sums.gravity_potential -= p.mass[i] * gravity.dot(p.position[i]);
  return sums;
}

}  // namespace

KickSums& KickSums::operator+=(const KickSums& other) {
  kinetic += other.kinetic;
  gravity_potential += other.gravity_potential;
  viscous += other.viscous;
  damping += other.damping;
  contact += other.contact;
  holding += other.holding;
  impulse += other.impulse;
  impulse_scale += other.impulse_scale;
  return *this;
}

KickSums kick(const LoopSettings& settings, const NeighbourList& list, const Kick& kick, Particles& particles,
              std::vector<KickSums>& blocks, const Sleep* sleep, const IndividualSteps* steps) {
  const auto pass = [&](auto chosen, const auto kernel) {
    for_blocks(particles.size(), sleep, [&](std::size_t b, std::size_t begin, std::size_t end) {
      blocks[b] = sleep && sleep->is_held(b)
                      ? kick_held_block<decltype(chosen)>(kernel, settings, list, kick, *sleep, steps, begin,
                                                          end, particles)
                      : kick_block<decltype(chosen)>(kernel, settings, list, kick, steps, false,
                                                     sleep != nullptr, begin, end, particles);
    });
  };
  with_kernel(settings.options, [&](const auto kernel) {
    if (settings.artificial_viscosity && settings.zero_energy_control)
      pass(Forces<true, true>(), kernel);
    else if (settings.artificial_viscosity)
      pass(Forces<true, false>(), kernel);
    else if (settings.zero_energy_control)
      pass(Forces<false, true>(), kernel);
    else
      pass(Forces<false, false>(), kernel);
  });
  if (sleep)
    for_blocks(particles.size(), nullptr, [&](std::size_t b, std::size_t begin, std::size_t end) {
      if (!sleep->is_asleep(b)) return;
      // Otherwise that stays which the block was last computed with, all of it at once.
      if (steps) blocks[b] = energy_at_rest(*steps, kick.gravity, particles, begin, end);
      take_impulses(kick, begin, end, blocks[b]);
    });
  KickSums sum;
  for (const KickSums& block : blocks) sum += block;
  return sum;
}

DriftCheck drift(double dt, const Vec3& frame, const TurfBox& box, Particles& p,
                 std::vector<DriftCheck>& blocks, const Sleep* sleep) {
  if (sleep)
    std::fill(blocks.begin(), blocks.end(), DriftCheck{frame.squaredNorm(), Vec3::Zero(), true, false});
  for_blocks(p.size(), sleep, [&](std::size_t b, std::size_t begin, std::size_t end) {
    Pack largest = 0, not_finite = 0, beyond = 0;
    PackVector velocity_sum{};
    for (std::size_t i = begin; i < end; i += lanes) {
      const std::size_t count = std::min(lanes, end - i);
      const PackVector v = load_vectors(p.velocity, i, count);
      PackVector x = load_vectors(p.position, i, count);
      Pack speed_squared = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto axis = static_cast<Eigen::Index>(d);
        x[d] += dt * v[d];
        const Pack u = v[d] - frame[axis];
        speed_squared += u * u;
        velocity_sum[d] += only(v[d], count);
        beyond = stdx::max(beyond, stdx::max(box.low[axis] - x[d], x[d] - box.high[axis]));
      }
      store_vectors(x, p.position, i, count);
      largest = stdx::max(largest, speed_squared);
      not_finite += 0.0 * (speed_squared + (x[0] + x[1] + x[2]));  // 0 unless one is not
    }
    p.record_motion(begin, end);
    const auto& sum = velocity_sum;
    blocks[b] = {-smallest_lane(-largest),
                 {sum_lanes(sum[0]), sum_lanes(sum[1]), sum_lanes(sum[2])},
                 sum_lanes(not_finite) == 0,
                 stdx::any_of(beyond > 0.0)};
  });
  DriftCheck check;
  for (const DriftCheck& block : blocks) {
    check.largest_speed_squared = std::max(check.largest_speed_squared, block.largest_speed_squared);
    check.velocity_sum += block.velocity_sum;
    check.valid = check.valid && block.valid;
    check.outside = check.outside || block.outside;
  }
  return check;
}

}  // namespace tuft::sph
