#include "dem_bridge/host/sphere_steps.h"

#include <algorithm>
#include <array>

#include "dem_bridge/host/kick.h"
#include "dem_bridge/host/rows.h"

namespace tuft::dem {
namespace {

/// Spheres that are moved at once.
constexpr std::size_t block_size = 32;
static_assert(block_size % lanes == 0);

/// Three values of each sphere of a block, by component, and back.
struct alignas(stdx::memory_alignment_v<Pack>) BlockRows {
  std::array<double, block_size> x, y, z;

  void read(const double* rows) {
    for (std::size_t k = 0; k < block_size; ++k) {
      x[k] = rows[3 * k];
      y[k] = rows[3 * k + 1];
      z[k] = rows[3 * k + 2];
    }
  }
  void write(double* rows) const {
    for (std::size_t k = 0; k < block_size; ++k) {
      rows[3 * k] = x[k];
      rows[3 * k + 1] = y[k];
      rows[3 * k + 2] = z[k];
    }
  }
  [[nodiscard]] Pack3 pack(std::size_t k) const { return {load(&x[k]), load(&y[k]), load(&z[k])}; }
  void set(std::size_t k, const Pack3& value) {
    store(&x[k], value.x);
    store(&y[k], value.y);
    store(&z[k], value.z);
  }
};

/// Contact forces and torques on the spheres of a block.
struct BlockLoads {
  BlockRows force, torque;                         ///< set in packs of which any sphere is touched
  std::array<bool, block_size / lanes> touched{};  ///< by pack

  void read(std::span<const LoadRecord> loads, std::size_t first, double per_second) {
    for (const LoadRecord& load : loads) {
      const std::size_t k = load.grain - first, pack = k / lanes;
      if (!touched[pack]) {
        const Pack none = 0.0;
        force.set(pack * lanes, {none, none, none});
        torque.set(pack * lanes, {none, none, none});
        touched[pack] = true;
      }
      force.x[k] = per_second * load.impulse[0];
      force.y[k] = per_second * load.impulse[1];
      force.z[k] = per_second * load.impulse[2];
      torque.x[k] = per_second * load.angular[0];
      torque.y[k] = per_second * load.angular[1];
      torque.z[k] = per_second * load.angular[2];
    }
  }
};

/// Sums by lane.
struct BlockSums {
  Pack kinetic = 0.0, pair_work = 0.0, contact_work = 0.0, damping_work = 0.0;
  std::array<Pack, 3> received{0.0, 0.0, 0.0}, scale{0.0, 0.0, 0.0};  ///< N, of contact forces

  void receive(const Pack3& force) {
    using std::abs;
    const std::array<Pack, 3> components{force.x, force.y, force.z};
    for (std::size_t c = 0; c < 3; ++c) {
      received[c] += components[c];
      scale[c] += abs(components[c]);
    }
  }
  void add_to(KickSums& sums, double step) const {
    sums.kinetic += sum_lanes(kinetic);
    sums.pair_work += sum_lanes(pair_work);
    sums.contact_work += sum_lanes(contact_work);
    sums.damping_work += sum_lanes(damping_work);
    for (std::size_t c = 0; c < 3; ++c) {
      sums.received[c] += step * sum_lanes(received[c]);
      sums.scale[c] += step * sum_lanes(scale[c]);
    }
  }
};

struct Block {
  std::size_t first;  ///< its first sphere
  BlockRows velocity, spin, force, torque;
  BlockLoads loads;

