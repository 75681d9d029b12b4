#include "studies/median_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tuft::studies {
namespace {

constexpr double missed = 0.05;  ///< share of series in which the median lies outside of the bounds

/// The largest k for which the k-th smallest and the k-th largest of n values are such bounds; 0: none is.
std::size_t rank_of_bound(std::size_t n) {
  const double count = static_cast<double>(n);
  std::size_t rank = 0;
  double tail = 0;  // chance of at most `rank` heads in n throws
  while (true) {
    const double heads = static_cast<double>(rank);
    tail += std::exp(std::lgamma(count + 1) - std::lgamma(heads + 1) - std::lgamma(count - heads + 1) -
                     count * std::numbers::ln2);
    if (2 * tail > missed) return rank;
    ++rank;
  }
}

}  // namespace

MedianEstimate estimate_median(std::vector<double> values) {
  MedianEstimate result;
  if (values.empty()) return result;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  result.median = n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
  const std::size_t rank = rank_of_bound(n);
  result.bounded = rank > 0;
  const std::size_t first = result.bounded ? rank - 1 : 0;
  result.low = values[first];
  result.high = values[n - 1 - first];
  return result;
}

}  // namespace tuft::studies
