#include "core/record_layout.h"

#include <unistd.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <system_error>

#include "core/error.h"
#include "core/hdf5_handles.h"

namespace tuft::record {
namespace {

using h5::Id;
using h5::OpenFile;
using h5::require;

constexpr std::uint64_t short_row_chunk =
    32 * 1024;  // bytes; also the most that a scalar history wastes at its end
constexpr std::uint64_t most_rows = 4096;
constexpr std::uint64_t largest_chunk = 1024 * 1024;  // bytes, the library's chunk cache

std::vector<hsize_t> extent_of(const Id& dataset, const OpenFile& file, const std::string& name,
                               bool largest) {
  const Id space(require(H5Dget_space(dataset.get()), file, name, "has no shape"));
  std::vector<hsize_t> now(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space.get()), 0)));
  std::vector<hsize_t> limit(now.size());
  H5Sget_simple_extent_dims(space.get(), now.data(), limit.data());
  return largest ? limit : now;
}

}  // namespace

std::uint64_t row_size(const Channel& channel) {
  return std::accumulate(channel.row_shape.begin(), channel.row_shape.end(), std::uint64_t{1},
                         std::multiplies<>());
}

std::uint64_t value_size(const Channel& channel) {
  return channel.integer ? sizeof(std::int32_t) : channel.single_precision ? sizeof(float) : sizeof(double);
}

std::vector<std::uint64_t> chunk_shape(const Channel& channel) {
  const std::uint64_t row_bytes = std::max<std::uint64_t>(row_size(channel), 1) * value_size(channel);
  std::vector<std::uint64_t> chunk{std::clamp<std::uint64_t>(short_row_chunk / row_bytes, 1, most_rows)};
  for (const std::uint64_t length : channel.row_shape) chunk.push_back(std::max<std::uint64_t>(length, 1));
  if (row_bytes > largest_chunk && chunk.size() > 1) {
    const std::uint64_t pieces = (row_bytes + largest_chunk - 1) / largest_chunk;
    chunk[1] = std::max<std::uint64_t>((chunk[1] + pieces - 1) / pieces, 1);
  }
  return chunk;
}

void create_channel(h5::Group& root, const Channel& channel) {
  const auto& handle = h5::GroupAccess::handle(root);
  const OpenFile& file = *handle.file;
  std::vector<hsize_t> now{0}, limit{H5S_UNLIMITED};
  for (const std::uint64_t length : channel.row_shape) {
    now.push_back(length);
    limit.push_back(length);
  }
  const auto shape = chunk_shape(channel);
  const std::vector<hsize_t> chunk(shape.begin(), shape.end());
  const int rank = static_cast<int>(now.size());
  const Id space(H5Screate_simple(rank, now.data(), limit.data()));
  const Id creation(H5Pcreate(H5P_DATASET_CREATE)), links(H5Pcreate(H5P_LINK_CREATE));
  H5Pset_chunk(creation.get(), rank, chunk.data());
  H5Pset_create_intermediate_group(links.get(), 1);
  const hid_t type = channel.integer            ? H5T_STD_I32LE
                     : channel.single_precision ? H5T_IEEE_F32LE
                                                : H5T_IEEE_F64LE;
  const Id dataset(require(H5Dcreate2(handle.id.get(), channel.path.c_str(), type, space.get(), links.get(),
                                      creation.get(), H5P_DEFAULT),
                           file, channel.path, "cannot create the dataset"));
  root.set_attribute("unit", channel.unit, channel.path);
}

std::vector<std::pair<Channel, std::uint64_t>> list_channels(const std::filesystem::path& path) {
  const auto file = std::make_shared<OpenFile>(path, OpenFile::Mode::read);
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->push_back(fmt::format("/{}", name));
    return 0;
  };
  require(H5Lvisit(file->id(), H5_INDEX_NAME, H5_ITER_INC, add, &names), *file, "/", "cannot list");
  const h5::Group root = h5::GroupAccess::root(file);
  std::vector<std::pair<Channel, std::uint64_t>> channels;
  for (const std::string& name : names) {
    const Id object(require(H5Oopen(file->id(), name.c_str(), H5P_DEFAULT), *file, name, "cannot open"));
    if (H5Iget_type(object.get()) != H5I_DATASET) continue;
    const auto limit = extent_of(object, *file, name, true);
    if (limit.empty() || limit.front() != H5S_UNLIMITED) continue;
    const Id type(H5Dget_type(object.get()));
    const bool integer = H5Tget_class(type.get()) == H5T_INTEGER;
    Channel channel{name,
                    root.attribute("unit", name),
                    {},
                    !integer && H5Tget_size(type.get()) == sizeof(float),
                    integer};
    const auto now = extent_of(object, *file, name, false);
    channel.row_shape.assign(now.begin() + 1, now.end());
    channels.emplace_back(std::move(channel), now.front());
  }
  return channels;
}

void cut_rows(const std::filesystem::path& path, const std::map<std::string, std::uint64_t>& rows) {
  const std::filesystem::path copy = path.string() + fmt::format(".new-{}", ::getpid());
  try {
    std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
    OpenFile file(copy, OpenFile::Mode::append);
    for (const auto& [name, count] : rows) {
      const Id dataset(
          require(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), file, name, "cannot open the dataset"));
      auto extent = extent_of(dataset, file, name, false);
      if (extent.front() <= count) continue;
      extent.front() = count;
      require(H5Dset_extent(dataset.get(), extent.data()), file, name, "cannot cut rows off");
    }
    file.close();
    std::filesystem::rename(copy, path);
  } catch (const std::exception& error) {
    std::error_code ignored;
    std::filesystem::remove(copy, ignored);
    if (dynamic_cast<const RunError*>(&error) != nullptr) throw;
    throw_run_error("{}: cannot be shortened to the checkpoint ({})", path.string(), error.what());
  }
}

}  // namespace tuft::record
