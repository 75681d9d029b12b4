#include "sph_infill/sphere_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/checkpoint_values.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

double bond_stiffness(const SphereLaw& law, const SphereView& s, std::size_t i, std::size_t j) {
  return law.modulus * (s.radius[i] + s.radius[j]);
}

}  // namespace

SpherePairs::SpherePairs(const SphereView& spheres, double skin)
    : list_(spheres.position, 2 * *std::max_element(spheres.radius.begin(), spheres.radius.end()), skin) {
  list(spheres);
}

void SpherePairs::list(const SphereView& spheres) {
  const std::size_t n = spheres.mass.size();
  list_.build(spheres.position);
  std::vector<std::size_t> begin{0};
  std::vector<Index> first, second;
  Vec3Array slip;
  std::size_t old = 0;  // both lists rise by first and second sphere
  for (std::size_t i = 0; i < n; ++i) {
    for (const Index j : list_.row(i)) {
      if (static_cast<std::size_t>(j) <= i) continue;
      const auto before = [&](std::size_t k) {
        return static_cast<std::size_t>(first_[k]) < i ||
               (static_cast<std::size_t>(first_[k]) == i && second_[k] < j);
      };
      while (old < first_.size() && before(old)) ++old;
      const bool kept =
          old < first_.size() && static_cast<std::size_t>(first_[old]) == i && second_[old] == j;
      slip.push_back(kept ? slip_[old] : Vec3(0, 0, 0));
      first.push_back(static_cast<Index>(i));
      second.push_back(j);
    }
    begin.push_back(first.size());
  }
  begin_ = std::move(begin), first_ = std::move(first), second_ = std::move(second), slip_ = std::move(slip);
  force_.assign(first_.size(), {});
  blocks_.resize((n + block_size - 1) / block_size);

  mirror_begin_.assign(n + 1, 0);
  for (const Index j : second_) ++mirror_begin_[static_cast<std::size_t>(j) + 1];
  for (std::size_t i = 0; i < n; ++i) mirror_begin_[i + 1] += mirror_begin_[i];
  mirror_.resize(second_.size());
  std::vector<std::size_t> next(mirror_begin_.begin(), mirror_begin_.end() - 1);
  for (std::size_t k = 0; k < second_.size(); ++k)
    mirror_[next[static_cast<std::size_t>(second_[k])]++] = static_cast<std::uint32_t>(k);
}

PairSums SpherePairs::evaluate(const SphereLaw& law, const SphereView& s, double step_before) {
  for_blocks(s.mass.size(), nullptr, [&](std::size_t b, std::size_t begin, std::size_t end) {
    PairSums& sums = blocks_[b] = {};
    for (std::size_t k = begin_[begin]; k < begin_[end]; ++k) {
      const auto i = static_cast<std::size_t>(first_[k]), j = static_cast<std::size_t>(second_[k]);
      const Vec3 apart = s.position[i] - s.position[j];
      const double reach = s.radius[i] + s.radius[j], squared = apart.squaredNorm();
      if (!(squared < reach * reach)) {
        slip_.set(k, {0, 0, 0});
        force_[k] = {};
        continue;
      }
      const double distance = std::sqrt(squared), overlap = reach - distance;
      const Vec3 normal = apart / distance;
      const double stiffness = bond_stiffness(law, s, i, j),
                   mass = s.mass[i] * s.mass[j] / (s.mass[i] + s.mass[j]),
                   damping = s.damping_ratio[i] + s.damping_ratio[j];  // twice the mean
      const SphereBond bond{stiffness, damping * std::sqrt(stiffness * mass), law.friction};
      const Vec3 turning = s.radius[i] * s.spin[i] + s.radius[j] * s.spin[j];
      Vec3 slip = slip_[k];
      const SphereForce f = sphere_force(
          bond, {overlap, normal, s.velocity[i] - s.velocity[j] - turning.cross(normal), step_before}, slip);
      slip_.set(k, slip);
      force_[k] = {f.spring, f.other, normal.cross(f.other), true};
      sums.normal += f.normal_energy;
      sums.tangential += f.tangential_energy;
      sums.largest_overlap = std::max(sums.largest_overlap, overlap / reach);
    }
  });
  PairSums sum;
  for (const PairSums& block : blocks_) {
    sum.normal += block.normal;
    sum.tangential += block.tangential;
    sum.largest_overlap = std::max(sum.largest_overlap, block.largest_overlap);
  }
  return sum;
}

