#pragma once
/// File driver for HDF5 that makes every session on a file (open ... close) a transaction.
///
/// Why not HDF5's own drivers: after a failed write (disk full) the library can neither flush nor close the
/// file, tries again when the program ends, and leaves the file marked as open for writing; a killed writer
/// leaves the same mark and whatever part of the metadata had been written. Here instead:
/// - what lies beyond the old end of the file is written at once; nothing on disk refers to it yet;
/// - what overwrites older bytes is kept in memory until the file is closed, then written in this order: superblock
///   (which reserves the new space, so that a later session cannot give it away twice), raw data, index blocks,
///   object headers. The object header holds a dataset's extent, so that new rows come into sight last, whole, and
///   every state in between is a valid file for any HDF5 program, to read and to append to;
/// - the first failed write is kept as the session's error; later writes stay in memory, so that the library
/// closes
///   its books in peace; on closing, the file is cut back to its old length: it is what it was before;
/// - no locks are taken: a viewer that has the file open cannot stop a run.
#include <hdf5.h>

#include <cstdint>
#include <optional>
#include <string>

namespace tuft::h5 {

/// What went wrong at the level of the operating system; outlives the HDF5 file that it belongs to.
struct DriverStatus {
  int error = 0;          ///< errno of the first failed operation; 0: none
  std::string operation;  ///< "open", "read", "write", "close"
};

/// File access property list with this driver (owned by the caller) and the newest format. Throws RunError.
[[nodiscard]] hid_t make_access_properties(DriverStatus* status);

/// For tests: after this many more writes to disk, in any file, the next one fails with `error`, or with
/// `error` = 0 kills the process as SIGKILL does.
struct WriteFault {
  std::uint64_t writes_left = 0;
  int error = 0;
};
void inject_write_fault(std::optional<WriteFault> fault);
/// Writes to disk so far in this process.
[[nodiscard]] std::uint64_t disk_writes();

}  // namespace tuft::h5
