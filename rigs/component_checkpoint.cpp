#include "rigs/component_checkpoint.h"

#include <fmt/format.h>

#include "rigs/checkpoint_books.h"

namespace tuft::rigs {
namespace {

constexpr CheckpointFormat component_format{"component_format", 1};
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
}

}  // namespace

void write_component_checkpoint(const std::filesystem::path& path, const Scene& scene,
                                const ComponentState& state,
                                const std::function<void(h5::Group&)>& write_rest) {
  write_books(path, scene, component_format, {state.recorded, state.spent}, [&](h5::Group& root) {
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
    write_rest(root);
  });
}

void load_component_checkpoint(const std::filesystem::path& path, const Scene& scene, ComponentState& state,
                               const std::function<void(const h5::Group&)>& read_rest) {
  const CheckpointBooks books = read_books(path, scene, component_format, [&](const h5::Group& root) {
    read_state(root, state);
    read_rest(root);
  });
  state.recorded = books.recorded;
  state.spent = books.spent;
}

}  // namespace tuft::rigs
