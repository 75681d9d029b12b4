#include "core/record_file.h"

#include <sys/statvfs.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <unordered_map>

#include "core/error.h"
#include "core/hdf5_handles.h"
#include "core/record_layout.h"

namespace tuft {

using h5::Id;
using h5::OpenFile;
using h5::require;

/// One channel: its layout, the rows on disk and the rows that wait.
struct ChannelState {
  Channel channel;
  std::uint64_t row_size = 1;  ///< numbers a row
  std::uint64_t rows_on_disk = 0;
  std::uint64_t rows_buffered = 0;
  std::vector<double> buffer;
};

struct RecordFile::Impl {
  std::filesystem::path path;
  std::vector<ChannelState> channels;
  std::unordered_map<std::string, std::size_t> index;

  void add(ChannelState state) {
    index.emplace(state.channel.path, channels.size());
    channels.push_back(std::move(state));
  }
  ChannelState& find(std::string_view channel);
  void drop_buffers();
  void require_space() const;
  void write_rows(const OpenFile& file, ChannelState& state) const;
};

namespace {

/// What index blocks and the superblock of one flush take at most, bytes a channel (measured: under 2 kB).
constexpr std::uint64_t metadata_allowance = 8192;

std::string in_words(std::uint64_t bytes) {
  return bytes < 10'000'000 ? fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1e3)
                            : fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

ChannelState make_state(const Channel& channel, std::uint64_t rows) {
  return {channel, record::row_size(channel), rows, 0, {}};
}

}  // namespace

ChannelState& RecordFile::Impl::find(std::string_view channel) {
  const auto found = index.find(std::string(channel));
  if (found == index.end()) throw_run_error("{}: no channel {}", path.string(), channel);
  return channels[found->second];
}

void RecordFile::Impl::drop_buffers() {
  for (ChannelState& state : channels) {
    state.buffer.clear();
    state.rows_buffered = 0;
  }
}

/// Asks before writing: with a full disk the file is then not touched at all.
void RecordFile::Impl::require_space() const {
  std::uint64_t needed = 0;
  for (const ChannelState& state : channels) {
    if (state.rows_buffered == 0) continue;
    const std::uint64_t chunk_rows = record::chunk_shape(state.channel).front();
    const std::uint64_t rows = (state.rows_buffered / chunk_rows + 2) * chunk_rows;
    needed += rows * state.row_size * record::value_size(state.channel) + metadata_allowance;
  }
  struct statvfs disk {};
  const auto folder = path.parent_path();
  if (::statvfs(folder.empty() ? "." : folder.c_str(), &disk) != 0) return;  // writing will tell
  const std::uint64_t free = static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
  if (free < needed)
    throw_run_error(
        "{}: no space left on device: {} needed, {} free; make room, then resume from the last checkpoint",
        path.string(), in_words(needed), in_words(free));
}

void RecordFile::Impl::write_rows(const OpenFile& file, ChannelState& state) const {
  const std::string& name = state.channel.path;
  const Id dataset(
      require(H5Dopen2(file.id(), name.c_str(), H5P_DEFAULT), file, name, "cannot open the dataset"));
  std::vector<hsize_t> extent{state.rows_on_disk + state.rows_buffered}, start{state.rows_on_disk},
      count{state.rows_buffered};
  for (const std::uint64_t length : state.channel.row_shape) {
    extent.push_back(length);
    start.push_back(0);
    count.push_back(length);
  }
  require(H5Dset_extent(dataset.get(), extent.data()), file, name, "cannot grow");
  const Id target(require(H5Dget_space(dataset.get()), file, name, "has no shape"));
  require(H5Sselect_hyperslab(target.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          file, name, "has another shape");
  const Id source(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr));
  require(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, source.get(), target.get(), H5P_DEFAULT,
                   state.buffer.data()),
          file, name, "cannot write");
  file.require_healthy(name);
}

