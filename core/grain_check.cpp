#include "core/grain_check.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>
#include <system_error>

#include "core/error.h"
#include "core/nearest_name.h"

namespace tuft {
namespace {

/// Of a lognormal law between its limits: with less the limits and the law do not belong together.
constexpr double least_share_inside = 0.01;

std::string in_mm(double metres) {
  return fmt::format("{:g} mm", std::round(metres * 1e9) / 1e6);
}

void check_limits(const GrainMaterial& grain, const std::string& path, const Places& places) {
  if (grain.diameter_min == 0)
    places.fail(path + ".diameter_min", "missing; give the smallest grain, for example \"0.5 mm\"");
  if (grain.diameter_max == 0)
    places.fail(path + ".diameter_max", "missing; give the largest grain, for example \"2 mm\"");
  if (grain.diameter_max < grain.diameter_min)
    places.fail(path + ".diameter_max", fmt::format("is below diameter_min ({})", in_mm(grain.diameter_min)));
}

void check_shares_given(const std::string& path, const Places& places) {
  if (!places.has(path + ".sizes.by"))
    places.fail(path + ".sizes.by",
                "missing; say what shares count: \"mass\", as sieving and weighing do, or \"number\"");
}

/// Keys of one law beside another would do nothing.
void refuse(bool given, const std::string& key, std::string_view law, const Places& places) {
  if (given) places.fail(key, fmt::format("is for law = \"{}\"; leave it out", law));
}

void check_lognormal(const GrainMaterial& grain, const std::string& path, const Places& places) {
  const GrainSizes& sizes = grain.sizes;
  check_limits(grain, path, places);
  check_shares_given(path, places);
  if (sizes.median == 0)
    places.fail(path + ".sizes.median", "missing; law = \"lognormal\" needs it, for example \"1 mm\"");
  if (!(sizes.geometric_deviation > 1))
    places.fail(path + ".sizes.geometric_deviation",
                "law = \"lognormal\" needs it above 1 (about 68 % lie between median/deviation and median x "
                "deviation)");
  if (!(grain.diameter_max > grain.diameter_min))
    places.fail(path + ".diameter_max", "must be above diameter_min for law = \"lognormal\"");
  const auto below = [&](double diameter) {
    return 0.5 * std::erfc(-std::log(diameter / sizes.median) / std::log(sizes.geometric_deviation) /
                           std::numbers::sqrt2);
  };
  const double inside = below(grain.diameter_max) - below(grain.diameter_min);
  if (inside < least_share_inside)
    places.fail(
        path + ".sizes.median",
        fmt::format("only {:.1g} of this lognormal law lies between diameter_min ({}) and diameter_max "
                    "({}); move them or it",
                    inside, in_mm(grain.diameter_min), in_mm(grain.diameter_max)));
}

void complete_sieve(GrainMaterial& grain, const std::string& path, const Places& places) {
  const Curve& sieve = grain.sizes.sieve;
  const std::string key = path + ".sizes.sieve";
  check_shares_given(path, places);
  if (sieve.x.empty())
    places.fail(key, "missing; law = \"sieve\" needs { unit = \"mm\", opening = [...], passing = [...] }");
  if (sieve.x.size() < 2) places.fail(key, "needs at least two openings");
  if (!(sieve.x.front() > 0)) places.fail(key, "its first opening must be above 0");
  if (sieve.y.front() != 0)
    places.fail(key, fmt::format("passing begins at {:g}; begin with the opening that nothing passes (0)",
                                 sieve.y.front()));
  if (sieve.y.back() != 1)
    places.fail(
        key, fmt::format("passing ends at {:g}; end with the opening that all passes (1)", sieve.y.back()));
  for (std::size_t i = 1; i < sieve.y.size(); ++i)
    if (sieve.y[i] < sieve.y[i - 1])
      places.fail(key, fmt::format("passing falls from {:g} to {:g} at {}; a wider opening cannot pass less",
                                   sieve.y[i - 1], sieve.y[i], in_mm(sieve.x[i])));
  const auto take = [&](double& limit, double end, const char* name) {
    if (limit != 0 && std::abs(limit - end) > 1e-9 * end)
      places.fail(
          path + "." + name,
          fmt::format("the sieve curve says {}; leave this out (0 where a file gives it)", in_mm(end)));
    limit = end;
  };
  take(grain.diameter_min, sieve.x.front(), "diameter_min");
  take(grain.diameter_max, sieve.x.back(), "diameter_max");
}

/// The list of a clump of ClumpShape::spheres: one piece, and no sphere that is not seen.
void check_clump(const Clump& clump, const std::string& path, const Places& places) {
  const std::vector<ClumpSphere>& spheres = clump.spheres;
  const std::string key = path + ".spheres";
  if (clump.shape != ClumpShape::spheres) {
    if (!spheres.empty()) places.fail(key, "is for shape = \"spheres\"; leave it out, or choose that");
    return;
  }
  if (clump.overlap != Clump{}.overlap)
    places.fail(path + ".overlap", "is for pair, triangle and tetrahedron; listed spheres lie as they are");
  if (spheres.empty())
    places.fail(
        key, "missing; shape = \"spheres\" needs a list like [{ x = 0, radius = 1 }, { x = 1, radius = 1 }]");
  if (spheres.size() > largest_clump)
    places.fail(key, fmt::format("holds {} spheres; a clump has at most {}", spheres.size(), largest_clump));
  const auto distance = [&](std::size_t a, std::size_t b) {
    const ClumpSphere &s = spheres[a], &t = spheres[b];
    return std::hypot(s.x - t.x, s.y - t.y, s.z - t.z);
  };
  std::vector<bool> reached(spheres.size(), false);
  std::vector<std::size_t> next{0};
  reached[0] = true;
  for (std::size_t k = 0; k < next.size(); ++k)
    for (std::size_t b = 0; b < spheres.size(); ++b) {
      const std::size_t a = next[k];
      if (a == b) continue;
      if (distance(a, b) + spheres[b].radius <= spheres[a].radius)
        places.fail(fmt::format("{}.{}", key, b),
                    fmt::format("lies within sphere {} of the list; leave it out", a));
      constexpr double touching = 1 + 1e-9;
      if (reached[b] || distance(a, b) > touching * (spheres[a].radius + spheres[b].radius)) continue;
      reached[b] = true;
      next.push_back(b);
    }
  if (next.size() == spheres.size()) return;
  const auto apart = std::find(reached.begin(), reached.end(), false) - reached.begin();
  places.fail(fmt::format("{}.{}", key, apart),
              "touches none of those that hang together with the first; a clump is one piece");
}

void check_names(const Scene& scene, const Places& places) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  for (const auto& [name, factor] : scene.infill.dem.material_coarse_graining) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    const auto nearest = nearest_name(name, names);
    places.fail("infill.dem.material_coarse_graining." + name,
                nearest
                    ? fmt::format("no layer holds this material; did you mean \"{}\"?", *nearest)
                    : fmt::format("no layer holds this material; the scene has {}", fmt::join(names, ", ")));
  }
}

