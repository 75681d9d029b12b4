#include "coupler/micro_recorder.h"

#include <algorithm>
#include <cmath>

#include "coupler/whole_grains.h"
#include "micro_scale/coarse_fields.h"
#include "micro_scale/network_statistics.h"

namespace tuft::coupler {
namespace {

constexpr double room_above = 0.25;  // of the infill's depth
constexpr const char *distribution_path = "/micro/normal_force_density", *bins_name = "normal_force_bins";

/// Density of the solid of which a material is made, kg/m^3; 0: not known.
double solid_density(const Material& material, const std::vector<Material>& materials) {
  if (material.grain) return material.grain->density;
  double volume = 0;  // m^3/kg
  for (const GrainShare& share : material.grain_shares) {
    const Material& part = materials.at(static_cast<std::size_t>(share.material));
    if (!part.grain) return 0;
    volume += share.mass_fraction / part.grain->density;
  }
  return volume > 0 ? 1 / volume : 0;
}

/// Rows of three numbers each.
std::vector<double> flat(const Vec3Array& vectors) {
  std::vector<double> values;
  values.reserve(3 * vectors.size());
  for (std::size_t i = 0; i < vectors.size(); ++i)
    values.insert(values.end(), {vectors.x[i], vectors.y[i], vectors.z[i]});
  return values;
}
std::vector<double> flat(const std::vector<Vec3>& vectors) {
  std::vector<double> values;
  values.reserve(3 * vectors.size());
  for (const Vec3& v : vectors) values.insert(values.end(), {v.x(), v.y(), v.z()});
  return values;
}
/// By rows.
std::vector<double> flat(const std::vector<Mat3>& tensors) {
  std::vector<double> values;
  values.reserve(9 * tensors.size());
  for (const Mat3& t : tensors)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) values.push_back(t(row, column));
  return values;
}

bool has_contacts_inside(const Infill& infill) {
  return infill.stress_moments().empty();
}

void append(ContactNetwork& network, const ContactNetwork& more) {
  for (std::size_t c = 0; c < more.size(); ++c) {
    network.kind.push_back(more.kind[c]);
    network.particle.push_back(more.particle[c]);
    network.other.push_back(more.other[c]);
    network.branch.push_back(more.branch[c]);
    network.normal_force.push_back(more.normal_force[c]);
    network.tangential_force.push_back(more.tangential_force[c]);
    network.overlap.push_back(more.overlap[c]);
  }
}

/// Root mean square of the particles' spins, rad/s.
double spin_rms(const ParticleView& particles) {
  double sum = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) sum += particles.spin(i).squaredNorm();
  return particles.size() == 0 ? 0 : std::sqrt(sum / static_cast<double>(particles.size()));
}

}  // namespace

MicroSettings micro_settings(const Scene& scene) {
  const MicroOutput& wanted = scene.output.micro;
  MicroSettings settings;
  settings.contacts = wanted.contacts;
  settings.fields = wanted.fields;
  if (!wanted.fields) return settings;
  const double floor = scene.rig.is_specimen() ? 0 : scene.turf.carpet.backing_thickness,
               depth = scene.infill_depth();
  const Vec3 half(0.5 * scene.turf.size[0], 0.5 * scene.turf.size[1], 0);
  settings.grid = micro::make_grid(Vec3(0, 0, floor) - half,
                                   Vec3(0, 0, floor + (1 + room_above) * depth) + half, wanted.cell);
  if (scene.rig.is_specimen()) settings.grid.margin = 0.5 * scene.infill.sph.pitch;
  const double width = wanted.width > 0 ? wanted.width : settings.grid.spacing.maxCoeff();
  // A narrower kernel could fall between the centres of cells.
  settings.kernel = micro::lucy_kernel(std::max(width, 0.5 * settings.grid.spacing.norm()));
  for (const Material& material : scene.materials)
    settings.solid_density.push_back(solid_density(material, scene.materials));
  return settings;
}

