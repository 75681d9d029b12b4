#pragma once
/// Groups of elements that step at their own steps: the slow ones are evaluated every m-th step, their forces
/// given as one impulse of the time since the last one, while the nodes move at the fast step throughout. An
/// asynchronous variational integrator with commensurate steps (Lew, Marsden, Ortiz & West 2003), also known
/// as the impulse method or r-RESPA (Tuckerman, Berne & Martyna 1992): momentum is kept to rounding.
#include <cstdint>
#include <span>
#include <vector>

#include "fe_carpet/element_arrays.h"

namespace tuft::fe {

/// A group of elements is a material: what a mesh made elsewhere has too.
struct Subcycling {
  std::vector<std::uint8_t> slow;  ///< per family
  std::vector<std::size_t> fast_blocks;
  std::vector<Index> nodes;                        ///< of slow elements
  std::vector<Index> first_corner, corner_offset;  ///< as in NodeArrays, of the fast elements alone
  std::uint64_t slow_elements = 0;

  int every = 1;       ///< steps from one evaluation of the slow elements to the next
  int steps = 0;       ///< taken since the last one, in [0, every)
  double drifted = 0;  ///< s, moved since the slow elements were last evaluated
  double owed = 0;     ///< s, since their last impulse
  NodeMotion window;   ///< positions at the last evaluation; mean velocities from there to the present one
  Vec3Array turn;      ///< rad, sum of rotation increments since the last evaluation
  std::uint64_t slow_evaluations = 0;

  /// From the last evaluation to the present positions, for the element loop.
  void close_window(const NodeMotion& motion);
  /// Adds a step's rotations, after the nodes have moved.
  void drift(const NodeMotion& motion, double dt);
};

/// Slow are the materials whose elements bear at least twice the smallest step (s, per material; infinite
/// without elements). Empty `slow` when there are none.
[[nodiscard]] Subcycling make_subcycling(const ShellMesh& mesh, const ElementArrays& elements,
                                         std::span<const double> step_of_material);

/// How many steps of the fast materials the slow ones bear, at least 1.
[[nodiscard]] int subcycle_ratio(const Subcycling& subcycling, std::span<const double> step_of_material);

}  // namespace tuft::fe
