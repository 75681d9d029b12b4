#include "rigs/checkpoint_moment.h"

#include <optional>
#include <utility>

#include "core/parallel.h"
#include "core/scene_reader.h"
#include "coupler/recorder.h"
#include "rigs/run_state.h"
#include "rigs/specimen_checkpoint.h"
#include "rigs/specimen_test.h"
#include "rigs/xdmf.h"

namespace tuft::rigs {
namespace {

CheckpointMoment restore_specimen(const std::filesystem::path& checkpoint, const Scene& scene) {
  const std::unique_ptr<SpecimenTest> rig = make_specimen_test(scene);
  const auto read = [&](const auto& rest) {
    static_cast<void>(read_books(checkpoint, scene, specimen_format, rest));
  };
  SpecimenTally tally;
  read([&](const h5::Group& root) { tally = read_tally(root, rig->tests()); });
  CheckpointMoment moment;
  moment.simulation = build_specimen_test(scene, *rig, tally.test);  // where that fails, no file is to blame
  read([&](const h5::Group& root) { moment.simulation->load(root.open_group("simulation")); });
  moment.time = tally.time_before + rig->interval() * static_cast<double>(tally.row);
  return moment;
}

CheckpointMoment restore_turf(const std::filesystem::path& checkpoint, const Scene& scene) {
  const std::uint64_t index = read_checkpoint_index(checkpoint, scene);
  const std::optional<coupler::Packing> bed = read_checkpoint_bed(checkpoint, scene);
  RunState state = make_run_state(scene, bed ? &*bed : nullptr, index, {});
  (void)read_checkpoint(checkpoint, scene, state);
  return {state.schedule.time(state.index), std::move(state.built.simulation)};
}

}  // namespace

CheckpointMoment restore_checkpoint(const std::filesystem::path& folder, const Scene& scene) {
  if (scene.numerics.threads > 0) set_threads(scene.numerics.threads);
  const std::filesystem::path checkpoint = folder / "checkpoint.h5";
  return scene.rig.is_specimen() ? restore_specimen(checkpoint, scene) : restore_turf(checkpoint, scene);
}

void record_moment(const CheckpointMoment& moment, const Scene& scene, const std::filesystem::path& folder) {
  coupler::Recorder recorder =
      coupler::Recorder::create(folder / "run.h5", *moment.simulation, write_scene(scene), TUFT_VERSION, {},
                                {}, coupler::micro_settings(scene));
  recorder.record_frame(moment.time, *moment.simulation);
  recorder.flush();
  write_xdmf(folder);
}

}  // namespace tuft::rigs
