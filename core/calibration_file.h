#pragma once
/// Calibration files (`tuft calibrate`): which numbers of which materials are fitted, with which models, to
/// what. SI throughout, but for values whose unit is that of the key or result they speak of (Given).
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/given_value.h"
#include "core/scene_places.h"

namespace tuft {

enum class ParameterScale { linear, log };

/// One number of a material's file, and where it may lie.
struct CalibrationParameter {
  std::string material;  ///< a file of materials/, looked for as in scenes
  std::string key;       ///< of that file: "continuum.unloading_ratio"
  Given lower, upper;
  Given start;  ///< left out: the file's number
  ParameterScale scale = ParameterScale::linear;
};

/// A test of a point, or a scene of a rig that tests infill alone.
struct CalibrationModelEntry {
  std::string name;
  std::string file;             ///< beside the calibration file
  std::vector<Given> settings;  ///< "key=value", as given to --set
};

/// A measured curve, in a file of comma-separated columns or in the calibration itself.
struct TargetCurve {
  std::string file;                ///< beside the calibration file; empty: x and y
  std::string x_column, y_column;  ///< names in the file's first line; empty: the first and second
  std::vector<Given> x, y;         ///< plain numbers
  std::string x_unit = "1", y_unit = "1";
  double tolerance = 0.05;  ///< > 0, over the curve's largest |y|
};

/// What one result of one model should be: a number, a range or a curve.
struct CalibrationTarget {
  std::string model;
  std::string quantity;  ///< a result of the model, or one of its curves
  Given number, tolerance;
  std::vector<Given> range;  ///< two
  /// [0, 0.5), share of the range that the fit keeps from each of its ends: the regularisation draws a fit to
  /// where the misfit begins, and a little beyond.
  double margin = 0.02;
  std::optional<TargetCurve> curve;
  double weight = 1;       ///< > 0
  std::string provenance;  ///< "literature: ...", see provenance_words
};

enum class OptimiserAlgorithm { bobyqa, sbplx, cobyla, crs2, direct_l };

struct OptimiserChoice {
  OptimiserAlgorithm algorithm = OptimiserAlgorithm::bobyqa;
  int max_evaluations = 1000;
  double tolerance = 1e-5;        ///< of parameters scaled to [0, 1]
  double initial_step = 0.1;      ///< of them
  double global_share = 0.5;      ///< of the evaluations, for the global part of crs2 and direct_l
  std::uint64_t seed = 1;         ///< of crs2
  double failure_misfit = 10000;  ///< of a target whose model failed
};

struct CalibrationFile {
  std::string file;  ///< as given by the user, for messages
  std::string name;
  double regularisation = 0.03;  ///< >= 0, weight of the squared distance from the start, scaled to [0, 1]
  OptimiserChoice optimiser;
  std::vector<CalibrationParameter> parameters;
  std::vector<CalibrationModelEntry> models;
  std::vector<CalibrationTarget> targets;
  Places places;  ///< where each key was written
};

/// With which a provenance begins.
inline constexpr std::string_view provenance_words[] = {"published", "literature", "measured", "derived",
                                                        "assumed"};

/// Reads and checks what can be known without the models. Throws InputError, one line: file:line, key, value,
/// what to do.
[[nodiscard]] CalibrationFile read_calibration(const std::filesystem::path& file);

/// A file named in the calibration, beside it. Throws InputError with the place of the key.
[[nodiscard]] std::filesystem::path file_beside(const CalibrationFile& calibration, const std::string& name,
                                                const std::string& key);

}  // namespace tuft
