#pragma once
/// A stiff elastic material (50 MPa) and a soft one.
#include <vector>

#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph::test {

inline constexpr double soft_density = 600;  ///< kg/m^3

/// soft_modulus: Pa, bulk. With 1 MPa stable steps differ four and a half times, with a quarter of it nine.
inline std::vector<Material> stiff_and_soft(double soft_modulus = 1e6) {
  std::vector<Material> both = single_material(elastic_material(50e6, 1500));
  both.push_back(single_material(elastic_material(soft_modulus, soft_density)).front());
  return both;
}

/// `stiff` rows under `soft` ones, `width` particles square.
inline Lattice stiff_under_soft(int width, int stiff, int soft, double pitch) {
  Turf turf;
  turf.layers = {{0, stiff * pitch}, {1, soft * pitch}};
  return make_lattice(turf, {{width * pitch, width * pitch}, 0}, pitch);
}

}  // namespace tuft::sph::test
