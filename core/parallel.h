#pragma once
/// Deterministic threads: the same bits for any number of them. Loops write only their own index; sums go
/// through fixed blocks whose partial sums are added in order.
#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tuft {

inline constexpr std::size_t sum_block = 512;  ///< fixed, so that a sum does not depend on the thread count

inline void set_threads(int count) { omp_set_num_threads(count); }

/// body(i) for i in [0, count). Bodies must not write what another index reads or writes.
template <class Body>
void parallel_for(std::size_t count, Body&& body) {
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < count; ++i) body(i);
}

/// Sum of term(i) over [0, count): bitwise the same for any thread count. T needs a zero `T{}` and +=.
/// Allocates count/512 partial sums: for records and checks, not for every step of an inner loop.
template <class T, class Term>
T deterministic_sum(std::size_t count, Term&& term) {
  const std::size_t blocks = (count + sum_block - 1) / sum_block;
  std::vector<T> partial(blocks);
#pragma omp parallel for schedule(static)
  for (std::size_t b = 0; b < blocks; ++b) {
    T sum{};
    const std::size_t end = std::min(count, (b + 1) * sum_block);
    for (std::size_t i = b * sum_block; i < end; ++i) sum += term(i);
    partial[b] = sum;
  }
  T total{};
  for (const T& sum : partial) total += sum;
  return total;
}

}  // namespace tuft
