#pragma once
/// A private folder for one host: its socket, its log, its restart files.
#include <chrono>
#include <filesystem>

namespace tuft::dem {

class ScratchFolder {
 public:
  /// Creates <temporary folder>/tuft-MACHINE-XXXXXX (mode 0700) and holds a lock on it while it lives; the
  /// temporary folder is TMPDIR, or /tmp where that is missing or its path too long for a socket's. Removes
  /// such folders of this machine that nobody holds: their programs were killed. An empty one that is younger
  /// than `grace` is left for its maker to lock; if that is wrong, its maker makes another. Throws RunError.
  explicit ScratchFolder(std::chrono::seconds grace = std::chrono::seconds(2));
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace tuft::dem
