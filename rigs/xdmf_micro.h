#pragma once
/// The micro-scale in run.xdmf: contacts as lines from centre to centre, and coarse-grained fields.
#include <cstdint>
#include <string>

#include "core/hdf5_file.h"

namespace tuft::rigs::xdmf {

/// Frames that group `frames` holds of contacts and fields, as far as it has them; `frames_of_run` else.
[[nodiscard]] std::uint64_t whole_micro_frames(const h5::Group& frames, std::uint64_t frames_of_run);

/// The grids of one frame; empty where nothing of the micro-scale was recorded. `file`: name of run.h5.
class MicroGrids {
 public:
  MicroGrids(const h5::Group& frames, std::string file);
  [[nodiscard]] std::string contacts(std::uint64_t frame) const;
  [[nodiscard]] std::string fields(std::uint64_t frame) const;

 private:
  [[nodiscard]] std::string item(const std::string& name, std::uint64_t first, std::uint64_t rows,
                                 bool integer) const;

  h5::Group frames_;
  std::string file_;
  std::vector<double> end_;  ///< of each frame's contacts
};

}  // namespace tuft::rigs::xdmf
