#include <algorithm>

#include "dem_bridge/dem_infill_impl.h"

namespace tuft::dem {

void DemInfill::Impl::write_vectors(h5::Group& group, const char* name, std::size_t first) {
  std::vector<double> values;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto component = array(first + c);
    values.insert(values.end(), component.begin(), component.end());
  }
  group.write(name, values, {3, grains.size()});
}

namespace {

std::vector<double> read_three(const h5::Group& group, const char* name, std::size_t grains) {
  std::vector<double> values = group.read_doubles(name);
  if (values.size() != 3 * grains)
    throw_input_error("checkpoint: {} holds {} values for {} grains: it is of another scene, or damaged",
                      name, values.size(), grains);
  return values;
}

}  // namespace

void DemInfill::Impl::read_vectors(const h5::Group& group, const char* name, std::size_t first) {
  const std::vector<double> values = read_three(group, name, grains.size());
  for (std::size_t c = 0; c < 3; ++c)
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(c * grains.size()), grains.size(),
                array(first + c).begin());
}

void DemInfill::save(h5::Group& group) {
  Impl& my = *impl_;
  my.ask(Request::save, "restart");
  my.check_count();
  const HostSums& sums = my.sums;
  group.write("radius", my.grains.radius);
  group.write("restart", my.host->take_file("restart"));
  my.write_vectors(group, "position", SharedArrays::position_x);
  my.write_vectors(group, "velocity", SharedArrays::velocity_x);
  my.write_vectors(group, "spin", SharedArrays::spin_x);
  my.write_vectors(group, "own_force", SharedArrays::own_force_x);
  my.write_vectors(group, "own_torque", SharedArrays::own_torque_x);
  group.write("works",
              std::vector<double>{sums.pair_work, sums.contact_work, sums.damping_work, sums.last_pair_work,
                                  sums.last_contact_work, sums.last_damping_work, sums.kinetic, sums.stored,
                                  my.stored_is_current ? 1.0 : 0.0});
  const auto expelled = my.array(SharedArrays::expelled);
  group.write("expelled", std::vector<double>(expelled.begin(), expelled.end()));
  const auto& momentum = my.expelled.momentum;
  group.write("expelled_sums",
              std::vector<double>{static_cast<double>(my.expelled.grains), my.expelled.mass, momentum[0],
                                  momentum[1], momentum[2], my.expelled.energy, my.expelled.pending});
  group.write("overlap_largest", my.overlap_largest);
  group.write_scalar("time", my.time);
  group.write_scalar("step", my.shared().step);
  group.write_scalar("largest_step", my.largest_step);
  group.write_scalar("steps", my.steps);
  group.write_scalar("damping", my.damping);
  group.write_scalar("initial_stored", my.initial_stored);
  group.write_scalar("missing", my.missing);
  group.write_scalar("dissipated", my.dissipated);
  group.write_scalar("started", static_cast<std::uint64_t>(my.started));
}

void DemInfill::load(const h5::Group& group) {
  Impl& my = *impl_;
  if (group.read_doubles("radius") != my.grains.radius)
    throw_input_error(
        "checkpoint: its grains are not those of this scene ({} grains); resume with the scene it was made "
        "of",
        my.grains.size());
  const std::vector<double> works = group.read_doubles("works");
  if (works.size() != 9)
    throw_input_error("checkpoint: {} works of the infill instead of 9: it is damaged", works.size());
  my.new_host();
  my.time = group.read_double("time");
  my.largest_step = group.read_double("largest_step");
  my.steps = group.read_count("steps");
  my.damping = group.read_double("damping");
  my.initial_stored = group.read_double("initial_stored");
  my.missing = group.read_double("missing");
  my.dissipated = group.read_double("dissipated");
  my.started = group.read_count("started") != 0;
  my.host->write_file("restart", group.read_bytes("restart"));
  my.set_up("read_restart restart");

  my.read_vectors(group, "position", SharedArrays::position_x);
  my.read_vectors(group, "velocity", SharedArrays::velocity_x);
  my.read_vectors(group, "spin", SharedArrays::spin_x);
  my.read_vectors(group, "own_force", SharedArrays::own_force_x);
  my.read_vectors(group, "own_torque", SharedArrays::own_torque_x);
  my.shared().step = group.read_double("step");
  my.sums = {works[0], works[1], works[2], works[3], works[4], works[5], works[6], works[7]};
  my.stored_is_current = works[8] != 0;
  const std::vector<double> expelled = group.read_doubles("expelled"),
                            sums = group.read_doubles("expelled_sums");
  if (expelled.size() != my.grains.size() || sums.size() != 7)
    throw_input_error(
        "checkpoint: {} marks and {} sums of expelled grains instead of {} and 7: it is damaged",
        expelled.size(), sums.size(), my.grains.size());
  std::copy(expelled.begin(), expelled.end(), my.array(SharedArrays::expelled).begin());
  my.expelled = {static_cast<std::uint64_t>(sums[0]), sums[1], {sums[2], sums[3], sums[4]}, sums[5], sums[6]};
  my.shared().expelled = my.expelled.grains;
  my.overlap_largest = group.read_doubles("overlap_largest");
  my.overlap_largest.resize(my.used.size() * (my.used.size() + 1) / 2);
  my.read_expelled();
  if (my.started) my.ask(Request::resume);
}

}  // namespace tuft::dem
