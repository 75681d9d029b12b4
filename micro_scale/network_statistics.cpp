#include "micro_scale/network_statistics.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace tuft::micro {
namespace {

/// Normal forces between particles, N.
std::vector<double> normal_forces(const ContactNetwork& network) {
  std::vector<double> forces;
  for (std::size_t c = 0; c < network.size(); ++c)
    if (network.kind[c] == ContactKind::grain) forces.push_back(network.normal_force[c].norm());
  return forces;
}

double spread_of_eigenvalues(const Mat3& symmetric) {
  const Vec3 values = Eigen::SelfAdjointEigenSolver<Mat3>(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
  return values[2] - values[0];
}

void describe_forces(std::vector<double> forces, NetworkStatistics& statistics) {
  std::sort(forces.begin(), forces.end());
  const std::size_t count = forces.size();
  double sum = 0, strong = 0;
  for (const double force : forces) sum += force;
  statistics.mean_normal = sum / static_cast<double>(count);
  const auto above = std::upper_bound(forces.begin(), forces.end(), statistics.mean_normal);
  for (auto force = above; force != forces.end(); ++force) strong += *force;
  statistics.percentile_99 = forces[(count - 1) * 99 / 100];
  statistics.largest_normal = forces.back();
  statistics.strong_contacts = static_cast<double>(forces.end() - above) / static_cast<double>(count);
  if (sum > 0) statistics.strong_share = strong / sum;
}

}  // namespace

std::vector<double> count_coordination(const ContactNetwork& network, std::size_t particles) {
  std::vector<double> contacts(particles, 0);
  for (std::size_t c = 0; c < network.size(); ++c) {
    if (network.kind[c] != ContactKind::grain) continue;
    contacts[static_cast<std::size_t>(network.particle[c])] += 1;
    contacts[static_cast<std::size_t>(network.other[c])] += 1;
  }
  return contacts;
}

NetworkStatistics describe_network(const ContactNetwork& network, std::size_t particles) {
  NetworkStatistics statistics;
  for (const ContactKind kind : network.kind) ++statistics.contacts[static_cast<std::size_t>(kind)];
  const std::vector<double> forces = normal_forces(network);
  const std::size_t count = forces.size();
  if (count == 0) return statistics;
  std::size_t loose = 0;
  for (const double contacts : count_coordination(network, particles)) loose += contacts < 2 ? 1 : 0;
  statistics.coordination = 2 * static_cast<double>(count) / static_cast<double>(particles);
  statistics.rattlers = static_cast<double>(loose) / static_cast<double>(particles);
  describe_forces(forces, statistics);

  double normal = 0, tangential = 0;
  for (std::size_t c = 0; c < network.size(); ++c) {
    if (network.kind[c] != ContactKind::grain) continue;
    const Vec3 n = network.branch[c].normalized();
    const double force = network.normal_force[c].norm();
    statistics.fabric += n * n.transpose();
    statistics.force_fabric += force * n * n.transpose();
    normal += force;
    tangential += network.tangential_force[c].norm();
  }
  statistics.fabric /= static_cast<double>(count);
  statistics.anisotropy = spread_of_eigenvalues(statistics.fabric);
  if (!(normal > 0)) return statistics;
  statistics.force_fabric /= normal;
  statistics.force_anisotropy = spread_of_eigenvalues(statistics.force_fabric);
  statistics.tangential_ratio = tangential / normal;
  return statistics;
}

std::vector<NamedValue> named_values(const NetworkStatistics& s) {
  const auto contacts = [&](ContactKind kind) {
    return static_cast<double>(s.contacts[static_cast<std::size_t>(kind)]);
  };
  return {{"contacts_grain", "1", contacts(ContactKind::grain)},
          {"contacts_backing", "1", contacts(ContactKind::backing)},
          {"contacts_fibre", "1", contacts(ContactKind::fibre)},
          {"contacts_body", "1", contacts(ContactKind::body)},
          {"coordination", "1", s.coordination},
          {"rattlers", "1", s.rattlers},
          {"normal_force_mean", "N", s.mean_normal},
          {"normal_force_percentile_99", "N", s.percentile_99},
          {"normal_force_largest", "N", s.largest_normal},
          {"strong_contacts", "1", s.strong_contacts},
          {"strong_share", "1", s.strong_share},
          {"tangential_ratio", "1", s.tangential_ratio},
          {"fabric_xx", "1", s.fabric(0, 0)},
          {"fabric_yy", "1", s.fabric(1, 1)},
          {"fabric_zz", "1", s.fabric(2, 2)},
          {"fabric_xy", "1", s.fabric(0, 1)},
          {"fabric_yz", "1", s.fabric(1, 2)},
          {"fabric_zx", "1", s.fabric(2, 0)},
          {"fabric_anisotropy", "1", s.anisotropy},
          {"force_fabric_anisotropy", "1", s.force_anisotropy}};
}

std::vector<double> force_distribution(const ContactNetwork& network, const ForceBins& bins) {
  const std::vector<double> forces = normal_forces(network);
  std::vector<double> density(bins.count, 0);
  double sum = 0;
  for (const double force : forces) sum += force;
  if (!(sum > 0)) return density;
  const auto count = static_cast<double>(forces.size());
  for (const double force : forces) {
    const double place = force * count / sum / bins.width;
    if (place < static_cast<double>(bins.count))
      density[static_cast<std::size_t>(place)] += 1 / (count * bins.width);
  }
  return density;
}

}  // namespace tuft::micro
