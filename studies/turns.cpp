#include "studies/turns.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/error.h"

namespace tuft::studies {
namespace {

constexpr std::uint64_t turns_of_motion = 50;     ///< at least so many make up all that follows the release
constexpr double turns_in_time = 20;              ///< and so many fit the time, where a turn may be shorter
constexpr std::uint64_t looks_at_the_clock = 10;  ///< while settling
constexpr std::size_t turns_of_blow = 6;          ///< fewer do not bound a median
constexpr std::size_t idle_turns = 2;             ///< without a push, after which a blow is over
constexpr double pressed_share = 0.5;             ///< of the greatest push, from which on it is a blow
constexpr double motion_left = 0.25;  ///< share of its energy, at which the rig is all but stopped
// Of the time: for all that a run of the first would take, if it is to settle in full; for its run-up at
// most; and, of what that leaves, for run-ups of others.
constexpr double full_share = 0.3, run_up_share = 0.5, others_share = 0.5;
constexpr std::uint64_t warming = 1;  ///< intervals after a state is taken up: lists are built

class Turns {
 public:
  explicit Turns(const TurnRequest& request) : request_(request) {
    record_.stretches.resize(request.entrants.size());
    record_.failures.resize(request.entrants.size());
    scenes_.resize(request.entrants.size());
  }

  TurnRecord run() {
    if (run_up_first() && ready_others()) move();
    return std::move(record_);
  }

 private:
  [[nodiscard]] double wall() const { return request_.clock() - start_; }
  [[nodiscard]] double left() const { return request_.seconds - wall(); }
  [[nodiscard]] bool stopped() {
    if (request_.stop == nullptr || !*request_.stop) return false;
    record_.end = TurnRecord::End::stopped;
    return true;
  }
  [[nodiscard]] bool out_of_time(double needed) {
    if (left() >= needed) return false;
    record_.end = TurnRecord::End::out_of_time;
    return true;
  }
  void report(TurnProgress::Stage stage, std::size_t done, std::uint64_t intervals,
              const std::string& name = {}) {
    if (request_.on_progress)
      request_.on_progress({stage, name, scenes_.size(), done, intervals, wall(), std::max(0.0, left())});
  }

  /// Does something with an entrant; what it throws takes the entrant out, unless it is the first.
  template <class Work>
  void attempt(std::size_t e, Work&& work) {
    if (!record_.failures[e].empty()) return;
    const auto fail = [&](const std::exception& error) {
      record_.failures[e] = error.what();
      scenes_[e].reset();
    };
    try {
      work();
    } catch (const InputError& error) {
      if (e == 0) throw;
      fail(error);
    } catch (const RunError& error) {
      if (e == 0) throw;
      fail(error);
    }
  }

  void build(std::size_t e, bool adopting) {
    report(TurnProgress::Stage::building, e, 0, request_.entrants[e].name);
    scenes_[e] = request_.entrants[e].build(adopting);
  }

  /// Whether it came to its end.
  bool settle_first(std::uint64_t intervals) {
    const std::uint64_t end = record_.settled + intervals,
                        chunk = std::max<std::uint64_t>(1, intervals / looks_at_the_clock);
    while (record_.settled < end) {
      if (stopped() || out_of_time(0)) return false;
      const std::uint64_t now = std::min(chunk, end - record_.settled);
      scenes_[0]->walk(now);
      record_.settled += now;
      report(TurnProgress::Stage::settling, 0, record_.settled);
    }
    return true;
  }

  /// What the first takes to build (grains are packed) is what any run of the scene takes, and counts not.
  bool run_up_first() {
    start_ = request_.clock();
    build(0, false);
    start_ = request_.clock();
    if (!settle_first(request_.settle_least)) return false;
    if (record_.settled > 0) {
      each_ = wall() / static_cast<double>(record_.settled);
      const std::uint64_t further = request_.settle_most - std::min(request_.settle_most, record_.settled);
      const double spare =
          (full_share * request_.seconds - wall()) / each_ - static_cast<double>(request_.moving);
      if (!settle_first(std::min(further, static_cast<std::uint64_t>(std::max(0.0, spare))))) return false;
    }
    scenes_[0]->release();
    return find_blow();
  }

  /// Intervals of a turn, so that enough fit `seconds`; `each`: s that one takes.
  [[nodiscard]] std::uint64_t turn_in(double seconds, double each) const {
    const auto longest = static_cast<double>(std::max<std::uint64_t>(1, request_.moving / turns_of_motion));
    const double fitting = each > 0 ? std::floor(seconds / (each * turns_in_time)) : longest;
    return static_cast<std::uint64_t>(std::clamp(fitting, 1.0, longest));
  }

  /// Leaves the state in which the rig begins to press hard in request.state: the earliest of those kept, for
  /// how hard it will press is known afterwards only.
  bool find_blow() {
    const std::uint64_t chunk = turn_in(run_up_share * request_.seconds, each_);
    double most = 0, fastest = 0, kept = 0;
    std::uint64_t done = 0;
    const auto keep = [&](double push) {
      scenes_[0]->save(request_.state);
      kept = push;
      record_.start = done;
      run_up_ = wall();
    };
    while (done + 2 * chunk <= request_.moving && wall() < run_up_share * request_.seconds) {
      if (stopped()) return false;
      const Stretch s = scenes_[0]->walk(chunk);
      if (s.intervals < chunk) break;
      done += chunk;
      report(TurnProgress::Stage::run_up, 0, done, request_.entrants[0].name);
      most = std::max(most, s.push);
      fastest = std::max(fastest, s.motion);
      if (most > 0 && kept < pressed_share * most && s.push >= pressed_share * most) keep(s.push);
      // It has been stopped: what presses on it was greatest about now.
      if (s.motion < motion_left * fastest) break;
    }
    // The last state is then the nearest to what was not reached.
    record_.cut = fastest > 0 && wall() >= run_up_share * request_.seconds;
    if (kept == 0 || record_.cut) keep(kept);
    each_ = run_up_ / static_cast<double>(std::max<std::uint64_t>(1, record_.settled + record_.start));
    return true;
  }

