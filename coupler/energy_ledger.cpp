#include "coupler/energy_ledger.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/checkpoint_values.h"
#include "core/error.h"

namespace tuft::coupler {

void EnergyLedger::enter(double time, const EnergyTerms& terms, const std::function<std::string()>& fastest) {
  const auto values = terms.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      throw_run_error("energy term {} is not finite at t = {:.6g} s; {}; reduce numerics.step_safety",
                      EnergyTerms::names[i], time, fastest());
  }
  if (entries_++ == 0) reference_ = terms.balance();
  scale_ = std::max(scale_, terms.kinetic_carpet + terms.kinetic_infill + terms.kinetic_bodies +
                                terms.strain_carpet + terms.stored_infill + terms.contact_elastic);
  const auto before = last_.values();
  last_ = terms;
  error_ = scale_ > 0 ? (terms.balance() - reference_) / scale_ : 0;
  largest_error_ = std::max(largest_error_, std::abs(error_));
  if (std::abs(error_) <= limit_) return;
  std::size_t risen = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    if (std::abs(values[i] - before[i]) > std::abs(values[risen] - before[risen])) risen = i;
  throw_run_error(
      "energy error {:.3g} % passes numerics.energy_error_limit ({:.3g} %) at t = {:.6g} s: term {} changed "
      "most ({:+.4g} J "
      "to {:.4g} J); {}; reduce numerics.step_safety or look at the frames",
      100 * error_, 100 * limit_, time, EnergyTerms::names[risen], values[risen] - before[risen],
      values[risen], fastest());
}

void EnergyLedger::save(h5::Group& group) const {
  const auto values = last_.values();
  group.write("last", std::span<const double>(values));
  const std::vector<double> state{scale_, reference_, error_, largest_error_, static_cast<double>(entries_)};
  group.write("state", std::span<const double>(state));
}

void EnergyLedger::load(const h5::Group& group) {
  const std::vector<double> v = h5::read_checked(group, "last", EnergyTerms::count);
  last_ = {v[0], v[1], v[2],  v[3],  v[4],  v[5],  v[6],  v[7],
           v[8], v[9], v[10], v[11], v[12], v[13], v[14], v[15]};
  const std::vector<double> s = h5::read_checked(group, "state", 5);
  h5::check_whole(group, "state", 4, s[4], {0, h5::most_counted});
  scale_ = s[0];
  reference_ = s[1];
  error_ = s[2];
  largest_error_ = s[3];
  entries_ = static_cast<std::uint64_t>(s[4]);
}

}  // namespace tuft::coupler
