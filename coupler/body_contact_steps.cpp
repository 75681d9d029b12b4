/// What steps contact with bodies bears.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "coupler/body_contact.h"

namespace tuft::coupler {
namespace {

constexpr double tangential_ratio = ContactParameters{}.tangential_ratio;

/// A body that can move meets points at their kicks. It should not notice: so much of what is stable for its
/// mass, and of a point's radius that it closes in, lies between two of them at most.
constexpr double share_of_body = 0.1;

/// Springs, or dashpots, of one point that add up as they stand to each other.
class Together {
 public:
  /// tangential: of a pair, over what it has along its normal.
  explicit Together(double tangential) : tangential_(tangential) {}
  void add(double strength, const Vec3& normal) {
    sum_ += strength;
    along_normals_ += strength * normal * normal.transpose();
  }
  /// In the direction in which they are most: along it normal ones count with the square of its cosine,
  /// tangential ones with what is left.
  [[nodiscard]] double most() const {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(along_normals_, Eigen::EigenvaluesOnly);
    return tangential_ * sum_ + (1 - tangential_) * principal.eigenvalues().maxCoeff();
  }

 private:
  double tangential_, sum_ = 0;
  Eigen::Matrix3d along_normals_ = Eigen::Matrix3d::Zero();
};

}  // namespace

double BodyContact::stiffness_apart(std::size_t point) const {
  // Nothing but the pairs says how far a spring that stiffens is pressed in.
  const auto most = [this](const NormalSpring& spring) {
    return !(spring.stiffening > 0) ? spring.stiffness : searched_ ? 0 : spring.tangent(spring.end);
  };
  const double stiffness = most(settings_.spring[point]);
  return settings_.wall_spring.empty() ? stiffness : std::max(stiffness, most(settings_.wall_spring[point]));
}

void BodyContact::look(const ParticleView& points, const std::vector<RigidBody>& bodies,
                       std::vector<Approach>& approaches) const {
  approaches.resize(keys_.size());
  const auto is_of_next = [this](std::size_t g) {
    return g + 1 < keys_.size() && key_point(keys_[g]) == key_point(keys_[g + 1]);
  };
#pragma omp parallel for schedule(static) if (keys_.size() > least_for_threads)
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    const Index i = key_point(keys_[g]);
    const RigidBody& body = bodies[static_cast<std::size_t>(key_other(keys_[g]))];
    approaches[g] = {.spring = &spring_of(i, body)};
    // A constant spring at the only body near, one at rest, is all that counts.
    const bool alone = !is_of_next(g) && (g == 0 || !is_of_next(g - 1));
    if (alone && !(approaches[g].spring->stiffening > 0) && !body.can_move()) continue;
    const SurfacePoint surface = surface_of(body, points, static_cast<std::size_t>(i));
    const double radius = points.radius_along(static_cast<std::size_t>(i), surface.normal);
    approaches[g].normal = surface.normal;
    approaches[g].overlap = radius - surface.distance;
    approaches[g].closing = -(points.velocity(i) - body.velocity).dot(surface.normal);
    approaches[g].radius = radius;
  }
}

double BodyContact::Approach::stiffness_after(double horizon) const {
  if (!(spring->stiffening > 0)) return spring->stiffness;
  const double coming = overlap + horizon * std::max(0.0, closing);
  return coming > 0 ? spring->tangent(coming) : 0;
}

double BodyContact::step_under(double stiffness, double dashpots, std::size_t point,
                               const ParticleView& points) const {
  if (!(stiffness > 0)) return std::numeric_limits<double>::infinity();
  const double zeta = settings_.damping_ratio[point] * dashpots / std::sqrt(stiffness);
  return 2 * std::sqrt(points.mass[point] / stiffness) * (std::sqrt(1 + zeta * zeta) - zeta);
}

double BodyContact::step_apart(std::size_t point, const ParticleView& points, bool with_dashpots) const {
  // Before the first search a point may be near any three bodies, at right angles.
  const double others = !searched_ && with_dashpots ? 2 : 0, k = stiffness_apart(point);
  return step_under((1 + others * tangential_ratio) * k,
                    with_dashpots ? (1 + others * std::sqrt(tangential_ratio)) * std::sqrt(k) : 0, point,
                    points);
}

