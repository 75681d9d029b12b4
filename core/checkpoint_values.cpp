#include "core/checkpoint_values.h"

#include <cmath>

#include "core/error.h"
#include "core/hdf5_handles.h"

namespace tuft::h5 {
namespace {

constexpr std::string_view advice =
    "the checkpoint is truncated or damaged, or belongs to another scene: start the scene again with tuft "
    "run";

template <class Read>
auto read_or_refuse(Read&& read) {
  try {
    return read();
  } catch (const RunError& error) {  // names file and dataset
    throw_input_error("{}: {}", error.what(), advice);
  }
}

std::string words(Bounds bounds, std::string_view kind) {
  if (bounds.least <= finite.least && bounds.most >= finite.most)
    return std::string(bounds.most > finite.most ? "a number" : "finite");
  if (bounds.most >= finite.most) return fmt::format("{} of at least {:.6g}", kind, bounds.least);
  return fmt::format("{} from {:.6g} to {:.6g}", kind, bounds.least, bounds.most);
}

}  // namespace

void refuse(const Group& group, std::string_view name, std::string_view what) {
  const Group::Handle& handle = GroupAccess::handle(group);
  throw_input_error("{}: {} {}: {}", handle.file->path().string(), handle.object(name), what, advice);
}

void check_value(const Group& group, std::string_view name, std::size_t entry, double value, Bounds bounds) {
  if (value >= bounds.least && value <= bounds.most) return;
  refuse(group, name, fmt::format("[{}] is {:.6g}; it must be {}", entry, value, words(bounds, "a number")));
}

void check_whole(const Group& group, std::string_view name, std::size_t entry, double value, Bounds bounds) {
  if (value >= bounds.least && value <= bounds.most && value == std::floor(value)) return;
  refuse(group, name,
         fmt::format("[{}] is {:.6g}; it must be {}", entry, value, words(bounds, "a whole number")));
}

void check_length(const Group& group, std::string_view name, std::size_t length, std::size_t needed) {
  if (length != needed) refuse(group, name, fmt::format("holds {} values instead of {}", length, needed));
}

std::vector<double> read_all_checked(const Group& group, std::string_view name, Bounds bounds) {
  std::vector<double> values = read_or_refuse([&] { return group.read_doubles(name); });
  for (std::size_t k = 0; k < values.size(); ++k) check_value(group, name, k, values[k], bounds);
  return values;
}

std::vector<double> read_checked(const Group& group, std::string_view name, std::size_t count,
                                 Bounds bounds) {
  std::vector<double> values = read_all_checked(group, name, bounds);
  check_length(group, name, values.size(), count);
  return values;
}

double read_number(const Group& group, std::string_view name, Bounds bounds) {
  return read_checked(group, name, 1, bounds).front();
}

Vec3Array read_vectors(const Group& group, const std::string& name, std::size_t count) {
  return {read_checked(group, name + "_x", count), read_checked(group, name + "_y", count),
          read_checked(group, name + "_z", count)};
}

std::vector<double> read_all_whole(const Group& group, std::string_view name, Bounds bounds) {
  std::vector<double> values = read_or_refuse([&] { return group.read_doubles(name); });
  for (std::size_t k = 0; k < values.size(); ++k) check_whole(group, name, k, values[k], bounds);
  return values;
}

std::vector<double> read_whole(const Group& group, std::string_view name, std::size_t count, Bounds bounds) {
  std::vector<double> values = read_all_whole(group, name, bounds);
  check_length(group, name, values.size(), count);
  return values;
}

std::uint64_t read_count(const Group& group, std::string_view name, double most) {
  return static_cast<std::uint64_t>(read_whole(group, name, 1, {0, most}).front());
}

bool read_flag(const Group& group, std::string_view name) {
  return read_count(group, name, 1) != 0;
}

std::vector<std::uint64_t> read_keys(const Group& group, std::string_view name) {
  // Stored as anything else they would have been rounded, or made of what is no number.
  return read_or_refuse([&] {
    static_cast<void>(read_all_whole(group, name, {0, 18446744073709551615.0}));
    return group.read_counts(name);
  });
}

}  // namespace tuft::h5
