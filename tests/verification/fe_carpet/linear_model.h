#pragma once
/// The linear stiffness of a mesh, assembled in the tests from the element functions alone, apart from the
/// carpet's loops: forces of small displacements, and the largest frequency of the mesh by power iteration.
#include <cmath>
#include <vector>

#include "fe_carpet/carpet.h"
#include "fe_carpet/plane_stress.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe::test {

/// Three translations and three rotations per node, and likewise forces and moments.
using NodalVector = std::vector<std::array<double, 6>>;

class LinearModel {
 public:
  LinearModel(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials,
              double hourglass_coefficient)
      : mesh_(mesh), mass_(mesh.nodes.size(), 0.0), inertia_(mesh.nodes.size(), 0.0) {
    for (const ShellMaterial& material : materials)
      law_.push_back(plane_stress_law(material, hourglass_coefficient));
    for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
      geometry_.push_back(shell_geometry(diagonal_form(point(e, 0), point(e, 1), point(e, 2), point(e, 3))));
      const double area = geometry_[e].area, t = mesh.thickness[e];
      const double mass = materials[static_cast<std::size_t>(mesh.material[e])].density * t * area;
      for (const Index n : mesh.quads[e]) {
        mass_[static_cast<std::size_t>(n)] += mass / 4;
        inertia_[static_cast<std::size_t>(n)] += mass / 4 * rotary_inertia_ratio(area, t);
      }
    }
  }

  /// Internal forces and moments of a small displacement and rotation field.
  [[nodiscard]] NodalVector internal_forces(const NodalVector& u) const {
    NodalVector f(u.size(), {0, 0, 0, 0, 0, 0});
    for (std::size_t e = 0; e < mesh_.quads.size(); ++e) {
      ShellStrain<double> strain{};
      ShellHourglass<double> hourglass{};
      strains(e, u, strain, hourglass);
      const PlaneStressLaw& law = law_[static_cast<std::size_t>(mesh_.material[e])];
      const double t = mesh_.thickness[e];
      const ShellForces<double> s = nodal_forces(geometry_[e], elastic_resultants(law, t, strain),
                                                 hourglass_resistance(law, t, geometry_[e], hourglass));
      add(f, e, 0, 1, s.force.along13, 1, s);
      add(f, e, 1, 1, s.force.along24, -1, s);
      add(f, e, 2, -1, s.force.along13, 1, s);
      add(f, e, 3, -1, s.force.along24, -1, s);
    }
    return f;
  }

  void strains(std::size_t e, const NodalVector& u, ShellStrain<double>& strain,
               ShellHourglass<double>& hourglass) const {
    std::array<Triple<double>, 4> d{}, r{};
    for (std::size_t c = 0; c < 4; ++c) {
      const auto& v = u[static_cast<std::size_t>(mesh_.quads[e][c])];
      d[c] = {v[0], v[1], v[2]};
      r[c] = {v[3], v[4], v[5]};
    }
    strain_increments(geometry_[e], diagonal_form(d[0], d[1], d[2], d[3]),
                      diagonal_form(r[0], r[1], r[2], r[3]), (r[0] + r[1]) + (r[2] + r[3]), strain,
                      hourglass);
  }

  /// Largest eigenvalue of M^-1 K by power iteration with clamped nodes held; converges from below.
  [[nodiscard]] double largest_frequency_squared(int iterations) const {
    NodalVector u(mesh_.nodes.size());
    for (std::size_t n = 0; n < u.size(); ++n)
      for (std::size_t c = 0; c < 6; ++c) u[n][c] = std::sin(12.9898 * static_cast<double>(6 * n + c) + 0.5);
    double eigenvalue = 0;
    for (int i = 0; i < iterations; ++i) {
      double norm = 0;
      for (std::size_t n = 0; n < u.size(); ++n)
        for (std::size_t c = 0; c < 6; ++c) {
          if (mesh_.clamped[n]) u[n][c] = 0;
          norm += u[n][c] * u[n][c] * (c < 3 ? mass_[n] : inertia_[n]);
        }
      for (auto& v : u)
        for (double& x : v) x /= std::sqrt(norm);
      NodalVector f = internal_forces(u);
      eigenvalue = 0;
      for (std::size_t n = 0; n < u.size(); ++n)
        for (std::size_t c = 0; c < 6; ++c) {
          eigenvalue += u[n][c] * f[n][c];
          u[n][c] = f[n][c] / (c < 3 ? mass_[n] : inertia_[n]);
        }
    }
    return eigenvalue;
  }

 private:
  [[nodiscard]] Triple<double> point(std::size_t e, std::size_t corner) const {
    const auto n = static_cast<std::size_t>(mesh_.quads[e][corner]);
    return {mesh_.nodes.x[n], mesh_.nodes.y[n], mesh_.nodes.z[n]};
  }
  void add(NodalVector& f, std::size_t e, std::size_t corner, double sign, const Triple<double>& along,
           double h, const ShellForces<double>& s) const {
    const Triple<double>& moment = corner % 2 == 0 ? s.moment.along13 : s.moment.along24;
    auto& v = f[static_cast<std::size_t>(mesh_.quads[e][corner])];
    v[0] += sign * along.x + h * s.force.hourglass.x;
    v[1] += sign * along.y + h * s.force.hourglass.y;
    v[2] += sign * along.z + h * s.force.hourglass.z;
    v[3] += sign * moment.x + h * s.moment.hourglass.x + s.mean_moment.x;
    v[4] += sign * moment.y + h * s.moment.hourglass.y + s.mean_moment.y;
    v[5] += sign * moment.z + h * s.moment.hourglass.z + s.mean_moment.z;
  }

  ShellMesh mesh_;
  std::vector<PlaneStressLaw> law_;
  std::vector<ShellGeometry<double>> geometry_;
  std::vector<double> mass_, inertia_;
};

}  // namespace tuft::fe::test
