#pragma once
/// Infill as grains: the client of liggghts_host, which is the only program that links LIGGGHTS.
#include <memory>
#include <string>
#include <vector>

#include "core/infill.h"
#include "core/scene.h"

namespace tuft::dem {

/// Grains placed in space, or the spheres that clumps are made of. Index i is LIGGGHTS tag i + 1.
struct Grains {
  Vec3Array position;           ///< m
  std::vector<double> radius;   ///< m
  std::vector<double> density;  ///< kg/m^3
  std::vector<Index> layer;     ///< index into the turf's layers
  std::vector<Index> material;  ///< index into Scene::materials
  /// Number of the clump that a sphere belongs to, whose spheres follow each other in the order of their
  /// material's clump; below 0: a grain of its own. Empty: all are.
  std::vector<Index> body = {};
  std::size_t moved = 0;  ///< of grains that stuck between obstacles and were placed elsewhere in their layer
  [[nodiscard]] std::size_t size() const { return radius.size(); }
};

/// A thin quadrilateral that grains may not overlap (fibre or backing), for packing.
struct ThinQuad {
  std::array<Vec3, 4> corner;
  double half_thickness = 0;
};

struct PackingRequest {
  std::array<double, 2> size{};  ///< m, patch centred on the origin
  bool round = false;  ///< a cylinder about the z axis, size[0] = size[1] across, in place of a cuboid
  double floor = 0;    ///< m, top of the backing
  const Turf* turf = nullptr;
  const std::vector<Material>* materials = nullptr;
  const DemOptions* options = nullptr;
  std::uint64_t seed = 1;
  bool clumps = false;  ///< grains of materials with a clump are clumps (effect clumps), else spheres
  std::span<const ThinQuad> obstacles;
};

/// Geometric packing: random grains per layer up to the layer's mass, overlaps pushed apart against walls,
/// obstacles and each other. Deterministic for a seed. Not yet at rest: settle it with dynamics (the coupler
/// does). Clumps have the volumes, so the masses and numbers, of the spheres in whose place they are, and
/// are turned at random. Throws InputError for a request that cannot be packed, and for a layer that would
/// hold not a single grain.
[[nodiscard]] Grains pack_grains(const PackingRequest& request);

/// Factor on the diameters of a grain material: its own, else that of all.
[[nodiscard]] double coarse_graining_of(const DemOptions& options, const std::string& material);

struct DemSettings {
  DemOptions options;
  Vec3 gravity{0, 0, -9.81};  ///< m/s^2
  bool rolling_resistance = true;
  bool cohesion = false;
  std::array<Vec3, 2> box{};  ///< m; grains whose centre leaves it are expelled
};

/// m, by which LIGGGHTS' domain is wider than the box that grains may not leave.
inline constexpr double expulsion_margin = 0.02;

/// Every member that reaches the host throws RunError when it is gone, silent for longer than
/// DemOptions::answer_timeout, or reports a value that is not finite or a lost grain, and advance() when a
/// grain moves on by more than its radius in a step; the message has the time and the grain or the host's
/// last words. The host ends with the thread that made this object, at the latest. The step may change from
/// window to window; set_damping slows spin as well as motion.
class DemInfill final : public Infill {
 public:
  /// Starts a host process. Throws RunError when it is missing, does not answer, or reports an error (with
  /// its words).
  DemInfill(const Grains& grains, const std::vector<Material>& materials, const DemSettings& settings);
  ~DemInfill() override;

