#pragma once
/// The carpet: fibres and backing as 4-node shells, explicit central differences.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/hdf5_file.h"
#include "core/scene.h"
#include "core/vector.h"
#include "fe_carpet/mass_scaling.h"

namespace tuft::fe {

/// Shell mesh. Quads index nodes, counter-clockwise seen from the side of the shell normal.
struct ShellMesh {
  Vec3Array nodes;  ///< m
  std::vector<std::array<Index, 4>> quads;
  std::vector<double> thickness;  ///< m, per quad
  std::vector<Index> material;    ///< per quad, index into the materials given with the mesh
  /// Per quad: contact surface it belongs to. 0 is the backing, 1..n the strands. A particle touches each
  /// surface at its nearest point only. Each free strand is a surface of its own; the whole part of a tape is
  /// one.
  std::vector<Index> surface;
  std::vector<std::uint8_t> clamped;  ///< per node: all six degrees of freedom fixed
  /// Per node, or empty for none: bits 0 to 2 hold the translations along x, y and z, bits 3 to 5 the
  /// rotations about them (symmetry planes, hinges).
  std::vector<std::uint8_t> constraints;
  Index surface_count = 0;  ///< backing included: surfaces are 0 .. surface_count - 1

  static constexpr Index backing_surface = 0;
};

/// Generates the carpet of a patch centred on the origin, backing mid-surface at z = backing thickness / 2
/// (its lower face on the tray's floor z = 0), strands rising in +z. Strands, or the tape they are split
/// from, share their root nodes with the backing. The backing's edge nodes are clamped. The same seed gives
/// the same mesh. `with_fibres` false: the backing alone. Material 0 is the backing, 1 the fibre. Throws
/// InputError when the patch holds no tuft or a length is unusable.
[[nodiscard]] ShellMesh generate_carpet(const CarpetDesign& design, std::array<double, 2> size,
                                        std::uint64_t seed, bool with_fibres);

/// Throws InputError naming the element on zero-length sides, coincident nodes, indices out of range.
void check_mesh(const ShellMesh& mesh);

struct CarpetOptions {
  double damping = 0;                       ///< 1/s, mass-proportional
  Vec3 gravity{0, 0, -9.81};                ///< m/s^2
  ShellSection section;                     ///< of all materials but those in
  std::vector<ShellSection> sections = {};  ///< per material of the mesh, or empty
  /// [0, 1), share of the carpet's mass that may be added to the elements that bound the step; 0: off. Weight
  /// stays the true one.
  double mass_scaling_limit = 0;
  /// Materials whose elements bear 2.5 times the smallest step or more are evaluated at a multiple of it
  /// (subcycling.h).
  bool subcycle = false;
};

/// Energies, J, as of the last force evaluation with kinetic energy centred there (see core/infill.h).
struct CarpetEnergy {
  double kinetic = 0;            ///< translation and rotation
  double strain = 0;             ///< work of the shell stresses
  double hourglass = 0;          ///< work of hourglass resistance and of the drilling penalty
  double gravity_potential = 0;  ///< relative to z = 0
  double damping = 0;            ///< dissipated by mass-proportional damping
  double eroded = 0;             ///< had gone into elements until they failed
  double external_work = 0;      ///< work of the loads given to step()

  /// What must stay constant, J: all that is stored, moving or lost, less what was put in.
  [[nodiscard]] double balance() const {
    return kinetic + strain + hourglass + gravity_potential + damping + eroded - external_work;
  }
  bool operator==(const CarpetEnergy&) const = default;
};

/// Where a carpet stands and how it is stressed, without motion: what strands keep of the way infill was laid
/// among them. Strains on the way to failure are not kept: they count from there on.
struct CarpetShape {
  Vec3Array position;                 ///< m, one per node of the mesh
  std::vector<double> element_state;  ///< thickness and stresses, element by element
  double strain = 0, hourglass = 0;   ///< J, that went into the elements
};

/// Nodes: positions at t, translational velocity half a step before.
struct NodeView {
  std::span<const double> x, y, z, vx, vy, vz;
  std::span<const double> mass;  ///< kg, translational, what mass scaling has added included
  std::span<const std::uint8_t> clamped;
};

class Carpet {
 public:
  /// materials[i] is the material with index i of the mesh. A mesh with neither nodes nor elements stands for
  /// no carpet (infill alone). Throws InputError on an unusable mesh.
  Carpet(ShellMesh mesh, std::vector<ShellMaterial> materials, const CarpetOptions& options);
  ~Carpet();
  Carpet(const Carpet&) = delete;
  Carpet& operator=(const Carpet&) = delete;

