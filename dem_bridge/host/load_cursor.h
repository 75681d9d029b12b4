#pragma once
/// Finds what contact gives the grains that are gone through.
#include <algorithm>
#include <cstddef>
#include <span>

#include "dem_bridge/protocol.h"

namespace tuft::dem {

class LoadCursor {
 public:
  explicit LoadCursor(std::span<const LoadRecord> loads) : loads_(loads) {}

  /// Of the grains from `first` to before `end`. Quick when grains come in their order, right in any.
  [[nodiscard]] std::span<const LoadRecord> of(std::size_t first, std::size_t end) {
    if (at_ > 0 && loads_[at_ - 1].grain >= first) at_ = 0;
    constexpr std::size_t near = 8;
    for (std::size_t k = 0; k < near && before(first); ++k) ++at_;
    if (before(first))
      at_ = static_cast<std::size_t>(
          std::lower_bound(loads_.begin() + static_cast<std::ptrdiff_t>(at_), loads_.end(), first,
                           [](const LoadRecord& load, std::size_t grain) { return load.grain < grain; }) -
          loads_.begin());
    const std::size_t begin = at_;
    while (before(end)) ++at_;
    return loads_.subspan(begin, at_ - begin);
  }

 private:
  [[nodiscard]] bool before(std::size_t grain) const {
    return at_ < loads_.size() && loads_[at_].grain < grain;
  }
  std::span<const LoadRecord> loads_;
  std::size_t at_ = 0;
};

}  // namespace tuft::dem
