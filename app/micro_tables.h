#pragma once
/// The micro-scale in words and tables, for the terminal.
#include <optional>
#include <string>

#include "core/hdf5_file.h"
#include "coupler/micro_reader.h"

namespace tuft::app {

/// One run at one moment: a frame of a file that is laid out as run.h5.
struct MicroMoment {
  std::string name;    ///< of the approach
  std::string source;  ///< "frame 3", "checkpoint"
  h5::Group root;
  std::size_t frame = 0;
  std::optional<ContactNetwork> network;
  std::optional<coupler::RecordedFields> fields;
};

/// Statistics of its contacts and profiles of its fields, as far as it has them.
void print_moment(const MicroMoment& moment);

/// Fields of two moments cell by cell, over the cells in which both have infill. Both have fields. Throws
/// InputError where their grids differ.
void print_field_comparison(const MicroMoment& a, const MicroMoment& b);

}  // namespace tuft::app