RecordFile RecordFile::create(const std::filesystem::path& path, const std::vector<Channel>& channels,
                              const std::function<void(h5::Group&)>& write_static) {
  RecordFile record;
  record.impl_ = std::make_unique<Impl>();
  record.impl_->path = path;
  h5::File file = h5::File::create_atomically(path);
  h5::Group root = file.root();
  for (const Channel& channel : channels) {
    record::create_channel(root, channel);
    record.impl_->add(make_state(channel, 0));
  }
  if (write_static) write_static(root);
  file.commit();
  return record;
}

RecordFile RecordFile::reopen(const std::filesystem::path& path,
                              const std::map<std::string, std::uint64_t>& rows) {
  RecordFile record;
  record.impl_ = std::make_unique<Impl>();
  record.impl_->path = path;
  bool too_long = false;
  for (const auto& [channel, have] : record::list_channels(path)) {
    const auto wanted = rows.find(channel.path);
    if (wanted == rows.end())
      throw_run_error("{}: {}: the checkpoint does not know this channel; it belongs to another run",
                      path.string(), channel.path);
    if (have < wanted->second)
      throw_run_error(
          "{}: {}: {} rows, but the checkpoint was taken after {}; the file is not the one it belongs to",
          path.string(), channel.path, have, wanted->second);
    too_long |= have > wanted->second;
    record.impl_->add(make_state(channel, wanted->second));
  }
  for (const auto& [name, count] : rows) {
    if (!record.impl_->index.contains(name))
      throw_run_error("{}: {}: no such channel, but the checkpoint holds {} rows of it", path.string(), name,
                      count);
  }
  if (too_long) record::cut_rows(path, rows);
  return record;
}

void RecordFile::append(std::string_view channel, std::span<const double> row) {
  const ChannelState& state = impl_->find(channel);
  if (row.size() != state.row_size)
    throw_run_error("{}: {}: a row has {} values, {} given", impl_->path.string(), channel, state.row_size,
                    row.size());
  append_rows(channel, row);
}

void RecordFile::append_rows(std::string_view channel, std::span<const double> rows) {
  ChannelState& state = impl_->find(channel);
  if (rows.size() % state.row_size != 0)
    throw_run_error("{}: {}: rows have {} values, {} given are no whole number of them", impl_->path.string(),
                    channel, state.row_size, rows.size());
  const auto bad =
      std::find_if_not(rows.begin(), rows.end(), [](double value) { return std::isfinite(value); });
  if (bad != rows.end()) {
    const auto place = static_cast<std::uint64_t>(bad - rows.begin());
    throw_run_error("{}: {}: value {} of row {} is {}; the run has gone unstable", impl_->path.string(),
                    channel, place % state.row_size,
                    state.rows_on_disk + state.rows_buffered + place / state.row_size, *bad);
  }
  state.buffer.insert(state.buffer.end(), rows.begin(), rows.end());
  state.rows_buffered += rows.size() / state.row_size;
}

void RecordFile::append(std::string_view channel, double value) {
  append(channel, std::span(&value, 1));
}

void RecordFile::flush() {
  if (buffered_bytes() == 0) return;
  try {
    impl_->require_space();
    OpenFile file(impl_->path, OpenFile::Mode::append);
    for (ChannelState& state : impl_->channels) {
      if (state.rows_buffered > 0) impl_->write_rows(file, state);
    }
    file.close();
  } catch (...) {
    impl_->drop_buffers();
    throw;
  }
  for (ChannelState& state : impl_->channels) state.rows_on_disk += state.rows_buffered;
  impl_->drop_buffers();
}

std::map<std::string, std::uint64_t> RecordFile::rows() const {
  std::map<std::string, std::uint64_t> counts;
  for (const ChannelState& state : impl_->channels)
    counts[state.channel.path] = state.rows_on_disk + state.rows_buffered;
  return counts;
}

std::size_t RecordFile::buffered_bytes() const {
  std::size_t bytes = 0;
  for (const ChannelState& state : impl_->channels) bytes += state.buffer.size() * sizeof(double);
  return bytes;
}

RecordFile::RecordFile() = default;
RecordFile::~RecordFile() = default;
RecordFile::RecordFile(RecordFile&&) noexcept = default;
RecordFile& RecordFile::operator=(RecordFile&&) noexcept = default;

}  // namespace tuft
