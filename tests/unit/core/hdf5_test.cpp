#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "core/error.h"
#include "core/hdf5_driver.h"
#include "core/hdf5_file.h"
#include "core/hdf5_overlay.h"
#include "scratch_folder.h"

namespace tuft {
namespace {

using test::message_of;
using test::ScratchFolder;
using testing::HasSubstr;

TEST(Hdf5File, ReturnsEveryTypeBitForBit) {
  const ScratchFolder folder;
  const std::vector<double> doubles{0.1,    -1e-308, std::numeric_limits<double>::max(),
                                    5e-324, -0.0,    1.0 / 3.0};
  const std::vector<std::int32_t> ints{-1, 0, std::numeric_limits<std::int32_t>::min()};
  const std::vector<std::uint64_t> counts{0, std::numeric_limits<std::uint64_t>::max()};
  const std::vector<std::uint8_t> bytes{0, 255, 17};
  const std::string text = "two lines\nand a µ";
  {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    h5::Group state = file.root().create_group("state");
    state.write("doubles", doubles, {2, 3});
    state.write("ints", ints);
    state.write("counts", counts);
    state.write("bytes", bytes);
    state.write("nothing", std::span<const double>{});
    state.write_scalar("pi", 3.141592653589793);
    state.write_scalar("count", std::uint64_t{1} << 63);
    state.write_string("text", text);
    state.write_string("empty", "");
    state.set_attribute("unit", "m/s^2", "doubles");
    state.set_attribute("what", "state of a test");
    file.commit();
  }
  const h5::File file = h5::File::open(folder / "a.h5");
  const h5::Group state = file.root().open_group("state");
  const auto read = state.read_doubles("doubles");
  ASSERT_EQ(read.size(), doubles.size());
  EXPECT_EQ(0, std::memcmp(read.data(), doubles.data(), sizeof(double) * doubles.size()));
  EXPECT_EQ(state.shape("doubles"), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(state.read_row("doubles", 1), std::vector<double>(doubles.begin() + 3, doubles.end()));
  EXPECT_EQ(state.read_row("ints", 1), std::vector<double>{static_cast<double>(ints[1])});
  EXPECT_EQ(state.read_ints("ints"), ints);
  EXPECT_EQ(state.read_counts("counts"), counts);
  EXPECT_EQ(state.read_bytes("bytes"), bytes);
  EXPECT_TRUE(state.read_doubles("nothing").empty());
  EXPECT_EQ(state.read_double("pi"), 3.141592653589793);
  EXPECT_EQ(state.read_count("count"), std::uint64_t{1} << 63);
  EXPECT_EQ(state.read_string("text"), text);
  EXPECT_EQ(state.read_string("empty"), "");
  EXPECT_EQ(state.attribute("unit", "doubles"), "m/s^2");
  EXPECT_EQ(state.attribute("what"), "state of a test");
  EXPECT_EQ(state.names(), (std::vector<std::string>{"bytes", "count", "counts", "doubles", "empty", "ints",
                                                     "nothing", "pi", "text"}));
  EXPECT_TRUE(file.root().has("state/ints"));
  EXPECT_FALSE(file.root().has("state/missing"));
  EXPECT_FALSE(file.root().has("missing/ints"));
}

TEST(Hdf5File, SaysWhichRowIsMissing) {
  const ScratchFolder folder;
  {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    file.root().write("x", std::vector<double>{1, 2, 3, 4}, {2, 2});
    file.commit();
  }
  const h5::File file = h5::File::open(folder / "a.h5");
  EXPECT_NE(message_of<RunError>([&] { (void)file.root().read_row("x", 2); }).find("has no row 2; it has 2"),
            std::string::npos);
}

TEST(Hdf5File, GroupKeepsItsFileOpen) {
  const ScratchFolder folder;
  {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    h5::Group root = file.root();
    root.write_scalar("x", 1.5);
    file.commit();
  }
  const h5::Group root = h5::File::open(folder / "a.h5").root();
  EXPECT_EQ(root.read_double("x"), 1.5);
}

TEST(Hdf5File, ErrorsNameFileAndDataset) {
  const ScratchFolder folder;
  {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    file.root().create_group("state").write("x", std::vector<double>{1, 2});
    file.commit();
  }
  const h5::File file = h5::File::open(folder / "a.h5");
  const std::string missing =
      message_of<RunError>([&] { (void)file.root().open_group("state").read_doubles("y"); });
  EXPECT_THAT(missing, HasSubstr((folder / "a.h5").string() + ": /state/y: cannot open the dataset"));
  EXPECT_THAT(message_of<RunError>([&] { (void)file.root().open_group("state").read_double("x"); }),
              HasSubstr("/state/x: is not a single value"));
  EXPECT_THAT(message_of<RunError>([&] { (void)h5::File::open(folder / "none.h5"); }),
              HasSubstr("none.h5: cannot open the file (open: No such file or directory)"));
}

TEST(Hdf5File, TruncatedOrForeignFileIsRefused) {
  const ScratchFolder folder;
  {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    file.root().write("x", std::vector<double>(10000, 1.0));
    file.commit();
  }
  std::filesystem::resize_file(folder / "a.h5", std::filesystem::file_size(folder / "a.h5") / 2);
  EXPECT_THAT(message_of<RunError>([&] { (void)h5::File::open(folder / "a.h5"); }),
              HasSubstr("truncated file"));
  std::ofstream(folder / "text.h5") << "not HDF5 at all";
  EXPECT_THAT(message_of<RunError>([&] { (void)h5::File::open(folder / "text.h5"); }),
              HasSubstr("cannot open the file"));
}

TEST(Hdf5File, AtomicCreationLeavesOldFileUntilCommit) {
  const ScratchFolder folder;
  const auto write = [&](double value, bool commit) {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    file.root().write_scalar("x", value);
    if (commit) file.commit();
  };
  write(1, true);
  write(2, false);
  EXPECT_EQ(h5::File::open(folder / "a.h5").root().read_double("x"), 1);
  write(3, true);
  EXPECT_EQ(h5::File::open(folder / "a.h5").root().read_double("x"), 3);
  const auto entries = std::distance(std::filesystem::directory_iterator(folder.path()), {});
  EXPECT_EQ(entries, 1) << "temporary files left behind";
}

TEST(Hdf5File, EveryFailedWriteLeavesOldFileAndSaysWhy) {
  const ScratchFolder folder;
  const auto write = [&](double value) {
    h5::File file = h5::File::create_atomically(folder / "a.h5");
    file.root().create_group("g").write("x", std::vector<double>(5000, value));
    file.commit();
  };
  const std::uint64_t before = h5::disk_writes();
  write(1);
  const std::uint64_t writes = h5::disk_writes() - before;
  ASSERT_GT(writes, 3u);
  for (std::uint64_t n = 0; n < writes; ++n) {
    h5::inject_write_fault(h5::WriteFault{n, ENOSPC});
    const std::string message = message_of<RunError>([&] { write(2); });
    h5::inject_write_fault({});
    EXPECT_THAT(message, HasSubstr("No space left on device")) << n;
    EXPECT_EQ(h5::File::open(folder / "a.h5").root().open_group("g").read_doubles("x").front(), 1) << n;
  }
}

TEST(WriteOverlay, LaterWritesCoverEarlierOnes) {
  // Against a plain array: 2000 random writes, then random reads.
  h5::WriteOverlay overlay;
  std::vector<unsigned char> plain(1000, 0);
  std::uint32_t state = 12345;
  const auto random = [&state](std::uint32_t below) {
    return (state = state * 1664525u + 1013904223u) % 65536u % below;
  };
  for (int k = 0; k < 2000; ++k) {
    const std::uint32_t size = 1 + random(60), at = random(1000 - size);
    std::vector<unsigned char> data(size);
    for (auto& byte : data) byte = static_cast<unsigned char>(1 + random(255));
    std::copy(data.begin(), data.end(), plain.begin() + at);
    overlay.put(at, data.data(), data.size(), h5::BlockKind::raw_data);
    const std::uint32_t length = 1 + random(200), from = random(1000 - length);
    std::vector<unsigned char> read(length, 0);
    overlay.apply(from, read.data(), read.size());
    ASSERT_TRUE(std::equal(read.begin(), read.end(), plain.begin() + from)) << k;
  }
  std::uint64_t end = 0;
  for (const auto& [address, block] : overlay.blocks()) {
    EXPECT_GE(address, end) << "blocks overlap";
    end = address + block.bytes.size();
  }
}

}  // namespace
}  // namespace tuft
