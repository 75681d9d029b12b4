#include "tests/verification/sph_infill/cases/statics.h"

#include <numbers>

namespace tuft::sph::test {
namespace {

constexpr double g = 9.81;

/// Kernels themselves (the solver needs their slopes alone), normalised in space.
double kernel_value(Kernel kernel, double h, double r) {
  const double q = r / h;
  if (q >= 2) return 0;
  if (kernel == Kernel::wendland_c2)
    return 21 / (16 * std::numbers::pi * h * h * h) * std::pow(1 - q / 2, 4) * (2 * q + 1);
  const double outer = std::pow(2 - q, 3), inner = q < 1 ? 4 * std::pow(1 - q, 3) : 0;
  return (outer - inner) / (4 * std::numbers::pi * h * h * h);
}

}  // namespace

namespace {

/// By summation over that by continuity.
std::vector<double> density_ratios(const SphInfill& infill, const SphOptions& options) {
  std::vector<double> ratio = summed_density(infill.particles(), options);
  const auto by_continuity = field(infill, "density");
  for (std::size_t i = 0; i < ratio.size(); ++i) ratio[i] /= by_continuity[i];
  return ratio;
}

/// Two rows off all boundaries the kernel is full for most of its weight.
bool is_inside(const Vec3& x, int width, int rows, double pitch) {
  return std::max(std::abs(x.x()), std::abs(x.y())) <= (0.5 * width - 2) * pitch && x.z() >= 2 * pitch &&
         x.z() <= (rows - 2) * pitch;
}

}  // namespace

std::vector<double> summed_density(const ParticleView& p, const SphOptions& options) {
  const double h = options.smoothing_length;
  std::vector<double> density(p.size(), 0);
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < p.size(); ++j)
      density[i] += p.mass[j] * kernel_value(options.kernel, h, (p.position(i) - p.position(j)).norm());
  return density;
}

ColumnResult geostatic_column(const Numerics& numerics, const ColumnSizes& sizes) {
  const int width = sizes.width, rows = sizes.rows, border = 2;
  const double pitch = sizes.pitch;
  const auto materials = single_material(mixture_material());
  const Lattice lattice = block(width, width, rows, pitch);
  SphInfill infill(lattice, materials, settings_of(numerics, pitch, {0, 0, -g}));
  const std::size_t n = lattice.position.size();
  const double rho = materials[0].continuum->density, height = rows * pitch, full = rho * g * height;
  const double modulus = constrained_modulus(*materials[0].continuum, 1e4);
  const double stiffness = 10 * modulus * pitch;
  const Tray tray(width * pitch, width * pitch, stiffness, 0.1);
  const std::vector<double> ratio_placed = density_ratios(infill, settings_of(numerics, pitch, {}).options);
  ContactImpulses contact;
  // The critical damping of the column's first mode, of circular frequency pi c/(2 H).
  const double frequency = 0.5 * std::numbers::pi * std::sqrt(modulus / rho) / height;
  infill.set_damping(2 * frequency);
  double floor_force = 0;
  for (double t = 0; t < 14 / frequency;) {
    const double dt = step_with_walls(infill, stiffness);
    tray.push(infill.particles(), dt, contact);
    infill.advance(dt, 1, contact);
    floor_force = 0;
    for (const double impulse : contact.linear.z) floor_force += impulse / dt;
    t += dt;
  }

  ColumnResult result;
  const auto stress = field(infill, "vertical_stress"), density = field(infill, "density");
  double row_below = 0, squares = 0;
  for (int row = border; row < rows - border; ++row) {
    const double z = (row + 0.5) * pitch, expected = -rho * g * (height - z);
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double to_wall =
          0.5 * width * pitch - std::max(std::abs(lattice.position.x[i]), std::abs(lattice.position.y[i]));
      if (std::abs(lattice.position.z[i] - z) > 0.1 * pitch || to_wall < border * pitch) continue;
      result.worst_particle = std::max(result.worst_particle, std::abs(stress[i] - expected) / full);
      sum += stress[i];
      ++count;
    }
    const double plane = -rho * g * (height - row * pitch);
    if (row > border) {
      const double error = std::abs(0.5 * (row_below + sum / count) - plane) / full;
      result.worst_plane = std::max(result.worst_plane, error);
      squares += error * error;
    }
    row_below = sum / count;
  }
  result.mean_plane = std::sqrt(squares / (rows - 2 * border - 1));
  for (const double value : density)
    result.density_spread = std::max(result.density_spread, std::abs(value / rho - 1));
  const std::vector<double> ratio = density_ratios(infill, settings_of(numerics, pitch, {}).options);
  for (std::size_t i = 0; i < n; ++i)
    if (is_inside(lattice.position[i], width, rows, pitch))
      result.density_drift = std::max(result.density_drift, std::abs(ratio[i] / ratio_placed[i] - 1));
  const double weight = rho * std::pow(width * pitch, 2) * height * g;
  result.floor_force = floor_force / weight;
  result.kinetic = infill.energy().kinetic / (weight * height);
  return result;
}

