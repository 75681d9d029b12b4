#pragma once
/// Linear viscoelastic shells: the deviator relaxes by a Prony series, the volume is elastic, plane stress
/// holds at the end of every step. Pure functions of state and arguments.
///
///   s(t) = 2 int G(t - u) de/du du,   G(t) = G_inf + sum_i G_i exp(-b_i t),   p = K tr e,   s_zz + p = 0
///
/// with e the deviatoric strain. Over a step of constant strain rate each term is integrated exactly (Taylor,
/// Pister & Goudreau, Int. J. Numer. Meth. Eng. 2 (1970) 45):
///
///   h_i <- exp(-b_i dt) h_i + 2 G_i (1 - exp(-b_i dt))/(b_i dt) de
///
/// Unknown is the strain through the thickness; the stress is linear in it, so it follows in closed form.
#include "fe_carpet/plane_stress.h"

namespace tuft::fe {

struct ViscoelasticLaw {
  struct Term {
    double modulus = 0;  ///< G_i, Pa
    double decay = 0;    ///< b_i, 1/s
    double kept = 1;     ///< exp(-b_i dt)
    double gain = 0;     ///< G_i (1 - exp(-b_i dt)) / (b_i dt), Pa
  };
  IsotropicLaw instantaneous;
  double bulk = 0;       ///< K, Pa
  double long_term = 0;  ///< G_inf, Pa
  std::vector<Term> terms;
  double step = -1;  ///< s, that `kept` and `gain` are made for
  double gain = 0;   ///< G_inf + sum of gains, Pa: the modulus of the step

  [[nodiscard]] std::size_t plane_rows() const { return 3 * (terms.size() + 1); }
  [[nodiscard]] std::size_t shear_rows() const { return terms.size() + 1; }

  /// For steps of dt, s, >= 0. To be called before advance whenever the step changes.
  void set_step(double dt) {
    if (dt == step) return;
    step = dt;
    gain = long_term;
    for (Term& term : terms) {
      const double x = term.decay * dt;
      term.kept = std::exp(-x);
      term.gain = term.modulus * (x > 0 ? -std::expm1(-x) / x : 1.0);
      gain += term.gain;
    }
  }

  template <class Real>
  [[nodiscard]] PlaneStress<Real> stress(const Real& exx, const Real& eyy, const Real& gxy) const {
    return instantaneous.stress(exx, eyy, gxy);
  }
  template <class Real>
  [[nodiscard]] Real transverse_stress(const Real& strain) const {
    return instantaneous.transverse_stress(strain);
  }
  /// With the instantaneous Poisson's ratio. Held, such a fibre comes to resist its width's contraction,
  /// which then falls short of uniaxial stress: by (nu_later - nu)^2 / (1 - nu_later^2) of its stiffness.
  template <class Real>
  [[nodiscard]] PlaneStrain<Real> fibre_strain(const Real& x, const Real& y) const {
    return instantaneous.fibre_strain(x, y);
  }

  [[nodiscard]] double drilling_modulus() const { return instantaneous.shear; }

