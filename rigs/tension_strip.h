#pragma once
/// A strip of carpet material between two grips, drawn at constant speed.
#include <vector>

#include "core/scene.h"
#include "coupler/energy_ledger.h"
#include "fe_carpet/carpet.h"
#include "rigs/tension_results.h"

namespace tuft::rigs {

/// The strip of one test of a tension rig: along x from the held grip at 0, one row of nodes in each grip.
struct StripMesh {
  fe::ShellMesh mesh;
  std::vector<std::size_t> held, driven;                              ///< nodes in the grips
  double gauge_length = 0, width = 0, thickness = 0;                  ///< m
  [[nodiscard]] double section() const { return width * thickness; }  ///< m^2, as cut
};
[[nodiscard]] StripMesh make_strip_mesh(const Scene& scene, std::size_t test);

/// One test, from the strip at rest between its grips (its points already at the speeds of uniform extension,
/// so that no wave is sent through it) to the strain limit.
class TensionStrip {
 public:
  TensionStrip(const Scene& scene, std::size_t test);

  /// To the next row: a share 1 / rig.samples of the strain limit. Throws RunError from the carpet.
  void advance();
  [[nodiscard]] TensionRow row() const;
  [[nodiscard]] coupler::EnergyTerms energy_terms() const;
  /// Relative: impulse of the grips less the strip's change of momentum, over all impulse exchanged.
  [[nodiscard]] double momentum_error() const;
  [[nodiscard]] const fe::Carpet& carpet() const { return carpet_; }
  [[nodiscard]] double rate() const { return rate_; }          ///< 1/s
  [[nodiscard]] double interval() const { return interval_; }  ///< s between rows
  [[nodiscard]] double step() const { return step_; }          ///< s, last one taken, or the first to be
  [[nodiscard]] std::uint64_t steps() const { return steps_; }
  [[nodiscard]] std::uint64_t steps_a_row() const;  ///< at present

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  [[nodiscard]] Vec3 momentum() const;

  StripMesh strip_;
  double rate_, interval_, step_safety_, step_ = 0;
  fe::Carpet carpet_;
  Vec3Array no_load_;
  Vec3 first_momentum_{0, 0, 0};
  std::uint64_t rows_ = 0, steps_ = 0;
};

/// Largest principal logarithmic strain at the middle of any shell that has not failed, from where its nodes
/// were as built and at the last force evaluation.
[[nodiscard]] double largest_principal_strain(const fe::Carpet& carpet);

}  // namespace tuft::rigs
