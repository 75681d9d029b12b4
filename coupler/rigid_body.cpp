#include "coupler/rigid_body.h"

#include <algorithm>
#include <cmath>

namespace tuft::coupler {

SurfacePoint distance_to(const HalfSpace& shape, const Vec3& relative) {
  return {shape.normal.dot(relative), shape.normal};
}

SurfacePoint distance_to(const Cylinder& shape, const Vec3& relative, double rim) {
  const double across = std::hypot(relative.x(), relative.y());
  const Vec3 radial = across > 0 ? Vec3(relative.x() / across, relative.y() / across, 0) : Vec3(1, 0, 0);
  // From the cylinder that is smaller by the rim at side and foot; `above` alone is not.
  const double above = relative.z() - shape.height, foot = rim - relative.z();
  const double side = across - shape.radius + rim;
  if (above > foot) {
    const double beyond_side = across - shape.radius;
    if (above <= 0 || beyond_side <= 0)
      return above > beyond_side ? SurfacePoint{above, Vec3(0, 0, 1)} : SurfacePoint{beyond_side, radial};
    const double distance = std::hypot(beyond_side, above);
    return {distance, (beyond_side * radial + Vec3(0, 0, above)) / distance};
  }
  const Vec3 down(0, 0, -1);
  if (side <= 0 || foot <= 0)
    return foot >= side ? SurfacePoint{foot - rim, down} : SurfacePoint{side - rim, radial};
  const double distance = std::hypot(side, foot);
  return {distance - rim, (side * radial + foot * down) / distance};
}

SurfacePoint distance_to(const Bore& shape, const Vec3& relative) {
  const double across = std::hypot(relative.x(), relative.y());
  const Vec3 inwards = across > 0 ? Vec3(-relative.x() / across, -relative.y() / across, 0) : Vec3(1, 0, 0);
  return {shape.radius - across, inwards};
}

SurfacePoint distance_to(const Block& shape, const Vec3& relative) {
  const Vec3 beyond = relative.cwiseAbs() - shape.half;
  const Vec3 side(relative.x() < 0 ? -1 : 1, relative.y() < 0 ? -1 : 1, relative.z() < 0 ? -1 : 1);
  const Vec3 outside = beyond.cwiseMax(0.0);
  if (const double distance = outside.norm(); distance > 0)
    return {distance, outside.cwiseProduct(side) / distance};
  Eigen::Index axis = 0;
  const double depth = beyond.maxCoeff(&axis);
  Vec3 normal(0, 0, 0);
  normal[axis] = side[axis];
  return {depth, normal};
}

SurfacePoint distance_to(const LyingCylinder& shape, const Vec3& relative) {
  const double across = std::hypot(relative.x(), relative.z());
  const Vec3 radial = across > 0 ? Vec3(relative.x() / across, 0, relative.z() / across) : Vec3(0, 0, 1);
  return {across - shape.radius, radial};
}

SurfacePoint distance_to(const Ball& shape, const Vec3& relative) {
  const double distance = relative.norm();
  return {distance - shape.radius, distance > 0 ? Vec3(relative / distance) : Vec3(0, 0, 1)};
}

BodyAdvance advance_body(RigidBody& body, const BodyPush& contact, const Vec3& gravity, double window) {
  BodyAdvance result;
  const Vec3& impulse = contact.whole;
  const Vec3 before = body.velocity;
  if (body.is_fixed()) {
    result.impulse_taken = impulse;
    if (!body.driven) return result;
    body.velocity = body.drive;
    body.position += body.velocity * window;
    result.external = {-contact.until_now.dot(before), -0.5 * impulse.dot(before + body.velocity)};
    return result;
  }
  const Vec3 push = impulse / body.mass + gravity * window + body.load * (window / body.mass);
  const double resistance = 0.5 * body.guide_damping * window / body.mass;
  body.velocity += (push - 2 * resistance * before).cwiseProduct(body.freedom) / (1 + resistance);
  // The mean of before and after, and what the velocity then was off theirs: m (u + e/m)^2/2 with u the mean.
  const Vec3 early = (contact.until_now - 0.5 * impulse).cwiseProduct(body.freedom);
  result.kinetic = 0.25 * body.mass * (before.squaredNorm() + body.velocity.squaredNorm()) +
                   early.dot(0.5 * (before + body.velocity) + 0.5 * early / body.mass);
  body.position += body.velocity * window;
  const Vec3 load = body.load.cwiseProduct(body.freedom) * window;
  const Vec3 mean = 0.5 * (before + body.velocity).cwiseProduct(body.freedom);
  const Vec3 damping = -body.guide_damping * window * mean;  // N s
  result.external = {0.5 * load.dot(before), load.dot(mean)};
  result.damped = {-0.5 * damping.dot(before), -damping.dot(mean)};
  // What the guides hold back, and what the momentum really changed by: measured, so that the balance can
  // fail.
  const Vec3 held = Vec3::Ones() - body.freedom;
  result.impulse_taken = impulse.cwiseProduct(held) + body.mass * (body.velocity - before) -
                         (body.mass * window) * gravity.cwiseProduct(body.freedom) - load - damping;
  return result;
}

}  // namespace tuft::coupler
