#pragma once
/// Deterministic threads: the same bits for any number of them. Loops write only their own index; sums go
/// through fixed blocks whose partial sums are added in order.
#include <omp.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace tuft {

inline constexpr std::size_t sum_block = 512;  ///< fixed, so that a sum does not depend on the thread count

inline void set_threads(int count) {
  omp_set_num_threads(count);
}

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

/// Largest value(i) over [0, count), 0 if none is above; NaN counts for nothing. For loops over memory:
/// values of several indices at once, as compilers do not by themselves, for they keep the order of maxima
/// that NaN would tell apart.
template <class Value>
double largest_of(std::size_t count, Value&& value) {
  constexpr std::size_t width = 16, share = 4096;
  double largest = 0;
#pragma omp parallel for schedule(static) reduction(max : largest) if (count > share)
  for (std::size_t part = 0; part < (count + share - 1) / share; ++part) {
    const std::size_t end = std::min(count, (part + 1) * share);
    std::size_t i = part * share;
    std::array<double, width> found{};
    for (; i + width <= end; i += width)
      for (std::size_t l = 0; l < width; ++l) {
        const double v = value(i + l);
        found[l] = found[l] < v ? v : found[l];
      }
    for (; i < end; ++i) found[0] = std::max(found[0], value(i));
    for (const double v : found) largest = std::max(largest, v);
  }
  return largest;
}

}  // namespace tuft
