#pragma once
/// Inside of DemInfill, for the files that make it up.
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "dem_bridge/clump_bodies.h"
#include "dem_bridge/dem_infill.h"
#include "dem_bridge/host_link.h"
#include "dem_bridge/liggghts_script.h"

namespace tuft::dem {

/// Sums over all ranks and all windows since the start of the run.
struct HostSums {
  double pair_work = 0;       ///< J, of grain-grain forces and torques
  double contact_work = 0;    ///< of the contact impulses
  double damping_work = 0;    ///< of the damping (never positive)
  double last_pair_work = 0;  ///< share of the last kick in each: a kick's middle is the moment of report
  double last_contact_work = 0;
  double last_damping_work = 0;
  double kinetic = 0;  ///< J, at the middle of the last kick
  double stored = 0;   ///< J, as the host was last asked to sum it
};

/// Grains that have been expelled. Kinetic energies are as of the first force evaluation outside; those that
/// the last kick still counted with the rest wait in `pending`.
struct ExpelledSums {
  std::uint64_t grains = 0;
  double mass = 0;
  std::array<double, 3> momentum{};
  double energy = 0, pending = 0;
};

struct DemInfill::Impl {
  Grains grains;
  std::vector<Material> materials;
  DemSettings settings;
  GrainBodies bodies;  // as given
  std::vector<Index> used;
  double stable_step = 0;
  double rayleigh_time = 0, largest_step = 0;  // s, of the grain with the smallest; so far
  GrainSizes sizes;

  std::unique_ptr<HostLink> host;
  bool started = false;
  EnergyWanted energy_wanted = EnergyWanted::kinetic;  // of the coming window
  bool stored_is_current = false;                      // the host has stored energy at the last kick
  double time = 0;                                     // s, end of the last window
  double damping = 0;                                  // 1/s
  double initial_stored = 0;
  double missing =
      0;  // J, energy that left the motion of the grains and is not stored, at the last `energy()`
  double dissipated = 0;    // J, sum of all increases of `missing`
  std::uint64_t steps = 0;  // substeps so far
  double waiting = 0, exchanging = 0;
  std::vector<std::uint8_t> expelled_mask;  // as ParticleView has it
  HostSums sums;
  ExpelledSums expelled;
  std::vector<double> overlap_largest;  // over the run, by pair_place of `used`

  Impl(const Grains& given, const std::vector<Material>& given_materials, const DemSettings& given_settings);

  [[nodiscard]] SharedMemory& memory() { return host->memory(); }
  [[nodiscard]] SharedState& shared() { return host->memory().state(); }
  [[nodiscard]] std::span<double> array(std::size_t name) { return host->memory().array(name); }
  std::string ask(Request request, std::string_view text = {}) {
    return host->ask(request, text, fmt::format("DEM infill at t = {:.9g} s", time));
  }

  /// A host of its own for each life: LIGGGHTS cannot be emptied and filled again safely. The one before is
  /// ended first.
  void new_host();
  void set_up(const std::string& source_command);
  void start_fresh();
  void write_loads(const ContactImpulses& contact);
  void check_speeds(double step);
  /// Adds what the ranks report of a window to the sums, rank by rank.
  [[nodiscard]] const GrainBody* body_of(std::size_t grain) const;
  void take_report(AdvanceReport& report);
  /// Throws RunError when a grain has been lost to LIGGGHTS, naming it.
  void check_count();
  void read_expelled();

  // Energy (dem_energy.cpp).
  void ask_stored();
  void sum_stored();
  [[nodiscard]] double kinetic_of_view();
  [[nodiscard]] double kinetic_of_bodies();
  [[nodiscard]] double gravity_potential();

  // Overlaps (dem_overlaps.cpp).
  void take_overlaps();

  // Checkpoints (dem_checkpoint.cpp).
  void write_vectors(h5::Group& group, const char* name, std::size_t first);
  void read_vectors(const h5::Group& group, const char* name, std::size_t first);
};

}  // namespace tuft::dem
