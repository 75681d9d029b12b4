#pragma once
/// LIGGGHTS as the bridge needs it: one rank of it, and all functions are called on all ranks alike. The
/// implementation is the only place that sees LIGGGHTS' headers.
///
/// State between windows: LIGGGHTS has just evaluated the grains' own forces at x(t); velocities are
/// v(t - dt/2). So they are in LIGGGHTS' arrays and in the shared memory, where they are copied in LIGGGHTS'
/// callback. `advance` makes the kick of a whole step and the drift under these forces and what the driver
/// sends (sphere_steps.h), and lets LIGGGHTS go on to the next evaluation: so the forces of the window act at
/// t, without lag, and the exchange happens outside LIGGGHTS' run, where a restart file may be written at any
/// window. Clumps are integrated by LIGGGHTS, which has made its closing half kick with their forces;
/// `advance` makes the rest of it.
#include <filesystem>
#include <memory>
#include <string>

#include "dem_bridge/shared_memory.h"

namespace tuft::dem {

class LiggghtsEngine {
 public:
  /// LIGGGHTS' own errors end the process (its words are in the shared memory); those of the bridge are
  /// thrown as std::runtime_error by all functions below.
  LiggghtsEngine(SharedMemory& memory, int rank);
  ~LiggghtsEngine();
  LiggghtsEngine(const LiggghtsEngine&) = delete;
  LiggghtsEngine& operator=(const LiggghtsEngine&) = delete;

  void set_up(const std::string& commands);
  /// After `set_up` from a restart file.
  void resume();
  void advance();
  void compute_stored_energy();
  void take_census();
  /// The answer to Request::contacts.
  [[nodiscard]] std::string list_overlaps();
  /// The answer to Request::network (contact_network.h).
  [[nodiscard]] std::string list_contacts();
  void save(const std::string& restart_file);

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::dem
