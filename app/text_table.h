#pragma once
/// Aligned tables for the terminal.
#include <string>
#include <vector>

namespace tuft::app {

/// First column to the left, the others to the right unless told otherwise; rows may be shorter than the
/// widest.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header = {}) : header_(std::move(header)) {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Column that holds prose: to the left, not padded.
  void set_prose(std::size_t column) { prose_ = column; }
  [[nodiscard]] std::string text(const std::string& indent = "  ") const;

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
  std::size_t prose_ = static_cast<std::size_t>(-1);
};

}  // namespace tuft::app
