#pragma once
/// Conditioning as it runs: a plate comes down and is lifted, once or until the bed stays as low as asked, or
/// a roller passes; it is taken away, and rigid spheres give way to the continuum (docs/conditioning.md).
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coupler/build_simulation.h"
#include "coupler/conditioned_infill.h"
#include "coupler/roller.h"
#include "rigs/run.h"
#include "rigs/schedule.h"

namespace tuft::rigs {

/// Height of a plate that moves from `from` to `to` (m) in `intervals`, after `done` of them. Half a cosine:
/// its speed begins and ends at 0 and has no jump but those of intervals.
[[nodiscard]] double plate_height(double from, double to, std::uint64_t done, std::uint64_t intervals);

class Compaction {
 public:
  /// Of a simulation just built, its plate where it starts.
  Compaction(const Scene& scene, const Schedule& schedule, const coupler::BuiltSimulation& built);

  /// "pressing", "lifting", "rolling", "settling" of the interval that ends at `index`; empty once
  /// conditioning is over.
  [[nodiscard]] std::string stage(std::uint64_t index) const;
  /// What is due before the interval that begins at `index`: drives the plate, takes it away, switches the
  /// infill. Throws InputError, see coupler::take_over.
  void before_interval(std::uint64_t index, const std::vector<EffectDecision>& effects,
                       coupler::BuiltSimulation& built);
  /// Measures after the interval that ended at `index`.
  void after_interval(std::uint64_t index, const coupler::BuiltSimulation& built);
  /// Where the run goes on after the interval that ended at `index`: there, or where conditioning ends once
  /// the bed stays as low as asked. What would have been the time of presses that are not needed passes at
  /// once.
  [[nodiscard]] std::uint64_t next_index(std::uint64_t index) const;
  /// At the release of the rig: depths that conditioning and settling left.
  void note_release(const coupler::BuiltSimulation& built);

  /// Element steps of the carpet while conditioning, which its speed does not count.
  [[nodiscard]] std::uint64_t element_steps() const { return element_steps_; }
  /// Measures for the summary; those that are not known yet are left out.
  [[nodiscard]] std::map<std::string, Quantity> notes() const;

  void save(h5::Group& group) const;
  void load(const h5::Group& group);

 private:
  [[nodiscard]] std::vector<double> depths(const coupler::BuiltSimulation& built) const;
  void drive(std::uint64_t index, coupler::BuiltSimulation& built) const;
  void take_away(coupler::BuiltSimulation& built) const;
  void finish_press(const coupler::BuiltSimulation& built);
  [[nodiscard]] double placed_depth()
      const;  ///< m, above the backing: of grains as they lie, else as asked for
  [[nodiscard]] double wanted_depth() const;  ///< m, above the backing
  [[nodiscard]] double surface() const;       ///< m, height as placed
  [[nodiscard]] bool repeats() const { return !roller_ && schedule_.presses > 1; }

  const Scene* scene_;
  Schedule schedule_;
  std::optional<coupler::Roller> roller_;
  double start_ = 0, pressed_ = 0;  ///< m, heights of the plate's face: before, and of the press at hand
  std::uint64_t presses_ = 0;       ///< done
  double missing_ = 0;              ///< m, by which the bed stayed too high after the last of several presses
  bool stays_ = false;              ///< as low as asked, of several presses
  double plate_force_ = 0;          ///< N, on the plate over the last interval, upwards
  double largest_pressure_ = 0;     ///< Pa, mean under the plate
  std::vector<double> placed_, under_plate_, lifted_, switched_,
      released_;  ///< m, layer tops above the backing
  coupler::SwitchReport switch_;
  bool switched_over_ = false;
  double settled_speed_ = 0;  ///< m/s, of the fastest particle at the release
  std::uint64_t element_steps_ = 0;
};

}  // namespace tuft::rigs
