#pragma once
/// Grains that are rigid bodies of several spheres, by LIGGGHTS' `fix multisphere`, which integrates them and
/// keeps their state. The bridge makes them, adds its loads to the whole body, and lets whole bodies leave.
/// One rank only: there LIGGGHTS' arrays stay in our order, and the spheres of a body follow each other.
#include <cstddef>
#include <memory>
#include <vector>

#include "core/vector.h"
#include "dem_bridge/host/body_kick.h"

namespace LAMMPS_NS {
class LAMMPS;
class FixMultisphere;
}  // namespace LAMMPS_NS

namespace tuft::dem {

/// LIGGGHTS' id of the fix.
inline constexpr const char* clumps_fix = "clumps";

class Clumps {
 public:
  /// After the commands and before the first set-up. Without that fix there are no clumps. Bodies that a
  /// restart file has brought are taken as they are; else the file of protocol.h says which there are. Throws
  /// std::runtime_error where it cannot be read or spheres are not where they should be.
  explicit Clumps(LAMMPS_NS::LAMMPS& lammps);
  ~Clumps();
  Clumps(const Clumps&) = delete;
  Clumps& operator=(const Clumps&) = delete;

  [[nodiscard]] bool empty() const { return bodies_.empty(); }
  /// Its spheres are LIGGGHTS' atoms from `first` on.
  struct Body {
    int first, count, place;  ///< place: in LIGGGHTS' list of bodies
  };
  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  /// The body of an atom, or -1.
  [[nodiscard]] int of_atom(int atom) const {
    return empty() ? -1 : of_atom_[static_cast<std::size_t>(atom)];
  }
  /// Of the mass, of a sphere; 1 for a grain of its own.
  [[nodiscard]] double share(int atom) const;

  [[nodiscard]] Vec3 centre(const Body& body) const;
  /// kg; every atom of it has the same in LIGGGHTS' rmass, which contacts go by.
  [[nodiscard]] double mass(const Body& body) const;
  /// With what LIGGGHTS' atoms feel as pair force and torque.
  [[nodiscard]] BodyState state(const Body& body) const;
  void set_motion(const Body& body, const Vec3& velocity, const Vec3& angular_momentum);
  void set_velocity_and_spin(const Body& body, const Vec3& velocity, const Vec3& spin);
  /// All forces and torques of the half kick that opens LIGGGHTS' next step.
  void set_forces(const Body& body, const Vec3& force, const Vec3& torque);
  /// What LIGGGHTS adds to the sum over the spheres in the closing half kick, until it is set anew.
  void set_added(const Body& body, const Vec3& force, const Vec3& torque);
  /// No forces and nothing added on any body.
  void clear_forces();
  /// Velocities of all spheres from those of the bodies.
  void move_spheres();
  /// After a change of LIGGGHTS' step.
  void take_step();
  /// Puts a body to rest in a point of no size.
  void park(const Body& body, const Vec3& place);

 private:
  void make_bodies();
  void list_bodies();

  struct Fields;  // LIGGGHTS' containers, whose contents it may move
  std::unique_ptr<Fields> fields_;
  LAMMPS_NS::LAMMPS* lammps_;
  LAMMPS_NS::FixMultisphere* fix_ = nullptr;
  std::vector<Body> bodies_;
  std::vector<int> of_atom_;
};

}  // namespace tuft::dem
