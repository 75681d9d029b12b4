#include "dem_bridge/packing_relaxation.h"

#include <algorithm>
#include <cmath>

#include "core/geometry.h"

namespace tuft::dem {
namespace {

constexpr double pair_share =
    0.8;  ///< of an overlap, removed in one sweep; 1 rings where a sphere has many contacts
constexpr double share_of_drop =
    0.5;  ///< a sphere falls that contacts push by less than this share of the fall
constexpr double skin_share =
    0.3;  ///< of the mean radius: how far spheres may move before lists are made again

/// A regular grid of cells over the box, with items sorted by cell.
class CellGrid {
 public:
  CellGrid(const PackingBox& box, double side) {
    low_ = {-box.half_size[0], -box.half_size[1], box.floor};
    const std::array<double, 3> length{2 * box.half_size[0], 2 * box.half_size[1], box.lid - box.floor};
    for (std::size_t c = 0; c < 3; ++c) {
      count_[c] = std::max(1, static_cast<int>(length[c] / side));
      inverse_[c] = count_[c] / std::max(length[c], 1e-300);
    }
  }
  [[nodiscard]] int coordinate(double x, std::size_t c) const {
    return std::clamp(static_cast<int>((x - low_[c]) * inverse_[c]), 0, count_[c] - 1);
  }
  [[nodiscard]] std::array<int, 3> place(const Vec3& x) const {
    return {coordinate(x.x(), 0), coordinate(x.y(), 1), coordinate(x.z(), 2)};
  }
  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(count_[0]) * count_[1] * count_[2];
  }
  [[nodiscard]] std::size_t cell(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * count_[1] + j) * count_[0] + i;
  }
  /// Calls body(cell) for the cells from `from` to `to`, cut at the grid's edges.
  template <class Body>
  void for_cells(std::array<int, 3> from, std::array<int, 3> to, Body&& body) const {
    for (std::size_t c = 0; c < 3; ++c) {
      from[c] = std::max(from[c], 0);
      to[c] = std::min(to[c], count_[c] - 1);
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j)
        for (int i = from[0]; i <= to[0]; ++i) body(cell(i, j, k));
  }

 private:
  std::array<double, 3> low_{}, inverse_{};
  std::array<int, 3> count_{};
};

/// Variable-length rows in one array.
struct Lists {
  std::vector<std::size_t> begin;  ///< one more than rows
  std::vector<int> items;
  [[nodiscard]] std::span<const int> row(std::size_t i) const {
    return {items.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

/// Rows from (row, item) pairs, kept in the order given within a row.
Lists sort_into_rows(std::size_t rows, const std::vector<std::pair<int, int>>& entries) {
  Lists lists{std::vector<std::size_t>(rows + 1, 0), std::vector<int>(entries.size())};
  for (const auto& [row, item] : entries) ++lists.begin[static_cast<std::size_t>(row) + 1];
  for (std::size_t i = 0; i < rows; ++i) lists.begin[i + 1] += lists.begin[i];
  std::vector<std::size_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (const auto& [row, item] : entries) lists.items[next[static_cast<std::size_t>(row)]++] = item;
  return lists;
}

/// Both directions of every pair closer than `skin`. Each pair is found from its larger sphere, which looks
/// as far as twice its own radius: a small sphere among large ones need not search their reach.
Lists find_spheres(const LooseSpheres& spheres, const PackingBox& box, double skin) {
  const std::size_t count = spheres.radius.size();
  double mean = 0;
  for (double radius : spheres.radius) mean += radius / static_cast<double>(count);
  const CellGrid grid(box, 2 * mean + skin);
  std::vector<std::pair<int, int>> placed;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = grid.place(spheres.position[i]);
    placed.emplace_back(static_cast<int>(grid.cell(a, b, c)), static_cast<int>(i));
  }
  const Lists in_cell = sort_into_rows(grid.cells(), placed);
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 x = spheres.position[i];
    const double own = spheres.radius[i];
    const Vec3 look = Vec3::Constant(2 * own + skin);
    grid.for_cells(grid.place(x - look), grid.place(x + look), [&](std::size_t cell) {
      for (int j : in_cell.row(cell)) {
        const auto other = static_cast<std::size_t>(j);
        if (spheres.radius[other] > own || (spheres.radius[other] == own && other >= i)) continue;
        if (!spheres.group.empty() && spheres.group[other] == spheres.group[i]) continue;
        const double reach = own + spheres.radius[other] + skin;
        if ((x - spheres.position[other]).squaredNorm() >= reach * reach) continue;
        pairs.emplace_back(static_cast<int>(i), j);
        pairs.emplace_back(j, static_cast<int>(i));
      }
    });
  }
  return sort_into_rows(count, pairs);
}

/// Obstacles closer than `skin` to each sphere.
Lists find_obstacles(const LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles,
                     double skin) {
  const std::size_t count = spheres.radius.size();
  const double largest = *std::max_element(spheres.radius.begin(), spheres.radius.end());
  const CellGrid grid(box, largest + skin);
  std::vector<std::pair<int, int>> placed;
  std::vector<Vec3> low(obstacles.size()), high(obstacles.size());
  for (std::size_t q = 0; q < obstacles.size(); ++q) {
    low[q] = high[q] = obstacles[q].corner[0];
    for (const Vec3& corner : obstacles[q].corner) {
      low[q] = low[q].cwiseMin(corner);
      high[q] = high[q].cwiseMax(corner);
    }
    const Vec3 margin = Vec3::Constant(obstacles[q].half_thickness + skin);
    low[q] -= margin;
    high[q] += margin;
    const Vec3 reach = Vec3::Constant(largest);
    grid.for_cells(grid.place(low[q] - reach), grid.place(high[q] + reach), [&](std::size_t cell) {
      placed.emplace_back(static_cast<int>(cell), static_cast<int>(q));
    });
  }
  const Lists in_cell = sort_into_rows(grid.cells(), placed);
  std::vector<std::pair<int, int>> near;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 x = spheres.position[i];
    const auto [a, b, c] = grid.place(x);
    for (int q : in_cell.row(grid.cell(a, b, c))) {
      const auto quad = static_cast<std::size_t>(q);
      const Vec3 nearest = x.cwiseMax(low[quad]).cwiseMin(high[quad]);
      if ((x - nearest).squaredNorm() < spheres.radius[i] * spheres.radius[i])
        near.emplace_back(static_cast<int>(i), q);
    }
  }
  return sort_into_rows(count, near);
}

