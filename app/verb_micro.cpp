#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <list>
#include <optional>

#include "app/micro_tables.h"
#include "app/report_data.h"
#include "app/verbs.h"
#include "core/error.h"
#include "dem_bridge/scratch_folder.h"
#include "rigs/checkpoint_moment.h"
#include "rigs/run_folder.h"

namespace tuft::app {
namespace {

struct MicroArguments {
  std::string folder, csv;
  std::vector<int> frames;  ///< none: the last; one, or one for each run
  bool checkpoint = false;
  std::string out, cell, width, host;  ///< for the checkpoint
  int threads = -1;
};

using Path = std::filesystem::path;

std::size_t recorded_frames(const Path& folder) {
  std::error_code ignored;
  if (!std::filesystem::exists(folder / "run.h5", ignored)) return 0;
  return coupler::micro_frames(h5::File::open(folder / "run.h5").root());
}

MicroMoment read_moment(const Path& file, std::size_t frame, std::string source) {
  const h5::Group root = h5::File::open(file).root();
  MicroMoment moment{root.attribute("approach"), std::move(source), root, frame, {}, {}};
  if (coupler::has_contacts(root)) moment.network = coupler::read_contacts(root, frame);
  if (coupler::has_fields(root)) moment.fields = coupler::read_fields(root, frame);
  return moment;
}

MicroMoment read_frame(const Path& folder, std::optional<int> wanted) {
  const std::size_t frames = recorded_frames(folder);
  if (frames == 0)
    throw_input_error(
        "{}: this run recorded neither contacts nor fields with its frames; leave --frame out for those of "
        "its checkpoint, or run its scene with --set output.micro.contacts=true",
        folder.string());
  const std::size_t frame = wanted ? static_cast<std::size_t>(*wanted) : frames - 1;
  if (frame >= frames)
    throw_input_error("{}: there is no frame {}; the last is {}", folder.string(), frame, frames - 1);
  return read_moment(folder / "run.h5", frame, fmt::format("frame {}", frame));
}

/// The scene of a run, that it may be restored, and what is recorded of the moment: all.
struct MomentScenes {
  Scene of_run, recorded;
};

MomentScenes read_scenes(const Path& folder, const MicroArguments& arguments) {
  const auto text = [](const std::string& value) { return fmt::format("\"{}\"", value); };
  Overrides host;
  if (!arguments.host.empty()) host.emplace_back("infill.dem.host", text(arguments.host));
  Overrides all = host;
  all.emplace_back("output.micro.contacts", "true");
  all.emplace_back("output.micro.fields", "true");
  if (!arguments.cell.empty()) all.emplace_back("output.micro.cell", text(arguments.cell));
  if (!arguments.width.empty()) all.emplace_back("output.micro.width", text(arguments.width));
  MomentScenes scenes{rigs::read_run_scene(folder, host), {}};
  if (scenes.of_run.rig.is_component())
    throw_input_error("{}: the rig {} has no infill, so there are neither contacts nor fields of it",
                      folder.string(), scenes.of_run.rig.type);
  scenes.recorded = rigs::read_run_scene(folder, all);
  if (arguments.threads >= 0) scenes.of_run.numerics.threads = arguments.threads;
  return scenes;
}

/// Goes by way of a file that is laid out as run.h5, so that it is the same to look at this moment as at a
/// frame.
MicroMoment take_from_checkpoint(const Path& folder, const MicroArguments& arguments, const Path& into) {
  const MomentScenes scenes = read_scenes(folder, arguments);
  rigs::record_moment(rigs::restore_checkpoint(folder, scenes.of_run), scenes.recorded, into);
  return read_moment(into / "run.h5", 0, "checkpoint");
}

void check_checkpoint(const Path& folder, const MicroArguments& arguments) {
  std::error_code ignored;
  if (std::filesystem::exists(folder / "checkpoint.h5", ignored)) return;
  if (!std::filesystem::exists(folder / "scene.toml", ignored))
    throw_input_error(
        "{}: not the folder of a run: it holds no scene.toml; give a folder that `tuft run` wrote",
        folder.string());
  throw_input_error(
      "{}: {}no checkpoint to take contacts and fields from; run its scene with output.checkpoint_every "
      "above "
      "0, or with --set output.micro.contacts=true",
      folder.string(), arguments.checkpoint ? "" : "this run recorded neither contacts nor fields, and has ");
}

void make_folder(const Path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw_input_error("{}: cannot be created: {}; choose another --out", folder.string(), failure.message());
}

void write_csv(const std::string& path, const ContactNetwork& network) {
  std::ofstream file(path, std::ios::trunc);
  file << "kind,particle,other,branch_x_m,branch_y_m,branch_z_m,normal_x_N,normal_y_N,normal_z_N,tangential_"
          "x_N,"
          "tangential_y_N,tangential_z_N,overlap_m\n";
  constexpr const char* kinds[] = {"grain", "backing", "fibre", "body"};
  for (std::size_t c = 0; c < network.size(); ++c) {
    const Vec3 b = network.branch[c], n = network.normal_force[c], t = network.tangential_force[c];
    file << fmt::format("{},{},{},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g}\n",
                        kinds[static_cast<std::size_t>(network.kind[c])], network.particle[c],
                        network.other[c], b.x(), b.y(), b.z(), n.x(), n.y(), n.z(), t.x(), t.y(), t.z(),
                        network.overlap[c]);
  }
  file.close();
  if (!file) throw_run_error("{}: cannot be written", path);
}

int micro_scale(const MicroArguments& arguments) {
  const std::vector<Path> folders = expand_run_folders({arguments.folder});
  if (!arguments.out.empty()) {
    if (folders.size() != 1) throw_input_error("--out wants the folder of one run");
    rigs::check_run_folder(arguments.out);
  }
  if (arguments.frames.size() > std::max(std::size_t{1}, folders.size()))
    throw_input_error("--frame: {} frames for {}; give one, or one for each run of a comparison",
                      arguments.frames.size(), folders.size() == 1 ? "one run" : "two runs");
  std::vector<MicroMoment> moments;
  std::list<dem::ScratchFolder> scratch;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    const Path& folder = folders[k];
    std::optional<int> frame;
    if (!arguments.frames.empty()) frame = arguments.frames[std::min(k, arguments.frames.size() - 1)];
    if (!arguments.checkpoint && (frame || recorded_frames(folder) > 0)) {
      moments.push_back(read_frame(folder, frame));
      continue;
    }
    check_checkpoint(folder, arguments);
    if (!arguments.out.empty()) make_folder(arguments.out);
    moments.push_back(take_from_checkpoint(
        folder, arguments, arguments.out.empty() ? scratch.emplace_back().path() : Path(arguments.out)));
  }
  if (!arguments.csv.empty()) {
    if (moments.size() != 1 || !moments[0].network)
      throw_input_error("--csv wants the folder of one run that recorded its contacts");
    write_csv(arguments.csv, *moments[0].network);
  }
  for (const MicroMoment& moment : moments) print_moment(moment);
  if (moments.size() == 2 && moments[0].fields && moments[1].fields)
    print_field_comparison(moments[0], moments[1]);
  if (!arguments.out.empty()) fmt::print("recorded: {}\n", (Path(arguments.out) / "run.h5").string());
  return 0;
}

}  // namespace

