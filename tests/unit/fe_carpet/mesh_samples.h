#pragma once
/// The sample files of data/: one backing of 2 x 2 quads of 10 mm with one tuft of two strands of two quads.
#include <algorithm>
#include <string>

#include "core/scene_files.h"
#include "fe_carpet/mesh_import.h"

namespace tuft::fe::test {

inline std::string sample_path(const std::string& name) {
  return "tests/unit/fe_carpet/data/" + name;
}
inline std::string sample(const std::string& name) {
  return read_text_file(sample_path(name));
}

/// Lengths in mm; thicknesses of a design for what the file leaves open.
inline MeshImportOptions sample_options() {
  MeshImportOptions options;
  options.backing_thickness = 0.002;
  options.strand_thickness = 0.0001;
  return options;
}

/// The text with the first `old_text` replaced; the test fails to make sense when there is none.
inline std::string with(std::string text, const std::string& old_text, const std::string& new_text) {
  const std::size_t at = text.find(old_text);
  return at == std::string::npos ? "no '" + old_text + "' in the sample"
                                 : text.replace(at, old_text.size(), new_text);
}

/// The number of the line on which `words` begin.
inline std::string line_of(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace tuft::fe::test
