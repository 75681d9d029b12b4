#pragma once
/// The known name that a mistyped one was probably meant to be.
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tuft {

/// Edits (insert, delete, replace, swap neighbours) from one word to the other: Damerau's distance in the
/// restricted form, each letter edited once.
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) cost[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) cost[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, replaced});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

/// Closest of `known`, or nothing where even that takes more edits than half of the given name. Ties: the
/// first.
template <class Names>
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view given, const Names& known) {
  std::optional<std::string> best;
  std::size_t fewest = std::max<std::size_t>(1, given.size() / 2) + 1;
  for (const auto& name : known) {
    const std::size_t edits = edit_distance(given, name);
    if (edits < fewest) {
      fewest = edits;
      best = std::string(name);
    }
  }
  return best;
}

}  // namespace tuft
