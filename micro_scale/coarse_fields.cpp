#include "micro_scale/coarse_fields.h"

#include <algorithm>
#include <cmath>

namespace tuft::micro {
namespace {

/// Which particles take part: those in the grid that have not left the turf.
std::vector<char> find_inside(const CoarseGrid& grid, const ParticleView& particles, CoarseFields& fields) {
  std::vector<char> inside(particles.size(), 0);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles.is_expelled(i)) continue;
    inside[i] = grid.holds(particles.position(i));
    if (inside[i] != 0) continue;
    ++fields.outside;
    fields.outside_mass += particles.mass[i];
  }
  return inside;
}

Mat3 as_matrix(const std::array<double, 6>& s) {
  Mat3 m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return m;
}

/// Sums over particles; velocity holds momentum and coordination its sum until `finish_means`.
void add_particles(const CoarseGrid& grid, const Kernel& kernel, const ParticleView& particles,
                   const ParticleMeasures& measures, const std::vector<char>& inside,
                   std::vector<double>& number, CoarseFields& fields) {
  const double per_volume = 1 / grid.cell_volume();
  Spread spread;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (inside[i] == 0) continue;
    spread_point(grid, kernel, particles.position(i), spread);
    const double mass = particles.mass[i];
    const Vec3 velocity = particles.velocity(i);
    const Mat3 moment =
        measures.stress_moment.empty() ? Mat3(Mat3::Zero()) : as_matrix(measures.stress_moment[i]);
    for (std::size_t s = 0; s < spread.cell.size(); ++s) {
      const std::size_t cell = spread.cell[s];
      const double phi = per_volume * spread.share[s];
      fields.density[cell] += mass * phi;
      fields.velocity[cell] += mass * phi * velocity;
      number[cell] += phi;
      if (!measures.solid_volume.empty()) fields.porosity[cell] -= measures.solid_volume[i] * phi;
      if (!measures.coordination.empty()) fields.coordination[cell] += measures.coordination[i] * phi;
      if (!measures.stress_moment.empty()) fields.stress[cell] += phi * moment;
    }
  }
}

void finish_means(const std::vector<double>& number, CoarseFields& fields) {
  for (std::size_t cell = 0; cell < number.size(); ++cell) {
    if (!(number[cell] > 0)) continue;
    fields.velocity[cell] /= fields.density[cell];
    if (!fields.coordination.empty()) fields.coordination[cell] /= number[cell];
  }
}

/// A pass of its own: as the difference of two sums it would lose all digits where much moves as one.
void add_kinetic_stress(const CoarseGrid& grid, const Kernel& kernel, const ParticleView& particles,
                        const std::vector<char>& inside, CoarseFields& fields) {
  const double per_volume = 1 / grid.cell_volume();
  Spread spread;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (inside[i] == 0) continue;
    spread_point(grid, kernel, particles.position(i), spread);
    for (std::size_t s = 0; s < spread.cell.size(); ++s) {
      const std::size_t cell = spread.cell[s];
      const Vec3 own = particles.velocity(i) - fields.velocity[cell];
      fields.kinetic_stress[cell] -= per_volume * spread.share[s] * particles.mass[i] * own * own.transpose();
    }
  }
}

/// f (x) b times the kernel's mean along the branch, by Gauss' rule with three points on each piece. Weights
/// add up to 1, so the integral over space is f (x) b to rounding whatever the number of pieces.
void add_branch(const CoarseGrid& grid, const Kernel& kernel, const Vec3& start, const Vec3& branch,
                const Vec3& force, Spread& spread, CoarseFields& fields) {
  const std::array<double, 3> at{-std::sqrt(0.6), 0, std::sqrt(0.6)}, weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
  const int pieces = std::max(1, static_cast<int>(std::ceil(4 * branch.norm() / kernel.cutoff)));
  const Mat3 moment = force * branch.transpose() / (grid.cell_volume() * pieces);
  for (int piece = 0; piece < pieces; ++piece)
    for (std::size_t g = 0; g < at.size(); ++g) {
      const double along = (piece + 0.5 + 0.5 * at[g]) / pieces;
      spread_point(grid, kernel, start + along * branch, spread);
      for (std::size_t s = 0; s < spread.cell.size(); ++s)
        fields.stress[spread.cell[s]] += weight[g] * spread.share[s] * moment;
    }
}

void add_contacts(const CoarseGrid& grid, const Kernel& kernel, const ParticleView& particles,
                  const ContactNetwork& network, const std::vector<char>& inside, bool branches,
                  CoarseFields& fields) {
  Spread spread;
  for (std::size_t c = 0; c < network.size(); ++c) {
    const auto i = static_cast<std::size_t>(network.particle[c]);
    const bool of_grains = network.kind[c] == ContactKind::grain;
    if (inside[i] == 0 || (of_grains && inside[static_cast<std::size_t>(network.other[c])] == 0)) continue;
    const Vec3 start = particles.position(i), force = network.force(c);
    if (branches) add_branch(grid, kernel, start, network.branch[c], force, spread, fields);
    if (of_grains) continue;
    spread_point(grid, kernel, start + network.branch[c], spread);
    for (std::size_t s = 0; s < spread.cell.size(); ++s)
      fields.boundary_force[spread.cell[s]] += spread.share[s] / grid.cell_volume() * force;
  }
}

}  // namespace

CoarseFields coarse_grain(const CoarseGrid& grid, const Kernel& kernel, const ParticleView& particles,
                          const ParticleMeasures& measures, const ContactNetwork& network) {
  const std::size_t cells = grid.size();
  CoarseFields fields;
  fields.density.assign(cells, 0);
  fields.velocity.assign(cells, Vec3::Zero());
  if (!measures.solid_volume.empty()) fields.porosity.assign(cells, 1);
  if (!measures.coordination.empty()) fields.coordination.assign(cells, 0);
  fields.kinetic_stress.assign(cells, Mat3::Zero());
  fields.stress.assign(cells, Mat3::Zero());
  fields.boundary_force.assign(cells, Vec3::Zero());
  const std::vector<char> inside = find_inside(grid, particles, fields);
  std::vector<double> number(cells, 0);
  add_particles(grid, kernel, particles, measures, inside, number, fields);
  finish_means(number, fields);
  add_kinetic_stress(grid, kernel, particles, inside, fields);
  add_contacts(grid, kernel, particles, network, inside, measures.stress_moment.empty(), fields);
  return fields;
}

}  // namespace tuft::micro
