#pragma once
/// run.xdmf: how ParaView and VisIt find the frames inside run.h5.
#include <filesystem>
#include <string>
#include <vector>

namespace tuft::h5 {
class Group;
}

namespace tuft::rigs {

/// Writes `run.xdmf` (XDMF 3) beside `run.h5`: one temporal collection whose every step holds the infill as
/// points, with each recorded field as attribute, and the carpet as quadrilaterals; where they are recorded
/// also contacts as lines with their forces, and coarse-grained fields on their grid. Bodies have no mesh and
/// are left to the report. Describes the frames that run.h5 holds at this moment, also of a run that was
/// killed. Throws RunError when run.h5 cannot be read or run.xdmf not be written.
void write_xdmf(const std::filesystem::path& folder);

/// The text of it, from the root group of run.h5. `file` is the name of run.h5 as the text will refer to it.
[[nodiscard]] std::string xdmf_text(const h5::Group& root, const std::string& file);

}  // namespace tuft::rigs
