#pragma once
/// What repeated measurements say of the median, with no assumption on how they scatter.
#include <vector>

namespace tuft::studies {

struct MedianEstimate {
  double median = 0;
  /// The true median lies between them in at least 95 of 100 such series. Between order statistics: of n
  /// independent values each lies below it as often as a coin shows heads.
  double low = 0, high = 0;
  /// Whether there were enough values for that (six); else they are the smallest and the largest.
  bool bounded = false;
};

/// All 0 for no values. Values must be finite.
[[nodiscard]] MedianEstimate estimate_median(std::vector<double> values);

}  // namespace tuft::studies