/// Where contacts push a sphere in one sweep.
struct Push {
  Vec3 shift{0, 0, 0};
  double squeeze = 0;  ///< m, sizes of all pushes: large where they oppose each other
};

/// Takes sphere i's share of every overlap with others.
void push_from_spheres(const LooseSpheres& spheres, std::size_t i, std::span<const int> near, Push& push) {
  const Vec3 x = spheres.position[i];
  for (int j : near) {
    const auto other = static_cast<std::size_t>(j);
    const Vec3 apart = x - spheres.position[other];
    const double sum = spheres.radius[i] + spheres.radius[other];
    const double squared = apart.squaredNorm();
    if (squared >= sum * sum) continue;
    const double distance = std::sqrt(squared);
    // Two centres in one place part along an axis that depends on their order only.
    const Vec3 direction = distance > 1e-12 * sum ? Vec3(apart / distance) : Vec3(0, 0, i < other ? -1 : 1);
    const double size = pair_share * spheres.radius[other] / sum * (sum - distance);
    push.shift += size * direction;
    push.squeeze += size;
  }
}

void push_from_obstacles(const Vec3& x, double radius, std::span<const ThinQuad> obstacles,
                         std::span<const int> near, Push& push) {
  Vec3 shift(0, 0, 0);
  for (int q : near) {
    const ThinQuad& quad = obstacles[static_cast<std::size_t>(q)];
    const FacetPoint closest = closest_point_on_facet(x, quad.corner);
    const double reach = radius + quad.half_thickness, distance = std::sqrt(closest.distance_squared);
    if (distance >= reach) continue;
    Vec3 direction = x - closest.point;
    if (distance > 1e-12 * reach)
      direction /= distance;
    else
      direction = (quad.corner[2] - quad.corner[0]).cross(quad.corner[3] - quad.corner[1]).normalized();
    // Facets of one fibre share edges and push alike: the largest push in a direction counts, not their sum.
    const double wanted = reach - distance - shift.dot(direction);
    if (wanted <= 0) continue;
    shift += wanted * direction;
    push.squeeze += wanted;
  }
  push.shift += shift;
}

double clamp_between(double x, double low, double high) {
  return low > high ? 0.5 * (low + high) : std::clamp(x, low, high);
}

