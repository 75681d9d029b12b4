#pragma once
/// HDF5 (C API) behind RAII. All failures throw RunError naming file and dataset (RunError, not InputError,
/// unless the caller translates it).
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tuft::h5 {

/// A group of an open file. Cheap to copy; keeps the file open while it lives.
class Group {
 public:
  struct Handle;  ///< internal (core/hdf5_handles.h)

  [[nodiscard]] Group create_group(std::string_view name);
  [[nodiscard]] Group open_group(std::string_view name) const;
  [[nodiscard]] bool has(std::string_view name) const;

  /// Writes a new dataset of rank shape.size(); an empty shape means one dimension, values.size() long.
  void write(std::string_view name, std::span<const double> values, std::vector<std::uint64_t> shape = {});
  void write(std::string_view name, std::span<const std::int32_t> values,
             std::vector<std::uint64_t> shape = {});
  void write(std::string_view name, std::span<const std::uint64_t> values,
             std::vector<std::uint64_t> shape = {});
  void write(std::string_view name, std::span<const std::uint8_t> values,
             std::vector<std::uint64_t> shape = {});
  void write_scalar(std::string_view name, double value);
  void write_scalar(std::string_view name, std::uint64_t value);
  void write_string(std::string_view name, std::string_view value);
  /// String attribute on this group, or on the dataset `of` inside it.
  void set_attribute(std::string_view key, std::string_view value, std::string_view of = {});

  [[nodiscard]] std::vector<double> read_doubles(std::string_view name) const;
  /// Of a dataset [R, ...] the values of one row, and nothing else from the disk. Throws RunError where it
  /// has fewer.
  [[nodiscard]] std::vector<double> read_row(std::string_view name, std::uint64_t row) const;
  [[nodiscard]] std::vector<std::int32_t> read_ints(std::string_view name) const;
  [[nodiscard]] std::vector<std::uint64_t> read_counts(std::string_view name) const;
  [[nodiscard]] std::vector<std::uint8_t> read_bytes(std::string_view name) const;
  [[nodiscard]] double read_double(std::string_view name) const;
  [[nodiscard]] std::uint64_t read_count(std::string_view name) const;
  [[nodiscard]] std::string read_string(std::string_view name) const;
  [[nodiscard]] std::string attribute(std::string_view key, std::string_view of = {}) const;
  [[nodiscard]] std::vector<std::uint64_t> shape(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> names() const;  ///< members, sorted

 private:
  friend struct GroupAccess;
  std::shared_ptr<Handle> handle_;
};

/// A whole file that is written or read at once (checkpoints, caches, reading results).
class File {
 public:
  /// Opens an existing file read-only; also one whose writer was killed.
  static File open(const std::filesystem::path& path);
  /// Starts a file beside `path`; `commit()` syncs it and renames it over `path`, so that `path` is at every
  /// moment either the old or the new file, whole. Destroyed without commit: the temporary file is removed.
  static File create_atomically(const std::filesystem::path& path);
  [[nodiscard]] Group root() const;
  void commit();
  ~File();
  File(File&&) noexcept;
  File& operator=(File&&) noexcept;

 private:
  File();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tuft::h5
