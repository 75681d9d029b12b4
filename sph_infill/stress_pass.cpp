/// Pass 1 of a step: velocity gradients, stresses and what the force pass needs of each particle.
#include <cmath>
#include <span>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/individual_steps.h"
#include "sph_infill/particle_packs.h"
#include "sph_infill/soil_update.h"

namespace tuft::sph {
namespace {

template <class Real>
struct GradientSumsOf {
  SymmetricTensorOf<Real> moment;
  TensorOf<Real> velocity;
  std::array<Real, 3> gradient{};
  SymmetricTensorOf<Real> mobility;
};

/// What the sums take of a pair, w = V_j times the shape of the kernel's slope; in units of the records.
struct WeighedPair {
  SinglePack dx, dy, dz;    ///< x_i - x_j
  SinglePack wx, wy, wz;    ///< w (x_i - x_j)
  SinglePack ux, uy, uz;    ///< v_j - v_i, m/s
  SinglePack inverse_mass;  ///< of j
};

/// The three below go over the same pairs one after the other: all 24 sums at once would not stay in
/// registers, of which processors without AVX-512 have 16.
void add_moments(std::span<const WeighedPair> pairs, GradientSumsOf<SinglePack>& sums) {
  GradientSumsOf<SinglePack> sum = sums;
  SymmetricTensorOf<SinglePack>& m = sum.moment;
  for (const WeighedPair& q : pairs) {
    m.xx -= q.wx * q.dx, m.yy -= q.wy * q.dy, m.zz -= q.wz * q.dz;
    m.xy -= q.wx * q.dy, m.yz -= q.wy * q.dz, m.zx -= q.wz * q.dx;
    sum.gradient[0] += q.wx, sum.gradient[1] += q.wy, sum.gradient[2] += q.wz;
  }
  sums.moment = m, sums.gradient = sum.gradient;
}
void add_velocities(std::span<const WeighedPair> pairs, TensorOf<SinglePack>& velocity) {
  TensorOf<SinglePack> v = velocity;
  for (const WeighedPair& q : pairs) {
    v.xx += q.ux * q.wx, v.xy += q.ux * q.wy, v.xz += q.ux * q.wz;
    v.yx += q.uy * q.wx, v.yy += q.uy * q.wy, v.yz += q.uy * q.wz;
    v.zx += q.uz * q.wx, v.zy += q.uz * q.wy, v.zz += q.uz * q.wz;
  }
  velocity = v;
}
void add_mobilities(std::span<const WeighedPair> pairs, SymmetricTensorOf<SinglePack>& mobility) {
  SymmetricTensorOf<SinglePack> c = mobility;
  for (const WeighedPair& q : pairs) {
    const SinglePack nx = q.inverse_mass * q.wx, ny = q.inverse_mass * q.wy, nz = q.inverse_mass * q.wz;
    c.xx += nx * q.wx, c.yy += ny * q.wy, c.zz += nz * q.wz;
    c.xy += nx * q.wy, c.yz += ny * q.wz, c.zx += nz * q.wx;
  }
  mobility = c;
}

/// See GradientSums; a particle a lane.
using GroupGradients = std::array<GradientSumsOf<Pack>, packs_of_single>;

/// In units of the particles: `factor` is the kernel's.
GroupGradients widened_sums(const GradientSumsOf<SinglePack>& sums, double factor, const Particles& p) {
  GroupGradients wide;
  const double gradient = factor * p.volume_unit() * p.position_unit(), moment = gradient * p.position_unit();
  const auto widen = [&wide](double by, const SinglePack& single, auto&& in) {
    const auto packs = widened(single);
    for (std::size_t k = 0; k < packs.size(); ++k) in(wide[k]) = by * packs[k];
  };
  const auto widen_tensor = [&](double by, const SymmetricTensorOf<SinglePack>& single, auto tensor) {
    using Tensor = SymmetricTensorOf<Pack>;
    const auto component = [&](const SinglePack& value, Pack Tensor::*at) {
      widen(by, value, [&](GradientSumsOf<Pack>& s) -> Pack& { return s.*tensor.*at; });
    };
    component(single.xx, &Tensor::xx), component(single.yy, &Tensor::yy), component(single.zz, &Tensor::zz);
    component(single.xy, &Tensor::xy), component(single.yz, &Tensor::yz), component(single.zx, &Tensor::zx);
  };
  widen_tensor(moment, sums.moment, &GradientSumsOf<Pack>::moment);
  widen_tensor(gradient * gradient, sums.mobility, &GradientSumsOf<Pack>::mobility);
  const auto velocity = [&](const SinglePack& value, Pack TensorOf<Pack>::*at) {
    widen(gradient, value, [&](GradientSumsOf<Pack>& s) -> Pack& { return s.velocity.*at; });
  };
  using T = TensorOf<Pack>;
  const TensorOf<SinglePack>& v = sums.velocity;
  velocity(v.xx, &T::xx), velocity(v.xy, &T::xy), velocity(v.xz, &T::xz);
  velocity(v.yx, &T::yx), velocity(v.yy, &T::yy), velocity(v.yz, &T::yz);
  velocity(v.zx, &T::zx), velocity(v.zy, &T::zy), velocity(v.zz, &T::zz);
  for (std::size_t d = 0; d < 3; ++d)
    widen(gradient, sums.gradient[d], [d](GradientSumsOf<Pack>& s) -> Pack& { return s.gradient[d]; });
  return wide;
}

template <class KernelType>
GroupGradients sum_pair_gradients(const KernelType kernel, const NeighbourList& list, const Particles& p,
                                  std::size_t group) {
  const auto own = RecordPlaces(entries_of_group(group, p.size()).data()).load(p.motion);
  GradientSumsOf<SinglePack> sum;
  std::array<WeighedPair, row_chunk> weighed;
  for_chunks(list.group(group), [&](const RowEntry* entries, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const auto other = RecordPlaces(entries + k * group_size).load(p.motion);
      const PairMotion pair(own, other);
      const SinglePack w = other[3] * kernel.slope_shape(pair.q_squared);
      const auto& [dx, dy, dz] = pair.d;
      weighed[k] = {dx, dy, dz, w * dx, w * dy, w * dz, pair.u[0], pair.u[1], pair.u[2], other[7]};
    }
    const std::span<const WeighedPair> pairs(weighed.data(), count);
    add_moments(pairs, sum);
    add_velocities(pairs, sum.velocity);
    add_mobilities(pairs, sum.mobility);
  });
  return widened_sums(sum, kernel.slope_factor(), p);
}

template <SoilEffects on>
SoilStateOf<Pack> load_state(const Particles& p, std::size_t i, std::size_t count) {
  const auto of = [&](const std::vector<double>& values) { return load_lanes(values, i, count); };
  Pack lost = 0;
  if constexpr (on.strength_softening) lost = of(p.lost_strength);
  return {of(p.compression),
          of(p.largest_compression),
          of(p.plastic_compression),
          of(p.pressure),
          of(p.bulk_modulus),
          {of(p.deviator[0]), of(p.deviator[1]), of(p.deviator[2]), of(p.deviator[3]), of(p.deviator[4]),
           of(p.deviator[5])},
          lost};
}

template <SoilEffects on>
void store_state(const SoilStateOf<Pack>& s, std::size_t i, std::size_t count, Particles& p) {
  const auto to = [&](std::vector<double>& values, const Pack& pack) { store_lanes(pack, values, i, count); };
  to(p.compression, s.compression);
  to(p.largest_compression, s.largest_compression);
  to(p.plastic_compression, s.plastic_compression);
  to(p.pressure, s.pressure);
  to(p.bulk_modulus, s.bulk_modulus);
  const SymmetricTensorOf<Pack>& d = s.deviator;
  const std::array<const Pack*, 6> component{&d.xx, &d.yy, &d.zz, &d.xy, &d.yz, &d.zx};
  for (std::size_t c = 0; c < 6; ++c) to(p.deviator[c], *component[c]);
  if constexpr (on.strength_softening) to(p.lost_strength, s.lost_strength);
}

/// Written so that NaN fails; the sum of squares is not finite if any component is not.
PackMask is_valid(const SoilStateOf<Pack>& state) {
  static const double low = std::log(smallest_density_ratio), high = std::log(largest_density_ratio);
  const Pack sum = state.pressure + double_dot(state.deviator, state.deviator);
  return state.compression > low && state.compression < high && stdx::abs(sum) < 1e300;
}

/// S = (v*/V) sigma B, the half of the pair force that a particle brings, and its viscous factors. growth:
/// v*/V, v* of the part of a cell that strains.
void store_stress_records(const LoopSettings& settings, const SoilStateOf<Pack>& state,
                          const SymmetricTensorOf<Pack>& correction, const Pack& growth, const Pack& density,
                          const Pack& wave_speed, std::size_t i, std::size_t count, Particles& p) {
  SymmetricTensorOf<Pack> stress = state.deviator;
  stress.xx -= state.pressure, stress.yy -= state.pressure, stress.zz -= state.pressure;
  const TensorOf<Pack> q = dot(growth * stress, correction);
  Pack linear = 0, quadratic = 0;
  if (settings.artificial_viscosity) {
    const double unit = MotionRecord::position_unit;
    const Pack root = stdx::sqrt(density);
    linear = root * stdx::sqrt((settings.options.viscosity_linear * unit) * wave_speed);
    quadratic = (unit * std::sqrt(settings.options.viscosity_quadratic)) * root;
  }
  store_records(
      std::array{q.xx, q.xy, q.xz, q.yx, q.yy, q.yz, q.zx, q.zy, q.zz, linear, quadratic, wave_speed}, i,
      count, p.stress);
}

/// C L and C over the unit of positions; C = zeta rho c h, or 0 where L is not the fit of the neighbours'
/// motion.
void store_residual_records(const SphOptions& options, const TensorOf<Pack>& l, const PackMask& fitted,
                            const Pack& impedance, std::size_t i, std::size_t count, Particles& p) {
  const Pack c =
      select(fitted, (options.zero_energy_viscosity * options.smoothing_length) * impedance, Pack(0.0));
  store_records(std::array{c * l.xx, c * l.xy, c * l.xz, c * l.yx, c * l.yy, c * l.yz, c * l.zx, c * l.zy,
                           c * l.zz, c / p.position_unit(), Pack(0.0), Pack(0.0)},
                i, count, p.residual);
}

/// Squared length of row i of L in mass-scaled velocities, 1/(kg m^2), in the parts that stable_step.h bounds
/// frequencies with.
struct RowMobility {
  Pack neighbours, own;
};

RowMobility row_mobility(const GradientSumsOf<Pack>& sums, const SymmetricTensorOf<Pack>& b,
                         const Pack& inverse_mass) {
  const TensorOf<Pack> bc = dot(b, sums.mobility);
  const Pack neighbours = bc.xx * b.xx + bc.xy * b.xy + bc.xz * b.zx + bc.yx * b.xy + bc.yy * b.yy +
                          bc.yz * b.yz + bc.zx * b.zx + bc.zy * b.yz + bc.zz * b.zz;
  const auto& g = sums.gradient;
  const Pack x = b.xx * g[0] + b.xy * g[1] + b.zx * g[2], y = b.xy * g[0] + b.yy * g[1] + b.yz * g[2],
             z = b.zx * g[0] + b.yz * g[1] + b.zz * g[2];
  return {neighbours, inverse_mass * (x * x + y * y + z * z)};
}

/// Sums of a block, lane by lane.
struct PackSums {
  Pack work = 0, plastic = 0, stable_step = std::numeric_limits<double>::infinity();
  bool valid = true;
};

/// What follows from the pair sums of `count` particles from i on.
template <SoilEffects on>
void update_particles(const LoopSettings& settings, const GradientSumsOf<Pack>& sums, double dt,
                      std::size_t i, std::size_t count, Particles& p, PackSums& total) {
  std::array<const SoilLaw*, lanes> of_lane;
  for (std::size_t l = 0; l < lanes; ++l)
    of_lane[l] = &settings.laws[static_cast<std::size_t>(p.material[i + (l < count ? l : 0)])];
  const LawOfLanes law(of_lane);
  const auto [correction, fitted] = correction_matrices(sums.moment);
  const TensorOf<Pack> velocity_gradient = dot(sums.velocity, correction);
  SoilStateOf<Pack> state = load_state<on>(p, i, count);
  const Pack weighed = load_lanes(p.volume, i, count);  // V, by which both passes of the step weigh
  const Pack share = load_lanes(p.strained_share, i, count);
  Pack volume = weighed;
  if (dt > 0) {
    const SoilWorkOf<Pack> work = update_soil_state<on>(law, strain_step_of(velocity_gradient, dt), state);
    volume = load_lanes(p.reference_volume, i, count) * exp(-state.compression);
    const Pack middle_volume = 0.5 * share * (weighed + volume);
    total.work += only(middle_volume * work.total, count);
    total.plastic += only(middle_volume * work.dissipated, count);
    store_state<on>(state, i, count, p);
    total.valid = total.valid && stdx::all_of(is_valid(state));
  }
  store_lanes(volume, p.volume, i, count);

  const Pack mass = load_lanes(p.mass, i, count);
  const Pack modulus = state.bulk_modulus * (1.0 + 4.0 / 3.0 * law.value(&SoilLaw::shear_ratio));
  const Pack wave_speed = stdx::sqrt(modulus * volume / mass);
  const RowMobility row = row_mobility(sums, correction, Pack(1.0) / mass);
  const Pack frequency = stdx::sqrt(modulus * share * volume *
                                    largest_mobility(settings.step_limit, row.neighbours, row.own, volume,
                                                     load_lanes(p.reference_volume, i, count)));
  const SymmetricTensorOf<Pack> rate = symmetric_part(velocity_gradient);
  const Pack stable =
      particle_stable_step(settings.step_limit, frequency, wave_speed, stdx::sqrt(double_dot(rate, rate)),
                           share_inside(row.neighbours, row.own));
  total.stable_step = stdx::min(total.stable_step, stable);
  if (!p.own_step.empty())
    for (std::size_t l = 0; l < count; ++l) p.own_step[i + l] = static_cast<float>(stable[l]);
  const Pack density = mass / volume;
  store_stress_records(settings, state, correction, share * volume / weighed, density, wave_speed, i, count,
                       p);
  if (settings.zero_energy_control)
    store_residual_records(settings.options, velocity_gradient, fitted, density * wave_speed, i, count, p);
}

/// update_particles for the effects of the scene. Apart from the kernel's loop: there are many combinations
/// of effects, and no kernel in any.
using ParticleUpdate = decltype(&update_particles<SoilEffects{}>);

ParticleUpdate particle_update_of(const SoilEffects& effects) {
  ParticleUpdate update = nullptr;
  with_soil_effects(effects, [&](auto on) { update = update_particles<decltype(on)::value>; });
  return update;
}

/// Stable steps of those that were not strained count too, as they are stored, in single precision.
void note_steps(const Particles& p, std::size_t begin, std::size_t end, IndividualSteps& steps,
                StressSums& sums) {
  for (std::size_t i = begin; i < end; i += group_size) {
    const auto first = p.own_step.begin() + static_cast<std::ptrdiff_t>(i);
    const double stable =
        *std::min_element(first, first + static_cast<std::ptrdiff_t>(std::min(group_size, end - i)));
    if (!steps.is_strained(i / group_size)) sums.stable_step = std::min(sums.stable_step, stable);
    steps.note(i / group_size, stable);
  }
}

template <class KernelType>
StressSums update_block(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                        double dt, IndividualSteps* steps, std::size_t begin, std::size_t end, Particles& p) {
  const ParticleUpdate update = particle_update_of(settings.soil_effects);
  PackSums total;
  for (std::size_t first = begin; first < end; first += group_size) {
    const std::size_t group = first / group_size;
    if (steps && !steps->is_strained(group)) continue;
    prefetch_records(list, group, p.motion);
    if (const std::size_t ahead = first + groups_ahead * group_size; ahead < p.stress.size())
      prefetch<Access::write>(p.stress.data() + ahead, group_size);
    const GroupGradients sums = sum_pair_gradients(kernel, list, p, group);
    const double since = steps ? steps->since_strain(group) : dt;
    for (std::size_t k = 0, i = first; k < sums.size() && i < end; ++k, i += lanes)
      update(settings, sums[k], since, i, std::min(lanes, end - i), p, total);
  }
  StressSums sums{sum_lanes(total.work), sum_lanes(total.plastic), smallest_lane(total.stable_step),
                  total.valid};
  if (steps) note_steps(p, begin, end, *steps, sums);
  return sums;
}

}  // namespace

