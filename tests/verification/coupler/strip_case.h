#pragma once
/// A few masses and one shell strip, free in space or held.
#include <cmath>
#include <optional>

#include "coupler/simulation.h"
#include "momentum.h"
#include "point_infill.h"

namespace tuft::coupler {

/// A strip of n elements along x, mid-surface z = 0, free in space.
inline fe::ShellMesh strip(int n, double length, double width, double thickness, bool clamp_ends) {
  fe::ShellMesh mesh;
  for (int i = 0; i <= n; ++i)
    for (int side = 0; side < 2; ++side) {
      mesh.nodes.push_back(Vec3(length * (static_cast<double>(i) / n - 0.5), (side - 0.5) * width, 0));
      mesh.clamped.push_back(clamp_ends && (i == 0 || i == n) ? 1 : 0);
    }
  for (Index i = 0; i < n; ++i) {
    mesh.quads.push_back({2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    mesh.thickness.push_back(thickness);
    mesh.material.push_back(0);
    mesh.surface.push_back(1);
  }
  mesh.surface_count = 2;
  return mesh;
}

/// Adds a copy of the only sheet of `mesh`, `height` above it.
inline void add_strip(fe::ShellMesh& mesh, double height) {
  const std::size_t nodes = mesh.nodes.size(), quads = mesh.quads.size();
  for (std::size_t i = 0; i < nodes; ++i) {
    mesh.nodes.push_back(mesh.nodes[i] + Vec3(0, 0, height));
    mesh.clamped.push_back(mesh.clamped[i]);
  }
  for (std::size_t e = 0; e < quads; ++e) {
    auto quad = mesh.quads[e];
    for (Index& corner : quad) corner += static_cast<Index>(nodes);
    mesh.quads.push_back(quad);
    mesh.thickness.push_back(mesh.thickness[e]);
    mesh.material.push_back(mesh.material[e]);
    mesh.surface.push_back(2);
  }
  mesh.surface_count = 3;
}

/// A held bowl of 7 x 7 facets of 2 mm: a pyramid standing on its tip, its nodes shifted so that every facet
/// is warped and has a fold along its diagonal.
inline fe::ShellMesh bowl(double thickness) {
  constexpr int n = 7;
  fe::ShellMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = 0.002 * (i - 0.5 * n), y = 0.002 * (j - 0.5 * n);
      const double shift = 3e-4 * std::sin(2.1 * i + 3.7 * j);
      mesh.nodes.push_back(Vec3(x, y, 0.8 * (std::abs(x) + std::abs(y)) + shift));
      mesh.clamped.push_back(1);
    }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index a = j * (n + 1) + i;
      mesh.quads.push_back({a, a + 1, a + n + 2, a + n + 1});
      mesh.thickness.push_back(thickness);
      mesh.material.push_back(0);
      mesh.surface.push_back(1);
    }
  mesh.surface_count = 2;
  return mesh;
}

struct StripCase {
  bool in_bowl = false;
  bool look_at_all = false;
  bool clamp = false;
  double damping_ratio = 0;
  FrictionLaw friction{0.4, 0.6, 300};
  double window = 0;
  double coupling_particle_stiffness = 1e5;
  double body_stiffness = 0;  ///< N/m, of particles against bodies; 0: as against shells
  double release_time = 0.002;
  bool release = true;
  Vec3 gravity{0, 0, 0};
  double failure_strain = 0;
  int elements = 10;
  double softer_half = 0;  ///< Young's modulus of the half at larger x over the other's; 0: all the same
  bool subcycle = false;
  double mass_scaling_limit = 0;
  std::optional<double> floor;  ///< m, height of a fixed plane
  double strand_radius_factor = 1;
  bool is_backing = false;             ///< the strip, in place of a strand
  std::optional<double> second_sheet;  ///< m, height of another strip like the first
};

inline Simulation make(const StripCase& setup, std::unique_ptr<PointInfill> infill) {
  SimulationParts parts;
  fe::CarpetOptions options;
  options.gravity = setup.gravity;
  options.subcycle = setup.subcycle;
  options.mass_scaling_limit = setup.mass_scaling_limit;
  infill->gravity = setup.gravity;
  ShellMaterial material{0.36e9, 0.3, 920};
  material.failure_strain = setup.failure_strain;
  std::vector<ShellMaterial> materials{material};
  fe::ShellMesh mesh = setup.in_bowl ? bowl(5e-4) : strip(setup.elements, 0.04, 0.004, 5e-4, setup.clamp);
  if (setup.is_backing) mesh.surface.assign(mesh.quads.size(), fe::ShellMesh::backing_surface);
  if (setup.second_sheet) add_strip(mesh, *setup.second_sheet);
  if (setup.softer_half > 0) {
    materials.push_back(material);
    materials.back().young_modulus *= setup.softer_half;
    for (std::size_t e = mesh.quads.size() / 2; e < mesh.quads.size(); ++e) mesh.material[e] = 1;
  }
  parts.carpet = std::make_unique<fe::Carpet>(std::move(mesh), std::move(materials), options);
  const std::size_t n = infill->mass_.size(), nodes = parts.carpet->nodes().x.size();
  parts.particle_shell.stiffness.assign(n, setup.coupling_particle_stiffness);
  parts.particle_shell.damping_ratio.assign(n, setup.damping_ratio);
  parts.particle_shell.friction.assign(n, setup.friction);
  parts.particle_shell.strand_radius_factor = setup.strand_radius_factor;
  parts.particle_shell.skip_pairs_apart = !setup.look_at_all;
  parts.particle_body = {
      std::vector<NormalSpring>(
          n, {setup.body_stiffness > 0 ? setup.body_stiffness : setup.coupling_particle_stiffness}),
      parts.particle_shell.damping_ratio, parts.particle_shell.friction};
  parts.node_body.spring.assign(nodes, {1e4});
  parts.node_body.damping_ratio.assign(nodes, 0);
  parts.node_body.friction.assign(nodes, {});
  parts.node_radius.assign(nodes, 2.5e-4);
  parts.infill = std::move(infill);
  parts.gravity = setup.gravity;
  parts.numerics.coupling_window = setup.window;
  parts.numerics.contact_release_time = setup.release_time;
  parts.numerics.energy_error_limit = 1e9;
  if (setup.floor) {
    RigidBody floor;
    floor.name = "floor";
    floor.shape = HalfSpace{Vec3(0, 0, 1)};
    floor.position = Vec3(0, 0, *setup.floor);
    parts.bodies.push_back(floor);
  }
  parts.skin = 5e-4;
  parts.release_overlap = setup.release;
  return Simulation(std::move(parts));
}

}  // namespace tuft::coupler
