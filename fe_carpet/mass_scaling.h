#pragma once
/// Selective mass scaling: the elements that bound the step, and only they, get mass until all of them bear
/// one common larger step.
#include "core/vector.h"

namespace tuft::fe {

struct ElementArrays;

/// What was added, of the whole carpet (clamped elements included), and what it bought.
struct MassScaling {
  double limit = 0;                        ///< share of the carpet's mass that might be added; 0: off
  double true_mass = 0;                    ///< kg
  double added_mass = 0;                   ///< kg
  Index elements = 0;                      ///< that got mass
  double step_before = 0, step_after = 0;  ///< s, stable steps of the carpet as built

  [[nodiscard]] double share() const { return true_mass > 0 ? added_mass / true_mass : 0; }
};

/// Raises the masses of elements whose own stable step dt_e is below a target to m_e (target / dt_e)^2. The
/// target is the largest with which at most `limit` times the carpet's mass is added. Rotary inertia is in
/// proportion to mass and follows. An element's frequency squared goes as 1 / mass, so that its step becomes
/// the target to rounding. `position`: of the nodes as built.
MassScaling scale_masses(ElementArrays& elements, const Vec3Array& position, double limit);

}  // namespace tuft::fe
