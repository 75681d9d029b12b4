#pragma once
/// The strand of a pull-out: where it lies in its box, and the friction that its test is run with.
#include "core/scene.h"
#include "coupler/specimen.h"

namespace tuft::rigs {

/// A strand of turf.carpet along x at half the box's height, flat between the platens. It leaves the box
/// through the wall at +x and ends there in the grip, an element away. embedded_length 0: it also leaves it
/// through the wall at -x, by rig.travel and an element, so that as much is embedded all the time. It does
/// not fail.
[[nodiscard]] coupler::SpecimenStrand make_pull_out_strand(const Scene& scene);

/// m, of the strand inside the box before it is drawn.
[[nodiscard]] double embedded_length(const SpecimenRig& rig);
/// m, the same once the grip has moved by `displacement`.
[[nodiscard]] double embedded_length(const SpecimenRig& rig, double displacement);

/// Friction of the rig's infill on the strand at a speed (m/s), of grains the mean over the material's shares
/// by mass; with_rate false (effect friction_rate off): at any speed that of fast sliding.
[[nodiscard]] double strand_friction(const Scene& scene, double speed, bool with_rate);

/// The decay of friction with speed that a test at `run_speed` needs to have the friction of `speed`: mu(v)
/// depends on decay x v alone, so decay x speed / run_speed.
void run_friction_of(Scene& scene, double speed, double run_speed);

}  // namespace tuft::rigs
