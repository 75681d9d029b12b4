#pragma once
/// How channels of a RecordFile lie in HDF5: chunked datasets that grow in their first dimension.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/record_file.h"

namespace tuft::record {

/// Numbers in one row.
[[nodiscard]] std::uint64_t row_size(const Channel& channel);
/// Bytes of one stored number.
[[nodiscard]] std::uint64_t value_size(const Channel& channel);
/// Shape of a chunk, rows first: many rows of a short row (up to 4096, about 32 kB), one row of a long one,
/// and a row over 1 MiB split along its first dimension.
[[nodiscard]] std::vector<std::uint64_t> chunk_shape(const Channel& channel);

/// Adds the empty dataset of a channel, and the groups of its path. Throws RunError.
void create_channel(h5::Group& root, const Channel& channel);

/// Channels of a file and their rows on disk: every dataset that can grow. Throws RunError.
[[nodiscard]] std::vector<std::pair<Channel, std::uint64_t>> list_channels(const std::filesystem::path& path);

/// Cuts channels back to the given rows. Works on a copy that then replaces the file, so that a kill in
/// between loses nothing. Throws RunError.
void cut_rows(const std::filesystem::path& path, const std::map<std::string, std::uint64_t>& rows);

}  // namespace tuft::record
