// A picture of a design of inputs/turfs/, drawn from the mesh that the generator makes of it:
//   build/release/bin/print_carpet_svg DESIGN > picture.svg
// Left a patch, right one of its tufts, close up. Painter's algorithm: shells are drawn from the farthest on.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/scene_reader.h"
#include "fe_carpet/carpet.h"
#include "fe_carpet/leg_shape.h"

namespace {

using tuft::CarpetDesign;
using tuft::Index;
using tuft::Vec3;

constexpr double page_width = 1600, page_height = 1000;  // px
constexpr double mm = 1e-3;

struct Colour {
  double red, green, blue;
};

/// Perspective: what lies `distance` in front of the eye is drawn at `scale` px/m, its centre at (x, y).
struct Camera {
  Vec3 target, right, up, forward;
  double distance, scale, x, y;

  Camera(const Vec3& look_at, double azimuth, double height, double distance_, double scale_, double x_,
         double y_)
      : target(look_at),
        right(-std::sin(azimuth), std::cos(azimuth), 0),
        forward(-std::cos(height) * std::cos(azimuth), -std::cos(height) * std::sin(azimuth),
                -std::sin(height)),
        distance(distance_),
        scale(scale_),
        x(x_),
        y(y_) {
    up = right.cross(forward);
  }
  [[nodiscard]] double depth(const Vec3& p) const { return (p - target).dot(forward); }
  [[nodiscard]] std::array<double, 2> project(const Vec3& p) const {
    const double factor = scale * distance / (distance + depth(p));
    return {x + factor * (p - target).dot(right), y - factor * (p - target).dot(up)};
  }
};

/// Number that looks random and is the same everywhere, in [0, 1).
double scatter(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15U;
  n ^= n >> 29U;
  n *= 0xbf58476d1ce4e5b9U;
  return static_cast<double>((n ^ (n >> 32U)) >> 11U) * 0x1.0p-53;
}

struct Picture {
  tuft::fe::ShellMesh mesh;
  CarpetDesign design;
  tuft::fe::RootLayout layout;

  [[nodiscard]] Vec3 corner(std::size_t e, std::size_t i) const {
    return mesh.nodes[static_cast<std::size_t>(mesh.quads[e][i])];
  }
  [[nodiscard]] Vec3 centre(std::size_t e) const {
    return 0.25 * (corner(e, 0) + corner(e, 1) + corner(e, 2) + corner(e, 3));
  }
  [[nodiscard]] int surfaces_per_leg() const {
    return layout.strands_per_leg + (design.unsplit_length > 0 ? 1 : 0);
  }
  [[nodiscard]] int surfaces_per_tuft() const { return layout.legs * surfaces_per_leg(); }
  /// Of a strand's shell.
  [[nodiscard]] int tuft_of(std::size_t e) const { return (mesh.surface[e] - 1) / surfaces_per_tuft(); }
  [[nodiscard]] int place_in_leg(std::size_t e) const { return (mesh.surface[e] - 1) % surfaces_per_leg(); }
  [[nodiscard]] int leg_of(std::size_t e) const {
    return (mesh.surface[e] - 1) % surfaces_per_tuft() / surfaces_per_leg();
  }
  [[nodiscard]] bool at_root(std::size_t e) const {
    return corner(e, 0).z() <= 0.5001 * design.backing_thickness;
  }
  [[nodiscard]] bool is_tape(std::size_t e) const {
    return design.unsplit_length > 0 && place_in_leg(e) == 0;
  }
};

/// Fresh green for strands, each its own shade, the whole tape darker, the backing nearly black.
Colour base_colour(const Picture& picture, std::size_t e) {
  if (picture.mesh.surface[e] == 0) return {46, 44, 42};
  if (picture.is_tape(e)) return picture.leg_of(e) == 0 ? Colour{44, 132, 104} : Colour{104, 158, 60};
  // The two legs of a tuft a little apart in hue, so that the eye can follow them up.
  const double blue = picture.leg_of(e) == 0 ? 26 : 0;
  const double shade = scatter(static_cast<std::uint64_t>(picture.mesh.surface[e]));
  return {92 + 70 * shade - 1.2 * blue, 166 + 40 * shade, 62 + 20 * shade + blue};
}

/// Lambert's law on both faces, darker towards the root, where little light comes down.
Colour shade(const Picture& picture, std::size_t e) {
  static const Vec3 light = Vec3(0.55, -0.35, 0.75).normalized();
  const Vec3 normal = (picture.corner(e, 2) - picture.corner(e, 0))
                          .cross(picture.corner(e, 3) - picture.corner(e, 1))
                          .normalized();
  const double height = std::clamp(picture.centre(e).z() / picture.design.pile_length, 0.0, 1.0);
  const double lit =
      picture.mesh.surface[e] == 0 ? 1 : (0.58 + 0.46 * std::abs(normal.dot(light))) * (0.74 + 0.34 * height);
  const Colour base = base_colour(picture, e);
  return {std::min(255.0, lit * base.red), std::min(255.0, lit * base.green),
          std::min(255.0, lit * base.blue)};
}

std::string draw(const Picture& picture, const Camera& camera, const std::vector<std::size_t>& shells,
                 double line) {
  std::vector<std::size_t> order = shells;
  const auto far = [&](std::size_t e) {  // the backing lies below everything
    return camera.depth(picture.centre(e)) + (picture.mesh.surface[e] == 0 ? 1 : 0);
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return far(a) > far(b); });
  std::string text;
  for (const std::size_t e : order) {
    const Colour c = shade(picture, e);
    std::string points;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto [x, y] = camera.project(picture.corner(e, i));
      points += fmt::format("{:.1f},{:.1f} ", x, y);
    }
    const double edge =
        picture.mesh.surface[e] == 0 ? 1.25 : 0.72;  // its outline, so that shells can be counted
    text += fmt::format(
        "<polygon points=\"{}\" fill=\"rgb({:.0f},{:.0f},{:.0f})\" stroke=\"rgb({:.0f},{:.0f},{:.0f})\" "
        "stroke-width=\"{}\"/>\n",
        points, c.red, c.green, c.blue, edge * c.red, edge * c.green, edge * c.blue, line);
  }
  return text;
}

