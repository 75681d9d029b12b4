/// Element-steps per second of the shells on a field of 50 000 fibre shells: 2 381 strands of 21 elements of
/// 3 x 1.3 x 0.1 mm (a 63 mm pile), clamped at their roots and swinging. One-point elements with stress
/// resultants and with three points through the thickness; fully integrated viscoelastic ones with three.
#include <benchmark/benchmark.h>

#include <cmath>

#include "core/parallel.h"
#include "fe_carpet/carpet.h"

namespace {

using tuft::Index;
using tuft::Vec3;

constexpr Index strands = 2381, elements_per_strand = 21;
constexpr double element_length = 0.003, strand_width = 0.0013, strand_thickness = 0.0001, spacing = 0.005;
constexpr Index strands_per_row = 49;
constexpr double step_safety = 0.9;

tuft::fe::ShellMesh fibre_field() {
  tuft::fe::ShellMesh mesh;
  mesh.surface_count = strands + 1;
  for (Index s = 0; s < strands; ++s) {
    const double x = spacing * (s % strands_per_row), y = spacing * (s / strands_per_row);
    for (Index k = 0; k <= elements_per_strand; ++k) {
      const auto left = static_cast<Index>(mesh.nodes.size());
      mesh.nodes.push_back({x, y, element_length * k});
      mesh.nodes.push_back({x + strand_width, y, element_length * k});
      mesh.clamped.insert(mesh.clamped.end(), 2, k == 0);
      if (k == 0) continue;
      mesh.quads.push_back({left - 2, left - 1, left + 1, left});
      mesh.thickness.push_back(strand_thickness);
      mesh.material.push_back(0);
      mesh.surface.push_back(s + 1);
    }
  }
  return mesh;
}

void step_field(benchmark::State& state, const tuft::ShellMaterial& material,
                const tuft::ShellSection& section) {
  tuft::set_threads(static_cast<int>(state.range(0)));
  tuft::fe::CarpetOptions options;
  options.section = section;
  tuft::fe::Carpet carpet(fibre_field(), {material}, options);
  const std::size_t nodes = carpet.nodes().x.size();
  // Strands bend as in a blow: speed grows along them, each in a direction of its own.
  for (std::size_t n = 0; n < nodes; ++n) {
    if (carpet.nodes().clamped[n]) continue;
    const double share = carpet.nodes().z[n] / (element_length * elements_per_strand);
    const double direction = 0.1 * static_cast<double>(n / (2 * (elements_per_strand + 1)));
    carpet.set_velocity(n, share * Vec3(std::cos(direction), std::sin(direction), 0), Vec3(0, 0, 0));
  }
  tuft::Vec3Array load;
  load.assign(nodes, 0.0);
  const double dt = step_safety * carpet.stable_step();
  for (int i = 0; i < 5; ++i) carpet.step(dt, load);
  const std::uint64_t before = carpet.element_steps();
  for (auto _ : state) carpet.step(dt, load);
  state.counters["element_steps"] =
      benchmark::Counter(static_cast<double>(carpet.element_steps() - before), benchmark::Counter::kIsRate);
}

const tuft::ShellMaterial polyethylene{0.5e9, 0.4, 920};

void shell_one_point_elastic(benchmark::State& state) {
  step_field(state, polyethylene, {});
}
void shell_one_point_3pt(benchmark::State& state) {
  tuft::ShellSection section;
  section.thickness_points = 3;
  step_field(state, polyethylene, section);
}
void shell_full_elastic(benchmark::State& state) {
  tuft::ShellSection section;
  section.element = tuft::ElementKind::fully_integrated;
  step_field(state, polyethylene, section);
}
void shell_full_prony_3pt(benchmark::State& state) {
  // Published: G = 0.061, 0.0663, 0.2 GPa with decays 0, 10, 1000 1/s (Bustamante et al. 2024).
  const tuft::ShellMaterial slit_film{2 * 0.3273e9 * 1.42, 0.42, 920, {{0.0663e9, 10}, {0.2e9, 1000}}};
  tuft::ShellSection section;
  section.element = tuft::ElementKind::fully_integrated;
  section.thickness_points = 3;
  step_field(state, slit_film, section);
}

BENCHMARK(shell_one_point_elastic)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_one_point_3pt)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_full_elastic)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(shell_full_prony_3pt)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
