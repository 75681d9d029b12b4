#include "sph_infill/separated_pairs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/error.h"

namespace tuft::sph {
namespace {

/// Particles sorted into cells as wide as the reach.
class Cells {
 public:
  Cells(const Vec3Array& positions, double width) : width_(width) {
    const std::array<const std::vector<double>*, 3> component{&positions.x, &positions.y, &positions.z};
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [low, high] = std::minmax_element(component[d]->begin(), component[d]->end());
      low_[d] = *low;
      count_[d] = static_cast<std::size_t>((*high - *low) / width) + 1;
    }
    begin_.assign(count_[0] * count_[1] * count_[2] + 1, 0);
    std::vector<std::size_t> cell(positions.size());
    for (std::size_t i = 0; i < cell.size(); ++i) {
      const Vec3 x = positions[i];
      cell[i] = (along(x.x(), 0) * count_[1] + along(x.y(), 1)) * count_[2] + along(x.z(), 2);
      ++begin_[cell[i] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    particle_.resize(positions.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < cell.size(); ++i) particle_[next[cell[i]]++] = static_cast<Index>(i);
  }

  template <class Visit>
  void for_each_within(const Vec3& low, const Vec3& high, Visit&& visit) const {
    for (std::size_t x = along(low.x(), 0); x <= along(high.x(), 0); ++x)
      for (std::size_t y = along(low.y(), 1); y <= along(high.y(), 1); ++y) {
        const std::size_t column = (x * count_[1] + y) * count_[2];
        for (std::size_t k = begin_[column + along(low.z(), 2)]; k < begin_[column + along(high.z(), 2) + 1];
             ++k)
          visit(particle_[k]);
      }
  }

 private:
  [[nodiscard]] std::size_t along(double value, std::size_t d) const {
    return static_cast<std::size_t>(
        std::clamp(std::floor((value - low_[d]) / width_), 0.0, static_cast<double>(count_[d] - 1)));
  }
  double width_;
  std::array<double, 3> low_{};
  std::array<std::size_t, 3> count_{};
  std::vector<std::uint32_t> begin_;
  std::vector<Index> particle_;
};

/// By which a sheet is taken larger than it is, over the reach: particles at a wall are pressed into it, past
/// the edge of a sheet that ends there.
constexpr double edge = 0.02;

/// Each corner moved outwards from the centre.
Sheet enlarged(const Sheet& sheet, const Vec3& centre, double by) {
  Sheet larger = sheet;
  for (Vec3& corner : larger) corner += std::numbers::sqrt2 * by * (corner - centre).normalized();
  return larger;
}

/// Whether the line from a to b meets the triangle (Moeller & Trumbore 1997), with a margin of rounding so
/// that none passes between the two halves of a sheet.
bool crosses(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, const Vec3& r) {
  constexpr double margin = 1e-9;
  const Vec3 line = b - a, first = q - p, second = r - p, across = line.cross(second);
  const double volume = first.dot(across);
  if (volume == 0) return false;  // parallel
  const Vec3 from = a - p, along = from.cross(first);
  const double u = from.dot(across) / volume, v = line.dot(along) / volume, t = second.dot(along) / volume;
  return u >= -margin && v >= -margin && u + v <= 1 + margin && t >= 0 && t <= 1;
}

using Pair = std::array<Index, 2>;  ///< lower index first

/// Axes of a sheet and the box about its corners in them; m.
struct SheetBox {
  Vec3 centre, along, across, normal;
  double half_length = 0, half_width = 0, half_warp = 0;

  SheetBox(const Sheet& sheet, const Vec3& middle) : centre(middle) {
    const Vec3 diagonal = sheet[2] - sheet[0];
    normal = diagonal.cross(sheet[3] - sheet[1]).normalized();
    along = sheet[1] + sheet[2] - sheet[0] - sheet[3];
    along = (along - normal.dot(along) * normal).normalized();
    across = normal.cross(along);
    for (const Vec3& corner : sheet) {
      const Vec3 from = corner - centre;
      half_length = std::max(half_length, std::abs(along.dot(from)));
      half_width = std::max(half_width, std::abs(across.dot(from)));
      half_warp = std::max(half_warp, std::abs(normal.dot(from)));
    }
  }
};

/// Particles on one side of a sheet, in its axes; height: m from the plane it lies about, not negative.
struct Side {
  std::vector<double> along, across, height;
  std::vector<Index> particle;

