#include "tests/verification/sph_infill/cases/drawn_block.h"

namespace tuft::sph::test {
DrawnResult drawn_block(const Numerics& numerics, const DrawnCase& c) {
  const int width = 8, rows = 16;
  const double pitch = c.pitch, length = rows * pitch;
  Lattice lattice = block(width, width, rows, pitch);
  jitter(lattice, c.jitter);
  const std::size_t n = lattice.position.size();
  SphSettings settings = settings_of(numerics, pitch, {0, 0, 0});
  settings.tension_cutoff = c.tension_cutoff;
  SphInfill infill(lattice, single_material(c.material), settings);
  const double stiffness = 2 * constrained_modulus(c.material, 0) * pitch;
  const double start = 0.05 * length / c.speed;  // grips come to speed over this time
  const auto grip_path = [&](double t) {
    return t < start ? 0.5 * c.speed * t * t / start : c.speed * (t - 0.5 * start);
  };

  DrawnResult result;
  EnergyLedger ledger;
  ContactImpulses contact;
  result.smallest_distance = 1;
  double time = 0, next_look = 0, work = 0;
  while (2 * grip_path(time) < c.stretch * length) {
    const double dt = step_with_walls(infill, stiffness, c.step);
    const ParticleView p = infill.particles();
    contact.linear.assign(n, 0);
    double pull = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double z = lattice.position.z[i], side = z > length - 2 * pitch ? 1 : z < 2 * pitch ? -1 : 0;
      if (side == 0) continue;
      const Vec3 target = lattice.position[i] + Vec3(0, 0, side * grip_path(time));
      const Vec3 impulse = -dt * stiffness * (p.position(i) - target);
      contact.linear.set(i, impulse);
      pull += 0.5 * side * impulse.z() / dt;
    }
    infill.advance(dt, 1, contact);
    const InfillEnergy e = infill.energy();
    ledger.enter(e);
    work = std::max(work, std::abs(e.contact_work));
    result.tension = std::max(result.tension, pull / (width * width * pitch * pitch));
    time += dt;
    if (time >= next_look) {
      next_look = time + 0.02 * length / c.speed;
      result.smallest_distance =
          std::min(result.smallest_distance, smallest_distance(infill.particles()) / pitch);
      result.clumped = share_closer_than(infill.particles(), 0.5 * pitch);
      result.close = std::max(result.close, result.clumped);
    }
  }
  result.energy_error = ledger.worst / work;
  const ParticleView p = infill.particles();
  std::vector<double> z(p.z.begin(), p.z.end());
  std::ranges::sort(z);
  for (std::size_t i = 1; i < n; ++i)
    result.widest_gap = std::max(result.widest_gap, (z[i] - z[i - 1]) / pitch);
  return result;
}

}  // namespace tuft::sph::test
