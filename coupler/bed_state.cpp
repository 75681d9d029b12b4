#include "coupler/bed_state.h"

#include <algorithm>
#include <span>
#include <vector>

#include "coupler/layer_depth.h"
#include "coupler/whole_grains.h"

namespace tuft::coupler {
namespace {

const dem::DemInfill& grains_of(const Simulation& simulation) {
  return dynamic_cast<const dem::DemInfill&>(simulation.infill());
}

/// What contacts do to spheres.
struct Load {
  Vec3Array force;  // N
  std::vector<int> contacts;
  double sum = 0, count = 0;  // N, of all contacts; how many
};

void add_contacts(Load& load, const ContactNetwork& network) {
  for (std::size_t c = 0; c < network.size(); ++c) {
    const Vec3 force = network.force(c);
    const auto add = [&](Index sphere, const Vec3& on_it) {
      load.force.add(static_cast<std::size_t>(sphere), on_it);
      ++load.contacts[static_cast<std::size_t>(sphere)];
    };
    add(network.particle[c], force);
    if (network.kind[c] == ContactKind::grain) add(network.other[c], -force);
    load.sum += force.norm();
    ++load.count;
  }
}

double quantile(std::vector<double>& sorted, std::size_t percent) {
  return sorted.empty() ? 0 : sorted[(sorted.size() - 1) * percent / 100];
}

}  // namespace

bool is_at_rest(const RestState& rest, double most_unborne) {
  constexpr double most_kinetic = 1e-3;  // grains of 3 mm at 8 mm/s
  return rest.unborne_weight <= most_unborne && rest.kinetic_share <= most_kinetic;
}

std::vector<double> numbers_of(const RestState& rest) {
  return {rest.unborne_weight, rest.unbalanced_force, rest.kinetic_share, rest.rattlers};
}

RestState rest_of(std::span<const double> n) {
  return {n[0], n[1], n[2], n[3]};
}

std::vector<double> numbers_of(const BedState& bed) {
  std::vector<double> numbers = numbers_of(bed.rest);
  numbers.insert(numbers.end(), {bed.depth, bed.bulk_density, bed.porosity, bed.coordination,
                                 bed.speed_median, bed.speed_percentile_99, bed.speed_largest,
                                 bed.overlap_mean, bed.overlap_percentile_99, bed.overlap_largest});
  return numbers;
}

BedState bed_of(std::span<const double> n) {
  return {n[4], n[5], n[6], n[7], rest_of(n), n[8], n[9], n[10], n[11], n[12], n[13]};
}

RestState measure_rest(const Simulation& simulation) {
  const dem::DemInfill& infill = grains_of(simulation);
  const ParticleView spheres = infill.particles();
  Load load;
  load.force.assign(spheres.size(), 0.0);
  load.contacts.assign(spheres.size(), 0);
  add_contacts(load, infill.contacts());
  add_contacts(load, simulation.boundary_contacts());

  const Vec3 gravity = simulation.infill_gravity();
  const std::vector<std::size_t> first = first_spheres(spheres.size(), infill.clumps());
  double unbalanced = 0, weight = 0, kinetic = 0, scale = 0, loose = 0, grains = 0;
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    if (spheres.is_expelled(first[g])) continue;
    Vec3 force(0, 0, 0), momentum(0, 0, 0);
    double mass = 0, widest = 0;
    int contacts = 0;
    for (std::size_t i = first[g]; i < first[g + 1]; ++i) {
      force += load.force[i] + spheres.mass[i] * gravity;
      momentum += spheres.mass[i] * spheres.velocity(i);
      mass += spheres.mass[i];
      widest = std::max(widest, 2 * spheres.radius[i]);
      contacts += load.contacts[i];
    }
    unbalanced += force.norm();
    kinetic += 0.5 * momentum.squaredNorm() / mass;
    weight += mass * gravity.norm();
    scale += mass * gravity.norm() * widest;
    loose += contacts < 2 ? 1 : 0;
    ++grains;
  }
  RestState rest;
  if (grains == 0) return rest;
  rest.rattlers = loose / grains;
  if (scale > 0) rest.kinetic_share = kinetic / scale;
  if (weight > 0) rest.unborne_weight = unbalanced / weight;
  if (load.sum > 0) rest.unbalanced_force = unbalanced / grains / (load.sum / load.count);
  return rest;
}

BedState measure_bed(const Simulation& simulation, std::array<double, 2> size, double floor,
                     std::size_t layers) {
  const dem::DemInfill& infill = grains_of(simulation);
  const ParticleView spheres = infill.particles();
  const std::vector<std::size_t> first = first_spheres(spheres.size(), infill.clumps());
  double mass = 0, volume = 0, count = 0;
  std::vector<double> speed;
  for (std::size_t g = 0; g + 1 < first.size(); ++g) {
    if (spheres.is_expelled(first[g])) continue;
    for (std::size_t i = first[g]; i < first[g + 1]; ++i) {
      mass += spheres.mass[i];
      volume += infill.solid_volume(i);
      speed.push_back(spheres.velocity(i).norm());
    }
    ++count;
  }
  BedState bed;
  bed.depth = layer_tops(spheres, size, floor, layers).back();
  const double room = size[0] * size[1] * bed.depth;
  if (!(room > 0) || count == 0) return bed;
  bed.bulk_density = mass / room;
  bed.porosity = 1 - volume / room;
  const auto overlaps = infill.overlaps();
  bed.coordination = 2 * static_cast<double>(overlaps.contacts) / count;
  bed.overlap_mean = overlaps.mean;
  bed.overlap_percentile_99 = overlaps.percentile_99;
  bed.overlap_largest = overlaps.largest;
  std::sort(speed.begin(), speed.end());
  bed.speed_median = quantile(speed, 50);
  bed.speed_percentile_99 = quantile(speed, 99);
  bed.speed_largest = quantile(speed, 100);
  bed.rest = measure_rest(simulation);
  return bed;
}

}  // namespace tuft::coupler
