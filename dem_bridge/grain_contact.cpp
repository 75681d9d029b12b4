#include "dem_bridge/grain_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "dem_bridge/cohesion.h"
#include "dem_bridge/dem_infill.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"

namespace tuft::dem {
namespace {

/// Overlap at rest over r* from which on a remark is made: contact areas are no longer small beside grains.
constexpr double large_cohesive_overlap = 0.05;
/// Range of factors over which a bed's peak and rebound changed by under 6 % (docs/theory/dem.md).
constexpr double tried_coarse_graining = 3.5;

double sphere_mass(double radius, double density) {
  return 4.0 / 3.0 * std::numbers::pi * radius * radius * radius * density;
}

double young_of_contact(const GrainMaterial& a, const GrainMaterial& b) {
  return effective_young_modulus(a.young_modulus, a.poisson_ratio, b.young_modulus, b.poisson_ratio);
}

double cohesion_of(const DemOptions& options, const std::vector<Material>& materials, Index a, Index b) {
  return contact_property(options, materials, a, b, &GrainMaterial::cohesion_energy_density,
                          &GrainPair::cohesion_energy_density);
}

const GrainMaterial& grain_of(const std::vector<Material>& materials, Index kind) {
  return *materials[static_cast<std::size_t>(kind)].grain;
}

std::string names_of(const std::vector<Material>& materials, Index a, Index b) {
  const std::string& first = materials[static_cast<std::size_t>(a)].name;
  return a == b ? first : first + " on " + materials[static_cast<std::size_t>(b)].name;
}

}  // namespace

double contact_property(const DemOptions& options, const std::vector<Material>& materials, Index a, Index b,
                        double GrainMaterial::*own, std::optional<double> GrainPair::*of_pair) {
  if (a != b)
    for (const GrainPair& pair : options.pairs)
      if (std::minmax(pair.materials[0], pair.materials[1]) == std::minmax(a, b) && pair.*of_pair)
        return *(pair.*of_pair);
  return 0.5 * (grain_of(materials, a).*own + grain_of(materials, b).*own);
}

double stable_step_of_grain(double radius, double density, Index material, std::span<const Index> kinds,
                            const std::vector<Material>& materials, const DemOptions& options,
                            double mass_ratio) {
  const GrainMaterial& grain = grain_of(materials, material);
  double step = stable_grain_step(radius, density, grain.young_modulus, grain.poisson_ratio);
  if (options.contact == GrainContact::hertz) return step;
  const double mass = sphere_mass(radius, density);
  for (const Index other : kinds) {
    const double stiffness =
        hooke_stiffness(young_of_contact(grain, grain_of(materials, other)), 0.5 * radius,
                        0.5 * mass_ratio * mass, options.characteristic_velocity);
    const double restitution = contact_property(options, materials, material, other,
                                                &GrainMaterial::restitution, &GrainPair::restitution);
    const bool plastic = options.contact == GrainContact::hooke_hysteresis;
    step = std::min(step, stable_hooke_step(stiffness, mass, restitution,
                                            plastic ? options.unloading_ratio : 1, mass_ratio));
  }
  return step;
}

/// kn/r* grows with m*/r*^3, which is least, 4/3 pi rho, where one grain is much smaller than the other
/// (equal ones: 16/3 pi rho).
double cohesion_over_hooke(Index a, Index b, const std::vector<Material>& materials,
                           const DemOptions& options) {
  const GrainMaterial &first = grain_of(materials, a), &second = grain_of(materials, b);
  const double mass = sphere_mass(1, std::min(first.density, second.density));
  return 2 * std::numbers::pi * cohesion_of(options, materials, a, b) /
         hooke_stiffness(young_of_contact(first, second), 1, mass, options.characteristic_velocity);
}

void check_cohesion(std::span<const Index> kinds, const std::vector<Material>& materials,
                    const DemOptions& options) {
  if (options.contact == GrainContact::hertz) return;
  for (const Index a : kinds)
    for (const Index b : kinds)
      if (const double ratio = cohesion_over_hooke(a, b, materials, options); !(ratio < 1))
        throw_input_error(
            "DEM infill: cohesion of {} is {:.3g} times as stiff as their springs, so they collapse into "
            "each "
            "other; lower cohesion_energy_density or use infill.dem.contact = \"hertz\"",
            names_of(materials, a, b), ratio);
}

std::vector<std::string> contact_remarks(std::span<const Index> kinds, bool cohesion,
                                         const std::vector<Material>& materials, const DemOptions& options) {
  std::vector<std::string> remarks;
  for (const Index a : kinds) {
    const std::string& name = materials[static_cast<std::size_t>(a)].name;
    if (const double factor = coarse_graining_of(options, name); factor > tried_coarse_graining)
      remarks.push_back(
          fmt::format("grains of {} are drawn {:.3g} times too large, beyond the {:g} that was tried: what "
                      "depends on grain "
                      "size against fibres and missile changes (docs/theory/dem.md)",
                      name, factor, tried_coarse_graining));
    for (const Index b : kinds) {
      const double density = cohesion_of(options, materials, a, b);
      if (!cohesion || b < a || !(density > 0)) continue;
      if (options.contact != GrainContact::hertz) {
        remarks.push_back(
            fmt::format("cohesion of {} makes Hooke's springs softer by up to {:.2g}, and holds nothing "
                        "together: both grow "
                        "with overlap alike; infill.dem.contact = \"hertz\" does",
                        names_of(materials, a, b), cohesion_over_hooke(a, b, materials, options)));
        continue;
      }
      const double overlap =
          cohesive_overlap(density, young_of_contact(grain_of(materials, a), grain_of(materials, b)));
      if (overlap > large_cohesive_overlap)
        remarks.push_back(fmt::format(
            "cohesion alone presses grains of {} together by {:.2g} of their effective radius: lower "
            "cohesion_energy_density, or make them stiffer",
            names_of(materials, a, b), overlap));
    }
  }
  return remarks;
}

}  // namespace tuft::dem
