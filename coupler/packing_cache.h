#pragma once
/// What packings of grains have in common, whatever holds the grains: the cache, and coming to rest.
#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "coupler/simulation.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::coupler {

/// Settled packings kept by content: the scene's turf, grain materials, DEM options, seed, the effects that
/// matter to grains, the program's version, and `container`, in words, where it is not the turf's tray.
/// Reading and writing never fail: without a cache a packing is made anew.
class PackingCache {
 public:
  PackingCache(const Scene& scene, const std::vector<EffectDecision>& effects, std::string_view container);
  [[nodiscard]] bool load(dem::Grains& grains) const;  ///< false: not there, or not readable
  void store(const dem::Grains& grains) const;

 private:
  std::filesystem::path path_;  ///< empty: no cache
};

/// Lets grains come to rest in three stages, shares of `settle_time` (s; 1.5 : 6 : 3, PHYSICS section 8):
/// strong drag; 5 g with light drag; 1 g. `report` gets the share done.
void come_to_rest(Simulation& simulation, double settle_time, const std::function<void(double)>& report);

[[nodiscard]] Vec3Array positions(const Infill& infill);

}  // namespace tuft::coupler
