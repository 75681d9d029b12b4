#pragma once
/// One material point along a path of strain and stress: what `tuft point` computes, with the update that SPH
/// uses.
#include <vector>

#include "core/point_test.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

/// The point at one moment.
struct PathRow {
  double time = 0;          ///< s
  std::size_t segment = 0;  ///< from 1; 0 before the first
  SymmetricTensor strain;   ///< integral of D dt, extension positive
  SoilState state;
  double yield = 0;       ///< Pa, sqrt(J2) at which it yields here
  double work = 0;        ///< J per m^3 of the reference volume, sigma : D
  double dissipated = 0;  ///< J/m^3, of it
  double stored = 0;      ///< J/m^3, energy that the state can give back (stored_energy)

  /// Cauchy stress, tension positive, Pa.
  [[nodiscard]] SymmetricTensor stress() const {
    SymmetricTensor s = state.deviator;
    s.xx -= state.pressure, s.yy -= state.pressure, s.zz -= state.pressure;
    return s;
  }
  /// sqrt(3 J2), Pa: of triaxial stresses the difference of axial and lateral.
  [[nodiscard]] double q() const { return std::sqrt(1.5 * double_dot(state.deviator, state.deviator)); }
};

struct PathRecord {
  std::vector<PathRow> rows;  ///< the start, then at most PointTest::samples of each segment, its end among
                              ///< them; of a fresh one its own start before these
  std::size_t completed = 0;  ///< segments that came to their end
  std::size_t steps = 0;
  double work_size = 0;           ///< J/m^3, sum of the sizes of all works
  double largest_energy_gap = 0;  ///< J/m^3, largest |work - dissipated - (stored - stored at the start)|
};

/// The law of the tested material under the effects decided for it. Throws InputError naming the material's
/// file and what of it cannot be.
[[nodiscard]] SoilLaw law_of(const PointTest& test, const std::vector<EffectDecision>& effects);

/// Shear stress that the row's segment speaks of, Pa: zx of direct_shear, else xy.
[[nodiscard]] double shear_stress(const PointTest& test, const PathRow& row);

/// Runs the test's path. `record` holds what was reached also when it throws: RunError, naming the segment,
/// for a stress that is not met within the strain limit or lateral stresses that cannot be kept.
void run_strain_path(const SoilLaw& law, const PointTest& test, PathRecord& record);

}  // namespace tuft::sph
