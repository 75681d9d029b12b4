/// Grains for a turf: how many of which size in each layer, and where.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "core/error.h"
#include "dem_bridge/dem_infill.h"
#include "dem_bridge/grain_sizes.h"
#include "dem_bridge/packing_clumps.h"
#include "dem_bridge/packing_consolidation.h"
#include "dem_bridge/packing_relaxation.h"

namespace tuft::dem {
namespace {

constexpr int sweeps = 400;  ///< that part clumps
/// Above this a slab is made higher, so that spheres find room among strands; then all fall together.
constexpr double densest_fraction = 0.48;

double sphere_mass(double diameter, double density) {
  return std::numbers::pi / 6 * diameter * diameter * diameter * density;
}

/// Uniform in [0, 1), the same on every platform (the standard's distributions are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * (*this)(); }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>((*this)() * static_cast<double>(count));
  }

 private:
  std::mt19937_64 engine_;
};

struct Grain {
  double radius;
  Index material;
};

GrainSizeDistribution sizes_of(const Material& material, const DemOptions& options) {
  const double factor = coarse_graining_of(options, material.name);
  if (!(factor >= 1))
    throw_input_error("packing: grain material {} has coarse graining {}; it must be 1 or more",
                      material.name, factor);
  return {*material.grain, factor};
}

/// Diameters uniform in number between the two, until the mass is reached. The last grain is as large as what
/// is missing; a remainder under half of the smallest grain is left out: so the error is under half a grain.
void draw_grains(double mass, const GrainSizeDistribution& sizes, double density, Index material,
                 Random& random, std::vector<Grain>& grains) {
  double missing = mass;
  while (missing >= 0.5 * sphere_mass(sizes.smallest(), density)) {
    double diameter = random.between(sizes.smallest(), sizes.largest());
    if (sphere_mass(diameter, density) > missing)
      diameter = std::max(sizes.smallest(), std::cbrt(6 * missing / (std::numbers::pi * density)));
    grains.push_back({0.5 * diameter, material});
    missing -= sphere_mass(diameter, density);
  }
}

/// Of the rectangle around it, what the container covers.
double covered_share(const PackingRequest& request) {
  return request.round ? std::numbers::pi / 4 : 1.0;
}

void check_request(const PackingRequest& request) {
  if (request.turf == nullptr || request.materials == nullptr || request.options == nullptr)
    throw_input_error("packing: turf, materials and options must be given");
  if (!(request.size[0] > 0) || !(request.size[1] > 0))
    throw_input_error("packing: the patch is {} x {} m; both must be positive", request.size[0],
                      request.size[1]);
  if (request.round && request.size[0] != request.size[1])
    throw_input_error("packing: a round container cannot be {} x {} m; its two sizes are its diameter",
                      request.size[0], request.size[1]);
}

/// All grains of one layer in random order.
std::vector<Grain> draw_layer(const PackingRequest& request, const Layer& layer, Random& random) {
  const std::vector<Material>& materials = *request.materials;
  const Material& of_layer = materials[layer.material];
  if (of_layer.grain_shares.empty() || !(of_layer.bulk_density > 0))
    throw_input_error(
        "packing: material {} has no grains or no bulk density; give it grain_shares and bulk_density, or "
        "use infill.approach = \"sph\"",
        of_layer.name);
  const double mass =
      of_layer.bulk_density * request.size[0] * request.size[1] * layer.depth * covered_share(request);
  std::vector<Grain> grains;
  for (const GrainShare& share : of_layer.grain_shares) {
    const Material& material = materials[share.material];
    if (!material.grain)
      throw_input_error("packing: material {} of {} has no [grain] block", material.name, of_layer.name);
    const GrainSizeDistribution sizes = sizes_of(material, *request.options);
    if (sizes.largest() > std::min(request.size[0], request.size[1]))
      throw_input_error(
          "packing: grains of {} are up to {} m wide, the patch is {} x {} m; take a larger patch or less "
          "coarse graining",
          material.name, sizes.largest(), request.size[0], request.size[1]);
    const double mass_of_kind = share.mass_fraction * mass, density = material.grain->density;
    if (is_drawn_at_random(material.grain->sizes))
      draw_grains(mass_of_kind, sizes, density, share.material, random, grains);
    else
      for (const double diameter : quota_diameters(sizes, mass_of_kind, density))
        grains.push_back({0.5 * diameter, share.material});
  }
  if (grains.empty())
    throw_input_error(
        "packing: a layer of {} that is {:g} mm deep weighs {:.3g} mg, less than half of its smallest grain: "
        "it "
        "would hold none; make it deeper, the patch larger, or take less coarse graining",
        of_layer.name, 1e3 * layer.depth, 1e6 * mass);
  for (std::size_t i = grains.size(); i > 1; --i) std::swap(grains[i - 1], grains[random.below(i)]);
  return grains;
}

