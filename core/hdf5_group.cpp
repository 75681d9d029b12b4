#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "core/hdf5_handles.h"

namespace tuft::h5 {
namespace {

template <class T>
hid_t type_of();
template <>
hid_t type_of<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t type_of<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t type_of<std::uint64_t>() {
  return H5T_NATIVE_UINT64;
}
template <>
hid_t type_of<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

Id open_dataset(const Group::Handle& group, std::string_view name) {
  return Id(require(H5Dopen2(group.id.get(), std::string(name).c_str(), H5P_DEFAULT), *group.file,
                    group.object(name), "cannot open the dataset"));
}

std::vector<std::uint64_t> shape_of(const Group::Handle& group, const Id& dataset, std::string_view name) {
  const Id space(require(H5Dget_space(dataset.get()), *group.file, group.object(name), "has no shape"));
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> size(static_cast<std::size_t>(std::max(rank, 0)));
  require(H5Sget_simple_extent_dims(space.get(), size.data(), nullptr), *group.file, group.object(name),
          "has no shape");
  return {size.begin(), size.end()};
}

template <class T>
void write_values(const Group::Handle& group, std::string_view name, std::span<const T> values,
                  const std::vector<hsize_t>& size, bool scalar) {
  const auto count = std::accumulate(size.begin(), size.end(), std::uint64_t{1}, std::multiplies<>());
  const std::string object = group.object(name);
  if (count != values.size())
    throw_run_error("{}: {}: shape holds {} values, {} given", group.file->path().string(), object, count,
                    values.size());
  const Id space(scalar ? H5Screate(H5S_SCALAR)
                        : H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr));
  const Id dataset(require(H5Dcreate2(group.id.get(), std::string(name).c_str(), type_of<T>(), space.get(),
                                      H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           *group.file, object, "cannot create the dataset"));
  if (count > 0)
    require(H5Dwrite(dataset.get(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), *group.file,
            object, "cannot write");
  group.file->require_healthy(object);
}

template <class T>
void write_array(const Group::Handle& group, std::string_view name, std::span<const T> values,
                 const std::vector<std::uint64_t>& shape) {
  std::vector<hsize_t> size(shape.begin(), shape.end());
  if (size.empty()) size = {values.size()};
  write_values(group, name, values, size, false);
}

void require_numbers(const Group::Handle& group, const Id& dataset, std::string_view name) {
  const Id type(H5Dget_type(dataset.get()));
  const H5T_class_t kind = H5Tget_class(type.get());
  if (kind != H5T_FLOAT && kind != H5T_INTEGER)
    group.file->fail(group.object(name), "is not a dataset of numbers");
}

template <class T>
std::vector<T> read_values(const Group::Handle& group, std::string_view name) {
  const Id dataset = open_dataset(group, name);
  const auto size = shape_of(group, dataset, name);
  require_numbers(group, dataset, name);
  std::vector<T> values(std::accumulate(size.begin(), size.end(), std::uint64_t{1}, std::multiplies<>()));
  if (!values.empty())
    require(H5Dread(dataset.get(), type_of<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), *group.file,
            group.object(name), "cannot read");
  return values;
}

template <class T>
T read_single(const Group::Handle& group, std::string_view name) {
  const auto values = read_values<T>(group, name);
  if (values.size() != 1) group.file->fail(group.object(name), "is not a single value");
  return values.front();
}

/// Fixed-length UTF-8, at least one byte long since HDF5 knows no empty strings.
Id string_type(std::size_t length) {
  Id type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), std::max<std::size_t>(length, 1));
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  return type;
}

/// Length of a fixed-length string type; throws for any other type.
std::size_t string_length(const Group::Handle& group, const Id& type, std::string_view name) {
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0)
    group.file->fail(group.object(name), "is not a string of fixed length");
  return H5Tget_size(type.get());
}

std::string without_padding(std::string text) {
  text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  return text;
}

std::shared_ptr<Group::Handle> make_handle(std::shared_ptr<OpenFile> file, Id id, std::string path) {
  return std::make_shared<Group::Handle>(Group::Handle{std::move(file), std::move(id), std::move(path)});
}

}  // namespace

Group GroupAccess::root(const std::shared_ptr<OpenFile>& file) {
  Id id(require(H5Gopen2(file->id(), "/", H5P_DEFAULT), *file, "/", "cannot open the group"));
  Group group;
  group.handle_ = make_handle(file, std::move(id), "");
  return group;
}