/// Within the walls, by its own radius.
void keep_between_walls(Vec3& x, double radius, const PackingBox& box) {
  if (box.round) {
    const double limit = std::max(0.0, box.half_size[0] - radius), from_axis = std::hypot(x.x(), x.y());
    if (from_axis > limit) x.head<2>() *= limit / from_axis;
    return;
  }
  for (int c = 0; c < 2; ++c) {
    const double limit = box.half_size[static_cast<std::size_t>(c)] - radius;
    x[c] = clamp_between(x[c], -limit, limit);
  }
}

}  // namespace

struct Relaxation::Neighbours {
  Lists spheres, obstacles;  // by sphere
};

Relaxation::Relaxation(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles)
    : spheres_(spheres), box_(box), obstacles_(obstacles), next_(spheres.position) {
  const std::size_t count = spheres.radius.size();
  for (double radius : spheres.radius) mean_radius_ += radius / static_cast<double>(count);
  skin_ = skin_share * mean_radius_;
}

Relaxation::~Relaxation() = default;

void Relaxation::renew_lists() {
  bool renew = near_ == nullptr;
  const std::size_t count = spheres_.radius.size();
  for (std::size_t i = 0; i < count && !renew; ++i)
    renew = (spheres_.position[i] - listed_[i]).squaredNorm() > 0.25 * skin_ * skin_;
  if (!renew) return;
  near_ = std::make_unique<Neighbours>(
      Neighbours{find_spheres(spheres_, box_, skin_), find_obstacles(spheres_, box_, obstacles_, skin_)});
  listed_ = spheres_.position;
}

void Relaxation::sweep(bool in_slabs, double drop, const std::function<void(Vec3Array&)>& constrain) {
  renew_lists();
  const std::size_t count = spheres_.radius.size();
  constexpr std::size_t worth_threads = 4096;
#pragma omp parallel for schedule(static) if (count > worth_threads)
  for (std::size_t i = 0; i < count; ++i) {
    const double radius = spheres_.radius[i];
    Push push;
    push_from_spheres(spheres_, i, near_->spheres.row(i), push);
    push_from_obstacles(spheres_.position[i] + push.shift, radius, obstacles_, near_->obstacles.row(i), push);
    Vec3 x = spheres_.position[i] + push.shift;
    if (push.squeeze < share_of_drop * drop) x.z() -= drop;
    keep_between_walls(x, radius, box_);
    const double low = in_slabs ? spheres_.low[i] : box_.floor, high = in_slabs ? spheres_.high[i] : box_.lid;
    x.z() = std::max(clamp_between(x.z(), low + radius, high - radius), box_.floor + radius);
    next_.set(i, x);
  }
  if (constrain) constrain(next_);
  std::swap(spheres_.position, next_);
}

double Relaxation::depth_in_obstacles(const Vec3& x, double radius) const {
  double deepest = 0;
  for (const ThinQuad& quad : obstacles_) {
    const double reach = radius + quad.half_thickness;
    const double across = (quad.corner[2] - quad.corner[0]).norm() + (quad.corner[3] - quad.corner[1]).norm();
    if ((x - quad.corner[0]).squaredNorm() > (reach + across) * (reach + across)) continue;
    const double squared = closest_point_on_facet(x, quad.corner).distance_squared;
    if (squared < reach * reach) deepest = std::max(deepest, reach - std::sqrt(squared));
  }
  return deepest;
}

double Relaxation::depth_in_obstacles(std::size_t i) {
  renew_lists();
  double deepest = 0;
  for (const int q : near_->obstacles.row(i)) {
    const ThinQuad& quad = obstacles_[static_cast<std::size_t>(q)];
    const double distance =
        std::sqrt(closest_point_on_facet(spheres_.position[i], quad.corner).distance_squared);
    deepest = std::max(deepest, spheres_.radius[i] + quad.half_thickness - distance);
  }
  return deepest;
}

void Relaxation::move(std::size_t i, const Vec3& x) {
  spheres_.position.set(i, x);
  near_ = nullptr;
}

void push_apart(LooseSpheres& spheres, const PackingBox& box, std::span<const ThinQuad> obstacles, int sweeps,
                const std::function<void(Vec3Array&)>& constrain) {
  if (spheres.radius.empty()) return;
  Relaxation relaxation(spheres, box, obstacles);
  for (int sweep = 0; sweep < sweeps; ++sweep) relaxation.sweep(sweep < sweeps / 4, 0, constrain);
}

}  // namespace tuft::dem
