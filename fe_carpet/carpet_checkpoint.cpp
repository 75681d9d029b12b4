#include <fmt/format.h>

#include <array>
#include <limits>
#include <numeric>
#include <string_view>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "fe_carpet/carpet_impl.h"
#include "fe_carpet/erosion.h"

namespace tuft::fe {
namespace {

void write_vectors(h5::Group& group, const std::string& name, const Vec3Array& values) {
  group.write(name + "_x", values.x);
  group.write(name + "_y", values.y);
  group.write(name + "_z", values.z);
}

/// Which rows of an element's state: all, or those of thickness and stress, without what follows the strain
/// to failure.
enum class Rows { all, stress };

std::size_t row_count(const ElementFamily& family, Rows rows) {
  return rows == Rows::all ? family.rows : family.rows - family.failure_rows();
}

/// Values of the elements' rows and thicknesses.
std::size_t state_size(const ElementArrays& elements, Rows which = Rows::all) {
  std::size_t size = 0;
  for (const Index slot : elements.slot) {
    const std::size_t batch = static_cast<std::size_t>(slot) / lanes;
    size += 1 + row_count(elements.family[static_cast<std::size_t>(elements.batch_family[batch])], which);
  }
  return size;
}

/// Calls visit(value) for each element's thickness and rows: element by element, so that a checkpoint does
/// not depend on the width of the processor's vectors.
template <class Elements, class Visit>
void visit_state(Elements& elements, Rows which, const Visit& visit) {
  for (const Index slot_index : elements.slot) {
    const auto slot = static_cast<std::size_t>(slot_index), batch = slot / lanes;
    const std::size_t first = elements.state_of_batch(batch) + slot % lanes;
    const std::size_t rows =
        row_count(elements.family[static_cast<std::size_t>(elements.batch_family[batch])], which);
    visit(elements.thickness[slot]);
    for (std::size_t row = 0; row < rows; ++row) visit(elements.state[first + row * lanes]);
  }
}

std::vector<double> unpack_state(const ElementArrays& elements, Rows which = Rows::all) {
  std::vector<double> flat;
  flat.reserve(state_size(elements, which));
  visit_state(elements, which, [&flat](double value) { flat.push_back(value); });
  return flat;
}

void pack_state(const std::vector<double>& flat, ElementArrays& elements, Rows which = Rows::all) {
  auto next = flat.begin();
  visit_state(elements, which, [&next](double& value) { value = *next++; });
}

/// Block sums keep their blocks, for the same last bits; from a processor of another vector width the total
/// is kept.
void restore_block_sums(const std::vector<double>& saved, std::vector<double>& blocks) {
  if (saved.size() == blocks.size()) {
    blocks = saved;
    return;
  }
  std::fill(blocks.begin(), blocks.end(), 0.0);
  blocks.front() = std::accumulate(saved.begin(), saved.end(), 0.0);
}

/// A checkpoint's sums by block. How many there are is the writer's affair (see above), as many of each, and
/// no more than elements.
std::array<std::vector<double>, 2> read_block_sums(const h5::Group& group, std::size_t elements) {
  std::array<std::vector<double>, 2> sums{h5::read_all_checked(group, "strain_work"),
                                          h5::read_all_checked(group, "hourglass_work")};
  if (sums[0].size() > elements || sums[0].empty() != (elements == 0))
    h5::refuse(group, "strain_work",
               fmt::format("holds sums of {} blocks of {} elements", sums[0].size(), elements));
  h5::check_length(group, "hourglass_work", sums[1].size(), sums[0].size());
  return sums;
}

constexpr std::size_t sums_width = 11;
constexpr int most_steps = std::numeric_limits<int>::max();

std::vector<double> flatten(const std::vector<NodeSums>& sums) {
  std::vector<double> flat;
  for (const NodeSums& s : sums) {
    flat.insert(flat.end(),
                {s.kinetic, s.external_work, s.last_external_work, s.damping_work, s.last_damping_work});
    flat.insert(flat.end(), s.impulse_received.begin(), s.impulse_received.end());
    flat.insert(flat.end(), s.impulse_to_clamps.begin(), s.impulse_to_clamps.end());
  }
  return flat;
}

void restore(const std::vector<double>& flat, std::vector<NodeSums>& sums) {
  for (std::size_t b = 0; b < sums.size(); ++b) {
    const double* v = &flat[b * sums_width];
    sums[b] = {v[0], v[1], v[2], v[3], v[4], {v[5], v[6], v[7]}, {v[8], v[9], v[10]}, 0};
  }
}

void restore_eroded(const std::vector<double>& eroded, ElementArrays& elements, Index first_spare_node) {
  elements.eroded_count = 0;
  for (std::size_t e = 0; e < eroded.size(); ++e) {
    elements.eroded[e] = eroded[e] != 0;
    if (!elements.eroded[e]) continue;
    ++elements.eroded_count;
    empty_slot(elements, static_cast<std::size_t>(elements.slot[e]), first_spare_node);
  }
}

}  // namespace

CarpetShape Carpet::shape() const {
  const Impl& c = *impl_;
  if (c.elements.eroded_count > 0)
    throw std::logic_error("carpet: the shape is asked of a carpet whose shells have failed");
  const CarpetEnergy spent = energy();
  CarpetShape shape{{}, unpack_state(c.elements, Rows::stress), spent.strain, spent.hourglass};
  for (std::size_t n = 0; n < c.nodes.size(); ++n) shape.position.push_back(c.nodes.motion.position[n]);
  return shape;
}

void Carpet::take_shape(const CarpetShape& shape) {
  Impl& c = *impl_;
  if (c.steps > 0) throw std::logic_error("carpet: a shape is taken before the first step only");
  const std::size_t nodes = c.nodes.size(), values = state_size(c.elements, Rows::stress);
  if (shape.position.size() != nodes || shape.element_state.size() != values)
    throw RunError(fmt::format(
        "carpet: a shape of {} nodes and {} values of elements does not fit a carpet of {} and {}",
        shape.position.size(), shape.element_state.size(), nodes, values));
  if (c.elements.element_count == 0) return;
  for (std::size_t n = 0; n < nodes; ++n) set_position(n, shape.position[n]);
  pack_state(shape.element_state, c.elements, Rows::stress);
  restore_block_sums({shape.strain}, c.elements.strain_work);
  restore_block_sums({shape.hourglass}, c.elements.hourglass_work);
}

void Carpet::save(h5::Group& group) const {
  const Impl& c = *impl_;
  write_vectors(group, "position", c.nodes.motion.position);
  write_vectors(group, "velocity", c.nodes.motion.velocity);
  write_vectors(group, "angular_velocity", c.nodes.motion.angular_velocity);
  group.write("element_state", unpack_state(c.elements));
  group.write("strain_work", c.elements.strain_work);
  group.write("hourglass_work", c.elements.hourglass_work);
  group.write("node_sums", flatten(c.nodes.sums), {c.nodes.sums.size(), sums_width});
  const std::vector<double> eroded(c.elements.eroded.begin(), c.elements.eroded.end());
  group.write("eroded", eroded);
  group.write_scalar("eroded_energy", c.eroded_energy);
  group.write_scalar("last_step", c.last_step);
  group.write_scalar("time", c.time);
  group.write_scalar("damping", c.options.damping);
  group.write_scalar("steps", c.steps);
  std::vector<double> grips{c.grips.work,        c.grips.last_work,   c.grips.impulse.x(),
                            c.grips.impulse.y(), c.grips.impulse.z(), c.grips.exchanged};
  for (const Vec3& force : c.grips.force) grips.insert(grips.end(), force.data(), force.data() + 3);
  if (!c.grips.nodes.empty()) group.write("grips", std::span<const double>(grips));
  group.write_scalar("from_rest", static_cast<std::uint64_t>(c.from_rest));
  if (!c.subcycling) return;
  const Subcycling& s = *c.subcycling;
  auto cycle = group.create_group("subcycling");
  write_vectors(cycle, "position", s.window.position);
  write_vectors(cycle, "turn", s.turn);
  cycle.write_scalar("drifted", s.drifted);
  cycle.write_scalar("owed", s.owed);
  cycle.write_scalar("every", static_cast<std::uint64_t>(s.every));
  cycle.write_scalar("steps", static_cast<std::uint64_t>(s.steps));
  cycle.write_scalar("slow_evaluations", s.slow_evaluations);
}

void Carpet::load(const h5::Group& group) {
  Impl& c = *impl_;
  if (c.elements.eroded_count > 0)
    throw std::logic_error(
        "carpet: a checkpoint is loaded into a carpet as built, none of whose shells have failed");
  const std::size_t stored = c.nodes.motion.position.size();
  // All is read before anything is changed: a checkpoint that does not fit leaves the carpet as it was.
  Vec3Array position = h5::read_vectors(group, "position", stored),
            velocity = h5::read_vectors(group, "velocity", stored);
  Vec3Array angular_velocity = h5::read_vectors(group, "angular_velocity", stored);
  const std::vector<double> state = h5::read_checked(group, "element_state", state_size(c.elements));
  const std::vector<double> sums = h5::read_checked(group, "node_sums", c.nodes.sums.size() * sums_width);
  const auto [strain_work, hourglass_work] = read_block_sums(group, c.elements.element_count);
  const std::vector<double> eroded = h5::read_whole(group, "eroded", c.elements.eroded.size(), {0, 1});
  const double eroded_energy = h5::read_number(group, "eroded_energy");
  const double last_step = h5::read_number(group, "last_step", h5::not_negative);
  const double time = h5::read_number(group, "time");
  std::vector<double> grips;
  if (!c.grips.nodes.empty()) grips = h5::read_checked(group, "grips", 6 + 3 * c.grips.nodes.size());
  const double damping = h5::read_number(group, "damping", h5::not_negative);
  const std::uint64_t steps = h5::read_count(group, "steps");
  const bool from_rest = h5::read_flag(group, "from_rest");

  if (c.subcycling) {
    const h5::Group cycle = group.open_group("subcycling");
    Subcycling s = *c.subcycling;
    s.window.position = h5::read_vectors(cycle, "position", stored);
    s.turn = h5::read_vectors(cycle, "turn", c.nodes.size());
    s.drifted = h5::read_number(cycle, "drifted");
    s.owed = h5::read_number(cycle, "owed");
    s.every = static_cast<int>(h5::read_whole(cycle, "every", 1, {1, most_steps}).front());
    s.steps = static_cast<int>(h5::read_count(cycle, "steps", s.every - 1));
    s.slow_evaluations = h5::read_count(cycle, "slow_evaluations");
    c.subcycling = std::move(s);
  }

  c.nodes.motion = {std::move(position), std::move(velocity), std::move(angular_velocity)};
  restore_eroded(eroded, c.elements, static_cast<Index>(c.nodes.size()));
  pack_state(state, c.elements);
  restore(sums, c.nodes.sums);
  restore_block_sums(strain_work, c.elements.strain_work);
  restore_block_sums(hourglass_work, c.elements.hourglass_work);
  c.eroded_energy = eroded_energy;
  if (!grips.empty()) {
    c.grips.work = grips[0];
    c.grips.last_work = grips[1];
    c.grips.impulse = Vec3(grips[2], grips[3], grips[4]);
    c.grips.exchanged = grips[5];
    for (std::size_t i = 0; i < c.grips.force.size(); ++i)
      c.grips.force[i] = Vec3(grips[6 + 3 * i], grips[7 + 3 * i], grips[8 + 3 * i]);
  }
  c.last_step = last_step;
  c.time = time;
  c.options.damping = damping;
  c.steps = steps;
  c.from_rest = from_rest;
}

}  // namespace tuft::fe
