#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "app/number_format.h"
#include "app/text_table.h"
#include "app/verbs.h"
#include "core/error.h"
#include "core/units.h"
#include "coupler/build_simulation.h"
#include "fe_carpet/mesh_export.h"
#include "fe_carpet/mesh_topology.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

struct CarpetArguments {
  SceneArguments scene;
  std::string out;
  std::string unit = "mm";
};

std::string counts_table(const fe::MeshSummary& sum) {
  TextTable table;
  table.set_prose(1);
  table.add({"tufts", format_count(sum.tufts)});
  table.add({"strands", format_count(sum.strands)});
  table.add({"elements", fmt::format("{} ({} of the backing, {} of fibres)",
                                     format_count(sum.backing_elements + sum.fibre_elements),
                                     format_count(sum.backing_elements), format_count(sum.fibre_elements))});
  table.add(
      {"nodes", fmt::format("{} ({} clamped)", format_count(sum.nodes), format_count(sum.clamped_nodes))});
  table.add(
      {"mass", fmt::format("{} ({} of the backing, {} of fibres)",
                           format_quantity(sum.backing_mass + sum.fibre_mass, "kg"),
                           format_quantity(sum.backing_mass, "kg"), format_quantity(sum.fibre_mass, "kg"))});
  return table.text();
}

double factor_of_unit(const std::string& unit) {
  try {
    const double factor = unit_factor(unit, "m");
    if (!(factor > 0)) throw_input_error("must be positive; write for example mm");
    return factor;
  } catch (const InputError& error) {
    throw_input_error("--unit {}: {}", unit, error.what());
  }
}

/// The file can be written, and is not the one that the carpet is read from.
void check_target(const std::filesystem::path& out, const Scene& scene) {
  std::error_code ignored;
  const std::filesystem::path folder = out.has_parent_path() ? out.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, ignored))
    throw_input_error("{}: there is no folder {}; choose another --out", out.string(), folder.string());
  if (!scene.turf.carpet.mesh.file.empty() &&
      std::filesystem::equivalent(out, scene.turf.carpet.mesh.file, ignored))
    throw_input_error("{}: is the mesh file of the scene itself; choose another --out", out.string());
}

int carpet(const CarpetArguments& arguments) {
  const Scene scene = read_scene_arguments(arguments.scene);
  const double unit = factor_of_unit(arguments.unit);
  const std::vector<ShellMaterial> materials{scene.turf.carpet.backing, scene.turf.carpet.fibre};
  const fe::ShellMesh mesh = coupler::build_carpet_mesh(scene, effect_on(decide_effects(scene), "fibres"));
  if (!arguments.out.empty()) {
    const std::filesystem::path out = arguments.out;
    check_target(out, scene);
    rigs::write_text_file(
        out, fe::export_mesh_text(mesh, materials, out.extension().string(), {unit, arguments.unit}));
  }
  fmt::print("{}", counts_table(fe::summarise(mesh, materials)));
  for (const std::string& note : coupler::carpet_mesh_notes(scene)) fmt::print("note: {}\n", note);
  if (!arguments.out.empty()) fmt::print("mesh: {} (lengths in {})\n", arguments.out, arguments.unit);
  return 0;
}

}  // namespace

void register_carpet(CLI::App& program, Action& action) {
  CLI::App* verb =
      program.add_subcommand("carpet", "The carpet's mesh alone: its size, and a file for other programs");
  auto arguments = std::make_shared<CarpetArguments>();
  add_scene_options(*verb, arguments->scene, false);
  verb->add_option("--out", arguments->out,
                   "file to write; its ending decides: .vtk, .vtu (ParaView), .msh (Gmsh), .k (LS-DYNA)");
  verb->add_option("--unit", arguments->unit, "unit of lengths in the file")->capture_default_str();
  verb->callback([arguments, &action] { action = [arguments] { return carpet(*arguments); }; });
}

}  // namespace tuft::app
