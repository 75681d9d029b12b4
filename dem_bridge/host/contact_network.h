#pragma once
/// The force of each pair of grains that touch, as LIGGGHTS applied it.
///
/// LIGGGHTS keeps no force of a pair. Its `compute pair/gran/local` evaluates them anew, whatever the contact
/// models are, without adding to the forces and without advancing the springs: from positions, the springs'
/// present elongations and velocities. Positions and springs are still those of the last evaluation, but of
/// clumps the closing half kick has changed the velocities; so those that the evaluation saw, v(t - dt/2),
/// which the shared memory holds, take their place meanwhile, and springs at Coulomb's limit are kept from
/// sticking. What comes out are the forces of that evaluation up to rounding, and nothing of the simulation
/// has changed.
#include <string>

#include "dem_bridge/shared_memory.h"

namespace LAMMPS_NS {
class LAMMPS;
}

namespace tuft::dem {

/// To be given among the commands that set LIGGGHTS up, before its first run.
inline constexpr const char* contact_forces_command = "compute contact_forces all pair/gran/local id force";

/// ContactRecords, one after the other as bytes, sorted by grain. `own_forces_current`: LIGGGHTS' forces are
/// the grains' own at the present moment; then they are compared with the sums over the contacts. Throws
/// std::runtime_error when the two differ, naming the grain, and when the command above was not given.
[[nodiscard]] std::string list_contacts(LAMMPS_NS::LAMMPS& lammps, const SharedMemory& memory,
                                        bool own_forces_current);

}  // namespace tuft::dem
