#pragma once
/// The one interface that both descriptions of infill, SPH and DEM, implement. Rigs and contact see infill
/// only through it and cannot tell which one they have: that is what makes the comparison fair.
///
/// Time convention (leapfrog, the same as the carpet's central differences): at the start of window k
/// positions stand at t_k and velocities at t_k - dt/2. `advance` evaluates the infill's own forces at t_k,
/// kicks to t_k + dt/2 under them and the contact impulse of the window, and drifts positions to t_k + dt.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "core/contact_network.h"
#include "core/hdf5_file.h"
#include "core/vector.h"

namespace tuft {

/// When particles that take steps of their own are kicked. Entry k is of particles [k group, (k + 1) group);
/// empty: all are kicked in every window, for as long as it is.
struct ParticleKicks {
  std::size_t group = 1;
  std::span<const double> since;  ///< s since the last kick
  /// s that the coming window's kick lasts; 0: it has none. Below 0 where a period has become shorter and the
  /// last kick went too far ahead.
  std::span<const double> length;
  /// s, of that, from when the velocity belongs to until now: what of the kick lies before the moment of its
  /// force. Half of it in regular kicks; below 0 where the last kick went too far ahead.
  std::span<const double> lag;

  [[nodiscard]] bool empty() const { return length.empty(); }
};

/// Structure-of-arrays view of the particles. All spans have one size. Index i is the same particle for the
/// whole run, in every view and across checkpoints. Valid until the next call that is not const.
struct ParticleView {
  std::span<const double> x, y, z;     ///< position, m
  std::span<const double> vx, vy, vz;  ///< velocity, m/s
  std::span<const double> wx, wy, wz;  ///< spin, rad/s; empty where particles have none (SPH)
  std::span<const double> radius;      ///< contact radius, m; sideways where half_height is not empty
  std::span<const double> mass;        ///< kg
  std::span<const Index> layer;        ///< index into Scene::turf.layers
  /// Index into Scene::materials of what touches others (a grain of a mixture layer is sand or SBR; an SPH
  /// particle is its layer's material).
  std::span<const Index> material;
  /// 1: has left the turf and takes no part any more (Expelled). Empty where none has.
  std::span<const std::uint8_t> expelled;
  ParticleKicks kicks{};  ///< of the window that `begin_window` has announced
  /// Contact radius upwards and downwards, m; empty where that is `radius`. An SPH particle stands for a cell
  /// of its lattice, whose rows are as high as it takes for whole ones to fill a layer.
  std::span<const double> half_height{};

  [[nodiscard]] bool is_expelled(std::size_t i) const { return !expelled.empty() && expelled[i] != 0; }
  [[nodiscard]] double radius_upwards(std::size_t i) const {
    return half_height.empty() ? radius[i] : half_height[i];
  }
  /// Contact radius along a unit normal: of the ellipsoid with these half axes.
  [[nodiscard]] double radius_along(std::size_t i, const Vec3& normal) const {
    if (half_height.empty() || half_height[i] == radius[i]) return radius[i];
    const double up = normal.z() * normal.z();
    return std::sqrt(radius[i] * radius[i] * (1 - up) + half_height[i] * half_height[i] * up);
  }
  [[nodiscard]] double largest_radius(std::size_t i) const { return std::max(radius[i], radius_upwards(i)); }
  /// Radius of the sphere with the volume of that ellipsoid.
  [[nodiscard]] double mean_radius(std::size_t i) const {
    return half_height.empty() || half_height[i] == radius[i]
               ? radius[i]
               : std::cbrt(radius[i] * radius[i] * half_height[i]);
  }
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] bool has_spin() const { return !wx.empty(); }
  [[nodiscard]] Vec3 position(std::size_t i) const { return {x[i], y[i], z[i]}; }
  [[nodiscard]] Vec3 velocity(std::size_t i) const { return {vx[i], vy[i], vz[i]}; }
  [[nodiscard]] Vec3 spin(std::size_t i) const {
    return has_spin() ? Vec3(wx[i], wy[i], wz[i]) : Vec3(0, 0, 0);
  }
};

/// What contact gives each particle over one window. The infill spreads it evenly over its substeps.
struct ContactImpulses {
  Vec3Array linear;   ///< N s
  Vec3Array angular;  ///< N m s about the particle's centre; empty where particles have no spin
};

