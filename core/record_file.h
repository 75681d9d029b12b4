#pragma once
/// Results that grow row by row (histories, frames, energies) in one HDF5 file that is readable after the writer
/// was killed at any moment.
///
/// How: rows are buffered in memory; `flush` opens the file, appends them as one transaction (core/hdf5_driver.h: data
/// before what points to it, extents last) and closes it. Between flushes the file is closed and whole; a kill or a
/// failed write in the middle of a flush leaves all earlier rows readable, by any HDF5 program.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/hdf5_file.h"

namespace tuft {

struct Channel {
  std::string path;                        ///< "/history/acceleration", "/frames/infill/position"
  std::string unit;                        ///< "m/s^2"; attribute `unit` of the dataset
  std::vector<std::uint64_t> row_shape;    ///< {} for one number a row, {N, 3} for N vectors
  bool single_precision = false;           ///< stored as float (frames)
  bool integer = false;                    ///< stored as a whole number of 32 bits (indices)
};

class RecordFile {
 public:
  /// Creates the file with empty channels; `write_static` adds what never changes (mesh, scene text).
  /// Throws RunError when the file cannot be created or written.
  static RecordFile create(const std::filesystem::path& path, const std::vector<Channel>& channels,
                           const std::function<void(h5::Group&)>& write_static);
  /// Goes on with an existing file; rows beyond `rows` (per channel, from a checkpoint) are cut off.
  static RecordFile reopen(const std::filesystem::path& path, const std::map<std::string, std::uint64_t>& rows);

  /// Buffers one row. Row length must match the channel; non-finite values throw RunError naming the channel.
  void append(std::string_view channel, std::span<const double> row);
  void append(std::string_view channel, double value);
  /// Any number of rows, one after the other.
  void append_rows(std::string_view channel, std::span<const double> rows);
  /// Writes what is buffered. Throws RunError with the free space when the disk is full; what was flushed before
  /// stays readable, and the buffered rows are dropped.
  void flush();
  /// Rows per channel, buffered ones included.
  [[nodiscard]] std::map<std::string, std::uint64_t> rows() const;
  [[nodiscard]] std::size_t buffered_bytes() const;

  RecordFile(RecordFile&&) noexcept;
  RecordFile& operator=(RecordFile&&) noexcept;
  ~RecordFile();

 private:
  RecordFile();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft
