#include "rigs/run.h"
#include "rigs/grain_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/scene_reader.h"
#include "coupler/layer_depth.h"
#include "rigs/component_run.h"
#include "rigs/process_memory.h"
#include "rigs/run_folder.h"
#include "rigs/run_outcome.h"
#include "rigs/run_remarks.h"
#include "rigs/run_state.h"
#include "rigs/specimen_run.h"
#include "rigs/xdmf.h"

namespace tuft::rigs {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::vector<coupler::RecordedColumn> rig_columns(const Rig& rig) {
  std::vector<coupler::RecordedColumn> columns;
  for (const HistoryColumn& c : rig.columns()) columns.push_back({c.name, c.unit});
  return columns;
}

std::vector<coupler::RecordedColumn> finished_columns(const Rig& rig) {
  std::vector<coupler::RecordedColumn> columns;
  for (const auto& c : rig.finished_columns()) columns.push_back({c.column.name, c.column.unit});
  return columns;
}

/// What the bridge has counted since this program began, s.
struct HostSeconds {
  double exchange = 0, waiting = 0;
};

HostSeconds host_seconds(const coupler::BuiltSimulation& built) {
  if (built.dem == nullptr) return {};
  return {built.dem->exchange_seconds(), built.dem->waiting_seconds()};
}

/// Wall time by phase. DEM: the window's time is split into LIGGGHTS' own steps (infill), what the bridge
/// copies and signals (exchange), and the rest of the wait for the other process (waiting).
/// `conditioning`: of both, what belongs to conditioning.
std::map<std::string, double> cost_by_phase(coupler::Simulation& simulation,
                                            const coupler::BuiltSimulation& built,
                                            const HostSeconds& conditioning) {
  std::map<std::string, double> cost = phase_seconds(simulation.timers());
  if (built.dem != nullptr) {
    const double window = cost["infill"];
    const HostSeconds now = host_seconds(built);
    cost["exchange"] = now.exchange - conditioning.exchange;
    cost["infill"] = std::min(window, now.waiting - conditioning.waiting);
    cost["waiting"] = std::max(0.0, window - cost["infill"] - cost["exchange"]);
  }
  return cost;
}

/// Runs one request; its members are what the stages share.
class Runner {
 public:
  explicit Runner(const RunRequest& request)
      : request_(request),
        summary_(begin_run(request.scene, request.scene.infill.approach == Approach::sph ? "sph" : "dem")) {}

  RunSummary run() {
    attempt(summary_, [this] {
      prepare();
      try {
        go();
      } catch (const InputError& error) {  // seen only now: the run has failed, and keeps what it has
        throw_run_error("{}", error.what());
      }
    });
    conclude();
    return summary_;
  }

 private:
  [[nodiscard]] std::filesystem::path file(const char* name) const { return request_.folder / name; }

  void prepare() {
    const Scene& scene = request_.scene;
    std::optional<coupler::Packing> bed;
    if (request_.resume) bed = read_checkpoint_bed(file("checkpoint.h5"), scene);
    const std::uint64_t index = request_.resume ? read_checkpoint_index(file("checkpoint.h5"), scene) : 0;
    state_ = make_run_state(scene, bed ? &*bed : nullptr, index,
                            [&](const std::string& stage, double done) { report_progress(stage, 0, done); });
    if (request_.resume) {
      const CheckpointRest rest = read_checkpoint(file("checkpoint.h5"), scene, state_);
      before_ = rest.spent;
      recorder_.emplace(coupler::Recorder::reopen(file("run.h5"), state_.simulation(), rest.rows,
                                                  rig_columns(*state_.rig), coupler::micro_settings(scene)));
      if (state_.index > state_.schedule.release() && state_.built.dem != nullptr)
        state_.built.dem->set_overlap_limit(scene.infill.dem.overlap_limit);
      if (state_.index >= state_.schedule.release())
        set_drop_damping();
      else
        set_settle_damping();
    } else {
      recorder_.emplace(coupler::Recorder::create(
          file("run.h5"), state_.simulation(), write_scene(scene), TUFT_VERSION, rig_columns(*state_.rig),
          finished_columns(*state_.rig), coupler::micro_settings(scene)));
      set_settle_damping();
    }
    remark(remarks_on_setup(scene, state_));
    remark(remarks_on_rest(scene, state_));
    state_.simulation().timers().add(Phase::packing, state_.built.packing_seconds);
    state_.simulation().timers().add(Phase::setup, seconds_since(start_) - state_.built.packing_seconds);
    built_ = true;
  }