  [[nodiscard]] std::string_view approach() const override { return "dem"; }
  [[nodiscard]] ParticleView particles() const override;
  /// The smallest over the grains of 20 % of the Rayleigh time pi r sqrt(rho/G) / (0.1631 nu + 0.8766), and
  /// with Hooke's contact of what its springs bear (dem_bridge/hooke.h).
  [[nodiscard]] double stable_step() const override;
  void begin_window(double window, int substeps, bool energy_wanted) override;
  AdvanceReport advance(double window, int substeps, const ContactImpulses& contact) override;
  void set_damping(double rate) override;
  /// All as of the last kick (t_k for one substep a window). kinetic, contact_work and damping are summed in
  /// the host from what each kick did. stored is the closed form over the contacts: normal, tangential and
  /// rolling springs with their present stiffness (dem_bridge/hertz.h, hooke.h; cdt stores nothing), less
  /// what cohesion has given (cohesion.h): it may be below 0.
  ///
  /// LIGGGHTS 3.8.0 registers energy options for its contact models (computeElasticPotential,
  /// computeDissipatedEnergy), but no integrator of the library sums them up; so what grain contacts
  /// dissipate is what left the motion (minus the work of all grain-grain forces, summed every step) and is
  /// not stored. A dissipation cannot shrink: dissipated adds up its increases from one call to the next, so
  /// energy that contacts create (a step beyond stability, a spring that remembers too long) is not hidden in
  /// it but breaks the balance of the sum. Cost: one pass over the neighbour list, about a third of a DEM
  /// step. In a window that was announced with energy_wanted it is made at the last kick, and all energies
  /// are of that moment. Otherwise it is made on this call, with springs stretched as they are one step
  /// later: off by the springs' forces times the slip of a step, to and fro, and `dissipated` adds up what is
  /// off upwards. Kinetic energy is not summed in a window that was announced without energy_wanted: it stays
  /// that of the last one in which it was.
  [[nodiscard]] InfillEnergy energy() const override;
  /// Looked for at the end of every window. A grain so fast that it passes expulsion_margin in one is lost to
  /// LIGGGHTS (RunError).
  [[nodiscard]] Expelled expelled() const override;
  [[nodiscard]] std::uint64_t particle_steps() const override;
  void save(h5::Group& group) override;
  void load(const h5::Group& group) override;
  [[nodiscard]] std::vector<Field> fields() const override;
  /// Forces as of the last evaluation, at the present positions: with the impulse of the next window they are
  /// what the next kick works under. They are LIGGGHTS' own, whatever its contact models
  /// (host/contact_network.h), and their sums are checked against each grain's own force. Cost: about that of
  /// one DEM step, and of carrying 32 bytes a contact.
  [[nodiscard]] ContactNetwork contacts() const override;

  /// Before the first advance; std::logic_error afterwards. Of a clump's sphere: the whole clump moves as a
  /// rigid body whose sphere i has this velocity and spin.
  void set_velocity(std::size_t i, const Vec3& linear, const Vec3& spin);
  /// Grains::body as given.
  [[nodiscard]] std::span<const Index> clumps() const;
  /// m^3, of a grain; of a clump's sphere its share of the clump's, as of its mass.
  [[nodiscard]] double solid_volume(std::size_t i) const;
  [[nodiscard]] double waiting_seconds() const;   ///< wall time spent waiting for the host's DEM steps
  [[nodiscard]] double exchange_seconds() const;  ///< wall time of copying and signalling
  [[nodiscard]] int host_process() const;         ///< process id, for tests that kill it

  struct OverlapStatistics {
    double mean = 0, percentile_99 = 0, largest = 0;  ///< overlap over the smaller radius, of touching pairs
    std::size_t contacts = 0;
  };
  [[nodiscard]] OverlapStatistics overlaps() const;

  /// Overlaps of one pair of kinds of grains.
  struct PairOverlaps {
    Index first = 0, second = 0;  ///< into Scene::materials, first <= second
    OverlapStatistics now;
    /// Over the run (count_overlaps_from_now), as far as it was looked at: in windows with energy_wanted, at
    /// their last kick. Beyond DemOptions::overlap_limit `advance` throws RunError.
    double largest_of_run = 0;
  };
  /// From now on: what grains overlapped by before is forgotten, `limit` stops the run (0: none does).
  void count_overlaps_from_now(double limit);
  /// After `load`: the limit alone.
  void set_overlap_limit(double limit);
  /// All pairs of kinds that the bed holds, whether or not they touch.
  [[nodiscard]] std::vector<PairOverlaps> overlaps_by_pair() const;
  /// `largest_of_run` alone, which needs no host.
  [[nodiscard]] std::vector<PairOverlaps> largest_overlaps() const;
  /// The largest step so far over the smallest Rayleigh time of a grain (0.2: as large as usually taken).
  [[nodiscard]] double rayleigh_share() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::dem
