#include "rigs/component_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/parallel.h"
#include "core/record_file.h"
#include "core/scene_reader.h"
#include "core/timers.h"
#include "rigs/component_checkpoint.h"
#include "rigs/process_memory.h"
#include "rigs/run_outcome.h"
#include "rigs/tension_record.h"
#include "rigs/tension_strip.h"

namespace tuft::rigs {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::uint64_t checkpoints_a_test = 10;

/// Runs one request: the tests of its rig one after the other.
class ComponentRunner {
 public:
  explicit ComponentRunner(const RunRequest& request)
      : request_(request),
        rig_(request.scene.rig.tension),
        rows_a_test_(static_cast<std::uint64_t>(rig_.samples)),
        summary_(begin_run(request.scene, "fe")) {}

  RunSummary run() {
    attempt(summary_, [this] {
      prepare();
      go();
    });
    conclude();
    return summary_;
  }

 private:
  [[nodiscard]] std::filesystem::path file(const char* name) const { return request_.folder / name; }

  void start_test() {
    const ScopedPhase phase(timers_, Phase::setup);
    strip_.emplace(request_.scene, state_.test);
    ledger_.emplace(request_.scene.numerics.energy_error_limit, 0.0);
    summary_.shells = std::max<std::uint64_t>(summary_.shells, strip_->carpet().mesh().quads.size());
  }

  void prepare() {
    if (request_.resume) {
      load_component_checkpoint(file("checkpoint.h5"), request_.scene, state_, [&](const h5::Group& group) {
        start_test();
        strip_->load(group.open_group("strip"));
        ledger_->load(group.open_group("ledger"));
      });
      record_.emplace(RecordFile::reopen(file("run.h5"), state_.recorded));
      return;
    }
    record_.emplace(create_tension_record(file("run.h5"), request_.scene, TUFT_VERSION));
    start_test();
    enter_row();
    checkpoint();  // whatever ends it from here on, it goes on
  }

  void go() {
    first_done_ = rows_done();
    int checkpoints = 0;
    while (true) {
      if (state_.row == rows_a_test_) {
        finish_test();
        if (state_.test == rig_.rates.size()) break;
        start_test();
        enter_row();
      }
      {
        const ScopedPhase phase(timers_, Phase::carpet);
        strip_->advance();
      }
      ++state_.row;
      enter_row();
      const bool last = state_.test + 1 == rig_.rates.size() && state_.row == rows_a_test_;
      const bool due = state_.row % std::max<std::uint64_t>(1, rows_a_test_ / checkpoints_a_test) == 0;
      const bool stop = request_.stop != nullptr && request_.stop->load();
      if (due || stop || last) checkpoint();
      if (due) ++checkpoints;
      report_progress(last);
      if (!last &&
          (stop || (request_.stop_after_checkpoints > 0 && checkpoints >= request_.stop_after_checkpoints))) {
        summary_.status = "stopped";
        return;
      }
    }
    summary_.status = "completed";
  }

  /// Measures, and puts the row into the books and the file.
  void enter_row() {
    const TensionRow row = strip_->row();
    const coupler::EnergyTerms terms = strip_->energy_terms();
    {
      const ScopedPhase phase(timers_, Phase::ledger);
      ledger_->enter(row.time, terms,
                     [&] { return fmt::format("strain {:.4g}, rate {:g} 1/s", row.strain, strip_->rate()); });
      state_.energy_error = std::max(state_.energy_error, ledger_->largest_error());
      state_.momentum_error = std::max(state_.momentum_error, strip_->momentum_error());
    }
    const ScopedPhase phase(timers_, Phase::record);
    // Energy of motion matters where there is something to compare it with.
    constexpr double from_strain = 0.01;
    double& share = state_.kinetic_share.at(state_.test);
    if (row.strain >= from_strain && !row.failed)
      share = std::max(share, terms.kinetic_carpet / (terms.strain_carpet + terms.kinetic_carpet));
    state_.rows.at(state_.test).push_back(row);
    append_tension_row(*record_, state_.time_before + row.time, state_.test, strip_->rate(), row, *ledger_);
    if (row.failed && whole_rows(state_.rows[state_.test]).size() < fewest_whole_rows)
      throw_run_error(
          "{}: the strip failed within the first of {} rows at {:g} 1/s, with nothing measured before; raise "
          "rig.samples or lower rig.strain_limit",
          request_.scene.rig.type, rows_a_test_, strip_->rate());
    if (Clock::now() - last_flush_ > std::chrono::seconds(2)) {
      record_->flush();
      last_flush_ = Clock::now();
    }
  }

  void finish_test() {
    state_.time_before += strip_->interval() * static_cast<double>(rows_a_test_);
    state_.steps_before += strip_->steps();
    state_.element_steps_before += strip_->carpet().element_steps();
    ++state_.test;
    state_.row = 0;
    carpet_step_ = strip_->step();
    strip_.reset();
  }

  void checkpoint() {
    const ScopedPhase phase(timers_, Phase::checkpoint);
    record_->flush();
    state_.recorded = record_->rows();
    state_.steps = state_.steps_before + strip_->steps();
    ComponentState saved = state_;
    saved.spent = {state_.spent.wall + seconds_since(start_), cost()};
    write_component_checkpoint(file("checkpoint.h5"), request_.scene, saved, [&](h5::Group& group) {
      h5::Group strip = group.create_group("strip"), ledger = group.create_group("ledger");
      strip_->save(strip);
      ledger_->save(ledger);
    });
  }

