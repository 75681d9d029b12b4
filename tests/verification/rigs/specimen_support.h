#pragma once
/// Specimens of infill driven without a run's folder, and the law of a material point in one-dimensional
/// compression.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/scene.h"
#include "rigs/specimen_test.h"

namespace tuft::rigs::test {

/// Runs one test of a rig to its end, or until `enough` says so. Returns the largest energy error.
template <class Rig>
double run_test(const Scene& scene, Rig& rig, std::size_t test, const std::function<bool()>& enough = {}) {
  const auto simulation = build_specimen_test(scene, rig, test);
  rig.begin(test, *simulation);
  while (!rig.done() && !(enough && enough())) {
    rig.drive(*simulation);
    simulation->advance_interval(rig.interval());
    rig.sample(*simulation);
  }
  return simulation->ledger().largest_error();
}

/// One point of the soil law in uniaxial strain, integrated here from its equations (docs/theory/sph.md):
/// pressure along the table on first loading, dp = K de else; axial deviator ds = 4/3 G de, |s| <= 2/sqrt(3)
/// sqrt(a0 + a1 p + a2 p^2).
class UniaxialPoint {
 public:
  explicit UniaxialPoint(const SoilFoamMaterial& material) : m_(material) {}

  /// To the compressive logarithmic strain e.
  void move_to(double e) {
    constexpr double longest = 2e-6;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(e - e_) / longest)));
    const double de = (e - e_) / steps;
    for (int i = 0; i < steps; ++i) step(de);
  }
  [[nodiscard]] double stress() const { return p_ + s_; }  ///< Pa, axial
  [[nodiscard]] double pressure() const { return p_; }

 private:
  static double at(const Curve& c, double x) {
    const auto k =
        static_cast<std::size_t>(std::clamp(std::upper_bound(c.x.begin(), c.x.end(), x) - c.x.begin(),
                                            std::ptrdiff_t{1}, static_cast<std::ptrdiff_t>(c.x.size()) - 1));
    return c.y[k - 1] + (c.y[k] - c.y[k - 1]) * (x - c.x[k - 1]) / (c.x[k] - c.x[k - 1]);
  }
  void step(double de) {
    const double modulus = at(m_.unloading, std::max(0.0, p_));
    const double before = p_;
    e_ += de;
    p_ = std::min(p_ + modulus * de, at(m_.pressure, std::max(0.0, e_)));
    s_ += 4.0 / 3 * m_.shear_ratio * at(m_.unloading, std::max(0.0, 0.5 * (before + p_))) * de;
    const double limit =
        2 / std::sqrt(3.0) * std::sqrt(m_.yield_a0 + m_.yield_a1 * p_ + m_.yield_a2 * p_ * p_);
    s_ = std::clamp(s_, -limit, limit);
  }

  SoilFoamMaterial m_;
  double e_ = 0, p_ = 0, s_ = 0;
};

}  // namespace tuft::rigs::test
