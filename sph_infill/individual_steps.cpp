#include "sph_infill/individual_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "sph_infill/particle_packs.h"

namespace tuft::sph {
namespace {

/// A neighbour's period is at most so many times as long: a wave meets no step much too coarse for it
/// (Saitoh & Makino 2009, ApJ 697, L99: 4).
constexpr int largest_ratio = 4;

/// Each group's value and those of its neighbours: the smallest. Pairs are symmetric, so groups may hand
/// their values to their neighbours instead of asking them; and those above `largest`, most of a bed, need
/// not. Each thread has values of its own, and the smallest does not depend on who finds it.
std::vector<std::uint8_t> smallest_around(const NeighbourList& list, const std::vector<std::uint8_t>& values,
                                          std::uint8_t largest) {
  std::vector<std::uint8_t> smallest = values;
#pragma omp parallel
  {
    std::vector<std::uint8_t> mine = values;
#pragma omp for schedule(static)
    for (std::size_t g = 0; g < values.size(); ++g) {
      if (values[g] > largest) continue;
      for (const Index near : list.groups_near(g)) {
        std::uint8_t& other = mine[static_cast<std::size_t>(near)];
        other = std::min(other, values[g]);
      }
    }
#pragma omp critical
    for (std::size_t g = 0; g < values.size(); ++g) smallest[g] = std::min(smallest[g], mine[g]);
  }
  return smallest;
}

/// Inverse of the shortest stable step of the particles of a group and of all in their rows, 1/s.
float rate_around(const NeighbourList& list, const Particles& p, std::size_t group) {
  const auto own = entries_of_group(group, p.size());
  const auto of = [&](const RowEntry* entries) {
    return SinglePack([&](std::size_t l) { return p.own_step[entries[l].index()]; });
  };
  const NeighbourList::GroupRows rows = list.group(group);
  SinglePack shortest = of(own.data());
  for (std::size_t k = 0; k < rows.length; ++k)
    shortest = stdx::min(shortest, of(rows.first + k * group_size));
  return 1 / stdx::hmin(shortest);
}

}  // namespace

IndividualSteps::IndividualSteps(int largest, double safety, std::size_t particles)
    : largest_(largest), safety_(safety), particles_(particles) {
  if (largest < 1 || largest > most || (largest & (largest - 1)) != 0)
    throw_input_error("numerics.individual_steps is {}; it must be 1, 2, 4, 8 or {}", largest, most);
  if (!enabled()) return;
  const std::size_t count = (particles + group_size - 1) / group_size;
  for (auto* values : {&period_, &kick_period_, &pace_}) values->assign(count, 1);
  steps_since_kick_.assign(count, 0);
  due_.assign(count, strained | kicked);
  for (auto* values : {&own_rate_, &rate_, &contact_rate_}) values->assign(count, 0);
  for (auto* values : {&since_kick_, &planned_, &since_strain_, &kick_length_, &kick_lag_})
    values->assign(count, 0);
}

int IndividualSteps::period_of(std::size_t particle) const {
  return enabled() ? period_[particle / group_size] : 1;
}

int IndividualSteps::longest_period_of(std::size_t first, std::size_t end) const {
  if (!enabled()) return 1;
  const auto of = [&](std::size_t particle) {
    return period_.begin() + static_cast<std::ptrdiff_t>(particle / group_size);
  };
  return *std::max_element(of(first), of(end + group_size - 1));
}

std::size_t IndividualSteps::kicked_particles(std::size_t first, std::size_t end) const {
  std::size_t count = 0;
  for (; first < end; first += group_size)
    if (is_kicked(first / group_size)) count += std::min(group_size, end - first);
  return count;
}

void IndividualSteps::set_contact_rates(std::span<const float> rates) {
  if (!enabled()) return;
  parallel_for(groups(), [&](std::size_t g) {
    float largest = 0;
    for (std::size_t i = g * group_size; i < std::min(particles_, (g + 1) * group_size); ++i)
      largest = std::max(largest, rates[i]);
    contact_rate_[g] = largest;
  });
}

void IndividualSteps::choose(const NeighbourList& list, const Particles& p, double dt) {
  parallel_for(groups(), [&](std::size_t g) {
    rate_[g] = rate_around(list, p, g);
    period_[g] = longest_period(g, dt);
  });
  limit_ratios(list);
  keep_pace(list);
  cycle_ = *std::max_element(period_.begin(), period_.end());
  since_chosen_ = 0;
}

void IndividualSteps::look_around(const NeighbourList& list, const Particles& p, double dt) {
  parallel_for(groups(), [&](std::size_t g) {
    rate_[g] = std::max(rate_[g], rate_around(list, p, g));
    period_[g] = std::min(period_[g], longest_period(g, dt));
  });
  limit_ratios(list);
  keep_pace(list);
}

bool IndividualSteps::bears(std::size_t group, double step, double share) const {
  const double own = step * rate_[group], contact = step * contact_rate_[group];
  return own * own + contact * contact <= share * share;
}

std::uint8_t IndividualSteps::longest_period(std::size_t group, double dt) const {
  int period = largest_;
  while (period > 1 && !bears(group, period * dt, safety_)) period /= 2;
  return static_cast<std::uint8_t>(period);
}

void IndividualSteps::shorten_to(std::size_t group, int period) {
  if (period_[group] <= period) return;
  period_[group] = static_cast<std::uint8_t>(period);
  shortened_.push_back(group);
}

// Each of these only ever lowers a value to that of a neighbour, so the order of neighbours does not matter.
void IndividualSteps::shorten(const NeighbourList& list, const Particles& p, double reach, double dt) {
  const auto for_near = [&](std::size_t g, auto&& visit) {
    const NeighbourList::GroupRows rows = list.group(g);
    for (std::size_t e = 0; e < rows.length * group_size; ++e) {
      const std::size_t j = rows.first[e].index(),
                        i = std::min(g * group_size + e % group_size, particles_ - 1);
      if ((p.position[i] - p.position[j]).squaredNorm() < reach * reach) visit(j / group_size);
    }
  };
  shortened_.clear(), stiffened_.clear();
  // What has stiffened bounds all that it reaches, be its own period 1.
  for (std::size_t g = 0; g < groups(); ++g)
    if (own_rate_[g] > growth_noted * rate_[g]) stiffened_.push_back(g);
  for (const std::size_t g : stiffened_) {
    const auto raise = [&](std::size_t other) { rate_[other] = std::max(rate_[other], own_rate_[g]); };
    raise(g);
    for_near(g, raise);
  }
  for (std::size_t g = 0; g < groups(); ++g)
    if (period_[g] > 1 && !bears(g, period_[g] * dt, most_of_step)) shorten_to(g, longest_period(g, dt));
  for (std::size_t k = 0; k < shortened_.size(); ++k)  // it grows
    for_near(shortened_[k],
             [&](std::size_t other) { shorten_to(other, largest_ratio * period_[shortened_[k]]); });
  for (const std::size_t g : shortened_) {
    const auto lower = [&](std::size_t other) { pace_[other] = std::min(pace_[other], period_[g]); };
    lower(g);
    for_near(g, lower);
  }
}

// Once is enough: what is held to four times the smallest period does not hold others of up to sixteen.
void IndividualSteps::limit_ratios(const NeighbourList& list) {
  // Four times a longer one is no limit.
  const std::vector<std::uint8_t> smallest =
      smallest_around(list, period_, static_cast<std::uint8_t>(largest_ / (2 * largest_ratio)));
  for (std::size_t g = 0; g < groups(); ++g)
    period_[g] = static_cast<std::uint8_t>(std::min<int>(period_[g], largest_ratio * smallest[g]));
}

void IndividualSteps::take_every_step() {
  for (auto* values : {&period_, &pace_}) std::fill(values->begin(), values->end(), 1);
  cycle_ = 1;
  since_chosen_ = chosen_every;
}

void IndividualSteps::keep_pace(const NeighbourList& list) {
  pace_ = smallest_around(list, period_, static_cast<std::uint8_t>(largest_ / 2));
}

void IndividualSteps::plan_kick(std::size_t group, double dt, bool as_begun) {
  const double next = period_[group] * dt;
  const bool regular = planned_[group] > 0 && kick_period_[group] == period_[group] &&
                       steps_since_kick_[group] == period_[group];
  double length = as_begun && regular ? next : velocity_lag(group) + 0.5 * next;
  // 0 would say that there is none.
  if (std::abs(length) < 1e-9 * dt) length = 1e-9 * dt;
  kick_length_[group] = length;
  kick_lag_[group] = velocity_lag(group);
}

void IndividualSteps::begin(double dt, bool energy_wanted, bool as_begun) {
  // Records of energy and steps in which all are kicked meet by themselves where their numbers allow it.
  if (energy_wanted && phase_ % cycle_ != 0 && since_wanted_ >= 8 * cycle_) phase_ = 0;
  in_step_ = phase_ % cycle_ == 0;
  since_wanted_ = in_step_ && energy_wanted ? 0 : since_wanted_ + 1;
  kicked_particles_ = 0;
  const auto is_due = [this](std::uint8_t pace) {
    return in_step_ || (phase_ & (pace - 1U)) == 0;
  };  // powers of two
  for (std::size_t g = 0; g < groups(); ++g)
    due_[g] =
        static_cast<std::uint8_t>((is_due(pace_[g]) ? strained : 0) | (is_due(period_[g]) ? kicked : 0));
  std::fill(kick_length_.begin(), kick_length_.end(), 0.0);
  for (std::size_t g = 0; g < groups(); ++g) {
    if (!is_kicked(g)) continue;
    plan_kick(g, dt, as_begun);
    kicked_particles_ += std::min(particles_, (g + 1) * group_size) - g * group_size;
  }
  kicks_ = {group_size, since_kick_, kick_length_, kick_lag_};
}

void IndividualSteps::end(double dt) {
  for (std::size_t g = 0; g < groups(); ++g) {
    since_strain_[g] = (is_strained(g) ? 0 : since_strain_[g]) + dt;
    since_kick_[g] = (is_kicked(g) ? 0 : since_kick_[g]) + dt;
  }
  for (std::size_t g = 0; g < groups(); ++g) {
    if (is_kicked(g)) planned_[g] = period_[g] * dt;
    kick_period_[g] = is_kicked(g) ? period_[g] : kick_period_[g];
    steps_since_kick_[g] = static_cast<std::uint8_t>((is_kicked(g) ? 0 : steps_since_kick_[g]) + 1);
  }
  phase_ = (phase_ + 1) % most;
  ++since_chosen_;
}

void IndividualSteps::save(h5::Group& group) const {
  if (!enabled()) return;
  const auto write = [&](const char* name, const auto& values) {
    group.write(name, std::vector<double>(values.begin(), values.end()));
  };
  write("steps_period", period_), write("steps_kick_period", kick_period_);
  write("steps_pace", pace_), write("steps_since_kick_count", steps_since_kick_);
  write("steps_own_rate", own_rate_);
  write("steps_rate", rate_), write("steps_contact_rate", contact_rate_);
  write("steps_since_kick", since_kick_), write("steps_planned", planned_);
  write("steps_since_strain", since_strain_);
  write("steps_numbers", std::array{phase_, cycle_, since_chosen_, since_wanted_});
  group.write_scalar("steps_in_step", static_cast<std::uint64_t>(in_step_));
}

void IndividualSteps::load(const h5::Group& group) {
  if (!enabled()) return;
  const auto fill = [](const std::vector<double>& found, auto& values) {
    using Value = typename std::remove_reference_t<decltype(values)>::value_type;
    std::transform(found.begin(), found.end(), values.begin(),
                   [](double v) { return static_cast<Value>(v); });
  };
  const auto read = [&](const char* name, auto& values, h5::Bounds bounds) {
    fill(h5::read_checked(group, name, values.size(), bounds), values);
  };
  const auto check_power = [&](const char* name, std::size_t entry, std::uint32_t value) {
    if (!std::has_single_bit(value))
      h5::refuse(group, name, fmt::format("[{}] is {}; it must be a power of two", entry, value));
  };
  const auto read_powers = [&](const char* name, std::vector<std::uint8_t>& values) {
    fill(h5::read_whole(group, name, values.size(), {1, static_cast<double>(largest_)}), values);
    for (std::size_t g = 0; g < values.size(); ++g) check_power(name, g, values[g]);
  };
  read_powers("steps_period", period_), read_powers("steps_kick_period", kick_period_);
  read_powers("steps_pace", pace_);
  fill(h5::read_whole(group, "steps_since_kick_count", groups(), {0, 255}), steps_since_kick_);
  const h5::Bounds rate{0, h5::single_precision.most};
  read("steps_own_rate", own_rate_, rate), read("steps_rate", rate_, rate);
  read("steps_contact_rate", contact_rate_, {0, h5::unbounded});
  read("steps_since_kick", since_kick_, h5::not_negative);
  read("steps_planned", planned_, h5::not_negative);
  read("steps_since_strain", since_strain_, h5::not_negative);
  std::array<std::uint32_t, 4> numbers{};
  constexpr const char* numbers_name = "steps_numbers";
  fill(h5::read_whole(group, numbers_name, numbers.size(), {0, std::numeric_limits<std::uint32_t>::max()}),
       numbers);
  std::tie(phase_, cycle_, since_chosen_, since_wanted_) = std::tuple_cat(numbers);
  h5::check_whole(group, numbers_name, 0, phase_, {0, most - 1});
  h5::check_whole(group, numbers_name, 1, cycle_, {1, static_cast<double>(largest_)});
  check_power(numbers_name, 1, cycle_);
  in_step_ = h5::read_flag(group, "steps_in_step");
}

}  // namespace tuft::sph