Group Group::create_group(std::string_view name) {
  Id id(
      require(H5Gcreate2(handle_->id.get(), std::string(name).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
              *handle_->file, handle_->object(name), "cannot create the group"));
  Group group;
  group.handle_ = make_handle(handle_->file, std::move(id), handle_->object(name));
  return group;
}

Group Group::open_group(std::string_view name) const {
  Id id(require(H5Gopen2(handle_->id.get(), std::string(name).c_str(), H5P_DEFAULT), *handle_->file,
                handle_->object(name), "cannot open the group"));
  Group group;
  group.handle_ = make_handle(handle_->file, std::move(id), handle_->object(name));
  return group;
}

bool Group::has(std::string_view name) const {
  // The library answers for the last link of a path only, so ask for each in turn.
  const std::string path(name);
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    if (H5Lexists(handle_->id.get(), path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

void Group::write(std::string_view name, std::span<const double> values, std::vector<std::uint64_t> shape) {
  write_array(*handle_, name, values, shape);
}
void Group::write(std::string_view name, std::span<const std::int32_t> values,
                  std::vector<std::uint64_t> shape) {
  write_array(*handle_, name, values, shape);
}
void Group::write(std::string_view name, std::span<const std::uint64_t> values,
                  std::vector<std::uint64_t> shape) {
  write_array(*handle_, name, values, shape);
}
void Group::write(std::string_view name, std::span<const std::uint8_t> values,
                  std::vector<std::uint64_t> shape) {
  write_array(*handle_, name, values, shape);
}
void Group::write_scalar(std::string_view name, double value) {
  write_values<double>(*handle_, name, {&value, 1}, {}, true);
}
void Group::write_scalar(std::string_view name, std::uint64_t value) {
  write_values<std::uint64_t>(*handle_, name, {&value, 1}, {}, true);
}

void Group::write_string(std::string_view name, std::string_view value) {
  const Id type = string_type(value.size());
  const Id space(H5Screate(H5S_SCALAR));
  const std::string object = handle_->object(name), text(value);
  const Id dataset(require(H5Dcreate2(handle_->id.get(), std::string(name).c_str(), type.get(), space.get(),
                                      H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           *handle_->file, object, "cannot create the dataset"));
  require(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()), *handle_->file,
          object, "cannot write");
  handle_->file->require_healthy(object);
}

void Group::set_attribute(std::string_view key, std::string_view value, std::string_view of) {
  const std::string object = handle_->object(of) + "@" + std::string(key), text(value);
  const std::string target = of.empty() ? "." : std::string(of);
  const Id type = string_type(value.size());
  const Id space(H5Screate(H5S_SCALAR));
  const Id attribute(
      require(H5Acreate_by_name(handle_->id.get(), target.c_str(), std::string(key).c_str(), type.get(),
                                space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
              *handle_->file, object, "cannot create the attribute"));
  require(H5Awrite(attribute.get(), type.get(), text.c_str()), *handle_->file, object, "cannot write");
}

std::vector<double> Group::read_doubles(std::string_view name) const {
  return read_values<double>(*handle_, name);
}
std::vector<double> Group::read_row(std::string_view name, std::uint64_t row) const {
  const Id dataset = open_dataset(*handle_, name);
  const auto shape = shape_of(*handle_, dataset, name);
  std::vector<hsize_t> count(shape.begin(), shape.end());
  require_numbers(*handle_, dataset, name);
  const std::string object = handle_->object(name);
  if (count.empty() || row >= count.front())
    handle_->file->fail(object,
                        fmt::format("has no row {}; it has {}", row, count.empty() ? 0 : count.front()));
  count.front() = 1;
  std::vector<hsize_t> start(count.size(), 0);
  start.front() = row;
  std::vector<double> values(
      std::accumulate(count.begin(), count.end(), std::uint64_t{1}, std::multiplies<>()));
  if (values.empty()) return values;
  const Id from(require(H5Dget_space(dataset.get()), *handle_->file, object, "has no shape"));
  require(H5Sselect_hyperslab(from.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          *handle_->file, object, "has another shape");
  const Id into(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  require(H5Dread(dataset.get(), H5T_NATIVE_DOUBLE, into.get(), from.get(), H5P_DEFAULT, values.data()),
          *handle_->file, object, "cannot read");
  return values;
}
std::vector<std::int32_t> Group::read_ints(std::string_view name) const {
  return read_values<std::int32_t>(*handle_, name);
}
std::vector<std::uint64_t> Group::read_counts(std::string_view name) const {
  return read_values<std::uint64_t>(*handle_, name);
}
std::vector<std::uint8_t> Group::read_bytes(std::string_view name) const {
  return read_values<std::uint8_t>(*handle_, name);
}
double Group::read_double(std::string_view name) const {
  return read_single<double>(*handle_, name);
}
std::uint64_t Group::read_count(std::string_view name) const {
  return read_single<std::uint64_t>(*handle_, name);
}

std::string Group::read_string(std::string_view name) const {
  const Id dataset = open_dataset(*handle_, name);
  const Id type(H5Dget_type(dataset.get()));
  std::string text(string_length(*handle_, type, name), '\0');
  require(H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), *handle_->file,
          handle_->object(name), "cannot read");
  return without_padding(std::move(text));
}

std::string Group::attribute(std::string_view key, std::string_view of) const {
  const std::string object = handle_->object(of) + "@" + std::string(key);
  const std::string target = of.empty() ? "." : std::string(of);
  const Id attribute(require(
      H5Aopen_by_name(handle_->id.get(), target.c_str(), std::string(key).c_str(), H5P_DEFAULT, H5P_DEFAULT),
      *handle_->file, object, "cannot open the attribute"));
  const Id type(H5Aget_type(attribute.get()));
  std::string text(string_length(*handle_, type, std::string(of) + "@" + std::string(key)), '\0');
  require(H5Aread(attribute.get(), type.get(), text.data()), *handle_->file, object, "cannot read");
  return without_padding(std::move(text));
}

std::vector<std::uint64_t> Group::shape(std::string_view name) const {
  return shape_of(*handle_, open_dataset(*handle_, name), name);
}

std::vector<std::string> Group::names() const {
  std::vector<std::string> found;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  require(H5Literate(handle_->id.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &found), *handle_->file,
          handle_->path, "cannot list the group");
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace tuft::h5
