#pragma once
/// How dense particles have come to lie, over how they were placed.
#include <vector>

#include "sph_infill/sph_infill.h"

namespace tuft::sph {

/// Density of each particle where it lies over its density where it was placed. Density is the kernel's sum
/// rho_i = sum_j m_j W(|x_i - x_j|), i itself included, and the same sum on the lattice, where the density is known, is
/// what it is measured by: at a wall, at the surface or between layers both sums lack or mix in the same, so the ratio
/// is that of the densities there too, to first order in the change.
class CompactionMeasure {
 public:
  CompactionMeasure(const Lattice& lattice, std::vector<double> mass, const SphOptions& options);

  /// One value a particle, > 0; 1 on the lattice itself.
  [[nodiscard]] std::vector<double> ratio(const Vec3Array& position) const;

 private:
  [[nodiscard]] std::vector<double> sums(const Vec3Array& position) const;

  std::vector<double> mass_;  ///< kg
  SphOptions options_;
  double pitch_ = 0;             ///< m
  std::vector<double> placed_;  ///< kg/m^3, sums on the lattice
};

}  // namespace tuft::sph
