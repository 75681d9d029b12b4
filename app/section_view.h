#pragma once
/// Side view of the section through the impact as inline SVG.
#include <map>
#include <string>

#include "app/report_data.h"

namespace tuft::app {

/// What all panels of a page have in common, m.
struct SectionFrame {
  double left = 0, right = 0, bottom = 0, top = 0;                ///< shown
  double wall_left = 0, wall_right = 0, wall_top = 0, floor = 0;  ///< tray, inner faces
  double strand_thickness = 0, backing_thickness = 0;
  std::map<Index, std::string> material_style;  ///< material -> CSS class
};

[[nodiscard]] SectionFrame make_section_frame(const Scene& scene);

/// One panel. At most `most_dots` particles are drawn (evenly thinned, and then said so in the panel).
[[nodiscard]] std::string section_svg(const Section& section, const SectionFrame& frame,
                                      const std::string& id, std::size_t most_dots = 6000);

}  // namespace tuft::app
