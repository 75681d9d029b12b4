#include "app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>

#include "app/verbs.h"
#include "core/error.h"

namespace tuft::app {
namespace {

constexpr int exit_failed = 1, exit_bad_input = 2;

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

/// The error of last resort, but still one line.
int print_error(const std::string& text, int code) {
  std::string line = text;
  std::replace(line.begin(), line.end(), '\n', ' ');
  while (!line.empty() && line.back() == ' ') line.pop_back();
  fmt::print(stderr, "tuft: error: {}\n", line);
  return code;
}

std::vector<std::string> verb_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* verb : program.get_subcommands(nullptr)) names.push_back(verb->get_name());
  return names;
}

void check_verb(const CLI::App& program, int count, const char* const* arguments) {
  const std::vector<std::string> names = verb_names(program);
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  if (count < 2) throw_input_error("no verb given; one of: {} (tuft --help says more)", list);
  const std::string verb = arguments[1];
  if (verb.starts_with('-') || std::find(names.begin(), names.end(), verb) != names.end()) return;
  const std::string near = nearest_word(verb, names);
  if (!near.empty()) throw_input_error("unknown verb '{}'; did you mean '{}'?", verb, near);
  throw_input_error("unknown verb '{}'; one of: {}", verb, list);
}

/// The parser's own words, with the nearest option where one was misspelt.
std::string describe_parse_error(const CLI::App& program, const CLI::ParseError& failure) {
  const auto chosen = program.get_subcommands();
  const CLI::App& verb = chosen.empty() ? program : *chosen.front();
  const std::string help =
      fmt::format("see tuft {}{}--help", chosen.empty() ? "" : verb.get_name(), chosen.empty() ? "" : " ");
  if (dynamic_cast<const CLI::ExtrasError*>(&failure) == nullptr)
    return fmt::format("{}; {}", failure.what(), help);
  const std::vector<std::string> extras = verb.remaining(true);
  const std::string extra =
      extras.empty() ? std::string() : extras.front().substr(0, extras.front().find('='));
  std::vector<std::string> options;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  const std::string near = extra.starts_with('-') ? nearest_word(extra, options) : std::string();
  if (!near.empty()) return fmt::format("unknown option '{}'; did you mean '{}'?", extra, near);
  return fmt::format("unexpected argument '{}'; {}", extra, help);
}

}  // namespace

std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t fewest = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t edits = edit_distance(word, candidate);
    if (edits < fewest && edits < candidate.size()) {
      fewest = edits;
      best = candidate;
    }
  }
  return best;
}

Overrides parse_settings(const std::vector<std::string>& settings) {
  Overrides overrides;
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0)
      throw_input_error("--set {}: not of the form key=value, e.g. --set numerics.seed=2", setting);
    overrides.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
  }
  return overrides;
}

void add_scene_options(CLI::App& verb, SceneArguments& arguments, bool with_infill) {
  verb.add_option("SCENE", arguments.scene, "scene file (TOML)")->required();
  // One value for each --set: otherwise the parser would take the scene's name for another one.
  verb.add_option("--set", arguments.settings, "override a key of the scene, e.g. rig.clegg.speed='2 m/s'")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all()
      ->allow_extra_args(false);
  if (with_infill)
    verb.add_option("--infill", arguments.infill, "how the infill is modelled, instead of the scene's choice")
        ->check(CLI::IsMember({"sph", "dem"}));
  verb.add_option("--threads", arguments.threads, "number of threads; 0: all cores")
      ->check(CLI::NonNegativeNumber);
}

Scene read_scene_arguments(const SceneArguments& arguments, const std::string& approach) {
  Overrides overrides = parse_settings(arguments.settings);
  const std::string& chosen = approach.empty() ? arguments.infill : approach;
  if (!chosen.empty()) overrides.emplace_back("infill.approach", chosen);
  if (arguments.threads >= 0)
    overrides.emplace_back("numerics.threads", fmt::format("{}", arguments.threads));
  return read_scene(arguments.scene, overrides);
}

int run_command_line(int count, const char* const* arguments) {
  CLI::App program(
      "tuft: synthetic turf under load. FE carpet coupled with SPH or DEM infill, compared in result and in "
      "cost.",
      "tuft");
  program.require_subcommand(1);
  program.set_version_flag("--version", std::string("tuft ") + TUFT_VERSION);
  program.footer("Exit codes: 0 done, 1 the run failed and says why, 2 bad input.");
  Action action;
  register_run(program, action);
  register_resume(program, action);
  register_check(program, action);
  register_explain(program, action);
  register_carpet(program, action);
  register_compare(program, action);
  register_point(program, action);
  register_calibrate(program, action);
  register_report(program, action);
  register_micro(program, action);
  register_show(program, action);
  try {
    check_verb(program, count, arguments);
    program.parse(count, arguments);
    return action();
  } catch (const CLI::ParseError& failure) {
    if (failure.get_exit_code() == 0) return program.exit(failure);  // --help, --version
    return print_error(describe_parse_error(program, failure), exit_bad_input);
  } catch (const InputError& failure) {
    return print_error(failure.what(), exit_bad_input);
  } catch (const RunError& failure) {
    return print_error(failure.what(), exit_failed);
  } catch (const std::bad_alloc&) {
    return print_error("out of memory; make the patch smaller or the pitch coarser", exit_failed);
  } catch (const std::exception& failure) {
    return print_error(fmt::format("{} (a defect of the program: please report it)", failure.what()),
                       exit_failed);
  }
}

}  // namespace tuft::app
