/// LS-DYNA keyword files, after the Keyword User's Manual, volume I: *NODE, *ELEMENT_SHELL, *PART,
/// *SECTION_SHELL in cards of standard width or with commas.
#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "fe_carpet/mesh_file.h"

namespace tuft::fe {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool has_inner_blank(std::string_view text) {
  return text.find_first_of(" \t") != std::string_view::npos;
}

std::vector<std::string_view> split_at_commas(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

std::vector<std::string_view> split_at_blanks(std::string_view line) {
  std::vector<std::string_view> fields;
  for (line = trimmed(line); !line.empty(); line = trimmed(line)) {
    const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
    fields.push_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return fields;
}

/// The fields of a card, blank ones empty: by commas if it has one; else by columns of the given widths; a
/// card whose columns would cut through blanks was written freely.
std::vector<std::string_view> split_card(std::string_view line, std::span<const std::size_t> widths) {
  if (line.find(',') != std::string_view::npos) return split_at_commas(line);
  std::vector<std::string_view> fields;
  std::string_view rest = line;
  for (const std::size_t width : widths) {
    if (rest.empty()) break;
    fields.push_back(trimmed(rest.substr(0, width)));
    if (has_inner_blank(fields.back()) || rest.substr(0, width).find('\t') != std::string_view::npos)
      return split_at_blanks(line);
    rest.remove_prefix(std::min(width, rest.size()));
  }
  return fields;
}

constexpr std::size_t node_widths[] = {8, 16, 16, 16, 8, 8};
constexpr std::size_t element_widths[] = {8, 8, 8, 8, 8, 8, 8, 8, 8, 8};
constexpr std::size_t thickness_widths[] = {16, 16, 16, 16, 16};
constexpr std::size_t common_widths[] = {10, 10, 10, 10, 10, 10, 10, 10};

class KeywordReader {
 public:
  KeywordReader(std::string_view text, const std::string& file) : text_(text) {
    mesh_.file = file;
    if (text_.starts_with("\xef\xbb\xbf")) text_.remove_prefix(3);  // a byte order mark
  }

  FileMesh read() {
    bool ended = false;
    while (!ended && next_line()) {
      if (line_[0] != '*') {
        if (trimmed(line_).empty()) continue;
        fail("a keyword (*NODE, ...) is needed here", line_, "a keyword file has cards only below a keyword");
      }
      ended = read_keyword();
    }
    if (!ended) fail("the file ends without *END", "", "it may be cut short; add *END if it is whole");
    give_thicknesses();
    note_skipped_keywords();
    return std::move(mesh_);
  }

 private:
  using Fields = std::vector<std::string_view>;

  struct Section {
    std::optional<double> thickness;
  };

  [[noreturn]] void fail(std::string_view problem, std::string_view value, std::string_view advice) const {
    fail_in_mesh_file(mesh_.file, std::max<std::size_t>(number_, 1), problem, value, advice);
  }

  /// The next line that is no comment; false at the end.
  bool next_line() {
    do {
      if (text_.empty()) return false;
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      line_ = text_.substr(0, end);
      text_.remove_prefix(std::min(end + 1, text_.size()));
      if (line_.ends_with('\r')) line_.remove_suffix(1);
      ++number_;
    } while (line_.starts_with('$'));
    if (line_.empty()) line_ = " ";  // a blank card, so that line_[0] is always there
    return true;
  }

  /// Whether another card of the present keyword follows; it is in line_ then. Blank cards are passed over.
  bool next_card() {
    while (true) {
      std::string_view ahead = text_;
      while (ahead.starts_with('$')) ahead.remove_prefix(std::min(ahead.find('\n'), ahead.size() - 1) + 1);
      if (ahead.empty() || ahead[0] == '*' || !next_line()) return false;
      if (!trimmed(line_).empty()) return true;
    }
  }

  void need_line(std::string_view wanted) {
    if (!next_line() || line_[0] == '*')
      fail(std::string(wanted) + " is missing", line_[0] == '*' ? line_ : std::string_view(),
           "the file is cut short or a card was dropped");
  }

  /// True for *END.
  bool read_keyword() {
    const std::string_view found = line_.substr(0, line_.find_first_of(" \t,"));
    std::string name = in_lower_case(found);
    const std::string options = in_lower_case(line_.substr(found.size()));
    const bool wide =
        name.ends_with('+') || name.ends_with('%') || trimmed(options) == "+" || trimmed(options) == "%";
    if (name.ends_with('-')) name.pop_back();
    if (name == "*end") return true;
    if (name == "*keyword") {
      if (options.find("long=y") != std::string::npos || options.find("i10=y") != std::string::npos)
        fail("the deck has cards of another width", line_, "save it with standard cards (LONG=S, I10=N)");
    } else if (wide && (name.starts_with("*node") || name.starts_with("*element_shell") ||
                        name.starts_with("*part") || name.starts_with("*section_shell"))) {
      fail("a keyword has cards of another width", line_, "save it with standard cards");
    } else if (name == "*node") {
      while (next_card()) read_node();
    } else if (name == "*element_shell" || name == "*element_shell_thickness" ||
               name == "*element_shell_beta") {
      while (next_card()) read_element(name != "*element_shell");
    } else if (name.starts_with("*element_shell")) {
      fail("shells with this option are not known", line_,
           "save them as *ELEMENT_SHELL or *ELEMENT_SHELL_THICKNESS");
    } else if (name == "*part") {
      while (next_part_title()) read_part();
    } else if (name == "*section_shell" || name == "*section_shell_title") {
      while (next_card()) read_section(name == "*section_shell_title");
    } else {
      if (name != "*title") skipped_.emplace(found);
      while (next_card()) {
      }
    }
    return false;
  }

  Fields card(std::span<const std::size_t> widths) const { return split_card(line_, widths); }

  [[nodiscard]] static std::string_view field(const Fields& fields, std::size_t i) {
    return i < fields.size() ? fields[i] : std::string_view();
  }

  FileId id(const Fields& fields, std::size_t i, std::string_view wanted) const {
    const std::string_view text = field(fields, i);
    if (text.empty()) fail(std::string(wanted) + " is missing", trimmed(line_), "complete the card");
    const auto value = whole_number(text);
    if (!value || *value < 1)
      fail(std::string(wanted) + " must be a whole number from 1 on", text,
           "correct it; parameters (&) are not known");
    return *value;
  }
  /// A whole number that may be left out: 0 then.
  FileId whole(const Fields& fields, std::size_t i, std::string_view wanted) const {
    const std::string_view text = field(fields, i);
    if (text.empty()) return 0;
    const auto value = whole_number(text);
    // Whole numbers are written as 0.0 by some programs.
    if (!value && real_number(text) == 0.0) return 0;
    if (!value)
      fail(std::string(wanted) + " must be a whole number", text, "correct it; parameters (&) are not known");
    return *value;
  }
  double real(const Fields& fields, std::size_t i, std::string_view wanted) const {
    const auto value = real_number(field(fields, i));
    if (!value)
      fail(field(fields, i).empty() ? std::string(wanted) + " is missing"
                                    : std::string(wanted) + " must be a number",
           field(fields, i).empty() ? trimmed(line_) : field(fields, i),
           "correct it; parameters (&) are not known");
    return *value;
  }

  void read_node() {
    const Fields fields = card(node_widths);
    FileNode node;
    node.line = number_;
    node.id = id(fields, 0, "the node's number");
    node.position = {real(fields, 1, "the node's x"), real(fields, 2, "the node's y"),
                     real(fields, 3, "the node's z")};
    mesh_.nodes.push_back(node);
  }

  void read_element(bool with_thickness) {
    const Fields fields = card(element_widths);
    FileQuad quad;
    quad.line = number_;
    quad.id = id(fields, 0, "the element's number");
    quad.part = part(id(fields, 1, "the element's part"));
    for (std::size_t i = 0; i < 4; ++i) {
      quad.nodes[i] =
          i < 3 ? id(fields, 2 + i, "a node of the element") : whole(fields, 5, "node 4 of the element");
      // Left out or 0 is the manual's other way to write a triangle.
      if (i == 3 && quad.nodes[3] == 0) quad.nodes[3] = quad.nodes[2];
    }
    for (std::size_t i = 6; i < 10; ++i)
      if (whole(fields, i, "a node of the element") != 0)
        fail("element " + std::to_string(quad.id) + " has nodes on its sides", trimmed(line_),
             "only shells of four nodes are known");
    if (with_thickness) quad.thickness = read_corner_thicknesses(quad.id);
    mesh_.quads.push_back(quad);
  }

  /// One thickness for the four of a card: their mean. All 0 or blank: the section's counts.
  std::optional<double> read_corner_thicknesses(FileId element) {
    need_line("the thickness card of element " + std::to_string(element));
    return mean_thickness(card(thickness_widths), "a thickness of element " + std::to_string(element));
  }

  std::optional<double> mean_thickness(const Fields& fields, const std::string& wanted) {
    double sum = 0, first = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double given = field(fields, i).empty() ? 0 : real(fields, i, wanted);
      if (given < 0)
        fail(wanted + " is negative", field(fields, i),
             "it must be positive, or 0 to be taken from elsewhere");
      if (i == 0) first = given;
      const double value = given == 0 ? first : given;
      differ_ = differ_ || value != first;
      sum += value;
    }
    if (sum == 0) return std::nullopt;
    return sum / 4;
  }

  std::size_t part(FileId number) {
    const auto [found, is_new] = part_index_.try_emplace(number, mesh_.parts.size());
    if (is_new) {
      mesh_.parts.push_back({"part " + std::to_string(number), "", std::nullopt});
      part_section_.push_back(0);
    }
    return found->second;
  }

  /// A title may be blank, so blank lines count here; but not those before the next keyword.
  bool next_part_title() {
    std::string_view ahead = text_;
    while (!ahead.empty() &&
           (ahead[0] == '$' || trimmed(ahead.substr(0, ahead.find_first_of("\r\n"))).empty()))
      ahead.remove_prefix(std::min(ahead.find('\n'), ahead.size() - 1) + 1);
    return !ahead.empty() && ahead[0] != '*' && next_line();
  }

  void read_part() {
    const std::string title(trimmed(line_));
    need_line("the card below the title of a *PART");
    const Fields fields = card(common_widths);
    const FileId number = id(fields, 0, "the part's number");
    const std::size_t index = part(number);
    if (!titled_.emplace(number, number_).second)
      fail("part " + std::to_string(number) + " is there already, in line " + std::to_string(titled_[number]),
           "", "give every one a number of its own");
    mesh_.parts[index].name = title;
    part_section_[index] = whole(fields, 1, "the part's section");
  }

  void read_section(bool with_title) {
    if (with_title) need_line("the card below the title of a *SECTION_SHELL");
    const Fields fields = card(common_widths);
    const FileId number = id(fields, 0, "the section's number");
    const FileId points = whole(fields, 3, "the section's count of points");
    const bool composite = whole(fields, 6, "the section's ICOMP") == 1;
    need_line("the thickness card of section " + std::to_string(number));
    const Fields fields_below = card(common_widths);
    offset_ =
        offset_ || (!field(fields_below, 4).empty() && real(fields_below, 4, "the section's NLOC") != 0);
    const auto thickness = mean_thickness(fields_below, "a thickness of section " + std::to_string(number));
    if (!sections_.try_emplace(number, Section{thickness}).second)
      fail("section " + std::to_string(number) + " is there already", "",
           "give every one a number of its own");
    if (!composite) return;
    for (FileId i = 0; i < points; i += 8) need_line("a card of angles of section " + std::to_string(number));
  }

  void give_thicknesses() {
    for (const auto& [number, index] : part_index_)
      if (const auto section = sections_.find(part_section_[index]); section != sections_.end())
        mesh_.parts[index].thickness = section->second.thickness;
    if (differ_)
      mesh_.notes.push_back(mesh_.file +
                            ": shells whose corners differ in thickness get the mean of the four");
    if (offset_)
      mesh_.notes.push_back(mesh_.file +
                            ": NLOC of *SECTION_SHELL is left out: nodes are on the mid-surface");
  }

  void note_skipped_keywords() {
    if (skipped_.empty()) return;
    std::string names;
    for (const std::string& keyword : skipped_) names += (names.empty() ? "" : ", ") + printable(keyword);
    mesh_.notes.push_back(mesh_.file + ": left out are " + names);
  }

  std::string_view text_;  // what is still to be read
  std::string_view line_;
  std::size_t number_ = 0;  // of line_
  FileMesh mesh_;
  std::map<FileId, std::size_t> part_index_, titled_;
  std::vector<FileId> part_section_;  // per part
  std::map<FileId, Section> sections_;
  std::set<std::string> skipped_;  // keywords
  bool differ_ = false;            // corners of a shell, in thickness
  bool offset_ = false;            // a section's reference surface is not the middle
};

}  // namespace

FileMesh read_keyword_mesh(std::string_view text, const std::string& file) {
  return KeywordReader(text, file).read();
}

}  // namespace tuft::fe
