#pragma once
/// From strains of the mid-surface to forces per width: the integral of a law through the thickness, the
/// stiffness of the modes that one point in the plane does not see, and the strains at the points of the
/// fully integrated element. Pure functions.
#include "fe_carpet/plane_stress.h"
#include "fe_carpet/shell_strain.h"
#include "fe_carpet/thickness_rule.h"

namespace tuft::fe {

/// Penalty on the drilling spin over G: it costs the step 0.1 %, and is stiff against bending. Displacements
/// of thin and thick twisted beams change by 0.1 % from 0.01 to 1.
inline constexpr double drilling_share = 0.01;
/// The same for deviations from the mean, which are no motion of the element at all.
inline constexpr double drilling_share_of_deviations = 1e-5;

/// Membrane strain and curvature increments at a point of the mid-surface.
template <class Real>
struct SectionStrain {
  PlaneStrain<Real> membrane;   ///< -
  PlaneStrain<Real> curvature;  ///< 1/m
};

template <class Real>
struct SectionForces {
  PlaneStress<Real> force;   ///< N/m
  PlaneStress<Real> moment;  ///< N
  Real work;                 ///< J/m^2, over the increment
  Real thickness_strain;     ///< mean through the thickness
};

/// Values of state of a section. Points = 1: no points at all, but membrane force and moment as two states of
/// the same law; exact for any linear law, whose stress is linear through the thickness.
template <int Points, class Law>
[[nodiscard]] std::size_t section_rows(const Law& law) {
  return law.plane_rows() * (Points == 1 ? 2U : static_cast<std::size_t>(Points));
}

/// t: thickness, m. Rows hold the section's state.
template <int Points, class Law, class Real, class Rows>
[[nodiscard]] SectionForces<Real> advance_section(const Law& law, const Rows& rows, const Real& t,
                                                  const SectionStrain<Real>& e) {
  SectionForces<Real> s;
  if constexpr (Points == 1) {
    // Bending in terms of the outer fibre: strain t k/2, stress b, moment t^2 b/6, work t/3 b t k/2.
    const Real half = 0.5 * t, sixth = t * t * (1.0 / 6.0);
    const PlaneStrain<Real> outer{half * e.curvature.xx, half * e.curvature.yy, half * e.curvature.xy};
    const PlaneAdvance<Real> n = law.template advance<Real>(rows, e.membrane);
    const PlaneAdvance<Real> b = law.template advance<Real>(rows.from(law.plane_rows()), outer);
    s.force = {t * n.stress.xx, t * n.stress.yy, t * n.stress.xy};
    s.moment = {sixth * b.stress.xx, sixth * b.stress.yy, sixth * b.stress.xy};
    s.work = t * (power(n.mean, e.membrane) + (1.0 / 3.0) * power(b.mean, outer));
    s.thickness_strain = n.thickness_strain;
  } else {
    constexpr ThicknessRule<Points> rule = thickness_rule<Points>();
    const Real zero(0.0);
    s = {{zero, zero, zero}, {zero, zero, zero}, zero, zero};
    for (std::size_t p = 0; p < Points; ++p) {
      const Real z = t * (0.5 * rule.height[p]);
      const PlaneStrain<Real> de{e.membrane.xx + z * e.curvature.xx, e.membrane.yy + z * e.curvature.yy,
                                 e.membrane.xy + z * e.curvature.xy};
      const PlaneAdvance<Real> a = law.template advance<Real>(rows.from(p * law.plane_rows()), de);
      const Real weight = t * rule.weight[p], lever = weight * z;
      s.force.xx += weight * a.stress.xx;
      s.force.yy += weight * a.stress.yy;
      s.force.xy += weight * a.stress.xy;
      s.moment.xx += lever * a.stress.xx;
      s.moment.yy += lever * a.stress.yy;
      s.moment.xy += lever * a.stress.xy;
      s.work += weight * power(a.mean, de);
      s.thickness_strain += rule.weight[p] * a.thickness_strain;
    }
  }
  return s;
}

/// Stiffness of the modes beyond the centre's strains, conjugate to ShellModes. Integrals of the fully
/// integrated element's energy, exact for a parallelogram.
template <class Real>
struct ModeStiffness {
  Real fibre_xi, fibre_eta;         ///< N m
  Real turn_xx, turn_xy, turn_yy;   ///< N m
  Real shear_xi_eta, shear_eta_xi;  ///< N/m
  Real spin, spin_deviation;        ///< N m
};

template <class Law, class Real>
[[nodiscard]] ModeStiffness<Real> mode_stiffness(const Law& law, const ShellFrame<Real>& f, const Real& t) {
  const Real zero(0.0), volume = t * f.area, third = volume * (1.0 / 3.0);
  ModeStiffness<Real> k;
  const auto along = [&law](const PlaneStrain<Real>& e) {
    return power<Real>(law.template stress<Real>(e.xx, e.yy, e.xy), e);
  };
  k.fibre_xi = third * along(law.template fibre_strain<Real>(f.x_xi, f.y_xi));
  k.fibre_eta = third * along(law.template fibre_strain<Real>(f.x_eta, f.y_eta));
  k.turn_xx = k.turn_xy = k.turn_yy = zero;
  const auto add_turn = [&](const Real& hx, const Real& hy) {
    const PlaneStress<Real> of_x = law.template stress<Real>(zero, -hy, -hx);
    const PlaneStress<Real> of_y = law.template stress<Real>(hx, zero, hy);
    k.turn_xx += -hy * of_x.yy - hx * of_x.xy;
    k.turn_xy += -hy * of_y.yy - hx * of_y.xy;
    k.turn_yy += hx * of_y.xx + hy * of_y.xy;
  };
  add_turn(f.xi_x, f.xi_y);
  add_turn(f.eta_x, f.eta_y);
  const Real bending = third * t * t * (1.0 / 12.0);
  k.turn_xx = bending * k.turn_xx;
  k.turn_xy = bending * k.turn_xy;
  k.turn_yy = bending * k.turn_yy;
  const Real shear = law.template transverse_stress<Real>(third);
  k.shear_xi_eta = shear * (f.xi_x * f.xi_x + f.xi_y * f.xi_y);
  k.shear_eta_xi = shear * (f.eta_x * f.eta_x + f.eta_y * f.eta_y);
  const Real drilling = volume * law.drilling_modulus();
  k.spin = drilling_share * drilling;
  k.spin_deviation = (drilling_share_of_deviations / 3) * drilling;
  return k;
}

/// Strains at a point (xi, eta) of the fully integrated element, and where its stresses go.
template <class Real>
struct PointStrain {
  SectionStrain<Real> section;
  Real gxz, gyz;
};

/// How the modes enter at a point.
template <class Real>
struct PointShape {
  PointJacobian<Real> j;
  Real hx, hy;  ///< 1/m, gradient of xi eta
  Real from_eta,
      from_xi;  ///< eta and xi less their means over the element, so that modes leave the mean alone
};

template <class Real>
TUFT_HD inline PointShape<Real> point_shape(const ShellFrame<Real>& f, double xi, double eta) {
  PointShape<Real> p;
  p.j = jacobian_at(f, xi, eta);
  p.hx = p.j.xi_x * eta + p.j.eta_x * xi;
  p.hy = p.j.xi_y * eta + p.j.eta_y * xi;
  const Real over = Real(4.0 / 3.0) / f.area;
  p.from_xi = Real(xi) - over * (f.x_xi * f.y_h - f.x_h * f.y_xi);
  p.from_eta = Real(eta) - over * (f.x_h * f.y_eta - f.x_eta * f.y_h);
  return p;
}

/// What a unit of fibre_xi and fibre_eta strains, once an element.
template <class Real>
struct FibrePair {
  PlaneStrain<Real> xi, eta;
};

template <class Law, class Real>
[[nodiscard]] FibrePair<Real> fibre_pair(const Law& law, const ShellFrame<Real>& f) {
  return {law.template fibre_strain<Real>(f.x_xi, f.y_xi), law.template fibre_strain<Real>(f.x_eta, f.y_eta)};
}

template <class Real>
TUFT_HD inline PointStrain<Real> strain_at(const PointShape<Real>& p, const FibrePair<Real>& fibre,
                                           const ShellModes<Real>& s, double xi, double eta) {
  PointStrain<Real> e;
  const Real a = p.from_eta * s.fibre_xi, b = p.from_xi * s.fibre_eta;
  e.section.membrane = {s.exx + a * fibre.xi.xx + b * fibre.eta.xx,
                        s.eyy + a * fibre.xi.yy + b * fibre.eta.yy,
                        s.gxy + a * fibre.xi.xy + b * fibre.eta.xy};
  e.section.curvature = {s.kxx + p.hx * s.turn_y, s.kyy - p.hy * s.turn_x,
                         s.kxy + p.hy * s.turn_y - p.hx * s.turn_x};
  const Real g_xi = s.shear_xi + eta * s.shear_xi_eta, g_eta = s.shear_eta + xi * s.shear_eta_xi;
  e.gxz = p.j.xi_x * g_xi + p.j.eta_x * g_eta;
  e.gyz = p.j.xi_y * g_xi + p.j.eta_y * g_eta;
  return e;
}

/// Adds the forces of a point to those conjugate to the modes: the transpose of strain_at, times the area
/// that the point stands for. qxz, qyz: N/m.
template <class Real>
TUFT_HD inline void add_point_forces(const PointShape<Real>& p, const FibrePair<Real>& fibre,
                                     const SectionForces<Real>& s, const Real& qxz, const Real& qyz,
                                     double xi, double eta, ShellModes<Real>& sum) {
  const Real w = p.j.determinant;
  const PlaneStress<Real> n{w * s.force.xx, w * s.force.yy, w * s.force.xy};
  const PlaneStress<Real> m{w * s.moment.xx, w * s.moment.yy, w * s.moment.xy};
  sum.exx += n.xx;
  sum.eyy += n.yy;
  sum.gxy += n.xy;
  sum.fibre_xi += p.from_eta * (fibre.xi.xx * n.xx + fibre.xi.yy * n.yy + fibre.xi.xy * n.xy);
  sum.fibre_eta += p.from_xi * (fibre.eta.xx * n.xx + fibre.eta.yy * n.yy + fibre.eta.xy * n.xy);
  sum.kxx += m.xx;
  sum.kyy += m.yy;
  sum.kxy += m.xy;
  sum.turn_x -= p.hy * m.yy + p.hx * m.xy;
  sum.turn_y += p.hx * m.xx + p.hy * m.xy;
  const Real q_xi = w * (p.j.xi_x * qxz + p.j.xi_y * qyz), q_eta = w * (p.j.eta_x * qxz + p.j.eta_y * qyz);
  sum.shear_xi += q_xi;
  sum.shear_xi_eta += eta * q_xi;
  sum.shear_eta += q_eta;
  sum.shear_eta_xi += xi * q_eta;
}

}  // namespace tuft::fe
