#pragma once
/// Rigid bodies that rigs and the tray are made of. They translate; their shape is known by its signed
/// distance.
#include <limits>
#include <string>
#include <variant>

#include "core/vector.h"

namespace tuft::coupler {

/// Everything behind the plane through the body's position: outside where normal . (p - position) > 0.
struct HalfSpace {
  Vec3 normal{0, 0, 1};  ///< unit, pointing out of the body
};

/// Upright solid cylinder; the body's position is the centre of its lower face.
struct Cylinder {
  double radius = 0;  ///< m
  double height = 0;  ///< m
};

using Shape = std::variant<HalfSpace, Cylinder>;

struct SurfacePoint {
  double distance = 0;   ///< m, negative inside
  Vec3 normal{0, 0, 1};  ///< unit, outwards
};

/// Signed distance of a point given relative to the body's position, and the outward normal there.
[[nodiscard]] SurfacePoint distance_to(const HalfSpace& shape, const Vec3& relative);
[[nodiscard]] SurfacePoint distance_to(const Cylinder& shape, const Vec3& relative);

struct RigidBody {
  std::string name;
  Shape shape;
  Vec3 position{0, 0, 0};  ///< m, at t
  Vec3 velocity{0, 0, 0};  ///< m/s, half a step before (leapfrog, as core/infill.h)
  double mass = std::numeric_limits<double>::infinity();  ///< kg; infinite: fixed in space
  Vec3 freedom{0, 0, 0};  ///< 1 for directions in which it moves freely, 0 for held ones
  bool present = true;    ///< false: takes no part (a missile not yet released)

  [[nodiscard]] bool is_fixed() const { return !(mass < std::numeric_limits<double>::infinity()); }
  [[nodiscard]] double inverse_mass() const { return is_fixed() ? 0.0 : 1.0 / mass; }
};

/// Work and momentum of one window of a moving body.
struct BodyAdvance {
  Vec3 impulse_taken{0, 0, 0};  ///< N s, contact impulse that changed its momentum or went into its guides
  double kinetic = 0;           ///< J, centred at the start of the window
};

/// Kicks and drifts a body over one window under a contact impulse (N s) and gravity (m/s^2).
BodyAdvance advance_body(RigidBody& body, const Vec3& impulse, const Vec3& gravity, double window);

}  // namespace tuft::coupler
