#include <algorithm>
#include <cstring>
#include <utility>

#include "dem_bridge/dem_infill_impl.h"

namespace tuft::dem {
namespace {

std::vector<OverlapRecord> read_records(const std::string& bytes) {
  if (bytes.size() % sizeof(OverlapRecord) != 0)
    throw_run_error("DEM infill: {} bytes of overlaps from liggghts_host, no multiple of {}", bytes.size(),
                    sizeof(OverlapRecord));
  std::vector<OverlapRecord> records(bytes.size() / sizeof(OverlapRecord));
  if (!records.empty()) std::memcpy(records.data(), bytes.data(), bytes.size());
  return records;
}

/// Sorts the overlaps: the sum does not depend on the order in which the host met the contacts.
DemInfill::OverlapStatistics statistics_of(std::vector<double>& overlaps) {
  DemInfill::OverlapStatistics result;
  result.contacts = overlaps.size();
  if (overlaps.empty()) return result;
  std::sort(overlaps.begin(), overlaps.end());
  for (const double overlap : overlaps) result.mean += overlap;
  result.mean /= static_cast<double>(overlaps.size());
  result.percentile_99 = overlaps[(overlaps.size() - 1) * 99 / 100];
  result.largest = overlaps.back();
  return result;
}

}  // namespace

DemInfill::OverlapStatistics DemInfill::overlaps() const {
  std::vector<double> overlaps;
  for (const OverlapRecord& record : read_records(impl_->ask(Request::contacts)))
    overlaps.push_back(record.overlap);
  return statistics_of(overlaps);
}

/// What the host has seen since it was last looked at, and the limit that the scene sets.
void DemInfill::Impl::take_overlaps() {
  for (std::size_t r = 0; r < memory().ranks(); ++r)
    for (std::size_t pair = 0; pair < overlap_largest.size(); ++pair) {
      double& largest = memory().rank(r).overlap_largest[pair];
      overlap_largest[pair] = std::max(overlap_largest[pair], std::exchange(largest, 0));
    }
}

std::vector<Infill::Field> DemInfill::fields() const {
  Impl& my = *impl_;
  my.ask(Request::contacts);
  const auto coordination = my.array(SharedArrays::coordination);
  return {{"coordination", "1", std::vector<double>(coordination.begin(), coordination.end())}};
}

}  // namespace tuft::dem
