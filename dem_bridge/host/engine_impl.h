#pragma once
/// Inside of LiggghtsEngine, for the files that make it up. Sees LIGGGHTS' headers.
#include <fmt/format.h>
#include <mpi.h>

#include <liggghts/lammps.h>
// LIGGGHTS' headers lean on each other's order.
#include <liggghts/atom.h>
#include <liggghts/fix_external.h>
#include <liggghts/fix_property_global.h>
#include <liggghts/force.h>
#include <liggghts/input.h>
#include <liggghts/integrate.h>
#include <liggghts/modify.h>
#include <liggghts/neigh_list.h>
#include <liggghts/pair_gran.h>
#include <liggghts/update.h>

#include <chrono>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/vector.h"
#include "dem_bridge/hooke_hysteresis.h"
#include "dem_bridge/host/clumps.h"
#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/host/rows.h"
#include "dem_bridge/host/sphere_steps.h"

namespace tuft::dem {

struct KickSums;
class LoadCursor;

/// All grains here are those of this rank: `nlocal` of them, ghosts of other ranks' behind.
struct LiggghtsEngine::Impl {
  SharedMemory& memory;
  const SharedState& shared;
  RankState& report;
  LAMMPS_NS::LAMMPS* lammps = nullptr;
  bool started = false;
  bool stepping = false;               // callbacks outside `advance` (set-ups) only look away
  std::int64_t substep = 0;            // of the window under way
  double copy_seconds = 0;             // of the window under way
  std::string trouble;                 // found in a callback, thrown when LIGGGHTS has returned
  std::map<std::size_t, Vec3> parked;  // grains that have left, and where: they are elsewhere in LIGGGHTS
  std::unique_ptr<Clumps> clumps;      // from set_up on
  std::optional<StateOut> written;     // the state of all grains, by the window's last step
  std::vector<int> place;              // of a grain in LIGGGHTS' arrays, by its index; -1: another rank's

  Impl(SharedMemory& shared_memory, int rank);
  ~Impl() { delete lammps; }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void command(const std::string& line) { lammps->input->one(line.c_str()); }

  /// LIGGGHTS reallocates and reorders its arrays: nothing of them may be kept between calls.
  [[nodiscard]] std::size_t index(int atom) const {
    return static_cast<std::size_t>(lammps->atom->tag[atom] - 1);
  }
  [[nodiscard]] int local_count() const { return lammps->atom->nlocal; }
  /// The three arrays from `first` on.
  struct Components {
    double *x, *y, *z;
    [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const Vec3& value) const { x[i] = value.x(), y[i] = value.y(), z[i] = value.z(); }
  };
  [[nodiscard]] Components components(std::size_t first) const {
    return {memory.array(first).data(), memory.array(first + 1).data(), memory.array(first + 2).data()};
  }

  // The state that driver and host exchange (exchange.cpp).
  [[nodiscard]] bool in_our_order() const;
  [[nodiscard]] bool copy_by_number(bool& all_inside);
  void publish_state();
  void take_velocities();
  void publish_own_forces();
  void restore_own_forces();
  void step_grains(bool in_run);
  void step_in_order(const SphereStep& step, bool last, LoadCursor& cursor, KickSums& sums);
  void step_by_number(const SphereStep& step, LoadCursor& cursor, KickSums& sums);
  void expel(int atom);
  void find_parked();
  void hold_expelled();
  void park(int atom);
  [[nodiscard]] Vec3 parking_place(const Vec3& left) const;

  // Grains that are clumps (clump_motion.cpp).
  void kick_clumps(bool in_run, KickSums& sums);
  void expel_clumps();
  void hold_expelled_clumps();
  void take_clump_velocities();
  void change_clump_step(double change);

  // Contacts (stored_energy.cpp).
  template <class Visit>
  void for_each_contact(Visit&& visit);
  /// What a `fix property/global` of the commands holds; null where there is none.
  [[nodiscard]] LAMMPS_NS::FixPropertyGlobal* property(const char* name, const char* style, int rows,
                                                       int columns);
  [[nodiscard]] std::vector<double> property_of_types(const char* name);
  /// Of plastic springs; one law for all kinds of grains. Empty where they are not.
  [[nodiscard]] std::optional<Hysteresis> hysteresis();
  /// As of the kick under way, or between kicks, nearly, as of the last.
  [[nodiscard]] double stored_energy(bool in_kick);
  void note_stored_energy();
  [[nodiscard]] std::string list_overlaps();

  // LIGGGHTS' steps (liggghts_engine.cpp).
  void set_step(double step);
  void start();
  static void callback(void* self, LAMMPS_NS::bigint, int count, int*, double**, double** external);
};

/// `visit(a, b, distance, history)`: places of both, x_a - x_b, LIGGGHTS' springs. A contact with another
/// rank's grain is met on both ranks; then b is a ghost, nlocal or more.
template <class Visit>
void LiggghtsEngine::Impl::for_each_contact(Visit&& visit) {
  auto* pair = dynamic_cast<LAMMPS_NS::PairGran*>(lammps->force->pair);
  if (pair == nullptr || pair->list == nullptr)
    throw std::runtime_error("LIGGGHTS has no granular neighbour list");
  auto* atom = lammps->atom;
  for (int k = 0; k < pair->list->inum; ++k) {
    const int a = pair->list->ilist[k];
    for (int n = 0; n < pair->list->numneigh[a]; ++n) {
      const int b = pair->list->firstneigh[a][n] & NEIGHMASK;
      const double* history =
          pair->listgranhistory->firstdouble[a] + static_cast<std::ptrdiff_t>(pair->dnum()) * n;
      visit(a, b, load3(atom->x[a]) - load3(atom->x[b]), history);
    }
  }
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace tuft::dem
