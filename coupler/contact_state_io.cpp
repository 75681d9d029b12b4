#include "coupler/contact_state_io.h"

#include <fmt/format.h>

#include "core/checkpoint_values.h"

namespace tuft::coupler {
namespace {
constexpr std::size_t history_numbers = 10;
}

void save_pairs(h5::Group& group, const std::vector<PairKey>& keys,
                const std::vector<ContactHistory>& histories) {
  std::vector<double> flat;
  flat.reserve(histories.size() * history_numbers);
  for (const ContactHistory& h : histories) {
    for (int axis = 0; axis < 3; ++axis) flat.push_back(h.spring[axis]);
    for (int axis = 0; axis < 3; ++axis) flat.push_back(h.tangential[axis]);
    flat.push_back(h.dashpot);
    flat.push_back(h.offset);
    flat.push_back(h.side);
    flat.push_back(h.distance);
  }
  group.write("keys", std::span<const std::uint64_t>(keys));
  group.write("histories", std::span<const double>(flat));
}

void load_pairs(const h5::Group& group, std::size_t points, std::size_t others, std::vector<PairKey>& keys,
                std::vector<ContactHistory>& histories) {
  keys = h5::read_keys(group, "keys");
  for (std::size_t k = 0; k < keys.size(); ++k) {
    const std::uint64_t point = keys[k] >> 32, other = keys[k] & 0xffffffffu;
    if (point >= points || other >= others)
      h5::refuse(group, "keys",
                 fmt::format("[{}] is of point {} of {} with {} of {}", k, point, points, other, others));
    if (k > 0 && !(keys[k - 1] < keys[k]))
      h5::refuse(group, "keys", fmt::format("[{}] is {}, not above the one before", k, keys[k]));
  }
  const std::vector<double> flat = h5::read_checked(group, "histories", keys.size() * history_numbers);
  histories.assign(keys.size(), {});
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const double* h = &flat[i * history_numbers];
    histories[i] = {Vec3(h[0], h[1], h[2]), Vec3(h[3], h[4], h[5]), h[6], h[7], h[8], h[9]};
  }
}

void save_energy(h5::Group& group, const ContactEnergy& energy) {
  const std::vector<double> values{energy.elastic, energy.damped, energy.friction, energy.released};
  group.write("energy", std::span<const double>(values));
}

ContactEnergy load_energy(const h5::Group& group) {
  const std::vector<double> v = h5::read_checked(group, "energy", 4);
  return {v[0], v[1], v[2], v[3]};
}

}  // namespace tuft::coupler
