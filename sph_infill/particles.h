#pragma once
/// State of all particles as structures of arrays. Index i is the same particle everywhere and for ever.
#include <array>
#include <vector>

#include "sph_infill/soil_law.h"

namespace tuft::sph {

struct Particles {
  // What a checkpoint holds.
  Vec3Array position;  ///< m, at t_k
  Vec3Array velocity;  ///< m/s, at t_k - dt/2
  std::vector<double> compression, largest_compression, plastic_compression;
  std::vector<double> pressure, bulk_modulus;   ///< Pa
  std::array<std::vector<double>, 6> deviator;  ///< Pa; xx yy zz xy yz zx
  std::vector<double> lost_strength;            ///< [0, 1]; empty without effect strength_softening

  // What never changes.
  std::vector<double> inverse_mass;                    ///< 1/kg
  std::vector<double> mass, reference_volume, radius;  ///< kg, m^3, m
  std::vector<Index> layer, material;
  std::vector<Index> law;  ///< index into the laws

  // What follows from the above in every step.
  std::vector<double> volume;  ///< m^3, by which gradients weigh neighbours: of the stress evaluation before
  std::vector<double> next_volume;  ///< m^3, of this stress evaluation
  Vec3Array next_velocity;          ///< m/s, at t_k + dt/2
  std::array<std::vector<double>, 9>
      stress_gradient;     ///< V sigma B by rows, N m: the half of the pair force a particle brings
  Vec3Array gradient_sum;  ///< sum_j V_j grad_i W_ij, 1/m
  /// Factors of the viscous pair force: sqrt(m V) sqrt(c) and sqrt(m V).
  std::vector<double> viscous_linear, viscous_quadratic;

  [[nodiscard]] std::size_t size() const { return mass.size(); }

  [[nodiscard]] SoilState soil_state(std::size_t i) const {
    return {compression[i],
            largest_compression[i],
            plastic_compression[i],
            pressure[i],
            bulk_modulus[i],
            {deviator[0][i], deviator[1][i], deviator[2][i], deviator[3][i], deviator[4][i], deviator[5][i]},
            lost_strength.empty() ? 0 : lost_strength[i]};
  }
  void set_soil_state(std::size_t i, const SoilState& s) {
    compression[i] = s.compression;
    largest_compression[i] = s.largest_compression;
    plastic_compression[i] = s.plastic_compression;
    pressure[i] = s.pressure;
    bulk_modulus[i] = s.bulk_modulus;
    const SymmetricTensor& d = s.deviator;
    deviator[0][i] = d.xx, deviator[1][i] = d.yy, deviator[2][i] = d.zz;
    deviator[3][i] = d.xy, deviator[4][i] = d.yz, deviator[5][i] = d.zx;
    if (!lost_strength.empty()) lost_strength[i] = s.lost_strength;
  }
};

}  // namespace tuft::sph
