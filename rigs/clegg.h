#pragma once
/// Clegg impact tester: a flat-ended rigid cylinder guided vertically, falling free on the turf.
#include <optional>
#include <vector>

#include "rigs/rig.h"

namespace tuft::rigs {

/// One drop as measured: equal intervals since release.
struct DropRecord {
  double interval = 0;               ///< s between samples
  std::vector<double> acceleration;  ///< m/s^2, upward: mean contact force over the interval / mass (what an
                                     ///< accelerometer reads, 0 in free fall)
  std::vector<double> velocity;      ///< m/s, upward, at the sample's end
  std::vector<double> height;        ///< m, lower face, at the sample's end
};

/// When the missile touches: where its force first passes touch_force on the way to the largest force so far,
/// staying over it. Strands that a falling missile buckles, and a single grain that stands out, may press as
/// hard for a moment, some mm above the infill; what counts is the contact that stops it.
class TouchClock {
 public:
  explicit TouchClock(double touch_force) : touch_force_(touch_force) {}
  void sample(double force);  ///< N, one after the other
  [[nodiscard]] bool touched() const { return touch_.has_value(); }
  /// Which sample was the first over touch_force. touched() only.
  [[nodiscard]] std::size_t touch() const { return *touch_; }

 private:
  double touch_force_, largest_ = 0;
  std::size_t samples_ = 0;
  std::optional<std::size_t> candidate_, touch_;  ///< since when the force is over touch_force; see touch()
};

struct DropResults {
  bool touched = false, separated = false;
  double touch_time = 0;    ///< s since release, see TouchClock
  double peak_g = 0;        ///< of the filtered acceleration, in standard gravity (9.80665 m/s^2)
  double time_of_peak = 0;  ///< s since touch
  double rebound_velocity =
      0;  ///< m/s, upward, at separation (last force under touch_force after the deepest point);
          ///< without separation: the highest upward velocity after the deepest point, at least 0
  double max_penetration = 0;  ///< m, depth of the lower face under its place at touch
  double pulse_duration = 0;   ///< s, around the peak, filtered acceleration above a tenth of it (or to the
                               ///< record's ends)
  double contact_time = 0;     ///< s, touch to separation (or to the end)
  double impact_velocity = 0;  ///< m/s, downward, at touch
};

/// Pure evaluation of a record. `filtered` is the filtered acceleration, as long as the record.
[[nodiscard]] DropResults evaluate_drop(const DropRecord& record, const std::vector<double>& filtered,
                                        double mass, double touch_force);

class CleggTester final : public Rig {
 public:
  explicit CleggTester(const CleggRig& settings, double gravity)
      : settings_(settings), gravity_(gravity), clock_(settings.touch_force) {}

  [[nodiscard]] std::vector<coupler::RigidBody> bodies() const override;
  void set_first_body(std::size_t index) override { body_ = index; }
  [[nodiscard]] double energy_scale() const override;
  void release(coupler::Simulation& simulation) override;
  void sample(const coupler::Simulation& simulation, double time, double interval) override;
  [[nodiscard]] std::vector<HistoryColumn> columns() const override;
  [[nodiscard]] std::vector<double> row() const override;
  [[nodiscard]] std::vector<FinishedColumn> finished_columns() const override;
  [[nodiscard]] std::map<std::string, Quantity> results() const override;
  void save(h5::Group& group) const override;
  void load(const h5::Group& group) override;

 private:
  [[nodiscard]] std::vector<double> filtered() const;
  /// m below the place at touch, which only the whole drop tells (TouchClock); 0 before it.
  [[nodiscard]] std::vector<double> penetration() const;
  CleggRig settings_;
  double gravity_;
  std::size_t body_ = 0;
  std::size_t samples_before_release_ = 0;
  TouchClock clock_;
  DropRecord record_;
};

}  // namespace tuft::rigs
