#include "dem_bridge/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <functional>
#include <string>
#include <system_error>
#include <thread>

#include "core/error.h"

namespace tuft::dem {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t letters = 6;  // that mkdtemp chooses
constexpr int attempts = 100;

/// How the names of this machine's folders begin. Folders on a network's file system are seen by machines
/// that do not see each other's locks, so each sweeps its own: the name tells the host and its start. What
/// was left before a machine was started again nobody sweeps.
std::string name_begin() {
  std::string machine(HOST_NAME_MAX + 1, '\0');
  ::gethostname(machine.data(), machine.size() - 1);
  std::string start;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> start;
  return fmt::format("tuft-{:08x}-",
                     static_cast<std::uint32_t>(std::hash<std::string>{}(machine.c_str() + ("/" + start))));
}

/// Opens a folder and takes the lock that it is itself, without waiting. -1 and errno where that fails:
/// EWOULDBLOCK when someone holds it, ENOENT also when the folder was removed before it was locked. Who has
/// it knows that the path leads to this folder until he removes it: nobody removes what he does not hold.
int hold(const fs::path& folder, struct stat& held) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return -1;
  struct stat named {};
  int reason = 0;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 || ::fstat(descriptor, &held) != 0 ||
      ::lstat(folder.c_str(), &named) != 0)
    reason = errno;
  else if (held.st_nlink == 0 || held.st_dev != named.st_dev || held.st_ino != named.st_ino)
    reason = ENOENT;
  if (reason == 0) return descriptor;
  ::close(descriptor);
  errno = reason;
  return -1;
}

/// Of a folder that is held here. Its maker locks it before anything is put there, so one that holds
/// something was left; an empty one may wait for its maker. Clocks differ: a time far ahead is no better.
bool was_left(const fs::path& folder, const struct stat& held, std::chrono::seconds grace) {
  std::error_code failure;
  const bool empty = fs::is_empty(folder, failure);
  if (failure || held.st_uid != ::getuid()) return false;
  return !empty || std::llabs(std::time(nullptr) - held.st_mtime) >= grace.count();
}

/// The kernel lets go of a lock when its holder dies. A lock is kept until its folder is gone.
void sweep(const fs::path& temporary, const std::string& begin, std::chrono::seconds grace) {
  std::error_code failure, ignored;
  for (fs::directory_iterator entry(temporary, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string name = entry->path().filename();
    if (!name.starts_with(begin) || name.size() != begin.size() + letters) continue;
    struct stat held {};
    const int lock = hold(entry->path(), held);
    if (lock < 0) continue;
    if (was_left(entry->path(), held, grace)) fs::remove_all(entry->path(), ignored);
    ::close(lock);
  }
}

}  // namespace

ScratchFolder::ScratchFolder(std::chrono::seconds grace) {
  const std::string begin = name_begin();
  std::error_code failure;
  fs::path temporary = fs::temp_directory_path(failure);
  // The path of a socket in the folder holds 107 bytes at most.
  const std::size_t longest = 107 - std::strlen("//control") - begin.size() - letters;
  const bool too_long = !failure && temporary.string().size() > longest;
  if (failure || too_long) temporary = "/tmp";
  sweep(temporary, begin, grace);

  for (int attempt = 0; attempt < attempts; ++attempt) {
    if (path_.empty()) {
      std::string pattern = (temporary / (begin + std::string(letters, 'X'))).string();
      if (::mkdtemp(pattern.data()) == nullptr)
        throw_run_error(
            "no folder can be made in {}{}: {}; set TMPDIR to a folder that can be written, its path of at "
            "most {} bytes",
            temporary.string(), too_long ? " (the path in TMPDIR is too long)" : "", std::strerror(errno),
            longest);
      path_ = pattern;
    }
    struct stat held {};
    lock_ = hold(path_, held);
    if (lock_ >= 0) return;
    const int reason = errno;
    if (reason == EWOULDBLOCK) {  // another program looks whether it was left
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else if (reason == ENOENT) {  // and took it for such
      path_.clear();
    } else {
      ::rmdir(path_.c_str());
      throw_run_error("the folder {} cannot be locked: {}; {}", path_.string(), std::strerror(reason),
                      reason == EMFILE || reason == ENFILE ? "raise the limit of open files (ulimit -n)"
                                                           : "set TMPDIR to a folder on another disk");
    }
  }
  throw_run_error(
      "no folder can be kept in {}: {} times another program removed or held a new one before it could be "
      "locked; start again, or set TMPDIR to a folder that no other program cleans",
      temporary.string(), attempts);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(lock_);
}

}  // namespace tuft::dem
