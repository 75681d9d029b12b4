#pragma once
/// What driver and liggghts_host agree on: the messages, and the layout of the memory they share.
///
/// Control goes over one stream socket a rank, in a private folder: a message is one byte that says what, and
/// for some a text. Bulk of every window never travels: all map one POSIX shared memory object, which has no
/// name any more when the host starts (its descriptor is handed over on the socket), so nothing is left
/// behind whatever ends first. Every rank of a host on several reads and writes its own grains there, by
/// their index, so nothing is gathered. Contacts, of which nobody knows the number before, are asked for now
/// and then and come as the answer's text.
#include <array>
#include <cstddef>
#include <cstdint>

namespace tuft::dem {

inline constexpr std::uint64_t protocol_magic = 0x7475667464656d31;  ///< "tuftdem1"
inline constexpr std::uint64_t protocol_version = 9;                 ///< raise with every change of this file

/// Steps after which LIGGGHTS adds the forces of its `fix external`, all zero: the bridge adds its own to the
/// forces when that calls it.
inline constexpr std::int64_t external_forces_every = 1'000'000'000;

/// m beyond the box where LIGGGHTS keeps a grain that has left it, out of reach of all inside: more than any
/// grain's radius, and within LIGGGHTS' own box (expulsion_margin).
inline constexpr double parking_distance = 0.018;

/// Driver to host. Every rank gives exactly one answer to a request.
enum class Request : char {
  hello = 'h',     ///< text: none; answered once the host has mapped the memory
  commands = 'c',  ///< text: LIGGGHTS commands, one a line, files in the host's folder; the host adds its own
                   ///< fixes and does the first set-up. Fills `mass` and `radius`
  advance = 'a',   ///< one window: `step`, `substeps`, `damping` and contact impulses of the shared memory
  census = 'p',    ///< fills `coordination` with 1 for every grain that is there
  energy = 'e',    ///< fills `stored_energy`, nearly: springs' elongations are those of one step later
  contacts = 'o',  ///< fills the coordination numbers; answered with OverlapRecords as bytes
  network = 'n',   ///< answered with the contacts themselves: ContactRecords as bytes
  save = 's',      ///< text: name of the restart file to write; fills own forces and torques
  resume = 'r',    ///< after commands that read a restart file: forces, torques, velocities from the memory
  quit = 'q',      ///< the host ends, after an answer where the memory is shared
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

/// One contact of two grains in the answer to Request::contacts. Of a contact between two ranks' grains the
/// rank with the grain of lower index tells.
struct OverlapRecord {
  std::int32_t first = 0, second = 0;  ///< LIGGGHTS' types - 1, first <= second
  double overlap = 0;                  ///< over the smaller radius, above 0
};

/// Kinds of grains that overlaps are told apart for.
inline constexpr std::size_t largest_kinds = 16;
/// Place of a pair of types (from 0) in a list of all pairs.
constexpr std::size_t pair_place(std::size_t a, std::size_t b) {
  const std::size_t low = a < b ? a : b, high = a < b ? b : a;
  return high * (high + 1) / 2 + low;
}
inline constexpr std::size_t largest_pairs = largest_kinds * (largest_kinds + 1) / 2;

/// The file of the host's folder that says which grains are rigid bodies, where the commands define a `fix
/// clumps all multisphere` and read no restart file: a BodyRecord and then a BodySphere for each of its
/// spheres, one body after the other.
inline constexpr const char* bodies_file_name = "bodies";

/// A body of the grains from `first` on.
struct BodyRecord {
  std::uint64_t first = 0, count = 0;
  double mass = 0;                              ///< kg
  double density = 0;                           ///< kg/m^3
  double reach = 0;                             ///< m, from the centre of mass to the farthest point
  std::array<double, 3> centre{};               ///< m, of mass
  std::array<std::array<double, 3>, 3> axes{};  ///< principal axes, right-handed
  std::array<double, 3> inertia{};              ///< kg m^2 about them
};

struct BodySphere {
  std::array<double, 3> place{};  ///< m, of its centre from that of mass, along the body's axes
  double share = 0;               ///< of the mass, see ClumpBody
};

/// What contact gives one grain over a window. Sorted by grain; one that nothing touches has no record.
struct LoadRecord {
  std::uint64_t grain = 0;
  std::array<double, 3> impulse{};  ///< N s
  std::array<double, 3> angular{};  ///< N m s about its centre
};

enum class EnergyWanted : std::int64_t { none, kinetic, all };  ///< all: `stored_energy`, too

/// Fixed part of the shared memory, written by the driver. Plain data; the two ends take turns (request,
/// answer).
struct SharedState {
  std::uint64_t magic = protocol_magic;
  std::uint64_t version = protocol_version;
  std::uint64_t grains = 0;
  std::uint64_t ranks = 1;

