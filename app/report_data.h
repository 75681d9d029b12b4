#pragma once
/// What the report reads from one run's folder: summary, scene, histories, energies, frames. Whatever a
/// failed or stopped run did not get to record is simply absent.
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/hdf5_file.h"
#include "core/scene.h"
#include "rigs/run.h"

namespace tuft::app {

/// Columns over one time axis, all of one length.
struct TimeTable {
  std::vector<double> time;                            ///< s since release
  std::map<std::string, std::vector<double>> columns;  ///< SI, by name
  [[nodiscard]] bool has(const std::string& name) const { return columns.contains(name); }
  [[nodiscard]] const std::vector<double>& at(const std::string& name) const { return columns.at(name); }
};

/// The missile's outline, m.
struct Missile {
  double radius = 0, height = 0;
  double face_height = 0;  ///< z of the lower face
  double x = 0, y = 0;     ///< axis
};

/// One particle near the section plane, m.
struct Dot {
  float x, z, radius;
  float depth;  ///< distance from the plane towards the viewer
  Index material;
};

/// One carpet facet near the plane, projected on it (x and z), m.
struct Facet {
  std::array<std::array<float, 2>, 4> corner;
  std::array<bool, 4>
      free_edge;  ///< from corner c to c + 1: not shared with another facet of the same surface
  bool backing;
};

/// The neighbourhood of the plane through the missile's axis at one instant.
struct Section {
  double time = 0;  ///< s since release
  Missile missile;
  std::vector<Dot> dots;  ///< far to near
  std::vector<Facet> facets;
  double particle_slice = 0;  ///< m, whole thickness of the slice of particles
  double facet_slice = 0;     ///< m, the same for backing facets and for the roots of strands
};

struct RunData {
  std::filesystem::path folder;
  std::string label;  ///< "SPH", "DEM"; with the folder's name where that is not unique
  rigs::RunSummary summary;
  std::optional<Scene> scene;
  TimeTable history, energy;
  std::vector<double> frame_times;   ///< s since release
  std::optional<double> touch_time;  ///< s since release: rigs::TouchClock
  std::string unreadable;            ///< why run.h5 says nothing though it is there; empty otherwise

  /// Reads the frame nearest to a time. Empty when there are no frames.
  [[nodiscard]] std::optional<Section> section(double time) const;
};

/// Throws InputError for a folder without a run; a missing or partial run.h5 is not an error.
[[nodiscard]] RunData read_run(const std::filesystem::path& folder);

/// A folder of `compare` stands for the runs in it: DIR with DIR/sph and DIR/dem. Others stand for
/// themselves.
[[nodiscard]] std::vector<std::filesystem::path> expand_run_folders(
    const std::vector<std::filesystem::path>& folders);

/// False where the effect `fibres` was switched off.
[[nodiscard]] bool has_fibres(const RunData& run);

/// Time of the largest filtered deceleration, s since release; empty without history.
[[nodiscard]] std::optional<double> peak_time(const RunData& run);

}  // namespace tuft::app
