#include "rigs/xdmf_micro.h"

#include <algorithm>

#include "rigs/xdmf_items.h"

namespace tuft::rigs::xdmf {
namespace {

bool is_static(const std::string& name) {
  return name == "low" || name == "spacing" || name == "cells" || name == "width";
}

std::string three(const std::vector<double>& v) {
  return fmt::format(
      "<DataItem Dimensions=\"3\" NumberType=\"Float\" Precision=\"8\" Format=\"XML\">{:.9g} {:.9g} "
      "{:.9g}</DataItem>",
      v.at(2), v.at(1), v.at(0));
}

}  // namespace

std::uint64_t whole_micro_frames(const h5::Group& frames, std::uint64_t frames_of_run) {
  std::uint64_t whole = frames_of_run;
  if (frames.has("contacts")) whole = std::min(whole, frames.open_group("contacts").shape("end").at(0));
  if (frames.has("grid")) {
    const h5::Group grid = frames.open_group("grid");
    for (const std::string& name : grid.names())
      if (!is_static(name)) whole = std::min(whole, grid.shape(name).at(0));
  }
  return whole;
}

MicroGrids::MicroGrids(const h5::Group& frames, std::string file) : frames_(frames), file_(std::move(file)) {
  if (frames.has("contacts")) end_ = frames.open_group("contacts").read_doubles("end");
}

std::string MicroGrids::item(const std::string& name, std::uint64_t first, std::uint64_t rows,
                             bool integer) const {
  const Shape shape = frames_.open_group("contacts").shape(name);
  Shape as = shape;
  as[0] = rows;
  return rows_item(file_, "/frames/contacts/" + name, shape, first, rows, as, integer);
}

std::string MicroGrids::contacts(std::uint64_t frame) const {
  if (frame >= end_.size()) return {};
  const auto first = frame == 0 ? 0 : static_cast<std::uint64_t>(end_[frame - 1]);
  const std::uint64_t count = static_cast<std::uint64_t>(end_[frame]) - first;
  if (count == 0) return {};
  std::string text = "      <Grid Name=\"contacts\" GridType=\"Uniform\">\n";
  text += fmt::format(
      "        <Topology TopologyType=\"Polyline\" NumberOfElements=\"{}\" NodesPerElement=\"2\">\n          "
      "{}\n"
      "        </Topology>\n",
      count, item("line", first, count, true));
  text += fmt::format("        <Geometry GeometryType=\"XYZ\">\n          {}\n        </Geometry>\n",
                      item("ends", 2 * first, 2 * count, false));
  text += attribute("force", "Scalar", item("force", first, count, false), "Cell");
  text += attribute("kind", "Scalar", item("kind", first, count, true), "Cell");
  text += attribute("overlap", "Scalar", item("overlap", first, count, false), "Cell");
  text += attribute("normal_force", "Vector", item("normal_force", first, count, false), "Cell");
  text += attribute("tangential_force", "Vector", item("tangential_force", first, count, false), "Cell");
  return text + "      </Grid>\n";
}

std::string MicroGrids::fields(std::uint64_t frame) const {
  if (!frames_.has("grid")) return {};
  const h5::Group grid = frames_.open_group("grid");
  const Shape density = grid.shape("density");
  std::string text = fmt::format(
      "      <Grid Name=\"fields\" GridType=\"Uniform\">\n"
      "        <Topology TopologyType=\"3DCoRectMesh\" Dimensions=\"{} {} {}\"/>\n"
      "        <Geometry GeometryType=\"ORIGIN_DXDYDZ\">\n          {}\n          {}\n        </Geometry>\n",
      density.at(1) + 1, density.at(2) + 1, density.at(3) + 1, three(grid.read_doubles("low")),
      three(grid.read_doubles("spacing")));
  for (const std::string& name : grid.names()) {
    const Shape shape = grid.shape(name);
    if (is_static(name) || shape.size() < 4) continue;
    const char* type = shape.size() == 4 ? "Scalar" : shape[4] == 3 ? "Vector" : "Tensor";
    text += attribute(name, type, frame_item(file_, "/frames/grid/" + name, shape, frame), "Cell");
  }
  return text + "      </Grid>\n";
}

}  // namespace tuft::rigs::xdmf
