#include "fe_carpet/subcycling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "fe_carpet/carpet_impl.h"
#include "fe_carpet/erosion.h"

namespace tuft::fe {
namespace {

constexpr std::size_t threads_pay_above = 1000;

/// A node's sums cost a hundredth of an element: threads pay for far more of them.
constexpr std::size_t threads_pay_above_nodes = 50000;

/// Elements of a slow material that are evaluated with the fast ones, counted from these. A kick on a node
/// that fast elements share drives their modes, in resonance where a whole number of half periods fits a
/// window (Fong, Darve & Lew 2008): strips of two parts then grew at every ratio. Above the highest frequency
/// of the slow elements a wave dies out within one of them, and with one layer no growth was found
/// (docs/theory/shells.md).
constexpr int buffer_layers = 1;
/// Of the slow elements' own step, that a window may take.
constexpr double outer_share = 0.8;

/// Longer windows gain nothing more: the slow elements cost 1/m of what they did.
constexpr int longest_window = 32;

}  // namespace

void Subcycling::close_window(const NodeMotion& motion) {
  const double rate = drifted > 0 ? 1 / drifted : 0;
#pragma omp parallel for schedule(static) if (nodes.size() > threads_pay_above_nodes)
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto n = static_cast<std::size_t>(nodes[i]);
    const Vec3 now = motion.position[n];
    window.velocity.set(n, rate * (now - window.position[n]));
    window.angular_velocity.set(n, rate * turn[n]);
    window.position.set(n, now);
    turn.set(n, Vec3(0, 0, 0));
  }
}

void Subcycling::drift(const NodeMotion& motion, double dt) {
  drifted += dt;
#pragma omp parallel for schedule(static) if (nodes.size() > threads_pay_above_nodes)
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto n = static_cast<std::size_t>(nodes[i]);
    turn.add(n, dt * motion.angular_velocity[n]);
  }
}

Subcycling make_subcycling(const ShellMesh& mesh, const ElementArrays& elements,
                           std::vector<std::uint8_t> slow) {
  Subcycling s;
  s.slow = std::move(slow);
  for (std::size_t b = 0; b < elements.block.size(); ++b)
    if (!s.slow[elements.block[b].family]) s.fast_blocks.push_back(b);

  const std::size_t count = mesh.nodes.size();
  std::vector<std::uint8_t> of_slow(count, 0);
  std::vector<std::vector<Index>> corners(count);
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const auto slot = static_cast<std::size_t>(elements.slot[e]);
    const bool is_slow = s.slow[static_cast<std::size_t>(elements.batch_family[slot / lanes])] != 0;
    s.slow_elements += is_slow;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const auto n = static_cast<std::size_t>(mesh.quads[e][corner]);
      if (is_slow)
        of_slow[n] = 1;
      else
        corners[n].push_back(
            static_cast<Index>(slot / lanes * batch_values + corner * corner_values + slot % lanes));
    }
  }
  s.first_corner.push_back(0);
  for (std::size_t n = 0; n < count; ++n) {
    s.corner_offset.insert(s.corner_offset.end(), corners[n].begin(), corners[n].end());
    s.first_corner.push_back(static_cast<Index>(s.corner_offset.size()));
    if (of_slow[n]) s.nodes.push_back(static_cast<Index>(n));
  }
  s.window.position = positions_with_spares(mesh, elements);
  s.window.velocity.assign(s.window.position.size(), 0.0);
  s.window.angular_velocity.assign(s.window.position.size(), 0.0);
  s.turn.assign(count, 0.0);
  return s;
}

SlowFamilies split_slow_families(const ShellMesh& mesh, std::span<const double> step_of_material) {
  SlowFamilies split;
  split.material = mesh.material;
  const std::size_t materials = step_of_material.size();
  const double fastest = *std::min_element(step_of_material.begin(), step_of_material.end());
  std::vector<Index> family_of_slow(materials, -1);
  for (std::size_t m = 0; m < materials; ++m)
    if (std::isfinite(step_of_material[m]) && step_of_material[m] >= 2 * fastest / outer_share) {
      family_of_slow[m] = static_cast<Index>(materials + split.copied.size());
      split.copied.push_back(m);
    }
  if (split.copied.empty()) return split;

  const auto is_slow = [&](std::size_t e) {
    return family_of_slow[static_cast<std::size_t>(mesh.material[e])] >= 0;
  };
  std::vector<std::uint8_t> near(mesh.nodes.size(), 0);
  const auto mark = [&](std::size_t e) {
    for (const Index n : mesh.quads[e]) near[static_cast<std::size_t>(n)] = 1;
  };
  const auto touches = [&](std::size_t e) {
    for (const Index n : mesh.quads[e])
      if (near[static_cast<std::size_t>(n)]) return true;
    return false;
  };
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    if (!is_slow(e)) mark(e);
  for (int layer = 1; layer < buffer_layers; ++layer) {
    std::vector<std::size_t> reached;
    for (std::size_t e = 0; e < mesh.quads.size(); ++e)
      if (touches(e)) reached.push_back(e);
    for (const std::size_t e : reached) mark(e);
  }
  for (std::size_t e = 0; e < mesh.quads.size(); ++e)
    if (is_slow(e) && !touches(e)) {
      split.material[e] = family_of_slow[static_cast<std::size_t>(mesh.material[e])];
      ++split.elements;
    }
  return split;
}

