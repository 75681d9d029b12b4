/// Frames: the particles and facets near the section plane, out of run.h5.
#include <algorithm>
#include <cmath>
#include <map>

#include "app/report_data.h"
#include "core/error.h"

namespace tuft::app {
namespace {

constexpr double release_tolerance = 1e-9;  // s, a frame of the moment of release shows the state before it

std::vector<double> read_optional(const h5::Group& group, const std::string& name, std::size_t count,
                                  double otherwise) {
  return group.has(name) ? group.read_doubles(name) : std::vector<double>(count, otherwise);
}

/// A missile of radius zero is not there: up to the release it waits outside.
Missile read_missile(const h5::Group& frames, std::size_t frame, double time,
                     const std::optional<Scene>& scene) {
  Missile missile;
  if (scene) missile = {0.5 * scene->rig.clegg.diameter, scene->rig.clegg.height, 0, 0, 0};
  if (time <= release_tolerance) missile.radius = 0;
  if (!frames.has("bodies") || !frames.open_group("bodies").has("missile")) return missile;
  const h5::Group group = frames.open_group("bodies").open_group("missile");
  const std::vector<double> position = group.read_row("position", frame);
  missile.x = position.at(0);
  missile.y = position.at(1);
  missile.face_height = position.at(2);
  return missile;
}

void read_dots(const h5::Group& infill, std::size_t frame, Section& section) {
  const std::vector<double> position = infill.read_row("position", frame);
  const std::size_t count = position.size() / 3;
  const std::vector<double> radius = read_optional(infill, "radius", count, 1e-3);
  std::vector<std::int32_t> material(count, 0);
  if (infill.has("material")) material = infill.read_ints("material");
  if (count == 0) return;
  double mean_diameter = 0;
  for (const double r : radius) mean_diameter += 2 * r / static_cast<double>(count);
  section.particle_slice = 1.5 * mean_diameter;
  for (std::size_t i = 0; i < count; ++i) {
    const double depth = section.missile.y - position[3 * i + 1];
    if (std::abs(depth) > 0.5 * section.particle_slice) continue;
    section.dots.push_back({static_cast<float>(position[3 * i]), static_cast<float>(position[3 * i + 2]),
                            static_cast<float>(radius[i]), static_cast<float>(depth), material[i]});
  }
  std::stable_sort(section.dots.begin(), section.dots.end(),
                   [](const Dot& a, const Dot& b) { return a.depth < b.depth; });
}

using Edge = std::array<std::int32_t, 3>;  // surface, lower node, higher node

Edge edge_of(const std::vector<std::int32_t>& quads, std::int32_t surface, std::size_t q, std::size_t c) {
  const std::int32_t a = quads[4 * q + c], b = quads[4 * q + (c + 1) % 4];
  return {surface, std::min(a, b), std::max(a, b)};
}

double middle(const std::vector<double>& position, const std::vector<std::int32_t>& quads, std::size_t q,
              std::size_t axis) {
  double sum = 0;
  for (std::size_t c = 0; c < 4; ++c)
    sum += 0.25 * position.at(3 * static_cast<std::size_t>(quads[4 * q + c]) + axis);
  return sum;
}

/// Facets that belong to the section: backing near the plane, and every whole strand rooted near it, however
/// it leans.
std::vector<bool> choose_facets(const std::vector<double>& position, const std::vector<std::int32_t>& quads,
                                const std::vector<std::int32_t>& surface, double plane, double slice) {
  // Half open, so that of two rows of tufts just half a gauge from the plane one is taken.
  const auto inside = [&](double y) {
    return y - plane > -0.5 * slice + 1e-6 && y - plane <= 0.5 * slice + 1e-6;
  };
  std::map<std::int32_t, std::size_t> root;  // lowest facet of each strand
  for (std::size_t q = 0; q < surface.size(); ++q) {
    const auto [found, added] = root.try_emplace(surface[q], q);
    if (!added && middle(position, quads, q, 2) < middle(position, quads, found->second, 2))
      found->second = q;
  }
  std::vector<bool> chosen(surface.size());
  for (std::size_t q = 0; q < surface.size(); ++q)
    chosen[q] = inside(middle(position, quads, surface[q] == 0 ? q : root.at(surface[q]), 1));
  return chosen;
}

void read_facets(const h5::Group& carpet, std::size_t frame, double slice, Section& section) {
  const std::vector<double> position = carpet.read_row("position", frame);
  const std::vector<std::int32_t> quads = carpet.read_ints("quads");
  const std::vector<std::int32_t> surface = carpet.read_ints("surface");
  section.facet_slice = slice;
  const std::vector<double> eroded =
      carpet.has("eroded") ? carpet.read_row("eroded", frame) : std::vector<double>(surface.size(), 0.0);
  std::map<Edge, int> uses;
  for (std::size_t q = 0; q < surface.size(); ++q)
    for (std::size_t c = 0; c < 4 && eroded[q] == 0; ++c) ++uses[edge_of(quads, surface[q], q, c)];
  const std::vector<bool> chosen = choose_facets(position, quads, surface, section.missile.y, slice);
  for (std::size_t q = 0; q < surface.size(); ++q) {
    if (!chosen[q] || eroded[q] != 0) continue;
    Facet facet{{}, {}, surface[q] == 0};
    for (std::size_t c = 0; c < 4; ++c) {
      const std::size_t node = static_cast<std::size_t>(quads[4 * q + c]);
      facet.corner[c] = {static_cast<float>(position.at(3 * node)),
                         static_cast<float>(position.at(3 * node + 2))};
      facet.free_edge[c] = uses[edge_of(quads, surface[q], q, c)] == 1;
    }
    section.facets.push_back(facet);
  }
}

}  // namespace

std::optional<Section> RunData::section(double time) const {
  if (frame_times.empty()) return std::nullopt;
  const auto nearest = std::min_element(frame_times.begin(), frame_times.end(), [&](double a, double b) {
    return std::abs(a - time) < std::abs(b - time);
  });
  const auto frame = static_cast<std::size_t>(nearest - frame_times.begin());
  Section section;
  section.time = *nearest;
  try {
    const h5::Group frames = h5::File::open(folder / "run.h5").root().open_group("frames");
    section.missile = read_missile(frames, frame, section.time, scene);
    if (frames.has("infill")) read_dots(frames.open_group("infill"), frame, section);
    // Rows of tufts stand a gauge apart: a slice of that thickness holds one row wherever the plane falls.
    if (frames.has("carpet"))
      read_facets(frames.open_group("carpet"), frame, scene ? scene->turf.carpet.gauge : 0.01, section);
  } catch (const RunError&) {
    return std::nullopt;
  }
  return section;
}

}  // namespace tuft::app
