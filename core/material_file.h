#pragma once
/// A material's file as text: the numbers in it, and the same text with some of them changed.
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace tuft {

/// A single number of the file.
struct MaterialNumber {
  std::string key;           ///< "continuum.pressure_exponential.modulus"
  std::string unit;          ///< SI; "1" for a plain number
  double value = 0;          ///< in that unit
  double low = 0, high = 0;  ///< what the key may be
  bool low_open = false, high_open = false;

  [[nodiscard]] bool allows(double x) const {
    return (low_open ? x > low : x >= low) && (high_open ? x < high : x <= high);
  }
};

struct MaterialFile {
  std::filesystem::path path;
  std::string name;  ///< of the material
  std::string text;
  std::vector<MaterialNumber> numbers;  ///< that are written in it; none of lists and curves
};

/// Reads a material's file. Throws InputError as the reading of a scene would.
[[nodiscard]] MaterialFile read_material_file(const std::filesystem::path& path, const std::string& name);

/// The text with other values (SI) for some of its keys, each in the unit in which it stands there, true to
/// rounding; all else is kept to the letter. Where `remark` is not empty, it
/// becomes the comment at the end of each changed line, in place of an earlier one with the same first word.
/// Throws InputError for a key that `numbers` has not.
[[nodiscard]] std::string with_numbers(const MaterialFile& file, const std::map<std::string, double>& values,
                                       const std::string& remark = "");

}  // namespace tuft
