#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include "core/error.h"
#include "core/hdf5_driver.h"
#include "core/record_file.h"
#include "core/record_layout.h"
#include "scratch_folder.h"

namespace tuft {
namespace {

using test::message_of;
using test::ScratchFolder;
using testing::HasSubstr;

const std::vector<Channel> channels{{"/history/time", "s", {}, false},
                                    {"/history/force", "N", {3}, false},
                                    {"/frames/infill/position", "m", {2000, 3}, true}};

double expected_force(std::uint64_t row, int component) {
  return static_cast<double>(row) + 0.1 * component;
}

RecordFile create(const std::filesystem::path& path) {
  return RecordFile::create(path, channels, [](h5::Group& root) { root.write_string("scene", "[scene]\n"); });
}

/// `count` rows of the histories and one frame, from row `first` on.
void append_rows(RecordFile& record, std::uint64_t first, std::uint64_t count) {
  for (std::uint64_t row = first; row < first + count; ++row) {
    record.append("/history/time", static_cast<double>(row));
    record.append("/history/force", std::vector<double>{expected_force(row, 0), expected_force(row, 1),
                                                        expected_force(row, 2)});
  }
  record.append("/frames/infill/position", std::vector<double>(6000, static_cast<double>(first)));
}

/// Every row on disk holds what was appended. Read with the library's own driver, as any other program would.
/// Returns the rows of the shortest history.
std::uint64_t check_with_plain_hdf5(const std::filesystem::path& path) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_GE(file, 0) << "unreadable";
  if (file < 0) return 0;
  const auto read = [file](const char* name, std::vector<double>& values) {
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    const hid_t space = H5Dget_space(set);
    hsize_t size[3] = {0, 1, 1};
    H5Sget_simple_extent_dims(space, size, nullptr);
    values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0) << name;
    H5Sclose(space);
    H5Dclose(set);
    return size[0];
  };
  std::vector<double> values;
  const std::uint64_t times = read("/history/time", values);
  for (std::uint64_t row = 0; row < times; ++row) EXPECT_EQ(values[row], static_cast<double>(row));
  const std::uint64_t forces = read("/history/force", values);
  for (std::uint64_t row = 0; row < forces; ++row)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(values[3 * row + static_cast<std::uint64_t>(k)], expected_force(row, k));
  const std::uint64_t frames = read("/frames/infill/position", values);
  for (std::uint64_t row = 0; row < frames; ++row) EXPECT_EQ(values[6000 * row], values[6000 * row + 5999]);
  if (frames > 1) {
    EXPECT_NE(values[6000 * (frames - 1)], 0) << "a row without data came into sight";
  }
  EXPECT_EQ(H5Fclose(file), 0);
  return std::min(times, forces);
}

TEST(RecordFile, RowsComeBackAcrossManyFlushes) {
  const ScratchFolder folder;
  RecordFile record = create(folder / "run.h5");
  std::uint64_t row = 0;
  for (const std::uint64_t count : {1, 10, 5000, 1, 4096, 777}) {
    append_rows(record, row, count);
    row += count;
    record.flush();
    EXPECT_EQ(check_with_plain_hdf5(folder / "run.h5"), row);
  }
  EXPECT_EQ(record.rows().at("/history/time"), row);
  EXPECT_EQ(record.rows().at("/frames/infill/position"), 6u);
  const h5::Group root = h5::File::open(folder / "run.h5").root();
  EXPECT_EQ(root.attribute("unit", "/history/force"), "N");
  EXPECT_EQ(root.read_string("scene"), "[scene]\n");
}

TEST(RecordFile, RefusesBadRows) {
  const ScratchFolder folder;
  RecordFile record = create(folder / "run.h5");
  EXPECT_THAT(message_of<RunError>([&] { record.append("/history/time", NAN); }),
              HasSubstr("/history/time: value 0 of row 0 is nan"));
  EXPECT_THAT(message_of<RunError>([&] { record.append("/history/force", 1.0); }),
              HasSubstr("/history/force: a row has 3 values, 1 given"));
  EXPECT_THAT(message_of<RunError>([&] { record.append("/history/tine", 1.0); }),
              HasSubstr("no channel /history/tine"));
}

