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

/// What one thread needs for the pairs of a sheet.
struct Sides {
  struct Point {
    Vec3 position;
    double height;  ///< m from the plane that a warped sheet lies about
    Index particle;
  };
  std::vector<Point> above, below;
};

/// Adds the pairs whose line of centres crosses one sheet.
void find_across(const Vec3Array& positions, const Cells& cells, const Sheet& given, double reach,
                 Sides& sides, std::vector<Pair>& found) {
  const Vec3 centre = 0.25 * (given[0] + given[1] + given[2] + given[3]);
  const Sheet sheet = enlarged(given, centre, edge * reach);
  const Vec3 normal = (sheet[2] - sheet[0]).cross(sheet[3] - sheet[1]).normalized();
  double around = 0;
  for (const Vec3& corner : sheet) around = std::max(around, (corner - centre).norm());
  sides.above.clear();
  sides.below.clear();
  const double farthest = (around + reach) * (around + reach);
  const Vec3 range = Vec3::Constant(around + reach);
  cells.for_each_within(centre - range, centre + range, [&](Index i) {
    const Vec3 x = positions[static_cast<std::size_t>(i)];
    const double height = normal.dot(x - centre);
    if (std::abs(height) > reach || (x - centre).squaredNorm() > farthest) return;
    (height >= 0 ? sides.above : sides.below).push_back({x, std::abs(height), i});
  });
  for (const auto& [a, above, i] : sides.above)
    for (const auto& [b, below, j] : sides.below) {
      const Vec3 line = b - a;
      const double squared = line.squaredNorm();
      if (above + below > reach || squared >= reach * reach) continue;
      // A line that meets the sheet passes its centre no farther away than its corners are.
      if ((centre - a).cross(line).squaredNorm() > around * around * squared) continue;
      if (crosses(a, b, sheet[0], sheet[1], sheet[2]) || crosses(a, b, sheet[0], sheet[2], sheet[3]))
        found.push_back({std::min(i, j), std::max(i, j)});
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
