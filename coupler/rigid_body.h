#pragma once
/// Rigid bodies that rigs and the tray are made of. They translate; their shape is known by its signed
/// distance.
#include <limits>
#include <optional>
#include <string>
#include <variant>

#include "core/scene.h"
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

/// Everything farther than `radius` from the upright axis through the body's position: the inside of a ring.
struct Bore {
  double radius = 0;  ///< m
};

/// Cuboid with edges along the axes, about the body's position.
struct Block {
  Vec3 half{0, 0, 0};  ///< m, half its edges
};

/// Endless cylinder lying along y, about the axis through the body's position.
struct LyingCylinder {
  double radius = 0;  ///< m
};

/// Ball about the body's position.
struct Ball {
  double radius = 0;  ///< m
};

using Shape = std::variant<HalfSpace, Cylinder, Bore, Block, LyingCylinder, Ball>;

struct SurfacePoint {
  double distance = 0;   ///< m, negative inside
  Vec3 normal{0, 0, 1};  ///< unit, outwards
};

/// Signed distance of a point given relative to the body's position, and the outward normal there.
[[nodiscard]] SurfacePoint distance_to(const HalfSpace& shape, const Vec3& relative);
/// rim: m, radius that its lower edge is rounded by, within the cylinder; at most its radius and height.
[[nodiscard]] SurfacePoint distance_to(const Cylinder& shape, const Vec3& relative, double rim = 0);
[[nodiscard]] SurfacePoint distance_to(const Bore& shape, const Vec3& relative);
[[nodiscard]] SurfacePoint distance_to(const Block& shape, const Vec3& relative);
[[nodiscard]] SurfacePoint distance_to(const LyingCylinder& shape, const Vec3& relative);
[[nodiscard]] SurfacePoint distance_to(const Ball& shape, const Vec3& relative);

struct RigidBody {
  std::string name;
  Shape shape;
  Vec3 position{0, 0, 0};  ///< m, at t
  Vec3 velocity{0, 0, 0};  ///< m/s, half a step before (leapfrog, as core/infill.h)
  double mass = std::numeric_limits<double>::infinity();  ///< kg; infinite: fixed in space
  Vec3 freedom{0, 0, 0};                ///< 1 for directions in which it moves freely, 0 for held ones
  bool present = true;                  ///< false: takes no part (a missile not yet released)
  std::optional<FrictionLaw> friction;  ///< of points on it; empty: the points' own against bodies
  bool driven = false;                  ///< of infinite mass, moved at `drive` whatever resists
  Vec3 drive{0, 0, 0};                  ///< m/s
  Vec3 load{0, 0, 0};                   ///< N, on a body of finite mass, along its freedom
  double guide_damping = 0;             ///< N s/m, of its guides, >= 0
  bool is_carpet = false;  ///< its surface is the carpet's: points' own friction is that on fibres

  /// Nothing that contact does moves it.
  [[nodiscard]] bool is_fixed() const { return !(mass < std::numeric_limits<double>::infinity()); }
  [[nodiscard]] bool can_move() const { return driven || !is_fixed(); }
  /// Normals lie in the plane of the turf everywhere: a tray's wall, a ring.
  [[nodiscard]] bool is_upright_wall() const {
    const auto* plane = std::get_if<HalfSpace>(&shape);
    return plane != nullptr ? plane->normal.z() == 0 : std::holds_alternative<Bore>(shape);
  }
  [[nodiscard]] double inverse_mass() const { return is_fixed() ? 0.0 : 1.0 / mass; }
  /// Of its surface, seen from a point (m), where it will be in `ahead` (s). rim: m, rounds a cylinder's
  /// lower edge.
  [[nodiscard]] SurfacePoint surface_from(const Vec3& point, double ahead = 0, double rim = 0) const {
    const Vec3 relative = point - position - ahead * velocity;
    if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return distance_to(*cylinder, relative, rim);
    return std::visit([&](const auto& of) { return distance_to(of, relative); }, shape);
  }
};

/// A work of one window's kick, J: its part up to the moment of the force, and all of it.
struct BodyWork {
  double until_now = 0, whole = 0;
};

/// Work and momentum of one window of a moving body.
struct BodyAdvance {
  Vec3 impulse_taken{0, 0, 0};  ///< N s, contact impulse that changed its momentum or went into its guides
  double kinetic = 0;           ///< J, at the start of the window, when contact's forces are of
  BodyWork external;            ///< of what drives or loads it
  BodyWork damped;              ///< taken by its guides
};

/// What contact gives a body in a window, N s.
struct BodyPush {
  Vec3 whole{0, 0, 0};
  Vec3 until_now{0, 0, 0};  ///< its part before the moment of the forces, half of it but at irregular kicks
};

/// Kicks and drifts a body over one window under contact, its load and gravity (m/s^2). The guides' damping
/// acts on the mean of the velocities before and after.
BodyAdvance advance_body(RigidBody& body, const BodyPush& push, const Vec3& gravity, double window);

}  // namespace tuft::coupler
