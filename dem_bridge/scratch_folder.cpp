#include "dem_bridge/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <system_error>

#include "core/error.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;
constexpr const char* prefix = "tuft-dem-";
/// s after which a folder without a lock is not one that is being made, which takes microseconds: its maker
/// was killed in them. One that was only kept waiting finds it swept, and makes another.
constexpr std::time_t being_made = 2;
constexpr int attempts = 3;

/// Takes the lock that a file is, without waiting; -1 when someone holds it or there is no such file.
int take_lock(const fs::path& file, int flags = 0) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CLOEXEC | flags, 0600);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

/// Puts a lock into a new folder and returns its descriptor, -1 on failure. It is taken under another name,
/// so that nobody ever finds it free under its own: between the making of a file and the taking of its lock
/// another program's sweep would take the folder for one that belongs to nobody.
int place_lock(const fs::path& folder) {
  const fs::path unseen = folder / "lock.new";
  const int descriptor = take_lock(unseen, O_CREAT | O_EXCL);
  if (descriptor < 0) return -1;
  if (::rename(unseen.c_str(), (folder / "lock").c_str()) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

/// The lock goes last, and comes back when a host that is just being ended has put something there meanwhile:
/// a folder without a lock would be swept by nobody.
void remove_folder(const fs::path& folder) {
  std::error_code ignored, failure;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().filename() != "lock") fs::remove_all(entry.path(), ignored);
  fs::remove(folder / "lock", ignored);
  fs::remove(folder, failure);
  if (!failure) return;
  const int lock = ::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (lock >= 0) ::close(lock);
}

/// The kernel lets go of a lock when its holder dies, so a folder whose lock is free belongs to nobody. A
/// folder without a lock file may be one that is being made just now: it is left alone for a while.
void remove_stale_folders(const fs::path& temporary) {
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(temporary, fs::directory_options::skip_permission_denied, ignored)) {
    if (!entry.path().filename().string().starts_with(prefix)) continue;
    struct stat status {};
    if (::lstat(entry.path().c_str(), &status) != 0 || !S_ISDIR(status.st_mode) ||
        status.st_uid != ::getuid())
      continue;
    const fs::path lock_file = entry.path() / "lock";
    const int lock = take_lock(lock_file);
    if (lock < 0 && (fs::exists(lock_file, ignored) || std::time(nullptr) - status.st_mtime <= being_made))
      continue;
    remove_folder(entry.path());
    if (lock >= 0) ::close(lock);
  }
}

}  // namespace

ScratchFolder::ScratchFolder() {
  std::error_code failure;
  fs::path temporary = fs::temp_directory_path(failure);
  // A socket's path holds 107 characters at most; a deep TMPDIR would not fit.
  if (failure || temporary.string().size() > 80) temporary = "/tmp";
  remove_stale_folders(temporary);
  int reason = 0;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    std::string pattern = (temporary / (std::string(prefix) + "XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw_run_error("no folder can be made in {}: {}; set TMPDIR to a folder that can be written",
                      temporary.string(), std::strerror(errno));
    path_ = pattern;
    lock_ = place_lock(path_);
    if (lock_ >= 0) return;
    reason = errno;
    remove_folder(path_);
    if (reason != ENOENT) break;
  }
  throw_run_error("{} cannot be locked: {}; set TMPDIR to a folder on a local disk", path_.string(),
                  std::strerror(reason));
}

ScratchFolder::~ScratchFolder() {
  remove_folder(path_);
  if (lock_ >= 0) ::close(lock_);
}

}  // namespace tuft::dem