GradientSums sum_gradients(const LoopSettings& settings, const NeighbourList& list,
                           const Particles& particles, std::size_t i) {
  const GroupGradients group = with_kernel(settings.options, [&](const auto kernel) {
    return sum_pair_gradients(kernel, list, particles, i / group_size);
  });
  const GradientSumsOf<Pack>& all = group[i % group_size / lanes];
  const std::size_t l = i % lanes;
  const auto tensor = [l](const SymmetricTensorOf<Pack>& t) {
    return SymmetricTensor{t.xx[l], t.yy[l], t.zz[l], t.xy[l], t.yz[l], t.zx[l]};
  };
  const TensorOf<Pack>& v = all.velocity;
  GradientSums result;
  result.moment = tensor(all.moment);
  result.velocity << v.xx[l], v.xy[l], v.xz[l], v.yx[l], v.yy[l], v.yz[l], v.zx[l], v.zy[l], v.zz[l];
  result.gradient = {all.gradient[0][l], all.gradient[1][l], all.gradient[2][l]};
  result.mobility = tensor(all.mobility);
  return result;
}

StressSums update_stress(const LoopSettings& settings, const NeighbourList& list, double dt,
                         Particles& particles, std::vector<StressSums>& blocks, const Sleep* sleep,
                         IndividualSteps* steps) {
  with_kernel(settings.options, [&](const auto kernel) {
    for_blocks(particles.size(), sleep, [&](std::size_t b, std::size_t begin, std::size_t end) {
      blocks[b] = update_block(kernel, settings, list, dt, steps, begin, end, particles);
    });
  });
  StressSums sum;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const StressSums& block = blocks[b];
    sum.stable_step = std::min(sum.stable_step, block.stable_step);
    if (sleep && sleep->is_asleep(b)) continue;
    sum.work += block.work;
    sum.plastic += block.plastic;
    sum.valid = sum.valid && block.valid;
  }
  return sum;
}

}  // namespace tuft::sph
