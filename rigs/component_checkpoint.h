#pragma once
/// Where a run of a component rig stands, and its checkpoint.h5.
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "core/hdf5_file.h"
#include "core/scene.h"
#include "rigs/run_state.h"
#include "rigs/tension_results.h"

namespace tuft::rigs {

struct ComponentState {
  explicit ComponentState(std::size_t tests) : rows(tests), kinetic_share(tests, 0.0) {}

  std::uint64_t test = 0, row = 0;            ///< test at hand, rows of it done
  std::vector<std::vector<TensionRow>> rows;  ///< by test
  std::vector<double> kinetic_share;          ///< by test, largest over its rows
  double time_before = 0;                     ///< s, of the tests before this one
  std::uint64_t steps_before = 0, element_steps_before = 0, steps = 0;
  double energy_error = 0, momentum_error = 0;    ///< largest so far
  std::map<std::string, std::uint64_t> recorded;  ///< rows in run.h5
  SpentSoFar spent;                               ///< before this run of the program
};

/// `write_rest` adds the strip and its ledger.
void write_component_checkpoint(const std::filesystem::path& path, const Scene& scene,
                                const ComponentState& state,
                                const std::function<void(h5::Group&)>& write_rest);
/// Throws InputError for a file that is missing, damaged, or of another scene. `read_rest` is called when
/// `state` is complete.
void load_component_checkpoint(const std::filesystem::path& path, const Scene& scene, ComponentState& state,
                               const std::function<void(const h5::Group&)>& read_rest);

}  // namespace tuft::rigs
