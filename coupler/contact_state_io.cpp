#include "coupler/contact_state_io.h"

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

void load_pairs(const h5::Group& group, std::vector<PairKey>& keys, std::vector<ContactHistory>& histories) {
  keys = group.read_counts("keys");
  const std::vector<double> flat = group.read_doubles("histories");
  histories.assign(keys.size(), {});
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const double* h = &flat.at(i * history_numbers);
    histories[i] = {Vec3(h[0], h[1], h[2]), Vec3(h[3], h[4], h[5]), h[6], h[7], h[8], h[9]};
  }
}

void save_energy(h5::Group& group, const ContactEnergy& energy) {
  const std::vector<double> values{energy.elastic, energy.damped, energy.friction, energy.released};
  group.write("energy", std::span<const double>(values));
}

ContactEnergy load_energy(const h5::Group& group) {
  const std::vector<double> v = group.read_doubles("energy");
  return {v.at(0), v.at(1), v.at(2), v.at(3)};
}

}  // namespace tuft::coupler
