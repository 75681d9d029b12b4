#include "coupler/whole_grains.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "dem_bridge/dem_infill.h"

namespace tuft::coupler {
namespace {

std::span<const Index> clumps_of(const Infill& infill) {
  const auto* grains = dynamic_cast<const dem::DemInfill*>(&infill);
  return grains == nullptr ? std::span<const Index>{} : grains->clumps();
}

}  // namespace

std::vector<std::size_t> first_spheres(std::size_t spheres, std::span<const Index> clumps) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < spheres; ++i)
    if (i == 0 || clumps.empty() || clumps[i] < 0 || clumps[i] != clumps[i - 1]) first.push_back(i);
  first.push_back(spheres);
  return first;
}

WholeGrains::WholeGrains(const Infill& infill) : WholeGrains(infill.particles(), clumps_of(infill)) {}

WholeGrains::WholeGrains(const ParticleView& spheres, std::span<const Index> clumps)
    : spheres_(spheres), view_(spheres) {
  const std::vector<std::size_t> first = first_spheres(spheres.size(), clumps);
  if (first.size() == spheres.size() + 1) return;
  for (std::size_t g = 0; g + 1 < first.size(); ++g) add_grain(spheres, first[g], first[g + 1]);
  view_ = {.x = position_.x,
           .y = position_.y,
           .z = position_.z,
           .vx = velocity_.x,
           .vy = velocity_.y,
           .vz = velocity_.z,
           .wx = spin_.x,
           .wy = spin_.y,
           .wz = spin_.z,
           .radius = radius_,
           .mass = mass_,
           .layer = layer_,
           .material = material_,
           .expelled = expelled_};
}

/// Masses of spheres are shares of their clump's, with its centre of mass (docs/theory/dem.md).
void WholeGrains::add_grain(const ParticleView& spheres, std::size_t first, std::size_t end) {
  double mass = 0, widest = 0;
  Vec3 moment(0, 0, 0), momentum(0, 0, 0);
  for (std::size_t i = first; i < end; ++i) {
    mass += spheres.mass[i];
    moment += spheres.mass[i] * spheres.position(i);
    momentum += spheres.mass[i] * spheres.velocity(i);
    widest = std::max(widest, spheres.radius[i]);
    grain_of_sphere_.push_back(static_cast<Index>(mass_.size()));
  }
  position_.push_back(moment / mass);
  velocity_.push_back(momentum / mass);
  spin_.push_back(spheres.spin(first));
  radius_.push_back(widest);
  mass_.push_back(mass);
  layer_.push_back(spheres.layer[first]);
  material_.push_back(spheres.material[first]);
  expelled_.push_back(spheres.is_expelled(first) ? 1 : 0);
}

ContactNetwork WholeGrains::network_of(const ContactNetwork& of_spheres) const {
  if (grain_of_sphere_.empty()) return of_spheres;
  const auto grain = [&](Index sphere) { return grain_of_sphere_[static_cast<std::size_t>(sphere)]; };
  const auto other_of = [&](std::size_t c) {
    return of_spheres.kind[c] == ContactKind::grain ? grain(of_spheres.other[c]) : of_spheres.other[c];
  };
  std::vector<std::size_t> order(of_spheres.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t c) {
    return std::tuple(of_spheres.kind[c], grain(of_spheres.particle[c]), other_of(c));
  });
  ContactNetwork network;
  for (const std::size_t c : order) {
    const Index whole = grain(of_spheres.particle[c]), other = other_of(c);
    const Vec3 from = view_.position(static_cast<std::size_t>(whole));
    const Vec3 to = of_spheres.kind[c] == ContactKind::grain
                        ? view_.position(static_cast<std::size_t>(other))
                        : Vec3(spheres_.position(static_cast<std::size_t>(of_spheres.particle[c])) +
                               of_spheres.branch[c]);
    network.kind.push_back(of_spheres.kind[c]);
    network.particle.push_back(whole);
    network.other.push_back(other);
    network.branch.push_back(to - from);
    network.normal_force.push_back(of_spheres.normal_force[c]);
    network.tangential_force.push_back(of_spheres.tangential_force[c]);
    network.overlap.push_back(of_spheres.overlap[c]);
  }
  return network;
}

}  // namespace tuft::coupler
