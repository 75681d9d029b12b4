#include <algorithm>
#include <cstring>
#include <numeric>
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

std::vector<DemInfill::PairOverlaps> DemInfill::largest_overlaps() const {
  const Impl& my = *impl_;
  std::vector<PairOverlaps> pairs;
  for (std::size_t b = 0; b < my.used.size(); ++b)
    for (std::size_t a = 0; a <= b; ++a) {  // in the order of pair_place
      pairs.push_back({my.used[a], my.used[b], {}, my.overlap_largest[pair_place(a, b)]});
    }
  return pairs;
}

std::vector<DemInfill::PairOverlaps> DemInfill::overlaps_by_pair() const {
  std::vector<PairOverlaps> pairs = largest_overlaps();
  std::vector<std::vector<double>> overlaps(pairs.size());
  for (const OverlapRecord& record : read_records(impl_->ask(Request::contacts)))
    overlaps.at(pair_place(static_cast<std::size_t>(record.first), static_cast<std::size_t>(record.second)))
        .push_back(record.overlap);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    pairs[p].now = statistics_of(overlaps[p]);
    pairs[p].largest_of_run = std::max(pairs[p].largest_of_run, pairs[p].now.largest);
  }
  return pairs;
}

void DemInfill::count_overlaps_from_now(double limit) {
  Impl& my = *impl_;
  std::fill(my.overlap_largest.begin(), my.overlap_largest.end(), 0.0);
  for (std::size_t r = 0; r < my.memory().ranks(); ++r) my.memory().rank(r).overlap_largest.fill(0.0);
  set_overlap_limit(limit);
}

void DemInfill::set_overlap_limit(double limit) {
  impl_->settings.options.overlap_limit = limit;
}

/// What the host has seen since it was last looked at, and the limit that the scene sets.
void DemInfill::Impl::take_overlaps() {
  for (std::size_t r = 0; r < memory().ranks(); ++r)
    for (std::size_t pair = 0; pair < overlap_largest.size(); ++pair) {
      double& largest = memory().rank(r).overlap_largest[pair];
      overlap_largest[pair] = std::max(overlap_largest[pair], std::exchange(largest, 0));
    }
  const double limit = settings.options.overlap_limit;
  if (!(limit > 0)) return;
  for (std::size_t b = 0; b < used.size(); ++b)
    for (std::size_t a = 0; a <= b; ++a)
      if (const double largest = overlap_largest[pair_place(a, b)]; largest > limit)
        throw_run_error(
            "DEM infill at t = {:.9g} s: grains of {} and {} overlap by {:.3g} of the smaller radius, more "
            "than infill.dem.overlap_limit = {:g}; make the grains stiffer, or raise the limit if that much "
            "is meant",
            time, materials[static_cast<std::size_t>(used[a])].name,
            materials[static_cast<std::size_t>(used[b])].name, largest, limit);
}

std::vector<Infill::Field> DemInfill::fields() const {
  Impl& my = *impl_;
  my.ask(Request::contacts);
  const auto of_spheres = my.array(SharedArrays::coordination);
  std::vector<double> coordination(of_spheres.begin(), of_spheres.end());
  for (const GrainBody& body : my.bodies.bodies) {  // every sphere tells that of its clump
    const auto first = coordination.begin() + static_cast<std::ptrdiff_t>(body.first),
               end = first + static_cast<std::ptrdiff_t>(body.count);
    std::fill(first, end, std::accumulate(first, end, 0.0));
  }
  return {{"coordination", "1", std::move(coordination)}};
}

}  // namespace tuft::dem
