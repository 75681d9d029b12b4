#include "tests/verification/sph_infill/cases/waves.h"

#include <numbers>

namespace tuft::sph::test {
namespace {

constexpr double bulk = 1e6, density = 1000, shear_ratio = 0.5;  // Pa, kg/m^3
constexpr double modulus = bulk * (1 + 4.0 / 3 * shear_ratio);
constexpr int width = 5;
const double theory = std::sqrt(modulus / density);

struct Bar {
  double pitch;
  Lattice lattice;
  SphInfill infill;
  double roller, dt;
  ContactImpulses contact;
  std::vector<std::vector<std::size_t>> members;  ///< of each row

  Bar(const Numerics& numerics, const BarSizes& sizes)
      : pitch(sizes.length / sizes.rows),
        lattice(block_of({numerics, sizes.half_row}, width, width, sizes.rows, pitch)),
        infill(lattice, single_material(elastic_material(bulk, density, shear_ratio)),
               settings_of(numerics, pitch, {0, 0, 0})),
        roller(200 * modulus * pitch),
        dt(step_with_walls(infill, roller, 0.5)),
        members(static_cast<std::size_t>(sizes.rows)) {
    for (std::size_t i = 0; i < lattice.position.size(); ++i)
      members[static_cast<std::size_t>(lattice.position.z[i] / pitch)].push_back(i);
  }

  void push_rollers() {
    const ParticleView p = infill.particles();
    contact.linear.assign(p.size(), 0);
    for (std::size_t i = 0; i < p.size(); ++i)
      contact.linear.set(
          i, -dt * roller * Vec3(p.x[i] - lattice.position.x[i], p.y[i] - lattice.position.y[i], 0));
  }
  /// Mean over a row.
  [[nodiscard]] double of_row(int row, std::span<const double> values) const {
    double sum = 0;
    for (const std::size_t i : members[static_cast<std::size_t>(row)]) sum += values[i];
    return sum / (width * width);
  }
};

/// Largest value of either sign and when, by a parabola through the samples around it.
struct Peak {
  double value = 0, time = 0;
};
Peak peak_of(const std::vector<double>& samples, double dt, double from, double to) {
  const auto first = static_cast<std::size_t>(std::max(1.0, from / dt)),
             last = std::min(samples.size() - 2, static_cast<std::size_t>(to / dt));
  std::size_t k = first;
  for (std::size_t m = first; m <= last; ++m)
    if (std::abs(samples[m]) > std::abs(samples[k])) k = m;
  const double a = samples[k - 1], b = samples[k], c = samples[k + 1], bend = a - 2 * b + c;
  const double shift = bend == 0 ? 0 : 0.5 * (a - c) / bend;
  return {b - 0.25 * (a - c) * shift, (static_cast<double>(k) + shift) * dt};
}

}  // namespace

ModeResult free_bar_mode(const Numerics& numerics, const BarSizes& sizes) {
  Bar bar(numerics, sizes);
  const std::size_t n = bar.lattice.position.size();
  std::vector<double> shape(n);
  for (std::size_t i = 0; i < n; ++i) {
    shape[i] = std::cos(std::numbers::pi * bar.lattice.position.z[i] / sizes.length);
    bar.infill.set_velocity(i, {0, 0, 0.05 * shape[i]});
  }
  // Zero crossings of the modal velocity at 1/4 and 3/4 of the period; velocities stand half a step behind.
  std::vector<double> crossings;
  double before = 1;
  for (double t = 0; crossings.size() < 3 && t < 4 * sizes.length / theory; t += bar.dt) {
    bar.push_rollers();
    bar.infill.advance(bar.dt, 1, bar.contact);
    double mode = 0;
    for (std::size_t i = 0; i < n; ++i) mode += bar.infill.particles().vz[i] * shape[i];
    if (mode * before < 0) crossings.push_back(t + 0.5 * bar.dt - bar.dt * mode / (mode - before));
    before = mode;
  }
  if (crossings.size() < 3) return {};
  return {2 * sizes.length / (crossings[2] - crossings[0]) / theory,
          2 * sizes.length / (4 * crossings[0]) / theory};
}

PulseResult reflected_pulse(const Numerics& numerics, const BarSizes& sizes, double pulse_width) {
  Bar bar(numerics, sizes);
  const double length = sizes.length, speed = 0.01 * theory;
  for (std::size_t i = 0; i < bar.lattice.position.size(); ++i) {
    const double x = (bar.lattice.position.z[i] / length - 0.5) / pulse_width;
    // Towards the wall: it meets it as compression, and the free end as tension.
    bar.infill.set_velocity(i, {0, 0, -speed * std::exp(-0.5 * x * x)});
  }
  const double wall = sizes.half_row ? 2 * modulus * bar.pitch : bar.roller;  // N/m
  std::vector<double> on_wall;                                                // Pa
  // A particle that touches the wall is held in place as a wall's own material would hold it: both ways.
  const auto push_wall = [&] {
    const ParticleView p = bar.infill.particles();
    double force = 0;
    for (const std::size_t i : bar.members[0]) {
      const double pull = wall * (p.z[i] - bar.lattice.position.z[i]);
      bar.contact.linear.add(i, {0, 0, -bar.dt * pull});
      force += pull;
    }
    on_wall.push_back(force / (width * width * bar.pitch * bar.pitch));
  };
  const int rows = sizes.rows, near_wall = rows / 4, near_free = rows - 1 - rows / 4;
  const std::array<int, 4> stations{rows / 8, 3 * rows / 8, near_wall, near_free};
  std::array<std::vector<double>, 4> velocity, stress;
  std::vector<double> at_wall;
  EnergyLedger ledger;
  for (double t = 0; t < 1.1 * length / theory; t += bar.dt) {
    bar.push_rollers();
    push_wall();
    bar.infill.advance(bar.dt, 1, bar.contact);
    ledger.enter(bar.infill.energy());
    const auto sigma = field(bar.infill, "vertical_stress");
    for (std::size_t s = 0; s < stations.size(); ++s) {
      velocity[s].push_back(bar.of_row(stations[s], bar.infill.particles().vz));
      stress[s].push_back(bar.of_row(stations[s], sigma));
    }
    // On the plane between the second and the third row: without shares the outermost carries half the
    // stress, see statics.h.
    at_wall.push_back(0.5 * (bar.of_row(1, sigma) + bar.of_row(2, sigma)));
  }

  PulseResult result;
  const double crossing = length / theory, dt = bar.dt;
  const auto before = [&](const std::vector<double>& samples) {
    return peak_of(samples, dt, 0, 0.5 * crossing);
  };
  const auto after = [&](const std::vector<double>& samples) {
    return peak_of(samples, dt, 0.5 * crossing, crossing);
  };
  const double apart = (stations[1] - stations[0]) * bar.pitch;
  result.speed = apart / (before(velocity[0]).time - before(velocity[1]).time) / theory;
  const double in = before(velocity[2]).value, out = before(velocity[3]).value;
  const double in_stress = before(stress[2]).value, out_stress = before(stress[3]).value;
  result.wall_velocity = after(velocity[2]).value / in;
  result.free_velocity = after(velocity[3]).value / out;
  result.wall_stress = after(stress[2]).value / in_stress;
  result.free_stress = after(stress[3]).value / out_stress;
  result.doubled_stress = peak_of(at_wall, dt, 0, crossing).value / in_stress;
  result.wall_force = peak_of(on_wall, dt, 0, crossing).value / in_stress;
  result.energy_error = ledger.worst / ledger.first;
  return result;
}

}  // namespace tuft::sph::test
