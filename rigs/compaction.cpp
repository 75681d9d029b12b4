#include "rigs/compaction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/checkpoint_values.h"
#include "coupler/fastest.h"
#include "coupler/layer_depth.h"

namespace tuft::rigs {
namespace {

double fastest_particle(const coupler::BuiltSimulation& built) {
  const ParticleView p = std::as_const(*built.simulation).infill().particles();
  return coupler::fastest(p.vx, p.vy, p.vz);
}

}  // namespace

double plate_height(double from, double to, std::uint64_t done, std::uint64_t intervals) {
  if (done >= intervals) return to;
  const double share = static_cast<double>(done) / static_cast<double>(intervals);
  return from + (to - from) * 0.5 * (1 - std::cos(std::numbers::pi * share));
}

Compaction::Compaction(const Scene& scene, const Schedule& schedule, const coupler::BuiltSimulation& built)
    : scene_(&scene),
      schedule_(schedule),
      start_(built.simulation->bodies().at(built.plate).position.z()),
      placed_(depths(built)) {
  pressed_ = surface() - scene.conditioning.depth;
  if (scene.conditioning.method == "roller") roller_.emplace(scene, surface());
}

double Compaction::placed_depth() const {
  return scene_->infill.approach == Approach::dem ? placed_.back() : scene_->infill_depth();
}
double Compaction::wanted_depth() const {
  return placed_depth() - scene_->conditioning.depth;
}
double Compaction::surface() const {
  return scene_->turf.carpet.backing_thickness + placed_depth();
}

std::vector<double> Compaction::depths(const coupler::BuiltSimulation& built) const {
  return coupler::layer_tops(std::as_const(*built.simulation).infill().particles(), scene_->turf.size,
                             scene_->turf.carpet.backing_thickness, scene_->turf.layers.size());
}

std::string Compaction::stage(std::uint64_t index) const {
  if (index > schedule_.conditioned()) return "";
  const std::uint64_t in_cycle = index == 0 ? 0 : (index - 1) % schedule_.cycle() + 1;
  if (in_cycle <= schedule_.press) return roller_ ? "rolling" : "pressing";
  return in_cycle <= schedule_.press + schedule_.lift ? "lifting" : "settling";
}

/// Sets the speeds that bring plate or roller where it is at the end of the interval.
void Compaction::drive(std::uint64_t index, coupler::BuiltSimulation& built) const {
  coupler::Simulation& simulation = *built.simulation;
  const std::uint64_t cycle = schedule_.cycle(), press = schedule_.press, at = index % cycle;
  if (!roller_) {
    const auto height = [&](std::uint64_t done) {
      return done <= press ? plate_height(start_, pressed_, done, press)
                           : plate_height(pressed_, start_, done - press, schedule_.lift);
    };
    simulation.drive_body(built.plate, Vec3(0, 0, (height(at + 1) - height(at)) / schedule_.interval));
    return;
  }
  const auto pass = static_cast<int>(index / cycle);
  for (std::size_t k = 0; k < roller_->size(); ++k) {
    // After a pass the roller turns and comes down for the next: beside the patch, where nothing is in its
    // way. After the last it is taken away.
    const double share = static_cast<double>(at + 1) / static_cast<double>(press);
    const Vec3 next = at < press ? roller_->place(k, pass, share) : roller_->place(k, pass + 1, 0);
    const Vec3 now = simulation.bodies().at(built.plate + k).position;
    simulation.drive_body(built.plate + k, (next - now) / schedule_.interval);
  }
}

void Compaction::take_away(coupler::BuiltSimulation& built) const {
  const std::size_t count = roller_ ? roller_->size() : 1;
  for (std::size_t k = built.plate; k < built.plate + count; ++k)
    if (built.simulation->bodies().at(k).present) built.simulation->remove_body(k);
}

void Compaction::before_interval(std::uint64_t index, const std::vector<EffectDecision>& effects,
                                 coupler::BuiltSimulation& built) {
  coupler::Simulation& simulation = *built.simulation;
  const std::uint64_t lifted = schedule_.conditioned() - schedule_.rest;
  if (index < lifted) drive(index, built);
  if (index == lifted || index == schedule_.conditioned()) take_away(built);
  if (index != schedule_.conditioned()) return;
  element_steps_ = simulation.carpet().element_steps();
  switched_ = depths(built);
  if (built.spheres == nullptr) return;  // grains stay what they are
  switch_ = {};
  auto continuum = coupler::take_over(*scene_, effects, *built.spheres, switch_);
  auto springs = coupler::body_springs(*scene_, effects, continuum->particles(), false);
  simulation.replace_infill(std::move(continuum), std::move(springs));
  built.spheres = nullptr;
  switched_over_ = true;
}

/// One press after the other: by how much the bed stays too high is how much deeper the next one goes. Half
/// of the infill is left above the backing in any case.
void Compaction::finish_press(const coupler::BuiltSimulation& built) {
  missing_ = depths(built).back() - wanted_depth();
  stays_ = missing_ <= scene_->conditioning.tolerance;
  const double lowest = scene_->turf.carpet.backing_thickness + 0.5 * wanted_depth();
  if (!stays_) pressed_ = std::max(lowest, pressed_ - missing_);
}

void Compaction::after_interval(std::uint64_t index, const coupler::BuiltSimulation& built) {
  if (index > schedule_.conditioned()) return;
  const double area = scene_->turf.size[0] * scene_->turf.size[1];
  plate_force_ = 0;
  for (std::size_t k = 0; k < (roller_ ? roller_->size() : 1); ++k)
    plate_force_ += built.simulation->interval_impulse()[built.plate + k].z() / schedule_.interval;
  largest_pressure_ = std::max(largest_pressure_, plate_force_ / area);
  const std::uint64_t cycle = schedule_.cycle(), at = (index - 1) % cycle + 1;
  if (at == schedule_.press) under_plate_ = depths(built);
  if (at == schedule_.press + schedule_.lift) lifted_ = depths(built);
  if (at != cycle) return;
  ++presses_;
  if (repeats()) finish_press(built);
}

std::uint64_t Compaction::next_index(std::uint64_t index) const {
  const bool enough = stays_ && index < schedule_.conditioned() && index % schedule_.cycle() == 0;
  return enough ? schedule_.conditioned() : index;
}

void Compaction::note_release(const coupler::BuiltSimulation& built) {
  released_ = depths(built);
  settled_speed_ = fastest_particle(built);
}

std::map<std::string, Quantity> Compaction::notes() const {
  std::map<std::string, Quantity> notes;
  const auto depth = [&](const char* name, const std::vector<double>& tops) {
    if (!tops.empty()) notes[fmt::format("conditioning_depth_{}", name)] = {tops.back(), "m"};
  };
  depth("placed", placed_), depth("under_plate", under_plate_), depth("lifted", lifted_);
  depth("at_switch", switched_), depth("released", released_);
  if (!released_.empty())
    notes["conditioning_residual_compaction"] = {placed_depth() - released_.back(), "m"};
  const double area = scene_->turf.size[0] * scene_->turf.size[1];
  if (roller_)
    notes["conditioning_roller_force_largest"] = {largest_pressure_ * area, "N"};
  else
    notes["conditioning_plate_pressure_largest"] = {largest_pressure_, "Pa"};
  notes[roller_ ? "conditioning_passes" : "conditioning_presses"] = {static_cast<double>(presses_), "1"};
  if (repeats() && presses_ > 0) {
    notes["conditioning_stays"] = {stays_ ? 1.0 : 0.0, "1"};
    notes["conditioning_missing_compaction"] = {std::max(0.0, missing_), "m"};
  }
  if (!switched_over_) return notes;
  notes["conditioning_sphere_overlap_largest"] = {switch_.largest_overlap, "1"};
  notes["conditioning_kinetic_kept"] = {switch_.kinetic, "J"};
  notes["conditioning_energy_let_go"] = {switch_.let_go, "J"};
  notes["conditioning_speed_at_switch"] = {switch_.fastest, "m/s"};
  if (!released_.empty()) notes["conditioning_speed_at_release"] = {settled_speed_, "m/s"};
  // Volumes from the kernel's sums over the patch, for comparison with the depth at the switch.
  notes["conditioning_depth_of_volumes"] = {switch_.volume / (scene_->turf.size[0] * scene_->turf.size[1]),
                                            "m"};
  notes["conditioning_started_as_placed"] = {switch_.started_as_placed, "1"};
  const auto& layers = scene_->turf.layers;
  for (std::size_t k = 0; k < layers.size(); ++k) {
    const Material& material = scene_->materials.at(static_cast<std::size_t>(layers[k].material));
    const std::string name = fmt::format("conditioning_layer_{}_{}", k + 1, material.name);
    const double placed = material.continuum->density,
                 thickness = switched_[k] - (k > 0 ? switched_[k - 1] : 0);
    notes[name + "_density_placed"] = {placed, "kg/m^3"};
    notes[name + "_density_reached"] = {placed * switch_.density_mean.at(k), "kg/m^3"};
    notes[name + "_density_deviation"] = {placed * switch_.density_deviation.at(k), "kg/m^3"};
    // Mass over volume: what the kernel's sums must agree with.
    notes[name + "_density_of_layer"] = {thickness > 0 ? placed * layers[k].depth / thickness : 0, "kg/m^3"};
  }
  return notes;
}

void Compaction::save(h5::Group& group) const {
  const std::vector<double> numbers{start_,
                                    plate_force_,
                                    largest_pressure_,
                                    switch_.kinetic,
                                    switch_.let_go,
                                    switch_.fastest,
                                    switch_.largest_overlap,
                                    switch_.started_as_placed,
                                    switched_over_ ? 1.0 : 0.0,
                                    settled_speed_,
                                    switch_.volume,
                                    pressed_,
                                    static_cast<double>(presses_),
                                    missing_,
                                    stays_ ? 1.0 : 0.0};
  group.write("numbers", std::span<const double>(numbers));
  group.write_scalar("element_steps", element_steps_);
  const auto write = [&](const char* name, const std::vector<double>& values) {
    group.write(name, std::span<const double>(values));
  };
  write("placed", placed_), write("under_plate", under_plate_), write("lifted", lifted_);
  write("switched", switched_), write("released", released_);
  write("density_mean", switch_.density_mean), write("density_deviation", switch_.density_deviation);
}

void Compaction::load(const h5::Group& group) {
  const std::vector<double> n = h5::read_checked(group, "numbers", 15);
  start_ = n[0], plate_force_ = n[1], largest_pressure_ = n[2];
  switch_.kinetic = n[3], switch_.let_go = n[4], switch_.fastest = n[5];
  switch_.largest_overlap = n[6], switch_.started_as_placed = n[7];
  switched_over_ = n[8] != 0;
  settled_speed_ = n[9];
  switch_.volume = n[10];
  h5::check_whole(group, "numbers", 12, n[12], {0, h5::most_counted});
  pressed_ = n[11], presses_ = static_cast<std::uint64_t>(n[12]);
  missing_ = n[13], stays_ = n[14] != 0;
  element_steps_ = h5::read_count(group, "element_steps");
  const auto read = [&](const char* name) { return h5::read_all_checked(group, name); };
  placed_ = read("placed");
  if (roller_) roller_.emplace(*scene_, surface());
  under_plate_ = read("under_plate"), lifted_ = read("lifted");
  switched_ = read("switched"), released_ = read("released");
  switch_.density_mean = read("density_mean"), switch_.density_deviation = read("density_deviation");
}

}  // namespace tuft::rigs