std::vector<Channel> MicroRecorder::channels(const Simulation& simulation) const {
  std::vector<Channel> channels;
  if (settings_.contacts) {
    channels = {{"/micro/time", "s", {}},
                {"/micro/spin_rms", "rad/s", {}},
                {"/frames/contacts/end", "1", {}},
                {"/frames/contacts/pair", "1", {2}, false, true},
                {"/frames/contacts/kind", "1", {}, false, true},
                {"/frames/contacts/line", "1", {2}, false, true},
                {"/frames/contacts/ends", "m", {3}, true},  // two rows a contact
                {"/frames/contacts/force", "N", {}, true},
                {"/frames/contacts/normal_force", "N", {3}, true},
                {"/frames/contacts/tangential_force", "N", {3}, true},
                {"/frames/contacts/overlap", "m", {}, true}};
    for (const micro::NamedValue& value : named_values(micro::NetworkStatistics{}))
      channels.push_back({"/micro/" + value.name, value.unit, {}});
    channels.push_back({distribution_path, "1", {micro::ForceBins{}.count}});
    const ParticleView particles = simulation.infill().particles();
    if (!particles.wx.empty())
      channels.push_back({"/frames/infill/spin", "rad/s", {particles.size(), 3}, true});
  }
  if (settings_.fields) {
    const auto& n = settings_.grid.cells;
    const auto add = [&](const char* name, const char* unit, std::uint64_t components) {
      std::vector<std::uint64_t> shape{static_cast<std::uint64_t>(n[2]), static_cast<std::uint64_t>(n[1]),
                                       static_cast<std::uint64_t>(n[0])};
      if (components > 1) shape.push_back(components);
      channels.push_back({std::string("/frames/grid/") + name, unit, std::move(shape), true});
    };
    add("density", "kg/m^3", 1);
    add("velocity", "m/s", 3);
    add("stress", "Pa", 9);
    add("kinetic_stress", "Pa", 9);
    add("boundary_force", "N/m^3", 3);
    if (!solid_volumes(simulation.infill().particles()).empty()) add("porosity", "1", 1);
    if (has_contacts_inside(simulation.infill())) add("coordination", "1", 1);
    channels.push_back({"/frames/grid/mass_outside", "kg", {}});
  }
  return channels;
}

void MicroRecorder::write_static(h5::Group& root, const Simulation& simulation) const {
  if (!settings_.any()) return;
  if (const WholeGrains grains(simulation.infill()); !grains.grain_of_sphere().empty())
    root.open_group("frames").open_group("infill").write("grain", grains.grain_of_sphere());
  if (settings_.contacts) {
    const micro::ForceBins bins;
    std::vector<double> edges;
    for (std::size_t b = 0; b <= bins.count; ++b) edges.push_back(bins.width * static_cast<double>(b));
    auto group = root.open_group("micro");
    group.write(bins_name, std::span<const double>(edges));
    group.set_attribute("unit", "1", bins_name);
  }
  if (!settings_.fields) return;
  const micro::CoarseGrid& grid = settings_.grid;
  auto group = root.open_group("frames").open_group("grid");
  group.write("low", std::span<const double>(grid.low.data(), 3));
  group.write("spacing", std::span<const double>(grid.spacing.data(), 3));
  group.write("cells", std::span<const std::int32_t>(grid.cells));
  group.write_scalar("width", 0.5 * settings_.kernel.cutoff);
  for (const char* length : {"low", "spacing", "width"}) group.set_attribute("unit", "m", length);
}

std::vector<double> MicroRecorder::solid_volumes(const ParticleView& particles) const {
  std::vector<double> volumes(particles.size());
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const double density = settings_.solid_density.at(static_cast<std::size_t>(particles.material[i]));
    if (!(density > 0)) return {};
    volumes[i] = particles.mass[i] / density;
  }
  return volumes;
}