  [[nodiscard]] std::map<std::string, double> cost() const {
    std::map<std::string, double> total = phase_seconds(timers_);
    for (const auto& [phase, seconds] : state_.spent.cost) total[phase] += seconds;
    return total;
  }

  [[nodiscard]] double simulated_time() const {
    return state_.time_before + (strip_ ? strip_->interval() * static_cast<double>(state_.row) : 0);
  }
  [[nodiscard]] double rows_done() const { return simulated_time() / request_.scene.info.duration; }

  void report_progress(bool last) {
    if (!request_.on_progress || (!last && last_report_ && seconds_since(*last_report_) < 0.1)) return;
    last_report_ = Clock::now();
    Progress progress;
    progress.stage = fmt::format("{:g} 1/s", strip_->rate());
    progress.time = simulated_time();
    progress.end_time = request_.scene.info.duration;
    progress.window = state_.steps_before + strip_->steps();
    progress.energy_error = state_.energy_error;
    progress.wall = seconds_since(start_);
    const double done = rows_done() - first_done_;
    progress.eta = done > 0 ? progress.wall * (1 - rows_done()) / done : -1;
    request_.on_progress(progress);
  }

  void conclude() {
    keep_summary(request_, record_.has_value(), summary_.error);
    if (record_) attempt(summary_, [this] { record_->flush(); });
    measure();
    write_summary(request_.folder, summary_);
  }

  void measure() {
    for (std::size_t test = 0; test < rig_.rates.size(); ++test) {
      if (whole_rows(state_.rows[test]).size() >= fewest_whole_rows)
        add_tension_results(summary_.results, rig_.rates[test], state_.rows[test]);
      if (state_.kinetic_share[test] > 0)
        summary_.notes[fmt::format("rate_{:g}_kinetic_share", rig_.rates[test])] = {
            state_.kinetic_share[test], "1"};
    }
    summary_.energy_error = state_.energy_error;
    summary_.momentum_error = state_.momentum_error;
    summary_.simulated_time = simulated_time();
    summary_.steps = state_.steps_before + (strip_ ? strip_->steps() : 0);
    summary_.cost = cost();
    const std::uint64_t element_steps =
        state_.element_steps_before + (strip_ ? strip_->carpet().element_steps() : 0);
    if (summary_.cost["carpet"] > 0)
      summary_.element_steps_per_s = static_cast<double>(element_steps) / summary_.cost["carpet"];
    summary_.peak_memory_bytes = peak_memory_bytes(0);
    summary_.wall_s = state_.spent.wall + seconds_since(start_);
    if (strip_) carpet_step_ = strip_->step();
    summary_.notes["carpet_step"] = {carpet_step_, "s"};
    summary_.notes["mass_factor"] = {rig_.mass_factor, "1"};
    summary_.notes["threads"] = {static_cast<double>(omp_get_max_threads()), "1"};
  }

  const RunRequest& request_;
  const TensionRig& rig_;
  std::uint64_t rows_a_test_;
  RunSummary summary_;
  ComponentState state_{rig_.rates.size()};
  std::optional<TensionStrip> strip_;
  std::optional<coupler::EnergyLedger> ledger_;
  std::optional<RecordFile> record_;
  PhaseTimers timers_;
  double first_done_ = 0, carpet_step_ = 0;
  Clock::time_point start_ = Clock::now(), last_flush_ = start_;
  std::optional<Clock::time_point> last_report_;
};

}  // namespace

RunSummary run_component(const RunRequest& request) {
  return ComponentRunner(request).run();
}

RunPlan plan_component(const Scene& scene) {
  const TensionRig& rig = scene.rig.tension;
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  RunPlan plan;
  plan.effects = decide_effects(scene);
  for (std::size_t test = 0; test < rig.rates.size(); ++test) {
    TensionStrip strip(scene, test);
    const fe::ShellMesh& mesh = strip.carpet().mesh();
    plan.shells = std::max<std::uint64_t>(plan.shells, mesh.quads.size());
    plan.nodes = std::max<std::uint64_t>(plan.nodes, mesh.nodes.size());
    plan.carpet_step = test == 0 ? strip.step() : std::min(plan.carpet_step, strip.step());
    const std::uint64_t steps = strip.steps_a_row() * static_cast<std::uint64_t>(rig.samples);
    plan.windows += steps;
    strip.advance();  // caches warm
    const auto start = Clock::now();
    const std::uint64_t before = strip.steps();
    constexpr double long_enough = 0.02;  // s
    while (strip.row().strain < 0.5 * rig.strain_limit && seconds_since(start) < long_enough) strip.advance();
    if (strip.steps() > before)
      plan.predicted_wall_s +=
          seconds_since(start) / static_cast<double>(strip.steps() - before) * static_cast<double>(steps);
  }
  plan.window = plan.infill_step = plan.carpet_step;
  plan.predicted_memory_bytes = peak_memory_bytes(0);
  if (rig.mass_factor > 1)
    plan.remarks.push_back(fmt::format(
        "density times rig.mass_factor = {:g}: the kinetic share that the run reports must stay small",
        rig.mass_factor));
  return plan;
}

}  // namespace tuft::rigs
