// The stable steps of a design of inputs/turfs/, and what mass scaling and subcycling make of them
// (docs/theory/shells.md):
//   build/release/bin/print_carpet_steps DESIGN [SIZE in m, 0.1 [times the fibres' modulus, 1]]
// Run in the repository's root.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "core/scene_reader.h"
#include "fe_carpet/carpet.h"

namespace {

using tuft::Vec3;

/// Wall seconds for a second of the carpet alone, swaying, at 0.8 of its stable step, one thread; steps per
/// window of slow elements.
struct Cost {
  double seconds;
  int ratio;
};

Cost cost_of(const tuft::fe::ShellMesh& mesh, const std::vector<tuft::ShellMaterial>& materials,
             tuft::fe::CarpetOptions options, bool subcycle) {
  options.subcycle = subcycle;
  tuft::fe::Carpet carpet(mesh, materials, options);
  const std::size_t nodes = carpet.nodes().x.size();
  for (std::size_t n = 0; n < nodes; ++n)
    if (!carpet.nodes().clamped[n])
      carpet.set_velocity(n, Vec3(carpet.nodes().z[n] / 0.06, 0, 0), Vec3(0, 0, 0));
  tuft::Vec3Array load;
  load.assign(nodes, 0.0);
  const double dt = 0.8 * carpet.stable_step();
  const int block = 4 * carpet.subcycle();
  for (int i = 0; i < block; ++i) carpet.step(dt, load);
  const auto start = std::chrono::steady_clock::now();
  double seconds = 0;
  int steps = 0;
  while (seconds < 4) {
    for (int i = 0; i < block; ++i) carpet.step(dt, load);
    steps += block;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return {seconds / (steps * dt), carpet.subcycle()};
}

void print(const std::string& design, double size, double stiffer) {
  const tuft::CarpetDesign d =
      tuft::read_scene("inputs/clegg_small.toml", {{"turf.design", design}}).turf.carpet;
  const tuft::fe::ShellMesh mesh = tuft::fe::generate_carpet(d, {size, size}, 1, true);
  std::vector<tuft::ShellMaterial> materials{d.backing, d.fibre};
  materials[1].young_modulus *= stiffer;
  tuft::fe::CarpetOptions options;
  options.sections = {d.backing_section, d.fibre_section};
  const tuft::fe::Carpet plain(mesh, materials, options);
  const std::vector<double> steps = plain.stable_steps_of_materials();
  double backing = 0;
  for (const tuft::Index m : mesh.material) backing += m == 0;
  fmt::print("{}: {} shells, {} of the backing; stable steps: backing {:.4g} us, fibres {:.4g} us\n", design,
             mesh.quads.size(), backing, 1e6 * steps[0], 1e6 * steps[1]);
  for (const double limit : {0.001, 0.01, 0.05}) {
    options.mass_scaling_limit = limit;
    const tuft::fe::Carpet carpet(mesh, materials, options);
    const tuft::fe::MassScaling& s = carpet.mass_scaling();
    const std::vector<double> scaled = carpet.stable_steps_of_materials();
    fmt::print(
        "  {:.3g} % added to {} shells: step {:.4g} us, {:.4g} times; backing {:.4g}, fibres {:.4g} us\n",
        100 * s.share(), s.elements, 1e6 * s.step_after, s.step_after / s.step_before, 1e6 * scaled[0],
        1e6 * scaled[1]);
  }
  options.mass_scaling_limit = 0;
  tuft::set_threads(1);
  const Cost all = cost_of(mesh, materials, options, false), some = cost_of(mesh, materials, options, true);
  fmt::print("  one second of the carpet: {:.4g} s; subcycled by {}: {:.4g} s\n", all.seconds, some.ratio,
             some.seconds);
}

}  // namespace

int main(int count, char** words) {
  try {
    if (count >= 2) {
      print(words[1], count > 2 ? std::stod(words[2]) : 0.1, count > 3 ? std::stod(words[3]) : 1);
      return 0;
    }
  } catch (const tuft::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
  std::fputs("usage: print_carpet_steps DESIGN [SIZE [TIMES]]\n", stderr);
  return 2;
}
