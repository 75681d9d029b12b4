#pragma once
/// A test of infill between rigid walls: what oedometer, direct shear box and pull-out are to the run that
/// drives them.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene.h"
#include "coupler/simulation.h"
#include "coupler/specimen.h"
#include "rigs/rig.h"

namespace tuft::rigs {

/// A curve as an experimenter would draw it: "preload_1500_cycle_1_loading".
struct SpecimenCurve {
  std::string name;
  std::string x_unit, y_unit;
  std::string x_label, y_label;  ///< in words
  std::vector<double> x, y;
};

/// One rig with all its tests, which follow one another, each with a fresh specimen. Rows are measured at
/// equal intervals; forces are means over an interval, travel is that of its middle.
class SpecimenTest {
 public:
  SpecimenTest() = default;
  SpecimenTest(const SpecimenTest&) = delete;
  SpecimenTest& operator=(const SpecimenTest&) = delete;
  virtual ~SpecimenTest() = default;

  [[nodiscard]] virtual std::size_t tests() const = 0;
  [[nodiscard]] virtual std::string label(std::size_t test) const = 0;  ///< "1500 N"
  [[nodiscard]] virtual coupler::SpecimenRoom room() const = 0;
  /// What the specimen is placed around; empty: nothing.
  [[nodiscard]] virtual std::optional<coupler::SpecimenStrand> strand() const { return std::nullopt; }
  /// What of the scene's laws a test takes otherwise than as given: the specimen is placed before.
  virtual void adjust(Scene&, std::size_t) const {}
  /// What holds a specimen that fills the room.
  [[nodiscard]] virtual std::vector<coupler::RigidBody> bodies(std::size_t test,
                                                               const coupler::Specimen& specimen) const = 0;
  [[nodiscard]] virtual double energy_scale(
      std::size_t test) const = 0;                    ///< J, a small share of the work to be done
  [[nodiscard]] virtual double interval() const = 0;  ///< s between rows

  /// A fresh specimen stands between its bodies.
  virtual void begin(std::size_t test, const coupler::Simulation& simulation) = 0;
  /// Sets speeds and loads for the interval that comes.
  virtual void drive(coupler::Simulation& simulation) = 0;
  /// Measures the interval that was. Throws RunError for a test that cannot come to its end.
  virtual void sample(const coupler::Simulation& simulation) = 0;
  [[nodiscard]] virtual bool done() const = 0;          ///< the test at hand
  [[nodiscard]] virtual double share_done() const = 0;  ///< [0, 1], of the test at hand, estimated
  [[nodiscard]] virtual std::string stage() const = 0;  ///< "loading 2"
  [[nodiscard]] virtual std::vector<HistoryColumn> columns() const = 0;
  [[nodiscard]] virtual std::vector<double> row() const = 0;  ///< the last one measured

  /// Results and measures of quality of all tests as far as they went.
  virtual void add_results(std::map<std::string, Quantity>& results,
                           std::map<std::string, Quantity>& notes) const = 0;

  /// Names and units of the results that add_results gives of tests that went to their end; values are 0.
  [[nodiscard]] virtual std::map<std::string, Quantity> result_names() const = 0;
  /// Stress against strain of all tests as far as they went, named as `curve_names`.
  [[nodiscard]] virtual std::vector<SpecimenCurve> curves() const = 0;
  /// Names and units of the curves of tests that went to their end, without points.
  [[nodiscard]] virtual std::vector<SpecimenCurve> curve_names() const = 0;

  /// Rows of all tests, and where the test at hand stands. `load` follows `begin` of that test.
  virtual void save(h5::Group& group) const = 0;
  virtual void load(const h5::Group& group) = 0;
};

/// Of a scene whose rig.is_specimen().
[[nodiscard]] std::unique_ptr<SpecimenTest> make_specimen_test(const Scene& scene);

/// A fresh specimen between the bodies of a test. packing, where asked for: how its grains came to rest;
/// empty for a continuum.
[[nodiscard]] std::unique_ptr<coupler::Simulation> build_specimen_test(
    const Scene& scene, const SpecimenTest& rig, std::size_t test,
    std::optional<coupler::PackingReport>* packing = nullptr);

/// Force of the specimen on a body over the last interval, N.
[[nodiscard]] inline Vec3 mean_force(const coupler::Simulation& simulation, std::size_t body,
                                     double interval) {
  return simulation.interval_impulse()[body] / interval;
}

inline constexpr double standard_weight = 9.81;  ///< m/s^2, the gravity of the simulation

/// Speeds of the plate or box: a change from one interval to the next is at most this share of the full
/// speed, so that no wave is sent through the specimen.
inline constexpr double speed_step = 0.05;

}  // namespace tuft::rigs
