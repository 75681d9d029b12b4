#pragma once
/// Tests of one material point (`tuft point`): a material and the path that it is strained along. SI
/// throughout.
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "core/scene_reader.h"

namespace tuft {

/// The effects that a point has.
inline constexpr std::array<std::string_view, 8> point_effect_names{
    "tension_cutoff", "density_hardening", "strength_softening", "strength_recovery",
    "strength_rate",  "inertial_friction", "dilation",           "shear_energy"};

/// How a segment moves; stresses and strains are positive in compression, z is the axis.
enum class PathKind {
  isotropic,         ///< all sides alike
  oedometric,        ///< along z alone
  triaxial,          ///< along z, normal stresses along x and y kept
  simple_shear,      ///< x displaced in proportion to y, with its rotation
  pure_shear,        ///< the same shear without rotation
  direct_shear,      ///< x displaced in proportion to z, normal stress along z kept, none of x and y strained
  velocity_gradient  ///< as given
};

/// One segment; it ends at a strain, at a stress, or after a duration: exactly one is given.
struct PathSegment {
  PathKind kind = PathKind::isotropic;
  /// Change over the segment: logarithmic, of volume (isotropic) or along z (oedometric, triaxial); of a
  /// shear its tangent.
  std::optional<double> strain;
  /// Pa: mean pressure (isotropic), stress along z (oedometric, triaxial), shear stress xy, or zx
  /// (direct_shear).
  std::optional<double> stress;
  std::optional<double> duration;         ///< s; velocity_gradient only, and all that it may have
  double rate = 1;                        ///< 1/s, of that strain
  std::vector<double> velocity_gradient;  ///< 1/s, nine by rows, extension positive: dv_x/dx, dv_x/dy, ...
  bool fresh = false;                     ///< begins with a fresh point, as the test did
};

/// What a test measures of its path, by a name of the user's.
enum class MeasureKind {
  modulus,                 ///< Pa, secant of axial stress over axial strain of an oedometric segment
  loss,                    ///< share of the work of `segment` that `release` does not give back
  unloading_over_loading,  ///< secant modulus of `release` over that of `segment`, each between 10 % and 90 %
                           ///< of the largest stress
  friction_angle,          ///< deg, of the line through the ends of all direct_shear segments
  cohesion                 ///< Pa, of that line
};

/// Strain in moduli is compression over the height as placed, as an oedometer has it.
struct PointMeasure {
  std::string name;
  MeasureKind kind = MeasureKind::modulus;
  int segment = 0;              ///< from 1: oedometric; of modulus, loss and unloading_over_loading
  int release = 0;              ///< from 1: oedometric, after it; of loss and unloading_over_loading
  std::vector<double> between;  ///< Pa, two axial stresses; of modulus
};

struct PointTest {
  std::string file;  ///< as given by the user, for messages
  std::string name;
  std::vector<Material> materials;
  Index material = 0;               ///< index into them
  double residual_compression = 0;  ///< ln(rho/rho0) to which the point was pressed and released before
  double step = 1e-4;               ///< largest strain of a step
  double strain_limit = 2;          ///< a stress that is not met within it ends the test with an error
  int samples = 400;                ///< rows kept of a segment
  Effects effects;
  std::vector<PathSegment> segments;
  std::vector<PointMeasure> measures;

  [[nodiscard]] const Material& tested() const { return materials[static_cast<std::size_t>(material)]; }
};

/// Reads a test and the material it names, as scenes are read. Throws InputError, one line: file:line, key,
/// value, what to do.
[[nodiscard]] PointTest read_point_test(const std::filesystem::path& file, const Overrides& overrides = {},
                                        const MaterialTexts& texts = {});

/// Whether a file is a test of a point (it has a table [point]) and not a scene. Throws InputError when it
/// cannot be read.
[[nodiscard]] bool is_point_test(const std::filesystem::path& file);

/// The effects of the soil law as decided for a test.
[[nodiscard]] std::vector<EffectDecision> decide_effects(const PointTest& test);

/// The test with every default written out and its material inline; reads back the same.
[[nodiscard]] std::string write_point_test(const PointTest& test);

}  // namespace tuft