int subcycle_ratio(const Subcycling& subcycling, std::span<const double> step_of_family) {
  double fast = std::numeric_limits<double>::infinity(), slow = fast;
  for (std::size_t m = 0; m < subcycling.slow.size(); ++m)
    (subcycling.slow[m] ? slow : fast) = std::min(subcycling.slow[m] ? slow : fast, step_of_family[m]);
  if (!(slow > fast)) return 1;
  return static_cast<int>(
      std::clamp<double>(std::floor(outer_share * slow / fast * (1 + 1e-12)), 1, longest_window));
}

std::vector<double> Carpet::Impl::steps_of_families() const {
  std::vector<double> step_of;
  for (const ElementFamily& family : elements.family) {
    const std::size_t first = family.first_batch, last = first + family.batch_count;
    double largest = 0;
#pragma omp parallel for schedule(static) \
    reduction(max                         \
              : largest) if (elements.element_count > threads_pay_above)
    for (std::size_t batch = first; batch < last; ++batch)
      largest =
          std::max(largest, stdx::hmax(batch_frequency_squared(elements, nodes.motion.position, batch)));
    step_of.push_back(largest > 0 ? 2 / std::sqrt(largest) : std::numeric_limits<double>::infinity());
  }
  return step_of;
}

void Carpet::Impl::split_off_slow_elements() {
  const SlowFamilies split = split_slow_families(mesh, steps_of_families());
  if (split.elements == 0) return;
  ShellMesh grouped = mesh;
  grouped.material = split.material;
  std::vector<ShellMaterial> laws = materials;
  CarpetOptions sections = options;
  sections.sections.resize(materials.size(), options.section);
  std::vector<std::uint8_t> slow(materials.size(), 0);
  for (const std::size_t m : split.copied) {
    laws.push_back(materials[m]);
    sections.sections.push_back(sections.sections[m]);
    slow.push_back(1);
  }
  elements = make_element_arrays(grouped, laws, sections);
  mass_scaling = scale_masses(elements, positions_with_spares(mesh, elements), options.mass_scaling_limit);
  nodes = make_node_arrays(mesh, elements);
  subcycling = make_subcycling(mesh, elements, std::move(slow));
  for (const std::size_t m : split.copied) subcycling->material.push_back(m);
  subcycling->every = fe::subcycle_ratio(*subcycling, steps_of_families());
}

/// As update_elements, with the slow elements only when `all`; their corner forces are multiplied by
/// `impulse`, the time that they are to act over the step's.
void Carpet::Impl::update_groups(bool all, double impulse) {
  Subcycling& s = *subcycling;
  for (std::size_t f = 0; f < elements.family.size(); ++f)
    if (auto* law = std::get_if<ViscoelasticLaw>(&elements.family[f].law))
      law->set_step(s.slow[f] ? s.drifted : last_step);
  if (all) {
    s.close_window(nodes.motion);
    s.slow_evaluations += 1;
  }
  const std::size_t count = all ? elements.block.size() : s.fast_blocks.size();
#pragma omp parallel for schedule(static) if (elements.element_count > threads_pay_above)
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t b = all ? i : s.fast_blocks[i];
    const ElementBlock& block = elements.block[b];
    const ElementFamily& family = elements.family[block.family];
    if (!s.slow[block.family]) {
      family.update(elements, family, nodes.motion, last_step, block.first_batch, block.last_batch, b);
      continue;
    }
    family.update(elements, family, s.window, s.drifted, block.first_batch, block.last_batch, b);
    if (impulse != 1)
      for (std::size_t v = block.first_batch * batch_values; v < block.last_batch * batch_values; ++v)
        elements.forces[v] *= impulse;
  }
  take_out_failed();
}

void Carpet::Impl::move_subcycled(double dt, const Vec3Array& force, const Vec3Array* moment) {
  Subcycling& s = *subcycling;
  s.owed += dt;
  ++s.steps;
  const bool all = s.steps >= s.every;
  NodeStep node_step{dt, options.damping, options.gravity, from_rest ? 0.5 : 0.0};
  if (!all) {
    node_step.first_corner = s.first_corner.data();
    node_step.corner_offset = s.corner_offset.data();
  }
  const bool starts = std::exchange(from_rest, false);
  update_groups(all, s.owed / dt);
  stop_on_inverted_element();
#pragma omp parallel for schedule(static) if (elements.element_count > threads_pay_above)
  for (std::size_t block = 0; block < nodes.sums.size(); ++block)
    update_node_block(nodes, elements, force, moment, node_step, block);
  if (starts) book_start_from_rest();
  if (all) {
    s.steps = 0;
    s.owed = s.drifted = 0;
  }
  s.drift(nodes.motion, dt);
}

}  // namespace tuft::fe