  void remark(const std::vector<std::string>& remarks) { add_remarks(request_, remarks, summary_); }

  void set_settle_damping() {
    state_.simulation().set_damping(request_.scene.numerics.settle_damping,
                                    request_.scene.numerics.settle_damping);
  }
  void set_drop_damping() { state_.simulation().set_damping(request_.scene.turf.carpet.damping, 0); }

  void go() {
    const Schedule& schedule = state_.schedule;
    coupler::Simulation& simulation = state_.simulation();
    loop_start_ = Clock::now();
    first_index_ = state_.index;
    if (state_.index == 0) state_.bed_placed = bed();
    // Contact with strands has not been looked for yet.
    if (state_.index == 0 && state_.bed_placed && state_.packing)
      state_.bed_placed->rest = state_.packing->rest;
    if (state_.index == 0) recorder_->record_frame(schedule.time(0), simulation);
    int checkpoints = 0;
    count_steps();
    while (state_.index < schedule.end) {
      if (state_.compaction && state_.index <= schedule.conditioned()) condition();
      if (state_.index == schedule.release()) {
        set_drop_damping();
        const Turf& turf = request_.scene.turf;
        state_.layer_tops = coupler::layer_tops(simulation.infill().particles(), turf.size,
                                                turf.carpet.backing_thickness, turf.layers.size());
        if (state_.compaction) state_.compaction->note_release(state_.built);
        state_.bed_released = bed();
        if (state_.built.dem != nullptr)
          state_.built.dem->count_overlaps_from_now(request_.scene.infill.dem.overlap_limit);
        remark(remarks_on_rest(request_.scene, state_));
        state_.rig->release(simulation);
      }
      simulation.advance_interval(schedule.interval);
      if (state_.index == first_index_)
        remark(remarks_on_window(request_.scene, simulation, schedule.interval, "output.histories"));
      ++state_.index;
      if (state_.compaction) {
        state_.compaction->after_interval(state_.index, state_.built);
        state_.index = state_.compaction->next_index(state_.index);
      }
      settle();
      const double time = schedule.time(state_.index);
      simulation.set_time(time);  // no drift: the grid's own value
      state_.rig->sample(simulation, time - 0.5 * schedule.interval, schedule.interval);
      record(time);
      const bool last = state_.index == schedule.end;
      const bool due = schedule.checkpoint_every > 0 && state_.index % schedule.checkpoint_every == 0;
      const bool stop = request_.stop != nullptr && request_.stop->load();
      // After the first interval, not before: contact has then looked for what overlaps as placed.
      const bool first = schedule.checkpoint_every > 0 && state_.index == 1;
      if (due || stop || last || first) {
        checkpoint();
        if (due) ++checkpoints;
      }
      report_progress(stage(), time, -1);
      if (!last &&
          (stop || (request_.stop_after_checkpoints > 0 && checkpoints >= request_.stop_after_checkpoints))) {
        summary_.status = "stopped";
        return;
      }
    }
    summary_.status = "completed";
  }

  /// Grains that lie still are not settled on: what is left of the time for it passes at once.
  void settle() {
    const Schedule& schedule = state_.schedule;
    if (state_.index <= schedule.conditioned() || state_.index >= schedule.release()) return;
    const std::uint64_t done = state_.index - schedule.conditioned();
    if (schedule.settle == schedule.settle_least || done < schedule.settle_least ||
        (done - schedule.settle_least) % schedule.look_every != 0)
      return;
    const double tolerance = request_.scene.infill.dem.rest_tolerance;
    if (!is_at_rest(measure_rest(state_.simulation()), tolerance)) return;
    state_.settled = done;
    state_.index = schedule.release();
  }

  /// How grains lie; empty for a continuum.
  [[nodiscard]] std::optional<coupler::BedState> bed() const {
    if (state_.built.dem == nullptr) return std::nullopt;
    const Turf& turf = request_.scene.turf;
    return coupler::measure_bed(state_.simulation(), turf.size, turf.carpet.backing_thickness,
                                turf.layers.size());
  }

  [[nodiscard]] std::string stage() const {
    if (state_.compaction)
      if (std::string name = state_.compaction->stage(state_.index); !name.empty()) return name;
    return state_.index <= state_.schedule.release() ? "settling" : "drop";
  }

  /// Steps up to the end of conditioning are what conditioning costs.
  void count_steps() {
    const bool conditioning = state_.index < state_.schedule.conditioned();
    state_.simulation().timers().count_steps_as(conditioning ? std::optional(Phase::conditioning)
                                                             : std::nullopt);
  }