void check_pairs(const Scene& scene, const Places& places) {
  const std::vector<GrainPair>& pairs = scene.infill.dem.pairs;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const GrainPair& pair = pairs[i];
    const std::string path = fmt::format("infill.dem.pairs.{}", i);
    const auto [a, b] = pair.materials;
    if (a == b)
      places.fail(path + ".materials",
                  "is a material and itself; what grains of one kind have is in its own [grain]");
    for (const Index m : pair.materials) {
      const Material& material = scene.materials[static_cast<std::size_t>(m)];
      if (!material.grain)
        places.fail(path + ".materials",
                    fmt::format("\"{}\" has no [grain]; name the kinds of grains in it", material.name));
    }
    if (!pair.friction && !pair.restitution && !pair.rolling_friction && !pair.cohesion_energy_density)
      places.fail(path,
                  "gives nothing; give friction, restitution, rolling_friction or cohesion_energy_density");
    for (std::size_t j = 0; j < i; ++j)
      if (std::minmax(a, b) == std::minmax(pairs[j].materials[0], pairs[j].materials[1]))
        places.fail(path + ".materials", fmt::format("is given in infill.dem.pairs.{} already", j));
  }
}

void complete_contact(DemOptions& dem, const CleggRig& rig, const Places& places) {
  const DemOptions defaults;
  const auto only_plastic = [&](const char* key, double given, double otherwise) {
    if (dem.contact != GrainContact::hooke_hysteresis && given != otherwise)
      places.fail(fmt::format("infill.dem.{}", key),
                  "is for contact = \"hooke_hysteresis\"; leave it out, or choose that");
  };
  only_plastic("unloading_ratio", dem.unloading_ratio, defaults.unloading_ratio);
  only_plastic("plastic_depth", dem.plastic_depth, defaults.plastic_depth);
  only_plastic("adhesion_ratio", dem.adhesion_ratio, defaults.adhesion_ratio);
  if (dem.contact != GrainContact::hertz) {
    if (dem.characteristic_velocity == 0) dem.characteristic_velocity = rig.speed;
  } else if (dem.characteristic_velocity != 0) {
    places.fail("infill.dem.characteristic_velocity",
                "is for contact = \"hooke\" or \"hooke_hysteresis\"; leave it out, or choose one of them");
  }
}

