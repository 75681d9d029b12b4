/// Pass 1 of a step: velocity gradients, stresses and what the force pass needs of each particle.
#include <cmath>

#include "sph_infill/gradient_correction.h"
#include "sph_infill/particle_packs.h"
#include "sph_infill/soil_update.h"

namespace tuft::sph {
namespace {

// Rows of a tile: moment (6), velocity (9), gradient (3), mobility (6); see GradientSums.
constexpr std::size_t gradient_rows = 24;
using GradientTile = Tile<gradient_rows>;

/// Writes the sums of particle i into entry `slot` of the tile's rows.
template <class KernelType>
void sum_pair_gradients(const KernelType kernel, const NeighbourList& list, const Particles& p, std::size_t i,
                        GradientTile& tile, std::size_t slot) {
  const double *x = p.position.x.data(), *y = p.position.y.data(), *z = p.position.z.data();
  const double *vx = p.velocity.x.data(), *vy = p.velocity.y.data(), *vz = p.velocity.z.data();
  const double *volume = p.volume.data(), *inverse_mass = p.inverse_mass.data();
  const double xi = x[i], yi = y[i], zi = z[i], vxi = vx[i], vyi = vy[i], vzi = vz[i];
  const Index* row = list.row(i).data();
  const std::size_t batches = list.row(i).size() / NeighbourList::row_multiple;

  double mxx = 0, myy = 0, mzz = 0, mxy = 0, myz = 0, mzx = 0;
  double lxx = 0, lxy = 0, lxz = 0, lyx = 0, lyy = 0, lyz = 0, lzx = 0, lzy = 0, lzz = 0;
  double gx = 0, gy = 0, gz = 0;
  double cxx = 0, cyy = 0, czz = 0, cxy = 0, cyz = 0, czx = 0;
#pragma omp simd reduction(+ : mxx, myy, mzz, mxy, myz, mzx, lxx, lxy, lxz, lyx, lyy, lyz, lzx, lzy, lzz, gx, gy, gz, \
                               cxx, cyy, czz, cxy, cyz, czx)
  for (std::size_t k = 0; k < batches * NeighbourList::row_multiple; ++k) {
    const Index j = row[k];
    const double dx = xi - x[j], dy = yi - y[j], dz = zi - z[j];
    const double w = volume[j] * kernel.slope_over_distance(dx * dx + dy * dy + dz * dz);
    const double wx = w * dx, wy = w * dy, wz = w * dz;
    const double ux = vx[j] - vxi, uy = vy[j] - vyi, uz = vz[j] - vzi;
    mxx -= wx * dx, myy -= wy * dy, mzz -= wz * dz;
    mxy -= wx * dy, myz -= wy * dz, mzx -= wz * dx;
    lxx += ux * wx, lxy += ux * wy, lxz += ux * wz;
    lyx += uy * wx, lyy += uy * wy, lyz += uy * wz;
    lzx += uz * wx, lzy += uz * wy, lzz += uz * wz;
    gx += wx, gy += wy, gz += wz;
    const double n = inverse_mass[j], nx = n * wx, ny = n * wy, nz = n * wz;
    cxx += nx * wx, cyy += ny * wy, czz += nz * wz;
    cxy += nx * wy, cyz += ny * wz, czx += nz * wx;
  }
  const std::array<double, gradient_rows> sums{mxx, myy, mzz, mxy, myz, mzx, lxx, lxy, lxz, lyx, lyy, lyz,
                                               lzx, lzy, lzz, gx,  gy,  gz,  cxx, cyy, czz, cxy, cyz, czx};
  for (std::size_t r = 0; r < gradient_rows; ++r) tile.row[r][slot] = sums[r];
}

template <class Real>
struct GradientSumsOf {
  SymmetricTensorOf<Real> moment;
  TensorOf<Real> velocity;
  std::array<Real, 3> gradient;
  SymmetricTensorOf<Real> mobility;
};

/// row: r -> value of row r.
template <class Real, class Row>
GradientSumsOf<Real> unpack(const Row& row) {
  return {{row(0), row(1), row(2), row(3), row(4), row(5)},
          {row(6), row(7), row(8), row(9), row(10), row(11), row(12), row(13), row(14)},
          {row(15), row(16), row(17)},
          {row(18), row(19), row(20), row(21), row(22), row(23)}};
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

/// V sigma B, the half of the pair force that a particle brings.
void store_stress_gradient(const SoilStateOf<Pack>& state, const SymmetricTensorOf<Pack>& correction,
                           const Pack& volume, std::size_t i, std::size_t count, Particles& p) {
  SymmetricTensorOf<Pack> force = state.deviator;
  force.xx -= state.pressure, force.yy -= state.pressure, force.zz -= state.pressure;
  const TensorOf<Pack> q = dot(volume * force, correction);
  const std::array<const Pack*, 9> component{&q.xx, &q.xy, &q.xz, &q.yx, &q.yy, &q.yz, &q.zx, &q.zy, &q.zz};
  for (std::size_t c = 0; c < 9; ++c) store_lanes(*component[c], p.stress_gradient[c], i, count);
}

/// |row i of L|^2 in mass-scaled velocities, 1/(kg m^2): what stable_step.h bounds frequencies with.
Pack row_mobility(const GradientSumsOf<Pack>& sums, const SymmetricTensorOf<Pack>& b,
                  const Pack& inverse_mass) {
  const TensorOf<Pack> bc = dot(b, sums.mobility);
  const Pack own = bc.xx * b.xx + bc.xy * b.xy + bc.xz * b.zx + bc.yx * b.xy + bc.yy * b.yy + bc.yz * b.yz +
                   bc.zx * b.zx + bc.zy * b.yz + bc.zz * b.zz;
  const auto& g = sums.gradient;
  const Pack x = b.xx * g[0] + b.xy * g[1] + b.zx * g[2], y = b.xy * g[0] + b.yy * g[1] + b.yz * g[2],
             z = b.zx * g[0] + b.yz * g[1] + b.zz * g[2];
  return own + inverse_mass * (x * x + y * y + z * z);
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
    of_lane[l] = &settings.laws[static_cast<std::size_t>(p.law[i + (l < count ? l : 0)])];
  const LawOfLanes law(of_lane);
  const SymmetricTensorOf<Pack> correction = correction_matrices(sums.moment);
  const TensorOf<Pack> velocity_gradient = dot(sums.velocity, correction);
  SoilStateOf<Pack> state = load_state<on>(p, i, count);
  Pack volume = load_lanes(p.volume, i, count);
  if (dt > 0) {
    const SoilWorkOf<Pack> work = update_soil_state<on>(law, strain_step_of(velocity_gradient, dt), state);
    const Pack before = volume;
    volume = load_lanes(p.reference_volume, i, count) * exp(-state.compression);
    const Pack middle_volume = 0.5 * (before + volume);
    total.work += only(middle_volume * work.total, count);
    total.plastic += only(middle_volume * work.dissipated, count);
    store_state<on>(state, i, count, p);
    total.valid = total.valid && stdx::all_of(is_valid(state));
  }
  store_lanes(volume, p.next_volume, i, count);
  store_lanes(sums.gradient[0], p.gradient_sum.x, i, count);
  store_lanes(sums.gradient[1], p.gradient_sum.y, i, count);
  store_lanes(sums.gradient[2], p.gradient_sum.z, i, count);
  store_stress_gradient(state, correction, volume, i, count, p);

  const Pack mass = load_lanes(p.mass, i, count);
  const Pack modulus = state.bulk_modulus * (1.0 + 4.0 / 3.0 * law.value(&SoilLaw::shear_ratio));
  const Pack wave_speed = stdx::sqrt(modulus * volume / mass);
  const Pack frequency =
      stdx::sqrt(modulus * volume * row_mobility(sums, correction, load_lanes(p.inverse_mass, i, count)));
  const SymmetricTensorOf<Pack> rate = symmetric_part(velocity_gradient);
  total.stable_step = stdx::min(
      total.stable_step,
      particle_stable_step(settings.step_limit, frequency, wave_speed, stdx::sqrt(double_dot(rate, rate))));
  if (settings.artificial_viscosity) {
    const Pack quadratic = stdx::sqrt(mass * volume);
    store_lanes(quadratic, p.viscous_quadratic, i, count);
    store_lanes(quadratic * stdx::sqrt(wave_speed), p.viscous_linear, i, count);
  }
}

/// The same for a tile of `size` particles from `first` on. Apart from the kernel's loop: there are many
/// combinations of effects, and no kernel in any.
using UpdateTile = void (*)(const LoopSettings& settings, const GradientTile& tile, double dt,
                            std::size_t first, std::size_t size, Particles& p, PackSums& total);
template <SoilEffects on>
void update_tile(const LoopSettings& settings, const GradientTile& tile, double dt, std::size_t first,
                 std::size_t size, Particles& p, PackSums& total) {
  for (std::size_t k = 0; k < size; k += lanes) {
    const std::size_t count = std::min(lanes, size - k);
    const auto sums = unpack<Pack>([&](std::size_t r) { return load_lanes(&tile.row[r][k], count); });
    update_particles<on>(settings, sums, dt, first + k, count, p, total);
  }
}

UpdateTile tile_update_of(const SoilEffects& effects) {
  UpdateTile update = nullptr;
  with_soil_effects(effects, [&](auto on) { update = update_tile<decltype(on)::value>; });
  return update;
}

template <class KernelType>
StressSums update_block(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                        double dt, std::size_t begin, std::size_t end, Particles& p) {
  const UpdateTile update = tile_update_of(settings.soil_effects);
  PackSums total;
  GradientTile tile;
  for (std::size_t first = begin; first < end; first += tile_size) {
    const std::size_t size = std::min(tile_size, end - first);
    for (std::size_t k = 0; k < size; ++k) sum_pair_gradients(kernel, list, p, first + k, tile, k);
    update(settings, tile, dt, first, size, p, total);
  }
  return {sum_lanes(total.work), sum_lanes(total.plastic), smallest_lane(total.stable_step), total.valid};
}

}  // namespace

GradientSums sum_gradients(const LoopSettings& settings, const NeighbourList& list,
                           const Particles& particles, std::size_t i) {
  GradientTile tile;
  with_kernel(settings.options,
              [&](const auto kernel) { sum_pair_gradients(kernel, list, particles, i, tile, 0); });
  const auto sums = unpack<double>([&](std::size_t r) { return tile.row[r][0]; });
  GradientSums result;
  const TensorOf<double>& v = sums.velocity;
  result.moment = sums.moment;
  result.velocity << v.xx, v.xy, v.xz, v.yx, v.yy, v.yz, v.zx, v.zy, v.zz;
  result.gradient = {sums.gradient[0], sums.gradient[1], sums.gradient[2]};
  result.mobility = sums.mobility;
  return result;
}

StressSums update_stress(const LoopSettings& settings, const NeighbourList& list, double dt,
                         Particles& particles, std::vector<StressSums>& blocks) {
  with_kernel(settings.options, [&](const auto kernel) {
    for_blocks(particles.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
      blocks[b] = update_block(kernel, settings, list, dt, begin, end, particles);
    });
  });
  StressSums sum;
  for (const StressSums& block : blocks) {
    sum.work += block.work;
    sum.plastic += block.plastic;
    sum.stable_step = std::min(sum.stable_step, block.stable_step);
    sum.valid = sum.valid && block.valid;
  }
  return sum;
}

}  // namespace tuft::sph
