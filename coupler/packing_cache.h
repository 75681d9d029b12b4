#pragma once
/// What packings of grains have in common, whatever holds the grains.
#include <filesystem>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "coupler/coming_to_rest.h"
#include "dem_bridge/dem_infill.h"
#include "fe_carpet/carpet.h"

namespace tuft::coupler {

struct Packing {
  dem::Grains grains;
  fe::CarpetShape carpet;  ///< as the grains have pushed the strands; of no nodes where strands stood still
  PackingReport report;
};

/// Settled packings kept by content: the scene's turf, grain materials, DEM options, seed, the effects that
/// matter to grains, a number that is raised with the way of packing, and `surroundings`: the fingerprint of
/// the mesh that grains lie among, or the container in words. Scenes are as packings are made
/// (packing_scene). Reading and writing never fail: without a cache a packing is made anew.
class PackingCache {
 public:
  PackingCache(const Scene& scene, const std::vector<EffectDecision>& effects, std::string_view surroundings);
  [[nodiscard]] bool load(Packing& packing) const;  ///< false: not there, not readable or not whole
  void store(const Packing& packing) const;

 private:
  std::filesystem::path path_;  ///< empty: no cache
};

/// Of all that a mesh holds, bit for bit.
[[nodiscard]] std::string fingerprint(const fe::ShellMesh& mesh);

[[nodiscard]] Vec3Array positions(const Infill& infill);

}  // namespace tuft::coupler
