#pragma once
/// A studded cylinder that rolls over the patch (docs/conditioning.md): the bodies it is made of, and where
/// they are.
///
/// Nothing rubs on it, so that a body that turns and one that does not press alike: it is made of bodies that
/// only move, the cylinder along x and each stud's round tip on its cycloid. The studs' shafts are left out.
#include <vector>

#include "core/scene.h"
#include "coupler/rigid_body.h"

namespace tuft::coupler {

class Roller {
 public:
  explicit Roller(const Scene& scene);
  /// surface: m, height of the infill's surface where it is not as deep as the scene has it.
  Roller(const Scene& scene, double surface);

  /// The cylinder, then the studs, where they stand before the first pass. All are driven.
  [[nodiscard]] std::vector<RigidBody> bodies() const;
  [[nodiscard]] std::size_t size() const { return 1 + studs_.size(); }
  /// Of body k, after a share of a pass (counted from 0), m. Even passes go to +x. Before and after each the
  /// roller is beside the patch; there it comes down to its height for the next, the last of which has the
  /// cylinder conditioning.depth below the surface as placed.
  [[nodiscard]] Vec3 place(std::size_t k, int pass, double share) const;
  /// s, of one pass.
  [[nodiscard]] double pass_time() const;

 private:
  struct Stud {
    double angle = 0;  ///< rad from straight down, where the axis is above the middle of the patch
    double y = 0;      ///< m
  };

  ConditioningRoller shape_;
  double half_way_ = 0;             ///< m, the axis goes from -half_way_ to half_way_
  double surface_ = 0, depth_ = 0;  ///< m
  std::vector<Stud> studs_;
};

}  // namespace tuft::coupler
