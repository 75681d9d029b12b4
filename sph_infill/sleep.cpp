#include "sph_infill/sleep.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "core/checkpoint_values.h"
#include "core/parallel.h"
#include "sph_infill/sph_loops.h"

namespace tuft::sph {
namespace {

constexpr std::array contact_names{"sleep_contact_x", "sleep_contact_y", "sleep_contact_z"};

}  // namespace

Sleep::Sleep(double tolerance, double smoothing_length, std::size_t particles, std::uint32_t longest_period)
    : tolerance_(tolerance),
      smoothing_length_(smoothing_length),
      particles_(particles),
      longest_period_(longest_period) {
  const std::size_t blocks = (particles + block_size - 1) / block_size;
  for (std::size_t b = 0; b < blocks; ++b) computed_.push_back(static_cast<Index>(b));
  if (!enabled()) return;
  held_.assign(blocks, 0);
  computed_now_.assign(blocks, 1);
  quiet_.assign(blocks, 0);
  neighbours_.resize(blocks);
  for (auto& force : contact_) force.assign(particles, 0);
}

std::size_t Sleep::computed_particles() const {
  const bool last =
      !computed_.empty() && (static_cast<std::size_t>(computed_.back()) + 1) * block_size > particles_;
  return computed_.size() * block_size - (last ? (block_size - particles_ % block_size) % block_size : 0);
}

void Sleep::find_moving() {
  moving_.clear();
  for (std::size_t b = 0; b < held_.size(); ++b)
    if (is_moving(b)) moving_.push_back(static_cast<Index>(b));
}

bool Sleep::anything_moves() const {
  for (std::size_t b = 0; b < held_.size(); ++b)
    if (is_moving(b)) return true;
  return false;
}

std::vector<Index> Sleep::find_neighbours(const NeighbourList& list, std::size_t block) const {
  thread_local std::vector<std::uint8_t> is_near;
  is_near.assign(held_.size(), 0);
  for (std::size_t g = block * (block_size / group_size);
       g < (block + 1) * (block_size / group_size) && g * group_size < particles_; ++g) {
    const NeighbourList::GroupRows rows = list.group(g);
    for (std::size_t e = 0; e < rows.length * group_size; ++e)
      is_near[rows.first[e].index() / block_size] = 1;
  }
  std::vector<Index> near;
  for (std::size_t other = 0; other < is_near.size(); ++other)
    if (is_near[other] != 0) near.push_back(static_cast<Index>(other));
  return near;
}

void Sleep::set_neighbours(const NeighbourList& list, std::span<const Index> blocks) {
  parallel_for(blocks.size(), [&](std::size_t k) {
    const auto b = static_cast<std::size_t>(blocks[k]);
    neighbours_[b] = find_neighbours(list, b);
  });
}

bool Sleep::contact_has_changed(std::size_t block, const Particles& p, const Vec3Array& impulses,
                                double window, const ParticleKicks& kicks) const {
  const std::size_t end = std::min(particles_, (block + 1) * block_size);
  // Half the tolerance: the rest of it may be there already.
  const double share = 0.5 * tolerance_ / smoothing_length_;
  for (std::size_t i = block * block_size; i < end; ++i) {
    const double length = kicks.empty() ? window : kicks.length[i / kicks.group];
    const double c = p.stress[i].wave_speed, allowed = share * length * c * c * p.mass[i];
    const double dx = impulses.x[i] - length * contact_[0][i], dy = impulses.y[i] - length * contact_[1][i],
                 dz = impulses.z[i] - length * contact_[2][i];
    if (!(dx * dx + dy * dy + dz * dz <= allowed * allowed)) return true;  // NaN too
  }
  return false;
}

void Sleep::remember_contact(std::size_t block, const Vec3Array* impulses, double window,
                             const ParticleKicks& kicks) {
  const std::size_t end = std::min(particles_, (block + 1) * block_size);
  std::array<const std::vector<double>*, 3> impulse{};
  if (impulses != nullptr) impulse = {&impulses->x, &impulses->y, &impulses->z};
  for (std::size_t first = block * block_size; first < end; first += group_size) {
    const std::size_t last = std::min(end, first + group_size);
    const double length = kicks.empty() ? window : kicks.length[first / kicks.group];
    if (length == 0) continue;  // contact has not been evaluated for it
    const double per_length = 1 / length;
    for (std::size_t d = 0; d < contact_.size(); ++d)
      for (std::size_t i = first; i < last; ++i)
        contact_[d][i] = impulse[d] ? static_cast<float>((*impulse[d])[i] * per_length) : 0;
  }
}

void Sleep::choose(const NeighbourList& list, const Particles& particles, const Vec3Array* impulses,
                   double window, const ParticleKicks& kicks) {
  if (!enabled()) return;
  const std::size_t blocks = held_.size();
  if (!neighbours_known_ && moving_.size() < blocks) {  // where all move, nothing stands beside them
    parallel_for(blocks, [&](std::size_t b) { neighbours_[b] = find_neighbours(list, b); });
    neighbours_known_ = true;
  }
  std::fill(computed_now_.begin(), computed_now_.end(), std::uint8_t{0});
  for (const Index m : moving_) {
    computed_now_[static_cast<std::size_t>(m)] = 1;
    if (!neighbours_known_) continue;
    for (const Index other : neighbours_[static_cast<std::size_t>(m)])
      computed_now_[static_cast<std::size_t>(other)] = 1;
  }
  parallel_for(blocks, [&](std::size_t b) {
    if (computed_now_[b] == 0 && impulses && contact_has_changed(b, particles, *impulses, window, kicks))
      computed_now_[b] = 1;
    if (computed_now_[b] != 0) remember_contact(b, impulses, window, kicks);
  });
  computed_.clear();
  for (std::size_t b = 0; b < blocks; ++b)
    if (computed_now_[b] != 0) computed_.push_back(static_cast<Index>(b));
}

void Sleep::note(std::size_t block, double unrest, std::uint32_t period) {
  if (held_[block] != 0) {
    if (quiet_[block] > 0) --quiet_[block];
    if (wakes(unrest)) held_[block] = 0, quiet_[block] = 0;
    return;
  }
  quiet_[block] = unrest < 0.5 * tolerance_ ? quiet_[block] + 1 : 0;
  // Of a particle that is slow, two kicks at least.
  if (quiet_[block] < std::max(quiet_steps, 2 * period)) return;
  held_[block] = 1;
  // Until all are held, and then until all are strained by their last velocities.
  quiet_[block] = 2 * longest_period_;
}

void Sleep::wake(std::size_t block) {
  if (enabled()) held_[block] = 0, quiet_[block] = 0;
}

void Sleep::save(h5::Group& group, const NeighbourList& list) const {
  if (!enabled()) return;
  const std::size_t blocks = held_.size();
  std::vector<double> held, quiet, complete, count, neighbours;
  for (std::size_t b = 0; b < blocks; ++b) {
    held.push_back(held_[b]);
    quiet.push_back(quiet_[b]);
    complete.push_back(list.is_complete(b) ? 1 : 0);
    const std::vector<Index> near = neighbours_known_ ? neighbours_[b] : find_neighbours(list, b);
    count.push_back(static_cast<double>(near.size()));
    neighbours.insert(neighbours.end(), near.begin(), near.end());
  }
  group.write("sleep_held", held);
  group.write("sleep_quiet", quiet);
  group.write("sleep_listed", complete);
  group.write("sleep_neighbour_count", count);
  group.write("sleep_neighbours", neighbours);
  for (std::size_t d = 0; d < contact_.size(); ++d)
    group.write(contact_names[d], std::vector<double>(contact_[d].begin(), contact_[d].end()));
}

void Sleep::load(const h5::Group& group, NeighbourList& list) {
  if (!enabled()) return;
  const std::size_t blocks = held_.size();
  const auto count_of_blocks = static_cast<double>(blocks);
  const double longest_quiet = std::max(quiet_steps, 2 * longest_period_);
  const std::vector<double> held = h5::read_whole(group, "sleep_held", blocks, {0, 1}),
                            quiet = h5::read_whole(group, "sleep_quiet", blocks, {0, longest_quiet}),
                            listed = h5::read_whole(group, "sleep_listed", blocks, {0, 1}),
                            count =
                                h5::read_whole(group, "sleep_neighbour_count", blocks, {0, count_of_blocks});
  const auto total = static_cast<std::size_t>(std::accumulate(count.begin(), count.end(), 0.0));
  const std::vector<double> neighbours =
      h5::read_whole(group, "sleep_neighbours", total, {0, count_of_blocks - 1});
  auto next = neighbours.begin();
  for (std::size_t b = 0; b < blocks; ++b) {
    held_[b] = held[b] != 0 ? 1 : 0;
    quiet_[b] = static_cast<std::uint32_t>(quiet[b]);
    if (listed[b] == 0) list.make_out_of_date(b);
    neighbours_[b].clear();
    neighbours_known_ = true;
    for (auto k = static_cast<std::size_t>(count[b]); k > 0; --k)
      neighbours_[b].push_back(static_cast<Index>(*next++));
  }
  for (std::size_t d = 0; d < contact_.size(); ++d) {
    const std::vector<double> force =
        h5::read_checked(group, contact_names[d], particles_, h5::single_precision);
    std::transform(force.begin(), force.end(), contact_[d].begin(),
                   [](double f) { return static_cast<float>(f); });
  }
}

}  // namespace tuft::sph
