#pragma once
/// A soil by closed forms in a folder of its own, tests of it, and calibrations to targets made with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "studies/calibrate.h"
#include "unit/core/scratch_folder.h"

namespace tuft::studies::test {

class SoilCalibration {
 public:
  SoilCalibration() {
    std::filesystem::create_directories(folder_ / "materials");
    write("materials/soil.toml", R"toml([material]
name = "soil"
bulk_density = "1000 kg/m^3"
[friction.fibre]
static = 0.3
dynamic = 0.3
[friction.body]
static = 0.3
dynamic = 0.3
[continuum]
shear_ratio = 0.5
unloading_ratio = 1.3
yield_a0 = "400 kPa^2"
yield_a2 = 0.2
tension_cutoff = "5 kPa"
[continuum.pressure_exponential]
modulus = "1.2 MPa"
growth = 8
)toml");
    write("ring.toml", R"toml([point]
material = "soil"
step = 1e-3
samples = 200
[[segments]]
path = "oedometric"
stress = "650 kPa"
[[segments]]
path = "oedometric"
stress = "5 kPa"
[[measures]]
name = "low"
segment = 1
between = ["50 kPa", "150 kPa"]
[[measures]]
name = "high"
segment = 1
between = ["500 kPa", "600 kPa"]
[[measures]]
name = "loss"
kind = "loss"
segment = 1
release = 2
)toml");
    write("box.toml", R"toml([point]
material = "soil"
step = 5e-3
samples = 100
[[segments]]
path = "isotropic"
stress = "100 kPa"
[[segments]]
path = "direct_shear"
strain = 0.5
[[segments]]
fresh = true
path = "isotropic"
stress = "300 kPa"
[[segments]]
path = "direct_shear"
strain = 0.5
[[measures]]
name = "angle"
kind = "friction_angle"
)toml");
  }

  void write(const std::string& name, const std::string& text) const { std::ofstream(path(name)) << text; }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  /// Four parameters, two models, then what a test adds: targets, and options of [calibration] and
  /// [optimiser].
  [[nodiscard]] Problem problem(const std::string& targets, const std::string& options = "",
                                const std::string& parameters = all_parameters()) const {
    write("c.toml",
          options + parameters +
              "[[models]]\nname = \"ring\"\nfile = \"ring.toml\"\n[[models]]\nname = \"box\"\nfile = "
              "\"box.toml\"\n" +
              targets);
    return make_problem(read_calibration(path("c.toml")));
  }

  static std::string parameter(const std::string& key, const std::string& lower, const std::string& upper,
                               const std::string& more = "scale = \"log\"") {
    return fmt::format(
        "[[parameters]]\nmaterial = \"soil\"\nkey = \"continuum.{}\"\nlower = {}\nupper = {}\n{}\n", key,
        lower, upper, more);
  }
  static std::string all_parameters() {
    return parameter("pressure_exponential.modulus", "\"0.4 MPa\"", "\"4 MPa\"") +
           parameter("pressure_exponential.growth", "3", "25") + parameter("unloading_ratio", "1", "3") +
           parameter("yield_a2", "0.05", "0.8");
  }

  /// Calibrates into a table of the folder.
  [[nodiscard]] CalibrationResult fit(const Problem& problem, const std::string& table = "e.csv") const {
    EvaluationLog log(path(table), problem);
    CalibrationRequest request;
    request.problem = &problem;
    request.log = &log;
    return calibrate(request);
  }

  /// The table without the columns that time decides.
  [[nodiscard]] std::vector<std::string> rows(const std::string& table = "e.csv") const {
    std::ifstream stream(path(table));
    std::vector<std::string> rows;
    for (std::string line; std::getline(stream, line);) {
      const std::size_t error = line.rfind(','), seconds = line.rfind(',', error - 1);
      rows.push_back(line.substr(0, seconds) + line.substr(error));
    }
    return rows;
  }

  /// What the models give with these values.
  [[nodiscard]] Evaluation truth(const std::vector<double>& values) const {
    const Problem any = problem(number("ring", "low", "\"1 MPa\"", "\"1 MPa\""));
    return evaluate(any, {values}, nullptr).front();
  }

  static std::string number(const std::string& model, const std::string& quantity, const std::string& value,
                            const std::string& tolerance) {
    return fmt::format(
        "[[targets]]\nmodel = \"{}\"\nquantity = \"{}\"\nnumber = {}\ntolerance = {}\nprovenance = "
        "\"derived: by "
        "the same law\"\n",
        model, quantity, value, tolerance);
  }
  static std::string range(const std::string& model, const std::string& quantity, const std::string& low,
                           const std::string& high, double margin = 0) {
    return fmt::format(
        "[[targets]]\nmodel = \"{}\"\nquantity = \"{}\"\nrange = [{}, {}]\nmargin = {}\nprovenance = "
        "\"derived: by "
        "the same law\"\n",
        model, quantity, low, high, margin);
  }

 private:
  tuft::test::ScratchFolder folder_;
};

}  // namespace tuft::studies::test
