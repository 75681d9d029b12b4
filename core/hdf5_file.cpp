#include "core/hdf5_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "core/error.h"
#include "core/hdf5_handles.h"

namespace tuft::h5 {
namespace {

/// Makes a file's bytes, or a folder's entries, survive a power cut.
void sync_to_disk(const std::filesystem::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC);
  const int error = descriptor < 0 || ::fsync(descriptor) != 0 ? errno : 0;
  if (descriptor >= 0) ::close(descriptor);
  // Some file systems cannot sync a folder (EINVAL); the rename is atomic all the same.
  if (error != 0 && error != EINVAL)
    throw_run_error("{}: cannot sync to disk ({})", path.string(), std::strerror(error));
}

}  // namespace

struct File::Impl {
  std::shared_ptr<OpenFile> file;
  std::filesystem::path target;     // empty: opened for reading
  std::filesystem::path temporary;  // to remove unless committed

  ~Impl() {
    if (temporary.empty()) return;
    try {
      file->close();
    } catch (const RunError&) {  // the file goes anyway
    }
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
  }
};

File::File() = default;
File::~File() = default;
File::File(File&&) noexcept = default;
File& File::operator=(File&&) noexcept = default;

File File::open(const std::filesystem::path& path) {
  File opened;
  opened.impl_ = std::make_unique<Impl>();
  opened.impl_->file = std::make_shared<OpenFile>(path, OpenFile::Mode::read);
  return opened;
}

File File::create_atomically(const std::filesystem::path& path) {
  File created;
  created.impl_ = std::make_unique<Impl>();
  const std::filesystem::path temporary = path.string() + fmt::format(".new-{}", ::getpid());
  created.impl_->file = std::make_shared<OpenFile>(temporary, OpenFile::Mode::write_new);
  created.impl_->target = path;
  created.impl_->temporary = temporary;
  return created;
}

Group File::root() const {
  return GroupAccess::root(impl_->file);
}

void File::commit() {
  if (impl_->temporary.empty())
    throw_run_error("{}: committed twice, or open for reading", impl_->file->path().string());
  impl_->file->close();
  sync_to_disk(impl_->temporary, 0);
  std::error_code error;
  std::filesystem::rename(impl_->temporary, impl_->target, error);
  if (error) throw_run_error("{}: cannot be replaced ({})", impl_->target.string(), error.message());
  impl_->temporary.clear();
  const auto folder = impl_->target.parent_path();
  sync_to_disk(folder.empty() ? std::filesystem::path(".") : folder, O_DIRECTORY);
}

}  // namespace tuft::h5
