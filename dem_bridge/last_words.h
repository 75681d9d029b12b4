#pragma once
/// What to quote of a program's output when it has ended.
#include <string>

namespace tuft::dem {

/// First line with ERROR in it, at most 400 characters; empty if there is none.
[[nodiscard]] std::string error_line(const std::string& text);

/// The same, or else the last line that is not blank or ruled.
[[nodiscard]] std::string telling_line(const std::string& text);

}  // namespace tuft::dem
