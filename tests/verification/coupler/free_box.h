#pragma once
/// A closed box of shells with grains inside, free in space and without weight: an isolated system whose
/// parts keep meeting.
#include <array>
#include <cmath>
#include <map>

#include "tests/verification/coupler/grain_case.h"

namespace tuft::coupler {

/// A closed cube of shells, `n` to an edge, with one surface.
inline fe::ShellMesh cube(double edge, int n, double thickness) {
  fe::ShellMesh mesh;
  std::map<std::array<int, 3>, Index> known;
  const auto node = [&](const std::array<int, 3>& at) {
    const auto [place, is_new] = known.emplace(at, static_cast<Index>(mesh.nodes.size()));
    if (is_new) {
      mesh.nodes.push_back(edge * (Vec3(at[0], at[1], at[2]) / n - Vec3::Constant(0.5)));
      mesh.clamped.push_back(0);
    }
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const auto corner = [&](int a, int b) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[(axis + 1) % 3] = a;
            at[(axis + 2) % 3] = b;
            return node(at);
          };
          std::array<Index, 4> quad{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
          if (side == 0) std::swap(quad[1], quad[3]);
          mesh.quads.push_back(quad);
          mesh.thickness.push_back(thickness);
          mesh.material.push_back(0);
          mesh.surface.push_back(1);
        }
  mesh.surface_count = 2;
  return mesh;
}

inline GrainCase grains_in_a_box(double friction, double restitution) {
  GrainCase setup;
  setup.mesh = cube(0.012, 4, 5e-4);
  setup.materials = {dem::test::grain_material(8e6, 0.45, 1150, restitution, friction)};
  setup.shell_friction = {friction, friction, 0};
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        dem::test::add_grain(setup.grains, 0.003 * Vec3(i - 1, j - 1, k - 1), 0.001 + 1e-5 * (i + 2 * j - k),
                             1150);
  setup.stiffness = 2000;
  setup.half_box = 0.1;
  return setup;
}

inline std::vector<std::pair<Vec3, Vec3>> shaken(std::size_t count) {
  std::vector<std::pair<Vec3, Vec3>> motion;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = 1.0 + static_cast<double>(i) * 0.7, b = 2.0 + static_cast<double>(i) * 1.3;
    motion.emplace_back(Vec3(std::sin(a), std::cos(b), std::sin(a + b)),
                        300 * Vec3(std::cos(a), std::sin(b), 0.3));
  }
  return motion;
}

struct FreeBox {
  double momentum_change = 0;    ///< over the sum of the grains' momenta at the start
  double largest_imbalance = 0;  ///< of a window, relative
  double energy_error = 0;       ///< relative, largest
  EnergyTerms energy;            ///< at the end
};

inline FreeBox run_free_box(const GrainCase& setup, std::uint64_t steps) {
  Simulation s = make(setup, shaken(setup.grains.size()));
  const Vec3 before = momentum(s);
  double scale = 0;
  const ParticleView p = s.infill().particles();
  for (std::size_t i = 0; i < p.size(); ++i) scale += p.mass[i] * p.velocity(i).norm();
  while (s.windows() < steps) s.advance_interval(100 * setup.window);
  return {(momentum(s) - before).norm() / scale, s.momentum_error(), s.ledger().largest_error(),
          s.ledger().last()};
}

}  // namespace tuft::coupler
