#pragma once
/// Coarse graining: fields of a continuum from particles, by one code for grains and for SPH, so that both
/// can be compared cell by cell (docs/theory/micro_scale.md).
///
/// With phi the kernel about the centre of a cell (Goldhirsch 2010, Granular Matter 12, 239; Weinhart et al.
/// 2012, Granular Matter 14, 289):
///     density           rho   = sum m_i phi_i
///     velocity          V     = sum m_i v_i phi_i / rho
///     solid fraction    nu    = sum (solid volume)_i phi_i;   porosity 1 - nu
///     kinetic stress    -sum m_i (v_i - V) (x) (v_i - V) phi_i
///     contact stress    sum f_c (x) b_c  mean of phi along the branch,   b_c from the particle's centre to
///     the
///                       other's or to the point of contact with what is not infill, f_c on the particle:
///                       what pushes it back along b is compression, and negative
///     stress of SPH     sum V_i sigma_i phi_i in its place
///     boundary force    sum f_c phi(contact point), f_c on particles by carpet and bodies, N/m^3
/// The three together obey the balance of momentum, d(rho V)/dt + div(rho V V) = div(stress) + boundary force
/// + rho g, without any further average.
#include <array>
#include <span>
#include <vector>

#include "core/infill.h"
#include "micro_scale/coarse_grid.h"

namespace tuft::micro {

/// What is known of the particles beside the view; one value a particle, or empty where it is not known.
struct ParticleMeasures {
  std::span<const double> solid_volume;                  ///< m^3, of solid in the particle
  std::span<const double> coordination;                  ///< contacts with other particles
  std::span<const std::array<double, 6>> stress_moment;  ///< Infill::stress_moments
};

/// One value a cell.
struct CoarseFields {
  std::vector<double> density;       ///< kg/m^3
  std::vector<Vec3> velocity;        ///< m/s; 0 where there is no mass
  std::vector<double> porosity;      ///< 1 - solid fraction (1 where there is nothing); empty: not known
  std::vector<double> coordination;  ///< mean of the particles around, by kernel; empty: not known
  std::vector<Mat3> kinetic_stress;  ///< Pa, tension positive
  std::vector<Mat3> stress;          ///< Pa, of contacts or of the particles; row: force, column: branch
  std::vector<Vec3> boundary_force;  ///< N/m^3
  std::size_t outside = 0;           ///< particles beyond the grid, which are left out with their contacts
  double outside_mass = 0;           ///< kg
};

/// Expelled particles are left out. Serial: the order of additions does not depend on threads.
[[nodiscard]] CoarseFields coarse_grain(const CoarseGrid& grid, const Kernel& kernel,
                                        const ParticleView& particles, const ParticleMeasures& measures,
                                        const ContactNetwork& network);

}  // namespace tuft::micro
