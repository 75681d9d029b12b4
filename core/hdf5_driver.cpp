#include "core/hdf5_driver.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "core/error.h"
#include "core/hdf5_overlay.h"

namespace tuft::h5 {
namespace {

std::optional<WriteFault> write_fault;
std::uint64_t write_count = 0;

/// pwrite of all bytes; 0 or errno.
int write_all(int descriptor, const unsigned char* data, std::size_t size, std::uint64_t address) {
  if (write_fault) {
    if (write_fault->writes_left == 0) {
      if (write_fault->error != 0) return write_fault->error;
      ::kill(::getpid(), SIGKILL);
    }
    --write_fault->writes_left;
  }
  ++write_count;
  while (size > 0) {
    const ssize_t done = ::pwrite(descriptor, data, size, static_cast<off_t>(address));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    data += done;
    address += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
  return 0;
}

/// One open file. The library sees the base only.
struct Session : H5FD_t {
  int descriptor = -1;
  bool writable = false;
  std::uint64_t old_size = 0;  // length on disk when the session began
  std::uint64_t disk_size = 0;
  haddr_t end_of_allocation = 0;
  haddr_t end_of_file = 0;  // as the library sees it, held writes included
  WriteOverlay held;
  DriverStatus* status = nullptr;

  void note(int error, const char* operation) const {
    if (status->error != 0) return;
    status->error = error;
    status->operation = operation;
  }
  [[nodiscard]] bool healthy() const { return status->error == 0; }
  /// Gives back the space of what nothing refers to.
  void roll_back() const {
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor, static_cast<off_t>(old_size));
  }
};

Session& session_of(H5FD_t* file) {
  return *static_cast<Session*>(file);
}
const Session& session_of(const H5FD_t* file) {
  return *static_cast<const Session*>(file);
}

struct DriverInfo {
  DriverStatus* status;
};

hid_t driver_id();

H5FD_t* open_session(const char* name, unsigned flags, hid_t access, haddr_t max_address) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (info == nullptr || max_address == 0) return nullptr;
  auto session = std::make_unique<Session>();
  session->status = info->status;
  session->writable = (flags & H5F_ACC_RDWR) != 0;
  int mode = (session->writable ? O_RDWR : O_RDONLY) | O_CLOEXEC;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  session->descriptor = ::open(name, mode, 0666);
  struct stat state {};
  if (session->descriptor < 0 || ::fstat(session->descriptor, &state) != 0) {
    session->note(errno, "open");
    if (session->descriptor >= 0) ::close(session->descriptor);
    return nullptr;
  }
  session->old_size = session->disk_size = session->end_of_file = static_cast<std::uint64_t>(state.st_size);
  return session.release();
}

/// Holes (blocks allocated and never written) lie beyond the end on disk: extend first, so that a superblock
/// never tells of more than the file holds.
int extend_to_allocation(Session& session) {
  if (session.disk_size >= session.end_of_allocation) return 0;
  if (::ftruncate(session.descriptor, static_cast<off_t>(session.end_of_allocation)) != 0) return errno;
  session.disk_size = session.end_of_allocation;
  return 0;
}

/// Brings what is held to the disk, what refers to the rest last. A failure half-way leaves a valid file.
void commit(Session& session) {
  int error = extend_to_allocation(session);
  if (error != 0) {
    session.note(error, "write");
    session.roll_back();
    return;
  }
  for (const BlockKind kind :
       {BlockKind::superblock, BlockKind::raw_data, BlockKind::metadata, BlockKind::object_header}) {
    for (const auto& [address, block] : session.held.blocks()) {
      if (error == 0 && block.kind == kind)
        error = write_all(session.descriptor, block.bytes.data(), block.bytes.size(), address);
    }
  }
  // Longer than allocated: leavings of a killed session. Harmless, so a failure to cut them off is none.
  if (error == 0 && session.disk_size > session.end_of_allocation) {
    [[maybe_unused]] const int ignored =
        ::ftruncate(session.descriptor, static_cast<off_t>(session.end_of_allocation));
  }
  if (error != 0) session.note(error, "write");
}

herr_t close_session(H5FD_t* file) {
  const std::unique_ptr<Session> session(&session_of(file));
  if (session->writable && session->healthy())
    commit(*session);
  else if (session->writable)
    session->roll_back();
  if (::close(session->descriptor) != 0 && session->writable) session->note(errno, "close");
  return 0;  // errors travel in DriverStatus: the library must be able to forget the file
}

BlockKind kind_of(H5FD_mem_t type, const unsigned char* data, std::size_t size) {
  if (type == H5FD_MEM_SUPER) return BlockKind::superblock;
  if (type == H5FD_MEM_DRAW) return BlockKind::raw_data;
  // The library files array indices under the type of object headers too, so look at the signature ("HDF5
  // File Format Specification" 3.0, IV.A.1.b: OHDR, and OCHK for its continuations).
  const bool header = size >= 4 && (std::memcmp(data, "OHDR", 4) == 0 || std::memcmp(data, "OCHK", 4) == 0);
  return header ? BlockKind::object_header : BlockKind::metadata;
}

herr_t write_block(H5FD_t* file, H5FD_mem_t type, hid_t /*transfer*/, haddr_t address, std::size_t size,
                   const void* buffer) {
  Session& session = session_of(file);
  const auto* data = static_cast<const unsigned char*>(buffer);
  session.end_of_file = std::max<haddr_t>(session.end_of_file, address + size);
  if (session.healthy() && address >= session.old_size) {
    const int error = write_all(session.descriptor, data, size, address);
    if (error == 0) {
      session.disk_size = std::max<std::uint64_t>(session.disk_size, address + size);
      return 0;
    }
    session.note(error, "write");
  }
  try {
    session.held.put(address, data, size, kind_of(type, data, size));
  } catch (const std::bad_alloc&) {
    session.note(ENOMEM, "write");
    return -1;
  }
  return 0;
}

herr_t read_block(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
                  void* buffer) {
  Session& session = session_of(file);
  auto* const data = static_cast<unsigned char*>(buffer);
  std::size_t have = 0;
  while (have < size) {
    const ssize_t done =
        ::pread(session.descriptor, data + have, size - have, static_cast<off_t>(address + have));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      session.note(errno, "read");
      return -1;
    }
    if (done == 0) break;
    have += static_cast<std::size_t>(done);
  }
  std::memset(data + have, 0, size - have);  // allocated, not written yet
  session.held.apply(address, data, size);
  return 0;
}

