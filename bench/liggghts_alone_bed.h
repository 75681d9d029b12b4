#pragma once
/// A bed of grains in a square tray moved by LIGGGHTS alone: its gravity, its walls, no bridge.
#include <cstdio>
#include <string>
#include <vector>

#include "core/materials.h"
#include "dem_bridge/dem_infill.h"

namespace tuft::bench {

struct Seconds {
  double wall = 0, processor = 0;
};

class LiggghtsAloneBed {
 public:
  /// Grains of one material at rest between walls at +-half_width and above a floor at 0, m. Springs along
  /// contacts begin unstretched. Throws std::runtime_error when the program cannot be started.
  LiggghtsAloneBed(const dem::Grains& grains, const Material& material, const dem::DemSettings& settings,
                   double half_width, double step);
  ~LiggghtsAloneBed();
  LiggghtsAloneBed(const LiggghtsAloneBed&) = delete;
  LiggghtsAloneBed& operator=(const LiggghtsAloneBed&) = delete;

  /// What the steps took in LIGGGHTS' process.
  Seconds advance(int steps);
  /// `steps` of them slowed by a force of -rate x velocity, kg/s.
  void settle(int steps, double rate);

 private:
  Seconds command(const std::string& line);

  std::string folder_;
  std::FILE* commands_ = nullptr;
  std::FILE* answers_ = nullptr;
  int process_ = -1;
};

}  // namespace tuft::bench
