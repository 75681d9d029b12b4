#pragma once
/// Direct shear (after ASTM D3080): a box in two halves that meet without a gap; the upper plate bears a
/// constant load, the lower half is driven.
#include <array>
#include <optional>
#include <span>

#include "core/mohr_coulomb_line.h"
#include "rigs/specimen_test.h"

namespace tuft::rigs {

struct ShearRow {
  double time = 0;           ///< s since the test began, middle of the interval
  double shearing = 0;       ///< 0 while the normal load rises and is held, then 1
  double displacement = 0;   ///< m, of the lower half
  double shear_strain = 0;   ///< displacement over length or height, as the rig says
  double shear_stress = 0;   ///< Pa, force on the upper half over the box's area as built
  double normal_stress = 0;  ///< Pa, force of the specimen on the upper plate over that area
  double plane_stress = 0;   ///< Pa, vertical force that the plane of shearing carries, over that area
  double force_upper = 0;    ///< N, of the specimen on upper half and plate, along the displacement
  double force_lower = 0;    ///< N, on lower half and plate, against it
  double height_change = 0;  ///< m, of the upper plate since shearing began, upwards

  static constexpr std::size_t count = 10;
  [[nodiscard]] std::array<double, count> values() const;
  static ShearRow of(std::span<const double> values);
};

struct ShearResults {
  std::optional<double>
      yield_stress;         ///< Pa, mean over the last yield_window of strain before the yield strain
  double displacement = 0;  ///< m, mean over those rows
  std::optional<double> plane_stress;  ///< Pa, the mean vertical stress on the plane over the same rows
  double peak_stress = 0;              ///< Pa
  double strain_at_peak = 0;
  double height_change = 0;  ///< m, at the end
};

inline constexpr double yield_window = 0.005;

/// Pure evaluation of the rows of one test, in order of time.
[[nodiscard]] ShearResults evaluate_shear(std::span<const ShearRow> rows, double yield_strain);

class DirectShear final : public SpecimenTest {
 public:
  explicit DirectShear(const Scene& scene);

  [[nodiscard]] std::size_t tests() const override { return rig_.normal_stresses.size(); }
  [[nodiscard]] std::string label(std::size_t test) const override;
  [[nodiscard]] coupler::SpecimenRoom room() const override;
  [[nodiscard]] std::vector<coupler::RigidBody> bodies(std::size_t test,
                                                       const coupler::Specimen& specimen) const override;
  [[nodiscard]] double energy_scale(std::size_t test) const override;
  [[nodiscard]] double interval() const override;
  void begin(std::size_t test, const coupler::Simulation& simulation) override;
  void drive(coupler::Simulation& simulation) override;
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

  [[nodiscard]] const std::vector<ShearRow>& rows(std::size_t test) const { return rows_.at(test); }

 private:
  [[nodiscard]] double area() const { return rig_.size[0] * rig_.size[1]; }
  [[nodiscard]] double strain_length() const;  ///< m
  [[nodiscard]] std::size_t loading_rows() const;

  SpecimenRig rig_;
  std::vector<std::vector<ShearRow>> rows_;  ///< by test
  std::size_t test_ = 0;
  double density_ = 0;           ///< kg/m^3, as placed
  std::vector<double> modulus_;  ///< Pa, constrained, by test: what the guides of the plate damp
  double plate_mass_ = 0;        ///< kg
  double displacement_ = 0, height_ = 0,
         start_height_ = 0;  ///< m, at the end of the last interval; at shearing
  double speed_ = 0;         ///< m/s
};

}  // namespace tuft::rigs
