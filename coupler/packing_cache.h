#pragma once
/// What packings of grains have in common, whatever holds the grains.
#include <cstdint>
#include <filesystem>
#include <functional>
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
  /// False: not there, or damaged, or refused by `check`, which throws RunError for a packing that does not
  /// fit. Then `packing` is as it was, but for report.cache_trouble, which says what was wrong with the file.
  [[nodiscard]] bool load(Packing& packing, const std::function<void(const Packing&)>& check) const;
  void store(const Packing& packing) const;

 private:
  [[nodiscard]] Packing read() const;

  std::filesystem::path path_;             ///< empty: no cache
  std::vector<std::uint8_t> grain_kinds_;  ///< by material: it is one of grains
  std::size_t layers_;
};

/// Of all that a mesh holds, bit for bit.
[[nodiscard]] std::string fingerprint(const fe::ShellMesh& mesh);

/// A scene as its packings are made: of numerics nothing counts but seed and step_safety, which the cache
/// tells apart. A packing is a means to get grains at rest, damped and at several g: its energy balance is
/// not a result. Non-finite values and lost grains still stop it.
[[nodiscard]] Scene packing_scene(const Scene& scene);

[[nodiscard]] Vec3Array positions(const Infill& infill);

}  // namespace tuft::coupler
