#pragma once
/// Scene files: TOML, quantities as strings with units ("2 mm"), read strictly and validated once.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/scene.h"
#include "core/scene_files.h"

namespace tuft {

/// key.path = text, as given by `--set`.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// Reads a scene and everything it names (turf design, materials: looked for beside the scene, in its folders
/// `turfs/` and `materials/`, then in the same folders of the program's inputs). Throws InputError, one line:
/// file:line, key, the value, what to do. Where `texts` has a material that the scene names, its text is read in place
/// of the file.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file, const Overrides& overrides = {},
                               const MaterialTexts& texts = {});
/// The same from text, for resolved scenes inside result files; `name` stands for the file in messages.
[[nodiscard]] Scene read_scene_text(const std::string& text, const std::string& name, const Overrides& overrides = {});

/// The scene with every default written out, everything inline (carpet and materials too): reading it back gives the
/// same structs, bit for bit, wherever it is.
[[nodiscard]] std::string write_scene(const Scene& scene);

/// Content hash (hex, 16 digits) of a text: identifies scenes in checkpoints and packings in the cache.
[[nodiscard]] std::string content_hash(const std::string& text);

/// "2 mm" -> 0.002 for unit "m". Throws InputError without a place; readers add it.
[[nodiscard]] double parse_quantity(const std::string& text, const std::string& si_unit);

/// Markdown table of all keys: name, unit, default, range, meaning; generated from the code that reads them.
[[nodiscard]] std::string scene_reference();

}  // namespace tuft
