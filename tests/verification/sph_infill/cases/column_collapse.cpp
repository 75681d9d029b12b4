#include "tests/verification/sph_infill/cases/column_collapse.h"

#include <numbers>

namespace tuft::sph::test {
namespace {

constexpr double g = 9.81;
/// Over L0: what is thinner counts as spray.
constexpr double front_thickness = 0.025;

Lattice column(const CollapseCase& c, double pitch) {
  const int high = static_cast<int>(std::lround(c.aspect * c.particles));
  const int across = c.axisymmetric ? c.particles : c.slab;
  Lattice whole = block(c.particles, across, high, pitch), lattice;
  lattice.pitch = pitch;
  for (std::size_t i = 0; i < whole.position.size(); ++i) {
    // From the back wall, or the axis, on.
    const Vec3 x = whole.position[i] + Vec3(0.5 * c.particles, 0.5 * across, 0) * pitch;
    if (c.axisymmetric && std::hypot(x.x(), x.y()) > c.length) continue;
    lattice.position.push_back(x);
    lattice.volume.push_back(whole.volume[i]);
    lattice.layer.push_back(0);
    lattice.material.push_back(0);
  }
  return lattice;
}

double distance_from_back(const CollapseCase& c, const ParticleView& p, std::size_t i) {
  return c.axisymmetric ? std::hypot(p.x[i], p.y[i]) : p.x[i];
}

void measure_deposit(const CollapseCase& c, double pitch, double volume, const ParticleView& p,
                     CollapseResult& result) {
  // Wide enough that rows which have spread apart leave none of them empty.
  const double width = std::max(c.length / 8, 2 * pitch);
  std::vector<double> thickness(static_cast<std::size_t>(30 * c.length / width), 0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto bin = static_cast<std::size_t>(std::max(0.0, distance_from_back(c, p, i) / width));
    if (bin < thickness.size()) thickness[bin] += volume;
  }
  for (std::size_t b = 0; b < thickness.size(); ++b) {
    const double ring = std::numbers::pi / 4 * width * width * (2 * static_cast<double>(b) + 1);
    thickness[b] /= c.axisymmetric ? ring : width * c.slab * pitch;
  }
  const double thin = front_thickness * c.length;
  std::size_t front = 0;
  while (front + 1 < thickness.size() && thickness[front] >= thin) ++front;
  // Between the middles of the last bin that is thicker and the first that is not.
  const double above = front > 0 ? thickness[front - 1] : thin, below = thickness[front];
  const double length = (static_cast<double>(front) - 0.5 + (above - thin) / (above - below)) * width;
  result.run_out = length / c.length - 1;
  for (std::size_t i = 0; i < p.size(); ++i)
    if (distance_from_back(c, p, i) > length + width) result.spray += 1.0 / static_cast<double>(p.size());
  // Surface: the highest of its particles but one in twenty, which may be thrown up; a particle reaches half
  // a pitch beyond its middle.
  for (std::size_t b = 0; 2 * static_cast<double>(b) * pitch < length; ++b) {
    std::vector<double> heights;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (static_cast<std::size_t>(std::max(0.0, distance_from_back(c, p, i) / (2 * pitch))) == b)
        heights.push_back(p.z[i] + 0.5 * pitch);
    if (heights.empty()) break;
    const auto top =
        heights.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(heights.size() - 1));
    std::ranges::nth_element(heights, top);
    result.profile_x.push_back((2 * static_cast<double>(b) + 1) * pitch / c.length);
    result.profile_z.push_back(*top / c.length);
  }
  if (!result.profile_z.empty()) result.height = result.profile_z.front();
  result.close = share_closer_than(p, 0.5 * pitch);
}

}  // namespace

SoilFoamMaterial dry_grains(double friction) {
  SoilFoamMaterial m;
  const double bulk = 0.7e6, poisson = 0.3;
  m.density = 2650;
  m.pressure = {{0, 1}, {0, bulk}};
  m.unloading = {{0}, {bulk}};
  m.shear_ratio = 1.5 * (1 - 2 * poisson) / (1 + poisson);
  const double alpha = 3 * friction / std::sqrt(9 + 12 * friction * friction);
  m.yield_a0 = m.yield_a1 = 0;
  m.yield_a2 = alpha * alpha;
  m.tension_cutoff = 0;
  return m;
}

CollapseCase beads_in_a_channel() {
  CollapseCase c;
  c.friction = std::tan(22 * std::numbers::pi / 180);
  c.wall_friction = 0.233;  // tan 13.1 degrees
  c.channel = 0.45;
  return c;
}

RunOutLaws published_run_out(bool axisymmetric, double a) {
  const double root = std::sqrt(a), power = std::cbrt(a * a);
  if (axisymmetric) {
    const double lube = a < 1.7 ? 1.24 * a : 1.6 * root;
    return {lube, lube};
  }
  return {a < 2.3 ? 1.2 * a : 1.9 * power, a < 3 ? 1.8 * a : 2.3 * power};
}

CollapseResult column_collapse(const Numerics& numerics, const CollapseCase& c) {
  const double pitch = c.length / c.particles;
  SoilFoamMaterial grains = dry_grains(c.friction);
  grains.inertial_friction = c.inertial;
  const auto materials = single_material(grains);
  const Lattice lattice = column(c, pitch);
  SphSettings settings = settings_of(numerics, pitch, {0, 0, -g});
  settings.soil_effects.inertial_friction = c.inertial.has_value();
  SphInfill infill(lattice, materials, settings);
  // The deepest overlap, of rho g H on the floor, is 0.4 % of a pitch.
  const double stiffness = 2 * constrained_modulus(*materials[0].continuum, 0) * pitch;
  const FrictionPlane floor{{{0, 0, 0}, {0, 0, 1}, stiffness, 0.3}, c.floor.value_or(c.friction)};
  // The whole channel loses to its two walls what the slab, so much thinner, loses to its own.
  const double of_sides = c.axisymmetric ? 0 : c.wall_friction * c.slab * pitch / (c.channel * c.length);
  std::vector<FrictionPlane> walls{{{{0, 0, 0}, {1, 0, 0}, stiffness, 0.1}, 0},
                                   {{{0, 0, 0}, {0, 1, 0}, stiffness, 0.1}, of_sides}};
  if (!c.axisymmetric) walls.push_back({{{0, c.slab * pitch, 0}, {0, -1, 0}, stiffness, 0.1}, of_sides});

  CollapseResult result;
  EnergyLedger ledger;
  ContactImpulses contact;
  const std::size_t n = lattice.position.size();
  const double height = c.aspect * c.length, fall = std::sqrt(2 * height / g);
  double potential = 0;
  while (result.time < 10 * fall) {
    const ParticleView p = infill.particles();
    const double dt = step_with_walls(infill, stiffness);
    contact.linear.assign(n, 0);
    floor.push(p, dt, contact);
    for (const FrictionPlane& wall : walls) wall.push(p, dt, contact);
    infill.advance(dt, 1, contact);
    const InfillEnergy e = infill.energy();
    if (result.time == 0) potential = e.gravity_potential;
    ledger.enter(e);
    result.kinetic = e.kinetic / potential;
    result.time += dt;
    if (result.time > 2 * fall && result.kinetic < 1e-4) break;
  }
  result.energy_error = ledger.worst / potential;
  measure_deposit(c, pitch, lattice.volume[0], infill.particles(), result);
  return result;
}

}  // namespace tuft::sph::test