TEST(RecordFile, ReopenCutsBackToTheCheckpoint) {
  const ScratchFolder folder;
  std::map<std::string, std::uint64_t> rows;
  {
    RecordFile record = create(folder / "run.h5");
    append_rows(record, 0, 5000);
    record.flush();
    rows = record.rows();
    append_rows(record, 5000, 6000);
    record.flush();
  }
  RecordFile record = RecordFile::reopen(folder / "run.h5", rows);
  EXPECT_EQ(record.rows(), rows);
  EXPECT_EQ(check_with_plain_hdf5(folder / "run.h5"), 5000u);
  append_rows(record, 5000, 10);
  record.flush();
  EXPECT_EQ(check_with_plain_hdf5(folder / "run.h5"), 5010u);
}

TEST(RecordFile, ReopenRefusesAnotherRunsFile) {
  const ScratchFolder folder;
  {
    RecordFile record = create(folder / "run.h5");
    append_rows(record, 0, 3);
    record.flush();
  }
  const std::map<std::string, std::uint64_t> more{
      {"/history/time", 4}, {"/history/force", 3}, {"/frames/infill/position", 1}};
  EXPECT_THAT(message_of<RunError>([&] { (void)RecordFile::reopen(folder / "run.h5", more); }),
              HasSubstr("/history/time: 3 rows, but the checkpoint was taken after 4"));
  EXPECT_THAT(message_of<RunError>([&] { (void)RecordFile::reopen(folder / "run.h5", {}); }),
              HasSubstr("the checkpoint does not know this channel"));
}

TEST(RecordFile, ChunksSuitTheRow) {
  EXPECT_EQ(record::chunk_shape({"/a", "s", {}, false}), (std::vector<std::uint64_t>{4096}));
  EXPECT_EQ(record::chunk_shape({"/a", "s", {3}, false}), (std::vector<std::uint64_t>{1365, 3}));
  EXPECT_EQ(record::chunk_shape({"/a", "s", {4000, 3}, true}), (std::vector<std::uint64_t>{1, 4000, 3}));
  const auto split = record::chunk_shape({"/a", "s", {300000, 3}, true});
  EXPECT_EQ(split[0], 1u);
  EXPECT_LE(split[1] * 3 * sizeof(float), 1024u * 1024u);
}

/// A file with 4000 rows, the rows it holds, and the writes that a flush of 5000 more takes.
struct Pristine {
  explicit Pristine(const ScratchFolder& folder) : file(folder / "pristine.h5") {
    RecordFile record = create(file);
    append_rows(record, 0, 4000);
    record.flush();
    rows = record.rows();
    std::filesystem::copy_file(file, folder / "longer.h5");
    RecordFile longer = RecordFile::reopen(folder / "longer.h5", rows);
    const std::uint64_t before = h5::disk_writes();
    append_rows(longer, 4000, 5000);
    longer.flush();
    writes = h5::disk_writes() - before;
  }
  std::filesystem::path file;
  std::map<std::string, std::uint64_t> rows;
  std::uint64_t writes = 0;
};

/// Takes up a file whose last flush came to grief: first a short flush, then a long one.
void expect_resumable(const std::filesystem::path& path, const std::map<std::string, std::uint64_t>& rows) {
  RecordFile record = RecordFile::reopen(path, rows);
  ASSERT_EQ(check_with_plain_hdf5(path), 4000u);
  append_rows(record, 4000, 1);
  record.flush();
  ASSERT_EQ(check_with_plain_hdf5(path), 4001u);
  append_rows(record, 4001, 6000);
  record.flush();
  ASSERT_EQ(check_with_plain_hdf5(path), 10001u);
}

