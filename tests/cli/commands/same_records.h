#pragma once
/// Two runs that recorded the same, to the bit.
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "core/error.h"
#include "core/hdf5_file.h"

namespace tuft::test {

/// Of everything below two groups.
inline void expect_same_datasets(const h5::Group& a, const h5::Group& b, const std::string& path) {
  EXPECT_EQ(a.names(), b.names()) << path;
  for (const std::string& name : a.names()) {
    if (!b.has(name) || path + name == "/cost") continue;  // seconds
    std::optional<h5::Group> below;
    try {
      below = a.open_group(name);
    } catch (const RunError&) {  // a dataset
    }
    if (below) {
      expect_same_datasets(*below, b.open_group(name), path + name + "/");
      continue;
    }
    EXPECT_EQ(a.shape(name), b.shape(name)) << path << name;
    std::optional<std::vector<double>> numbers;
    try {
      numbers = a.read_doubles(name);
    } catch (const RunError&) {  // a text
    }
    if (numbers)
      EXPECT_TRUE(*numbers == b.read_doubles(name)) << path << name << " differs";
    else
      EXPECT_EQ(a.read_string(name), b.read_string(name)) << path << name;
  }
}

/// Of run.h5 of two folders, all but how long it took.
inline void expect_same_records(const std::string& folder, const std::string& other) {
  const h5::Group a = h5::File::open(folder + "/run.h5").root(), b = h5::File::open(other + "/run.h5").root();
  ASSERT_GT(a.open_group("history").read_doubles("time").size(), 2u);
  ASSERT_GT(a.open_group("frames").read_doubles("time").size(), 1u);
  expect_same_datasets(a, b, "/");
}

}  // namespace tuft::test
