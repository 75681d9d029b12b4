#include "coupler/micro_reader.h"

#include <algorithm>

namespace tuft::coupler {
namespace {

Vec3 vector_at(const std::vector<double>& values, std::size_t row) {
  return {values[3 * row], values[3 * row + 1], values[3 * row + 2]};
}

}  // namespace

bool has_contacts(const h5::Group& root) {
  return root.has("frames") && root.open_group("frames").has("contacts");
}

bool has_fields(const h5::Group& root) {
  return root.has("frames") && root.open_group("frames").has("grid");
}

std::size_t micro_frames(const h5::Group& root) {
  std::size_t frames = root.has("frames") ? root.open_group("frames").shape("time").at(0) : 0;
  if (has_contacts(root))
    frames = std::min({frames, root.open_group("frames").open_group("contacts").shape("end").at(0),
                       root.open_group("micro").shape("spin_rms").at(0)});
  if (has_fields(root))
    frames = std::min(frames, root.open_group("frames").open_group("grid").shape("mass_outside").at(0));
  return has_contacts(root) || has_fields(root) ? frames : 0;
}

double frame_time(const h5::Group& root, std::size_t frame) {
  return root.open_group("frames").read_doubles("time").at(frame);
}

std::size_t particle_count(const h5::Group& root) {
  const h5::Group infill = root.open_group("frames").open_group("infill");
  if (!infill.has("grain")) return infill.shape("position").at(1);
  return static_cast<std::size_t>(infill.read_ints("grain").back()) + 1;
}

double spin_rms(const h5::Group& root, std::size_t frame) {
  return root.open_group("micro").read_doubles("spin_rms").at(frame);
}

ContactNetwork read_contacts(const h5::Group& root, std::size_t frame) {
  const h5::Group group = root.open_group("frames").open_group("contacts");
  const std::vector<double> end = group.read_doubles("end");
  const auto first = frame == 0 ? std::size_t{0} : static_cast<std::size_t>(end.at(frame - 1));
  const auto last = static_cast<std::size_t>(end.at(frame));
  const std::vector<std::int32_t> pair = group.read_ints("pair"), kind = group.read_ints("kind");
  const std::vector<double> ends = group.read_doubles("ends"), normal = group.read_doubles("normal_force"),
                            tangential = group.read_doubles("tangential_force"),
                            overlap = group.read_doubles("overlap");
  ContactNetwork network;
  for (std::size_t c = first; c < last; ++c) {
    network.kind.push_back(static_cast<ContactKind>(kind.at(c)));
    network.particle.push_back(pair.at(2 * c));
    network.other.push_back(pair.at(2 * c + 1));
    network.branch.push_back(vector_at(ends, 2 * c + 1) - vector_at(ends, 2 * c));
    network.normal_force.push_back(vector_at(normal, c));
    network.tangential_force.push_back(vector_at(tangential, c));
    network.overlap.push_back(overlap.at(c));
  }
  return network;
}

RecordedFields read_fields(const h5::Group& root, std::size_t frame) {
  const h5::Group group = root.open_group("frames").open_group("grid");
  RecordedFields fields;
  fields.grid.low = vector_at(group.read_doubles("low"), 0);
  fields.grid.spacing = vector_at(group.read_doubles("spacing"), 0);
  const std::vector<std::int32_t> cells = group.read_ints("cells");
  std::copy_n(cells.begin(), 3, fields.grid.cells.begin());
  fields.width = group.read_double("width");
  fields.mass_outside = group.read_doubles("mass_outside").at(frame);
  for (const std::string& name : group.names()) {
    if (group.shape(name).size() < 4) continue;  // frames, three directions
    fields.values[name] = group.read_row(name, frame);
  }
  return fields;
}

}  // namespace tuft::coupler