double pressed_block(const Numerics& numerics, int rows, double contact_stiffness) {
  const int width = 8;
  const double pitch = 0.002, height = rows * pitch, strain = 1e-3;
  const SoilFoamMaterial material = elastic_material(1e6, 1000);
  SphInfill infill(block(width, width, rows, pitch), single_material(material),
                   settings_of(numerics, pitch, {0, 0, 0}));
  const double modulus = constrained_modulus(material, 0), stiffness = contact_stiffness * modulus * pitch;
  Tray tray(width * pitch, width * pitch, stiffness, 0.1);
  tray.planes.push_back({{0, 0, height}, {0, 0, -1}, stiffness, 0.1});
  const double frequency = std::numbers::pi * std::sqrt(modulus / material.density) / height;
  infill.set_damping(2 * frequency);
  ContactImpulses contact;
  double force = 0;
  for (double t = 0; t < 25 / frequency;) {
    const double dt = step_with_walls(infill, stiffness, 0.7);
    // Slowly: a blow leaves rows displaced in patterns that meet no stress, and with them another force.
    const double share = std::min(1.0, t * frequency / 15);
    tray.planes.back().point.z() = height * (1 - strain * share * share * (3 - 2 * share));
    tray.push(infill.particles(), dt, contact);
    force = 0;
    for (const double impulse : contact.linear.z) force += 0.5 * std::abs(impulse) / dt;
    infill.advance(dt, 1, contact);
    t += dt;
  }
  return force / std::pow(width * pitch, 2) / (modulus * strain);
}

double kinetic_energy_under_changing_steps(const Numerics& numerics) {
  constexpr double pitch = 0.002;
  constexpr int side = 6;
  const auto materials = single_material(mixture_material());
  SphSettings settings = settings_of(numerics, pitch, {0, 0, -g});
  settings.kick_length = KickLength::step_begun;
  SphInfill infill(block(side, side, side, pitch), materials, settings);
  const double height = side * pitch, weight = materials[0].continuum->density * height * height * height * g;
  const double stiffness = 10 * constrained_modulus(*materials[0].continuum, 1e4) * pitch;
  const Tray tray(height, height, stiffness, 0.1);
  const double dt = step_with_walls(infill, stiffness, 0.75);
  ContactImpulses contact;
  const auto step = [&](double length) {
    tray.push(infill.particles(), length, contact);
    infill.advance(length, 1, contact);
  };
  infill.set_damping(2000);
  for (int k = 0; k < 5000; ++k) step(dt);
  infill.set_damping(0);
  double largest = 0;
  for (int k = 0; k < 100; ++k) {
    step(k % 2 == 0 ? 0.5 * dt : dt);
    largest = std::max(largest, infill.energy().kinetic);
  }
  return largest / (weight * height);
}

BedResult settled_bed(const Numerics& numerics, const BedSizes& sizes) {
  const double pitch = sizes.pitch;
  const auto materials = single_material(mixture_material());
  const Lattice lattice = block(sizes.width, sizes.width, sizes.rows, pitch);
  const SphSettings settings = settings_of(numerics, pitch, {0, 0, -g});
  SphInfill infill(lattice, materials, settings);
  const std::size_t n = lattice.position.size();
  const double rho = materials[0].continuum->density, height = sizes.rows * pitch;
  const double scale = rho * std::pow(sizes.width * pitch, 2) * height * g * height;
  const double stiffness = 10 * constrained_modulus(*materials[0].continuum, 1e4) * pitch;
  const Tray tray(sizes.width * pitch, sizes.width * pitch, stiffness, 0.1);
  const double dt = step_with_walls(infill, stiffness, 0.75);

  const std::vector<double> first = density_ratios(infill, settings.options);

  BedResult result;
  EnergyLedger ledger;
  ContactImpulses contact;
  Vec3Array middle;
  for (int k = 0; k < sizes.steps; ++k) {
    if (k == sizes.steps / 2) {
      const ParticleView p = infill.particles();
      for (std::size_t i = 0; i < n; ++i) middle.push_back(p.position(i));
    }
    tray.push(infill.particles(), dt, contact);
    infill.advance(dt, 1, contact);
    ledger.enter(infill.energy());
    if (result.kinetic.size() <= static_cast<std::size_t>(10LL * k / sizes.steps))
      result.kinetic.push_back(0);
    result.kinetic.back() = std::max(result.kinetic.back(), infill.energy().kinetic / scale);
  }
  result.energy_error = ledger.worst / scale;

  const std::vector<double> last = density_ratios(infill, settings.options);
  const ParticleView p = infill.particles();
  int count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    result.largest_move = std::max(result.largest_move, (p.position(i) - middle[i]).norm() / pitch);
    if (!is_inside(lattice.position[i], sizes.width, sizes.rows, pitch)) continue;
    const double drift = last[i] / first[i] - 1;
    result.density_drift = std::max(result.density_drift, std::abs(drift));
    result.mean_density_drift += drift;
    ++count;
  }
  result.mean_density_drift /= count;
  return result;
}

}  // namespace tuft::sph::test
