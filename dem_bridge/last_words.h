#pragma once
/// What to quote of a program's output when it has ended.
#include <string>

namespace tuft::dem {

/// First line with ERROR in it, else the last that is not blank or ruled, at most 400 characters; empty if
/// there is none.
[[nodiscard]] std::string telling_line(const std::string& text);

}  // namespace tuft::dem
