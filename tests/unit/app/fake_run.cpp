#include "unit/app/fake_run.h"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "core/record_file.h"
#include "core/scene_reader.h"
#include "rigs/run_folder.h"

namespace tuft::test {
namespace {

constexpr double row_interval = 2e-5, settling = 0.01, gravity = 9.80665;
constexpr double pi = std::numbers::pi;

/// A bed of points: a lattice for SPH, the same with random places and radii for grains.
struct Bed {
  std::vector<double> x, y, z, radius;
  std::vector<std::int32_t> layer, material;
};

/// A small generator of its own: the same bed on every machine.
struct Random {
  std::uint64_t state = 12345;
  double operator()() {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 11) / 9007199254740992.0;
  }
};

Bed make_bed(const Scene& scene) {
  const bool grains = scene.infill.approach == Approach::dem;
  const double pitch = grains ? 0.0028 : 0.0025;
  Bed bed;
  Random random;
  const double floor = scene.turf.carpet.backing_thickness;
  double bottom = floor;
  for (std::size_t l = 0; l < scene.turf.layers.size(); ++l) {
    const Layer& layer = scene.turf.layers[l];
    for (double z = bottom + 0.5 * pitch; z < bottom + layer.depth; z += pitch) {
      for (double x = -0.04 + 0.5 * pitch; x < 0.04; x += pitch) {
        for (double y = -0.04 + 0.5 * pitch; y < 0.04; y += pitch) {
          const double jitter = grains ? 0.35 * pitch : 0.0;
          bed.x.push_back(x + jitter * (random() - 0.5));
          bed.y.push_back(y + jitter * (random() - 0.5));
          bed.z.push_back(z + jitter * (random() - 0.5));
          bed.radius.push_back(grains ? pitch * (0.35 + 0.2 * random()) : 0.5 * pitch);
          bed.layer.push_back(static_cast<std::int32_t>(l));
          const bool mixed = grains && layer.material == 1;
          bed.material.push_back(mixed ? (random() < 0.5 ? 0 : 2) : layer.material);
        }
      }
    }
    bottom += layer.depth;
  }
  return bed;
}

struct Strands {
  std::vector<double> nodes;  // x y z
  std::vector<std::int32_t> quads, surface;
};

Strands make_strands(const CarpetDesign& carpet) {
  Strands mesh;
  Random random;
  const auto add_node = [&](double x, double y, double z) {
    mesh.nodes.insert(mesh.nodes.end(), {x, y, z});
    return static_cast<std::int32_t>(mesh.nodes.size() / 3 - 1);
  };
  for (int i = 0; i < 16; ++i) {
    const double x = -0.04 + 0.005 * i;
    const std::int32_t a = add_node(x, -0.002, 0.0008), b = add_node(x + 0.005, -0.002, 0.0008),
                       c = add_node(x + 0.005, 0.002, 0.0008), d = add_node(x, 0.002, 0.0008);
    mesh.quads.insert(mesh.quads.end(), {a, b, c, d});
    mesh.surface.push_back(0);
  }
  std::int32_t strand = 0;
  for (double x = -0.035; x < 0.04; x += 0.01) {
    for (int s = 0; s < 4; ++s) {
      ++strand;
      const double lean = 0.35 * (random() - 0.5), turn = 2 * pi * random();
      const double wx = 0.5 * carpet.strand_width * std::cos(turn),
                   wy = 0.5 * carpet.strand_width * std::sin(turn);
      std::int32_t left = add_node(x - wx, -wy, 0.0015), right = add_node(x + wx, wy, 0.0015);
      for (int e = 1; e <= 12; ++e) {
        const double t = e / 12.0, z = 0.0015 + carpet.pile_length * t,
                     dx = carpet.pile_length * lean * t * t;
        const std::int32_t next_left = add_node(x + dx - wx, -wy, z),
                           next_right = add_node(x + dx + wx, wy, z);
        mesh.quads.insert(mesh.quads.end(), {left, right, next_right, next_left});
        mesh.surface.push_back(strand);
        left = next_left;
        right = next_right;
      }
    }
  }
  return mesh;
}

/// A half-sine of force on a falling mass, integrated by hand.
struct Pulse {
  const FakeRun& run;
  double mass = 2.25, speed = 2.85;
  [[nodiscard]] double force(double t) const {
    const double s = t - run.touch;
    if (s < 0 || s > run.pulse) return 0;
    return run.peak_g * gravity * mass * std::sin(pi * s / run.pulse);
  }
  [[nodiscard]] double velocity(double t) const {
    const double s = std::clamp(t - run.touch, 0.0, run.pulse);
    return -speed + run.peak_g * gravity * run.pulse / pi * (1 - std::cos(pi * s / run.pulse));
  }
  [[nodiscard]] double penetration(double t) const {
    const double s = std::clamp(t - run.touch, 0.0, run.pulse), w = pi / run.pulse;
    const double during = speed * s - run.peak_g * gravity / w * (s - std::sin(w * s) / w);
    return during - velocity(run.touch + run.pulse) * std::max(0.0, t - run.touch - run.pulse) +
           (t < run.touch ? speed * (t - run.touch) : 0.0);
  }
};

std::vector<Channel> channels_of(std::size_t particles, std::size_t nodes, bool sph) {
  std::vector<Channel> channels{{"/history/time", "s", {}, false},
                                {"/history/acceleration", "m/s^2", {}, false},
                                {"/history/acceleration_filtered", "m/s^2", {}, false},
                                {"/history/velocity", "m/s", {}, false},
                                {"/history/penetration", "m", {}, false},
                                {"/history/contact_force", "N", {}, false},
                                {"/energy/time", "s", {}, false},
                                {"/cost/time", "s", {}, false},
                                {"/cost/contact", "s", {}, false},
                                {"/frames/time", "s", {}, false},
                                {"/frames/infill/position", "m", {particles, 3}, true},
                                {"/frames/infill/velocity", "m/s", {particles, 3}, true},
                                {"/frames/carpet/position", "m", {nodes, 3}, true},
                                {"/frames/bodies/missile/position", "m", {3}, true}};
  for (const char* term :
       {"kinetic_carpet", "kinetic_infill", "kinetic_bodies", "strain_carpet", "hourglass", "eroded",
        "stored_infill", "dissipated_infill", "contact_elastic", "contact_damping", "contact_friction",
        "gravity_potential", "damping", "expelled", "external_work"})
    channels.push_back({std::string("/energy/") + term, "J", {}, false});
  channels.push_back({"/energy/error", "1", {}, false});
  if (sph) channels.push_back({"/frames/infill/pressure", "Pa", {particles}, true});
  return channels;
}

void append_history(RecordFile& file, const FakeRun& run, const Pulse& pulse) {
  Random random;
  const double start_energy = 0.5 * pulse.mass * pulse.speed * pulse.speed;
  for (double t = -settling; t < run.duration; t += row_interval) {
    const double a = t < 0 ? 0 : pulse.force(t) / pulse.mass;
    file.append("/history/time", t);
    file.append("/history/acceleration", a == 0 ? 0 : a * (1 + 0.25 * (random() - 0.5)));
    file.append("/history/acceleration_filtered", a);
    file.append("/history/velocity", t < 0 ? 0 : pulse.velocity(t));
    file.append("/history/penetration", t < 0 ? 0 : pulse.penetration(t));
    file.append("/history/contact_force", t < 0 ? 0 : pulse.force(t));
    const double kinetic = t < 0 ? 0 : 0.5 * pulse.mass * std::pow(pulse.velocity(t), 2);
    const double given = t < 0 ? 0 : start_energy - kinetic;
    file.append("/energy/time", t);
    file.append("/energy/kinetic_carpet", 0.01 * given);
    file.append("/energy/kinetic_infill", 0.12 * given * std::max(0.0, 1 - t / run.duration));
    file.append("/energy/kinetic_bodies", kinetic);
    file.append("/energy/strain_carpet", 0.15 * given);
    file.append("/energy/hourglass", 0.001 * given);
    file.append("/energy/stored_infill", 0.4 * given);
    file.append("/energy/dissipated_infill", 0.2 * given);
    file.append("/energy/contact_elastic", 0.02 * given);
    file.append("/energy/contact_damping", 0.04 * given);
    file.append("/energy/contact_friction", 0.06 * given);
    file.append("/energy/gravity_potential", 0.3 - pulse.mass * gravity * (t < 0 ? 0 : pulse.penetration(t)));
    file.append("/energy/damping", t < 0 ? 1e-3 * (t + settling) : 1e-3 * settling);
    file.append("/energy/expelled", 0.0);
    file.append("/energy/external_work", t < 0 ? 0 : start_energy);
    file.append("/energy/error", 0.004 * given / start_energy);
    file.append("/cost/time", t);
    file.append("/cost/contact", t + settling);
  }
}

void append_frames(RecordFile& file, const FakeRun& run, const Pulse& pulse, const Bed& bed,
                   const Strands& strands, double surface) {
  for (double t = 0; t <= run.duration; t += run.frame_interval) {
    const double depth = pulse.penetration(t);
    file.append("/frames/time", t);
    std::vector<double> position, velocity;
    for (std::size_t i = 0; i < bed.x.size(); ++i) {
      const double r = std::hypot(bed.x[i], bed.y[i]);
      const double push =
          std::max(0.0, depth) * std::pow(bed.z[i] / surface, 2) / (1 + std::pow(r / 0.027, 8));
      position.insert(position.end(), {bed.x[i], bed.y[i], bed.z[i] - push});
      velocity.insert(velocity.end(), {0, 0, push > 0 ? pulse.velocity(t) : 0});
    }
    file.append("/frames/infill/position", position);
    file.append("/frames/infill/velocity", velocity);
    if (run.approach == Approach::sph)
      file.append("/frames/infill/pressure", std::vector<double>(bed.x.size(), 1e3));
    std::vector<double> nodes = strands.nodes;
    for (std::size_t i = 0; i < nodes.size(); i += 3)
      if (std::abs(nodes[i]) < 0.025) nodes[i + 2] = std::min(nodes[i + 2], surface - depth + 0.001);
    file.append("/frames/carpet/position", nodes);
    file.append("/frames/bodies/missile/position", std::vector<double>{0, 0, surface - depth});
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "tuft-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder: " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

Scene fake_scene(Approach approach) {
  Scene scene;
  scene.file = "fake.toml";
  scene.info = {"fake_drop", 0.03};
  CarpetDesign& carpet = scene.turf.carpet;
  carpet.gauge = 0.01;
  carpet.stitch_spacing = 0.01;
  carpet.strands_per_tuft = 4;
  carpet.pile_length = 0.06;
  carpet.strand_width = 0.0013;
  carpet.strand_thickness = 0.0002;
  carpet.lean = 0.1;
  carpet.fan_out = 0.1;
  carpet.element_length = 0.005;
  carpet.backing_thickness = 0.0015;
  carpet.backing_element = 0.005;
  carpet.fibre = {600e6, 0.4, 920};
  carpet.backing = {200e6, 0.3, 900};
  scene.turf.size = {0.08, 0.08};
  scene.turf.tray_depth = 0.07;
  scene.turf.layers = {{0, 0.005}, {1, 0.022}, {2, 0.023}};
  const char* names[] = {"sand", "mixture", "sbr"};
  for (int m = 0; m < 3; ++m) {
    Material material;
    material.name = names[m];
    material.bulk_density = m == 0 ? 1600 : m == 1 ? 977 : 440;
    material.continuum = SoilFoamMaterial{
        material.bulk_density, {{0, 0.3}, {0, 2e6}}, {{0, 1e6}, {1e7, 2e7}}, 0.5, 1e8, 0, 0.12, 20e3};
    if (m == 1)
      material.grain_shares = {{0, 0.7}, {2, 0.3}};
    else {
      material.grain =
          GrainMaterial{m == 0 ? 2650.0 : 1150.0, m == 0 ? 1e8 : 8e6, 0.3, 0.5, 0.5, 0.1, 0.0008, 0.0017};
      material.grain_shares = {{m, 1.0}};
    }
    material.fibre_friction = {0.44, 0.6, 300};
    material.body_friction = {0.4, 0.4, 0};
    scene.materials.push_back(material);
  }
  scene.infill.approach = approach;
  scene.infill.sph.pitch = 0.0025;
  scene.infill.sph.smoothing_length = 0.00325;
  scene.infill.dem.coarse_graining = 2.5;
  return scene;
}

rigs::RunSummary fake_summary(const FakeRun& run) {
  rigs::RunSummary summary;
  const bool sph = run.approach == Approach::sph;
  summary.status = "completed";
  summary.scene_name = "fake_drop";
  summary.rig = "clegg";
  summary.approach = sph ? "sph" : "dem";
  summary.version = "0.0.0-test";
  summary.results = {{"peak_g", {run.peak_g, "g"}},
                     {"time_of_peak", {0.5 * run.pulse, "s"}},
                     {"rebound_velocity", {sph ? 0.9 : 1.1, "m/s"}},
                     {"max_penetration", {0.0137, "m"}}};
  summary.energy_error = 0.0041;
  summary.momentum_error = 3.2e-13;
  summary.simulated_time = run.duration;
  summary.steps = sph ? 21034 : 45077;
  summary.wall_s = sph ? 63.2 : 118.4;
  summary.cost = {
      {"setup", 0.6}, {"search", 3.1}, {"contact", 8.7}, {"carpet", 14.2},   {"infill", sph ? 32.5 : 2.0},
      {"rig", 0.1},   {"ledger", 0.4}, {"record", 1.2},  {"checkpoint", 0.3}};
  if (!sph) summary.cost.insert({{"packing", 12.0}, {"exchange", 4.4}, {"waiting", 68.0}});
  summary.particles = sph ? 20480 : 16404;
  summary.shells = 13712;
  summary.particle_steps_per_s = 1.41e6;
  summary.element_steps_per_s = 2.05e7;
  summary.peak_memory_bytes = 312000000;
  summary.effects = {
      {"fibres", true, "the turf has a pile"},
      {"artificial_viscosity", sph, sph ? "needed by shocks in a continuum" : "DEM infill has none"}};
  summary.notes = {{"carpet_step", {2.1e-7, "s"}}, {"initial_overlap", {0.00012, "m"}}};
  return summary;
}

void write_fake_run(const std::filesystem::path& folder, const FakeRun& run) {
  const Scene scene = fake_scene(run.approach);
  const Bed bed = make_bed(scene);
  const Strands strands = make_strands(scene.turf.carpet);
  const Pulse pulse{run};
  std::filesystem::create_directories(folder);
  rigs::write_text_file(folder / "scene.toml", write_scene(scene));
  rigs::write_summary(folder, fake_summary(run));
  RecordFile file = RecordFile::create(
      folder / "run.h5", channels_of(bed.x.size(), strands.nodes.size() / 3, run.approach == Approach::sph),
      [&](h5::Group& root) {
        root.write_string("scene", write_scene(scene));
        h5::Group infill = root.open_group("frames").open_group("infill"),
                  carpet = root.open_group("frames").open_group("carpet");
        infill.write("radius", bed.radius);
        infill.write("layer", bed.layer);
        infill.write("material", bed.material);
        carpet.write("quads", strands.quads, {strands.surface.size(), 4});
        carpet.write("surface", strands.surface);
      });
  append_history(file, run, pulse);
  append_frames(file, run, pulse, bed, strands, scene.turf.carpet.backing_thickness + scene.infill_depth());
  file.flush();
}

void write_failed_run(const std::filesystem::path& folder, Approach approach, const std::string& error) {
  rigs::RunSummary summary;
  summary.status = "failed";
  summary.error = error;
  summary.scene_name = "fake_drop";
  summary.rig = "clegg";
  summary.approach = approach == Approach::sph ? "sph" : "dem";
  summary.version = "0.0.0-test";
  std::filesystem::create_directories(folder);
  rigs::write_text_file(folder / "scene.toml", write_scene(fake_scene(approach)));
  rigs::write_summary(folder, summary);
}

}  // namespace tuft::test