  void clear() { along.clear(), across.clear(), height.clear(), particle.clear(); }
  void add(double a, double b, double h, Index i) {
    along.push_back(a), across.push_back(b), height.push_back(h), particle.push_back(i);
  }
};

/// What one thread needs for the pairs of a sheet.
struct Sides {
  Side above, below;
  std::vector<std::uint8_t> may_cross;
};

/// Particles that may be nearer to another across the sheet than `reach`: nearer to the sheet's box.
void gather(const Vec3Array& positions, const Cells& cells, const SheetBox& box, double reach, Sides& sides) {
  sides.above.clear();
  sides.below.clear();
  const double around = std::hypot(box.half_length, box.half_width, box.half_warp);
  const Vec3 range = Vec3::Constant(around + reach);
  cells.for_each_within(box.centre - range, box.centre + range, [&](Index i) {
    const Vec3 from = positions[static_cast<std::size_t>(i)] - box.centre;
    const double a = box.along.dot(from), b = box.across.dot(from), h = box.normal.dot(from);
    const double beyond_a = std::max(0.0, std::abs(a) - box.half_length),
                 beyond_b = std::max(0.0, std::abs(b) - box.half_width),
                 beyond_h = std::max(0.0, std::abs(h) - box.half_warp);
    if (beyond_a * beyond_a + beyond_b * beyond_b + beyond_h * beyond_h > reach * reach * (1 + 1e-9)) return;
    (h >= 0 ? sides.above : sides.below).add(a, b, std::abs(h), i);
  });
}

/// For one particle above, which of those below are within reach and their line to it passes through the
/// sheet's box: all that cross the sheet, and few others.
void mark_crossing(const SheetBox& box, double a, double b, double h, double reach, Sides& sides) {
  const Side& below = sides.below;
  const std::size_t n = below.particle.size();
  // Rounding is to leave none out: the exact test follows.
  const double squared_reach = reach * reach * (1 + 1e-9);
  const double slack = 1e-6 * reach, length = box.half_length + slack, width = box.half_width + slack,
               warp = box.half_warp + slack;
  const double *ba = below.along.data(), *bb = below.across.data(), *bh = below.height.data();
  std::uint8_t* mark = sides.may_cross.data();
#pragma omp simd
  for (std::size_t k = 0; k < n; ++k) {
    const double da = ba[k] - a, db = bb[k] - b, dh = h + bh[k];
    // Shares of the way at which the line enters and leaves the box's range of heights.
    const double inverse = 1 / (dh + 1e-300), enter = std::max(0.0, (h - warp) * inverse),
                 leave = std::min(1.0, (h + warp) * inverse);
    const double a0 = a + enter * da, a1 = a + leave * da, b0 = b + enter * db, b1 = b + leave * db;
    const bool within = da * da + db * db + dh * dh < squared_reach;
    const bool meets = (std::min(a0, a1) <= length) & (std::max(a0, a1) >= -length) &
                       (std::min(b0, b1) <= width) & (std::max(b0, b1) >= -width);
    mark[k] = static_cast<std::uint8_t>(within & meets);
  }
}

/// Adds the pairs whose line of centres crosses one sheet.
void find_across(const Vec3Array& positions, const Cells& cells, const Sheet& given, double reach,
                 Sides& sides, std::vector<Pair>& found) {
  const Vec3 centre = 0.25 * (given[0] + given[1] + given[2] + given[3]);
  const Sheet sheet = enlarged(given, centre, edge * reach);
  const SheetBox box(sheet, centre);
  gather(positions, cells, box, reach, sides);
  const Side &above = sides.above, &below = sides.below;
  sides.may_cross.resize(below.particle.size());
  for (std::size_t k = 0; k < above.particle.size(); ++k) {
    mark_crossing(box, above.along[k], above.across[k], above.height[k], reach, sides);
    const Index i = above.particle[k];
    const Vec3 a = positions[static_cast<std::size_t>(i)];
    for (std::size_t m = 0; m < below.particle.size(); ++m) {
      if (!sides.may_cross[m]) continue;
      const Index j = below.particle[m];
      const Vec3 b = positions[static_cast<std::size_t>(j)];
      if ((b - a).squaredNorm() >= reach * reach) continue;
      if (crosses(a, b, sheet[0], sheet[1], sheet[2]) || crosses(a, b, sheet[0], sheet[2], sheet[3]))
        found.push_back({std::min(i, j), std::max(i, j)});
    }
  }
}

}  // namespace

SeparatedPairs::SeparatedPairs(const Vec3Array& positions, std::span<const Sheet> sheets, double reach) {
  if (positions.size() == 0 || sheets.empty()) return;
  const Cells cells(positions, reach);
  std::vector<Pair> pairs;
#pragma omp parallel
  {
    Sides sides;
    std::vector<Pair> found;
#pragma omp for schedule(dynamic, 16) nowait
    for (std::size_t s = 0; s < sheets.size(); ++s)
      find_across(positions, cells, sheets[s], reach, sides, found);
      // In any order: they are sorted afterwards.
#pragma omp critical
    pairs.insert(pairs.end(), found.begin(), found.end());
  }
  list(pairs, positions.size());
}

SeparatedPairs::SeparatedPairs(std::span<const double> values, std::size_t count) {
  std::vector<Pair> pairs;
  for (std::size_t k = 0; k + 1 < values.size(); k += 2)
    pairs.push_back({static_cast<Index>(values[k]), static_cast<Index>(values[k + 1])});
  list(pairs, count);
}

void SeparatedPairs::list(std::vector<Pair>& pairs, std::size_t count) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  if (pairs.empty()) return;
  begin_.assign(count + 1, 0);
  for (const Pair& pair : pairs)
    for (const Index i : pair) ++begin_[static_cast<std::size_t>(i) + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  partner_.resize(2 * pairs.size());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  // Lower partners first, then higher ones, each in order: rows come out sorted.
  for (const auto& [low, high] : pairs) partner_[next[static_cast<std::size_t>(high)]++] = low;
  for (const auto& [low, high] : pairs) partner_[next[static_cast<std::size_t>(low)]++] = high;
}

std::vector<double> SeparatedPairs::values() const {
  std::vector<double> values;
  for (std::size_t i = 0; i + 1 < begin_.size(); ++i)
    for (const Index j : of(i))
      if (static_cast<std::size_t>(j) > i) {
        values.push_back(static_cast<double>(i));
        values.push_back(static_cast<double>(j));
      }
  return values;
}

}  // namespace tuft::sph
