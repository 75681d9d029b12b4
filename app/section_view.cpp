#include "app/section_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coupler/build_simulation.h"

namespace tuft::app {
namespace {

/// Everything is drawn in millimetres with z up: svg y = -z.
double mm(double metres) {
  return 1e3 * metres;
}

std::string particles(const Section& section, const SectionFrame& frame, std::size_t most) {
  const std::size_t every = std::max<std::size_t>(1, (section.dots.size() + most - 1) / most);
  std::string text, open_style;
  for (std::size_t i = 0; i < section.dots.size(); i += every) {
    const Dot& dot = section.dots[i];
    const auto found = frame.material_style.find(dot.material);
    const std::string style = found == frame.material_style.end() ? "m0" : found->second;
    if (style != open_style) {
      if (!open_style.empty()) text += "</g>\n";
      text += fmt::format("<g class=\"{}\">", style);
      open_style = style;
    }
    text += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"/>", mm(dot.x), -mm(dot.z),
                        mm(dot.radius));
  }
  if (!open_style.empty()) text += "</g>\n";
  return text;
}

std::string point(const std::array<float, 2>& at) {
  return fmt::format("{:.2f} {:.2f}", mm(at[0]), -mm(at[1]));
}

constexpr double thinnest_line = 0.2;  // mm, so that thin strands stay visible

/// Strips as pale areas, their long edges as lines of the shell's thickness: a strand seen on edge has its
/// true one.
std::string facets(const Section& section, bool backing, double thickness) {
  std::string area, edges;
  for (const Facet& facet : section.facets) {
    if (facet.backing != backing) continue;
    for (std::size_t c = 0; c < 4; ++c) {
      area += c == 0 ? 'M' : 'L';
      area += point(facet.corner[c]);
      if (facet.free_edge[c] || backing)
        edges += fmt::format("M{}L{}", point(facet.corner[c]), point(facet.corner[(c + 1) % 4]));
    }
    area += "z";
  }
  if (area.empty()) return {};
  const char* name = backing ? "backing" : "strand";
  return fmt::format(
      "<path class=\"{0}-area\" d=\"{1}\"/>\n<path class=\"{0}\" stroke-width=\"{2:.3f}\" d=\"{3}\"/>\n",
      name, area, std::max(thinnest_line, mm(thickness)), edges);
}

std::string missile_outline(const Missile& missile, const SectionFrame& frame) {
  const double top = std::min(missile.face_height + missile.height, frame.top + 0.01);
  if (missile.radius <= 0) return {};
  return fmt::format(
      "<rect class=\"missile\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n",
      mm(missile.x - missile.radius), -mm(top), mm(2 * missile.radius), mm(top - missile.face_height));
}

std::string tray(const SectionFrame& frame) {
  return fmt::format("<path class=\"tray\" d=\"M{0:.2f} {2:.2f}V{3:.2f}H{1:.2f}V{2:.2f}\"/>\n",
                     mm(frame.wall_left), mm(frame.wall_right), -mm(frame.wall_top), -mm(frame.floor));
}

/// Under the floor, where nothing moves.
std::string scale_bar(const SectionFrame& frame) {
  const double width = mm(frame.right - frame.left);
  const double length = width > 150 ? 50 : width > 60 ? 20 : 10;
  const double x = mm(frame.wall_left > frame.left ? frame.wall_left : frame.left + 0.003);
  const double y = -mm(frame.bottom) - 0.022 * width;
  return fmt::format(
      "<path class=\"scale\" d=\"M{:.1f} {:.1f}h{:.0f}\"/><text class=\"scale\" x=\"{:.1f}\" y=\"{:.1f}\" "
      "style=\"font-size:{:.1f}px\">{:.0f} mm</text>\n",
      x, y, length, x + length + 0.012 * width, y + 0.012 * width, 0.034 * width, length);
}

}  // namespace

SectionFrame make_section_frame(const Scene& scene) {
  SectionFrame frame;
  const double half = 0.5 * scene.turf.size[0];
  const double axis = scene.rig.clegg.position[0];
  // A large patch is cropped to what the missile can move.
  const double reach = 2.6 * scene.rig.clegg.diameter;
  frame.left = std::max(-half - 0.003, axis - reach);
  frame.right = std::min(half + 0.003, axis + reach);
  const double surface = scene.turf.carpet.backing_thickness + scene.infill_depth();
  frame.bottom = -0.045 * (frame.right - frame.left) - 0.001;
  frame.top = std::max(surface, std::min(scene.turf.carpet.pile_length, surface + 0.03)) + 0.012;
  frame.wall_left = -half;
  frame.wall_right = half;
  frame.wall_top = scene.turf.tray_depth;
  frame.floor = coupler::floor_height(scene, decide_effects(scene));
  frame.strand_thickness = scene.turf.carpet.strand_thickness;
  frame.backing_thickness = scene.turf.carpet.backing_thickness;
  // Colours by material, in the order of the layers from the bottom, then what only mixtures hold: sand,
  // mixture and rubber look the same in both approaches.
  const auto style = [&](Index material) {
    if (!frame.material_style.contains(material))
      frame.material_style.emplace(material, fmt::format("m{}", frame.material_style.size() % 6));
  };
  for (const Layer& layer : scene.turf.layers) style(layer.material);
  for (std::size_t m = 0; m < scene.materials.size(); ++m) style(static_cast<Index>(m));
  return frame;
}

std::string section_svg(const Section& section, const SectionFrame& frame, const std::string& id,
                        std::size_t most_dots) {
  std::string text = fmt::format(
      "<svg id=\"{}\" class=\"section\" viewBox=\"{:.2f} {:.2f} {:.2f} {:.2f}\" role=\"img\" "
      "aria-label=\"section through the impact\">\n",
      id, mm(frame.left), -mm(frame.top), mm(frame.right - frame.left), mm(frame.top - frame.bottom));
  text += facets(section, true, frame.backing_thickness);
  text += particles(section, frame, most_dots);
  text += facets(section, false, frame.strand_thickness);
  text += missile_outline(section.missile, frame) + tray(frame) + scale_bar(frame);
  return text + "</svg>\n";
}

}  // namespace tuft::app