  double step = 0;                                     ///< s, of one substep
  std::int64_t substeps = 0;                           ///< of the window
  double damping = 0;                                  ///< 1/s
  EnergyWanted energy_wanted = EnergyWanted::kinetic;  ///< at the last kick of the window
  std::array<double, 3> gravity{};                     ///< m/s^2
  std::array<double, 3> box_low{}, box_high{};         ///< m; grains whose centre leaves it are expelled
  std::uint64_t expelled = 0;                          ///< grains that have left so far; a clump counts once
  std::uint64_t loads = 0;                             ///< LoadRecords of the window
};

/// What one rank tells of its grains: written by that rank alone.
struct RankState {
  // The last window.
  std::array<double, 3> impulse_received{};  ///< N s, summed over grains and substeps as added to the forces
  std::array<double, 3> impulse_scale{};     ///< N s, the same with absolute values
  double run_seconds = 0;                    ///< wall time of the steps, copies excluded
  double copy_seconds = 0;                   ///< wall time of copies in the host
  double pair_work = 0;                      ///< J in the window: of grain-grain forces and torques
  double contact_work = 0;                   ///< of the contact impulses
  double damping_work = 0;                   ///< of the damping (never positive)
  double last_pair_work = 0;  ///< share of the last kick in each: a kick's middle is the moment of report
  double last_contact_work = 0;
  double last_damping_work = 0;
  double kinetic = 0;  ///< J, at the middle of the last kick
  // Grains that have left at its end. Their kinetic energy is as of the force evaluation that comes.
  std::uint64_t expelled = 0;
  double expelled_mass = 0;
  std::array<double, 3> expelled_momentum{};
  double expelled_energy = 0;

  std::uint64_t fast = 0;    ///< grains that move on by more than their radius in a step, at the window's end
  std::uint64_t grains = 0;  ///< that the rank owns
  double stored_energy =
      0;  ///< J, elastic, in grain-grain contacts; on request, or as of a window's last kick
  /// By pair_place: the largest overlap over the smaller radius, seen whenever stored_energy was summed up in
  /// a kick. The driver sets it back; over a network the host does, once it has told.
  std::array<double, largest_pairs> overlap_largest{};

  // Host's own words: ring of the last characters LIGGGHTS printed. Readable after any kind of death.
  std::uint64_t words_written = 0;
  std::array<char, 8192> words{};
};

/// What lies behind SharedState: a RankState a rank, arrays, each `grains` long, by grain index
/// (LIGGGHTS tag - 1), and room for a LoadRecord a grain.
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
    own_force_x,  ///< N, of the other grains; for save and resume alone
    own_force_y,
    own_force_z,
    own_torque_x,  ///< N m
    own_torque_y,
    own_torque_z,
    mass,  ///< kg; of a clump's sphere its share of the clump's
    radius,
    coordination,
    expelled,  ///< 1: has left the box (written by the host; by the driver before a resume), else 0
    count
  };

  static constexpr std::size_t alignment = 64;
  static constexpr std::size_t aligned(std::size_t bytes) {
    return (bytes + alignment - 1) / alignment * alignment;
  }
  static constexpr std::size_t padded(std::size_t grains) {
    return aligned(grains * sizeof(double)) / sizeof(double);
  }
  static constexpr std::size_t rank_offset(std::size_t rank) {
    return aligned(sizeof(SharedState)) + rank * aligned(sizeof(RankState));
  }
  static constexpr std::size_t array_offset(std::size_t grains, std::size_t ranks, std::size_t name) {
    return rank_offset(ranks) + name * padded(grains) * sizeof(double);
  }
  static constexpr std::size_t loads_offset(std::size_t grains, std::size_t ranks) {
    return array_offset(grains, ranks, Name::count);
  }
  static constexpr std::size_t total_bytes(std::size_t grains, std::size_t ranks) {
    return loads_offset(grains, ranks) + aligned(grains * sizeof(LoadRecord));
  }
};

}  // namespace tuft::dem