/// Energies of the infill, J, all as of one moment: the last force evaluation, with the kinetic energy
/// centred there, as the mean of the values half a step before and after or as m v- . v+ / 2. Stored terms
/// are current values, the others have been summed up since the start of the run.
struct InfillEnergy {
  double kinetic = 0;            ///< translation and spin
  double stored = 0;             ///< elastic energy between or in particles; for SPH the whole stress work
  double dissipated = 0;         ///< friction, plasticity where told apart, viscosity inside the infill
  double gravity_potential = 0;  ///< relative to z = 0
  double damping = 0;            ///< taken out by set_damping
  double contact_work = 0;  ///< work the contact impulses did on the infill (sum of J . centred velocity)
  double let_go = 0;        ///< what the infill held that another that took over could not (conditioning)
  double expelled = 0;      ///< kinetic energy of particles as they left the turf
};

/// Particles that have left the turf. They stay in the view, where they left, without velocity; nothing
/// touches them, and their stored and gravity energy stays in the infill's.
struct Expelled {
  std::uint64_t particles = 0;
  double mass = 0;            ///< kg
  Vec3 momentum{0, 0, 0};     ///< kg m/s, as they left
  double kinetic_energy = 0;  ///< J, as they left
};

/// What one window did, measured on the receiving side.
struct AdvanceReport {
  Vec3 impulse_received{0, 0, 0};  ///< N s, sum of contact impulses as really applied
  Vec3 impulse_scale{0, 0, 0};     ///< N s, sum of their absolute values by component
  int substeps = 0;
};

class Infill {
 public:
  Infill() = default;
  Infill(const Infill&) = delete;
  Infill& operator=(const Infill&) = delete;
  virtual ~Infill() = default;

  [[nodiscard]] virtual std::string_view approach() const = 0;  ///< "sph" or "dem"
  [[nodiscard]] virtual ParticleView particles() const = 0;
  /// Largest stable step of the infill's own forces at the present state, s, before any safety factor.
  [[nodiscard]] virtual double stable_step() const = 0;
  /// Announces the window that `advance` will make, before contact is evaluated for it. energy_wanted:
  /// energies as of its start are of use.
  virtual void begin_window(double /*window*/, int /*substeps*/, bool /*energy_wanted*/) {}
  /// Whether particles may be kicked at times of their own (ParticleView::kicks). Where they are, contact's
  /// impulse on one is its force times the length of its kick, in windows in which it has one; and
  /// `set_contact_rates` tells what steps contact bears.
  [[nodiscard]] virtual bool has_individual_steps() const { return false; }
  /// Inverse of the longest step that contact bears, 1/s, a value a particle: 0 where nothing is near,
  /// infinite for a particle that has to be kicked in every window.
  virtual void set_contact_rates(std::span<const float> /*rates*/) {}
  /// Whether the energies are as of the start of the last window. If not they are of an earlier moment.
  [[nodiscard]] virtual bool energy_is_current() const { return true; }
  /// Where thin sheets lie (corners in order, m): particles of a continuum on both sides of one do not act on
  /// each other until the next call. Returns how far particles and sheets may each move until then, m.
  /// Grains, which meet only what they touch, pay no heed.
  virtual double set_sheets(std::span<const std::array<Vec3, 4>> /*sheets*/) {
    return std::numeric_limits<double>::infinity();
  }
  /// One coupling window, in `substeps` equal steps of window/substeps.
  /// Throws RunError naming particle, time and field when a value is not finite, or the host is gone.
  virtual AdvanceReport advance(double window, int substeps, const ContactImpulses& contact) = 0;
  /// Mass-proportional damping a = -rate v for settling, 1/s; 0 switches it off.
  virtual void set_damping(double rate) = 0;
  [[nodiscard]] virtual InfillEnergy energy() const = 0;
  [[nodiscard]] virtual Expelled expelled() const { return {}; }
  /// Particle steps so far (particles times substeps).
  [[nodiscard]] virtual std::uint64_t particle_steps() const = 0;

  /// State for a bitwise continuation. `load` expects an object built from the same scene.
  virtual void save(h5::Group& group) = 0;
  virtual void load(const h5::Group& group) = 0;
  /// Scalar fields for frames, one value a particle, SI: e.g. "pressure" (Pa), "density" (kg/m^3).
  struct Field {
    std::string name, unit;
    std::vector<double> values;
  };
  [[nodiscard]] virtual std::vector<Field> fields() const = 0;

  /// Contacts of the particles with each other where they stand now, all of kind grain. Empty where stress is
  /// a state of the particles. Changes no bit of what follows.
  [[nodiscard]] virtual ContactNetwork contacts() const { return {}; }
  /// Volume times Cauchy stress (tension positive) of each particle, J: xx yy zz xy yz zx. Empty where stress
  /// is that of the contacts.
  [[nodiscard]] virtual std::vector<std::array<double, 6>> stress_moments() const { return {}; }
};

}  // namespace tuft
