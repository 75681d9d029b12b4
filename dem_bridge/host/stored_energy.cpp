/// Sums over the contacts of grains.
#include <algorithm>
#include <cstring>

#include "dem_bridge/cohesion.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"
#include "dem_bridge/host/contact_history.h"
#include "dem_bridge/host/engine_impl.h"

namespace tuft::dem {

LAMMPS_NS::FixPropertyGlobal* LiggghtsEngine::Impl::property(const char* name, const char* style, int rows,
                                                             int columns) {
  return dynamic_cast<LAMMPS_NS::FixPropertyGlobal*>(lammps->modify->find_fix_property(
      name, "property/global", style, rows, columns, "liggghts_host", false));
}

std::vector<double> LiggghtsEngine::Impl::property_of_types(const char* name) {
  const int types = lammps->atom->ntypes;
  auto* fix = property(name, "peratomtype", types, 0);
  if (fix == nullptr) throw std::runtime_error(fmt::format("the commands define no property {}", name));
  std::vector<double> values;
  for (int t = 0; t < types; ++t) values.push_back(fix->compute_vector(t));
  return values;
}

std::optional<Hysteresis> LiggghtsEngine::Impl::hysteresis() {
  const int types = lammps->atom->ntypes;
  const auto of_first = [&](const char* name) {
    auto* const fix = property(name, "peratomtypepair", types, types);
    return fix == nullptr ? 0.0 : fix->compute_array(0, 0);
  };
  if (property("coefficientMaxElasticStiffness", "peratomtypepair", types, types) == nullptr)
    return std::nullopt;
  return Hysteresis{of_first("coefficientMaxElasticStiffness"), of_first("coefficientPlasticityDepth"),
                    of_first("coefficientAdhesionStiffness")};
}

/// Elastic energy of all contacts where the last kick was made, less what cohesion has given. Between kicks
/// positions are moved back by one step, but springs' elongations stay those of the present positions, which
/// is off by their force times the slip of a step. Which models there are is asked of LIGGGHTS: a
/// characteristic velocity is Hooke's, a ratio of stiffnesses that of plastic springs, a second vector of
/// history the rolling spring's. Of a contact with another rank's grain each rank counts half.
double LiggghtsEngine::Impl::stored_energy(bool in_kick) {
  const auto* atom = lammps->atom;
  const auto young = property_of_types("youngsModulus"), poisson = property_of_types("poissonsRatio");
  auto* const velocity_of_hooke = property("characteristicVelocity", "scalar", 0, 0);
  auto* const cohesion = property("cohesionEnergyDensity", "peratomtypepair", atom->ntypes, atom->ntypes);
  const std::optional<Hysteresis> plastic = hysteresis();
  const int values = static_cast<LAMMPS_NS::PairGran*>(lammps->force->pair)->dnum(),
            tangential_spring = first_vector(values);
  const bool rolling_spring = values >= 6;
  const double back = started && !in_kick ? shared.step : 0;
  const Components velocity = components(SharedArrays::velocity_x);
  double total = 0;
  for_each_contact([&](int a, int b, const Vec3& distance, const double* history) {
    const double sum = atom->radius[a] + atom->radius[b], length = distance.norm();
    double distance_before = length;
    if (back > 0) distance_before = (distance - back * (velocity[index(a)] - velocity[index(b)])).norm();
    const double before = sum - distance_before, now = sum - length;
    if (before <= 0 && now <= 0) return;
    const double radius = atom->radius[a] * atom->radius[b] / sum;
    const int s = atom->type[a] - 1, t = atom->type[b] - 1;
    if (in_kick) {
      double& largest =
          report.overlap_largest[pair_place(static_cast<std::size_t>(s), static_cast<std::size_t>(t))];
      largest = std::max(largest, now / std::min(atom->radius[a], atom->radius[b]));
    }
    const double modulus = effective_young_modulus(young[s], poisson[s], young[t], poisson[t]);
    double tangential = 0, energy = 0;
    if (velocity_of_hooke != nullptr) {
      const double mass = atom->rmass[a] * atom->rmass[b] / (atom->rmass[a] + atom->rmass[b]);
      tangential = hooke_stiffness(modulus, radius, mass, velocity_of_hooke->compute_scalar());
      if (before > 0)
        energy += plastic ? hysteretic_energy(*plastic, tangential, radius, before, history[0])
                          : 0.5 * tangential * before * before;
    } else {
      if (before > 0) energy += normal_energy(modulus, radius, before);
      if (now > 0)
        tangential = tangential_stiffness(effective_shear_modulus(young[s], poisson[s], young[t], poisson[t]),
                                          radius, now);
    }
    if (cohesion != nullptr)
      energy -=
          cohesion->compute_array(s, t) * overlap_volume(atom->radius[a], atom->radius[b], distance_before);
    if (now > 0) {
      const double* const spring = history + tangential_spring;
      energy += 0.5 * tangential * load3(spring).squaredNorm();
      if (rolling_spring) energy += 0.5 * load3(spring + 3).squaredNorm() / (tangential * radius * radius);
    }
    total += b < atom->nlocal ? energy : 0.5 * energy;
  });
  return total;
}

/// In a kick, which may be within LIGGGHTS: no exception may pass through it.
void LiggghtsEngine::Impl::note_stored_energy() {
  try {
    report.stored_energy = stored_energy(true);
  } catch (const std::exception& error) {
    trouble = error.what();
  }
}

std::string LiggghtsEngine::Impl::list_overlaps() {
  const auto* const atom = lammps->atom;
  const auto coordination = memory.array(SharedArrays::coordination);
  for (int a = 0; a < local_count(); ++a) coordination[index(a)] = 0;
  std::vector<OverlapRecord> records;
  for_each_contact([&](int a, int b, const Vec3& distance, const double*) {
    const double overlap = atom->radius[a] + atom->radius[b] - distance.norm();
    if (overlap <= 0) return;
    const bool own = b < atom->nlocal;
    coordination[index(a)] += 1;
    if (own) coordination[index(b)] += 1;
    if (!own && index(a) > index(b)) return;
    const int s = atom->type[a] - 1, t = atom->type[b] - 1;
    records.push_back({std::min(s, t), std::max(s, t), overlap / std::min(atom->radius[a], atom->radius[b])});
  });
  std::string bytes(records.size() * sizeof(OverlapRecord), '\0');
  if (!records.empty()) std::memcpy(bytes.data(), records.data(), bytes.size());
  return bytes;
}

}  // namespace tuft::dem
