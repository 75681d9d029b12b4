#include "coupler/roller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::coupler {
namespace {

constexpr double beside = 0.002;  // m between patch and roller before and after a pass

RigidBody driven_body(std::string name, const Shape& shape, const Vec3& position) {
  RigidBody body;
  body.name = std::move(name);
  body.shape = shape;
  body.position = position;
  body.driven = true;
  body.friction = FrictionLaw{0, 0, 0};
  return body;
}

}  // namespace

Roller::Roller(const Scene& scene)
    : Roller(scene, scene.turf.carpet.backing_thickness + scene.infill_depth()) {}

Roller::Roller(const Scene& scene, double surface)
    : shape_(scene.conditioning.roller), surface_(surface), depth_(scene.conditioning.depth) {
  const double reach = 0.5 * shape_.diameter + (shape_.studs_around > 0 ? shape_.stud_length : 0);
  half_way_ = 0.5 * scene.turf.size[0] + reach + beside;
  if (shape_.studs_around == 0) return;
  const int rings = std::max(1, static_cast<int>(scene.turf.size[1] / shape_.stud_spacing));
  const double pitch = 2 * std::numbers::pi / shape_.studs_around;
  for (int ring = 0; ring < rings; ++ring)
    for (int stud = 0; stud < shape_.studs_around; ++stud)
      studs_.push_back({pitch * (stud + 0.5 * (ring % 2)), shape_.stud_spacing * (ring - 0.5 * (rings - 1))});
}

std::vector<RigidBody> Roller::bodies() const {
  std::vector<RigidBody> bodies{driven_body("roller", LyingCylinder{0.5 * shape_.diameter}, place(0, 0, 0))};
  for (std::size_t k = 1; k < size(); ++k)
    bodies.push_back(
        driven_body(fmt::format("stud_{}", k), Ball{0.5 * shape_.stud_diameter}, place(k, 0, 0)));
  return bodies;
}

Vec3 Roller::place(std::size_t k, int pass, double share) const {
  const double sign = pass % 2 == 0 ? 1 : -1, radius = 0.5 * shape_.diameter;
  const double x = sign * half_way_ * (2 * share - 1);
  const double z = surface_ - depth_ * (pass + 1) / shape_.passes + radius;
  if (k == 0) return {x, 0, z};
  const Stud& stud = studs_[k - 1];
  const double arm = radius + shape_.stud_length - 0.5 * shape_.stud_diameter;
  const double angle = stud.angle - x / radius;  // the lowest point stands still
  return {x + arm * std::sin(angle), stud.y, z - arm * std::cos(angle)};
}

double Roller::pass_time() const {
  return 2 * half_way_ / shape_.speed;
}

}  // namespace tuft::coupler
