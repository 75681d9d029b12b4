#pragma once
/// A pack of doubles as wide as the processor's vectors. The element functions of shell_strain.h are
/// templates over their number type: double for one element (tests, a device), Pack for as many elements at
/// once as there are lanes.
#include <cstddef>
#include <experimental/simd>
#include <new>
#include <vector>

#include "core/vector.h"

namespace tuft {

namespace stdx = std::experimental;

/// ISO/IEC TS 19570:2018 data-parallel type, in the standard library of GCC 11 and later.
using Pack = stdx::native_simd<double>;
inline constexpr std::size_t lanes = Pack::size();

/// Eight single-precision numbers, on every processor: loops over pairs of particles take so many at once.
inline constexpr std::size_t single_lanes = 8;
using SinglePack = stdx::simd<float, stdx::simd_abi::deduce_t<float, single_lanes>>;
static_assert(single_lanes % lanes == 0);
/// Packs that the numbers of a SinglePack fill in double precision.
inline constexpr std::size_t packs_of_single = single_lanes / lanes;

/// Storage whose first value is aligned for whole-pack loads.
template <class T>
struct PackAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{stdx::memory_alignment_v<Pack>};
  PackAllocator() = default;
  template <class U>
  PackAllocator(const PackAllocator<U>& /*other*/) {}
  [[nodiscard]] T* allocate(std::size_t count) {
    return static_cast<T*>(::operator new(count * sizeof(T), alignment));
  }
  void deallocate(T* pointer, std::size_t /*count*/) { ::operator delete(pointer, alignment); }
  bool operator==(const PackAllocator&) const = default;
};
using PackedDoubles = std::vector<double, PackAllocator<double>>;

[[nodiscard]] inline Pack load(const double* aligned) {
  return Pack(aligned, stdx::vector_aligned);
}
inline void store(double* aligned, const Pack& value) {
  value.copy_to(aligned, stdx::vector_aligned);
}

[[nodiscard]] inline Pack gather(const double* values, const Index* index) {
  return Pack([&](auto lane) { return values[index[lane]]; });
}

/// Sum of the lanes, always in the same order.
[[nodiscard]] inline double sum_lanes(const Pack& value) {
  double sum = 0;
  for (std::size_t lane = 0; lane < lanes; ++lane) sum += value[lane];
  return sum;
}

[[nodiscard]] inline double smallest_lane(const Pack& value) {
  double smallest = value[0];
  for (std::size_t lane = 1; lane < lanes; ++lane)
    smallest = value[lane] < smallest ? double(value[lane]) : smallest;
  return smallest;
}

}  // namespace tuft