  /// Rows: xx, yy, xy of the long-term deviator, then of each term. Their zz is -(xx + yy); the pressure is
  /// the sum of these zz, since plane stress held before.
  template <class Real, class Rows>
  [[nodiscard]] PlaneAdvance<Real> advance(const Rows& rows, const PlaneStrain<Real>& de) const {
    const std::size_t count = terms.size() + 1;
    // Totals before the step, and what is left of them at its end without further strain.
    PlaneStress<Real> before{rows.read(0), rows.read(1), rows.read(2)}, left = before;
    for (std::size_t i = 1; i < count; ++i) {
      const double kept = terms[i - 1].kept;
      const Real xx = rows.read(3 * i), yy = rows.read(3 * i + 1), xy = rows.read(3 * i + 2);
      before = {before.xx + xx, before.yy + yy, before.xy + xy};
      left = {left.xx + kept * xx, left.yy + kept * yy, left.xy + kept * xy};
    }
    const Real mean_before = before.xx + before.yy, s_zz_left = -(left.xx + left.yy);
    const Real in_plane = de.xx + de.yy;
    const Real ezz =
        -(mean_before + s_zz_left + (bulk - 2.0 / 3.0 * gain) * in_plane) * (1.0 / (bulk + 4.0 / 3.0 * gain));
    const Real third = (in_plane + ezz) * (1.0 / 3.0);
    const Real twice_xx = 2.0 * (de.xx - third), twice_yy = 2.0 * (de.yy - third);

    rows.write(0, rows.read(0) + long_term * twice_xx);
    rows.write(1, rows.read(1) + long_term * twice_yy);
    rows.write(2, rows.read(2) + long_term * de.xy);
    for (std::size_t i = 1; i < count; ++i) {
      const Term& term = terms[i - 1];
      rows.write(3 * i, term.kept * rows.read(3 * i) + term.gain * twice_xx);
      rows.write(3 * i + 1, term.kept * rows.read(3 * i + 1) + term.gain * twice_yy);
      rows.write(3 * i + 2, term.kept * rows.read(3 * i + 2) + term.gain * de.xy);
    }
    const Real s_xx = left.xx + gain * twice_xx, s_yy = left.yy + gain * twice_yy, mean = s_xx + s_yy;
    const PlaneStress<Real> after{s_xx + mean, s_yy + mean, left.xy + gain * de.xy};
    return {after,
            {0.5 * (before.xx + mean_before + after.xx), 0.5 * (before.yy + mean_before + after.yy),
             0.5 * (before.xy + after.xy)},
            ezz};
  }

  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> advance_shear(const Rows& rows, const Real& dg) const {
    return advance_terms(rows, Real(shear_correction * dg));
  }

  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_shear(const Rows& rows, const Real& d) const {
    return advance_terms(rows, Real(d * (1 / instantaneous.shear)));
  }

  /// Exact for uniaxial stress: the sides are free, s_side + p = 0 with s_side = -s/2, so that p = K tr e =
  /// s/2 and the stress is 3/2 s. Rows: s of the long-term deviator, then of each term.
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_uniaxial(const Rows& rows, const Real& d) const {
    const Real de = d * (1 / (2 * instantaneous.shear * (1 + instantaneous.poisson)));
    Real before = rows.read(0), left = before;
    for (std::size_t i = 1; i < terms.size() + 1; ++i) {
      const Real s = rows.read(i);
      before += s;
      left += terms[i - 1].kept * s;
    }
    const Real volume = (0.5 * (left - before) + gain * de) * (1.0 / (bulk + gain / 3.0));
    const Real twice = 2.0 * (de - (1.0 / 3.0) * volume);
    (void)advance_terms(rows, twice);
    return {1.5 * (left + gain * twice), 0.75 * (before + left + gain * twice)};
  }

 private:
  /// One deviatoric component: each term's stress relaxes and takes its modulus times the strain.
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> advance_terms(const Rows& rows, const Real& strain) const {
    Real before = rows.read(0), after = before + long_term * strain;
    rows.write(0, after);
    for (std::size_t i = 1; i < terms.size() + 1; ++i) {
      const Term& term = terms[i - 1];
      const Real old = rows.read(i), now = term.kept * old + term.gain * strain;
      rows.write(i, now);
      before += old;
      after += now;
    }
    return {after, 0.5 * (before + after)};
  }
};

/// Of a material with Prony terms; what the terms do not take of the instantaneous shear modulus is
/// long-term.
[[nodiscard]] inline ViscoelasticLaw viscoelastic_law(const ShellMaterial& material) {
  ViscoelasticLaw law;
  law.instantaneous = instantaneous_law(material);
  law.bulk = material.young_modulus / (3 * (1 - 2 * material.poisson_ratio));
  law.long_term = law.instantaneous.shear;
  for (const PronyTerm& term : material.relaxation) {
    law.long_term -= term.modulus;
    law.terms.push_back({term.modulus, term.decay, 1, term.modulus});
  }
  law.set_step(0);
  return law;
}

}  // namespace tuft::fe