std::string write_text(double x, double y, int size, const std::string& words, const char* more = "") {
  return fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" font-size=\"{}\" {}>{}</text>\n", x, y, size, more,
                     words);
}

/// Words at the page's right edge and a line from them to a point of the carpet.
std::string point_out(const Camera& camera, const Vec3& at, double y, const std::string& words,
                      const std::string& more) {
  const auto [px, py] = camera.project(at);
  constexpr double column = 1330;
  const std::string line = fmt::format("<polyline points=\"{:.0f},{:.0f} {:.0f},{:.0f} {:.1f},{:.1f}\" ",
                                       column - 8, y - 6, column - 34, y - 6, px, py);
  return line + "fill=\"none\" stroke=\"#f6f5f1\" stroke-width=\"5\" stroke-opacity=\"0.75\"/>" + line +
         "fill=\"none\" stroke=\"#333\" stroke-width=\"1.6\"/>" +
         fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" fill=\"#fff\" stroke=\"#333\"/>\n", px,
                     py) +
         write_text(column, y, 21, words, "font-weight=\"600\"") +
         write_text(column, y + 25, 17, more, "fill=\"#555\"");
}

/// Five tufts by three rows from the middle, where no wall bends them.
std::string draw_patch(const Picture& picture) {
  const CarpetDesign& d = picture.design;
  const double half_x = 2.5 * d.stitch_spacing, half_y = 1.5 * d.gauge;
  const auto inside = [&](const Vec3& p) { return std::abs(p.x()) < half_x && std::abs(p.y()) < half_y; };
  std::vector<std::size_t> shells;
  std::set<int> tufts;
  for (std::size_t e = 0; e < picture.mesh.quads.size(); ++e) {
    const bool backing = picture.mesh.surface[e] == 0;
    if (!backing && picture.at_root(e) && inside(picture.centre(e))) tufts.insert(picture.tuft_of(e));
    if (backing ? inside(picture.centre(e)) : tufts.contains(picture.tuft_of(e))) shells.push_back(e);
  }
  const Camera camera(Vec3(0, 0, 0.45 * d.pile_length), -0.72, 0.46, 0.5, 7600, 335, 530);
  return draw(picture, camera, shells, 0.5) +
         write_text(60, 950, 18,
                    fmt::format("{} tufts: rows {:.1f} mm apart, a stitch every {:.1f} mm, pile {:.1f} mm",
                                tufts.size(), d.gauge / mm, d.stitch_spacing / mm, d.pile_length / mm),
                    "fill=\"#555\"");
}

/// The tuft nearest the patch's centre: walls bend it least.
int central_tuft(const Picture& picture) {
  int best = 0;
  double nearest = 1;
  for (std::size_t e = 0; e < picture.mesh.quads.size(); ++e) {
    if (picture.mesh.surface[e] == 0) continue;
    const Vec3 at = picture.centre(e);
    const double distance = std::hypot(at.x(), at.y()) + at.z();
    if (distance < nearest) nearest = distance, best = picture.tuft_of(e);
  }
  return best;
}

constexpr double close_azimuth = -1.0, close_height = 0.26;  // rad

