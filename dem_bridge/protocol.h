#pragma once
/// What driver and liggghts_host agree on: the messages, and the layout of the memory they share.
///
/// Control goes over one ZeroMQ PAIR socket (ipc, in a private folder): a message is one byte that says what,
/// and for some a text. Bulk of every window never travels: both map one POSIX shared memory object, which
/// has no name any more when the host starts (it inherits the descriptor), so nothing is left behind whatever
/// ends first. Contacts, of which nobody knows the number before, are asked for now and then and come as the
/// answer's text.
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>

namespace tuft::dem {

inline constexpr std::uint64_t protocol_magic = 0x7475667464656d31;  ///< "tuftdem1"
inline constexpr std::uint64_t protocol_version = 3;                 ///< raise with every change of this file

/// Driver to host. Every request gets exactly one answer.
enum class Request : char {
  hello = 'h',  ///< text: none; answered once the host has mapped the memory
  commands =
      'c',  ///< text: LIGGGHTS commands, one a line; the host adds its own fixes and does the first set-up
  advance = 'a',   ///< one window: `step`, `substeps`, `damping` and the impulses of the shared memory
  energy = 'e',    ///< fills `stored_energy`, nearly: springs' elongations are those of one step later
  contacts = 'o',  ///< fills the overlap statistics and the coordination numbers
  network = 'n',   ///< answered with the contacts themselves: ContactRecords as bytes
  save = 's',  ///< text: path of the restart file to write; own forces and torques into the impulse arrays
  resume =
      'r',     ///< after commands that read a restart file: forces, torques, velocities, sums from the memory
  quit = 'q',  ///< answered, then the host ends
};

/// Host to driver.
enum class Answer : char {
  done = 'd',    ///< text: what was asked for, else none
  failed = 'f',  ///< text: why, one line
};

/// One contact of two grains in the answer to Request::network, sorted by grain.
struct ContactRecord {
  std::int32_t first = 0, second = 0;  ///< grain indices, first < second
  std::array<double, 3> force{};       ///< N, on the first
};

/// Fixed part of the shared memory. Plain data; each field has one writer at a time, because the two ends
/// take turns (request, answer).
struct SharedState {
  std::uint64_t magic = protocol_magic;
  std::uint64_t version = protocol_version;
  std::uint64_t grains = 0;

  // Driver to host.
  double step = 0;                              ///< s, of one substep
  std::int64_t substeps = 0;                    ///< of the window
  double damping = 0;                           ///< 1/s
  std::int64_t energy_wanted = 0;               ///< 1: `stored_energy` at the last kick of the window
  std::array<double, 3> gravity{};              ///< m/s^2
  std::array<double, 3> box_low{}, box_high{};  ///< m; grains whose centre leaves it are expelled

  // Host to driver: the last window.
  std::array<double, 3> impulse_received{};  ///< N s, summed over grains and substeps as added to the forces
  std::array<double, 3> impulse_scale{};     ///< N s, the same with absolute values
  double kinetic = 0;                        ///< J, at the middle of the last kick
  double run_seconds = 0;                    ///< wall time inside LIGGGHTS' steps, kicks and copies excluded
  double copy_seconds = 0;                   ///< wall time of kicks and copies in the host

  // Host to driver, and back on resume: works since the start of the run, J.
  double pair_work = 0;       ///< of grain-grain forces and torques
  double contact_work = 0;    ///< of the contact impulses
  double damping_work = 0;    ///< of the damping (never positive)
  double last_pair_work = 0;  ///< share of the last kick in each: a kick's middle is the moment of report
  double last_contact_work = 0;
  double last_damping_work = 0;

  // Host to driver, and back on resume: of the grains that have been expelled. Kinetic energies are as of the
  // first force evaluation outside; those that the last kick still counted with the rest wait in
  // `expelled_pending`.
  std::uint64_t expelled = 0;
  double expelled_mass = 0;
  std::array<double, 3> expelled_momentum{};
  double expelled_energy = 0, expelled_pending = 0;

  // Host to driver: on request, the first also of a window.
  double stored_energy = 0;  ///< J, elastic, in grain-grain contacts
  double overlap_mean = 0, overlap_percentile_99 = 0, overlap_largest = 0;
  std::uint64_t contacts = 0;

  // Host's own words: ring of the last characters LIGGGHTS printed. Readable after any kind of death.
  std::uint64_t words_written = 0;
  std::array<char, 8192> words{};
};

/// The arrays behind SharedState, each `grains` long, by grain index (LIGGGHTS tag - 1).
struct SharedArrays {
  enum Name : std::size_t {
    position_x,
    position_y,
    position_z,
    velocity_x,
    velocity_y,
    velocity_z,
    spin_x,
    spin_y,
    spin_z,
    linear_x,
    linear_y,
    linear_z,  ///< contact impulse of the window, N s (save/resume: own force, N)
    angular_x,
    angular_y,
    angular_z,  ///< N m s (save/resume: own torque, N m)
    mass,
    radius,
    coordination,
    expelled,  ///< 1: has left the box (written by the host; by the driver before a resume), else 0
    count
  };

  static constexpr std::size_t alignment = 64;
  static constexpr std::size_t padded(std::size_t grains) {
    constexpr std::size_t line = alignment / sizeof(double);
    return (grains + line - 1) / line * line;
  }
  static constexpr std::size_t header_bytes = (sizeof(SharedState) + alignment - 1) / alignment * alignment;
  static constexpr std::size_t total_bytes(std::size_t grains) {
    return header_bytes + Name::count * padded(grains) * sizeof(double);
  }

  /// `memory` points to SharedState; pages are aligned far beyond `alignment`.
  static std::span<double> view(void* memory, std::size_t grains, std::size_t name) {
    auto* first = reinterpret_cast<double*>(static_cast<std::byte*>(memory) + header_bytes);
    return {first + name * padded(grains), grains};
  }
};

}  // namespace tuft::dem
