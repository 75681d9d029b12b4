#pragma once
/// A private folder for one host: its socket, its log, its restart files.
#include <filesystem>

namespace tuft::dem {

class ScratchFolder {
 public:
  /// Creates <temporary folder>/tuft-dem-XXXXXX (mode 0700) and holds a lock in it while it lives. Removes
  /// such folders of earlier programs that were killed: those whose lock nobody holds. Throws RunError.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace tuft::dem
