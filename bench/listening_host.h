#pragma once
/// A liggghts_host that listens on this machine, as one on another machine would, for one driver.
#include <sys/types.h>

#include <string>

namespace tuft::bench {

class ListeningHost {
 public:
  /// Starts it at a free port; its output is dropped. Throws RunError or std::runtime_error.
  ListeningHost();
  ~ListeningHost();  ///< waits for its end with its driver's, or ends it
  ListeningHost(const ListeningHost&) = delete;
  ListeningHost& operator=(const ListeningHost&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  std::string endpoint_;
  pid_t process_ = -1;
};

}  // namespace tuft::bench