void register_micro(CLI::App& program, Action& action) {
  CLI::App* verb = program.add_subcommand(
      "micro",
      "Contacts and coarse-grained fields of a run, or of both of a comparison, at any of its frames "
      "that recorded them or at its last checkpoint");
  auto arguments = std::make_shared<MicroArguments>();
  verb->add_option("DIR", arguments->folder, "folder of a run, or of a comparison")->required();
  CLI::Option* frame =
      verb->add_option(
              "--frame", arguments->frames,
              "which frame, from 0; of a comparison one for both runs, or one for each, as 12,17; if "
              "left out the last, or the checkpoint of a run that recorded none")
          ->type_name("N[,M]")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->check(CLI::NonNegativeNumber);
  CLI::Option* checkpoint =
      verb->add_flag(
              "--checkpoint", arguments->checkpoint,
              "take the moment of the run's last checkpoint, whatever it recorded; changes nothing there")
          ->excludes(frame);
  verb->add_option("--csv", arguments->csv, "also write the contacts to this file, one a row");
  verb->add_option("--out", arguments->out,
                   "also record that moment there: run.h5, and run.xdmf for ParaView")
      ->type_name("DIR")
      ->needs(checkpoint);
  verb->add_option("--cell", arguments->cell, "edge of a cell, as \"2 mm\", in place of output.micro.cell")
      ->needs(checkpoint);
  verb->add_option("--width", arguments->width,
                   "coarse-graining width, as \"2 mm\", in place of output.micro.width")
      ->needs(checkpoint);
  verb->add_option("--threads", arguments->threads, "number of threads; 0: all cores")
      ->check(CLI::NonNegativeNumber)
      ->needs(checkpoint);
  verb->add_option("--host", arguments->host, "another host of the grains, as for tuft resume")
      ->type_name("HOST")
      ->needs(checkpoint);
  verb->callback([arguments, &action] { action = [arguments] { return micro_scale(*arguments); }; });
}

}  // namespace tuft::app