  bool ready_others() {
    double spare = others_share * left();
    for (std::size_t e = 0; e < scenes_.size(); ++e) {
      if (stopped()) return false;
      attempt(e, [&] {
        if (!adopts(e)) {
          build(e, false);
          spare -= run_up(e, spare);
        }
        scenes_[e]->walk(warming);
      });
    }
    record_.start += warming;
    return !stopped();
  }

  /// Takes up the state of the first, if it may and the state fits. So does the first, which went on.
  bool adopts(std::size_t e) {
    if (e > 0 && !request_.entrants[e].adopts) return false;
    try {
      build(e, true);
      scenes_[e]->adopt(request_.state);
      return true;
    } catch (const InputError&) {
      if (e == 0) throw;
    } catch (const RunError&) {
      if (e == 0) throw;
    }
    return false;
  }

  /// s of wall time that it took. A scene with an effect may be so much slower than the one without that it
  /// would take all there is.
  double run_up(std::size_t e, double spare) {
    const double before = wall();
    const auto check = [&](double needed) {
      if (needed > spare && !stopped())
        throw_run_error(
            "it needs a run-up of its own, of {:.0f} s or more, for which there was no time: give more with "
            "--cost-seconds, or look at it alone with --only",
            std::ceil(std::max(run_up_, needed)));
    };
    const std::uint64_t all = record_.settled + record_.start;
    const std::uint64_t chunk = std::max<std::uint64_t>(1, all / looks_at_the_clock);
    check(run_up_);
    for (std::uint64_t done = 0; done < all && !stopped();) {
      if (done == record_.settled) scenes_[e]->release();
      const std::uint64_t end = done < record_.settled ? record_.settled : all,
                          now = std::min(chunk, end - done);
      scenes_[e]->walk(now);
      done += now;
      report(TurnProgress::Stage::run_up, e, 0, request_.entrants[e].name);
      check((wall() - before) * static_cast<double>(all) / static_cast<double>(done));
    }
    if (record_.start == 0) scenes_[e]->release();
    return wall() - before;
  }

  void move() {
    const auto scenes = std::ranges::count_if(scenes_, [](const auto& scene) { return scene != nullptr; });
    record_.turn = turn_in(left(), each_ * static_cast<double>(scenes));
    double last = 0;
    for (std::uint64_t done = record_.start; done + record_.turn <= request_.moving; done += record_.turn) {
      const double before = request_.clock();
      if (stopped() || out_of_time(last)) return;
      if (!take_turn()) return;
      last = request_.clock() - before;
      report(TurnProgress::Stage::turns, record_.turns(), done + record_.turn);
      if (is_blow_over()) {
        record_.end = TurnRecord::End::struck;
        return;
      }
    }
  }

  /// False: it was broken off, or the first scene is at its end; what it held so far is forgotten.
  bool take_turn() {
    const std::size_t count = scenes_.size();
    std::vector<Stretch> taken(count);
    bool whole = true;
    shuffle();
    for (std::size_t k = 0; k < count && whole; ++k) {
      const std::size_t e = order_[k];
      attempt(e, [&] { taken[e] = scenes_[e]->walk(record_.turn); });
      whole = !stopped() && (e != 0 || taken[e].intervals == record_.turn);
    }
    if (!whole) return false;
    for (std::size_t e = 0; e < count; ++e)
      if (record_.failures[e].empty()) record_.stretches[e].push_back(taken[e]);
    return true;
  }

  /// Another order in each turn, so that what the machine does falls on all alike, and none twice in a row:
  /// it would find its own state in the caches.
  void shuffle() {
    if (order_.empty()) {
      order_.resize(scenes_.size());
      std::iota(order_.begin(), order_.end(), std::size_t{0});
    }
    const std::size_t last = order_.back();
    for (std::size_t k = order_.size() - 1; k > 0; --k) std::swap(order_[k], order_[random_() % (k + 1)]);
    if (order_.front() == last) std::swap(order_.front(), order_.back());
  }

  [[nodiscard]] bool is_blow_over() const {
    const std::vector<Stretch>& first = record_.stretches.front();
    const auto pushes = [](const Stretch& s) { return s.push > 0; };
    if (static_cast<std::size_t>(std::ranges::count_if(first, pushes)) < turns_of_blow) return false;
    return std::none_of(first.end() - static_cast<std::ptrdiff_t>(std::min(idle_turns, first.size())),
                        first.end(), pushes);
  }

  const TurnRequest& request_;
  TurnRecord record_;
  std::vector<std::unique_ptr<SteppedScene>> scenes_;
  std::vector<std::size_t> order_;
  std::mt19937 random_{1};
  double start_ = 0;
  double each_ = 0;    ///< s of wall time that the first takes for an interval
  double run_up_ = 0;  ///< s of it, from the start to the state that was kept
};

}  // namespace

TurnRecord take_turns(const TurnRequest& request) {
  return Turns(request).run();
}

}  // namespace tuft::studies
