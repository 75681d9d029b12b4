#pragma once
/// The micro-scale of a finished run, or one under way, read back from its run.h5.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "core/contact_network.h"
#include "core/hdf5_file.h"
#include "micro_scale/coarse_grid.h"

namespace tuft::coupler {

/// Frames with contacts or fields; 0: the run recorded neither.
[[nodiscard]] std::size_t micro_frames(const h5::Group& root);
[[nodiscard]] bool has_contacts(const h5::Group& root);
[[nodiscard]] bool has_fields(const h5::Group& root);
[[nodiscard]] double frame_time(const h5::Group& root, std::size_t frame);  ///< s since release
/// What contacts are of: particles, or where those are spheres of clumps, clumps and other grains.
[[nodiscard]] std::size_t particle_count(const h5::Group& root);
/// rad/s, root mean square over the particles. Of a run with contacts.
[[nodiscard]] double spin_rms(const h5::Group& root, std::size_t frame);

/// The contacts of a frame, in single precision as they were recorded. frame < micro_frames.
[[nodiscard]] ContactNetwork read_contacts(const h5::Group& root, std::size_t frame);

struct RecordedFields {
  micro::CoarseGrid grid;
  double width = 0;         ///< m
  double mass_outside = 0;  ///< kg, of particles beyond the grid
  /// By name as in /frames/grid, cell by cell; vectors have 3, tensors 9 numbers a cell.
  std::map<std::string, std::vector<double>> values;
};
[[nodiscard]] RecordedFields read_fields(const h5::Group& root, std::size_t frame);

}  // namespace tuft::coupler
