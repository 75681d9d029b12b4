#pragma once
/// Runs another program and waits for it.
#include <filesystem>
#include <string>
#include <vector>

namespace tuft::bench {

/// Runs arguments[0] with its standard output and error going to `log` (replaced). Returns the exit code, or
/// 128 + signal as a shell does. Throws std::runtime_error when the program cannot be started.
[[nodiscard]] int run_program(const std::vector<std::string>& arguments, const std::filesystem::path& log);

}  // namespace tuft::bench
