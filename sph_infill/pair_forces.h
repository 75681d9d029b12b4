#pragma once
/// What neighbours exert on particles: the pair loop of the kick.
#include <array>

#include "sph_infill/particle_packs.h"

namespace tuft::sph {

/// Forces on the particles of a group, N, as packs after each other.
struct GroupForces {
  using Components = std::array<std::array<Pack, packs_of_single>, 3>;
  Components whole, viscous;  ///< whole: with what is viscous
};

/// The forces that a scene's effects call for; those that are not cost nothing.
template <bool viscosity, bool zero_energy_control>
struct Forces {
  static constexpr bool viscous = viscosity, controlled = zero_energy_control,
                        dissipative = viscous || controlled;
};

/// (a + b) . x of tensors that are the first nine values, by rows.
template <std::size_t count>
[[nodiscard]] inline SingleVector sum_dot(const std::array<SinglePack, count>& a,
                                          const std::array<SinglePack, count>& b, const SingleVector& x) {
  const auto row = [&](std::size_t k) {
    return (a[k] + b[k]) * x[0] + (a[k + 1] + b[k + 1]) * x[1] + (a[k + 2] + b[k + 2]) * x[2];
  };
  return {row(0), row(3), row(6)};
}
[[nodiscard]] inline SingleVector operator*(const SinglePack& a, const SingleVector& x) {
  return {a * x[0], a * x[1], a * x[2]};
}
[[nodiscard]] inline SingleVector operator+(const SingleVector& a, const SingleVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// What a pair's forces have of dissipation:
///
/// Viscosity (Monaghan 1992): pressure-like (-alpha c mu + beta mu^2)/rho on approaching pairs, mu = h
/// u.d/(d^2 + 0.01 h^2). Means of rho and c of a pair are geometric, so that the pair's factor is a product
/// of one number of each. Those numbers hold alpha, beta and the unit of positions too, in which mu is taken.
///
/// The control of zero-energy modes: see sph_loops.h.
template <class Chosen>
class Dissipation {
 public:
  using Stress = std::array<SinglePack, StressRecord::values>;
  using Residual = std::array<SinglePack, ResidualRecord::values>;

  Dissipation(const Particles& p, const RecordPlaces& own) : residual_(p.residual) {
    if constexpr (Chosen::controlled) own_residual_ = own.load(residual_);
  }

  /// slope: V_i V_j times that of the kernel. g: slope times d.
  [[nodiscard]] SingleVector of_pair(const PairMotion& pair, const Stress& i, const Stress& j,
                                     const RecordPlaces& places, const SinglePack& slope,
                                     const SingleVector& g) const {
    SingleVector force{};
    if constexpr (Chosen::viscous) {
      const SinglePack approach = pair.u[0] * pair.d[0] + pair.u[1] * pair.d[1] + pair.u[2] * pair.d[2];
      const SinglePack mu = stdx::max(SinglePack(0), approach) / (pair.q_squared + 0.01F);
      force = -(mu * (i[9] * j[9] + (i[10] * j[10]) * mu)) * g;
    }
    if constexpr (Chosen::controlled) {
      const Residual other = places.load(residual_);
      const SinglePack weight = (own_residual_[9] + other[9]) * slope;
      force = force + SinglePack(-1) * (weight * pair.u + sum_dot(own_residual_, other, g));
    }
    return force;
  }

 private:
  const std::vector<ResidualRecord>& residual_;
  Residual own_residual_;
};

/// f_ij = V_i V_j (S_i + S_j) g_ij (sph_loops.h), and what is dissipative. Every product and sum of a pair
/// is such that exchanging i and j changes signs alone: forces of a pair are opposite and equal to the last
/// bit, whichever rows find them. They are added in double precision, so that momentum is kept to the
/// rounding of that.
template <class Chosen, class KernelType>
GroupForces sum_pair_forces(const KernelType kernel, const NeighbourList& list, const Particles& p,
                            std::size_t group) {
  const RecordPlaces here(entries_of_group(group, p.size()).data());
  const auto own = here.load(p.motion);
  const auto own_stress = here.load(p.stress);
  const Dissipation<Chosen> dissipation(p, here);
  GroupForces::Components whole{};
  SingleVector viscous{};
  const NeighbourList::GroupRows rows = list.group(group);
  for (std::size_t k = 0; k < rows.length; ++k) {
    const RecordPlaces places(rows.first + k * group_size);
    const auto other = places.load(p.motion);
    const PairMotion pair(own, other);
    const SinglePack slope = (own[3] * other[3]) * kernel.slope_shape(pair.q_squared);
    const SingleVector g = slope * pair.d;
    const auto stress = places.load(p.stress);
    SingleVector force = sum_dot(own_stress, stress, g);
    if constexpr (Chosen::dissipative) {
      const SingleVector taken = dissipation.of_pair(pair, own_stress, stress, places, slope, g);
      viscous = viscous + taken;
      force = force + taken;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const auto wide = widened(force[c]);
      for (std::size_t part = 0; part < packs_of_single; ++part) whole[c][part] += wide[part];
    }
  }
  const double factor = kernel.slope_factor() * p.position_unit() * p.volume_unit() * p.volume_unit();
  GroupForces forces;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto wide = widened(viscous[c]);
    for (std::size_t part = 0; part < packs_of_single; ++part) {
      forces.whole[c][part] = factor * whole[c][part];
      forces.viscous[c][part] = factor * wide[part];
    }
  }
  return forces;
}

}  // namespace tuft::sph