TEST(RecordFile, WriteThatFailsAnywhereInAFlushLeavesFlushedRowsReadable) {
  const ScratchFolder folder;
  const Pristine pristine(folder);
  const auto trial = folder / "trial.h5";
  ASSERT_GT(pristine.writes, 10u);
  for (std::uint64_t n = 0; n < pristine.writes; ++n) {
    std::filesystem::copy_file(pristine.file, trial, std::filesystem::copy_options::overwrite_existing);
    RecordFile record = RecordFile::reopen(trial, pristine.rows);
    append_rows(record, 4000, 5000);
    h5::inject_write_fault(h5::WriteFault{n, ENOSPC});
    const std::string message = message_of<RunError>([&] { record.flush(); });
    h5::inject_write_fault({});
    ASSERT_THAT(message, HasSubstr("No space left on device")) << n;
    EXPECT_EQ(record.buffered_bytes(), 0u);
    // The last writes bring object headers, dataset by dataset: rows may be in sight already, but only whole.
    const std::uint64_t readable = check_with_plain_hdf5(trial);
    ASSERT_TRUE(readable == 4000 || readable == 9000) << n << ": " << readable;
    expect_resumable(trial, pristine.rows);
    ASSERT_FALSE(HasFailure()) << n;
  }
}

/// Runs `work` in a child process and returns its wait status.
template <class Work>
int in_child(Work&& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      work();
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s\n", error.what());
      std::_Exit(3);
    }
    std::exit(0);  // through HDF5's own clean-up, as the program does
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(RecordFile, KillAtEveryWriteOfAFlushLeavesFlushedRowsReadable) {
  const ScratchFolder folder;
  const Pristine pristine(folder);
  const auto trial = folder / "trial.h5";
  for (std::uint64_t n = 0; n < pristine.writes; ++n) {
    std::filesystem::copy_file(pristine.file, trial, std::filesystem::copy_options::overwrite_existing);
    const int status = in_child([&] {
      RecordFile record = RecordFile::reopen(trial, pristine.rows);
      append_rows(record, 4000, 5000);
      h5::inject_write_fault(h5::WriteFault{n, 0});
      record.flush();
    });
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << n;
    const std::uint64_t readable = check_with_plain_hdf5(trial);
    ASSERT_TRUE(readable == 4000 || readable == 9000) << n << ": " << readable;
    expect_resumable(trial, pristine.rows);
    ASSERT_FALSE(HasFailure()) << n;
  }
}

TEST(RecordFile, KillAtAnyMomentLeavesFlushedRowsReadable) {
  const ScratchFolder folder;
  for (int trial = 0; trial < 60; ++trial) {
    std::filesystem::remove(folder / "run.h5");
    const auto initial = create(folder / "run.h5");
    int first_flush[2];
    ASSERT_EQ(::pipe(first_flush), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      RecordFile record = RecordFile::reopen(folder / "run.h5", initial.rows());
      for (std::uint64_t row = 0;; row += 50) {
        append_rows(record, row, 50);
        record.flush();
        if (row == 0 && ::write(first_flush[1], "x", 1) != 1) std::_Exit(3);
      }
    }
    ::close(first_flush[1]);  // so that a writer that dies early ends the wait
    char byte = 0;
    ASSERT_EQ(::read(first_flush[0], &byte, 1), 1);
    std::this_thread::sleep_for(std::chrono::microseconds(137 * trial));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(first_flush[0]);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the writer ended by itself";
    const std::uint64_t rows = check_with_plain_hdf5(folder / "run.h5");
    EXPECT_GE(rows, 50u) << "a flushed row is lost";
    EXPECT_EQ(rows % 50, 0u) << "part of a flush came into sight";
    EXPECT_EQ(h5::File::open(folder / "run.h5").root().read_doubles("/history/time").size() % 50, 0u);
  }
}

