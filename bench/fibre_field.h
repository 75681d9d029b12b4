#pragma once
/// The field of 50 000 fibre shells that the shells' speed is measured on: 2 381 strands of 21 elements of
/// 3 x 1.3 x 0.1 mm (a 63 mm pile), clamped at their roots and swinging.
#include <cmath>
#include <cstddef>
#include <memory>

#include "fe_carpet/carpet.h"

namespace tuft::bench {

inline constexpr Index strands = 2381, elements_per_strand = 21, strands_per_row = 49;
inline constexpr double element_length = 0.003, strand_width = 0.0013, strand_thickness = 0.0001,
                        spacing = 0.005;
inline constexpr double field_step_safety = 0.9;
/// A run looks for the stable step once a history row (coupler::Simulation::advance_interval): in
/// inputs/clegg_small.toml a row every 20 us, the carpet's steps are 3.33 us, of SPH and DEM alike.
inline constexpr int steps_per_step_control = 6;

inline fe::ShellMesh fibre_field() {
  fe::ShellMesh mesh;
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

/// One of the cases measured.
struct FieldCase {
  const char* name;
  ShellMaterial material;
  ShellSection section;
};

inline FieldCase field_case(int which) {
  const ShellMaterial polyethylene{0.5e9, 0.4, 920};
  // Published: G = 0.061, 0.0663, 0.2 GPa with decays 0, 10, 1000 1/s (Bustamante et al. 2024).
  ShellMaterial slit_film{2 * 0.3273e9 * 1.42, 0.42, 920, {{0.0663e9, 10}, {0.2e9, 1000}}};
  ShellSection section;
  switch (which) {
    case 0:
      return {"shell_one_point_elastic", polyethylene, section};
    case 1:
      section.thickness_points = 3;
      return {"shell_one_point_3pt", polyethylene, section};
    case 2:
      section.element = ElementKind::fully_integrated;
      return {"shell_full_elastic", polyethylene, section};
    case 3:
      section.element = ElementKind::fully_integrated;
      section.thickness_points = 3;
      return {"shell_full_prony_3pt", slit_film, section};
    default:
      section.element = ElementKind::fully_integrated;
      section.thickness_points = 3;
      slit_film.failure_strain = 0.4;  // published (Bustamante et al. 2024); not reached here
      return {"shell_full_prony_3pt_erosion", slit_film, section};
  }
}
inline constexpr int field_cases = 5;

/// Strands bend as in a blow: speed grows along them, each in a direction of its own.
inline std::unique_ptr<fe::Carpet> swinging_field(const FieldCase& of) {
  fe::CarpetOptions options;
  options.section = of.section;
  auto carpet = std::make_unique<fe::Carpet>(fibre_field(), std::vector{of.material}, options);
  for (std::size_t n = 0; n < carpet->nodes().x.size(); ++n) {
    if (carpet->nodes().clamped[n]) continue;
    const double share = carpet->nodes().z[n] / (element_length * elements_per_strand);
    const double direction = 0.1 * static_cast<double>(n / (2 * (elements_per_strand + 1)));
    carpet->set_velocity(n, share * Vec3(std::cos(direction), std::sin(direction), 0), Vec3(0, 0, 0));
  }
  return carpet;
}

}  // namespace tuft::bench