  [[nodiscard]] const ShellMesh& mesh() const;  ///< as built (reference positions)
  [[nodiscard]] NodeView nodes() const;
  /// Largest stable step of the shells alone, s, without safety factor.
  [[nodiscard]] double stable_step() const;
  /// The same of each material's elements alone; infinite for a material without elements.
  [[nodiscard]] std::vector<double> stable_steps_of_materials() const;
  /// Steps that the slow materials' elements bear in one now; 1 without subcycling.
  [[nodiscard]] int subcycle_ratio() const;
  /// Evaluates slow elements every `steps`-th step from now on; as built: subcycle_ratio(). They are
  /// evaluated in the last of their steps, and energy() holds as of such a step only. May be changed after
  /// such a step only, else std::logic_error; ignored without slow elements when it is 1, else
  /// std::logic_error.
  void set_subcycle(int steps);
  [[nodiscard]] int subcycle() const;
  /// What mass scaling added to the carpet as built and the step it gained; all zero when it is off.
  [[nodiscard]] const MassScaling& mass_scaling() const;
  /// Membrane stiffness of each node's surroundings, N/m: m / dt_crit^2 with the element's own critical step,
  /// the material bound below which a contact spring on the node cannot govern the step. One value a
  /// node. Mass scaling leaves it as it is: contact must not stiffen because mass was added.
  [[nodiscard]] std::span<const double> node_contact_stiffness() const;
  [[nodiscard]] double last_step() const;  ///< s, length of the last step; 0 before the first
  /// One central-difference step. `force` (N, one per node) acts over the step; clamped nodes do not move and
  /// the reaction to their load is not reported. Throws RunError naming element or node on non-finite values.
  void step(double dt, const Vec3Array& force);
  /// With moments too, N m, one per node.
  void step(double dt, const Vec3Array& force, const Vec3Array& moment);
  void set_damping(double rate);  ///< 1/s
  [[nodiscard]] CarpetEnergy energy() const;
  [[nodiscard]] double kinetic_energy() const;  ///< J, energy().kinetic after the first step; cheap
  /// Takes all velocities away and books their energy as damping: the kinetic energy at the last force
  /// evaluation and what loads, gravity and inner forces have done since. The last loads count for the whole
  /// step to the present positions, at their power in the last evaluation. The ledger is closed, before the
  /// next step and after it.
  void stop();
  /// Per element: whether it has failed (erosion.h). Empty when no material can.
  [[nodiscard]] std::span<const std::uint8_t> eroded() const;
  [[nodiscard]] std::size_t eroded_count() const;
  /// Sum of external loads given to free nodes so far, N s, and what clamped nodes took.
  [[nodiscard]] Vec3 impulse_received() const;
  [[nodiscard]] Vec3 impulse_to_clamps() const;
  [[nodiscard]] std::uint64_t element_steps() const;  ///< evaluations of an element
  void set_velocity(std::size_t node, const Vec3& linear, const Vec3& angular);
  /// Moves a node at this velocity (m/s) from now on, zero included: a grip. Its components must be held
  /// (clamped, or ShellMesh::constraints) wherever the velocity is not zero; the work of what moves it enters
  /// energy().external_work. Not with damping. To be said again
  /// for the same nodes, in the same order, before load().
  void drive(std::size_t node, const Vec3& velocity);
  /// N, what holds the held components of a driven node on their way against the shells and the loads given:
  /// as of the last force evaluation, at positions one step before nodes().
  [[nodiscard]] Vec3 holding_force(std::size_t node) const;
  /// What all driven nodes gave so far.
  struct GripSums {
    Vec3 impulse{0, 0, 0};  ///< N s
    double exchanged = 0;   ///< N s, sum of the impulses' magnitudes
    double work = 0;        ///< J, as of the last force evaluation
  };
  [[nodiscard]] GripSums grips() const;
  void set_position(std::size_t node,
                    const Vec3& position);  ///< for restoring a settled shape; before stepping only

  [[nodiscard]] CarpetShape shape() const;  ///< none of whose elements has failed, else std::logic_error
  /// Stands as in that shape, of a carpet of the same mesh and sections, and at rest; before the first step
  /// only (std::logic_error). Throws RunError when it does not fit.
  void take_shape(const CarpetShape& shape);

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::fe
