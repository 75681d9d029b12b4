#pragma once
/// What a contact network is like as a whole: how forces are spread over contacts and directions.
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/contact_network.h"

namespace tuft::micro {

/// Contacts with other particles, a value a particle.
[[nodiscard]] std::vector<double> count_coordination(const ContactNetwork& network, std::size_t particles);

/// Forces and directions are those of contacts between particles; all is 0 where there are none.
struct NetworkStatistics {
  std::array<std::size_t, contact_kinds> contacts{};  ///< by kind
  double coordination = 0;      ///< mean over all particles of contacts with other particles
  double rattlers = 0;          ///< share of particles with less than two of them
  double mean_normal = 0;       ///< N, mean magnitude of normal forces
  double percentile_99 = 0;     ///< N: 99 of 100 contacts have no larger normal force
  double largest_normal = 0;    ///< N
  double strong_contacts = 0;   ///< share of contacts with more than the mean force (Radjai et al. 1998)
  double strong_share = 0;      ///< share of all normal force that they carry
  double tangential_ratio = 0;  ///< sum of tangential over sum of normal magnitudes
  /// Fabric tensor, mean of n (x) n over contacts (Satake 1982), n the unit branch: I/3 where directions are
  /// even. `force_fabric`: weighed by the normal force.
  Mat3 fabric = Mat3::Zero(), force_fabric = Mat3::Zero();
  double anisotropy = 0;        ///< largest less smallest eigenvalue of the fabric tensor
  double force_anisotropy = 0;  ///< of the force's
};
[[nodiscard]] NetworkStatistics describe_network(const ContactNetwork& network, std::size_t particles);

/// The numbers above by name, with unit, for histories and tables.
struct NamedValue {
  std::string name, unit;
  double value = 0;
};
[[nodiscard]] std::vector<NamedValue> named_values(const NetworkStatistics& statistics);

/// The bins in which distributions of forces are recorded and printed: as far as six times the mean.
struct ForceBins {
  std::size_t count = 12;
  double width = 0.5;  ///< in mean normal forces
};

/// Density of the distribution of normal forces over their mean, in bins from 0 on; what lies beyond the last
/// is left out. Density times width adds up to the share of contacts in the bins.
[[nodiscard]] std::vector<double> force_distribution(const ContactNetwork& network,
                                                     const ForceBins& bins = {});

}  // namespace tuft::micro