/// Height of a layer's slab: its depth, or more when its grains would be packed too densely in it.
double slab_height(const std::vector<Grain>& grains, const Layer& layer, const PackingRequest& request) {
  double volume = 0;
  for (const Grain& grain : grains) volume += sphere_mass(2 * grain.radius, 1.0);
  return std::max(layer.depth,
                  volume / (densest_fraction * request.size[0] * request.size[1] * covered_share(request)));
}

/// From even over the rectangle [-half, half] to even over the disc in it: shares of area kept in x, of the
/// circumference in y.
Vec3 in_disc(const Vec3& x, const std::array<double, 2>& half) {
  if (!(half[0] > 0)) return {0, 0, x.z()};
  const double radius = half[0] * std::sqrt(std::max(0.0, 0.5 + 0.5 * x.x() / half[0])),
               angle = std::numbers::pi * (1 + x.y() / half[1]);
  return {radius * std::cos(angle), radius * std::sin(angle), x.z()};
}

/// Bits of a number with two zeros between each: three of them interleaved are a place on the Morton curve.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

bool of_one_clump(const Grains& grains, std::size_t a, std::size_t b) {
  return !grains.body.empty() && grains.body[a] >= 0 && grains.body[a] == grains.body[b];
}

/// Grains that are neighbours in space become neighbours in memory: every loop that gathers over contacts,
/// here, in the host and in the coupler, then finds them in its caches.
Grains sorted_along_curve(const Grains& grains, const PackingBox& box) {
  const double cell = 1e-3;  // m: only an order, no result depends on it
  std::vector<std::uint64_t> key(grains.size());
  for (std::size_t i = 0; i < grains.size(); ++i) {
    if (i > 0 && of_one_clump(grains, i - 1, i)) {  // go together, where the first of them is
      key[i] = key[i - 1];
      continue;
    }
    const Vec3 x = grains.position[i] - Vec3(-box.half_size[0], -box.half_size[1], box.floor);
    key[i] = spread_bits(static_cast<std::uint64_t>(x.x() / cell)) |
             spread_bits(static_cast<std::uint64_t>(x.y() / cell)) << 1 |
             spread_bits(static_cast<std::uint64_t>(x.z() / cell)) << 2;
  }
  std::vector<std::size_t> order(grains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  Grains sorted;
  sorted.moved = grains.moved;
  for (std::size_t i : order) {
    sorted.position.push_back(grains.position[i]);
    sorted.radius.push_back(grains.radius[i]);
    sorted.density.push_back(grains.density[i]);
    sorted.layer.push_back(grains.layer[i]);
    sorted.material.push_back(grains.material[i]);
    if (!grains.body.empty()) sorted.body.push_back(grains.body[i]);
  }
  return sorted;
}

}  // namespace

double coarse_graining_of(const DemOptions& options, const std::string& material) {
  const auto own = options.material_coarse_graining.find(material);
  return own == options.material_coarse_graining.end() ? options.coarse_graining : own->second;
}

Grains pack_grains(const PackingRequest& request) {
  check_request(request);
  Random random(request.seed);
  Grains packed;
  LooseSpheres spheres;
  double low = request.floor;
  for (std::size_t l = 0; l < request.turf->layers.size(); ++l) {
    const Layer& layer = request.turf->layers[l];
    const std::vector<Grain> grains = draw_layer(request, layer, random);
    const double high = low + slab_height(grains, layer, request);
    for (const Grain& grain : grains) {
      const double x = 0.5 * request.size[0] - grain.radius, y = 0.5 * request.size[1] - grain.radius;
      const double bottom = low + grain.radius, top = std::max(bottom, high - grain.radius);
      // One after the other: the order in which a call's arguments are evaluated is not fixed.
      const double px = random.between(-x, x), py = random.between(-y, y), pz = random.between(bottom, top);
      spheres.position.push_back(request.round ? in_disc({px, py, pz}, {x, y}) : Vec3(px, py, pz));
      spheres.radius.push_back(grain.radius);
      spheres.low.push_back(low);
      spheres.high.push_back(high);
      packed.density.push_back((*request.materials)[grain.material].grain->density);
      packed.layer.push_back(static_cast<Index>(l));
      packed.material.push_back(grain.material);
    }
    low = high;
  }
  const PackingBox box{{0.5 * request.size[0], 0.5 * request.size[1]}, request.floor, low, request.round};
  packed.moved = consolidate(spheres, box, request.obstacles, [&random] { return random(); });
  packed.position = std::move(spheres.position);
  packed.radius = std::move(spheres.radius);
  if (request.clumps)
    packed = make_clumps(packed, *request.materials, box, request.obstacles, sweeps,
                         [&random] { return random(); });
  return sorted_along_curve(packed, box);
}

}  // namespace tuft::dem
