#pragma once
/// Values of a checkpoint, checked before anything is made of them. What does not fit throws InputError with
/// the file, the dataset, the entry, its value, and what to do: so does a dataset that cannot be read.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/hdf5_file.h"
#include "core/vector.h"

namespace tuft::h5 {

/// What a value may be, bounds included. NaN lies in none.
struct Bounds {
  double least = std::numeric_limits<double>::lowest();
  double most = std::numeric_limits<double>::max();
};
inline constexpr double unbounded = std::numeric_limits<double>::infinity();
inline constexpr Bounds finite{};
inline constexpr Bounds not_negative{0, std::numeric_limits<double>::max()};
inline constexpr Bounds positive{std::numeric_limits<double>::min(), std::numeric_limits<double>::max()};
/// What is kept in single precision.
inline constexpr Bounds single_precision{std::numeric_limits<float>::lowest(),
                                         std::numeric_limits<float>::max()};
/// Whole numbers that a double holds exactly.
inline constexpr double most_counted = 9007199254740992.0;

/// `what` is wrong with a dataset: "holds 3 values instead of 4".
[[noreturn]] void refuse(const Group& group, std::string_view name, std::string_view what);
void check_value(const Group& group, std::string_view name, std::size_t entry, double value, Bounds bounds);
/// A whole number besides.
void check_whole(const Group& group, std::string_view name, std::size_t entry, double value, Bounds bounds);
void check_length(const Group& group, std::string_view name, std::size_t length, std::size_t needed);

/// `count` values.
[[nodiscard]] std::vector<double> read_checked(const Group& group, std::string_view name, std::size_t count,
                                               Bounds bounds = finite);
/// As many as there are.
[[nodiscard]] std::vector<double> read_all_checked(const Group& group, std::string_view name,
                                                   Bounds bounds = finite);
[[nodiscard]] double read_number(const Group& group, std::string_view name, Bounds bounds = finite);
/// From name_x, name_y and name_z.
[[nodiscard]] Vec3Array read_vectors(const Group& group, const std::string& name, std::size_t count);

/// `count` whole numbers, whatever kind of number they are stored as.
[[nodiscard]] std::vector<double> read_whole(const Group& group, std::string_view name, std::size_t count,
                                             Bounds bounds);
[[nodiscard]] std::vector<double> read_all_whole(const Group& group, std::string_view name, Bounds bounds);
[[nodiscard]] std::uint64_t read_count(const Group& group, std::string_view name, double most = most_counted);
[[nodiscard]] bool read_flag(const Group& group, std::string_view name);
/// Where all 64 bits of each are in use.
[[nodiscard]] std::vector<std::uint64_t> read_keys(const Group& group, std::string_view name);

}  // namespace tuft::h5
