#pragma once
/// What the verbs share on the command line.
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene.h"
#include "core/scene_reader.h"

namespace CLI {
class App;
}

namespace tuft::app {

/// A verb sets what is to be done once the whole line has been read; the action returns the exit code.
using Action = std::function<int()>;

/// SCENE with --set, --infill and --threads.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> settings;  ///< "key=value"
  std::string infill;                 ///< "sph", "dem" or empty
  int threads = -1;                   ///< -1: as the scene says
};

void add_scene_options(CLI::App& verb, SceneArguments& arguments, bool with_infill);

/// Reads the scene with its overrides. `approach` non-empty goes before everything. Throws InputError.
[[nodiscard]] Scene read_scene_arguments(const SceneArguments& arguments, const std::string& approach = {});

/// "key=value" -> pair. Throws InputError for text without '=' or with an empty key.
[[nodiscard]] Overrides parse_settings(const std::vector<std::string>& settings);

/// The candidate with the fewest edits to a word, if it is close enough to be a slip of the fingers; else
/// empty.
[[nodiscard]] std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// Reads the command line and does it. Prints at most one line on standard error. Returns the exit code: 0
/// done, 1 the run failed, 2 bad input.
[[nodiscard]] int run_command_line(int count, const char* const* arguments);

}  // namespace tuft::app
