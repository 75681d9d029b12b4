#pragma once
/// Infill at rest sleeps: what moves, and what stands beside it, is computed; nothing else.
///
/// Particles go by blocks. A block is
/// - awake: its particles move;
/// - on guard: held still, beside an awake block or under a contact force that has changed; its stresses and
///   forces are computed in every step, as if it were free;
/// - asleep: held still, and so are all neighbours of its particles; nothing of it is computed.
///
/// Unrest of a particle is the larger of |v|/c and |a| h/c^2, with the acceleration a that it has or would
/// have: the strain of a wave with that speed of its particles, or of one that changes by as much within h.
/// An awake block is held once the unrest of all its particles has stayed under half the tolerance for
/// `quiet_steps` steps. A block on guard is let go in the very step in which the unrest of one of its
/// particles passes the tolerance.
///
/// Where particles take steps of their own (individual_steps.h), unrest is found at their kicks, two at least
/// of the slowest of a block are awaited, and particles are held from their next kick on.
///
/// docs/theory/sph.md shows why no wave can be missed.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hdf5_file.h"
#include "core/infill.h"

namespace tuft::sph {

class NeighbourList;
struct Particles;

class Sleep {
 public:
  /// Steps of rest before a block is held.
  static constexpr std::uint32_t quiet_steps = 20;

  Sleep() = default;
  /// tolerance: strain, >= 0; 0: all blocks are awake for ever, at no cost. longest_period: steps from one
  /// kick of a particle to the next, at most.
  Sleep(double tolerance, double smoothing_length, std::size_t particles, std::uint32_t longest_period = 1);

  [[nodiscard]] bool enabled() const { return tolerance_ > 0; }
  /// Awake and on guard, ascending.
  [[nodiscard]] std::span<const Index> computed() const { return computed_; }
  [[nodiscard]] bool is_held(std::size_t block) const { return enabled() && held_[block] != 0; }
  /// Of a held block: its particles have no velocity any more, and what they were strained by is in their
  /// stresses.
  [[nodiscard]] bool has_settled(std::size_t block) const { return quiet_[block] == 0; }
  /// Whether a held block with this unrest is let go, in the same step.
  /// NaN lets go: what is held still would hide it.
  [[nodiscard]] bool wakes(double unrest) const { return !(unrest <= tolerance_); }
  [[nodiscard]] bool is_asleep(std::size_t block) const { return enabled() && computed_now_[block] == 0; }
  /// Number of particles in the blocks computed.
  [[nodiscard]] std::size_t computed_particles() const;

  /// Blocks that move, or did in the last step, ascending: as of the last `find_moving`.
  void find_moving();
  [[nodiscard]] std::span<const Index> moving() const { return moving_; }
  [[nodiscard]] bool anything_moves() const;
  /// Notes which blocks the neighbours of those given are in.
  void set_neighbours(const NeighbourList& list, std::span<const Index> blocks);
  /// The list has been built anew, whole: neighbours are noted of all blocks when next they are needed.
  void forget_neighbours() { neighbours_known_ = false; }
  /// Chooses the blocks to compute in the coming step: what moves, what stands beside it, and what contact
  /// pushes otherwise than before. impulses: of the window, N s, or null; window: s. kicks: where contact has
  /// been evaluated for kicks of the particles' own.
  void choose(const NeighbourList& list, const Particles& particles, const Vec3Array* impulses, double window,
              const ParticleKicks& kicks = {});
  /// What a step has found. unrest: a block's, where it was computed; period: steps between kicks of its
  /// slowest particle.
  template <class UnrestOfBlock, class PeriodOfBlock>
  void update(UnrestOfBlock&& unrest, PeriodOfBlock&& period) {
    for (const Index block : computed_) {
      const auto b = static_cast<std::size_t>(block);
      note(b, unrest(b), period(b));
    }
  }
  void wake(std::size_t block);

  /// With what the list of neighbours knows, on which the choice of blocks depends.
  void save(h5::Group& group, const NeighbourList& list) const;
  /// list: just built, whole.
  void load(const h5::Group& group, NeighbourList& list);

 private:
  void note(std::size_t block, double unrest, std::uint32_t period);
  [[nodiscard]] std::vector<Index> find_neighbours(const NeighbourList& list, std::size_t block) const;
  /// Whether its particles have moved in the last two steps.
  [[nodiscard]] bool is_moving(std::size_t block) const { return held_[block] == 0 || quiet_[block] > 0; }
  /// Whether contact pushes a sleeping block otherwise than when it was last computed.
  [[nodiscard]] bool contact_has_changed(std::size_t block, const Particles& particles,
                                         const Vec3Array& impulses, double window,
                                         const ParticleKicks& kicks) const;
  void remember_contact(std::size_t block, const Vec3Array* impulses, double window,
                        const ParticleKicks& kicks);

  double tolerance_ = 0, smoothing_length_ = 0;
  std::size_t particles_ = 0;
  std::uint32_t longest_period_ = 1;
  std::vector<std::uint8_t> held_, computed_now_;
  /// Awake: steps that a block has been at rest. Held: steps for which it is still computed, so that what its
  /// neighbours read of it belongs to rest.
  std::vector<std::uint32_t> quiet_;
  std::vector<std::vector<Index>> neighbours_;  ///< blocks, ascending
  bool neighbours_known_ = true;
  std::vector<Index> computed_, moving_;
  std::array<std::vector<float>, 3> contact_;  ///< N, force on each particle when last computed
};

}  // namespace tuft::sph
