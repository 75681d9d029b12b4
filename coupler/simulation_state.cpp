// What Simulation tells about itself.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coupler/carpet_terms.h"
#include "coupler/simulation.h"

namespace tuft::coupler {
namespace {

std::pair<std::size_t, double> fastest(std::span<const double> vx, std::span<const double> vy,
                                       std::span<const double> vz) {
  std::pair<std::size_t, double> result{0, 0.0};
  for (std::size_t i = 0; i < vx.size(); ++i) {
    const double squared = vx[i] * vx[i] + vy[i] * vy[i] + vz[i] * vz[i];
    if (!(squared <= result.second)) result = {i, squared};
    if (std::isnan(squared)) break;
  }
  return {result.first, std::sqrt(result.second)};
}

double highest(const ParticleView& points, double x, double y, double reach, bool with_radius) {
  double top = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double r = points.radius[i];
    if (points.is_expelled(i)) continue;
    if (std::hypot(points.x[i] - x, points.y[i] - y) > reach + (with_radius ? r : 0)) continue;
    top = std::max(top, points.z[i] + points.radius_upwards(i));
  }
  return top;
}

}  // namespace

std::string Simulation::describe_fastest() const {
  const ParticleView p = parts_.infill->particles();
  const fe::NodeView n = parts_.carpet->nodes();
  const auto particle = fastest(p.vx, p.vy, p.vz);
  const auto node = fastest(n.vx, n.vy, n.vz);
  return fmt::format("fastest particle {} ({:.3g} m/s), fastest carpet node {} ({:.3g} m/s)", particle.first,
                     particle.second, node.first, node.second);
}

double Simulation::highest_infill(double x, double y, double radius) const {
  return highest(parts_.infill->particles(), x, y, radius, true);
}

double Simulation::highest_carpet(double x, double y, double radius) const {
  return highest(node_points(parts_.carpet->nodes()), x, y, radius, false);
}

double Simulation::carpet_balance() const {
  return parts_.carpet->energy().balance();
}

double Simulation::infill_balance() const {
  const InfillEnergy e = parts_.infill->energy();
  return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.expelled + e.let_go -
         e.contact_work;
}

Simulation::Residuals Simulation::residuals() const {
  Residuals r;
  r.carpet = carpet_balance_ - carpet_reference_;
  r.infill = infill_balance_ - infill_reference_;
  r.contact_and_bodies = ledger_.imbalance() - r.carpet - r.infill;
  return r;
}

EnergyTerms Simulation::energy_terms() const {
  const fe::CarpetEnergy carpet = parts_.carpet->energy();
  const InfillEnergy infill = parts_.infill->energy();
  ContactEnergy contact = particle_shell_.energy();
  contact += particle_body_.energy();
  contact += node_body_.energy();
  EnergyTerms terms = terms_of(carpet);
  terms.kinetic_infill = infill.kinetic;
  terms.kinetic_bodies = body_kinetic_;
  terms.stored_infill = infill.stored;
  terms.dissipated_infill = infill.dissipated;
  terms.contact_elastic = contact.elastic;
  terms.contact_damping = contact.damped;
  terms.contact_friction = contact.friction;
  terms.gravity_potential += infill.gravity_potential + body_potential_;
  terms.damping += infill.damping + body_damping_;
  terms.expelled = infill.expelled;
  terms.conditioning = infill.let_go;
  // Between the parts contact is no work from outside; what it has released is.
  terms.external_work = external_work_ + contact.released + parts_.carpet->grips().work;
  return terms;
}

}  // namespace tuft::coupler
