#include "rigs/component_checkpoint.h"

#include "core/error.h"
#include "core/timers.h"

namespace tuft::rigs {
namespace {

constexpr std::uint64_t component_format = 1;
constexpr std::size_t row_values = 8;

void write_rows(h5::Group& group, const std::string& name, const std::vector<TensionRow>& rows) {
  std::vector<double> flat;
  for (const TensionRow& r : rows)
    flat.insert(flat.end(), {r.time, r.strain, r.stress, r.true_stress, r.force, r.force_held,
                             r.principal_strain, r.failed ? 1.0 : 0.0});
  if (!flat.empty()) group.write(name, std::span<const double>(flat));
}

std::vector<TensionRow> read_rows(const h5::Group& group, const std::string& name) {
  std::vector<TensionRow> rows;
  if (!group.has(name)) return rows;
  const std::vector<double> flat = group.read_doubles(name);
  for (std::size_t i = 0; i + row_values <= flat.size(); i += row_values)
    rows.push_back({flat[i], flat[i + 1], flat[i + 2], flat[i + 3], flat[i + 4], flat[i + 5], flat[i + 6],
                    flat[i + 7] != 0});
  return rows;
}

std::string test_name(std::size_t test) {
  return fmt::format("test_{}", test);
}

void read_state(const h5::Group& root, ComponentState& state) {
  state.test = root.read_count("test");
  state.row = root.read_count("row");
  state.steps_before = root.read_count("steps_before");
  state.element_steps_before = root.read_count("element_steps_before");
  state.time_before = root.read_double("time_before");
  state.energy_error = root.read_double("energy_error");
  state.momentum_error = root.read_double("momentum_error");
  state.kinetic_share = root.read_doubles("kinetic_share");
  const h5::Group tests = root.open_group("tests");
  for (std::size_t test = 0; test < state.rows.size(); ++test)
    state.rows[test] = read_rows(tests, test_name(test));
  const h5::Group spent = root.open_group("spent");
  state.spent.wall = spent.read_double("wall");
  for (const auto phase : phase_names) state.spent.cost[std::string(phase)] = spent.read_double(phase);
  const h5::Group recorded = root.open_group("recorded");
  const std::string names = recorded.read_string("names");
  std::size_t begin = 0;
  for (const std::uint64_t count : recorded.read_counts("counts")) {
    const std::size_t end = names.find('\n', begin);
    state.recorded[names.substr(begin, end - begin)] = count;
    begin = end + 1;
  }
}

}  // namespace

void write_component_checkpoint(const std::filesystem::path& path, const Scene& scene,
                                const ComponentState& state,
                                const std::function<void(h5::Group&)>& write_rest) {
  h5::File file = h5::File::create_atomically(path);
  h5::Group root = file.root();
  root.write_scalar("component_format", component_format);
  root.write_string("scene_hash", physics_hash(scene));
  root.write_scalar("test", state.test);
  root.write_scalar("row", state.row);
  root.write_scalar("steps_before", state.steps_before);
  root.write_scalar("element_steps_before", state.element_steps_before);
  root.write_scalar("time_before", state.time_before);
  root.write_scalar("energy_error", state.energy_error);
  root.write_scalar("momentum_error", state.momentum_error);
  root.write("kinetic_share", std::span<const double>(state.kinetic_share));
  h5::Group tests = root.create_group("tests");
  for (std::size_t test = 0; test < state.rows.size(); ++test)
    write_rows(tests, test_name(test), state.rows[test]);
  h5::Group spent = root.create_group("spent");
  spent.write_scalar("wall", state.spent.wall);
  for (const auto& [phase, seconds] : state.spent.cost) spent.write_scalar(phase, seconds);
  h5::Group recorded = root.create_group("recorded");
  std::string names;
  std::vector<std::uint64_t> counts;
  for (const auto& [name, count] : state.recorded) {
    names += name + "\n";
    counts.push_back(count);
  }
  recorded.write_string("names", names);
  recorded.write("counts", std::span<const std::uint64_t>(counts));
  write_rest(root);
  file.commit();
}

void load_component_checkpoint(const std::filesystem::path& path, const Scene& scene, ComponentState& state,
                               const std::function<void(const h5::Group&)>& read_rest) {
  if (!std::filesystem::exists(path))
    throw_input_error("{}: no checkpoint to resume from: start the scene again with tuft run", path.string());
  try {
    const h5::File file = h5::File::open(path);
    const h5::Group root = file.root();
    if (!root.has("component_format") || root.read_count("component_format") != component_format)
      throw_input_error("{}: checkpoint of another format: resume with the version that wrote it",
                        path.string());
    if (root.read_string("scene_hash") != physics_hash(scene))
      throw_input_error(
          "{}: checkpoint of another scene: restore the scene.toml it was written with, or start the scene "
          "again "
          "with tuft run",
          path.string());
    read_state(root, state);
    read_rest(root);
  } catch (const RunError& error) {
    throw_input_error("{}: checkpoint is truncated or damaged ({}): start the scene again with tuft run",
                      path.string(), error.what());
  }
}

}  // namespace tuft::rigs
