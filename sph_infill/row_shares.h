#pragma once
/// What part of its cell a particle of a bed strains itself.
///
/// The lowest and the uppermost rows lie half a row off the floor and off what presses on the surface, and
/// the half row between is a spring of contact (docs/theory/contact.md). Gradients of these rows are those of
/// whole cells, so that the energy of the half rows would be counted twice: n rows between two plates would
/// be too stiff by 0.6/n, and the outermost would carry half the stress. Shares of the cells' energy take it
/// back. They are those for which a uniform stress leaves every row in equilibrium but the outermost, and
/// these with its whole force; of all such the nearest to one. Rows may be of unlike thickness, as those of
/// layers are.
#include <array>
#include <span>
#include <vector>

#include "core/scene.h"

namespace tuft::sph {

/// Largest difference of a share from one. (0.57 in the beds of inputs/.)
inline constexpr double most_share_change = 0.8;

/// place: of the rows, m, ascending; thickness: m, > 0; across: spacings in their plane, m. One share a row.
/// Fewer than three rows have shares of one.
[[nodiscard]] std::vector<double> row_shares(std::span<const double> place, std::span<const double> thickness,
                                             std::array<double, 2> across, const SphOptions& options);

}  // namespace tuft::sph
