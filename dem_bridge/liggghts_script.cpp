#include "dem_bridge/liggghts_script.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "dem_bridge/grain_contact.h"
#include "dem_bridge/protocol.h"

namespace tuft::dem {
namespace {

/// LIGGGHTS refuses moduli outside 5 MPa ... 1 GPa unless told that they are meant.
constexpr double soft_limit = 5e6, hard_limit = 1e9;  // Pa

/// LIGGGHTS forgets the springs of a pair that has parted only while the pair is closer than this times the
/// sum of radii; its default of 1 means never, until the neighbour list is built anew: grains that touch
/// again would meet the spring of their last contact, and the motion would depend on when lists are built. A
/// pair must not open this far in one step (10 m/s for grains of 1 mm and steps of 4 us).
constexpr double forget_distance = 1.02;

/// Distance a pair may close before the neighbour list is built again, as a share of the smallest radius:
/// a larger skin means fewer builds and more pairs to look at in each step.
constexpr double skin_share = 0.25;

static_assert(parking_distance < expulsion_margin);

/// Half of the largest reach, as LIGGGHTS would choose, unless that cuts a wide empty box into far more bins
/// than there are grains: each build of the neighbour list empties all of them.
double bin_size(const GrainSizes& sizes, const std::array<Vec3, 2>& box) {
  const double bins = 16.0 * static_cast<double>(sizes.count) + 4096.0;
  const double reach = forget_distance * 2 * sizes.largest + skin_share * sizes.smallest;
  return std::max(0.5 * reach, std::cbrt((box[1] - box[0]).prod() / bins));
}

std::string per_type(const char* id, const char* property, std::size_t types,
                     const std::function<double(std::size_t)>& value) {
  std::string line = fmt::format("fix {} all property/global {} peratomtype", id, property);
  for (std::size_t i = 0; i < types; ++i) line += fmt::format(" {:.17g}", value(i));
  return line + "\n";
}

std::string per_pair(const char* id, const char* property, std::size_t types,
                     const std::function<double(std::size_t, std::size_t)>& value) {
  std::string line = fmt::format("fix {} all property/global {} peratomtypepair {}", id, property, types);
  for (std::size_t i = 0; i < types; ++i)
    for (std::size_t j = 0; j < types; ++j) line += fmt::format(" {:.17g}", value(i, j));
  return line + "\n";
}

/// What moves clumps. Spheres are moved by the bridge (host/sphere_steps.h).
std::string integrators(const std::vector<bool>& clumped) {
  return std::ranges::count(clumped, true) == 0 ? "" : "fix clumps all multisphere\n";
}

}  // namespace

std::array<int, 2> rank_grid(int ranks, double length_x, double length_y) {
  std::array<int, 2> best{ranks, 1};
  double shortest = std::numeric_limits<double>::infinity();
  for (int x = 1; x <= ranks; ++x) {
    if (ranks % x != 0) continue;
    const double cuts = (x - 1) * length_y + (ranks / x - 1) * length_x;
    if (cuts > shortest || (cuts == shortest && x < best[0])) continue;
    shortest = cuts;
    best = {x, ranks / x};
  }
  return best;
}

std::vector<Index> used_materials(const Grains& grains) {
  std::vector<Index> used = grains.material;
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

std::vector<bool> clumped_materials(const Grains& grains, const std::vector<Index>& used) {
  std::vector<bool> clumped(used.size(), false);
  for (std::size_t i = 0; i < grains.body.size(); ++i)
    if (grains.body[i] >= 0)
      clumped[static_cast<std::size_t>(std::lower_bound(used.begin(), used.end(), grains.material[i]) -
                                       used.begin())] = true;
  return clumped;
}

namespace {

void check_clumps(const Grains& grains, const std::vector<Material>& materials, const DemSettings& settings) {
  if (grains.body.empty()) return;
  if (grains.body.size() != grains.size())
    throw_input_error("DEM infill: {} grains, but {} are said to be in clumps or not", grains.size(),
                      grains.body.size());
  const std::vector<Index> used = used_materials(grains);
  const std::vector<bool> clumped = clumped_materials(grains, used);
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto type = std::lower_bound(used.begin(), used.end(), grains.material[i]) - used.begin();
    if (grains.body[i] < 0 && clumped[static_cast<std::size_t>(type)])
      throw_input_error("DEM infill: grain {} of {} is a sphere, others are clumps; give it another material",
                        i, materials[static_cast<std::size_t>(grains.material[i])].name);
  }
  if (settings.options.ranks > 1 && std::ranges::count(clumped, true) > 0)
    throw_input_error("DEM infill: infill.dem.ranks is {}; clumps of grains need one process",
                      settings.options.ranks);
}

}  // namespace

void check_grains(const Grains& grains, const std::vector<Material>& materials, const DemSettings& settings) {
  const std::size_t count = grains.size();
  if (count == 0)
    throw_input_error("DEM infill: there is not a single grain; give the turf layers of infill");
  if (grains.position.size() != count || grains.density.size() != count || grains.layer.size() != count ||
      grains.material.size() != count)
    throw_input_error("DEM infill: {} radii but {} positions, {} densities, {} layers, {} materials", count,
                      grains.position.size(), grains.density.size(), grains.layer.size(),
                      grains.material.size());
  if (const std::size_t kinds = used_materials(grains).size(); kinds > largest_kinds)
    throw_input_error("DEM infill: {} grain materials; there may be {}: mix fewer", kinds, largest_kinds);
  if (settings.options.contact != GrainContact::hertz && !(settings.options.characteristic_velocity > 0))
    throw_input_error(
        "DEM infill: infill.dem.characteristic_velocity is {} m/s; Hooke's contact needs it above 0",
        settings.options.characteristic_velocity);
  for (std::size_t i = 0; i < count; ++i) {
    const Index m = grains.material[i];
    if (m < 0 || m >= static_cast<Index>(materials.size()) || !materials[m].grain)
      throw_input_error(
          "DEM infill: material {} of grain {} has no grain properties; give it a [grain] block", m, i);
    const Vec3 x = grains.position[i];
    if (!x.allFinite() || !(grains.radius[i] > 0) || !(grains.density[i] > 0) ||
        !std::isfinite(grains.radius[i]) || !std::isfinite(grains.density[i]))
      throw_input_error(
          "DEM infill: grain {} has position ({}, {}, {}) m, radius {} m, density {} kg/m^3; all must be "
          "finite, the last two positive",
          i, x.x(), x.y(), x.z(), grains.radius[i], grains.density[i]);
    if ((x.array() < settings.box[0].array()).any() || (x.array() >= settings.box[1].array()).any())
      throw_input_error(
          "DEM infill: grain {} at ({}, {}, {}) m is outside the box ({}, {}, {}) to ({}, {}, {}) m; "
          "enlarge the box",
          i, x.x(), x.y(), x.z(), settings.box[0].x(), settings.box[0].y(), settings.box[0].z(),
          settings.box[1].x(), settings.box[1].y(), settings.box[1].z());
  }
  check_clumps(grains, materials, settings);
  if (settings.cohesion) check_cohesion(used_materials(grains), materials, settings.options);
}

std::array<Vec3, 2> host_domain(const DemSettings& settings) {
  const Vec3 margin = Vec3::Constant(expulsion_margin);
  return {settings.box[0] - margin, settings.box[1] + margin};
}

std::vector<std::uint8_t> data_file(const Grains& grains, const std::vector<Index>& used,
                                    const std::array<Vec3, 2>& box) {
  std::string text = fmt::format("grains\n\n{} atoms\n{} atom types\n\n", grains.size(), used.size());
  const char* axes = "xyz";
  for (int a = 0; a < 3; ++a)
    text += fmt::format("{:.17g} {:.17g} {}lo {}hi\n", box[0][a], box[1][a], axes[a], axes[a]);
  text += "\nAtoms\n\n";
  for (std::size_t i = 0; i < grains.size(); ++i) {
    const auto type = std::lower_bound(used.begin(), used.end(), grains.material[i]) - used.begin() + 1;
    text += fmt::format("{} {} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", i + 1, type, 2 * grains.radius[i],
                        grains.density[i], grains.position.x[i], grains.position.y[i], grains.position.z[i]);
  }
  return {text.begin(), text.end()};
}

std::string set_up_commands(const std::string& source, const std::vector<Index>& used,
                            const std::vector<Material>& materials, const DemSettings& settings,
                            const GrainSizes& sizes, double step, const std::vector<bool>& clumped) {
  const std::size_t types = used.size();
  const auto grain = [&](std::size_t type) -> const GrainMaterial& { return *materials[used[type]].grain; };
  bool soft = false, hard = false;
  for (std::size_t i = 0; i < types; ++i) {
    soft |= grain(i).young_modulus < soft_limit;
    hard |= grain(i).young_modulus > hard_limit;
  }
  std::string text;
  if (soft) text += "soft_particles yes\n";
  if (hard) text += "hard_particles yes\n";
  text +=
      "units si\n"
      "atom_style granular\n"
      "atom_modify map array sort 0 0\n"
      "boundary f f f\n"
      "newton off\n"
      "communicate single vel yes\n";
  // A layer is flat: divided in height, most ranks would hold air.
  if (settings.options.ranks > 1) {
    const Vec3 size = settings.box[1] - settings.box[0];
    const auto [along_x, along_y] = rank_grid(settings.options.ranks, size.x(), size.y());
    text += fmt::format("processors {} {} 1\n", along_x, along_y);
  }
  text += source + "\n";
  text += fmt::format("neighbor {:.17g} bin\n", skin_share * sizes.smallest);
  text += fmt::format("neigh_modify delay 0 every 1 check yes contact_distance_factor {} binsize {:.17g}\n",
                      forget_distance, bin_size(sizes, host_domain(settings)));
  text += per_type("young_modulus", "youngsModulus", types, [&](auto i) { return grain(i).young_modulus; });
  text += per_type("poisson_ratio", "poissonsRatio", types, [&](auto i) { return grain(i).poisson_ratio; });
  const auto of_contacts = [&](const char* id, const char* property, double GrainMaterial::*own,
                               std::optional<double> GrainPair::*of_pair) {
    return per_pair(id, property, types, [&](auto i, auto j) {
      return contact_property(settings.options, materials, used[i], used[j], own, of_pair);
    });
  };
  text += of_contacts("restitution", "coefficientRestitution", &GrainMaterial::restitution,
                      &GrainPair::restitution);
  text += of_contacts("friction", "coefficientFriction", &GrainMaterial::friction, &GrainPair::friction);
  std::string model = "pair_style gran model hertz tangential history";
  const DemOptions& options = settings.options;
  if (options.contact != GrainContact::hertz) {
    text +=
        fmt::format("fix characteristic_velocity all property/global characteristicVelocity scalar {:.17g}\n",
                    options.characteristic_velocity);
    model = "pair_style gran model hooke tangential history";
  }
  if (options.contact == GrainContact::hooke_hysteresis) {
    const auto of_all = [&](const char* id, const char* property, double value) {
      text += per_pair(id, property, types, [=](auto, auto) { return value; });
    };
    of_all("unloading_ratio", "coefficientMaxElasticStiffness", options.unloading_ratio);
    of_all("adhesion_ratio", "coefficientAdhesionStiffness", options.adhesion_ratio);
    of_all("plastic_depth", "coefficientPlasticityDepth", options.plastic_depth);
    model = "pair_style gran model hooke/hysteresis tangential history";
  }
  if (settings.cohesion) {
    text += of_contacts("cohesion", "cohesionEnergyDensity", &GrainMaterial::cohesion_energy_density,
                        &GrainPair::cohesion_energy_density);
    model += " cohesion sjkr";
  }
  if (settings.rolling_resistance) {
    text += of_contacts("rolling_friction", "coefficientRollingFriction", &GrainMaterial::rolling_friction,
                        &GrainPair::rolling_friction);
    model +=
        settings.options.rolling == RollingModel::cdt ? " rolling_friction cdt" : " rolling_friction epsd2";
  }
  text += model + "\npair_coeff * *\n";
  text += fmt::format("timestep {:.17g}\n", step);
  text += integrators(clumped);
  text += fmt::format(
      "fix coupling all external pf/callback 1 {}\n"
      "thermo_style custom step\n"
      "thermo 1000000000\n"
      "thermo_modify lost ignore\n",
      external_forces_every);
  return text;
}

}  // namespace tuft::dem