  /// What conditioning has to do before the next interval.
  void condition() {
    {
      const ScopedPhase phase(state_.simulation().timers(), Phase::conditioning);
      state_.compaction->before_interval(state_.index, state_.effects, state_.built);
    }
    if (state_.index < state_.schedule.conditioned()) return;
    conditioning_ = host_seconds(state_.built);
    count_steps();
  }

  /// Wall time by phase, what was spent before a resume included.
  [[nodiscard]] std::map<std::string, double> cost() {
    const bool conditioning = state_.index < state_.schedule.conditioned();
    std::map<std::string, double> total = cost_by_phase(
        state_.simulation(), state_.built, conditioning ? host_seconds(state_.built) : conditioning_);
    for (const auto& [phase, seconds] : before_.cost) total[phase] += seconds;
    return total;
  }

  void record(double time) {
    coupler::Simulation& simulation = state_.simulation();
    const ScopedPhase phase(simulation.timers(), Phase::record);
    recorder_->record_history(time, state_.rig->row(), simulation.ledger());
    const bool conditioning = state_.index < state_.schedule.conditioned();
    const std::uint64_t every =
        conditioning ? state_.schedule.conditioning_frame_every : state_.schedule.frame_every;
    if (state_.index % every == 0 || state_.index == state_.schedule.conditioned() ||
        state_.index == state_.schedule.end) {
      recorder_->record_frame(time, simulation);
      recorder_->record_cost(time, cost());
    }
    recorder_->flush_when_due();
  }

  void checkpoint() {
    coupler::Simulation& simulation = state_.simulation();
    const ScopedPhase phase(simulation.timers(), Phase::checkpoint);
    recorder_->flush();
    write_checkpoint(file("checkpoint.h5"), request_.scene, state_, recorder_->rows(),
                     {before_.wall + seconds_since(start_), cost()});
  }

  void report_progress(const std::string& stage, double time, double packing_done) {
    if (!request_.on_progress) return;
    const bool finished = built_ && state_.index == state_.schedule.end;
    const bool next_stage = stage != std::exchange(last_stage_, stage);
    if (!finished && !next_stage && last_report_ && seconds_since(*last_report_) < 0.1) return;
    last_report_ = Clock::now();
    Progress progress;
    progress.stage = stage;
    progress.time = time;
    progress.end_time = request_.scene.info.duration;
    progress.wall = seconds_since(start_);
    progress.eta = -1;
    if (built_) {
      progress.window = state_.simulation().windows();
      progress.energy_error = state_.simulation().ledger().largest_error();
      const double done = static_cast<double>(state_.index - first_index_);
      const double left = static_cast<double>(state_.schedule.end - state_.index);
      if (done > 0) progress.eta = seconds_since(loop_start_) * left / done;
    } else if (packing_done > 0) {
      progress.time = packing_done;
      progress.end_time = 1;
    }
    request_.on_progress(progress);
  }

  /// Last words: what was measured so far, also of a run that failed.
  void conclude() {
    keep_summary(request_, built_, summary_.error);
    if (recorder_)
      attempt(summary_, [this] {
        if (built_)
          for (const auto& column : state_.rig->finished_columns())
            recorder_->record_finished(column.column.name, column.values);
        recorder_->flush();
      });
    if (built_) attempt(summary_, [this] { measure(); });
    summary_.wall_s = before_.wall + seconds_since(start_);
    write_summary(request_.folder, summary_);
    if (recorder_) {
      try {
        write_xdmf(request_.folder);
      } catch (const RunError& error) {
        if (summary_.error.empty()) summary_.error = error.what();
      }
    }
  }

  void measure();

