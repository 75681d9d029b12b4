#pragma once
/// The page of a point test: strain and stress paths, the yield surface, energy.
#include <string>

#include "core/point_test.h"
#include "sph_infill/strain_path.h"

namespace tuft::app {

struct PointRun {
  PointTest test;
  sph::SoilLaw law;
  sph::PathRecord record;
  std::vector<EffectDecision> effects;
  std::string error;  ///< empty: completed
  double wall_seconds = 0;
};

/// One self-contained HTML page.
[[nodiscard]] std::string point_page(const PointRun& run);

/// Largest error of the energy balance over the sum of all works; meaningful where elastic shear keeps its
/// energy.
[[nodiscard]] double energy_gap(const PointRun& run);

}  // namespace tuft::app
