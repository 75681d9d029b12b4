#pragma once
/// One-dimensional compression in a ring (after ASTM D2435): the upper plate is driven down at constant speed
/// to a preload, back until it is unloaded, and so on.
#include <array>
#include <optional>
#include <span>

#include "rigs/specimen_test.h"

namespace tuft::rigs {

struct OedometerRow {
  double time = 0;           ///< s since the test began, middle of the interval
  double cycle = 1;          ///< from 1
  double direction = 1;      ///< 1 loading, -1 unloading
  double travel = 0;         ///< m, of the plate, downwards
  double compression = 0;    ///< m, travel less what the contacts of both plates give way
  double strain = 0;         ///< compression over the specimen's height
  double stress = 0;         ///< Pa, force over the ring's area
  double force = 0;          ///< N, of the specimen on the upper plate
  double force_below = 0;    ///< N, on the lower plate
  double force_ring = 0;     ///< N, on the ring, downwards: friction
  double inertia_force = 0;  ///< N, what the forces on the specimen and its weight do not balance

  static constexpr std::size_t count = 11;
  [[nodiscard]] std::array<double, count> values() const;
  static OedometerRow of(std::span<const double> values);
};

/// Of one cycle. Moduli are secants between 10 % and 90 % of the cycle's largest stress; empty where a branch
/// does not pass both.
struct CycleResults {
  std::optional<double> loading_modulus, unloading_modulus;  ///< Pa
  double peak_force = 0;                                     ///< N
  double peak_strain = 0;
  std::optional<double> residual_strain;  ///< at the end of unloading
  std::optional<double> loss;             ///< share of the loading's work that unloading does not give back
};

/// Pure evaluation of the rows of one cycle, in order of time. Unloading that did not come to its end within
/// `seating_force` (N) gives no residual strain and no loss.
[[nodiscard]] CycleResults evaluate_cycle(std::span<const OedometerRow> rows, double seating_force);

/// Secant modulus between two stresses on the way up, Pa; empty where they are not passed.
[[nodiscard]] std::optional<double> loading_secant(std::span<const OedometerRow> rows, double low,
                                                   double high);

class Oedometer final : public SpecimenTest {
 public:
  explicit Oedometer(const Scene& scene);

  [[nodiscard]] std::size_t tests() const override { return rig_.preloads.size(); }
  [[nodiscard]] std::string label(std::size_t test) const override;
  [[nodiscard]] coupler::SpecimenRoom room() const override;
  [[nodiscard]] std::vector<coupler::RigidBody> bodies(std::size_t test,
                                                       const coupler::Specimen& specimen) const override;
  [[nodiscard]] double energy_scale(std::size_t test) const override;
  [[nodiscard]] double interval() const override;
  void begin(std::size_t test, const coupler::Simulation& simulation) override;
  void drive(coupler::Simulation& simulation) override;
  void sample(const coupler::Simulation& simulation) override;
  [[nodiscard]] bool done() const override { return cycle_ > rig_.cycles; }
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

  [[nodiscard]] const std::vector<OedometerRow>& rows(std::size_t test) const { return rows_.at(test); }

 private:
  enum Body : std::size_t { lower_plate, upper_plate, ring };
  [[nodiscard]] double area() const;

  SpecimenRig rig_;
  bool of_grains_;
  std::vector<std::vector<OedometerRow>> rows_;  ///< by test
  std::size_t test_ = 0;
  double give_below_ = 0, give_above_ = 0;  ///< m/N, of the contacts of each plate
  double weight_ = 0;                       ///< N
  /// The height (m) is that as placed of a continuum, that under the plate as it first bears the seating
  /// force of grains: how high these stand is theirs to say. Travel counts from start_height_ (m, plate).
  bool seated_ = true;
  double height_ = 0, start_height_ = 0;
  double placed_height_ = 0;             ///< m, plate before the test
  std::vector<double> expected_travel_;  ///< m, by test, to the preload, of grains: a rough estimate
  double height_before_ = 0;             ///< m, plate at the end of the last interval
  double speed_ = 0;                     ///< m/s, downwards, of the last interval
  int cycle_ = 1;
  bool loading_ = true;
};

}  // namespace tuft::rigs
