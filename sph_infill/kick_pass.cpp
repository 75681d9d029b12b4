/// Pass 2 of a step: forces and the kick that they give; and the drift after it.
#include <array>

#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

// Rows of a tile: sum_j Q_j g_ij (3), to be multiplied by V_i, and the viscous force, N (3).
constexpr std::size_t force_rows = 6;
using ForceTile = Tile<force_rows>;

/// Viscosity (Monaghan 1992): pressure-like (-alpha c mu + beta mu^2)/rho on approaching pairs, mu = h
/// u.d/(d^2 + 0.01 h^2). Means of rho and c of a pair are geometric, so that the pair's factor is a product
/// of one number of each.
template <bool viscous, class KernelType>
void sum_pair_forces(const KernelType kernel, const SphOptions& options, const NeighbourList& list,
                     const Particles& p, std::size_t i, ForceTile& tile, std::size_t slot) {
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
  const std::array<double, force_rows> sums{fx, fy, fz, ax, ay, az};
  for (std::size_t r = 0; r < force_rows; ++r) tile.row[r][slot] = sums[r];
}

/// KickSums of a block, lane by lane.
struct PackSums {
  struct Work {
    Pack until_now = 0, whole = 0;
  };
  Pack kinetic = 0, gravity_potential = 0;
  Work viscous, damping, contact;
  std::array<Pack, 3> impulse{}, impulse_scale{};

  [[nodiscard]] KickSums sum() const {
    const auto work = [](const Work& w) { return KickWork{sum_lanes(w.until_now), sum_lanes(w.whole)}; };
    const auto vector = [](const std::array<Pack, 3>& v) {
      return Vec3(sum_lanes(v[0]), sum_lanes(v[1]), sum_lanes(v[2]));
    };
    return {sum_lanes(kinetic), sum_lanes(gravity_potential), work(viscous), work(damping), work(contact),
            vector(impulse),    vector(impulse_scale)};
  }
};

const std::vector<double>& axis_of(const Vec3Array& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
std::vector<double>& axis_of(Vec3Array& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// One component of the kick of `count` particles from i on.
template <bool viscous>
void kick_component(const Kick& kick, const ForceTile& tile, std::size_t slot, std::size_t axis,
                    std::size_t i, std::size_t count, Particles& p, PackSums& total) {
  const auto of = [&](const std::vector<double>& values) { return load_lanes(values, i, count); };
  const Pack mass = of(p.mass), before = of(axis_of(p.velocity, axis));
  const Pack own = of(p.stress_gradient[3 * axis]) * of(p.gradient_sum.x) +
                   of(p.stress_gradient[3 * axis + 1]) * of(p.gradient_sum.y) +
                   of(p.stress_gradient[3 * axis + 2]) * of(p.gradient_sum.z);
  const Pack viscous_force = viscous ? load_lanes(&tile.row[3 + axis][slot], count) : Pack(0.0);
  const Pack force = own + of(p.volume) * load_lanes(&tile.row[axis][slot], count) + viscous_force;

  const double t = kick.duration(), gravity = kick.gravity[static_cast<Eigen::Index>(axis)];
  const Pack impulse = kick.impulse ? kick.impulse_share * of(axis_of(*kick.impulse, axis)) : Pack(0.0);
  const Pack contact_change = impulse / mass;
  // Damping by the mean of the velocities before and after: unconditionally stable, and its work is exact.
  const double half_damping = 0.5 * kick.damping * t;
  const Pack after =
      ((1 - half_damping) * before + t * (force / mass + gravity) + contact_change) / (1 + half_damping);
  store_lanes(after, axis_of(p.next_velocity, axis), i, count);

  const Pack mean = 0.5 * (before + after);
  // Of the change of velocity, for a step dt_before as long.
  const double share_before = kick.step_before / t;
  const auto add_work = [&](PackSums::Work& work, const Pack& given) {
    work.until_now += only(0.5 * share_before * given * before, count);
    work.whole += only(given * mean, count);
  };
  total.kinetic += only(0.5 * mass * before * (before + share_before * (after - before)), count);
  total.gravity_potential -= only(mass * gravity * of(axis_of(p.position, axis)), count);
  if constexpr (viscous) add_work(total.viscous, -t * viscous_force);
  add_work(total.damping, kick.damping * t * mass * mean);
  add_work(total.contact, impulse);
  const Pack received = only(mass * contact_change, count);
  total.impulse[axis] += received;
  total.impulse_scale[axis] += stdx::abs(received);
}

template <bool viscous, class KernelType>
KickSums kick_block(const KernelType kernel, const LoopSettings& settings, const NeighbourList& list,
                    const Kick& kick, std::size_t begin, std::size_t end, Particles& p) {
  PackSums total;
  ForceTile tile;
  for (std::size_t first = begin; first < end; first += tile_size) {
    const std::size_t size = std::min(tile_size, end - first);
    for (std::size_t k = 0; k < size; ++k)
      sum_pair_forces<viscous>(kernel, settings.options, list, p, first + k, tile, k);
    for (std::size_t k = 0; k < size; k += lanes)
      for (std::size_t axis = 0; axis < 3; ++axis)
        kick_component<viscous>(kick, tile, k, axis, first + k, std::min(lanes, size - k), p, total);
  }
  return total.sum();
}

}  // namespace

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
      blocks[b] = kick_block<viscous>(kernel, settings, list, kick, begin, end, particles);
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
