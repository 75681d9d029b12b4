#pragma once
/// Pieces of HTML. Text that comes from outside goes through escape_html.
#include <string>
#include <string_view>
#include <vector>

namespace tuft::app {

[[nodiscard]] std::string escape_html(std::string_view text);

/// A table whose cells are HTML already. The first column is a row header, the others are aligned to the
/// right with figures of equal width.
struct HtmlTable {
  std::string id, caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  bool prose = false;  ///< all columns to the left
  [[nodiscard]] std::string html() const;
};

[[nodiscard]] std::string html_section(const std::string& id, const std::string& title,
                                       const std::string& body);

}  // namespace tuft::app
