#include "studies/stepped_scene.h"

#include "core/error.h"
#include "rigs/processor_time.h"
#include "rigs/run_state.h"
#include "rigs/schedule.h"
#include "rigs/specimen_test.h"

namespace tuft::studies {
namespace {

const dem::DemInfill* grains_in(const coupler::Simulation& simulation) {
  return dynamic_cast<const dem::DemInfill*>(&simulation.infill());
}

/// Process id of a simulation's host, 0 where it has none.
int host_of(const coupler::Simulation& simulation) {
  const dem::DemInfill* const grains = grains_in(simulation);
  if (grains == nullptr) return 0;
  if (grains->host_process() <= 0)
    throw_input_error("grains are computed elsewhere (infill.dem.host), where processor time is not seen");
  return grains->host_process();
}

/// Impulse on bodies over the last interval, from body `first` on, N s.
double push_on(const coupler::Simulation& simulation, std::size_t first) {
  double push = 0;
  const std::vector<Vec3>& impulse = simulation.interval_impulse();
  for (std::size_t b = first; b < impulse.size(); ++b) push += impulse[b].norm();
  return push;
}

/// J, kinetic, of bodies that are free to move.
double motion_of(const coupler::Simulation& simulation) {
  double motion = 0;
  for (const coupler::RigidBody& body : simulation.bodies())
    if (body.present && !body.is_fixed()) motion += 0.5 * body.mass * body.velocity.squaredNorm();
  return motion;
}

/// Steps one interval after the other and says what they took.
template <class Step>
Stretch measure(const coupler::Simulation& simulation, std::uint64_t intervals, std::size_t first_body,
                Step&& step) {
  Stretch stretch;
  const int host = host_of(simulation);  // a state that is adopted comes with a new one
  const std::uint64_t windows = simulation.windows(), steps = simulation.infill().particle_steps();
  const double start = rigs::processor_seconds(host);
  for (std::uint64_t i = 0; i < intervals && step(); ++i, ++stretch.intervals)
    stretch.push += push_on(simulation, first_body);
  stretch.processor_s = rigs::processor_seconds(host) - start;
  stretch.windows = simulation.windows() - windows;
  stretch.particle_steps = simulation.infill().particle_steps() - steps;
  stretch.motion = motion_of(simulation);
  return stretch;
}

template <class Write>
void save_state(const std::filesystem::path& path, Write&& write) {
  h5::File file = h5::File::create_atomically(path);
  h5::Group root = file.root();
  write(root);
  file.commit();
}
void save_simulation(h5::Group& root, coupler::Simulation& simulation) {
  h5::Group group = root.create_group("simulation");
  simulation.save(group);
}
void load_simulation(const h5::Group& root, coupler::Simulation& simulation) {
  simulation.load(root.open_group("simulation"));
}

class Drop final : public RunningScene {
 public:
  Drop(const Scene& scene, const coupler::Packing* bed, const std::function<void(double)>& on_packing)
      : carpet_damping_(scene.turf.carpet.damping),
        state_(rigs::make_run_state(scene, bed, 0, [&](const std::string&, double done) {
          if (on_packing) on_packing(done);
        })) {
    static_cast<void>(host_of(state_.simulation()));
    state_.simulation().set_damping(scene.numerics.settle_damping, scene.numerics.settle_damping);
  }

  Stretch walk(std::uint64_t intervals) override {
    const double interval = state_.schedule.interval;
    return measure(state_.simulation(), intervals, state_.built.first_rig_body, [&] {
      state_.simulation().advance_interval(interval);
      return true;
    });
  }

  void release() override {
    state_.simulation().set_damping(carpet_damping_, 0);
    state_.rig->release(state_.simulation());
  }

  void save(const std::filesystem::path& file) override {
    save_state(file, [&](h5::Group& root) { save_simulation(root, state_.simulation()); });
  }
  void adopt(const std::filesystem::path& file) override {
    load_simulation(h5::File::open(file).root(), state_.simulation());
  }

  [[nodiscard]] const coupler::Simulation& simulation() const override { return state_.simulation(); }

 private:
  double carpet_damping_;
  rigs::RunState state_;
};

class FirstTest final : public RunningScene {
 public:
  explicit FirstTest(const Scene& scene)
      : rig_(rigs::make_specimen_test(scene)), simulation_(rigs::build_specimen_test(scene, *rig_, 0)) {
    static_cast<void>(host_of(*simulation_));
    rig_->begin(0, *simulation_);
  }

  Stretch walk(std::uint64_t intervals) override {
    return measure(*simulation_, intervals, 0, [&] {
      if (rig_->done()) return false;
      rig_->drive(*simulation_);
      simulation_->advance_interval(rig_->interval());
      rig_->sample(*simulation_);
      return true;
    });
  }

  void release() override {}  // the test's own drive moves it from the start

  void save(const std::filesystem::path& file) override {
    save_state(file, [&](h5::Group& root) {
      save_simulation(root, *simulation_);
      h5::Group rig = root.create_group("rig");
      rig_->save(rig);
    });
  }
  void adopt(const std::filesystem::path& file) override {
    const h5::File state = h5::File::open(file);
    load_simulation(state.root(), *simulation_);
    rig_->load(state.root().open_group("rig"));
  }

  [[nodiscard]] const coupler::Simulation& simulation() const override { return *simulation_; }

 private:
  std::unique_ptr<rigs::SpecimenTest> rig_;
  std::unique_ptr<coupler::Simulation> simulation_;
};

}  // namespace

double interval_of(const Scene& scene) {
  return scene.rig.is_specimen() ? rigs::make_specimen_test(scene)->interval()
                                 : rigs::make_schedule(scene).interval;
}

std::unique_ptr<RunningScene> step_scene(const Scene& scene, const coupler::Packing* bed,
                                         const std::function<void(double)>& on_packing) {
  if (scene.rig.is_specimen()) return std::make_unique<FirstTest>(scene);
  return std::make_unique<Drop>(scene, bed, on_packing);
}

std::optional<coupler::Packing> bed_of(const RunningScene& running, const Scene& scene) {
  const dem::DemInfill* const infill = grains_in(running.simulation());
  if (infill == nullptr || scene.rig.is_specimen()) return std::nullopt;
  const ParticleView p = infill->particles();
  coupler::Packing bed;
  bed.carpet = running.simulation().carpet().shape();
  dem::Grains& grains = bed.grains;
  grains.position = {{p.x.begin(), p.x.end()}, {p.y.begin(), p.y.end()}, {p.z.begin(), p.z.end()}};
  grains.radius.assign(p.radius.begin(), p.radius.end());
  grains.layer.assign(p.layer.begin(), p.layer.end());
  grains.material.assign(p.material.begin(), p.material.end());
  grains.body.assign(infill->clumps().begin(), infill->clumps().end());
  for (const Index material : grains.material)
    grains.density.push_back(scene.materials.at(static_cast<std::size_t>(material)).grain->density);
  return bed;
}

}  // namespace tuft::studies
