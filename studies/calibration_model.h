#pragma once
/// What a calibration runs: a test of a material point, or a rig that tests infill alone. Targets and the
/// search see both through one interface.
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/scene_files.h"
#include "core/scene_reader.h"

namespace tuft::studies {

/// Points of y over x, in the units given.
struct ModelCurve {
  std::string name, x_unit, y_unit;
  std::string x_label, y_label;  ///< in words
  std::vector<double> x, y;
};

struct ModelOutcome {
  std::map<std::string, double>
      results;  ///< in the units of result_units(); what was not reached is left out
  std::vector<ModelCurve> curves;
  std::string error;     ///< why it failed; empty: it did not
  double seconds = 0;    ///< it took
  bool stopped = false;  ///< by a stop that was asked for: says nothing of the parameters
};

class CalibrationModel {
 public:
  CalibrationModel() = default;
  CalibrationModel(const CalibrationModel&) = delete;
  CalibrationModel& operator=(const CalibrationModel&) = delete;
  virtual ~CalibrationModel() = default;

  /// One run, ready to go. Never throws RunError: a failed run is an outcome with its error.
  using Job = std::function<ModelOutcome(const std::atomic<bool>* stop)>;
  /// Reads the model with these materials. Not to be called by several threads at once. Throws InputError for
  /// materials that cannot be.
  [[nodiscard]] virtual Job prepare(const MaterialTexts& materials) const = 0;
  /// Whether jobs use all threads themselves; others may run beside each other.
  [[nodiscard]] virtual bool parallel_inside() const = 0;

  [[nodiscard]] virtual std::string kind() const = 0;  ///< "point", "oedometer", ...
  [[nodiscard]] virtual std::map<std::string, std::string> result_units() const = 0;  ///< unit by name
  [[nodiscard]] virtual std::vector<ModelCurve> curve_names() const = 0;              ///< without points
  [[nodiscard]] virtual std::vector<std::string> materials() const = 0;  ///< names of those it uses
  /// The model as resolved with these materials: says whether two are the same.
  [[nodiscard]] virtual std::string resolved(const MaterialTexts& materials) const = 0;
};

/// The model of a file, by what it holds. Throws InputError as the reading of the file does, and for scenes
/// of other rigs.
[[nodiscard]] std::unique_ptr<CalibrationModel> make_calibration_model(const std::filesystem::path& file,
                                                                       const Overrides& settings,
                                                                       const MaterialTexts& materials);

}  // namespace tuft::studies