// A limit on the file's size makes the kernel refuse writes as a full disk does, for any user.
TEST(RecordFile, WriteRefusedByTheSystemEndsInOneLineAndACleanExit) {
  const ScratchFolder folder;
  const int status = in_child([&] {
    RecordFile record = create(folder / "run.h5");
    append_rows(record, 0, 4000);
    record.flush();
    const auto limit = static_cast<rlim_t>(std::filesystem::file_size(folder / "run.h5") + 20000);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit file_size{limit, limit};
    ::setrlimit(RLIMIT_FSIZE, &file_size);
    append_rows(record, 4000, 50000);
    const std::string message = message_of<RunError>([&] { record.flush(); });
    if (message.find("run.h5: /history/") == std::string::npos ||
        message.find("File too large") == std::string::npos || message.find('\n') != std::string::npos)
      throw RunError("wrong message: " + message);
    if (check_with_plain_hdf5(folder / "run.h5") != 4000) throw RunError("rows lost");
  });
  ASSERT_TRUE(WIFEXITED(status)) << strsignal(WTERMSIG(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(check_with_plain_hdf5(folder / "run.h5"), 4000u);
}

/// A small file system of its own; needs the right to mount.
class SmallDisk {
 public:
  explicit SmallDisk(const std::filesystem::path& folder) : folder_(folder) {
    std::filesystem::create_directories(folder_);
    mounted_ = ::mount("tuft-test", folder_.c_str(), "tmpfs", 0, "size=1m") == 0;
  }
  ~SmallDisk() {
    if (mounted_) ::umount(folder_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  [[nodiscard]] bool mounted() const { return mounted_; }

 private:
  std::filesystem::path folder_;
  bool mounted_ = false;
};

TEST(RecordFile, FullDiskIsNoticedBeforeTheFileIsTouched) {
  const ScratchFolder folder;
  const SmallDisk disk(folder / "disk");
  if (!disk.mounted()) GTEST_SKIP() << "no right to mount a file system";
  const auto file = folder / "disk/run.h5";
  RecordFile record = create(file);
  append_rows(record, 0, 4000);
  record.flush();
  append_rows(record, 4000, 60000);
  const std::string message = message_of<RunError>([&] { record.flush(); });
  EXPECT_THAT(message, HasSubstr("disk/run.h5: no space left on device: "));
  EXPECT_THAT(message, HasSubstr("make room, then resume from the last checkpoint"));
  EXPECT_EQ(check_with_plain_hdf5(file), 4000u);
  append_rows(record, 4000, 10);
  record.flush();
  EXPECT_EQ(check_with_plain_hdf5(file), 4010u) << "what fits is still recorded";
  // A file written at once has no such warning: the write itself fails.
  const std::string atomic = message_of<RunError>([&] {
    h5::File checkpoint = h5::File::create_atomically(folder / "disk/checkpoint.h5");
    checkpoint.root().write("x", std::vector<double>(200000, 1.0));
    checkpoint.commit();
  });
  EXPECT_THAT(atomic, HasSubstr("/x: cannot write (write: No space left on device)"));
  EXPECT_FALSE(std::filesystem::exists(folder / "disk/checkpoint.h5"));
  EXPECT_EQ(check_with_plain_hdf5(file), 4010u);
}

TEST(RecordFile, TakesManyRowsAtOnceAndKeepsIntegersWholeWhenReopened) {
  const ScratchFolder folder;
  const auto file = folder / "run.h5";
  const auto kind_of = [&] {
    const hid_t open = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t set = H5Dopen2(open, "/pair", H5P_DEFAULT), type = H5Dget_type(set);
    const auto kind = H5Tget_class(type);
    H5Tclose(type), H5Dclose(set), H5Fclose(open);
    return kind;
  };
  {
    RecordFile record = RecordFile::create(file, {{"/pair", "1", {2}, false, true}}, {});
    record.append_rows("/pair",
                       std::vector<double>{1, 2, 3, 4, 16777217, 5});  // the last beyond single precision
    record.append_rows("/pair", {});
    EXPECT_THAT(message_of<RunError>([&] { record.append_rows("/pair", std::vector<double>(3, 1.0)); }),
                HasSubstr("rows have 2 values, 3 given"));
    EXPECT_THAT(message_of<RunError>([&] {
                  record.append_rows("/pair", std::vector<double>{1, 2, 3, NAN});
                }),
                HasSubstr("value 1 of row 4 is nan"));
    record.flush();
    EXPECT_EQ(record.rows().at("/pair"), 3u);
  }
  EXPECT_EQ(kind_of(), H5T_INTEGER);
  RecordFile again = RecordFile::reopen(file, {{"/pair", 2}});
  again.append_rows("/pair", std::vector<double>{7, 8});
  again.flush();
  EXPECT_EQ(kind_of(), H5T_INTEGER);
  EXPECT_EQ(h5::File::open(file).root().read_ints("pair"), (std::vector<std::int32_t>{1, 2, 3, 4, 7, 8}));
}

}  // namespace
}  // namespace tuft
