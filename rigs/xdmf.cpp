#include "rigs/xdmf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "rigs/xdmf_items.h"
#include "rigs/xdmf_micro.h"

namespace tuft::rigs {
namespace {

using xdmf::attribute;
using xdmf::data_item;
using xdmf::frame_item;
using xdmf::Shape;

/// What a moving set of points holds: fields that change [F, N] or [F, N, 3], and fields that do not [N].
struct Part {
  std::string name, path, topology;
  Shape position;  ///< [F, N, 3]
  std::vector<std::pair<std::string, Shape>> moving;
  std::vector<std::pair<std::string, Shape>> fixed_nodal;
  std::optional<Shape> eroded;  ///< [F, cells]: shells that failed
};

bool is_integer_field(const std::string& name) {
  return name == "layer" || name == "material" || name == "grain";
}

Part find_part(const h5::Group& frames, const std::string& name) {
  Part part{name, "/frames/" + name, {}, {}, {}, {}, {}};
  const h5::Group group = frames.open_group(name);
  part.position = group.shape("position");
  const std::uint64_t points = part.position.at(1);
  for (const std::string& member : group.names()) {
    if (member == "position" || member == "eroded") continue;
    const Shape shape = group.shape(member);
    const bool moves = shape.size() >= 2 && shape[0] == part.position[0] && shape[1] == points;
    if (moves && (shape.size() == 2 || shape[2] == 3)) part.moving.emplace_back(member, shape);
    if (!moves && shape.size() == 1 && shape[0] == points) part.fixed_nodal.emplace_back(member, shape);
  }
  return part;
}

std::string grid(const std::string& file, const Part& part, std::uint64_t frame) {
  std::string text = fmt::format("      <Grid Name=\"{}\" GridType=\"Uniform\">\n", part.name);
  text += part.topology;
  text += fmt::format("        <Geometry GeometryType=\"XYZ\">\n          {}\n        </Geometry>\n",
                      frame_item(file, part.path + "/position", part.position, frame));
  for (const auto& [name, shape] : part.moving)
    text += attribute(name, shape.size() == 3 ? "Vector" : "Scalar",
                      frame_item(file, part.path + "/" + name, shape, frame));
  for (const auto& [name, shape] : part.fixed_nodal)
    text += attribute(name, "Scalar", data_item(file, part.path + "/" + name, shape, is_integer_field(name)));
  if (part.eroded)
    text +=
        attribute("eroded", "Scalar", frame_item(file, part.path + "/eroded", *part.eroded, frame), "Cell");
  return text + "      </Grid>\n";
}

/// A kill between two channels can leave one of them a row longer: only frames that all of them hold are
/// shown.
std::uint64_t whole_frames(const std::vector<Part>& parts, std::size_t times) {
  std::uint64_t frames = times;
  for (const Part& part : parts) {
    frames = std::min(frames, part.position[0]);
    for (const auto& [name, shape] : part.moving) frames = std::min(frames, shape[0]);
    if (part.eroded) frames = std::min(frames, part.eroded->at(0));
  }
  return frames;
}

Part infill_part(const h5::Group& frames) {
  Part part = find_part(frames, "infill");
  part.topology = fmt::format(
      "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{}\" NodesPerElement=\"1\"/>\n",
      part.position.at(1));
  return part;
}

Part carpet_part(const h5::Group& frames, const std::string& file) {
  Part part = find_part(frames, "carpet");
  const h5::Group group = frames.open_group("carpet");
  if (group.has("eroded")) part.eroded = group.shape("eroded");
  const Shape quads = group.shape("quads");
  part.topology = fmt::format(
      "        <Topology TopologyType=\"Quadrilateral\" NumberOfElements=\"{}\">\n          {}\n"
      "        </Topology>\n",
      quads.at(0), data_item(file, "/frames/carpet/quads", quads, true));
  if (group.has("surface")) {
    part.topology += fmt::format(
        "        <Attribute Name=\"surface\" AttributeType=\"Scalar\" Center=\"Cell\">\n          {}\n"
        "        </Attribute>\n",
        data_item(file, "/frames/carpet/surface", group.shape("surface"), true));
  }
  return part;
}

}  // namespace

std::string xdmf_text(const h5::Group& root, const std::string& file) {
  std::vector<Part> parts;
  std::vector<double> times;
  std::optional<xdmf::MicroGrids> micro;
  std::uint64_t whole = 0;
  if (root.has("frames")) {
    const h5::Group frames = root.open_group("frames");
    times = frames.read_doubles("time");
    if (frames.has("infill")) parts.push_back(infill_part(frames));
    if (frames.has("carpet")) parts.push_back(carpet_part(frames, file));
    micro.emplace(frames, file);
    whole = xdmf::whole_micro_frames(frames, whole_frames(parts, times.size()));
  }
  std::string text =
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
      "    <Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
  for (std::uint64_t frame = 0; frame < whole; ++frame) {
    text += fmt::format(
        "    <Grid Name=\"frame {}\" GridType=\"Collection\" CollectionType=\"Spatial\">\n"
        "      <Time Value=\"{:.9g}\"/>\n",
        frame, times[frame]);
    for (const Part& part : parts) text += grid(file, part, frame);
    text += micro->contacts(frame) + micro->fields(frame);
    text += "    </Grid>\n";
  }
  return text + "    </Grid>\n  </Domain>\n</Xdmf>\n";
}

void write_xdmf(const std::filesystem::path& folder) {
  const std::string text = xdmf_text(h5::File::open(folder / "run.h5").root(), "run.h5");
  std::ofstream file(folder / "run.xdmf", std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw_run_error("{}: cannot be written", (folder / "run.xdmf").string());
}

}  // namespace tuft::rigs
