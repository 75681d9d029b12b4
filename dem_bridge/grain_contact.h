#pragma once
/// What two kinds of grains have between them, and the step that their contacts bear.
#include <span>
#include <vector>

#include "core/scene.h"

namespace tuft::dem {

/// A property of a contact: of one kind its own; of unlike kinds as given for the pair, else the mean of
/// both. a, b: indices of materials with grains.
[[nodiscard]] double contact_property(const DemOptions& options, const std::vector<Material>& materials,
                                      Index a, Index b, double GrainMaterial::*own,
                                      std::optional<double> GrainPair::*of_pair);

/// Largest stable step, s, of one grain of radius (m) and density (kg/m^3): a fifth of its Rayleigh time
/// (dem_bridge/hertz.h); with Hooke's contact the smaller of that and of its springs among equals
/// (dem_bridge/hooke.h), with the stiffest partner of `kinds` (indices of materials, its own among them).
/// mass_ratio: of the mass that its contacts go by over the one that density gives it; of a clump's sphere,
/// above 1.
[[nodiscard]] double stable_step_of_grain(double radius, double density, Index material,
                                          std::span<const Index> kinds,
                                          const std::vector<Material>& materials, const DemOptions& options,
                                          double mass_ratio = 1);

/// Stiffness of cohesion over that of Hooke's spring, 2 pi k r*/kn, of two kinds: from 1 on grains collapse
/// into each other. Largest over sizes, which is where one grain is much smaller than the other.
[[nodiscard]] double cohesion_over_hooke(Index a, Index b, const std::vector<Material>& materials,
                                         const DemOptions& options);

/// Throws InputError where cohesion overcomes Hooke's springs.
void check_cohesion(std::span<const Index> kinds, const std::vector<Material>& materials,
                    const DemOptions& options);

/// What a user should know of cohesion and coarse graining of the grains of these kinds; a line each.
[[nodiscard]] std::vector<std::string> contact_remarks(std::span<const Index> kinds, bool cohesion,
                                                       const std::vector<Material>& materials,
                                                       const DemOptions& options);

}  // namespace tuft::dem
