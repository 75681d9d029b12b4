#pragma once
// What the parts of print_sph_verification share.
#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tests/verification/sph_infill/cases/column_collapse.h"

namespace tuft::sph::test {

template <class... Values>
void print(fmt::format_string<Values...> format, Values&&... values) {
  fmt::print(format, std::forward<Values>(values)...);
  std::fflush(stdout);
}

/// Of a collapse (column_collapse.h) with another aspect ratio and pitch.
[[nodiscard]] double run_out(CollapseCase c, double aspect, int particles, const Numerics& numerics = {});

// Sections of docs/verification/sph.md (print_columns.cpp).
void print_plane_columns();
void print_axisymmetric_columns();
/// One row of either's table, to share the work among processes.
void print_row_of_columns(bool axisymmetric, double aspect);
void print_deposits();
void print_rods();
void print_fine_columns();
void print_channel();
void print_shipped_columns();
void print_inertial_columns();
void print_round_columns();

}  // namespace tuft::sph::test
