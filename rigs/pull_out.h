#pragma once
/// Pull-out: a strand of the carpet in infill between two platens, which are pressed together and then held
/// (a screw), is drawn out at constant speed. Friction on both faces: F = 2 mu sigma w L.
#include <array>
#include <optional>
#include <span>

#include "rigs/pull_out_strand.h"
#include "rigs/specimen_test.h"

namespace tuft::rigs {

struct PullRow {
  double time = 0;           ///< s since the test began, middle of the interval
  double phase = 0;          ///< 0 pressing, 1 held, 2 drawing
  double displacement = 0;   ///< m, of the grip
  double force = 0;          ///< N, of the grip on the strand
  double normal_stress = 0;  ///< Pa, mean force on both platens over their area
  double pressure = 0;  ///< Pa, normal forces on the strand over both faces of what is embedded, at the end
  double closed = 0;    ///< m, by which the platens have come together

  static constexpr std::size_t count = 7;
  [[nodiscard]] std::array<double, count> values() const;
  static PullRow of(std::span<const double> values);
};

struct PullResults {
  double peak_force = 0;            ///< N
  double displacement_at_peak = 0;  ///< m
  /// Means over the second half of the travel; empty before its end.
  std::optional<double> steady_force, normal_stress, pressure;  ///< N, Pa, Pa
  std::optional<double> over_platens;  ///< F over 2 mu sigma w L, sigma the platens' stress
  std::optional<double> over_strand;   ///< the same with the pressure on the strand
};

/// mu, w (m) and L of a test; L by displacement.
struct StripFriction {
  double friction = 0, width = 0;
  SpecimenRig rig;
};

/// Pure evaluation of the rows of one test, in order of time.
[[nodiscard]] PullResults evaluate_pull(std::span<const PullRow> rows, const StripFriction& strip);

class PullOut final : public SpecimenTest {
 public:
  explicit PullOut(const Scene& scene);

  [[nodiscard]] std::size_t tests() const override { return rig_.speeds.size(); }
  [[nodiscard]] std::string label(std::size_t test) const override;
  [[nodiscard]] coupler::SpecimenRoom room() const override;
  [[nodiscard]] std::optional<coupler::SpecimenStrand> strand() const override { return strand_; }
  void adjust(Scene& scene, std::size_t test) const override;
  [[nodiscard]] std::vector<coupler::RigidBody> bodies(std::size_t test,
                                                       const coupler::Specimen& specimen) const override;
  [[nodiscard]] double energy_scale(std::size_t test) const override;
  [[nodiscard]] double interval() const override;
  void begin(std::size_t test, const coupler::Simulation& simulation) override;
  void drive(coupler::Simulation& simulation) override;
  /// Throws RunError when the platens have closed by most of the height and the stress is not reached.
  void sample(const coupler::Simulation& simulation) override;
  [[nodiscard]] bool done() const override;
  [[nodiscard]] double share_done() const override;
  [[nodiscard]] std::string stage() const override;
  [[nodiscard]] std::vector<HistoryColumn> columns() const override;
  [[nodiscard]] std::vector<double> row() const override;
  void add_results(std::map<std::string, Quantity>& results,
                   std::map<std::string, Quantity>& notes) const override;
  [[nodiscard]] std::map<std::string, Quantity> result_names() const override;
  [[nodiscard]] std::vector<SpecimenCurve> curves() const override;
  [[nodiscard]] std::vector<SpecimenCurve> curve_names() const override;
  void save(h5::Group& group) const override;
  void load(const h5::Group& group) override;

  [[nodiscard]] const std::vector<PullRow>& rows(std::size_t test) const { return rows_.at(test); }
  [[nodiscard]] StripFriction strip(std::size_t test) const;

 private:
  [[nodiscard]] double area() const { return rig_.size[0] * rig_.size[1]; }
  [[nodiscard]] double run_speed(std::size_t test) const;  ///< m/s
  [[nodiscard]] std::string prefix(std::size_t test) const;
  [[nodiscard]] std::size_t held_rows() const;

  SpecimenRig rig_;
  coupler::SpecimenStrand strand_;
  double strand_width_ = 0;       ///< m
  double closing_ = 0;            ///< m/s, of each platen at most
  std::vector<double> friction_;  ///< by test
  std::vector<std::vector<PullRow>> rows_;
  std::size_t test_ = 0;
  std::size_t held_ = 0;                      ///< rows since the platens were stopped
  bool pressed_ = false;                      ///< the stress was reached
  double grip_speed_ = 0, platen_speed_ = 0;  ///< m/s
  double displacement_ = 0;                   ///< m, of the grip at the end of the last interval
  double grip_impulse_ = 0;                   ///< N s, given until then
  double start_gap_ = 0;                      ///< m, between the platens
};

}  // namespace tuft::rigs
