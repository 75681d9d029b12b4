#pragma once
/// Rows of tests in checkpoints. A Row has `count` values(), and of() makes it from them.
#include <fmt/format.h>

#include <span>
#include <vector>

#include "core/hdf5_file.h"

namespace tuft::rigs {

template <class Row>
void save_rows(h5::Group& group, const std::vector<std::vector<Row>>& tests) {
  for (std::size_t test = 0; test < tests.size(); ++test) {
    std::vector<double> flat;
    flat.reserve(Row::count * tests[test].size());
    for (const Row& row : tests[test]) {
      const auto values = row.values();
      flat.insert(flat.end(), values.begin(), values.end());
    }
    if (!flat.empty()) group.write(fmt::format("rows_{}", test), std::span<const double>(flat));
  }
}

template <class Row>
void load_rows(const h5::Group& group, std::vector<std::vector<Row>>& tests) {
  for (std::size_t test = 0; test < tests.size(); ++test) {
    tests[test].clear();
    const std::string name = fmt::format("rows_{}", test);
    if (!group.has(name)) continue;
    const std::vector<double> flat = group.read_doubles(name);
    for (std::size_t i = 0; i + Row::count <= flat.size(); i += Row::count)
      tests[test].push_back(Row::of(std::span(flat).subspan(i, Row::count)));
  }
}

}  // namespace tuft::rigs
