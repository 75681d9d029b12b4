#include "fe_carpet/mass_scaling.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fe_carpet/element_arrays.h"

namespace tuft::fe {
namespace {

struct Swinging {
  double frequency_squared;  ///< 1/s^2, bound of the element alone
  std::size_t slot;
};

/// Stiffest first; equal ones in the order of the mesh.
std::vector<Swinging> stiffest_first(const ElementArrays& elements, const Vec3Array& position) {
  std::vector<Swinging> all;
  for (std::size_t batch = 0; batch < elements.batch_count; ++batch) {
    const Pack bound = batch_frequency_squared(elements, position, batch);
    for (std::size_t lane = 0; lane < lanes; ++lane)
      if (elements.element[batch * lanes + lane] >= 0) all.push_back({bound[lane], batch * lanes + lane});
  }
  std::sort(all.begin(), all.end(), [&](const Swinging& a, const Swinging& b) {
    if (a.frequency_squared != b.frequency_squared) return a.frequency_squared > b.frequency_squared;
    return elements.element[a.slot] < elements.element[b.slot];
  });
  return all;
}

}  // namespace

MassScaling scale_masses(ElementArrays& elements, const Vec3Array& position, double limit) {
  MassScaling result;
  result.limit = limit;
  if (limit == 0) return result;
  const std::vector<Swinging> all = stiffest_first(elements, position);
  for (const Swinging& e : all) result.true_mass += elements.mass[e.slot];
  result.step_before = result.step_after = 2 / std::sqrt(all.front().frequency_squared);

  // To bring the k stiffest down to the frequency w, sum m_e (w_e^2 / w^2 - 1) must be added. This rises as w
  // falls, so the k are those whose own frequency is above the w that uses up what is allowed. A hair less,
  // so that rounding does not pass the limit.
  const double allowed = limit * result.true_mass * (1 - 1e-12);
  double stiffness = 0, mass = 0, target = all.front().frequency_squared;
  for (std::size_t k = 0; k < all.size(); ++k) {
    stiffness += elements.mass[all[k].slot] * all[k].frequency_squared;
    mass += elements.mass[all[k].slot];
    target = stiffness / (allowed + mass);
    if (k + 1 < all.size() && target >= all[k + 1].frequency_squared) break;
  }
  elements.true_mass = elements.mass;
  for (const Swinging& e : all) {
    if (e.frequency_squared <= target) break;
    const double before = elements.mass[e.slot];
    elements.mass[e.slot] = before * (e.frequency_squared / target);
    result.added_mass += elements.mass[e.slot] - before;
    ++result.elements;
  }
  result.step_after = 2 / std::sqrt(target);
  return result;
}

}  // namespace tuft::fe