  const RunRequest& request_;
  RunSummary summary_;
  RunState state_;
  std::optional<coupler::Recorder> recorder_;
  bool built_ = false;
  SpentSoFar before_;
  HostSeconds conditioning_;
  std::uint64_t first_index_ = 0;
  Clock::time_point start_ = Clock::now(), loop_start_ = start_;
  std::optional<Clock::time_point> last_report_;
  std::string last_stage_;
};

void Runner::measure() {
  coupler::Simulation& simulation = state_.simulation();
  summary_.results = state_.rig->results();
  summary_.energy_error = simulation.ledger().largest_error();
  summary_.momentum_error = simulation.momentum_error();
  summary_.simulated_time = state_.schedule.time(state_.index);
  summary_.steps = simulation.windows();
  summary_.cost = cost();
  const Infill& infill = simulation.infill();
  summary_.particles = infill.particles().size();
  summary_.shells = simulation.carpet().mesh().quads.size();
  const double infill_seconds = summary_.cost["infill"], carpet_seconds = summary_.cost["carpet"];
  if (infill_seconds > 0)
    summary_.particle_steps_per_s = static_cast<double>(infill.particle_steps()) / infill_seconds;
  const std::uint64_t conditioning_steps = state_.compaction ? state_.compaction->element_steps() : 0;
  if (carpet_seconds > 0)
    summary_.element_steps_per_s =
        static_cast<double>(simulation.carpet().element_steps() - conditioning_steps) / carpet_seconds;
  summary_.peak_memory_bytes =
      peak_memory_bytes(state_.built.dem != nullptr ? state_.built.dem->host_process() : 0);

  const coupler::StepPlan& plan = simulation.step_plan();
  auto& notes = summary_.notes;
  notes["window"] = {plan.window, "s"};
  notes["carpet_step"] = {plan.window / plan.carpet_substeps, "s"};
  if (const fe::MassScaling& scaling = simulation.carpet().mass_scaling(); scaling.limit > 0) {
    notes["mass_scaling_added"] = {scaling.added_mass, "kg"};
    notes["mass_scaling_share"] = {scaling.share(), "1"};
    notes["mass_scaling_step_before"] = {scaling.step_before, "s"};
    notes["mass_scaling_step_after"] = {scaling.step_after, "s"};
  }
  if (plan.carpet_subcycle > 1) notes["carpet_subcycle"] = {static_cast<double>(plan.carpet_subcycle), "1"};
  notes["particle_steps"] = {static_cast<double>(infill.particle_steps()), "1"};
  notes["infill_step"] = {plan.window / plan.infill_substeps, "s"};
  if (!simulation.carpet().eroded().empty())
    notes["eroded_shells"] = {static_cast<double>(simulation.carpet().eroded_count()), "1"};
  add_expelled_notes(infill.expelled(), notes);
  notes["contact_searches"] = {static_cast<double>(simulation.searches()), "1"};
  notes["contact_pairs_particle_shell"] = {static_cast<double>(simulation.particle_shell().pair_count()),
                                           "1"};
  notes["contact_touching_particle_shell"] = {static_cast<double>(simulation.particle_shell().touching()),
                                              "1"};
  notes["contact_softening_particle_shell"] = {simulation.particle_shell().softening(), "1"};
  notes["initial_overlaps"] = {static_cast<double>(simulation.particle_shell().initial_overlap().pairs +
                                                   simulation.particle_body().initial_overlap().pairs +
                                                   simulation.node_body().initial_overlap().pairs),
                               "1"};
  notes["initial_overlap_largest"] = {std::max({simulation.particle_shell().initial_overlap().largest,
                                                simulation.particle_body().initial_overlap().largest,
                                                simulation.node_body().initial_overlap().largest}),
                                      "m"};
  if (summary_.status != "failed") {  // a lost host cannot be asked
    const auto residuals = simulation.residuals();
    notes["energy_residual_carpet"] = {residuals.carpet, "J"};
    notes["energy_residual_infill"] = {residuals.infill, "J"};
    notes["energy_residual_contact"] = {residuals.contact_and_bodies, "J"};
  }
  const auto& layers = request_.scene.turf.layers;
  for (std::size_t i = 0; i < state_.layer_tops.size(); ++i)
    notes[fmt::format("layer_{}_{}_depth", i + 1, request_.scene.materials.at(layers[i].material).name)] = {
        state_.layer_tops[i] - (i > 0 ? state_.layer_tops[i - 1] : 0), "m"};
  if (state_.compaction) notes.merge(state_.compaction->notes());
  add_bed_notes(request_.scene, state_, notes);
  notes["threads"] = {static_cast<double>(omp_get_max_threads()), "1"};
  if (state_.built.dem != nullptr) {
    notes["packing_from_cache"] = {state_.built.packing_from_cache ? 1.0 : 0.0, "1"};
    add_grain_notes(*state_.built.dem, request_.scene.materials, summary_.status == "failed", notes);
    remark(remarks_on_overlaps(request_.scene, *state_.built.dem));
  }
}

}  // namespace

RunSummary run(const RunRequest& request) {
  const FolderLock lock(request.folder);
  if (request.scene.rig.is_component()) return run_component(request);
  if (request.scene.rig.is_specimen()) return run_specimen(request);
  return Runner(request).run();
}

}  // namespace tuft::rigs
