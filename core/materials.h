#pragma once
/// Materials of a scene as plain structs, SI throughout; `read_scene` (core/scene_reader.h) fills them from
/// inputs/materials and the scene.
#include <optional>
#include <string>
#include <vector>

#include "core/vector.h"

namespace tuft {

/// Piecewise linear curve; abscissa strictly increasing. What happens beyond the last point is the user's
/// law.
struct Curve {
  std::vector<double> x, y;
};

/// mu(v) = dynamic + (static - dynamic) exp(-decay v). dynamic may exceed static: friction rising with speed.
struct FrictionLaw {
  double static_coefficient = 0;   ///< >= 0
  double dynamic_coefficient = 0;  ///< >= 0
  double decay = 0;                ///< s/m, >= 0
};

/// Shell elements of the carpet: one point in the plane with hourglass control, or 2 x 2 points.
enum class ElementKind { one_point, fully_integrated };
/// What holds the modes that one point does not see: elastic forces, or forces proportional to their rate.
enum class HourglassControl { stiffness, viscous };

/// How the shells of one material are computed.
struct ShellSection {
  ElementKind element = ElementKind::one_point;
  /// Through the thickness, 1 to 5. 2 to 5: Gauss points, each with its own stress. 1: stress resultants
  /// integrated exactly, which a linear law allows (bending included; the same results as 2 to 5 to rounding,
  /// at the lowest cost).
  int thickness_points = 1;
  HourglassControl hourglass = HourglassControl::stiffness;  ///< one_point only
  /// [0, 1]. Stiffness: over that of the fully integrated element; 1 gives its accuracy in linear bending.
  /// Viscous: over critical damping.
  double hourglass_coefficient = 1;
};

/// One term of a relaxing shear modulus, G_i exp(-decay t).
struct PronyTerm {
  double modulus = 0;  ///< Pa, > 0
  double decay = 0;    ///< 1/s, >= 0
};

/// Isotropic shell material, viscoelastic when it has relaxation terms; or orthotropic and elastic.
struct ShellMaterial {
  double young_modulus = 0;  ///< Pa, > 0; of a viscoelastic material the instantaneous one
  double poisson_ratio = 0;  ///< [0, 0.5), instantaneous; the volume does not relax
  double density = 0;        ///< kg/m^3, > 0
  /// What relaxes of the instantaneous shear modulus E / (2 (1 + nu)); the moduli add up to at most that.
  std::vector<PronyTerm> relaxation = {};
  /// Pa; above 0: orthotropic, young_modulus and poisson_ratio (contraction across under tension along) then
  /// belong to `along`, and the shear modulus stands for itself. Not with relaxation.
  double across_young_modulus = 0;
  double shear_modulus = 0;                 ///< Pa, > 0 when orthotropic; otherwise unused
  std::array<double, 3> along = {1, 0, 0};  ///< direction of the stitch, projected into each shell

  /// Largest principal strain (logarithmic) at which a shell of it goes (fe_carpet/erosion.h); 0: none does.
  double failure_strain = 0;

  [[nodiscard]] bool orthotropic() const { return across_young_modulus > 0; }
  [[nodiscard]] bool can_fail() const { return failure_strain > 0; }
};

/// First loading as a closed form: P = (modulus/growth) (exp(growth e) - 1), e = ln(rho/rho0). The modulus
/// grows in proportion to pressure, modulus + growth P; Butterfield's (1979) line ln v = const - lambda* ln(p
/// + p0) is the same curve with growth = 1/lambda* and modulus = p0/lambda*.
struct ExponentialCompression {
  double modulus = 0;  ///< Pa, > 0, at no pressure
  double growth = 0;   ///< > 0
};

/// What a cone sqrt(J2) = k + alpha p agrees with of Mohr and Coulomb's tau = c + sigma tan(phi).
enum class ConeMatch {
  pure_shear,    ///< on a plane under the mean stress: alpha = tan(phi), k = c
  plane_strain,  ///< Drucker & Prager (1952): alpha = 3 tan/sqrt(9 + 12 tan^2), k = 3 c/sqrt(9 + 12 tan^2)
  triaxial_compression  ///< alpha = 6 sin/(sqrt(3) (3 - sin)), k = 6 c cos/(sqrt(3) (3 - sin))
};
struct MohrCoulombStrength {
  double cohesion = 0;        ///< Pa, >= 0
  double friction_angle = 0;  ///< rad, [0, pi/2)
  ConeMatch match = ConeMatch::pure_shear;
};

/// Moduli and strength grow as powers of the largest density so far over that of the reference state: a
/// factor (rho/rho0)^exponent = exp(exponent e) each; exponents >= 0.
struct DensityHardening {
  double modulus_exponent = 0;   ///< of the unloading bulk modulus, and with it the shear modulus
  double cohesion_exponent = 0;  ///< of sqrt(a0)
  double friction_exponent = 0;  ///< of sqrt(a2)
};

/// Strength is lost as exp(-gamma/strain) with the plastic shear strain gamma, down to what stays.
struct StrengthSoftening {
  double strain = 0;             ///< > 0
  double residual_cohesion = 0;  ///< [0, 1], share of sqrt(a0) that stays
  double residual_friction = 1;  ///< (0, 1], share of sqrt(a2) that stays
};

/// Lost strength comes back as exp(-t/time), and as exp(-e/compression) with every compression e.
struct StrengthRecovery {
  double time = 0;         ///< s; 0: not with time
  double compression = 0;  ///< 0: not with compression
};

/// Strength times 1 + coefficient ln(1 + rate/reference), rate: shear strain rate sqrt(2 dev D : dev D).
struct StrengthRate {
  double coefficient = 0;  ///< > 0
  double reference = 0;    ///< 1/s, > 0
};

/// Strength times 1 + increase I/(I + inertial_number), I = rate d sqrt(rho_s/p) (Jop, Forterre & Pouliquen
/// 2006), rate: plastic shear strain rate.
struct InertialFriction {
  double increase = 0;         ///< > 0, mu_2/mu_s - 1: the most that fast flow adds
  double inertial_number = 0;  ///< > 0, where half of it is reached
  double grain_diameter = 0;   ///< m, > 0
  double grain_density = 0;    ///< kg/m^3, > 0, of the solid
};

/// Infill as a continuum: soil and foam (PHYSICS: Krieg; LS-DYNA MAT_005). Compression positive here.
struct SoilFoamMaterial {
  double density = 0;         ///< kg/m^3 in bulk as placed (reference state, zero strain)
  Curve pressure;             ///< x: compressive volumetric strain ln(rho/rho0) from 0; y: Pa from 0, rising
  Curve unloading;            ///< x: pressure, Pa; y: bulk modulus for unloading and reloading, Pa
  double shear_ratio = 0.5;   ///< G / K_unloading, > 0
  double yield_a0 = 0;        ///< Pa^2: J2 <= a0 + a1 p + a2 p^2
  double yield_a1 = 0;        ///< Pa
  double yield_a2 = 0;        ///< -
  double tension_cutoff = 0;  ///< Pa, >= 0: p >= -tension_cutoff, where the deviator is zeroed too

