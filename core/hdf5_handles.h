#pragma once
/// Owned HDF5 identifiers, and the library's failures as RunError. Internal to core/hdf5_*.cpp and
/// record_file.cpp.
#include <fmt/format.h>
#include <hdf5.h>

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/hdf5_driver.h"
#include "core/hdf5_file.h"

namespace tuft::h5 {

/// Closes an identifier at the end of its life, whatever kind it is.
class Id {
 public:
  Id() = default;
  explicit Id(hid_t value) : value_(value) {}
  Id(Id&& other) noexcept : value_(std::exchange(other.value_, -1)) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(value_, other.value_);
    return *this;
  }
  ~Id() { close(); }
  void close() noexcept {
    if (value_ >= 0 && H5Iis_valid(value_) > 0) H5Idec_ref(value_);
    value_ = -1;
  }
  [[nodiscard]] hid_t get() const { return value_; }
  [[nodiscard]] bool valid() const { return value_ >= 0; }

 private:
  hid_t value_ = -1;
};

/// Innermost message of the library's error stack, which is cleared.
[[nodiscard]] std::string last_library_message();

/// An open file and what went wrong below HDF5.
class OpenFile {
 public:
  enum class Mode { read, write_new, append };
  /// Throws RunError when the file cannot be opened. `append` also takes files marked as open by a killed
  /// program.
  OpenFile(std::filesystem::path path, Mode mode);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;

  /// Closes the file, which commits it. Throws RunError when anything failed since it was opened.
  void close();
  [[nodiscard]] hid_t id() const { return id_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Throws RunError: path, object, what failed, and the operating system's words when it was its fault.
  [[noreturn]] void fail(std::string_view object, std::string_view what) const;
  /// Throws when a write of the operating system has failed, though the library does not know.
  void require_healthy(std::string_view object) const;

 private:
  bool close_quietly();
  std::filesystem::path path_;
  std::unique_ptr<DriverStatus> status_;
  hid_t id_ = -1;
};

/// Throws through `file` unless `result` is a success; returns it otherwise.
template <class Result>
Result require(Result result, const OpenFile& file, std::string_view object, std::string_view what) {
  if (result < 0) file.fail(object, what);
  return result;
}

struct Group::Handle {
  std::shared_ptr<OpenFile> file;
  Id id;
  std::string path;  ///< inside the file, for messages; "" for the root

  [[nodiscard]] std::string object(std::string_view name) const { return fmt::format("{}/{}", path, name); }
};

/// The way from a Group to the library's identifiers and back.
struct GroupAccess {
  [[nodiscard]] static const Group::Handle& handle(const Group& group) { return *group.handle_; }
  [[nodiscard]] static Group root(const std::shared_ptr<OpenFile>& file);
};

}  // namespace tuft::h5
