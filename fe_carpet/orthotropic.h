#pragma once
/// Orthotropic linear elastic shells: woven and stitched backings, stiff along and across the stitch and soft
/// in shear. Pure functions.
#include "fe_carpet/plane_stress.h"

namespace tuft::fe {

/// Stiffness in an element's own axes, for one element or a pack of them. Pa.
template <class Value>
struct OrthotropicLaw {
  Value q11, q12, q22, q16, q26, q66;  ///< in-plane stress of strain, engineering shear
  Value transverse_shear;              ///< shear_correction x the in-plane shear modulus
  Value shear;                         ///< in-plane shear modulus in the material's axes
  Value thinning;  ///< -e_zz / (e_xx + e_yy), of the geometric mean of both Poisson's ratios (assumed)
  Value s11, s12, s22, s16, s26, s66;  ///< the inverse, 1/Pa: strain of in-plane stress

  [[nodiscard]] static constexpr std::size_t plane_rows() { return 3; }
  [[nodiscard]] static constexpr std::size_t shear_rows() { return 1; }
  [[nodiscard]] const Value& drilling_modulus() const { return shear; }

  template <class Real>
  [[nodiscard]] PlaneStress<Real> stress(const Real& exx, const Real& eyy, const Real& gxy) const {
    return {q11 * exx + q12 * eyy + q16 * gxy, q12 * exx + q22 * eyy + q26 * gxy,
            q16 * exx + q26 * eyy + q66 * gxy};
  }
  template <class Real>
  [[nodiscard]] Real transverse_stress(const Real& strain) const {
    return transverse_shear * strain;
  }
  template <class Real>
  [[nodiscard]] PlaneStrain<Real> fibre_strain(const Real& x, const Real& y) const {
    const Real xx = x * x, yy = y * y, xy = x * y;  // the uniaxial stress, up to a factor
    const Real exx = s11 * xx + s12 * yy + s16 * xy, eyy = s12 * xx + s22 * yy + s26 * xy;
    const Real gxy = s16 * xx + s26 * yy + s66 * xy;
    const Real over = (xx + yy) / (xx * exx + yy * eyy + xy * gxy);
    return {over * exx, over * eyy, over * gxy};
  }
  template <class Real, class Rows>
  [[nodiscard]] PlaneAdvance<Real> advance(const Rows& rows, const PlaneStrain<Real>& de) const {
    return add_stress(rows, stress(de.xx, de.yy, de.xy), Real(-thinning * (de.xx + de.yy)));
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> advance_shear(const Rows& rows, const Real& dg) const {
    return add_shear(rows, Real(transverse_shear * dg));
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_uniaxial(const Rows& rows, const Real& d) const {
    return add_shear(rows, d);
  }
  template <class Real, class Rows>
  [[nodiscard]] ShearAdvance<Real> relax_shear(const Rows& rows, const Real& d) const {
    return add_shear(rows, d);
  }
};

/// The stiffness of a material with moduli along (1) and across (2), in axes whose e1 has to be turned by
/// `angle` (rad) to meet the material's direction 1 (Jones, Mechanics of Composite Materials, 2.6).
[[nodiscard]] inline OrthotropicLaw<double> orthotropic_law(const ShellMaterial& m, double angle) {
  const double e1 = m.young_modulus, e2 = m.across_young_modulus, nu12 = m.poisson_ratio;
  const double nu21 = nu12 * e2 / e1, over = 1 / (1 - nu12 * nu21), g = m.shear_modulus;
  const double q11 = e1 * over, q22 = e2 * over, q12 = nu12 * e2 * over;
  const double c = std::cos(angle), s = std::sin(angle), cc = c * c, ss = s * s, cs = c * s;
  OrthotropicLaw<double> law{};
  law.q11 = q11 * cc * cc + 2 * (q12 + 2 * g) * cc * ss + q22 * ss * ss;
  law.q22 = q11 * ss * ss + 2 * (q12 + 2 * g) * cc * ss + q22 * cc * cc;
  law.q12 = (q11 + q22 - 4 * g) * cc * ss + q12 * (cc * cc + ss * ss);
  law.q66 = (q11 + q22 - 2 * q12 - 2 * g) * cc * ss + g * (cc * cc + ss * ss);
  law.q16 = (q11 - q12 - 2 * g) * cc * cs + (q12 - q22 + 2 * g) * ss * cs;
  law.q26 = (q11 - q12 - 2 * g) * ss * cs + (q12 - q22 + 2 * g) * cc * cs;
  law.shear = g;
  law.transverse_shear = shear_correction * g;
  const double mean_poisson = std::sqrt(nu12 * nu21);
  law.thinning = mean_poisson / (1 - mean_poisson);
  const double s11 = 1 / e1, s22 = 1 / e2, s12 = -nu12 / e1, s66 = 1 / g, mixed = 2 * s12 + s66;
  law.s11 = s11 * cc * cc + mixed * cc * ss + s22 * ss * ss;
  law.s22 = s11 * ss * ss + mixed * cc * ss + s22 * cc * cc;
  law.s12 = (s11 + s22 - s66) * cc * ss + s12 * (cc * cc + ss * ss);
  law.s66 = 2 * (2 * s11 + 2 * s22 - 4 * s12 - s66) * cc * ss + s66 * (cc * cc + ss * ss);
  law.s16 = (2 * s11 - mixed) * cc * cs - (2 * s22 - mixed) * ss * cs;
  law.s26 = (2 * s11 - mixed) * ss * cs - (2 * s22 - mixed) * cc * cs;
  return law;
}

/// An isotropic law that is at least as stiff in every strain and direction, for bounds of frequencies.
[[nodiscard]] inline IsotropicLaw stiffer_isotropic_law(const ShellMaterial& m) {
  const OrthotropicLaw<double> own = orthotropic_law(m, 0);
  return isotropic_law(std::max(std::max(own.q11, own.q22) + own.q12, 2 * own.q66), 0);
}

}  // namespace tuft::fe
