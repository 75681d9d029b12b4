#include "dem_bridge/packing_consolidation.h"

#include <algorithm>
#include <vector>

namespace tuft::dem {
namespace {

constexpr int spreading = 100, in_slabs = 50;  ///< sweeps; a random cloud is even after some tens
constexpr int rounds = 6, after_a_round = 40;  ///< of moving what sticks; sweeps
/// Of its radius: a sphere that reaches deeper into obstacles sticks between them.
constexpr double stuck = 0.05;
/// Of the mean radius, by which free spheres fall in a sweep. Overlaps of the bed grow with it: with 0.05
/// twice as large in the mean as with 0.03.
constexpr double drop_share = 0.03;
/// The bed is down when it sinks by less than this share of what free spheres would.
constexpr double slow = 0.05;
constexpr int looked_at_every = 20, most_falls = 3000, at_last = 300;  ///< sweeps

/// A place in the sphere's slab that obstacles leave free; where it was if chance finds none.
Vec3 free_place(const Relaxation& relaxation, const LooseSpheres& spheres, std::size_t i,
                const PackingBox& box, const std::function<double()>& uniform) {
  constexpr int trials = 50;
  const double radius = spheres.radius[i];
  for (int trial = 0; trial < trials; ++trial) {
    // One after the other: the order in which a call's arguments are evaluated is not fixed.
    const double u = 2 * uniform() - 1, v = 2 * uniform() - 1, w = uniform();
    const double low = spheres.low[i] + radius, high = std::max(low, spheres.high[i] - radius);
    const Vec3 x(u * (box.half_size[0] - radius), v * (box.half_size[1] - radius), low + w * (high - low));
    if (box.round && x.head<2>().norm() > box.half_size[0] - radius) continue;
    if (relaxation.depth_in_obstacles(x, radius) <= stuck * radius) return x;
  }
  return spheres.position[i];
}

std::size_t move_what_sticks(Relaxation& relaxation, const LooseSpheres& spheres, const PackingBox& box,
                             const std::function<double()>& uniform) {
  std::vector<std::size_t> sticking;
  for (std::size_t i = 0; i < spheres.radius.size(); ++i)
    if (relaxation.depth_in_obstacles(i) > stuck * spheres.radius[i]) sticking.push_back(i);
  std::size_t moved = 0;
  for (const std::size_t i : sticking) {
    const Vec3 place = free_place(relaxation, spheres, i, box, uniform);
    if (place == spheres.position[i]) continue;
    relaxation.move(i, place);
    ++moved;
  }
  return moved;
}

double mean_height(const LooseSpheres& spheres) {
  double sum = 0;
  for (const double z : spheres.position.z) sum += z;
  return sum / static_cast<double>(spheres.radius.size());
}

void let_fall(Relaxation& relaxation, const LooseSpheres& spheres) {
  const double drop = drop_share * relaxation.mean_radius();
  double before = mean_height(spheres);
  for (int sweep = 1; sweep <= most_falls; ++sweep) {
    relaxation.sweep(false, drop);
    if (sweep % looked_at_every != 0) continue;
    const double now = mean_height(spheres);
    if (before - now < slow * drop * looked_at_every) return;
    before = now;
  }
}

}  // namespace

std::size_t consolidate(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles,
                        const std::function<double()>& uniform) {
  if (spheres.radius.empty()) return 0;
  Relaxation relaxation(spheres, box, obstacles);
  for (int sweep = 0; sweep < spreading; ++sweep) relaxation.sweep(sweep < in_slabs);
  std::size_t moved = 0;
  for (int round = 0; round < rounds; ++round) {
    const std::size_t now = move_what_sticks(relaxation, spheres, box, uniform);
    if (now == 0) break;
    moved += now;
    for (int sweep = 0; sweep < after_a_round; ++sweep) relaxation.sweep(false);
  }
  let_fall(relaxation, spheres);
  for (int sweep = 0; sweep < at_last; ++sweep) relaxation.sweep(false);
  return moved;
}

}  // namespace tuft::dem
