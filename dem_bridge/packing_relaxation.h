#pragma once
/// Pushing spheres apart until they hardly overlap: geometry only, no forces, no time.
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "dem_bridge/dem_infill.h"

namespace tuft::dem {

struct PackingBox {
  std::array<double, 2> half_size{};  ///< m, walls at +-half_size in x and y
  double floor = 0, lid = 0;          ///< m
  bool round = false;                 ///< a cylinder of radius half_size[0] in place of the four walls
};

/// Spheres with the slab [low, high] (m) each is kept in at first.
struct LooseSpheres {
  Vec3Array position;
  std::vector<double> radius, low, high;
  /// Spheres of one number do not push each other. Empty: all do.
  std::vector<Index> group = {};
};

/// Moves the spheres in `sweeps` sweeps. Each sweep shifts every sphere by a share of its overlaps with
/// others (the smaller sphere of a pair gives way more) and out of obstacles, then clamps it between the
/// walls: so walls, floor and lid are never crossed. During the first quarter of the sweeps spheres stay in
/// their slab, then only floor and lid hold them. Deterministic for any number of threads (every sphere
/// gathers its own shift). `constrain` may move what a sweep has made of the positions: as groups that are
/// rigid bodies do, which then hold spheres within walls and floor.
void push_apart(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles, int sweeps,
                const std::function<void(Vec3Array&)>& constrain = {});

}  // namespace tuft::dem
