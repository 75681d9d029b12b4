#include "app/html.h"

#include <fmt/format.h>

namespace tuft::app {

std::string escape_html(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string HtmlTable::html() const {
  std::string text = fmt::format("<table id=\"{}\"{}>\n", id, prose ? " class=\"prose\"" : "");
  if (!caption.empty()) text += fmt::format("<caption>{}</caption>\n", caption);
  if (!header.empty()) {
    text += "<thead><tr>";
    for (const std::string& cell : header) text += fmt::format("<th scope=\"col\">{}</th>", cell);
    text += "</tr></thead>\n";
  }
  text += "<tbody>\n";
  for (const auto& row : rows) {
    text += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c)
      text += c == 0 ? fmt::format("<th scope=\"row\">{}</th>", row[c]) : fmt::format("<td>{}</td>", row[c]);
    text += "</tr>\n";
  }
  return text + "</tbody></table>\n";
}

std::string html_section(const std::string& id, const std::string& title, const std::string& body) {
  return fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n{}</section>\n", id, title, body);
}

}  // namespace tuft::app
