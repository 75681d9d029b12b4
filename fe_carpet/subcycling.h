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
  std::vector<std::uint8_t> slow;     ///< per family
  std::vector<std::size_t> material;  ///< of the mesh, of each slow family; these come last
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

/// Which elements are slow: those of materials whose elements bear at least 2.5 times the smallest step, but for
/// the layers next to faster elements.
struct SlowFamilies {
  std::vector<Index> material;      ///< per quad: the mesh's, or for slow ones one of the copies after them
  std::vector<std::size_t> copied;  ///< material of the mesh of each copy
  std::size_t elements = 0;         ///< that are slow
};
[[nodiscard]] SlowFamilies split_slow_families(const ShellMesh& mesh,
                                               std::span<const double> step_of_material);

/// slow: per family of `elements`.
[[nodiscard]] Subcycling make_subcycling(const ShellMesh& mesh, const ElementArrays& elements,
                                         std::vector<std::uint8_t> slow);

/// How many steps of the fast families the slow ones bear, at least 1. Steps in s, infinite without elements.
[[nodiscard]] int subcycle_ratio(const Subcycling& subcycling, std::span<const double> step_of_family);

}  // namespace tuft::fe
