#pragma once
/// Grains are laid densely among strands that give way to them, as brushing and tamping leave them.
#include <functional>
#include <vector>

#include "core/scene.h"
#include "dem_bridge/dem_infill.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

/// A bed as laid, and the strands as it has pushed them.
struct LaidBed {
  Vec3Array position;      ///< m, of the grains
  fe::CarpetShape carpet;  ///< of no nodes where the scene has no carpet
  double time = 0;         ///< s of dynamics that it took
  bool lies = false;       ///< false: the time was up before the bed hardly sank
};

/// Lets grains fall at several g under drag until their bed hardly sinks. They have the share
/// infill.dem.packing_friction of their friction, on each other, strands, tray and floor, and neither plastic
/// springs nor cohesion; their moduli among each other are a tenth, for longer steps. `report` gets the share
/// of infill.dem.settle_time_limit that is done. `scene`: as packings are made (settled_packing.cpp).
[[nodiscard]] LaidBed lay(const Scene& scene, const std::vector<EffectDecision>& effects,
                          const dem::Grains& grains, const std::function<void(double)>& report);

}  // namespace tuft::coupler
