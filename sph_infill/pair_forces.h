#pragma once
/// What neighbours exert on particles: the pair loop of the kick.
#include <array>

#include "sph_infill/particle_packs.h"

namespace tuft::sph {

struct PairForces {
  std::array<Pack, 3> stress{}, viscous{};  ///< N
};

/// The control of zero-energy modes (sph_loops.h), pair by pair.
class ResidualForces {
 public:
  ResidualForces(const Particles& p, const Index* own)
      : records_(p.residual.data()), own_(load_records(records_, own)) {}

  /// u: v_j - v_i. g: slope (x_i - x_j). Slopes may lack a factor, which the force lacks then.
  void add(const Index* index, const Pack& slope, const Pack& volume, const std::array<Pack, 3>& u,
           const std::array<Pack, 3>& g) {
    const auto q = load_records(records_, index);
    const Pack own_weight = volume * slope, weight = q[9] * slope;
    for (std::size_t d = 0; d < 3; ++d) {
      motion_[d] += own_weight * u[d];
      neighbours_[d] += weight * u[d] + (q[3 * d] * g[0] + q[3 * d + 1] * g[1] + q[3 * d + 2] * g[2]);
    }
  }
  /// gradient: sum_j V_j g_ij.
  [[nodiscard]] Pack force(std::size_t d, const Pack& volume, const std::array<Pack, 3>& gradient) const {
    return -(own_[9] * motion_[d] + own_[3 * d] * gradient[0] + own_[3 * d + 1] * gradient[1] +
             own_[3 * d + 2] * gradient[2] + volume * neighbours_[d]);
  }

 private:
  const ResidualRecord* records_;
  std::array<Pack, ResidualRecord::values> own_;
  std::array<Pack, 3> motion_{}, neighbours_{};
};

/// The forces that a scene's effects call for; those that are not cost nothing.
template <bool viscosity, bool zero_energy_control>
struct Forces {
  static constexpr bool viscous = viscosity, controlled = zero_energy_control,
                        dissipative = viscous || controlled;
};

/// sum_j Q_j g_ij of the particles of a group. Pairs are taken one by one, a tensor's columns as they lie in
/// memory: sorting nine values into lanes takes longer than multiplying them.
class StressSum {
 public:
  explicit StressSum(const StressRecord* records) : records_(records) {}

  /// `slope[k]`: x, y and z of g_ij of entry k, a particle a lane.
  using Slope = std::array<std::array<double, lanes>, 3>;
  void add(const Index* index, const Slope* slope, std::size_t count) {
    std::array<Four, lanes> sum = sum_;
    for (std::size_t k = 0; k < count; ++k, index += lanes)
#pragma GCC unroll 8
      for (std::size_t l = 0; l < lanes; ++l)
        sum[l] += product(index[l], slope[k][0][l], slope[k][1][l], slope[k][2][l]);
    sum_ = sum;
  }
  /// Q_i sum_j V_j g_ij + V_i sum_j Q_j g_ij. gradient: sum_j V_j g_ij.
  [[nodiscard]] std::array<Pack, 3> force(const std::array<Index, lanes>& own, const Pack& volume,
                                          const std::array<Pack, 3>& gradient) const {
    std::array<Four, lanes> total;
    for (std::size_t l = 0; l < lanes; ++l)
      total[l] =
          product(own[l], gradient[0][l], gradient[1][l], gradient[2][l]) + sum_[l] * double(volume[l]);
    const auto component = [&](std::size_t d) { return Pack([&](auto l) { return total[l][d]; }); };
    return {component(0), component(1), component(2)};
  }

 private:
  [[nodiscard]] Four product(Index i, double x, double y, double z) const {
    const auto& column = records_[static_cast<std::size_t>(i)].v_sigma_b;
    return load_four_in_double(column[0].data()) * x + load_four_in_double(column[1].data()) * y +
           load_four_in_double(column[2].data()) * z;
  }

  const StressRecord* records_;
  std::array<Four, lanes> sum_{};
};

/// Viscosity (Monaghan 1992): pressure-like (-alpha c mu + beta mu^2)/rho on approaching pairs, mu = h
/// u.d/(d^2 + 0.01 h^2). Means of rho and c of a pair are geometric, so that the pair's factor is a product
/// of one number of each.
template <class Chosen, class KernelType>
PairForces sum_pair_forces(const KernelType kernel, const SphOptions& options, const NeighbourList& list,
                           const Particles& p, std::size_t group) {
  const auto own_index = indices_of_group(group, p.size());
  const auto [xi, yi, zi, vxi, vyi, vzi, volume_i, inverse_mass_i] =
      load_records(p.motion.data(), own_index.data());
  const auto [linear_i, quadratic_i, wave_speed_i, unused_i] =
      load_viscous(p.stress.data(), own_index.data());
  const double h = options.smoothing_length, floor = 0.01 * h * h;
  const Pack own_linear = options.viscosity_linear * h * linear_i,
             own_quadratic = options.viscosity_quadratic * h * h * quadratic_i;
  StressSum stress(p.stress.data());
  std::array<Pack, 3> gradient{};  // sum_j V_j g_ij
  PairForces force;
  [[maybe_unused]] auto residual = [&] {
    if constexpr (Chosen::controlled)
      return ResidualForces(p, own_index.data());
    else
      return 0;
  }();
  alignas(stdx::memory_alignment_v<Pack>) std::array<StressSum::Slope, row_chunk> slopes;
  for_chunks(list.group(group), [&](const Index* first, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      const Index* index = first + k * lanes;
      const auto [x, y, z, vx, vy, vz, volume, inverse_mass] = load_records(p.motion.data(), index);
      const Pack dx = xi - x, dy = yi - y, dz = zi - z, distance_squared = dx * dx + dy * dy + dz * dz;
      const Pack slope = kernel.slope_shape(distance_squared);
      const Pack gx = slope * dx, gy = slope * dy, gz = slope * dz;
      store(slopes[k][0].data(), gx), store(slopes[k][1].data(), gy), store(slopes[k][2].data(), gz);
      gradient[0] += volume * gx, gradient[1] += volume * gy, gradient[2] += volume * gz;
      const Pack ux = vx - vxi, uy = vy - vyi, uz = vz - vzi;
      if constexpr (Chosen::viscous) {
        const auto [linear, quadratic, wave_speed, unused] = load_viscous(p.stress.data(), index);
        const Pack approach = ux * dx + uy * dy + uz * dz;
        const Pack mu = stdx::max(Pack(0.0), approach) / (distance_squared + floor);
        const Pack a = mu * (own_linear * linear + own_quadratic * quadratic * mu);
        force.viscous[0] -= a * gx, force.viscous[1] -= a * gy, force.viscous[2] -= a * gz;
      }
      if constexpr (Chosen::controlled) residual.add(index, slope, volume, {ux, uy, uz}, {gx, gy, gz});
    }
    stress.add(first, slopes.data(), count);
  });
  force.stress = stress.force(own_index, volume_i, gradient);
  for (std::size_t d = 0; d < 3; ++d) {
    if constexpr (Chosen::controlled) force.viscous[d] += residual.force(d, volume_i, gradient);
    force.stress[d] *= kernel.slope_factor(), force.viscous[d] *= kernel.slope_factor();
  }
  return force;
}

}  // namespace tuft::sph
