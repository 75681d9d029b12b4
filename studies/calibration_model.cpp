#include "studies/calibration_model.h"

#include <chrono>
#include <cmath>

#include "core/error.h"
#include "core/point_test.h"
#include "rigs/specimen_run.h"
#include "sph_infill/path_results.h"

namespace tuft::studies {
namespace {

using Clock = std::chrono::steady_clock;

/// Runs and times; errors of the run become the outcome's. A result that is not finite is an error too.
template <class Run>
ModelOutcome attempt(const Run& run) {
  const auto start = Clock::now();
  ModelOutcome outcome;
  try {
    run(outcome);
  } catch (const RunError& error) {
    outcome.error = error.what();
  }
  for (const auto& [name, value] : outcome.results)
    if (!std::isfinite(value) && outcome.error.empty()) outcome.error = fmt::format("{} is not finite", name);
  if (!outcome.error.empty()) outcome.results.clear();
  outcome.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return outcome;
}

/// Of a point or a rig.
template <class Curve>
ModelCurve curve_of(Curve curve) {
  return {curve.name,    curve.x_unit,       curve.y_unit,      curve.x_label,
          curve.y_label, std::move(curve.x), std::move(curve.y)};
}

std::vector<std::string> names_of(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  for (const Material& material : materials) names.push_back(material.name);
  return names;
}

class PointModel final : public CalibrationModel {
 public:
  PointModel(std::filesystem::path file, Overrides settings, const MaterialTexts& materials)
      : file_(std::move(file)), settings_(std::move(settings)), test_(read(materials)) {}

  Job prepare(const MaterialTexts& materials) const override {
    PointTest test = read(materials);
    const sph::SoilLaw law = sph::law_of(test, decide_effects(test));
    return [test = std::move(test), law](const std::atomic<bool>*) {
      return attempt([&](ModelOutcome& outcome) {
        sph::PathRecord record;
        sph::run_strain_path(law, test, record);
        for (const sph::PathResult& result : sph::path_results(test, record))
          outcome.results[result.name] = result.value;
        for (sph::PathCurve& curve : sph::path_curves(test, record))
          outcome.curves.push_back(curve_of(std::move(curve)));
      });
    };
  }
  bool parallel_inside() const override { return false; }
  std::string kind() const override { return "point"; }
  std::map<std::string, std::string> result_units() const override {
    std::map<std::string, std::string> units;
    for (const sph::PathResult& result : sph::path_result_names(test_)) units[result.name] = result.unit;
    return units;
  }
  std::vector<ModelCurve> curve_names() const override {
    std::vector<ModelCurve> names;
    for (const sph::PathCurve& curve : sph::path_curve_names(test_)) names.push_back(curve_of(curve));
    return names;
  }
  std::vector<std::string> materials() const override { return names_of(test_.materials); }
  std::string resolved(const MaterialTexts& materials) const override {
    return write_point_test(read(materials));
  }

 private:
  [[nodiscard]] PointTest read(const MaterialTexts& materials) const {
    return read_point_test(file_, settings_, materials);
  }
  std::filesystem::path file_;
  Overrides settings_;
  PointTest test_;
};

class SpecimenModel final : public CalibrationModel {
 public:
  SpecimenModel(std::filesystem::path file, Overrides settings, const MaterialTexts& materials)
      : file_(std::move(file)), settings_(std::move(settings)), scene_(read(materials)) {
    if (!scene_.rig.is_specimen())
      throw_input_error(
          "{}: rig.type: \"{}\": a calibration runs tests of a point and rigs oedometer and direct_shear",
          file_.string(), scene_.rig.type);
    rig_ = rigs::make_specimen_test(scene_);
  }

  Job prepare(const MaterialTexts& materials) const override {
    return [scene = read(materials)](const std::atomic<bool>* stop) {
      return attempt([&](ModelOutcome& outcome) {
        rigs::SpecimenOutcome measured = rigs::measure_specimen(scene, stop);
        outcome.stopped = measured.stopped;
        for (const auto& [name, quantity] : measured.results) outcome.results[name] = quantity.value;
        for (rigs::SpecimenCurve& curve : measured.curves)
          outcome.curves.push_back(curve_of(std::move(curve)));
      });
    };
  }
  bool parallel_inside() const override { return true; }
  std::string kind() const override { return scene_.rig.type; }
  std::map<std::string, std::string> result_units() const override {
    std::map<std::string, std::string> units;
    for (const auto& [name, quantity] : rig_->result_names()) units[name] = quantity.unit;
    return units;
  }
  std::vector<ModelCurve> curve_names() const override {
    std::vector<ModelCurve> names;
    for (const rigs::SpecimenCurve& curve : rig_->curve_names()) names.push_back(curve_of(curve));
    return names;
  }
  std::vector<std::string> materials() const override { return names_of(scene_.materials); }
  std::string resolved(const MaterialTexts& materials) const override { return write_scene(read(materials)); }

 private:
  [[nodiscard]] Scene read(const MaterialTexts& materials) const {
    return read_scene(file_, settings_, materials);
  }
  std::filesystem::path file_;
  Overrides settings_;
  Scene scene_;
  std::unique_ptr<rigs::SpecimenTest> rig_;
};

}  // namespace

std::unique_ptr<CalibrationModel> make_calibration_model(const std::filesystem::path& file,
                                                         const Overrides& settings,
                                                         const MaterialTexts& materials) {
  if (is_point_test(file)) return std::make_unique<PointModel>(file, settings, materials);
  return std::make_unique<SpecimenModel>(file, settings, materials);
}

}  // namespace tuft::studies
