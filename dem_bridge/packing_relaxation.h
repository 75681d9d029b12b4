#pragma once
/// Pushing spheres apart until they hardly overlap: geometry only, no forces, no time.
#include <array>
#include <functional>
#include <memory>
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

/// Sweeps that push spheres apart. Each shifts every sphere by a share of its overlaps with others (the
/// smaller sphere of a pair gives way more) and out of obstacles, then clamps it between the walls: so walls,
/// floor and lid are never crossed. Deterministic for any number of threads (every sphere gathers its own
/// shift). Holds references to what it is given.
class Relaxation {
 public:
  Relaxation(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles);
  ~Relaxation();
  Relaxation(const Relaxation&) = delete;
  Relaxation& operator=(const Relaxation&) = delete;

  /// in_slabs: every sphere stays in its slab, else floor and lid alone hold it. drop: m, by which spheres
  /// fall that hardly anything touches. `constrain` may move what the sweep has made of the positions: as
  /// groups that are rigid bodies do, which then hold spheres within walls and floor.
  void sweep(bool in_slabs, double drop = 0, const std::function<void(Vec3Array&)>& constrain = {});

  [[nodiscard]] double mean_radius() const { return mean_radius_; }
  /// m, by which a sphere reaches into obstacles: of a number of them, and anywhere.
  [[nodiscard]] double depth_in_obstacles(std::size_t i);
  [[nodiscard]] double depth_in_obstacles(const Vec3& x, double radius) const;
  /// Takes a sphere to another place.
  void move(std::size_t i, const Vec3& x);

 private:
  struct Neighbours;
  void renew_lists();

  LooseSpheres& spheres_;
  PackingBox box_;
  std::span<const ThinQuad> obstacles_;
  double mean_radius_ = 0, skin_ = 0;
  std::unique_ptr<Neighbours> near_;
  Vec3Array listed_, next_;
};

/// `sweeps` sweeps, in the first quarter of which spheres stay in their slabs.
void push_apart(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles, int sweeps,
                const std::function<void(Vec3Array&)>& constrain = {});

}  // namespace tuft::dem
