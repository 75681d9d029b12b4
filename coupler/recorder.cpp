#include "coupler/recorder.h"

#include <chrono>
#include <utility>

namespace tuft::coupler {
namespace {

std::vector<double> interleave(std::span<const double> x, std::span<const double> y,
                               std::span<const double> z) {
  std::vector<double> flat(3 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    flat[3 * i] = x[i];
    flat[3 * i + 1] = y[i];
    flat[3 * i + 2] = z[i];
  }
  return flat;
}

std::vector<Channel> declare_channels(const Simulation& simulation,
                                      const std::vector<RecordedColumn>& columns,
                                      const std::vector<RecordedColumn>& finished) {
  const std::uint64_t particles = simulation.infill().particles().size();
  const std::uint64_t nodes = simulation.carpet().nodes().x.size();
  std::vector<Channel> channels{{"/history/time", "s", {}, false},
                                {"/energy/time", "s", {}, false},
                                {"/frames/time", "s", {}, false},
                                {"/cost/time", "s", {}, false}};
  for (const RecordedColumn& c : columns) channels.push_back({"/history/" + c.name, c.unit, {}, false});
  for (const RecordedColumn& c : finished) channels.push_back({"/history/" + c.name, c.unit, {}, false});
  for (const auto name : EnergyTerms::names)
    channels.push_back({"/energy/" + std::string(name), "J", {}, false});
  channels.push_back({"/energy/error", "1", {}, false});
  for (const auto name : phase_names) channels.push_back({"/cost/" + std::string(name), "s", {}, false});
  channels.push_back({"/frames/infill/position", "m", {particles, 3}, true});
  channels.push_back({"/frames/infill/velocity", "m/s", {particles, 3}, true});
  for (const auto& field : simulation.infill().fields())
    channels.push_back({"/frames/infill/" + field.name, field.unit, {particles}, true});
  if (nodes > 0) channels.push_back({"/frames/carpet/position", "m", {nodes, 3}, true});
  if (const std::uint64_t shells = simulation.carpet().eroded().size(); shells > 0)
    channels.push_back({"/frames/carpet/eroded", "1", {shells}, true});
  for (const RigidBody& body : simulation.bodies())
    if (body.can_move()) channels.push_back({"/frames/bodies/" + body.name + "/position", "m", {3}, false});
  return channels;
}

/// What of the moving bodies' shapes never changes.
void write_bodies(h5::Group& frames, const Simulation& simulation) {
  for (const RigidBody& body : simulation.bodies()) {
    if (!body.can_move()) continue;
    auto group = frames.open_group("bodies").open_group(body.name);
    if (const auto* cylinder = std::get_if<Cylinder>(&body.shape)) {
      group.write_scalar("radius", cylinder->radius);
      group.write_scalar("height", cylinder->height);
    }
  }
}

void write_static(h5::Group& root, const Simulation& simulation, const std::string& scene_text,
                  const std::string& version) {
  root.set_attribute("version", version);
  root.set_attribute("approach", simulation.infill().approach());
  root.write_string("scene", scene_text);
  const ParticleView p = simulation.infill().particles();
  auto frames = root.open_group("frames");
  auto infill = frames.open_group("infill");
  infill.write("radius", p.radius);
  infill.set_attribute("unit", "m", "radius");
  infill.write("layer", p.layer);
  infill.write("material", p.material);
  write_bodies(frames, simulation);
  const fe::ShellMesh& mesh = simulation.carpet().mesh();
  if (mesh.nodes.size() == 0) return;
  std::vector<std::int32_t> quads;
  quads.reserve(4 * mesh.quads.size());
  for (const auto& quad : mesh.quads) quads.insert(quads.end(), quad.begin(), quad.end());
  auto carpet = frames.open_group("carpet");
  carpet.write("quads", std::span<const std::int32_t>(quads), {mesh.quads.size(), 4});
  carpet.write("surface", std::span<const std::int32_t>(mesh.surface));
  carpet.write("thickness", std::span<const double>(mesh.thickness));
  carpet.set_attribute("unit", "m", "thickness");
}

}  // namespace

Recorder Recorder::create(const std::filesystem::path& path, const Simulation& simulation,
                          const std::string& scene_text, const std::string& version,
                          const std::vector<RecordedColumn>& columns,
                          const std::vector<RecordedColumn>& finished, const MicroSettings& micro) {
  const MicroRecorder micro_recorder(micro);
  std::vector<Channel> channels = declare_channels(simulation, columns, finished);
  for (Channel& channel : micro_recorder.channels(simulation)) channels.push_back(std::move(channel));
  return {RecordFile::create(path, channels,
                             [&](h5::Group& root) {
                               write_static(root, simulation, scene_text, version);
                               micro_recorder.write_static(root, simulation);
                             }),
          columns, micro_recorder, simulation};
}

Recorder Recorder::reopen(const std::filesystem::path& path, const Simulation& simulation,
                          const std::map<std::string, std::uint64_t>& rows,
                          const std::vector<RecordedColumn>& columns, const MicroSettings& micro) {
  return {RecordFile::reopen(path, rows), columns, MicroRecorder(micro), simulation};
}

void Recorder::record_history(double time, const std::vector<double>& row, const EnergyLedger& ledger) {
  file_.append("/history/time", time);
  for (std::size_t c = 0; c < columns_.size(); ++c) file_.append("/history/" + columns_[c].name, row.at(c));
  if (std::exchange(entries_, ledger.entries()) == ledger.entries()) return;
  file_.append("/energy/time", time);
  const auto values = ledger.last().values();
  for (std::size_t i = 0; i < values.size(); ++i)
    file_.append("/energy/" + std::string(EnergyTerms::names[i]), values[i]);
  file_.append("/energy/error", ledger.error());
}

void Recorder::record_frame(double time, const Simulation& simulation) {
  const ParticleView p = simulation.infill().particles();
  file_.append("/frames/time", time);
  file_.append("/frames/infill/position", interleave(p.x, p.y, p.z));
  file_.append("/frames/infill/velocity", interleave(p.vx, p.vy, p.vz));
  for (const auto& field : simulation.infill().fields())
    file_.append("/frames/infill/" + field.name, field.values);
  const fe::NodeView n = simulation.carpet().nodes();
  if (!n.x.empty()) file_.append("/frames/carpet/position", interleave(n.x, n.y, n.z));
  if (const auto eroded = simulation.carpet().eroded(); !eroded.empty())
    file_.append("/frames/carpet/eroded", std::vector<double>(eroded.begin(), eroded.end()));
  for (const RigidBody& body : simulation.bodies())
    if (body.can_move())
      file_.append("/frames/bodies/" + body.name + "/position",
                   std::span<const double>(body.position.data(), 3));
  micro_.record(file_, time, simulation);
}

void Recorder::record_cost(double time, const std::map<std::string, double>& cost) {
  file_.append("/cost/time", time);
  for (const auto name : phase_names) file_.append("/cost/" + std::string(name), cost.at(std::string(name)));
}

void Recorder::record_finished(const std::string& name, const std::vector<double>& values) {
  for (const double value : values) file_.append("/history/" + name, value);
}

void Recorder::flush_when_due() {
  constexpr std::size_t most_bytes = 8 << 20;
  constexpr std::chrono::seconds longest_wait(2);
  const auto now = std::chrono::steady_clock::now();
  if (file_.buffered_bytes() < most_bytes && now - last_flush_ < longest_wait) return;
  file_.flush();
  last_flush_ = now;
}

}  // namespace tuft::coupler
