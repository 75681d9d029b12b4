#include "core/prefetch.h"

#include <gtest/gtest.h>

#include <set>

namespace tuft {
namespace {

template <std::size_t alignment>
void expect_all_lines_asked_for() {
  for (std::uintptr_t first = 4096; first < 4096 + 2 * cache_line; first += alignment)
    for (std::size_t bytes = 0; bytes <= 5 * cache_line; ++bytes) {
      std::set<std::uintptr_t> asked, wanted;
      for_cache_lines<alignment>(first, bytes, [&](std::uintptr_t at) { asked.insert(at / cache_line); });
      for (std::uintptr_t at = first; at < first + bytes; ++at) wanted.insert(at / cache_line);
      EXPECT_EQ(asked, wanted) << bytes << " bytes from " << first;
    }
}

TEST(Prefetch, AsksForEveryLineThatHoldsSomeOfItAndForNoOther) {
  expect_all_lines_asked_for<1>();
  expect_all_lines_asked_for<8>();
  expect_all_lines_asked_for<32>();
  expect_all_lines_asked_for<64>();
  expect_all_lines_asked_for<128>();
}

TEST(Prefetch, AsksForWhatIsAlignedOnce) {
  int asked = 0;
  for_cache_lines<64>(4096, 512, [&](std::uintptr_t) { ++asked; });
  EXPECT_EQ(asked, 8);
}

/// Addresses are numbers: what begins nowhere is reckoned like all else, and a range of nothing asks for
/// nothing.
TEST(Prefetch, ReckonsRangesThatDoNotExist) {
  std::set<std::uintptr_t> lines;
  for_cache_lines<8>(0, 800, [&](std::uintptr_t at) { lines.insert(at / cache_line); });
  EXPECT_EQ(lines.size(), 13U);
  for_cache_lines<8>(0, 0, [&](std::uintptr_t) { ADD_FAILURE() << "of nothing"; });
  prefetch(static_cast<const double*>(nullptr), 100);  // a sanitiser would object
}

}  // namespace
}  // namespace tuft
