#pragma once
/// The multi-rate clock: how one interval of the output grid is divided into coupling windows, and each
/// window into steps of carpet and infill. Output times fall on window ends exactly, so no record is
/// interpolated.
#include <cstdint>

namespace tuft::coupler {

/// Stable steps of the parts before any safety factor, s.
struct StableSteps {
  double carpet = 0;
  double infill = 0;
  double contact = 0;    ///< 2 / omega of the stiffest contact on a particle, for the window
  int carpet_ratio = 1;  ///< steps of the carpet that its slow elements bear in one; 1: none are subcycled
};

struct StepPlan {
  int windows = 1;          ///< in the interval
  int carpet_substeps = 1;  ///< in a window
  int infill_substeps = 1;  ///< in a window
  double window = 0;        ///< s
  int carpet_subcycle = 1;  ///< slow elements of the carpet are evaluated in every so many of its steps
};

/// Each part takes the largest step it can bear:
/// - the infill's step feels its own stiffness and that of contact in parallel: 1/dt^2 = 1/dt_infill^2 +
/// 1/dt_contact^2;
/// - the window is the larger of the two parts' steps, so that one of them takes a single step in it: nothing
///   is exchanged more often than either can tell; a scene may ask for another (requested_window > 0);
/// - the carpet's steps in an interval are a multiple of carpet_subcycle, so that its slow elements are
///   evaluated in the last one and the energy at the interval's end is that of one moment;
/// - a window in which the infill takes several steps is cut to dt_contact/sqrt(2), since contact's force is
///   held in it (docs/theory/contact.md).
[[nodiscard]] StepPlan plan_steps(const StableSteps& stable, double safety, double requested_window,
                                  double interval);

}  // namespace tuft::coupler
