#include <fmt/format.h>

#include "app/html.h"
#include "app/report_sections.h"

namespace tuft::app {

std::string report_remarks(const Runs& runs) {
  std::string items;
  for (const RunData& run : runs)
    for (const std::string& remark : run.summary.remarks)
      items += fmt::format("<li>{}{}</li>\n", runs.size() > 1 ? escape_html(run.label) + ": " : "",
                           escape_html(remark));
  if (items.empty()) return {};
  return fmt::format("<section id=\"remarks\">\n<h2>Remarks</h2>\n<ul>\n{}</ul>\n</section>\n", items);
}

}  // namespace tuft::app
