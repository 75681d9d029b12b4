#include "sph_infill/sphere_placing.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "sph_infill/neighbour_list.h"

namespace tuft::sph {
namespace {

constexpr double largest_offset = 0.1;  // of the diameter, along each axis
constexpr double tolerance = 1e-4;      // of the sum of the radii
constexpr double relaxation =
    0.6;  // of half the overlap: whole steps of many neighbours at once would overshoot
constexpr int most_sweeps = 5000;

/// [-1, 1), the same on every machine.
double symmetric(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11U) * 0x1.0p-52 - 1;
}

class Placer {
 public:
  Placer(const Lattice& lattice, const PlacingRequest& request) : request_(request), x_(lattice.position) {
    std::mt19937_64 engine(request.seed);
    for (std::size_t i = 0; i < size(); ++i) {
      const double reach = largest_offset * 2 * radius(i);
      const double dx = reach * symmetric(engine), dy = reach * symmetric(engine),
                   dz = reach * symmetric(engine);
      x_.set(i, inside(i, x_[i] + Vec3(dx, dy, dz)));
    }
    const double largest = *std::max_element(request.sphere_radius.begin(), request.sphere_radius.end());
    list_ = NeighbourList(x_, 2 * largest, 0.5 * largest);
    list_rows();
  }

  Placing place() {
    Placing result;
    for (double largest = 1; largest > tolerance; ++result.sweeps) {
      if (result.sweeps == most_sweeps)
        throw_run_error(
            "spheres of conditioning still overlap by {:.2g} of their diameter after {} sweeps: make "
            "conditioning.sphere_diameter smaller",
            largest, most_sweeps);
      largest = sweep();
      result.largest_overlap = largest;
    }
    result.position = std::move(x_);
    return result;
  }

 private:
  [[nodiscard]] std::size_t size() const { return request_.sphere_radius.size(); }
  [[nodiscard]] double radius(std::size_t i) const { return request_.sphere_radius[i]; }

  [[nodiscard]] Vec3 inside(std::size_t i, Vec3 x) const {
    const double wall = request_.wall_radius[i];
    for (int d = 0; d < 2; ++d) {
      const double most = 0.5 * request_.box.size[static_cast<std::size_t>(d)] - wall;
      x[d] = std::clamp(x[d], -most, most);
    }
    x.z() = std::max(x.z(), request_.box.floor + wall);
    return x;
  }

  void list_rows() {
    list_.build(x_);
    listed_ = x_;
    begin_.assign(1, 0);
    neighbour_.clear();
    for (std::size_t i = 0; i < size(); ++i) {
      const std::vector<Index> row = list_.row(i);
      neighbour_.insert(neighbour_.end(), row.begin(), row.end());
      begin_.push_back(neighbour_.size());
    }
  }

  /// Returns the largest overlap before it, over the sum of the radii.
  double sweep() {
    std::vector<double> overlap(size(), 0), moved(size(), 0);
    Vec3Array next = x_;
    parallel_for(size(), [&](std::size_t i) {
      Vec3 push(0, 0, 0);
      for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) {
        const auto j = static_cast<std::size_t>(neighbour_[k]);
        const Vec3 apart = x_[i] - x_[j];
        const double reach = radius(i) + radius(j), distance = apart.norm();
        if (!(distance < reach) || distance == 0) continue;
        push += (0.5 * relaxation * (reach - distance) / distance) * apart;
        overlap[i] = std::max(overlap[i], (reach - distance) / reach);
      }
      next.set(i, inside(i, x_[i] + push));
      moved[i] = (next[i] - listed_[i]).norm();
    });
    x_ = std::move(next);
    if (*std::max_element(moved.begin(), moved.end()) > 0.9 * list_.allowed_displacement()) list_rows();
    return *std::max_element(overlap.begin(), overlap.end());
  }

  const PlacingRequest& request_;
  Vec3Array x_, listed_;
  NeighbourList list_;
  std::vector<std::size_t> begin_;
  std::vector<Index> neighbour_;
};

}  // namespace

Placing place_spheres(const Lattice& lattice, const PlacingRequest& request) {
  if (request.sphere_radius.size() != lattice.position.size() ||
      request.wall_radius.size() != lattice.position.size())
    throw_run_error("placing spheres: {} and {} radii for {} particles", request.sphere_radius.size(),
                    request.wall_radius.size(), lattice.position.size());
  if (lattice.position.size() == 0) throw_input_error("SPH infill has no particles");
  return Placer(lattice, request).place();
}

}  // namespace tuft::sph
