#include <algorithm>

#include "dem_bridge/dem_infill_impl.h"

namespace tuft::dem {

void DemInfill::Impl::sum_stored() {
  sums.stored = 0;
  for (std::size_t r = 0; r < memory().ranks(); ++r) sums.stored += memory().rank(r).stored_energy;
}

void DemInfill::Impl::ask_stored() {
  ask(Request::energy);
  sum_stored();
}

/// Before the first window, when bodies lie as given.
double DemInfill::Impl::kinetic_of_bodies() {
  double sum = 0;
  const auto vector = [&](std::size_t first, std::size_t i) {
    return Vec3(array(first)[i], array(first + 1)[i], array(first + 2)[i]);
  };
  for (const GrainBody& body : bodies.bodies) {
    Vec3 velocity(0, 0, 0);
    for (std::size_t k = 0; k < body.count; ++k)
      velocity += bodies.shape_of(body).share[k] * vector(SharedArrays::velocity_x, body.first + k);
    const Vec3 spin = body.axes.transpose() * vector(SharedArrays::spin_x, body.first);
    sum += 0.5 * (body.mass * velocity.squaredNorm() + spin.dot(bodies.inertia_of(body).asDiagonal() * spin));
  }
  return sum;
}

double DemInfill::Impl::kinetic_of_view() {
  double sum = kinetic_of_bodies();
  const auto mass = array(SharedArrays::mass);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (!grains.body.empty() && grains.body[i] >= 0) continue;
    double speed = 0, spin = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      speed += array(SharedArrays::velocity_x + c)[i] * array(SharedArrays::velocity_x + c)[i];
      spin += array(SharedArrays::spin_x + c)[i] * array(SharedArrays::spin_x + c)[i];
    }
    sum += 0.5 * mass[i] * (speed + 0.4 * grains.radius[i] * grains.radius[i] * spin);
  }
  return sum;
}

/// At the last kick: positions one step back along the velocity they have moved with since.
double DemInfill::Impl::gravity_potential() {
  const double back = started ? shared().step : 0;
  const auto mass = array(SharedArrays::mass);
  double sum = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto x = array(SharedArrays::position_x + c), v = array(SharedArrays::velocity_x + c);
    const double g = settings.gravity[static_cast<Eigen::Index>(c)];
    for (std::size_t i = 0; i < grains.size(); ++i) sum -= mass[i] * g * (x[i] - back * v[i]);
  }
  return sum;
}

InfillEnergy DemInfill::energy() const {
  Impl& my = *impl_;
  if (!my.stored_is_current) my.ask_stored();
  InfillEnergy energy;
  energy.stored = my.sums.stored;
  energy.gravity_potential = my.gravity_potential();
  if (!my.started) {
    energy.kinetic = my.kinetic_of_view();
    return energy;
  }
  // The moment is the middle of the last kick, so half of its work has been done.
  const HostSums& sums = my.sums;
  const double pair_work = sums.pair_work - 0.5 * sums.last_pair_work;
  energy.kinetic = sums.kinetic;
  energy.expelled = my.expelled.energy;
  energy.contact_work = sums.contact_work - 0.5 * sums.last_contact_work;
  energy.damping = -(sums.damping_work - 0.5 * sums.last_damping_work);
  const double missing = -pair_work - (energy.stored - my.initial_stored);
  my.dissipated += std::max(0.0, missing - my.missing);
  my.missing = missing;
  energy.dissipated = my.dissipated;
  return energy;
}

void DemInfill::Impl::read_expelled() {
  if (expelled.grains == 0) return;
  const auto flags = array(SharedArrays::expelled);
  expelled_mask.assign(flags.begin(), flags.end());
}

Expelled DemInfill::expelled() const {
  const ExpelledSums& sums = impl_->expelled;
  return {sums.grains, sums.mass, Vec3(sums.momentum.data()), sums.energy + sums.pending};
}

}  // namespace tuft::dem