/// A host that listens on another machine: where.
void check_host(const DemOptions& dem, const Places& places) {
  constexpr std::string_view scheme = "tcp://";
  if (!dem.host.starts_with(scheme)) return;
  const std::size_t colon = dem.host.rfind(':');
  unsigned port = 0;
  const char *const first = dem.host.data() + colon + 1, *const end = dem.host.data() + dem.host.size();
  const auto [last, failure] = std::from_chars(first, end, port);
  constexpr unsigned largest_port = 65535;
  if (colon <= scheme.size() || failure != std::errc{} || last != end || port < 1 || port > largest_port)
    places.fail(
        "infill.dem.host",
        "is no address; give it as \"tcp://machine:port\", with the port that liggghts_host listens on");
}

/// What clumps cannot be combined with.
void check_clumps_run(const Scene& scene, const Places& places) {
  if (scene.infill.dem.ranks > 1 && effect_on(decide_effects(scene), "clumps"))
    places.fail("infill.dem.ranks",
                "clumps of grains need one process; use 1 rank, or effects.clumps = false");
}

}  // namespace

void complete_grain(GrainMaterial& grain, const std::string& path, const Places& places) {
  const GrainSizes& sizes = grain.sizes;
  if (grain.clump) check_clump(*grain.clump, path + ".clump", places);
  if (sizes.law != SizeLaw::lognormal) {
    refuse(sizes.median != 0, path + ".sizes.median", "lognormal", places);
    refuse(sizes.geometric_deviation != 0, path + ".sizes.geometric_deviation", "lognormal", places);
  }
  if (sizes.law != SizeLaw::sieve) refuse(!sizes.sieve.x.empty(), path + ".sizes.sieve", "sieve", places);
  switch (sizes.law) {
    case SizeLaw::uniform:
      return check_limits(grain, path, places);
    case SizeLaw::lognormal:
      return check_lognormal(grain, path, places);
    case SizeLaw::sieve:
      return complete_sieve(grain, path, places);
  }
}

void complete_dem(Scene& scene, const Places& places) {
  check_names(scene, places);
  check_pairs(scene, places);
  complete_contact(scene.infill.dem, scene.rig.clegg, places);
  check_host(scene.infill.dem, places);
  check_clumps_run(scene, places);
}

}  // namespace tuft