  std::optional<ExponentialCompression> pressure_exponential = {};  ///< in place of `pressure`
  double unloading_ratio = 0;  ///< >= 1, K_unloading over the slope of first loading; in place of `unloading`
  std::optional<MohrCoulombStrength> mohr_coulomb = {};  ///< in place of yield_a0, yield_a1 and yield_a2
  // What the effects of the same names need.
  std::optional<DensityHardening> density_hardening = {};
  std::optional<StrengthSoftening> strength_softening = {};
  std::optional<StrengthRecovery> strength_recovery = {};
  std::optional<StrengthRate> strength_rate = {};
  std::optional<InertialFriction> inertial_friction = {};
  double dilation_angle = 0;  ///< rad, [0, pi/2): plastic expansion over plastic shear strain is its tangent
};

enum class SizeLaw {
  uniform,    ///< every diameter between the limits alike
  lognormal,  ///< cut off at the limits
  sieve       ///< a measured curve, straight in the logarithm of diameter between its openings
};
/// What the shares of a distribution of sizes count.
enum class SizeShares { number, mass };

/// How the diameters of a kind of grain are distributed, true sizes, before coarse graining.
struct GrainSizes {
  SizeLaw law = SizeLaw::uniform;
  SizeShares by = SizeShares::number;
  double median = 0;               ///< m, > 0, of the lognormal law before it is cut off
  double geometric_deviation = 0;  ///< > 1, of the lognormal law: exp of ln d's standard deviation
  Curve sieve = {};                ///< x: opening, m; y: share that passes, from 0 to 1
};

/// What a clump is made of: equal spheres in a row of two, a triangle or a tetrahedron, or spheres as listed.
enum class ClumpShape { pair, triangle, tetrahedron, spheres };

/// One sphere of a clump, in any unit of length: a clump is scaled to the size of its grain.
struct ClumpSphere {
  double x = 0, y = 0, z = 0;
  double radius = 1;  ///< > 0
};

/// Spheres that make up a grain and overlap, a rigid body with the mass of their union. Its size is the
/// diameter of the sphere of the same volume.
struct Clump {
  ClumpShape shape = ClumpShape::tetrahedron;
  double overlap = 0.5;  ///< [0, 1), of the named shapes: depth that neighbours share over their diameter
  std::vector<ClumpSphere> spheres = {};  ///< of ClumpShape::spheres
};
inline constexpr std::size_t largest_clump = 32;  ///< spheres

/// One kind of grain.
struct GrainMaterial {
  double density = 0;                  ///< kg/m^3, of the solid
  double young_modulus = 0;            ///< Pa
  double poisson_ratio = 0;            ///< (0, 0.5)
  double restitution = 0;              ///< (0, 1]
  double friction = 0;                 ///< sliding, with its own kind
  double rolling_friction = 0;         ///< torque over normal force and effective radius r*
  double diameter_min = 0;             ///< m, true size, before coarse graining
  double diameter_max = 0;             ///< m
  double cohesion_energy_density = 0;  ///< J/m^3, >= 0: cohesive force over contact area (sjkr)
  GrainSizes sizes = {};
  std::optional<Clump> clump = {};  ///< effect clumps; none: grains are spheres
};

/// Share of a grain material in a layer's mass (a mixture has two, a pure material one: itself).
struct GrainShare {
  Index material = 0;        ///< index into Scene::materials
  double mass_fraction = 0;  ///< (0, 1], shares of a layer add up to 1
};

/// A material of inputs/materials/<name>.toml. Blocks it lacks are empty; a scene that needs one says so.
struct Material {
  std::string name;
  std::string file;  ///< where it was read from, for messages
  std::optional<SoilFoamMaterial> continuum;
  std::optional<GrainMaterial> grain;
  std::vector<GrainShare> grain_shares;  ///< what a layer of it is made of in DEM; empty: not usable in DEM
  double bulk_density = 0;               ///< kg/m^3 as placed: mass of a layer for both approaches
  FrictionLaw fibre_friction;            ///< against fibres and backing
  FrictionLaw body_friction;             ///< against rig bodies and the tray
  double contact_modulus = 0;            ///< Pa; 0: constrained modulus at numerics.contact_pressure (SPH),
                                         ///< effective Young's modulus (DEM)
  double contact_restitution = 0.5;      ///< (0, 1], normal damping of contact with carpet and bodies
};

}  // namespace tuft
