#include "rigs/tension_strip.h"

#include <algorithm>
#include <cmath>

#include "coupler/carpet_terms.h"

namespace tuft::rigs {
namespace {

// Bits of ShellMesh::constraints.
constexpr std::uint8_t length_held = 1, width_held = 2, height_and_turns_held = 4 | 8 | 16 | 32;

bool is_strand(const Scene& scene) {
  return scene.rig.type == "strand_tension";
}

Index elements_over(double length, double element) {
  return static_cast<Index>(std::max(1L, std::lround(length / element)));
}

/// Of the strip, whose axis is x: a strip cut across the stitch has the stitch along y.
ShellMaterial strip_material(const Scene& scene) {
  ShellMaterial material = is_strand(scene) ? scene.turf.carpet.fibre : scene.turf.carpet.backing;
  material.density *= scene.rig.tension.mass_factor;
  material.along = {1, 0, 0};
  if (scene.rig.tension.direction == StripDirection::across) material.along = {0, 1, 0};
  return material;
}

fe::CarpetOptions strip_options(const Scene& scene) {
  fe::CarpetOptions options;
  options.gravity = Vec3(0, 0, 0);
  options.section = is_strand(scene) ? scene.turf.carpet.fibre_section : scene.turf.carpet.backing_section;
  return options;
}

double contraction_ratio(const Scene& scene) {
  const ShellMaterial material = strip_material(scene);
  const bool across = material.orthotropic() && scene.rig.tension.direction == StripDirection::across;
  return material.poisson_ratio * (across ? material.across_young_modulus / material.young_modulus : 1);
}

Vec3 force_on(const fe::Carpet& carpet, const std::vector<std::size_t>& grip) {
  Vec3 sum(0, 0, 0);
  for (const std::size_t node : grip) sum += carpet.holding_force(node);
  return sum;
}

}  // namespace

StripMesh make_strip_mesh(const Scene& scene, std::size_t test) {
  const TensionRig& rig = scene.rig.tension;
  const CarpetDesign& carpet = scene.turf.carpet;
  StripMesh strip;
  strip.gauge_length = rig.gauge_lengths.size() == 1 ? rig.gauge_lengths.front() : rig.gauge_lengths.at(test);
  strip.width = rig.width;
  strip.thickness = is_strand(scene) ? carpet.strand_thickness : carpet.backing_thickness;
  const double element = is_strand(scene) ? carpet.element_length : carpet.backing_element;
  const Index along = elements_over(strip.gauge_length, element),
              across = elements_over(strip.width, element);
  const auto in_grip = static_cast<std::uint8_t>(length_held | height_and_turns_held |
                                                 (rig.grips == StripGrips::hold_width ? width_held : 0));
  fe::ShellMesh& mesh = strip.mesh;
  mesh.surface_count = 1;
  const auto node = [across](Index i, Index j) { return i * (across + 1) + j; };
  for (Index i = 0; i <= along; ++i)
    for (Index j = 0; j <= across; ++j) {
      mesh.nodes.push_back(
          {strip.gauge_length * i / along, strip.width * (2 * j - across) / (2 * across), 0});
      mesh.clamped.push_back(0);
      const bool gripped = i == 0 || i == along;
      mesh.constraints.push_back(gripped ? in_grip : 0);
      if (gripped) (i == 0 ? strip.held : strip.driven).push_back(static_cast<std::size_t>(node(i, j)));
    }
  for (Index i = 0; i < along; ++i)
    for (Index j = 0; j < across; ++j) {
      mesh.quads.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      mesh.thickness.push_back(strip.thickness);
      mesh.material.push_back(0);
      mesh.surface.push_back(0);
    }
  return strip;
}

TensionStrip::TensionStrip(const Scene& scene, std::size_t test)
    : strip_(make_strip_mesh(scene, test)),
      rate_(scene.rig.tension.rates.at(test)),
      interval_(scene.rig.tension.strain_limit / rate_ / scene.rig.tension.samples),
      step_safety_(scene.numerics.step_safety),
      carpet_(strip_.mesh, {strip_material(scene)}, strip_options(scene)) {
  const std::size_t count = strip_.mesh.nodes.size();
  no_load_.assign(count, 0.0);
  // Uniform extension from the start, ends that are let contract included; then the grips take theirs.
  const double contraction = contraction_ratio(scene);
  for (std::size_t n = 0; n < count; ++n) {
    const Vec3 x = strip_.mesh.nodes[n];
    const std::uint8_t held = strip_.mesh.constraints[n];
    const double along = held & length_held ? 0 : rate_ * x.x();
    const double across = held & width_held ? 0 : -contraction * rate_ * x.y();
    carpet_.set_velocity(n, Vec3(along, across, 0), Vec3(0, 0, 0));
  }
  for (const std::size_t n : strip_.held) carpet_.drive(n, Vec3(0, 0, 0));
  for (const std::size_t n : strip_.driven) carpet_.drive(n, Vec3(rate_ * strip_.gauge_length, 0, 0));
  step_ = interval_ / static_cast<double>(steps_a_row());
  first_momentum_ = momentum();
}

std::uint64_t TensionStrip::steps_a_row() const {
  return static_cast<std::uint64_t>(
      std::max(1.0, std::ceil(interval_ / (step_safety_ * carpet_.stable_step()))));
}

void TensionStrip::advance() {
  const std::uint64_t count = steps_a_row();
  step_ = interval_ / static_cast<double>(count);
  for (std::uint64_t i = 0; i < count; ++i) carpet_.step(step_, no_load_);
  steps_ += count;
  ++rows_;
}

TensionRow TensionStrip::row() const {
  TensionRow row;
  const fe::NodeView nodes = carpet_.nodes();
  const std::size_t held = strip_.held.front(), driven = strip_.driven.front();
  // Forces are those of the positions a step ago.
  const double back = carpet_.last_step();
  row.time = interval_ * static_cast<double>(rows_) - back;
  row.strain = (nodes.x[driven] - back * nodes.vx[driven] - nodes.x[held]) / strip_.gauge_length - 1;
  row.force = force_on(carpet_, strip_.driven).x();
  row.force_held = -force_on(carpet_, strip_.held).x();
  row.stress = row.force / strip_.section();
  row.true_stress = row.stress * (1 + row.strain);
  row.principal_strain = largest_principal_strain(carpet_);
  row.failed = carpet_.eroded_count() > 0;
  return row;
}

coupler::EnergyTerms TensionStrip::energy_terms() const {
  return coupler::terms_of(carpet_.energy());
}

Vec3 TensionStrip::momentum() const {
  const fe::NodeView nodes = carpet_.nodes();
  Vec3 sum(0, 0, 0);
  for (std::size_t n = 0; n < nodes.mass.size(); ++n)
    sum += nodes.mass[n] * Vec3(nodes.vx[n], nodes.vy[n], nodes.vz[n]);
  return sum;
}

double TensionStrip::momentum_error() const {
  const fe::Carpet::GripSums grips = carpet_.grips();
  if (!(grips.exchanged > 0)) return 0;
  return (grips.impulse - (momentum() - first_momentum_)).norm() / grips.exchanged;
}

void TensionStrip::save(h5::Group& group) const {
  group.write_scalar("rows", rows_);
  group.write_scalar("steps", steps_);
  group.write_scalar("step", step_);
  h5::Group carpet = group.create_group("carpet");
  carpet_.save(carpet);
}

void TensionStrip::load(const h5::Group& group) {
  rows_ = group.read_count("rows");
  steps_ = group.read_count("steps");
  step_ = group.read_double("step");
  carpet_.load(group.open_group("carpet"));
}

double largest_principal_strain(const fe::Carpet& carpet) {
  const fe::ShellMesh& mesh = carpet.mesh();
  const fe::NodeView nodes = carpet.nodes();
  const double back = carpet.last_step();
  double largest = 0;
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    if (!carpet.eroded().empty() && carpet.eroded()[e]) continue;
    const auto& quad = mesh.quads[e];
    // Tangents at the middle, before (a) and now (b): F a = b, C = F^T F.
    Eigen::Matrix<double, 3, 2> before = Eigen::Matrix<double, 3, 2>::Zero(), now = before;
    constexpr std::array<double, 4> xi{-1, 1, 1, -1}, eta{-1, -1, 1, 1};
    for (std::size_t c = 0; c < 4; ++c) {
      const auto n = static_cast<std::size_t>(quad[c]);
      const Vec3 x =
          Vec3(nodes.x[n], nodes.y[n], nodes.z[n]) - back * Vec3(nodes.vx[n], nodes.vy[n], nodes.vz[n]);
      before.col(0) += 0.25 * xi[c] * mesh.nodes[n];
      before.col(1) += 0.25 * eta[c] * mesh.nodes[n];
      now.col(0) += 0.25 * xi[c] * x;
      now.col(1) += 0.25 * eta[c] * x;
    }
    const Eigen::Matrix2d metric = before.transpose() * before, metric_now = now.transpose() * now;
    const Eigen::Matrix2d ratio = metric.inverse() * metric_now;  // eigenvalues: squared principal stretches
    const double half = 0.5 * ratio.trace();
    const double square = half + std::sqrt(std::max(0.0, half * half - ratio.determinant()));
    largest = std::max(largest, 0.5 * std::log(square));
  }
  return largest;
}

}  // namespace tuft::rigs
