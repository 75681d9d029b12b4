#include "coupler/rigid_body.h"

#include <algorithm>
#include <cmath>

namespace tuft::coupler {

SurfacePoint distance_to(const HalfSpace& shape, const Vec3& relative) {
  return {shape.normal.dot(relative), shape.normal};
}

SurfacePoint distance_to(const Cylinder& shape, const Vec3& relative) {
  const double across = std::hypot(relative.x(), relative.y());
  const Vec3 radial = across > 0 ? Vec3(relative.x() / across, relative.y() / across, 0) : Vec3(1, 0, 0);
  const double beyond_side = across - shape.radius;
  const double below = -relative.z(), above = relative.z() - shape.height;
  const double beyond_end = std::max(below, above);
  const Vec3 axial(0, 0, below >= above ? -1.0 : 1.0);
  if (beyond_side <= 0 && beyond_end <= 0) {
    if (beyond_side > beyond_end) return {beyond_side, radial};
    return {beyond_end, axial};
  }
  if (beyond_side <= 0) return {beyond_end, axial};
  if (beyond_end <= 0) return {beyond_side, radial};
  const double distance = std::hypot(beyond_side, beyond_end);
  return {distance, (beyond_side * radial + beyond_end * axial) / distance};
}

BodyAdvance advance_body(RigidBody& body, const Vec3& impulse, const Vec3& gravity, double window) {
  BodyAdvance result;
  if (body.is_fixed()) {
    result.impulse_taken = impulse;
    return result;
  }
  const Vec3 before = body.velocity;
  body.velocity += (impulse / body.mass + gravity * window).cwiseProduct(body.freedom);
  result.kinetic = 0.25 * body.mass * (before.squaredNorm() + body.velocity.squaredNorm());
  body.position += body.velocity * window;
  // What the guides hold back, and what the momentum really changed by: measured, so that the balance can
  // fail.
  const Vec3 held = Vec3::Ones() - body.freedom;
  result.impulse_taken = impulse.cwiseProduct(held) + body.mass * (body.velocity - before) -
                         (body.mass * window) * gravity.cwiseProduct(body.freedom);
  return result;
}

}  // namespace tuft::coupler
