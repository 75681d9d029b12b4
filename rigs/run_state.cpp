#include "rigs/run_state.h"

#include "coupler/roller.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "core/scene_reader.h"

namespace tuft::rigs {
namespace {

std::uint64_t intervals_in(double duration, double interval) {
  return static_cast<std::uint64_t>(std::llround(duration / interval));
}

constexpr std::uint64_t checkpoint_format = 18;

h5::File open_checkpoint(const std::filesystem::path& path, const Scene& scene) {
  if (!std::filesystem::exists(path))
    throw_input_error("{}: no checkpoint to resume from: start the scene again with tuft run", path.string());
  try {
    h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    const std::uint64_t format = root.read_count("format");
    if (format != checkpoint_format)
      throw_input_error(
          "{}: checkpoint format {} is not the format {} of this program: resume with the version that wrote "
          "it",
          path.string(), format, checkpoint_format);
    const std::string hash = root.read_string("scene_hash");
    if (hash != physics_hash(scene))
      throw_input_error(
          "{}: checkpoint of another scene (scene hash {}, this scene {}): restore the scene.toml it was "
          "written with, or start the scene again with tuft run",
          path.string(), hash, physics_hash(scene));
    return file;
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
}

/// Empty where it has not been measured.
void save_bed(h5::Group& root, const char* name, const std::optional<coupler::BedState>& bed) {
  std::vector<double> values;
  if (bed) values = numbers_of(*bed);
  root.write(name, std::span<const double>(values));
}
/// None, or `count` finite values.
std::vector<double> read_none_or(const h5::Group& root, const char* name, std::size_t count) {
  if (root.read_doubles(name).empty()) return {};
  return h5::read_checked(root, name, count);
}

std::optional<coupler::BedState> load_bed(const h5::Group& root, const char* name) {
  const std::vector<double> values = read_none_or(root, name, numbers_of(coupler::BedState{}).size());
  if (values.empty()) return std::nullopt;
  return coupler::bed_of(values);
}

void save_packing(h5::Group& root, const std::optional<coupler::PackingReport>& packing) {
  std::vector<double> values;
  if (packing) values = numbers_of(*packing);
  root.write("packing", std::span<const double>(values));
}
std::optional<coupler::PackingReport> load_packing(const h5::Group& root) {
  const std::vector<double> values =
      read_none_or(root, "packing", numbers_of(coupler::PackingReport{}).size());
  if (values.empty()) return std::nullopt;
  return coupler::packing_report_of(values);
}

}  // namespace

std::string physics_hash(const Scene& scene) {
  Scene bare = scene;
  bare.file.clear();
  bare.numerics.threads = 0;
  bare.infill.dem.host.clear();
  bare.infill.dem.use_cache = true;
  return content_hash(write_scene(bare));
}

Schedule make_schedule(const Scene& scene) {
  Schedule s;
  s.interval = scene.output.histories;
  const auto at_least_one = [&](double duration) {
    return std::max<std::uint64_t>(1, intervals_in(duration, s.interval));
  };
  const Conditioning& conditioning = scene.conditioning;
  if (conditioning.on()) {
    const bool rolls = conditioning.method == "roller";
    s.press = at_least_one(rolls ? coupler::Roller(scene).pass_time() : conditioning.press_time);
    s.lift = rolls ? 0 : at_least_one(conditioning.lift_time);
    s.presses = static_cast<std::uint64_t>(rolls ? conditioning.roller.passes : conditioning.presses);
    s.rest = intervals_in(conditioning.settle_time, s.interval);
    s.conditioning_frame_every = at_least_one(conditioning.frames);
  }
  s.settle = s.settle_least = intervals_in(scene.numerics.settle_time, s.interval);
  if (scene.infill.approach == Approach::dem && !scene.rig.is_component() && !scene.rig.is_specimen()) {
    constexpr double look_every = 1e-3;  // s
    s.settle = std::max(s.settle, intervals_in(scene.numerics.settle_time_limit, s.interval));
    s.look_every = at_least_one(look_every);
  }
  constexpr double usual_settling = 0.03;  // s, of coarse beds (docs/theory/dem.md)
  s.settle_expected = std::min(s.settle, std::max(s.settle_least, intervals_in(usual_settling, s.interval)));
  s.end = s.release() + at_least_one(scene.info.duration);
  s.frame_every = at_least_one(scene.output.frames);
  if (scene.output.checkpoint_every > 0) s.checkpoint_every = at_least_one(scene.output.checkpoint_every);
  return s;
}

RunState make_run_state(const Scene& scene, const coupler::Packing* bed, std::uint64_t index,
                        const std::function<void(const std::string&, double)>& on_progress) {
  RunState state;
  state.schedule = make_schedule(scene);
  state.effects = decide_effects(scene);
  state.rig = make_rig(scene);
  coupler::BuildRequest request;
  request.scene = &scene;
  request.effects = state.effects;
  request.rig_bodies = state.rig->bodies();
  request.energy_scale = state.rig->energy_scale();
  if (bed != nullptr) request.grains = &bed->grains;
  if (bed != nullptr && bed->carpet.position.size() > 0) request.carpet = &bed->carpet;
  request.on_progress = on_progress;
  const bool conditioned = scene.conditioning.on();
  const bool grains_settle = state.schedule.settle != state.schedule.settle_least;
  request.start_time = conditioned || grains_settle ? state.schedule.time(0) : -scene.numerics.settle_time;
  // A checkpoint taken where conditioning ends is from before the switch.
  request.before_conditioning = conditioned && index <= state.schedule.conditioned();
  Scene before_release = scene;
  before_release.infill.dem.overlap_limit = 0;  // counts from the release on
  request.scene = &before_release;
  state.built = coupler::build_simulation(request);
  state.packing = state.built.packing;
  state.rig->set_first_body(state.built.first_rig_body);
  state.simulation().set_time(state.schedule.time(0));
  if (conditioned) state.compaction.emplace(scene, state.schedule, state.built);
  return state;
}

void write_checkpoint(const std::filesystem::path& path, const Scene& scene, RunState& state,
                      const std::map<std::string, std::uint64_t>& rows, const SpentSoFar& spent) {
  h5::File file = h5::File::create_atomically(path);
  h5::Group root = file.root();
  root.write_scalar("format", checkpoint_format);
  root.write_string("scene_hash", physics_hash(scene));
  root.write_scalar("index", state.index);
  root.write("layer_tops", std::span<const double>(state.layer_tops));
  save_bed(root, "bed_placed", state.bed_placed);
  save_bed(root, "bed_released", state.bed_released);
  save_packing(root, state.packing);
  root.write_scalar("settled", state.settled);
  if (state.compaction) {
    h5::Group compaction = root.create_group("compaction");
    state.compaction->save(compaction);
  }
  h5::Group spent_group = root.create_group("spent");
  spent_group.write_scalar("wall", spent.wall);
  for (const auto& [phase, seconds] : spent.cost) spent_group.write_scalar(phase, seconds);
  h5::Group row_group = root.create_group("rows");
  std::string names;
  std::vector<std::uint64_t> counts;
  for (const auto& [name, count] : rows) {
    names += name + "\n";
    counts.push_back(count);
  }
  row_group.write_string("names", names);
  row_group.write("counts", std::span<const std::uint64_t>(counts));
  if (state.built.dem != nullptr) {
    const ParticleView p = state.built.dem->particles();
    h5::Group grains = root.create_group("grains");
    grains.write("x", p.x);
    grains.write("y", p.y);
    grains.write("z", p.z);
    grains.write("radius", p.radius);
    grains.write("mass", p.mass);
    grains.write("layer", p.layer);
    grains.write("material", p.material);
    if (const auto bodies = state.built.dem->clumps(); !bodies.empty()) grains.write("body", bodies);
  }
  h5::Group simulation = root.create_group("simulation");
  state.simulation().save(simulation);
  h5::Group rig = root.create_group("rig");
  state.rig->save(rig);
  file.commit();
}

std::uint64_t read_checkpoint_index(const std::filesystem::path& path, const Scene& scene) {
  const h5::File file = open_checkpoint(path, scene);
  try {
    return file.root().read_count("index");
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
}

std::optional<coupler::Packing> read_checkpoint_bed(const std::filesystem::path& path, const Scene& scene) {
  const h5::File file = open_checkpoint(path, scene);
  if (!file.root().has("grains")) return std::nullopt;
  try {
    const h5::Group group = file.root().open_group("grains");
    coupler::Packing bed;
    dem::Grains& grains = bed.grains;
    grains.position = {group.read_doubles("x"), group.read_doubles("y"), group.read_doubles("z")};
    grains.radius = group.read_doubles("radius");
    grains.layer = group.read_ints("layer");
    grains.material = group.read_ints("material");
    if (group.has("body")) grains.body = group.read_ints("body");
    const std::size_t count = grains.radius.size();
    h5::check_length(group, "x", grains.position.x.size(), count);
    h5::check_length(group, "y", grains.position.y.size(), count);
    h5::check_length(group, "z", grains.position.z.size(), count);
    h5::check_length(group, "layer", grains.layer.size(), count);
    h5::check_length(group, "material", grains.material.size(), count);
    if (!grains.body.empty()) h5::check_length(group, "body", grains.body.size(), count);
    const auto last = static_cast<double>(scene.materials.size()) - 1;
    for (std::size_t k = 0; k < grains.material.size(); ++k) {
      h5::check_whole(group, "material", k, grains.material[k], {0, last});
      const Material& material = scene.materials[static_cast<std::size_t>(grains.material[k])];
      if (!material.grain)
        h5::refuse(group, "material", fmt::format("[{}] is \"{}\", not a grain", k, material.name));
      grains.density.push_back(material.grain->density);
    }
    return bed;
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
}

CheckpointRest read_checkpoint(const std::filesystem::path& path, const Scene& scene, RunState& state) {
  const h5::File file = open_checkpoint(path, scene);
  const h5::Group root = file.root();
  CheckpointRest rest;
  try {
    state.index = root.read_count("index");
    state.layer_tops = root.read_doubles("layer_tops");
    state.bed_placed = load_bed(root, "bed_placed");
    state.bed_released = load_bed(root, "bed_released");
    state.packing = load_packing(root);
    state.settled = root.read_count("settled");
    if (state.compaction) state.compaction->load(root.open_group("compaction"));
    const h5::Group spent_group = root.open_group("spent");
    rest.spent.wall = spent_group.read_double("wall");
    for (const auto phase : phase_names) rest.spent.cost[std::string(phase)] = spent_group.read_double(phase);
    const h5::Group row_group = root.open_group("rows");
    const std::string names = row_group.read_string("names");
    const std::vector<std::uint64_t> counts = row_group.read_counts("counts");
    std::size_t begin = 0;
    for (const std::uint64_t count : counts) {
      const std::size_t end = names.find('\n', begin);
      rest.rows[names.substr(begin, end - begin)] = count;
      begin = end + 1;
    }
    state.simulation().load(root.open_group("simulation"));
    state.rig->load(root.open_group("rig"));
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
  return rest;
}

}  // namespace tuft::rigs
