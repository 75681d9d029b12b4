#pragma once
/// The host on a machine of its own: waits at a TCP port for a driver.
#include <string>

namespace tuft::dem {

inline constexpr int cannot_listen = 3;  ///< exit code of a process that could not have the port

/// Serves one driver after the other, each with a process of its own (LIGGGHTS cannot be emptied and filled
/// again), until ended by a signal; with `once` only one. One that is frozen as a whole, so that not even its
/// watch on the driver runs, is killed after `frozen_after` (s, at least 1). Waits 1 s after a process that
/// failed before a driver came, twice as long after each that follows. Returns the exit code; throws
/// std::runtime_error when five in a row have failed so, and where no folder or process can be made.
int listen_for_drivers(const std::string& endpoint, bool once, double frozen_after);

/// Serves one driver (session.cpp), with LIGGGHTS in this process, or, where the driver asks for several
/// ranks, in those of an mpirun that it starts. To be called by the process made for it.
int serve_one_driver(const std::string& endpoint);

/// To be called before this process ends on an error of LIGGGHTS: where it serves a driver, that hears the
/// error.
void say_last_words();

inline constexpr const char* served =
    "served";                                  ///< a file that it makes in its folder when a driver has come
inline constexpr const char* alive = "alive";  ///< one whose time it renews as long as it runs

}  // namespace tuft::dem
