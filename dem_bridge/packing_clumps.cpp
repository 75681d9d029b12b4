#include "dem_bridge/packing_clumps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem_bridge/clump_bodies.h"

namespace tuft::dem {
namespace {

using Turn = Eigen::Quaterniond;

/// Even over all turns (Shoemake 1992, Graphics Gems III, p. 124).
Turn random_turn(const std::function<double()>& uniform) {
  // One after the other: the order in which a call's arguments are evaluated is not fixed.
  const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
  const double s = std::sqrt(1 - u), c = std::sqrt(u);
  return {c * std::cos(b), s * std::sin(a), s * std::cos(a), c * std::sin(b)};
}

/// A grain that is pushed as a rigid body; a sphere is one of a single sphere.
struct LooseBody {
  std::size_t first = 0, count = 0;  // its spheres
  const ClumpBody* shape = nullptr;
  double diameter = 0;
  Vec3 centre{0, 0, 0};
  Turn turn = Turn::Identity();

  [[nodiscard]] Vec3 place(std::size_t k) const { return centre + diameter * (turn * shape->centre[k]); }
};

/// Walks with its spheres: by their mean shift, weighed by mass, and turned as a free body would be by the
/// moments of these shifts.
void follow(LooseBody& body, const Vec3Array& wanted) {
  Vec3 shift(0, 0, 0), moment(0, 0, 0);
  for (std::size_t k = 0; k < body.count; ++k) {
    const Vec3 here = body.place(k), step = body.shape->share[k] * (wanted[body.first + k] - here);
    shift += step;
    moment += (here - body.centre).cross(step);
  }
  body.centre += shift;
  if (body.count == 1) return;
  const Vec3 inertia = body.diameter * body.diameter * body.shape->inertia;
  const Vec3 angle = body.turn * (body.turn.conjugate() * moment).cwiseQuotient(inertia);
  const double size = angle.norm();
  if (size > 0) body.turn = (Turn(Eigen::AngleAxisd(size, angle / size)) * body.turn).normalized();
}

/// Back inside walls and above the floor, by a shift of the whole body.
void keep_inside(LooseBody& body, const PackingBox& box) {
  double lowest = 0;
  Vec3 low(0, 0, 0), high(0, 0, 0);
  for (std::size_t k = 0; k < body.count; ++k) {
    const Vec3 x = body.place(k);
    const double radius = body.diameter * body.shape->radius[k];
    lowest = std::max(lowest, box.floor + radius - x.z());
    if (box.round) continue;
    for (int c = 0; c < 2; ++c) {
      const double limit = box.half_size[static_cast<std::size_t>(c)] - radius;
      low[c] = std::max(low[c], -limit - x[c]);
      high[c] = std::max(high[c], x[c] - limit);
    }
  }
  body.centre += low - high;
  body.centre.z() += lowest;
  if (!box.round) return;
  // Each push is of the sphere that is farthest out; a few bring all in, a shift to the axis at the latest.
  for (int push = 0; push < 8; ++push) {
    Vec3 out(0, 0, 0);
    for (std::size_t k = 0; k < body.count; ++k) {
      Vec3 across = body.place(k);
      across.z() = 0;
      const double from_axis = across.norm(),
                   beyond = from_axis + body.diameter * body.shape->radius[k] - box.half_size[0];
      if (beyond > out.norm() && from_axis > 0) out = beyond / from_axis * across;
    }
    body.centre -= out;
  }
}

}  // namespace

Grains make_clumps(const Grains& grains, const std::vector<Material>& materials, const PackingBox& box,
                   std::span<const ThinQuad> obstacles, int sweeps, const std::function<double()>& uniform) {
  const std::vector<ClumpBody> shapes = clump_shapes(materials);
  Grains result;
  result.moved = grains.moved;
  const ClumpBody one_sphere = make_clump_body({ClumpShape::spheres, 0, {ClumpSphere{}}}, "spheres");
  std::vector<LooseBody> bodies;
  LooseSpheres members;
  Index clumps = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const ClumpBody& of_material = shapes[static_cast<std::size_t>(grains.material[i])];
    LooseBody body;
    body.first = result.size();
    body.shape = of_material.size() > 0 ? &of_material : &one_sphere;
    body.count = body.shape->size();
    body.diameter = 2 * grains.radius[i];
    body.centre = grains.position[i];
    if (of_material.size() > 0) body.turn = random_turn(uniform);
    for (std::size_t k = 0; k < body.count; ++k) {
      const double radius = of_material.size() > 0 ? body.diameter * body.shape->radius[k] : grains.radius[i];
      members.position.push_back(body.place(k));
      members.radius.push_back(radius);
      members.low.push_back(box.floor);  // layers have their order by now
      members.high.push_back(box.lid);
      members.group.push_back(static_cast<Index>(i));
      result.radius.push_back(radius);
      result.density.push_back(grains.density[i]);
      result.layer.push_back(grains.layer[i]);
      result.material.push_back(grains.material[i]);
      result.body.push_back(of_material.size() > 0 ? clumps : -1);
    }
    if (of_material.size() > 0) ++clumps;
    bodies.push_back(body);
  }
  push_apart(members, box, obstacles, sweeps, [&](Vec3Array& next) {
    for (LooseBody& body : bodies) {
      follow(body, next);
      keep_inside(body, box);
      for (std::size_t k = 0; k < body.count; ++k) next.set(body.first + k, body.place(k));
    }
  });
  result.position = std::move(members.position);
  return result;
}

}  // namespace tuft::dem