template <class Take>
void BodyContact::for_near_points(const ParticleView& points, std::span<const Approach> approaches,
                                  double horizon, bool with_dashpots, Take&& take) const {
  const std::size_t pairs = keys_.size();
#pragma omp parallel for schedule(static) if (pairs > least_for_threads)
  for (std::size_t first = 0; first < pairs; ++first) {  // sorted by point: each goes with its first pair
    const Index i = key_point(keys_[first]);
    if (first > 0 && key_point(keys_[first - 1]) == i) continue;
    const auto point = static_cast<std::size_t>(i);
    double largest = searched_ && all_stiffen_ ? 0 : stiffness_apart(point);
    Together springs(tangential_ratio), dashpots(std::sqrt(tangential_ratio));
    std::size_t g = first;
    for (; g < pairs && key_point(keys_[g]) == i; ++g) {
      const double k = approaches[g].stiffness_after(horizon);
      largest = std::max(largest, k);
      if (!with_dashpots) continue;
      springs.add(k, approaches[g].normal);
      dashpots.add(std::sqrt(k), approaches[g].normal);
    }
    double damping = with_dashpots ? std::sqrt(largest) : 0;
    if (with_dashpots && g - first > 1) {
      largest = std::max(largest, springs.most());
      damping = std::max(damping, dashpots.most());
    }
    take(first, point, step_under(largest, damping, point, points));
  }
}

std::vector<double> BodyContact::stable_steps(const ParticleView& points,
                                              std::span<const Approach> approaches, double horizon,
                                              bool with_dashpots) const {
  std::vector<double> steps(points.size(), std::numeric_limits<double>::infinity());
  if (!searched_ || !all_stiffen_)
    for (std::size_t i = 0; i < points.size(); ++i) steps[i] = step_apart(i, points, with_dashpots);
  for_near_points(points, approaches, horizon, with_dashpots,
                  [&](std::size_t, std::size_t i, double step) { steps[i] = step; });
  return steps;
}

double BodyContact::least_stable_step(const ParticleView& points, std::span<const Approach> approaches,
                                      double horizon, bool with_dashpots) const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity;
  if (!searched_ || !all_stiffen_)
    for (std::size_t i = 0; i < points.size(); ++i)
      least = std::min(least, step_apart(i, points, with_dashpots));
  std::vector<double> near(keys_.size(), infinity);
  for_near_points(points, approaches, horizon, with_dashpots,
                  [&](std::size_t first, std::size_t, double step) { near[first] = step; });
  for (const double step : near) least = std::min(least, step);
  return least;
}

void BodyContact::leave_near(std::vector<double>& steps) const {
  std::vector<double> near(steps.size(), std::numeric_limits<double>::infinity());
  for (const PairKey key : keys_) {
    const auto i = static_cast<std::size_t>(key_point(key));
    near[i] = steps[i];
  }
  steps = std::move(near);
}

void BodyContact::raise_rates(const ParticleView& points, const std::vector<RigidBody>& bodies,
                              std::span<const Approach> approaches, double horizon, bool with_dashpots,
                              double least_beside_moving, std::vector<float>& rates) const {
  for_near_points(points, approaches, horizon, with_dashpots, [&](std::size_t, std::size_t i, double step) {
    rates[i] = std::max(rates[i], static_cast<float>(1 / step));
  });
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (bodies[b].present && bodies[b].can_move())
      raise_beside(static_cast<Index>(b), bodies[b], approaches, horizon, least_beside_moving, rates);
}

void BodyContact::raise_beside(Index number, const RigidBody& body, std::span<const Approach> approaches,
                               double horizon, double least, std::vector<float>& rates) const {
  double stiffness = 0, soonest = 0;
  for (std::size_t g = 0; g < keys_.size(); ++g) {
    if (key_other(keys_[g]) != number) continue;
    const Approach& approach = approaches[g];
    stiffness += approach.stiffness_after(horizon);
    soonest = std::max(soonest, approach.closing / approach.radius);
  }
  // Stable is 2/omega, of all its springs together.
  const double of_mass = 0.5 * std::sqrt(stiffness * body.inverse_mass());
  const auto needed = static_cast<float>(std::max({least, of_mass / share_of_body, soonest / share_of_body}));
  for (const PairKey key : keys_) {
    if (key_other(key) != number) continue;
    float& rate = rates[static_cast<std::size_t>(key_point(key))];
    rate = std::max(rate, needed);
  }
}

}  // namespace tuft::coupler