std::string draw_tuft_close_up(const Picture& picture) {
  const CarpetDesign& d = picture.design;
  const int tuft = central_tuft(picture);
  std::vector<std::size_t> shells;
  Vec3 middle(0, 0, 0);
  int roots = 0;
  Vec3 tape(0, 0, 0), split = tape, tip = tape, bend = tape;
  const Camera direction(Vec3(0, 0, 0), close_azimuth, close_height, 0.5, 1, 0, 0);
  double tip_x = -1, bend_x = -1;
  std::array<Vec3, 2> front{Vec3(0, 1, 0), Vec3(0, 1, 0)};  ///< of each leg, at its root
  for (std::size_t e = 0; e < picture.mesh.quads.size(); ++e) {
    if (picture.mesh.surface[e] == 0 || picture.tuft_of(e) != tuft) continue;
    shells.push_back(e);
    if (picture.at_root(e)) {
      middle += picture.centre(e);
      ++roots;
      Vec3& root = front.at(static_cast<std::size_t>(picture.leg_of(e)));
      if (picture.corner(e, 0).y() < root.y()) root = picture.corner(e, 0);
    }
    const auto [px, py] = direction.project(picture.centre(e));
    const double height = picture.centre(e).z() / d.pile_length;
    if (height > 0.8 && px > tip_x) tip_x = px, tip = picture.centre(e);
    if (height > 0.52 && height < 0.6 && px > bend_x) bend_x = px, bend = picture.centre(e);
    if (picture.mesh.surface[e - 1] != picture.mesh.surface[e])
      split = 0.5 * (picture.corner(e, 0) + picture.corner(e, 1));
    if (picture.is_tape(e) && picture.leg_of(e) == 1 &&
        picture.centre(e).z() < 0.62 * d.unsplit_length + 0.5 * d.element_length)
      tape = picture.centre(e);
  }
  middle /= roots;
  for (std::size_t e = 0; e < picture.mesh.quads.size(); ++e)
    if (picture.mesh.surface[e] == 0 &&
        std::abs(picture.centre(e).x() - middle.x()) < 0.9 * d.stitch_spacing &&
        std::abs(picture.centre(e).y() - middle.y()) < 0.8 * d.gauge)
      shells.push_back(e);
  const Camera camera(Vec3(middle.x(), middle.y(), 0.47 * d.pile_length), close_azimuth, close_height, 0.5,
                      11600, 980, 520);
  std::string text = draw(picture, camera, shells, 0.8);
  text +=
      point_out(camera, tip, 190, fmt::format("{} strands", d.strands_per_tuft),
                fmt::format("{:.1f} x {:.1f} mm, fanned out", d.strand_width / mm, d.strand_thickness / mm));
  text += point_out(camera, bend, 400, "Curl and lean", "seeded, strand by strand");
  if (d.unsplit_length > 0) {
    text +=
        point_out(camera, split, 570, "The tape splits", fmt::format("{:.0f} mm up", d.unsplit_length / mm));
    text += point_out(camera, tape, 700, "Whole tape",
                      fmt::format("{} strands wide, gathered", picture.layout.strands_per_leg));
  }
  if (picture.layout.legs == 2) {
    text += point_out(camera, front[0], 890, "", "");
    text += point_out(camera, front[1], 890, "Two legs",
                      fmt::format("{:.1f} mm apart, one stitch", picture.layout.spacing / mm));
  }
  return text;
}

std::string title(const std::string& design) {
  return design == "monofilament"    ? "Monofilament: blades, separate from the root"
         : design == "slit_film_nfl" ? "Slit film: tapes, split into strands"
                                     : design;
}

void print(const std::string& design) {
  const tuft::Scene scene = tuft::read_scene("inputs/clegg_small.toml", {{"turf.design", design}});
  const CarpetDesign& d = scene.turf.carpet;
  const std::array<double, 2> wide{13.2 * d.stitch_spacing, 9.2 * d.gauge};
  const Picture picture{tuft::fe::generate_carpet(d, wide, 3, true), d, tuft::fe::root_layout(d)};
  fmt::print(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" fill=\"#222\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#f6f5f1\"/>\n"
      "<g stroke-linejoin=\"round\">\n{2}</g>\n",
      page_width, page_height, draw_patch(picture));
  fmt::print("<g stroke-linejoin=\"round\">\n{}</g>\n{}</svg>\n", draw_tuft_close_up(picture),
             write_text(60, 70, 32, title(design), "font-weight=\"700\""));
}

}  // namespace

int main(int count, char** words) {
  if (count != 2) {
    std::fputs("usage: print_carpet_svg DESIGN (a file of inputs/turfs/, run in the repository's root)\n",
               stderr);
    return 2;
  }
  try {
    print(words[1]);
    return 0;
  } catch (const tuft::InputError& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