herr_t query_features(const H5FD_t* /*file*/, unsigned long* flags) {
  // Without FEAT_ACCUMULATE_METADATA, so that each metadata block arrives on its own and can be told by its
  // signature.
  if (flags != nullptr)
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

herr_t truncate_session(H5FD_t* file, hid_t /*transfer*/, hbool_t /*closing*/) {
  Session& session = session_of(file);
  session.end_of_file = session.end_of_allocation;  // on disk: at the end of the session
  return 0;
}

herr_t flush_session(H5FD_t* /*file*/, hid_t /*transfer*/, hbool_t /*closing*/) {
  return 0;
}

haddr_t allocation_end(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return session_of(file).end_of_allocation;
}
haddr_t file_end(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return session_of(file).end_of_file;
}
herr_t set_allocation_end(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
  session_of(file).end_of_allocation = address;
  return 0;
}

H5FD_class_t make_class() {
  H5FD_class_t driver{};
  driver.name = "tuft_transaction";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DriverInfo);
  driver.open = open_session;
  driver.close = close_session;  // no cmp: two openings of one file never share a session
  driver.query = query_features;
  driver.get_eoa = allocation_end;
  driver.set_eoa = set_allocation_end;
  driver.get_eof = file_end;
  driver.read = read_block;
  driver.write = write_block;
  driver.flush = flush_session;
  driver.truncate = truncate_session;
  const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(map), std::end(map), std::begin(driver.fl_map));
  return driver;
}

hid_t driver_id() {
  static const H5FD_class_t driver = make_class();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

}  // namespace

hid_t make_access_properties(DriverStatus* status) {
  const DriverInfo info{status};
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  if (access < 0 || H5Pset_driver(access, driver_id(), &info) < 0 ||
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 ||
      H5Pset_libver_bounds(access, H5F_LIBVER_LATEST, H5F_LIBVER_LATEST) < 0) {
    if (access >= 0) H5Pclose(access);
    throw_run_error("the HDF5 library refuses its set-up; is another version of it loaded?");
  }
  return access;
}

void inject_write_fault(std::optional<WriteFault> fault) {
  write_fault = fault;
}
std::uint64_t disk_writes() {
  return write_count;
}

}  // namespace tuft::h5
