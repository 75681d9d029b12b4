#pragma once
/// Scenes that are stepped in turns, so that what the machine does meanwhile falls on all of them alike.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tuft::studies {

/// What a scene took for some intervals of its own time.
struct Stretch {
  double processor_s = 0;
  std::uint64_t windows = 0;
  std::uint64_t particle_steps = 0;  ///< kicks, where particles have steps of their own
  double push = 0;                   ///< N s, impulse of infill and carpet on the rig's bodies
  double motion = 0;                 ///< J, of bodies that move freely, at the end
  std::uint64_t intervals = 0;       ///< fewer than asked for: the scene has come to its end
};

/// A scene under way. Members throw RunError where a run would fail.
class SteppedScene {
 public:
  SteppedScene() = default;
  SteppedScene(const SteppedScene&) = delete;
  SteppedScene& operator=(const SteppedScene&) = delete;
  virtual ~SteppedScene() = default;
  virtual Stretch walk(std::uint64_t intervals) = 0;
  virtual void release() = 0;  ///< sets the rig in motion, once
  virtual void save(const std::filesystem::path& file) = 0;
  /// Goes on from what another has saved. Throws InputError or RunError where that does not fit.
  virtual void adopt(const std::filesystem::path& file) = 0;
};

struct Entrant {
  std::string name;
  bool adopts = false;  ///< may go on from the state of the first; else it needs a run-up of its own
  /// `adopting`: it will go on from a state that its own laws may not have led to. Throws InputError or
  /// RunError.
  std::function<std::unique_ptr<SteppedScene>(bool adopting)> build;
};

struct TurnProgress {
  enum class Stage { building, settling, run_up, turns } stage = Stage::building;
  std::string name;             ///< of what is being built or runs up
  std::size_t scenes = 0;       ///< entrants
  std::size_t done = 0;         ///< scenes that are ready, or turns
  std::uint64_t intervals = 0;  ///< of settling, or since the release
  double wall = 0, left = 0;    ///< s since the first scene was built, and at most to go
};

struct TurnRequest {
  /// The first is what the others are compared with: where it fails all does.
  std::vector<Entrant> entrants;
  /// Intervals of settling: at least so many, and more where time allows both them and all that follows.
  std::uint64_t settle_least = 0, settle_most = 0;
  std::uint64_t moving = 1;     ///< intervals after the release, at most
  std::filesystem::path state;  ///< file for the state from which all go on; overwritten
  /// s by `clock`, once the first scene is built. A turn is begun where the last one would have fitted.
  double seconds = 0;
  std::function<double()> clock;            ///< s of wall time
  const std::atomic<bool>* stop = nullptr;  ///< set: ends between two stretches
  std::function<void(const TurnProgress&)> on_progress;
};

struct TurnRecord {
  enum class End { whole, struck, out_of_time, stopped };
  End end = End::whole;
  /// Of each entrant, a stretch a turn; of one that failed those before.
  std::vector<std::vector<Stretch>> stretches;
  std::vector<std::string> failures;  ///< of each entrant; empty: none
  std::uint64_t settled = 0;          ///< intervals
  bool cut = false;                   ///< time for the run-up was over before the rig had been stopped
  std::uint64_t start = 0;            ///< intervals after the release, where the first turn begins
  std::uint64_t turn = 1;             ///< intervals in a turn

  [[nodiscard]] std::size_t turns() const { return stretches.empty() ? 0 : stretches.front().size(); }
};

/// The first entrant settles, is released and runs up to where its rig presses; from its state, or from a
/// run-up of their own, all step through the same time, a turn after another, in another order each (the same
/// in each call). An entrant that fails, or for whose run-up there is no time, is left out. Ends when the rig
/// lets go (End::struck). Throws what the first entrant throws.
[[nodiscard]] TurnRecord take_turns(const TurnRequest& request);

}  // namespace tuft::studies
