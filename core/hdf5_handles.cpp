#include "core/hdf5_handles.h"

#include <cstring>

#include "core/error.h"

namespace tuft::h5 {
namespace {

/// HDF5 prints its error stack on stderr unless told not to; here errors are exceptions.
void silence_library() {
  static const herr_t once = H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  static_cast<void>(once);
}

herr_t keep_innermost(unsigned /*depth*/, const H5E_error2_t* error, void* text) {
  if (error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

hid_t open_file(const std::string& name, OpenFile::Mode mode, hid_t access) {
  switch (mode) {
    case OpenFile::Mode::read:
      return H5Fopen(name.c_str(), H5F_ACC_RDONLY, access);
    case OpenFile::Mode::write_new:
      return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    case OpenFile::Mode::append:
      return H5Fopen(name.c_str(), H5F_ACC_RDWR, access);
  }
  return -1;
}

}  // namespace

std::string last_library_message() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_innermost, &text);
  H5Eclear2(H5E_DEFAULT);
  return text.empty() ? "unknown HDF5 error" : text;
}

OpenFile::OpenFile(std::filesystem::path path, Mode mode)
    : path_(std::move(path)), status_(std::make_unique<DriverStatus>()) {
  silence_library();
  const Id access(make_access_properties(status_.get()));
  id_ = open_file(path_.string(), mode, access.get());
  if (id_ < 0) fail("", mode == Mode::write_new ? "cannot create the file" : "cannot open the file");
}

bool OpenFile::close_quietly() {
  if (id_ < 0) return true;
  const bool closed = H5Fclose(id_) >= 0;
  id_ = -1;
  if (!closed) {  // the library still refers to the status: leave it to it, go on with a copy
    const DriverStatus* kept = status_.release();
    status_ = std::make_unique<DriverStatus>(*kept);
  }
  return closed;
}

OpenFile::~OpenFile() {
  close_quietly();
}

void OpenFile::close() {
  const bool closed = close_quietly();
  if (!closed) fail("", "cannot close the file");
  require_healthy("");
}

void OpenFile::fail(std::string_view object, std::string_view what) const {
  const std::string library = last_library_message();
  const std::string reason = status_->error != 0
                                 ? fmt::format("{}: {}", status_->operation, std::strerror(status_->error))
                                 : library;
  throw RunError(
      fmt::format("{}{}{}: {} ({})", path_.string(), object.empty() ? "" : ": ", object, what, reason));
}

void OpenFile::require_healthy(std::string_view object) const {
  if (status_->error != 0) fail(object, "cannot write");
}

}  // namespace tuft::h5
