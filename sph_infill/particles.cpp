#include "sph_infill/particles.h"

#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

/// Whole numbers of units modulo 2^32, as bits: the sum has no binary digits behind the point, and the whole
/// number in its last 32.
NarrowPack units_of(const Pack& x, double per_unit) {
  return low_halves(x * per_unit + 0x1.8p52);
}

}  // namespace

void Particles::record_motion(std::size_t begin, std::size_t end) {
  const double per_position = 1 / position_unit(), per_volume = 1 / volume_unit();
  constexpr std::size_t row_length = sizeof(MotionRecord) / sizeof(float);
  for (std::size_t i = begin; i < end; i += lanes) {
    const std::size_t count = std::min(lanes, end - i);
    const auto of = [&](const std::vector<double>& values) { return load_lanes(values, i, count); };
    const auto units = [&](const std::vector<double>& values) { return units_of(of(values), per_position); };
    auto* first = reinterpret_cast<float*>(&motion[i]);
    store_four_columns(
        {units(position.x), units(position.y), units(position.z), narrowed(of(volume) * per_volume)}, count,
        first, row_length);
    store_four_columns({narrowed(of(velocity.x)), narrowed(of(velocity.y)), narrowed(of(velocity.z)),
                        narrowed(1.0 / of(mass))},
                       count, first + 4, row_length);
  }
}

}  // namespace tuft::sph
