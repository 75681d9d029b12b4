#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/scene_check.h"

namespace tuft {
namespace {

/// Studs that reach the backing would tear it.
void check_roller(const Scene& scene, const Places& places) {
  const Conditioning& conditioning = scene.conditioning;
  if (conditioning.method != "roller") return;
  if (scene.infill.approach == Approach::sph)
    places.fail("conditioning.method",
                "\"roller\" is for grains; choose \"compaction\", or infill.approach = \"dem\"");
  const ConditioningRoller& roller = conditioning.roller;
  const double reach = conditioning.depth + (roller.studs_around > 0 ? roller.stud_length : 0);
  if (!(reach < scene.infill_depth()))
    places.fail("conditioning.depth",
                fmt::format("studs would reach {} below the surface of an infill of {}; make it or "
                            "conditioning.roller.stud_length less",
                            in_mm(reach), in_mm(scene.infill_depth())));
  // Every grain is checked against each of them.
  constexpr double most = 2000;
  const double studs =
      roller.studs_around * std::max(1.0, std::floor(scene.turf.size[1] / roller.stud_spacing));
  if (studs > most)
    places.fail(
        "conditioning.roller.stud_spacing",
        fmt::format("{} on a roller {} long, with {} around it, makes {:.3g} studs; {} are the most",
                    in_mm(roller.stud_spacing), in_mm(scene.turf.size[1]), roller.studs_around, studs, most));
}

}  // namespace

/// Spheres of a regular bed fill pi/6 of their cubes; random packings are no denser than 0.64 (Scott &
/// Kilgour 1969).
void check_conditioning(const Scene& scene, const Places& places) {
  const Conditioning& conditioning = scene.conditioning;
  if (!conditioning.on()) return;
  const double depth = scene.infill_depth();
  if (!(conditioning.depth < depth))
    places.fail("conditioning.depth",
                fmt::format("the infill is only {} deep; make it less than that", in_mm(depth)));
  check_roller(scene, places);
  if (conditioning.method == "roller" && conditioning.presses > 1)
    places.fail(
        "conditioning.presses",
        "is of a plate (method = \"compaction\"); a roller has conditioning.roller.passes: leave it out");
  if (conditioning.presses == 1 && conditioning.tolerance != Conditioning{}.tolerance)
    places.fail(
        "conditioning.tolerance",
        "says when pressing may end, but the plate comes once; give conditioning.presses above 1, or leave "
        "it out");
  if (scene.infill.approach != Approach::sph) return;
  constexpr double densest = 0.64, of_lattice = std::numbers::pi / 6;
  const double placed = of_lattice * std::pow(conditioning.sphere_diameter, 3),
               pressed = placed / (1 - conditioning.depth / depth);
  if (pressed <= densest) return;
  if (placed > densest)
    places.fail(
        "conditioning.sphere_diameter",
        fmt::format("spheres fill {:.2g} of the room as placed, and cannot fill more than 0.64 in any "
                    "disordered bed; make them smaller (0.96 can be pressed by an eighth)",
                    placed));
  places.fail(
      "conditioning.depth",
      fmt::format("spheres would fill {:.2g} of the room, more than the 0.64 of the densest disordered bed; "
                  "at most {} can be pressed with conditioning.sphere_diameter = {:g}",
                  pressed, in_mm(depth * (1 - placed / densest)), conditioning.sphere_diameter));
}

}  // namespace tuft
