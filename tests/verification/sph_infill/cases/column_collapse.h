#pragma once
/// Collapse of columns of dry grains onto a rough floor, against published run-outs.
#include <optional>
#include <vector>

#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph::test {

/// Dry grains after Bui et al. (2008): rho 2650 kg/m^3, K 0.7 MPa, G by Poisson's ratio 0.3, no cohesion, no
/// tension, cone sqrt(J2) <= alpha p with alpha = 3 tan(phi)/sqrt(9 + 12 tan^2 phi), the match in plane
/// strain.
[[nodiscard]] SoilFoamMaterial dry_grains(double friction);

struct CollapseCase {
  bool axisymmetric = false;  ///< a quarter of a cylinder between two mirror walls, or a plane slab
  double aspect = 1;          ///< H0/L0
  double length = 0.1;        ///< m, L0: length from the back wall, or radius
  int particles = 10;         ///< along L0
  double friction = 0.5774;   ///< tan phi of the material: 30 degrees
  std::optional<InertialFriction> inertial = {};  ///< of the material
  std::optional<double> floor = {};               ///< Coulomb friction of the floor; none: `friction`
  /// Of the side walls of a channel as wide as `channel` times L0, plane case: the slab, a slice of it, has
  /// that part of their friction that falls to it.
  double wall_friction = 0, channel = 1;
  int slab = 6;  ///< particles between the side walls of the plane case
};

/// Glass beads of 22 degrees between the walls of a channel 0.45 L0 apart with friction tan 13.1 degrees:
/// after Lajeunesse et al. 2005 and, for the walls, Jop et al. 2005 (literature, not seen first hand).
[[nodiscard]] CollapseCase beads_in_a_channel();

struct CollapseResult {
  double run_out = 0;                        ///< (L - L0)/L0; L: see column_collapse
  double height = 0;                         ///< H/L0 of the surface at the back wall or the axis, at the end
  double energy_error = 0;                   ///< over the potential energy at first
  double kinetic = 0;                        ///< at the end, over the potential energy at first
  double spray = 0;                          ///< share of the mass beyond L
  double time = 0;                           ///< s, when it was stopped
  std::vector<double> profile_x, profile_z;  ///< surface at the end in bins of two pitches, over L0
  double close = 0;  ///< share of particles with another nearer than half a pitch, at the end
};

/// Plane: a slab `slab` particles thick between two walls (penalty planes), frictionless or with their share
/// of a channel's friction, and a frictionless back wall, on a floor with Coulomb friction. A slice one
/// particle thick would not be in plane strain, for its particles have no neighbours to resist them across;
/// here stress builds up across the slab against the walls. Axisymmetric: a quarter cylinder between
/// frictionless walls along its two planes of symmetry.
///
/// The floor's normal contact is a penalty spring with a dashpot. L is where the deposit, counted from the
/// back in bins of L0/8 (of two pitches at least), first becomes thinner than L0/40; what lies beyond is
/// spray and is reported. The run ends when its kinetic energy is under 1e-4 of the potential energy at
/// first, not before two free falls of the height, or after ten.
[[nodiscard]] CollapseResult column_collapse(const Numerics& numerics, const CollapseCase& which);

/// Published run-outs (L - L0)/L0 at an aspect ratio. Plane: Lube et al. 2005, 1.2 a below 2.3, 1.9 a^(2/3)
/// above (their ranges are a < 1.8 and a > 2.8); Lajeunesse et al. 2005, 1.8 a below 3, 2.3 a^(2/3)... above.
/// Axisymmetric: Lube et al. 2004, 1.24 a below 1.7, 1.6 sqrt(a) above.
struct RunOutLaws {
  double low = 0, high = 0;
};
[[nodiscard]] RunOutLaws published_run_out(bool axisymmetric, double aspect);

}  // namespace tuft::sph::test
