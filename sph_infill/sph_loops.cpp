#include "sph_infill/sph_loops.h"

#include "core/parallel.h"
#include "sph_infill/gradient_correction.h"
#include "sph_infill/kernel.h"

namespace tuft::sph {
namespace {

/// Calls work(block, begin, end) for each block of particles, on all threads.
template <class Work>
void for_blocks(std::size_t count, Work&& work) {
  const std::size_t blocks = (count + block_size - 1) / block_size;
  parallel_for(blocks,
               [&](std::size_t b) { work(b, b * block_size, std::min(count, (b + 1) * block_size)); });
}

/// Calls body(kernel) with the chosen kernel as a value of its own type.
template <class Body>
auto with_kernel(const SphOptions& options, Body&& body) {
  if (options.kernel == Kernel::cubic_spline) return body(CubicSpline(options.smoothing_length));
  return body(WendlandC2(options.smoothing_length));
}

template <class KernelType>
GradientSums gradient_sums(const KernelType kernel, const NeighbourList& list, const Particles& p,
                           std::size_t i) {
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
  GradientSums sums;
  sums.moment = {mxx, myy, mzz, mxy, myz, mzx};
  sums.velocity << lxx, lxy, lxz, lyx, lyy, lyz, lzx, lzy, lzz;
  sums.gradient = {gx, gy, gz};
  sums.mobility = {cxx, cyy, czz, cxy, cyz, czx};
  return sums;
}

bool is_valid(const SoilState& state) {
  static const double low = std::log(smallest_density_ratio), high = std::log(largest_density_ratio);
  // Written so that NaN fails; the sum of squares is not finite if any component is not.
  return state.compression > low && state.compression < high &&
         std::isfinite(state.pressure + double_dot(state.deviator, state.deviator));
}

void store_stress_gradient(const SoilState& state, const SymmetricTensor& correction, double volume,
                           std::size_t i, Particles& p) {
  Mat3 stress = to_matrix(state.deviator);
  stress.diagonal().array() -= state.pressure;
  const Mat3 q = volume * (stress * to_matrix(correction));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      p.stress_gradient[static_cast<std::size_t>(3 * row + column)][i] = q(row, column);
}

/// |row i of L|^2 in mass-scaled velocities, 1/(kg m^2): what stable_step.h bounds frequencies with.
double row_mobility(const GradientSums& sums, const SymmetricTensor& correction, double inverse_mass) {
  const Mat3 b = to_matrix(correction);
  return (b * to_matrix(sums.mobility) * b).trace() + inverse_mass * (b * sums.gradient).squaredNorm();
}

/// The pass behind the pair loop, for one particle.
void update_particle_stress(const LoopSettings& settings, const GradientSums& sums, double dt, std::size_t i,
                            Particles& p, StressSums& total) {
  const SoilLaw& law = settings.laws[static_cast<std::size_t>(p.law[i])];
  const SymmetricTensor correction = correction_matrix(sums.moment);
  const Mat3 velocity_gradient = sums.velocity * to_matrix(correction);
  SoilState state = p.soil_state(i);
  double volume = p.volume[i];
  if (dt > 0) {
    const SoilWork work = update_soil(law, strain_step(velocity_gradient, dt), state);
    volume = p.reference_volume[i] * std::exp(-state.compression);
    const double middle_volume = 0.5 * (p.volume[i] + volume);
    total.work += middle_volume * work.total;
    total.plastic += middle_volume * work.dissipated;
    p.set_soil_state(i, state);
    total.valid = total.valid && is_valid(state);
  }
  p.next_volume[i] = volume;
  p.gradient_sum.set(i, sums.gradient);
  store_stress_gradient(state, correction, volume, i, p);

  const double modulus = state.bulk_modulus * (1 + 4.0 / 3.0 * law.shear_ratio);
  const double wave_speed = std::sqrt(modulus * volume / p.mass[i]);
  const double frequency = std::sqrt(modulus * volume * row_mobility(sums, correction, p.inverse_mass[i]));
  const SymmetricTensor rate = symmetric_part(velocity_gradient);
  total.stable_step = std::min(
      total.stable_step,
      particle_stable_step(settings.step_limit, frequency, wave_speed, std::sqrt(double_dot(rate, rate))));
  if (settings.artificial_viscosity) {
    p.viscous_quadratic[i] = std::sqrt(p.mass[i] * volume);
    p.viscous_linear[i] = p.viscous_quadratic[i] * std::sqrt(wave_speed);
  }
}

struct PairForces {
  Vec3 stress;   ///< sum_j Q_j g_ij; the force is V_i times it, plus Q_i sum_j V_j g_ij
  Vec3 viscous;  ///< N
};

/// Viscosity (Monaghan 1992): pressure-like (-alpha c mu + beta mu^2)/rho on approaching pairs, mu = h
/// u.d/(d^2 + 0.01 h^2). Means of rho and c of a pair are geometric, so that the pair's factor is a product
/// of one number of each.
template <bool viscous, class KernelType>
PairForces pair_forces(const KernelType kernel, const SphOptions& options, const NeighbourList& list,
                       const Particles& p, std::size_t i) {
  const double *x = p.position.x.data(), *y = p.position.y.data(), *z = p.position.z.data();
  const double *vx = p.velocity.x.data(), *vy = p.velocity.y.data(), *vz = p.velocity.z.data();
  const double *linear = p.viscous_linear.data(), *quadratic = p.viscous_quadratic.data();
  const auto& q = p.stress_gradient;
  const double *qxx = q[0].data(), *qxy = q[1].data(), *qxz = q[2].data(), *qyx = q[3].data(),
               *qyy = q[4].data(), *qyz = q[5].data(), *qzx = q[6].data(), *qzy = q[7].data(),
               *qzz = q[8].data();
  const double xi = x[i], yi = y[i], zi = z[i], h = options.smoothing_length, floor = 0.01 * h * h;
  const double vxi = viscous ? vx[i] : 0, vyi = viscous ? vy[i] : 0, vzi = viscous ? vz[i] : 0;
  const double linear_i = viscous ? options.viscosity_linear * linear[i] : 0;
  const double quadratic_i = viscous ? options.viscosity_quadratic * quadratic[i] : 0;
  const Index* row = list.row(i).data();
  const std::size_t batches = list.row(i).size() / NeighbourList::row_multiple;

  double fx = 0, fy = 0, fz = 0, ax = 0, ay = 0, az = 0;
#pragma omp simd reduction(+ : fx, fy, fz, ax, ay, az)
  for (std::size_t k = 0; k < batches * NeighbourList::row_multiple; ++k) {
    const Index j = row[k];
    const double dx = xi - x[j], dy = yi - y[j], dz = zi - z[j];
    const double distance_squared = dx * dx + dy * dy + dz * dz;
    const double slope = kernel.slope_over_distance(distance_squared);
    const double gx = slope * dx, gy = slope * dy, gz = slope * dz;
    fx += qxx[j] * gx + qxy[j] * gy + qxz[j] * gz;
    fy += qyx[j] * gx + qyy[j] * gy + qyz[j] * gz;
    fz += qzx[j] * gx + qzy[j] * gy + qzz[j] * gz;
    if constexpr (viscous) {
      const double approach = -((vxi - vx[j]) * dx + (vyi - vy[j]) * dy + (vzi - vz[j]) * dz);
      const double mu = h * std::max(0.0, approach) / (distance_squared + floor);
      const double a = mu * (linear_i * linear[j] + quadratic_i * quadratic[j] * mu);
      ax -= a * gx, ay -= a * gy, az -= a * gz;
    }
  }
  return {{fx, fy, fz}, {ax, ay, az}};
}

template <bool viscous, class KernelType>
void kick_particle(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                   const Kick& kick, std::size_t i, Particles& p, KickSums& total) {
  const PairForces pairs = pair_forces<viscous>(kernel, settings.options, list, p, i);
  Mat3 own;
  own << p.stress_gradient[0][i], p.stress_gradient[1][i], p.stress_gradient[2][i], p.stress_gradient[3][i],
      p.stress_gradient[4][i], p.stress_gradient[5][i], p.stress_gradient[6][i], p.stress_gradient[7][i],
      p.stress_gradient[8][i];
  const Vec3 force = own * p.gradient_sum[i] + p.volume[i] * pairs.stress + pairs.viscous;
  const double mass = p.mass[i], t = kick.duration();

  const Vec3 impulse = kick.impulse ? Vec3(kick.impulse_share * (*kick.impulse)[i]) : Vec3(0, 0, 0);
  const Vec3 contact_change = impulse / mass;
  const Vec3 before = p.velocity[i];
  // Damping by the mean of the velocities before and after: unconditionally stable, and its work is exact.
  const double half_damping = 0.5 * kick.damping * t;
  const Vec3 after =
      ((1 - half_damping) * before + t * (force / mass + kick.gravity) + contact_change) / (1 + half_damping);
  p.next_velocity.set(i, after);

  const Vec3 mean = 0.5 * (before + after);
  const double share_before =
      kick.step_before / t;  // of the change of velocity, for a step dt_before as long
  const auto work = [&](const Vec3& given) {
    return KickWork{0.5 * share_before * given.dot(before), given.dot(mean)};
  };
  total.kinetic += 0.5 * mass * before.dot(before + share_before * (after - before));
  total.gravity_potential -= mass * kick.gravity.dot(p.position[i]);
  if constexpr (viscous) total.viscous += work(-t * pairs.viscous);
  total.damping += work(kick.damping * t * mass * mean);
  total.contact += work(impulse);
  total.impulse += mass * contact_change;
  total.impulse_scale += (mass * contact_change).cwiseAbs();
}

}  // namespace

GradientSums sum_gradients(const LoopSettings& settings, const NeighbourList& list,
                           const Particles& particles, std::size_t i) {
  return with_kernel(settings.options,
                     [&](const auto kernel) { return gradient_sums(kernel, list, particles, i); });
}

StressSums update_stress(const LoopSettings& settings, const NeighbourList& list, double dt,
                         Particles& particles, std::vector<StressSums>& blocks) {
  with_kernel(settings.options, [&](const auto kernel) {
    for_blocks(particles.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
      StressSums total;
      for (std::size_t i = begin; i < end; ++i)
        update_particle_stress(settings, gradient_sums(kernel, list, particles, i), dt, i, particles, total);
      blocks[b] = total;
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

KickSums& KickSums::operator+=(const KickSums& other) {
  kinetic += other.kinetic;
  gravity_potential += other.gravity_potential;
  viscous += other.viscous;
  damping += other.damping;
  contact += other.contact;
  impulse += other.impulse;
  impulse_scale += other.impulse_scale;
  return *this;
}

KickSums kick(const LoopSettings& settings, const NeighbourList& list, const Kick& kick, Particles& particles,
              std::vector<KickSums>& blocks) {
  const auto pass = [&]<bool viscous>(const auto kernel) {
    for_blocks(particles.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
      KickSums total;
      for (std::size_t i = begin; i < end; ++i)
        kick_particle<viscous>(kernel, settings, list, kick, i, particles, total);
      blocks[b] = total;
    });
  };
  with_kernel(settings.options, [&](const auto kernel) {
    if (settings.artificial_viscosity)
      pass.template operator()<true>(kernel);
    else
      pass.template operator()<false>(kernel);
  });
  KickSums sum;
  for (const KickSums& block : blocks) sum += block;
  return sum;
}

DriftCheck drift(double dt, const Vec3Array& reference, Particles& p, std::vector<DriftCheck>& blocks) {
  std::swap(p.velocity, p.next_velocity);
  std::swap(p.volume, p.next_volume);
  for_blocks(p.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
    double largest = 0, finite = 0;
#pragma omp simd reduction(max : largest) reduction(+ : finite)
    for (std::size_t i = begin; i < end; ++i) {
      p.position.x[i] += dt * p.velocity.x[i];
      p.position.y[i] += dt * p.velocity.y[i];
      p.position.z[i] += dt * p.velocity.z[i];
      const double dx = p.position.x[i] - reference.x[i], dy = p.position.y[i] - reference.y[i],
                   dz = p.position.z[i] - reference.z[i];
      const double displacement = dx * dx + dy * dy + dz * dz;
      largest = std::max(largest, displacement);
      finite += 0 * displacement;  // 0 unless a position, and so a velocity, is not finite
    }
    blocks[b] = {largest, finite == 0};
  });
  DriftCheck check;
  for (const DriftCheck& block : blocks) {
    check.largest_displacement_squared =
        std::max(check.largest_displacement_squared, block.largest_displacement_squared);
    check.valid = check.valid && block.valid;
  }
  return check;
}

}  // namespace tuft::sph
