#pragma once
/// Which grains are spheres of one clump, and how each clump lies: what the driver knows of rigid bodies, and
/// what it tells the host of them.
#include <cstdint>
#include <vector>

#include "dem_bridge/clump_shape.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::dem {

struct GrainBody {
  std::size_t first = 0, count = 0;  ///< its spheres are the grains from first on
  Index material = 0;                ///< index into Scene::materials
  double diameter = 0;               ///< m, of the sphere of equal volume
  double mass = 0;                   ///< kg
  Vec3 centre{0, 0, 0};              ///< m, of mass
  Mat3 axes = Mat3::Identity();      ///< columns: principal axes
};

struct GrainBodies {
  std::vector<ClumpBody> shapes;  ///< by material; of no sphere where it has no clump
  std::vector<GrainBody> bodies;

  [[nodiscard]] bool empty() const { return bodies.empty(); }
  [[nodiscard]] const ClumpBody& shape_of(const GrainBody& body) const {
    return shapes[static_cast<std::size_t>(body.material)];
  }
  /// kg m^2
  [[nodiscard]] Vec3 inertia_of(const GrainBody& body) const {
    return body.mass * body.diameter * body.diameter * shape_of(body).inertia;
  }
};

/// Shapes of all materials with a clump. Throws InputError as make_clump_body does.
[[nodiscard]] std::vector<ClumpBody> clump_shapes(const std::vector<Material>& materials);

/// Size, place and axes of every body from where its spheres are. Throws InputError where spheres of one body
/// do not follow each other, are not as many or not placed (to 1e-6 of the diameter) as their material's
/// clump has them.
[[nodiscard]] GrainBodies find_bodies(const Grains& grains, const std::vector<Material>& materials);

/// The file of the host's folder that protocol.h describes.
[[nodiscard]] std::vector<std::uint8_t> bodies_file(const GrainBodies& bodies, const Grains& grains);

}  // namespace tuft::dem
