#pragma once
/// The linear stiffness of a mesh, assembled in the tests from the element functions alone, apart from the
/// carpet's loops: forces of small displacements, and the largest frequency of the mesh by power iteration.
#include <cmath>
#include <vector>

#include "fe_carpet/carpet.h"
#include "fe_carpet/orthotropic.h"
#include "fe_carpet/stable_step.h"

namespace tuft::fe::test {

/// Three translations and three rotations per node, and likewise forces and moments.
using NodalVector = std::vector<std::array<double, 6>>;

/// The instantaneous law of any material in the axes of an element.
inline OrthotropicLaw<double> law_of(const ShellMaterial& material, const ShellFrame<double>& f) {
  if (material.orthotropic()) {
    const Triple<double> along{material.along[0], material.along[1], material.along[2]};
    return orthotropic_law(material, std::atan2(dot(f.axes.e2, along), dot(f.axes.e1, along)));
  }
  ShellMaterial same = material;
  same.across_young_modulus = same.young_modulus;
  same.shear_modulus = same.young_modulus / (2 * (1 + same.poisson_ratio));
  return orthotropic_law(same, 0);
}

/// Elastic forces of one element's strains at its initial shape; `beyond` are the stiffnesses of the
/// one-point element's hourglass modes.
inline ShellModes<double> elastic_modes(const ShellFrame<double>& f, const OrthotropicLaw<double>& law,
                                        double t, const ShellSection& section,
                                        const ModeStiffness<double>& beyond, const ShellModes<double>& e) {
  ShellModes<double> s{};
  const ModeStiffness<double> k = mode_stiffness(law, f, t);
  const auto plane = [&](const SectionStrain<double>& strain) {
    SectionForces<double> forces{};
    if (section.thickness_points == 3) {
      std::array<double, 9> rows{};
      return advance_section<3>(law, PointRows<double>{rows.data()}, t, strain);
    }
    const PlaneStrain<double>&m = strain.membrane, &c = strain.curvature;
    const PlaneStress<double> n = law.stress(m.xx, m.yy, m.xy), b = law.stress(c.xx, c.yy, c.xy);
    const double inertia = t * t * t / 12;
    forces.force = {t * n.xx, t * n.yy, t * n.xy};
    forces.moment = {inertia * b.xx, inertia * b.yy, inertia * b.xy};
    return forces;
  };
  s.spin = k.spin * e.spin;
  s.spin_xi = k.spin_deviation * e.spin_xi;
  s.spin_eta = k.spin_deviation * e.spin_eta;
  s.spin_h = k.spin_deviation * e.spin_h;
  if (section.element == ElementKind::one_point) {
    const SectionForces<double> forces = plane({{e.exx, e.eyy, e.gxy}, {e.kxx, e.kyy, e.kxy}});
    s.exx = f.area * forces.force.xx;
    s.eyy = f.area * forces.force.yy;
    s.gxy = f.area * forces.force.xy;
    s.kxx = f.area * forces.moment.xx;
    s.kyy = f.area * forces.moment.yy;
    s.kxy = f.area * forces.moment.xy;
    const double shear = t * f.area * law.transverse_shear;
    const double qxz = shear * (f.xi_x * e.shear_xi + f.eta_x * e.shear_eta);
    const double qyz = shear * (f.xi_y * e.shear_xi + f.eta_y * e.shear_eta);
    s.shear_xi = f.xi_x * qxz + f.xi_y * qyz;
    s.shear_eta = f.eta_x * qxz + f.eta_y * qyz;
    s.fibre_xi = beyond.fibre_xi * e.fibre_xi;
    s.fibre_eta = beyond.fibre_eta * e.fibre_eta;
    s.turn_x = beyond.turn_xx * e.turn_x + beyond.turn_xy * e.turn_y;
    s.turn_y = beyond.turn_xy * e.turn_x + beyond.turn_yy * e.turn_y;
    s.shear_xi_eta = beyond.shear_xi_eta * e.shear_xi_eta;
    s.shear_eta_xi = beyond.shear_eta_xi * e.shear_eta_xi;
    return s;
  }
  const FibrePair<double> fibre = fibre_pair(law, f);
  const double gauss = 1 / std::sqrt(3.0);
  for (const double xi : {-gauss, gauss})
    for (const double eta : {-gauss, gauss}) {
      const PointShape<double> shape = point_shape(f, xi, eta);
      const PointStrain<double> strain = strain_at(shape, fibre, e, xi, eta);
      add_point_forces(shape, fibre, plane(strain.section), t * law.transverse_shear * strain.gxz,
                       t * law.transverse_shear * strain.gyz, xi, eta, s);
    }
  return s;
}

class LinearModel {
 public:
  /// Under viscous hourglass control K + (2/dt) C for steps of `dt`, s: these are stable while its largest
  /// eigenvalue is under (2/dt)^2.
  LinearModel(const ShellMesh& mesh, const std::vector<ShellMaterial>& materials, const ShellSection& section,
              double dt = 1)
      : mesh_(mesh), section_(section), mass_(mesh.nodes.size(), 0.0), inertia_(mesh.nodes.size(), 0.0) {
    for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
      frame_.push_back(shell_frame(corner_modes(point(e, 0), point(e, 1), point(e, 2), point(e, 3))));
      const double area = frame_[e].area, t = mesh.thickness[e];
      const ShellMaterial& material = materials[static_cast<std::size_t>(mesh.material[e])];
      law_.push_back(law_of(material, frame_[e]));
      const double mass = material.density * t * area;
      ModeStiffness<double> k = mode_stiffness(law_[e], frame_[e], t);
      double factor = section.hourglass_coefficient;
      if (section.hourglass == HourglassControl::viscous) {
        k = mode_damping(frame_[e], k, mass, rotary_inertia_ratio(area, t), section.hourglass_coefficient);
        factor = 2 / dt;
      }
      for (double* mode :
           {&k.fibre_xi, &k.fibre_eta, &k.turn_xx, &k.turn_xy, &k.turn_yy, &k.shear_xi_eta, &k.shear_eta_xi})
        *mode *= factor;
      beyond_.push_back(k);
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
      const ShellForces<double> s = nodal_forces(
          frame_[e],
          elastic_modes(frame_[e], law_[e], mesh_.thickness[e], section_, beyond_[e], strains(e, u)));
      constexpr std::array<double, 4> xi{-1, 1, 1, -1}, eta{-1, -1, 1, 1}, h{1, -1, 1, -1};
      for (std::size_t c = 0; c < 4; ++c) {
        auto& v = f[static_cast<std::size_t>(mesh_.quads[e][c])];
        const Triple<double> force = 0.25 * (xi[c] * s.force.xi + eta[c] * s.force.eta + h[c] * s.force.h);
        const Triple<double> moment =
            0.25 * (xi[c] * s.moment.xi + eta[c] * s.moment.eta + h[c] * s.moment.h + s.mean_moment);
        v[0] += force.x;
        v[1] += force.y;
        v[2] += force.z;
        v[3] += moment.x;
        v[4] += moment.y;
        v[5] += moment.z;
      }
    }
    return f;
  }

  [[nodiscard]] ShellModes<double> strains(std::size_t e, const NodalVector& u) const {
    std::array<Triple<double>, 4> d{}, r{};
    for (std::size_t c = 0; c < 4; ++c) {
      const auto& v = u[static_cast<std::size_t>(mesh_.quads[e][c])];
      d[c] = {v[0], v[1], v[2]};
      r[c] = {v[3], v[4], v[5]};
    }
    return strain_increments(frame_[e], corner_modes(d[0], d[1], d[2], d[3]),
                             corner_modes(r[0], r[1], r[2], r[3]), corner_mean(r[0], r[1], r[2], r[3]));
  }

  [[nodiscard]] const ShellFrame<double>& frame(std::size_t e) const { return frame_[e]; }

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

  ShellMesh mesh_;
  ShellSection section_;
  std::vector<OrthotropicLaw<double>> law_;  // per element
  std::vector<ModeStiffness<double>> beyond_;
  std::vector<ShellFrame<double>> frame_;
  std::vector<double> mass_, inertia_;
};

}  // namespace tuft::fe::test
