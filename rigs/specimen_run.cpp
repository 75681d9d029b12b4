#include "rigs/specimen_run.h"
#include "rigs/grain_notes.h"
#include "rigs/run_remarks.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/scene_reader.h"
#include "coupler/micro_recorder.h"
#include "coupler/recorder.h"
#include "rigs/checkpoint_books.h"
#include "rigs/direct_shear.h"
#include "rigs/oedometer.h"
#include "rigs/process_memory.h"
#include "rigs/pull_out.h"
#include "rigs/run_outcome.h"
#include "rigs/specimen_checkpoint.h"
#include "rigs/window_remarks.h"
#include "rigs/xdmf.h"

namespace tuft::rigs {

std::unique_ptr<SpecimenTest> make_specimen_test(const Scene& scene) {
  if (scene.rig.type == "oedometer") return std::make_unique<Oedometer>(scene);
  if (scene.rig.type == "pull_out") return std::make_unique<PullOut>(scene);
  return std::make_unique<DirectShear>(scene);
}

std::unique_ptr<coupler::Simulation> build_specimen_test(const Scene& scene, const SpecimenTest& rig,
                                                         std::size_t test,
                                                         std::optional<coupler::PackingReport>* packing) {
  coupler::SpecimenRequest request;
  request.effects = decide_effects(scene);
  const std::optional<coupler::SpecimenStrand> strand = rig.strand();
  const coupler::Specimen specimen =
      coupler::fill_room(scene, request.effects, rig.room(), strand ? &*strand : nullptr);
  if (packing != nullptr) *packing = specimen.packing;
  Scene of_test = scene;
  rig.adjust(of_test, test);
  request.scene = &of_test;
  request.strand = strand ? &*strand : nullptr;
  request.specimen = &specimen;
  request.bodies = rig.bodies(test, specimen);
  request.energy_scale = rig.energy_scale(test);
  return coupler::build_specimen(request);
}

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class SpecimenRunner {
 public:
  explicit SpecimenRunner(const RunRequest& request)
      : request_(request),
        rig_(make_specimen_test(request.scene)),
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
  [[nodiscard]] double time_in_test() const { return rig_->interval() * static_cast<double>(tally_.row); }
  [[nodiscard]] double time() const { return tally_.time_before + time_in_test(); }

  [[nodiscard]] std::vector<coupler::RecordedColumn> columns() const {
    std::vector<coupler::RecordedColumn> columns;
    for (const HistoryColumn& c : rig_->columns()) columns.push_back({c.name, c.unit});
    return columns;
  }

  void remark(const std::vector<std::string>& remarks) { add_remarks(request_, remarks, summary_); }

  void start_test() {
    const ScopedPhase phase(timers_, Phase::setup);
    std::optional<coupler::PackingReport> packing;
    simulation_ = build_specimen_test(request_.scene, *rig_, tally_.test, &packing);
    if (packing) remark(remarks_on_packing(request_.scene, *packing));
    rig_->begin(tally_.test, *simulation_);
    summary_.particles = simulation_->infill().particles().size();
    summary_.shells = simulation_->carpet().mesh().quads.size();
  }

  void prepare() {
    if (request_.resume) {
      const auto read = [&](const auto& rest) {
        return read_books(file("checkpoint.h5"), request_.scene, specimen_format, rest);
      };
      (void)read([&](const h5::Group& root) { tally_ = read_tally(root, rig_->tests()); });
      start_test();  // where that fails, the checkpoint is not to blame
      const CheckpointBooks books = read([&](const h5::Group& root) {
        simulation_->load(root.open_group("simulation"));
        rig_->load(root.open_group("rig"));
      });
      before_ = books.spent;
      recorder_.emplace(coupler::Recorder::reopen(file("run.h5"), *simulation_, books.recorded, columns(),
                                                  coupler::micro_settings(request_.scene)));
      return;
    }
    start_test();
    recorder_.emplace(coupler::Recorder::create(file("run.h5"), *simulation_, write_scene(request_.scene),
                                                TUFT_VERSION, columns(), {},
                                                coupler::micro_settings(request_.scene)));
    recorder_->record_frame(time(), *simulation_);
    checkpoint();  // whatever ends it from here on, it goes on
  }

  void go() {
    first_done_ = share_done();
    int checkpoints = 0;
    while (true) {
      if (rig_->done()) {
        if (!next_test()) break;
        recorder_->record_frame(time(), *simulation_);
      }
      advance();
      const bool last = rig_->done() && tally_.test + 1 == rig_->tests();
      const bool due =
          tally_.row % static_cast<std::uint64_t>(request_.scene.rig.specimen.checkpoint_rows) == 0;
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

  void advance() {
    rig_->drive(*simulation_);
    simulation_->advance_interval(rig_->interval());
    if (!std::exchange(stepped_, true))
      remark(remarks_on_window(request_.scene, *simulation_, rig_->interval(), "the rig's rows"));
    ++tally_.row;
    simulation_->set_time(time_in_test());  // no drift: the grid's own value
    const coupler::EnergyTerms& energy = simulation_->ledger().last();
    tally_.most_kinetic = std::max(tally_.most_kinetic, energy.kinetic_infill);
    tally_.most_work = std::max(tally_.most_work, energy.external_work);
    rig_->sample(*simulation_);
    const ScopedPhase phase(timers_, Phase::record);
    recorder_->record_history(time(), rig_->row(), simulation_->ledger());
    if (tally_.row % static_cast<std::uint64_t>(request_.scene.rig.specimen.frame_rows) == 0 ||
        rig_->done()) {
      recorder_->record_frame(time(), *simulation_);
      recorder_->record_cost(time(), cost());
    }
    recorder_->flush_when_due();
  }

  bool next_test() {
    if (tally_.test + 1 == rig_->tests()) return false;
    close_test();
    tally_.time_before += time_in_test();
    ++tally_.test;
    tally_.row = 0;
    start_test();
    return true;
  }

  /// The simulation at hand goes into the sums.
  void close_test() {
    tally_.steps_before += simulation_->windows();
    tally_.particle_steps_before += simulation_->infill().particle_steps();
    tally_.energy_error = energy_error();
    tally_.momentum_error = momentum_error();
    tally_.kinetic_share = kinetic_share();
    tally_.most_kinetic = tally_.most_work = 0;
    tally_.expelled = expelled();
    for (const auto& [phase, seconds] : phase_seconds(simulation_->timers())) before_.cost[phase] += seconds;
  }

  [[nodiscard]] double energy_error() const {
    return std::max(tally_.energy_error, simulation_ ? simulation_->ledger().largest_error() : 0.0);
  }
  [[nodiscard]] double momentum_error() const {
    return std::max(tally_.momentum_error, simulation_ ? simulation_->momentum_error() : 0.0);
  }

  /// Largest energy of motion of a test over the most work that it took.
  [[nodiscard]] double kinetic_share() const {
    return std::max(tally_.kinetic_share,
                    tally_.most_work > 0 ? tally_.most_kinetic / tally_.most_work : 0.0);
  }

  /// Of all tests so far.
  [[nodiscard]] Expelled expelled() const {
    Expelled sum = tally_.expelled;
    if (!simulation_) return sum;
    const Expelled here = simulation_->infill().expelled();
    sum.particles += here.particles;
    sum.mass += here.mass;
    sum.momentum += here.momentum;
    sum.kinetic_energy += here.kinetic_energy;
    return sum;
  }

  void checkpoint() {
    const ScopedPhase phase(timers_, Phase::checkpoint);
    recorder_->flush();
    const CheckpointBooks books{recorder_->rows(), {wall(), cost()}};
    write_books(file("checkpoint.h5"), request_.scene, specimen_format, books, [&](h5::Group& root) {
      write_tally(root, tally_);
      h5::Group simulation = root.create_group("simulation"), rig = root.create_group("rig");
      simulation_->save(simulation);
      rig_->save(rig);
    });
  }

  [[nodiscard]] double wall() const { return before_.wall + seconds_since(start_); }
  [[nodiscard]] std::map<std::string, double> cost() const {
    std::map<std::string, double> total = phase_seconds(timers_);
    for (const auto& [phase, seconds] : before_.cost) total[phase] += seconds;
    if (simulation_)
      for (const auto& [phase, seconds] : phase_seconds(simulation_->timers())) total[phase] += seconds;
    return total;
  }

  [[nodiscard]] double share_done() const {
    return (static_cast<double>(tally_.test) + rig_->share_done()) / static_cast<double>(rig_->tests());
  }

  void report_progress(bool last) {
    if (!request_.on_progress || (!last && last_report_ && seconds_since(*last_report_) < 0.1)) return;
    last_report_ = Clock::now();
    Progress progress;
    progress.stage = rig_->stage();
    progress.time = time();
    progress.end_time = share_done() > 0 ? time() / share_done() : 0;
    progress.window = tally_.steps_before + simulation_->windows();
    progress.energy_error = energy_error();
    progress.wall = seconds_since(start_);
    const double done = share_done() - first_done_;
    progress.eta = done > 0 ? progress.wall * (1 - share_done()) / done : -1;
    request_.on_progress(progress);
  }

  void conclude() {
    keep_summary(request_, recorder_.has_value(), summary_.error);
    if (recorder_) attempt(summary_, [this] { recorder_->flush(); });
    attempt(summary_, [this] { measure(); });
    write_summary(request_.folder, summary_);
    if (!recorder_) return;
    try {
      write_xdmf(request_.folder);
    } catch (const RunError& error) {
      if (summary_.error.empty()) summary_.error = error.what();
    }
  }

  void measure() {
    rig_->add_results(summary_.results, summary_.notes);
    summary_.energy_error = energy_error();
    summary_.momentum_error = momentum_error();
    summary_.simulated_time = time();
    summary_.cost = cost();
    summary_.peak_memory_bytes = peak_memory_bytes(0);
    summary_.wall_s = wall();
    summary_.notes["speed_factor"] = {request_.scene.rig.specimen.speed_factor, "1"};
    summary_.notes["threads"] = {static_cast<double>(omp_get_max_threads()), "1"};
    if (!simulation_) return;
    summary_.steps = tally_.steps_before + simulation_->windows();
    summary_.notes["window"] = {simulation_->step_plan().window, "s"};
    if (const auto* grains = dynamic_cast<const dem::DemInfill*>(&simulation_->infill())) {
      add_grain_notes(*grains, request_.scene.materials, summary_.status == "failed", summary_.notes);
      remark(remarks_on_overlaps(request_.scene, *grains));
    }
    summary_.notes["kinetic_share"] = {kinetic_share(), "1"};
    add_expelled_notes(expelled(), summary_.notes);
    const auto particle_steps =
        static_cast<double>(tally_.particle_steps_before + simulation_->infill().particle_steps());
    if (summary_.cost["infill"] > 0) summary_.particle_steps_per_s = particle_steps / summary_.cost["infill"];
  }

  const RunRequest& request_;
  std::unique_ptr<SpecimenTest> rig_;
  RunSummary summary_;
  SpecimenTally tally_;
  std::unique_ptr<coupler::Simulation> simulation_;
  std::optional<coupler::Recorder> recorder_;
  PhaseTimers timers_;
  SpentSoFar before_;
  double first_done_ = 0;
  bool stepped_ = false;
  Clock::time_point start_ = Clock::now();
  std::optional<Clock::time_point> last_report_;
};

}  // namespace

RunSummary run_specimen(const RunRequest& request) {
  return SpecimenRunner(request).run();
}

SpecimenOutcome measure_specimen(const Scene& scene, const std::atomic<bool>* stop) {
  const auto rig = make_specimen_test(scene);
  SpecimenOutcome outcome;
  for (std::size_t test = 0; test < rig->tests() && !outcome.stopped; ++test) {
    const auto simulation = build_specimen_test(scene, *rig, test);
    rig->begin(test, *simulation);
    std::uint64_t row = 0;
    while (!rig->done() && !outcome.stopped) {
      rig->drive(*simulation);
      simulation->advance_interval(rig->interval());
      simulation->set_time(rig->interval() * static_cast<double>(++row));
      rig->sample(*simulation);
      outcome.stopped = stop != nullptr && stop->load();
    }
  }
  std::map<std::string, Quantity> notes;
  rig->add_results(outcome.results, notes);
  outcome.curves = rig->curves();
  return outcome;
}

RunPlan plan_specimen(const Scene& scene) {
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  RunPlan plan;
  plan.effects = decide_effects(scene);
  const auto rig = make_specimen_test(scene);
  for (std::size_t test = 0; test < rig->tests(); ++test) {
    const auto simulation = build_specimen_test(scene, *rig, test);
    rig->begin(test, *simulation);
    plan.particles = simulation->infill().particles().size();
    // The first rows: caches warm, lists built; then those that are timed.
    constexpr double long_enough = 0.1, warm = 0.02;  // s
    Clock::time_point start = Clock::now();
    std::uint64_t windows = 0;
    double share = 0;
    bool warmed = false;
    while (!rig->done() && seconds_since(start) < (warmed ? long_enough : warm)) {
      rig->drive(*simulation);
      simulation->advance_interval(rig->interval());
      rig->sample(*simulation);
      if (warmed || seconds_since(start) < warm) continue;
      warmed = true;
      start = Clock::now();
      windows = simulation->windows();
      share = rig->share_done();
    }
    plan.window = simulation->step_plan().window;
    const double every = rig->interval();
    // Rows are the rig's own here, and nothing to propose another interval for.
    if (const std::string remark =
            scene.numerics.coupling_window > 0
                ? remark_on_windows(simulation->stable_steps(every), scene.numerics, every, "the rig's rows")
                : "";
        !remark.empty() && std::ranges::count(plan.remarks, remark) == 0)
      plan.remarks.push_back(remark);
    const double done = rig->share_done() - share;
    if (!(done > 0)) continue;
    plan.predicted_wall_s += seconds_since(start) / done;
    plan.windows += static_cast<std::uint64_t>(static_cast<double>(simulation->windows() - windows) / done);
  }
  plan.infill_step = plan.window;
  plan.predicted_memory_bytes = peak_memory_bytes(0);
  if (scene.rig.specimen.speed_factor > 1)
    plan.remarks.push_back(
        fmt::format("{:g} times faster than rig.speed: inertia_share and kinetic_share, which the run "
                    "reports, must stay small",
                    scene.rig.specimen.speed_factor));
  return plan;
}

}  // namespace tuft::rigs