void MicroRecorder::record(RecordFile& file, double time, const Simulation& simulation) {
  if (!settings_.any()) return;
  const WholeGrains grains(simulation.infill());
  ContactNetwork of_spheres = simulation.infill().contacts();
  append(of_spheres, simulation.boundary_contacts());
  const ContactNetwork network = grains.network_of(of_spheres);
  if (settings_.contacts) record_contacts(file, time, simulation, grains.view(), network);
  if (settings_.fields) record_fields(file, simulation, grains.view(), network);
}

void MicroRecorder::record_contacts(RecordFile& file, double time, const Simulation& simulation,
                                    const ParticleView& particles, const ContactNetwork& network) {
  std::vector<double> pair, kind, line, ends, force;
  for (std::size_t c = 0; c < network.size(); ++c) {
    const Vec3 start = particles.position(static_cast<std::size_t>(network.particle[c])),
               end = start + network.branch[c];
    pair.insert(pair.end(),
                {static_cast<double>(network.particle[c]), static_cast<double>(network.other[c])});
    kind.push_back(static_cast<double>(network.kind[c]));
    line.insert(line.end(), {2.0 * static_cast<double>(c), 2.0 * static_cast<double>(c) + 1});
    ends.insert(ends.end(), {start.x(), start.y(), start.z(), end.x(), end.y(), end.z()});
    force.push_back(network.force(c).norm());
  }
  file.append_rows("/frames/contacts/pair", pair);
  file.append_rows("/frames/contacts/kind", kind);
  file.append_rows("/frames/contacts/line", line);
  file.append_rows("/frames/contacts/ends", ends);
  file.append_rows("/frames/contacts/force", force);
  file.append_rows("/frames/contacts/normal_force", flat(network.normal_force));
  file.append_rows("/frames/contacts/tangential_force", flat(network.tangential_force));
  file.append_rows("/frames/contacts/overlap", network.overlap);
  file.append("/frames/contacts/end", static_cast<double>(file.rows().at("/frames/contacts/kind")));
  if (const ParticleView spheres = simulation.infill().particles(); spheres.has_spin()) {
    Vec3Array spin;
    for (std::size_t i = 0; i < spheres.size(); ++i) spin.push_back(spheres.spin(i));
    file.append("/frames/infill/spin", flat(spin));
  }
  file.append("/micro/time", time);
  file.append("/micro/spin_rms", spin_rms(particles));
  for (const micro::NamedValue& value : named_values(micro::describe_network(network, particles.size())))
    file.append("/micro/" + value.name, value.value);
  // Files that versions before began do not have it.
  if (file.rows().contains(distribution_path))
    file.append(distribution_path, micro::force_distribution(network));
}

void MicroRecorder::record_fields(RecordFile& file, const Simulation& simulation,
                                  const ParticleView& particles, const ContactNetwork& network) const {
  const Infill& infill = simulation.infill();
  const auto moments = infill.stress_moments();
  const std::vector<double> solid = solid_volumes(particles);
  std::vector<double> coordination;
  if (moments.empty()) coordination = micro::count_coordination(network, particles.size());
  const micro::CoarseFields fields = micro::coarse_grain(settings_.grid, settings_.kernel, particles,
                                                         {solid, coordination, moments}, network);
  file.append("/frames/grid/density", fields.density);
  file.append("/frames/grid/velocity", flat(fields.velocity));
  file.append("/frames/grid/stress", flat(fields.stress));
  file.append("/frames/grid/kinetic_stress", flat(fields.kinetic_stress));
  file.append("/frames/grid/boundary_force", flat(fields.boundary_force));
  if (!fields.porosity.empty()) file.append("/frames/grid/porosity", fields.porosity);
  if (!fields.coordination.empty()) file.append("/frames/grid/coordination", fields.coordination);
  file.append("/frames/grid/mass_outside", fields.outside_mass);
}

}  // namespace tuft::coupler