SphereLoad SpherePairs::load_on(std::size_t i, double radius) const {
  SphereLoad load;
  Vec3 turn(0, 0, 0);
  for_pairs_of(i, [&](std::size_t k, double sign, std::size_t) {
    const PairForce& f = force_[k];
    if (!f.touching) return;
    load.spring += sign * f.spring;
    load.other += sign * f.other;
    turn += f.turn;
  });
  load.torque = -radius * turn;
  return load;
}

Mat3 SpherePairs::stress_in(std::size_t i, const SphereView& s, double volume) const {
  Mat3 stress = Mat3::Zero();
  for_pairs_of(i, [&](std::size_t k, double sign, std::size_t j) {
    const PairForce& f = force_[k];
    if (!f.touching) return;
    const Vec3 normal = (s.position[i] - s.position[j]).normalized();
    stress += (s.radius[i] / volume) * normal * (sign * (f.spring + f.other)).transpose();
  });
  return stress;
}

double SpherePairs::frequency_squared(const SphereLaw& law, const SphereView& s) const {
  constexpr int least_contacts = 6;
  std::vector<double> largest(blocks_.size(), 0);
  for_blocks(s.mass.size(), nullptr, [&](std::size_t b, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = 0;
      for_pairs_of(i, [&](std::size_t, double, std::size_t j) {
        const double reach = s.radius[i] + s.radius[j];
        if ((s.position[i] - s.position[j]).squaredNorm() < reach * reach)
          sum += bond_stiffness(law, s, i, j);
      });
      sum = std::max(sum, least_contacts * bond_stiffness(law, s, i, i));
      largest[b] = std::max(largest[b], 2 * sum / s.mass[i]);
    }
  });
  return *std::max_element(largest.begin(), largest.end());
}

std::size_t SpherePairs::touching() const {
  return static_cast<std::size_t>(
      std::count_if(force_.begin(), force_.end(), [](const PairForce& f) { return f.touching; }));
}

void SpherePairs::save(h5::Group& group) const {
  std::vector<std::int32_t> pairs;
  std::vector<double> slips, forces;
  for (std::size_t k = 0; k < first_.size(); ++k) {
    const Vec3 slip = slip_[k];
    const PairForce& force = force_[k];
    if (slip.isZero(0) && !force.touching) continue;
    pairs.insert(pairs.end(), {first_[k], second_[k]});
    slips.insert(slips.end(), slip.data(), slip.data() + 3);
    for (const Vec3& part : {force.spring, force.other})
      forces.insert(forces.end(), part.data(), part.data() + 3);
  }
  group.write("pairs", std::span<const std::int32_t>(pairs));
  group.write("slips", std::span<const double>(slips));
  group.write("forces", std::span<const double>(forces));
}

void SpherePairs::load(const h5::Group& group, const SphereView& spheres) {
  const auto last = static_cast<double>(spheres.mass.size()) - 1;
  const std::vector<double> pairs = h5::read_all_whole(group, "pairs", {0, last});
  if (pairs.size() % 2 != 0)
    h5::refuse(group, "pairs", fmt::format("holds {} values, which are no pairs", pairs.size()));
  const std::vector<double> slips = h5::read_checked(group, "slips", pairs.size() / 2 * 3);
  // For whoever looks before the next evaluation; versions before did not save them.
  const std::vector<double> forces = group.has("forces")
                                         ? h5::read_checked(group, "forces", pairs.size() / 2 * 6)
                                         : std::vector<double>(pairs.size() / 2 * 6, 0.0);
  list(spheres);
  slip_.assign(first_.size(), 0);
  for (std::size_t p = 0; 2 * p < pairs.size(); ++p) {
    const auto i = static_cast<std::size_t>(pairs[2 * p]);
    const auto j = static_cast<Index>(pairs[2 * p + 1]);
    const auto row = [&](std::size_t k) { return second_.begin() + static_cast<std::ptrdiff_t>(begin_[k]); };
    const auto found = std::lower_bound(row(i), row(i + 1), j);
    if (found == row(i + 1) || *found != j)
      h5::refuse(group, "pairs",
                 fmt::format("[{}] and [{}] are spheres {} and {}, which are too far apart to touch", 2 * p,
                             2 * p + 1, i, j));
    const auto k = static_cast<std::size_t>(found - second_.begin());
    slip_.set(k, Vec3(slips[3 * p], slips[3 * p + 1], slips[3 * p + 2]));
    const double* f = &forces[6 * p];
    PairForce& force = force_[k];
    force.spring = Vec3(f[0], f[1], f[2]), force.other = Vec3(f[3], f[4], f[5]);
    force.touching = !force.spring.isZero(0);
    force.turn =
        (spheres.position[i] - spheres.position[static_cast<std::size_t>(j)]).normalized().cross(force.other);
  }
}

}  // namespace tuft::sph
