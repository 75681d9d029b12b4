#include "dem_bridge/dem_contacts.h"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "dem_bridge/protocol.h"

namespace tuft::dem {

ContactNetwork read_contacts(const std::string& bytes, const ParticleView& grains) {
  if (bytes.size() % sizeof(ContactRecord) != 0)
    throw_run_error("DEM infill: {} bytes of contacts from liggghts_host, no multiple of {}", bytes.size(),
                    sizeof(ContactRecord));
  std::vector<ContactRecord> records(bytes.size() / sizeof(ContactRecord));
  if (!records.empty()) std::memcpy(records.data(), bytes.data(), bytes.size());
  // Each rank has sorted its own.
  std::sort(records.begin(), records.end(), [](const ContactRecord& a, const ContactRecord& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  const auto twice = std::ranges::unique(records, [](const ContactRecord& a, const ContactRecord& b) {
    return a.first == b.first && a.second == b.second;  // told by both ranks
  });
  records.erase(twice.begin(), twice.end());
  ContactNetwork network;
  const auto count = static_cast<Index>(grains.size());
  for (const ContactRecord& record : records) {
    if (record.first < 0 || record.first >= record.second || record.second >= count)
      throw_run_error("DEM infill: liggghts_host sent a contact of grains {} and {}; there are {}",
                      record.first, record.second, count);
    const auto i = static_cast<std::size_t>(record.first), j = static_cast<std::size_t>(record.second);
    const Vec3 branch = grains.position(j) - grains.position(i), force(record.force.data());
    const double distance = branch.norm();
    network.add(ContactKind::grain, record.first, record.second, branch, -branch / distance, force,
                grains.radius[i] + grains.radius[j] - distance);
  }
  return network;
}

}  // namespace tuft::dem
