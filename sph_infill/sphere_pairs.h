#pragma once
/// Pairs of spheres that may touch, each held once with what it remembers, and their forces.
#include <span>
#include <vector>

#include "core/hdf5_file.h"
#include "sph_infill/neighbour_list.h"
#include "sph_infill/sphere_contact.h"

namespace tuft::sph {

/// What the pair law needs of each sphere.
struct SphereView {
  const Vec3Array& position;          ///< m
  const Vec3Array& velocity;          ///< m/s
  const Vec3Array& spin;              ///< rad/s
  const std::vector<double>& radius;  ///< m
  const std::vector<double>& mass;    ///< kg
  const std::vector<double>& damping_ratio;
};

struct SphereLaw {
  double modulus = 0;   ///< Pa: a pair's stiffness is modulus x (r_i + r_j), so that a pressure p overlaps
                        ///< them by p/modulus
  double friction = 0;  ///< >= 0
};

/// Energies of springs, J, and the largest overlap over the sum of the radii.
struct PairSums {
  double normal = 0, tangential = 0, largest_overlap = 0;
};

/// Force and torque that a sphere feels from all others.
struct SphereLoad {
  Vec3 spring{0, 0, 0}, other{0, 0, 0};  ///< N
  Vec3 torque{0, 0, 0};                  ///< N m about the centre, of `other`: springs push through it
};

/// A pair belongs to the sphere of the lower index. Forces are computed once a pair and gathered by both
/// spheres, in the order of indices: momentum is kept to rounding, and nothing depends on threads or on when
/// the list was made.
class SpherePairs {
 public:
  SpherePairs() = default;
  /// skin: m, how much farther than touching the list looks.
  SpherePairs(const SphereView& spheres, double skin);

  /// Makes the list anew; pairs that stay keep their slip.
  void list(const SphereView& spheres);
  /// While no sphere has moved farther than this since, no contact is missed.
  [[nodiscard]] double allowed_displacement() const { return list_.allowed_displacement(); }

  /// Forces at t_k; step_before: s, of the drift that led there.
  PairSums evaluate(const SphereLaw& law, const SphereView& spheres, double step_before);
  [[nodiscard]] SphereLoad load_on(std::size_t i, double radius) const;
  /// Stress that pair forces make in a sphere's share of space, sum_c r_i n (x) F / volume, Pa, compression
  /// positive.
  [[nodiscard]] Mat3 stress_in(std::size_t i, const SphereView& spheres, double volume) const;
  /// Largest of 2 sum_c k_c/m_i over the spheres, at least six contacts counted: bounds omega^2, see
  /// SphereInfill::stable_step.
  [[nodiscard]] double frequency_squared(const SphereLaw& law, const SphereView& spheres) const;
  [[nodiscard]] std::size_t touching() const;

  void save(h5::Group& group) const;
  /// Throws RunError when the file holds pairs that `spheres` has not.
  void load(const h5::Group& group, const SphereView& spheres);

 private:
  struct PairForce {
    Vec3 spring{0, 0, 0}, other{0, 0, 0};
    Vec3 turn{0, 0, 0};  ///< n x other: both spheres feel -r of it as torque
    bool touching = false;
  };
  /// Calls visit(slot, sign, other sphere) over the pairs of sphere i by rising index; sign -1: i is the
  /// second.
  template <class Visit>
  void for_pairs_of(std::size_t i, Visit&& visit) const;

  NeighbourList list_;
  std::vector<std::size_t> begin_;  ///< pairs of sphere i as the first are [begin_[i], begin_[i+1])
  std::vector<Index> first_, second_;
  std::vector<std::size_t> mirror_begin_;  ///< and as the second, slots mirror_[...]
  std::vector<std::uint32_t> mirror_;
  Vec3Array slip_;  ///< m
  std::vector<PairForce> force_;
  std::vector<PairSums> blocks_;
};

template <class Visit>
void SpherePairs::for_pairs_of(std::size_t i, Visit&& visit) const {
  for (std::size_t k = mirror_begin_[i]; k < mirror_begin_[i + 1]; ++k)
    visit(mirror_[k], -1.0, static_cast<std::size_t>(first_[mirror_[k]]));
  for (std::size_t k = begin_[i]; k < begin_[i + 1]; ++k) visit(k, 1.0, static_cast<std::size_t>(second_[k]));
}

}  // namespace tuft::sph
