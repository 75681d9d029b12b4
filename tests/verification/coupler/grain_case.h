#pragma once
/// Grains of LIGGGHTS, shells and bodies in one simulation, put together by hand: a test chooses every
/// number.
#include <cstdlib>
#include <utility>

#include "coupler/simulation.h"
#include "momentum.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::coupler {

struct GrainCase {
  dem::Grains grains;
  std::vector<Material> materials{dem::test::rubber()};
  bool rolling_resistance = false;
  RollingModel rolling = RollingModel::epsd2;
  fe::ShellMesh mesh;
  ShellMaterial shell{0.36e9, 0.3, 920};
  std::vector<RigidBody> bodies;
  FrictionLaw body_friction{0, 0, 0}, shell_friction{0, 0, 0};
  double stiffness = 2e4;    ///< N/m, of a grain against shells and bodies
  double damping_ratio = 0;  ///< of those
  Vec3 gravity{0, 0, 0};
  double half_box = 0.2;  ///< m
  double window = 0;      ///< s; 0: as the steps allow
  double energy_scale = 0;
  double release_time = 0;  ///< s, over which overlaps at the start are let go; 0: at once
};

inline RigidBody half_space(std::string name, const Vec3& point, const Vec3& normal) {
  RigidBody body;
  body.name = std::move(name);
  body.shape = HalfSpace{normal};
  body.position = point;
  return body;
}

inline Simulation make(const GrainCase& setup, const std::vector<std::pair<Vec3, Vec3>>& motion = {}) {
  SimulationParts parts;
  dem::DemSettings settings = dem::test::settings_in_box(setup.half_box, setup.gravity);
  settings.rolling_resistance = setup.rolling_resistance;
  settings.options.rolling = setup.rolling;
  auto infill = std::make_unique<dem::DemInfill>(setup.grains, setup.materials, settings);
  for (std::size_t i = 0; i < motion.size(); ++i) infill->set_velocity(i, motion[i].first, motion[i].second);
  fe::CarpetOptions options;
  options.gravity = setup.gravity;
  double half_thickness = 0;
  for (const double t : setup.mesh.thickness) half_thickness = std::max(half_thickness, 0.5 * t);
  parts.carpet = std::make_unique<fe::Carpet>(
      setup.mesh, setup.mesh.quads.empty() ? std::vector<ShellMaterial>{} : std::vector{setup.shell},
      options);
  const std::size_t n = setup.grains.size(), nodes = parts.carpet->nodes().x.size();
  parts.particle_shell.stiffness.assign(n, setup.stiffness);
  parts.particle_shell.damping_ratio.assign(n, setup.damping_ratio);
  parts.particle_shell.friction.assign(n, setup.shell_friction);
  parts.particle_body = {std::vector<NormalSpring>(n, {setup.stiffness}), parts.particle_shell.damping_ratio,
                         std::vector<FrictionLaw>(n, setup.body_friction)};
  parts.node_body.spring.assign(nodes, {setup.stiffness});
  parts.node_body.damping_ratio.assign(nodes, 0);
  parts.node_body.friction.assign(nodes, {});
  parts.node_radius.assign(nodes, half_thickness);
  parts.infill = std::move(infill);
  parts.bodies = setup.bodies;
  parts.gravity = setup.gravity;
  parts.numerics.coupling_window = setup.window;
  parts.numerics.energy_error_limit = 1e9;
  parts.energy_scale = setup.energy_scale;
  parts.skin = 5e-4;
  parts.release_overlap = setup.release_time > 0;
  parts.numerics.contact_release_time = setup.release_time;
  return Simulation(std::move(parts));
}

}  // namespace tuft::coupler
