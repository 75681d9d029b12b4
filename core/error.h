#pragma once
/// The two errors that reach a user. Everything else is a defect of ours.
#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace tuft {

/// The user's mistake: bad scene, bad argument, unusable folder. One line: what, where (file:line, key), the
/// value, what to do. The program ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that could not go on: instability, lost host, full disk. One line; exit code 1. Nothing recorded
/// before is lost.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

template <class... Args>
[[noreturn]] void throw_input_error(fmt::format_string<Args...> format, Args&&... args) {
  throw InputError(fmt::format(format, std::forward<Args>(args)...));
}

template <class... Args>
[[noreturn]] void throw_run_error(fmt::format_string<Args...> format, Args&&... args) {
  throw RunError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace tuft