  [[nodiscard]] GrainStateOf<Pack3, Pack> state(const SphereStep& step, std::size_t k) const {
    const Pack mass(step.mass + first + k, stdx::element_aligned),
        radius(step.radius + first + k, stdx::element_aligned);
    return {velocity.pack(k), spin.pack(k), force.pack(k),
            torque.pack(k),   mass,         0.4 * mass * radius * radius};
  }
};

template <bool loaded, bool with_kinetic>
void kick_block(const SphereStep& step, Block& block, BlockSums& sums) {
  const Pack none = 0.0;
  const Pack3 gravity{step.gravity.x(), step.gravity.y(), step.gravity.z()};
  for (std::size_t k = 0; k < block_size; k += lanes) {
    GrainLoadOf<Pack3> load{{none, none, none}, {none, none, none}, gravity, step.damping, step.step};
    if (loaded && block.loads.touched[k / lanes]) {
      load.contact_force = block.loads.force.pack(k);
      load.contact_torque = block.loads.torque.pack(k);
      sums.receive(load.contact_force);
    }
    const auto done = kick_grain(block.state(step, k), load);
    block.velocity.set(k, done.velocity);
    block.spin.set(k, done.spin);
    if constexpr (with_kinetic) sums.kinetic += done.kinetic;
    sums.pair_work += done.pair_work;
    sums.contact_work += done.contact_work;
    sums.damping_work += done.damping_work;
  }
}

void write_state(const SphereStep& step, std::size_t first, const BlockRows& position, const Block& block,
                 StateOut& out) {
  const BlockRows &v = block.velocity, &w = block.spin;
  const std::array<const std::array<double, block_size>*, 9> from{
      &position.x, &position.y, &position.z, &v.x, &v.y, &v.z, &w.x, &w.y, &w.z};
  const std::array<double*, 9> to{out.x, out.y, out.z, out.vx, out.vy, out.vz, out.wx, out.wy, out.wz};
  for (std::size_t c = 0; c < from.size(); ++c) std::copy_n(from[c]->data(), block_size, to[c] + first);
  const double* const radius = step.radius + first;
  const double low_x = out.low.x(), low_y = out.low.y(), low_z = out.low.z(), high_x = out.high.x(),
               high_y = out.high.y(), high_z = out.high.z();
  double poison = 0;
  int outside = 0, fast = 0;
#pragma omp simd reduction(+ : poison, outside, fast)
  for (std::size_t k = 0; k < block_size; ++k) {
    const double x = position.x[k], y = position.y[k], z = position.z[k];
    outside += !((x >= low_x) & (x < high_x) & (y >= low_y) & (y < high_y) & (z >= low_z) & (z < high_z));
    fast += moves_past_itself(v.x[k], v.y[k], v.z[k], radius[k], step.step);
    // Sums may overflow where no part of them has.
    poison += (x - x) + (y - y) + (z - z) + (v.x[k] - v.x[k]) + (v.y[k] - v.y[k]) + (v.z[k] - v.z[k]) +
              (w.x[k] - w.x[k]) + (w.y[k] - w.y[k]) + (w.z[k] - w.z[k]);
  }
  out.outside += static_cast<std::size_t>(outside);
  out.fast += static_cast<std::size_t>(fast);
  out.poison += poison;
}

void write_state(const SphereStep& step, std::size_t a, StateOut& out) {
  const Vec3 x = load3(step.position + 3 * a), v = load3(step.velocity + 3 * a), w = load3(step.spin + 3 * a);
  out.x[a] = x.x(), out.y[a] = x.y(), out.z[a] = x.z();
  out.vx[a] = v.x(), out.vy[a] = v.y(), out.vz[a] = v.z();
  out.wx[a] = w.x(), out.wy[a] = w.y(), out.wz[a] = w.z();
  if ((x.array() < out.low.array()).any() || (x.array() >= out.high.array()).any()) ++out.outside;
  if (moves_past_itself(v.x(), v.y(), v.z(), step.radius[a], step.step)) ++out.fast;
  out.poison += ((x - x) + (v - v) + (w - w)).sum();
}

void step_block(const SphereStep& step, std::size_t first, bool with_kinetic,
                std::span<const LoadRecord> loads, BlockSums& sums, StateOut* out) {
  Block block;
  block.first = first;
  block.velocity.read(step.velocity + 3 * first);
  block.spin.read(step.spin + 3 * first);
  block.force.read(step.force + 3 * first);
  block.torque.read(step.torque + 3 * first);
  if (loads.empty()) {
    with_kinetic ? kick_block<false, true>(step, block, sums) : kick_block<false, false>(step, block, sums);
  } else {
    block.loads.read(loads, first, step.per_second);
    with_kinetic ? kick_block<true, true>(step, block, sums) : kick_block<true, false>(step, block, sums);
  }
  block.velocity.write(step.velocity + 3 * first);
  block.spin.write(step.spin + 3 * first);
  BlockRows position;
  position.read(step.position + 3 * first);
  for (std::size_t k = 0; k < block_size; k += lanes)
    position.set(k, position.pack(k) + Pack(step.step) * block.velocity.pack(k));
  position.write(step.position + 3 * first);
  if (out != nullptr) write_state(step, first, position, block, *out);
}

}  // namespace

void step_sphere(const SphereStep& step, std::size_t a, std::span<const LoadRecord> loads, KickSums& sums) {
  const double mass = step.mass[a], radius = step.radius[a];
  const GrainState grain{load3(step.velocity + 3 * a),
                         load3(step.spin + 3 * a),
                         load3(step.force + 3 * a),
                         load3(step.torque + 3 * a),
                         mass,
                         0.4 * mass * radius * radius};
  GrainLoad load{Vec3(0, 0, 0), Vec3(0, 0, 0), step.gravity, step.damping, step.step};
  if (!loads.empty()) {
    load.contact_force = step.per_second * Vec3(loads.front().impulse.data());
    load.contact_torque = step.per_second * Vec3(loads.front().angular.data());
    sums.receive(step.step * load.contact_force);
  }
  const GrainKick done = kick_grain(grain, load);
  store3(step.velocity + 3 * a, done.velocity);
  store3(step.spin + 3 * a, done.spin);
  store3(step.position + 3 * a, load3(step.position + 3 * a) + step.step * done.velocity);
  sums.kinetic += done.kinetic;
  sums.pair_work += done.pair_work;
  sums.contact_work += done.contact_work;
  sums.damping_work += done.damping_work;
}

void step_spheres(const SphereStep& step, std::size_t first, std::size_t end, bool with_kinetic,
                  LoadCursor& cursor, KickSums& sums, StateOut* out) {
  BlockSums of_blocks;
  for (; first + block_size <= end; first += block_size)
    step_block(step, first, with_kinetic, cursor.of(first, first + block_size), of_blocks, out);
  of_blocks.add_to(sums, step.step);
  for (; first < end; ++first) {
    step_sphere(step, first, cursor.of(first, first + 1), sums);
    if (out != nullptr) write_state(step, first, *out);
  }
}

}  // namespace tuft::dem
