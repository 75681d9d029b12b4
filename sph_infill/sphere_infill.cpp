#include "sph_infill/sphere_infill.h"

#include <cmath>

#include "core/checkpoint_values.h"
#include "core/error.h"
#include "sph_infill/compaction.h"
#include "sph_infill/particle_packs.h"
#include "sph_infill/sphere_pairs.h"

namespace tuft::sph {
namespace {

/// Skin of the list of pairs over the largest diameter.
constexpr double skin_over_diameter = 0.2;
/// A solid sphere's inertia over m r^2.
constexpr double inertia_ratio = 0.4;

/// What the kick of a block adds up.
struct BlockSums {
  double kinetic = 0, potential = 0;
  KickWork other, damping, contact;
  Vec3 impulse{0, 0, 0}, impulse_scale{0, 0, 0};
  double largest_speed_squared = 0;
  bool valid = true;

  BlockSums& operator+=(const BlockSums& b) {
    kinetic += b.kinetic, potential += b.potential;
    other += b.other, damping += b.damping, contact += b.contact;
    impulse += b.impulse, impulse_scale += b.impulse_scale;
    largest_speed_squared = std::max(largest_speed_squared, b.largest_speed_squared);
    valid = valid && b.valid;
    return *this;
  }
};

/// A sum of work, and the part of the last kick's that lies behind the moment of its force.
struct WorkAccount {
  double sum = 0, pending = 0;
  void add(const KickWork& work) {
    sum += pending + work.until_now;
    pending = work.whole - work.until_now;
  }
};

void check(const SphereSettings& settings, std::size_t materials) {
  const auto positive = [](double value, const char* name) {
    if (!(value > 0) || !std::isfinite(value))
      throw_input_error("spheres of conditioning: {} is {}; it must be above 0", name, value);
  };
  positive(settings.diameter_ratio, "the diameter ratio");
  positive(settings.modulus, "the modulus");
  if (!(settings.friction >= 0) || !std::isfinite(settings.friction))
    throw_input_error("spheres of conditioning: friction is {}; it must be at least 0", settings.friction);
  if (settings.damping_ratio.size() != materials)
    throw_input_error("spheres of conditioning: {} damping ratios for {} materials",
                      settings.damping_ratio.size(), materials);
}

}  // namespace

std::vector<double> sphere_radii(const Lattice& lattice, double diameter_ratio) {
  std::vector<double> radius;
  for (const double volume : lattice.volume) radius.push_back(0.5 * diameter_ratio * std::cbrt(volume));
  return radius;
}

struct SphereInfill::Impl {
  Vec3 gravity{0, 0, 0};
  SphereLaw law;
  Vec3Array position, velocity, spin;  ///< m at t_k; m/s and rad/s at t_k - dt/2
  std::vector<double> radius, contact_radius, mass, damping_ratio;
  std::vector<double> density, placed_volume;  ///< kg/m^3 and m^3, as placed
  std::vector<Index> layer, material;
  SpherePairs pairs;
  std::unique_ptr<CompactionMeasure> compaction;
  bool lost_strength = false;

  double time = 0, step_before = 0, damping = 0;  ///< s, s, 1/s
  double displacement = 0;                        ///< m, no sphere has moved farther since the list was made
  double largest_overlap = 0;
  std::uint64_t particle_steps = 0;
  double kinetic = 0, potential = 0, normal = 0, tangential = 0;  ///< J, as of the last force evaluation
  WorkAccount other, damped, contact;  ///< J, work of dashpots and friction on the spheres
  std::vector<BlockSums> blocks;

  [[nodiscard]] SphereView view() const { return {position, velocity, spin, radius, mass, damping_ratio}; }
  BlockSums step(double dt, const ContactImpulses& impulses, double share);
  BlockSums kick(double dt, const ContactImpulses* impulses, double share);
  void kick_sphere(std::size_t i, double dt, const Vec3& impulse, const Vec3& angular, BlockSums& sums);
  [[noreturn]] void report_invalid() const;
  template <class Visit>
  void visit_numbers(Visit&& visit);
};

SphereInfill::SphereInfill(const Lattice& lattice, const std::vector<Material>& materials,
                           const Vec3Array& position, const SphereSettings& settings)
    : impl_(std::make_unique<Impl>()) {
  check(settings, materials.size());
  const std::size_t n = lattice.position.size();
  if (n == 0) throw_input_error("SPH infill has no particles");
  if (position.size() != n)
    throw_run_error("spheres of conditioning: {} positions for {} particles", position.size(), n);
  Impl& m = *impl_;
  m.gravity = settings.gravity;
  m.law = {settings.modulus, settings.friction};
  m.lost_strength = settings.lost_strength;
  m.position = position;
  m.velocity.assign(n, 0), m.spin.assign(n, 0);
  m.layer = lattice.layer, m.material = lattice.material;
  m.placed_volume = lattice.volume;
  m.radius = sphere_radii(lattice, settings.diameter_ratio);
  m.contact_radius = sphere_radii(lattice, 1);
  for (std::size_t i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(lattice.material[i]);
    if (k >= materials.size() || !materials[k].continuum)
      throw_input_error("SPH infill: material number {} has no [continuum] block", k);
    m.density.push_back(materials[k].continuum->density);
    m.mass.push_back(m.density[i] * lattice.volume[i]);
    m.damping_ratio.push_back(settings.damping_ratio[k]);
  }
  m.pairs =
      SpherePairs(m.view(), skin_over_diameter * 2 * *std::max_element(m.radius.begin(), m.radius.end()));
  m.compaction = std::make_unique<CompactionMeasure>(lattice, settings.options);
  m.blocks.resize((n + block_size - 1) / block_size);
}

SphereInfill::~SphereInfill() = default;

ParticleView SphereInfill::particles() const {
  const Impl& m = *impl_;
  return {m.position.x, m.position.y, m.position.z,     m.velocity.x, m.velocity.y, m.velocity.z, m.spin.x,
          m.spin.y,     m.spin.z,     m.contact_radius, m.mass,       m.layer,      m.material,   {}};
}

double SphereInfill::stable_step() const {
  const Impl& m = *impl_;
  const double omega = std::sqrt(m.pairs.frequency_squared(m.law, m.view()));
  const double zeta = *std::max_element(m.damping_ratio.begin(), m.damping_ratio.end());
  return 2 / omega * (std::sqrt(1 + zeta * zeta) - zeta);
}

AdvanceReport SphereInfill::advance(double window, int substeps, const ContactImpulses& contact) {
  Impl& m = *impl_;
  const std::size_t n = m.mass.size();
  if (!(window > 0) || !std::isfinite(window) || substeps < 1)
    throw_run_error("spheres: a window of {} s in {} substeps cannot be advanced", window, substeps);
  for (const std::size_t given : {contact.linear.size(), contact.angular.size()})
    if (given != 0 && given != n)
      throw_run_error("spheres: contact impulses for {} particles, but there are {}", given, n);
  AdvanceReport report;
  for (int s = 0; s < substeps; ++s) {
    const BlockSums sums = m.step(window / substeps, contact, 1.0 / substeps);
    report.impulse_received += sums.impulse;
    report.impulse_scale += sums.impulse_scale;
  }
  report.substeps = substeps;
  return report;
}

BlockSums SphereInfill::Impl::step(double dt, const ContactImpulses& impulses, double share) {
  if (displacement > pairs.allowed_displacement()) {
    pairs.list(view());
    displacement = 0;
  }
  const PairSums springs = pairs.evaluate(law, view(), step_before);
  normal = springs.normal;
  tangential = springs.tangential;
  largest_overlap = std::max(largest_overlap, springs.largest_overlap);
  const BlockSums sums = kick(dt, &impulses, share);
  if (!sums.valid) report_invalid();
  displacement += dt * std::sqrt(sums.largest_speed_squared);
  time += dt;
  step_before = dt;
  particle_steps += mass.size();
  return sums;
}

/// The kick about t_k, then drifts by dt.
BlockSums SphereInfill::Impl::kick(double dt, const ContactImpulses* impulses, double share) {
  const auto impulse_of = [&](const Vec3Array& values, std::size_t i) {
    return values.size() == 0 ? Vec3(0, 0, 0) : Vec3(share * values[i]);
  };
  for_blocks(mass.size(), nullptr, [&](std::size_t b, std::size_t begin, std::size_t end) {
    BlockSums& sums = blocks[b] = {};
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 none(0, 0, 0);
      kick_sphere(i, dt, impulses ? impulse_of(impulses->linear, i) : none,
                  impulses ? impulse_of(impulses->angular, i) : none, sums);
      position.add(i, dt * velocity[i]);
      const double speed_squared = velocity[i].squaredNorm();
      sums.largest_speed_squared = std::max(sums.largest_speed_squared, speed_squared);
      if (!std::isfinite(speed_squared + spin[i].squaredNorm() + position[i].squaredNorm()))
        sums.valid = false;
    }
  });
  BlockSums sum;
  for (const BlockSums& block : blocks) sum += block;
  kinetic = sum.kinetic;
  potential = sum.potential;
  other.add(sum.other);
  damped.add(sum.damping);
  contact.add(sum.contact);
  return sum;
}

/// Velocity and spin under all that acts over the kick, and the works of it. Damping acts on the mean of the
/// values before and after.
void SphereInfill::Impl::kick_sphere(std::size_t i, double dt, const Vec3& impulse, const Vec3& angular,
                                     BlockSums& sums) {
  // KickLength::step_begun: spheres live in coupled runs alone. The first kick starts from rest, the last
  // ends at t_k.
  const double t = step_before > 0 && dt > 0 ? dt : 0.5 * (step_before + dt),
               half_damping = 0.5 * damping * t;
  // The kick's impulses were given evenly over it: this share of each belongs before t_k.
  const double share = t > 0 ? std::min(1.0, 0.5 * step_before / t) : 0;
  const SphereLoad load = pairs.load_on(i, radius[i]);
  const double inertia = inertia_ratio * mass[i] * radius[i] * radius[i];
  const auto add = [share](KickWork& work, const Vec3& given, const Vec3& before, const Vec3& after) {
    work.until_now += share * given.dot(before);
    work.whole += 0.5 * given.dot(before + after);
  };

  const Vec3 v = velocity[i], w = spin[i];
  const Vec3 force = load.spring + load.other + mass[i] * gravity;
  const Vec3 v_after = ((1 - half_damping) * v + (t * force + impulse) / mass[i]) / (1 + half_damping);
  const Vec3 w_after = ((1 - half_damping) * w + (t * load.torque + angular) / inertia) / (1 + half_damping);
  // As of t_k, m v- . v+ / 2 for a step as long as the one before.
  const auto centred = [share](const Vec3& before, const Vec3& after) {
    return before.dot(before + 2 * share * (after - before));
  };
  sums.kinetic += 0.5 * (mass[i] * centred(v, v_after) + inertia * centred(w, w_after));
  sums.potential -= mass[i] * gravity.dot(position[i]);
  add(sums.other, t * load.other, v, v_after);
  add(sums.other, t * load.torque, w, w_after);
  add(sums.damping, (0.5 * damping * t * mass[i]) * (v + v_after), v, v_after);
  add(sums.damping, (0.5 * damping * t * inertia) * (w + w_after), w, w_after);
  add(sums.contact, impulse, v, v_after);
  add(sums.contact, angular, w, w_after);
  sums.impulse += impulse;
  sums.impulse_scale += impulse.cwiseAbs();
  velocity.set(i, v_after);
  spin.set(i, w_after);
}

void SphereInfill::Impl::report_invalid() const {
  for (std::size_t i = 0; i < mass.size(); ++i) {
    const Vec3 v = velocity[i], w = spin[i], x = position[i];
    if (!v.allFinite() || !w.allFinite() || !x.allFinite())
      throw_run_error(
          "sphere {} of conditioning at t = {:.6g} s: position ({}, {}, {}) m, velocity ({}, {}, {}) m/s, "
          "spin ({}, {}, "
          "{}) rad/s; look at the contact that loads it, or lower numerics.step_safety",
          i, time, x.x(), x.y(), x.z(), v.x(), v.y(), v.z(), w.x(), w.y(), w.z());
  }
  throw_run_error(
      "spheres of conditioning at t = {:.6g} s: speeds are too large to square; the run is unstable", time);
}

void SphereInfill::set_damping(double rate) {
  if (!(rate >= 0) || !std::isfinite(rate))
    throw_input_error("damping rate of the infill is {} 1/s; it must be at least 0", rate);
  impl_->damping = rate;
}

InfillEnergy SphereInfill::energy() const {
  const Impl& m = *impl_;
  InfillEnergy energy;
  energy.kinetic = m.kinetic;
  energy.stored = m.normal + m.tangential;
  energy.dissipated = -m.other.sum - m.tangential;
  energy.gravity_potential = m.potential;
  energy.damping = m.damped.sum;
  energy.contact_work = m.contact.sum;
  return energy;
}

std::uint64_t SphereInfill::particle_steps() const {
  return impl_->particle_steps;
}

double SphereInfill::largest_overlap() const {
  return impl_->largest_overlap;
}

double SphereInfill::mean_contacts() const {
  return 2.0 * static_cast<double>(impl_->pairs.touching()) / static_cast<double>(impl_->mass.size());
}

void SphereInfill::set_velocity(std::size_t i, const Vec3& v) {
  impl_->velocity.set(i, v);
}

void SphereInfill::set_spin(std::size_t i, const Vec3& w) {
  impl_->spin.set(i, w);
}

CompactedBed SphereInfill::hand_over() {
  Impl& m = *impl_;
  // A kick of no step after t_k brings velocities there; `centred` then holds for the step that would have
  // followed.
  const PairSums springs = m.pairs.evaluate(m.law, m.view(), m.step_before);
  m.normal = springs.normal;
  m.tangential = springs.tangential;
  (void)m.kick(0, nullptr, 0);
  CompactedBed bed;
  bed.position = m.position;
  bed.velocity = m.velocity;
  bed.density_ratio = m.compaction->smoothed(m.position, m.compaction->ratio(m.position));
  bed.time = m.time;
  bed.damping = m.damping;
  bed.energy = energy();
  const double held = deterministic_sum<double>(
      m.mass.size(), [&](std::size_t i) { return 0.5 * m.mass[i] * m.velocity[i].squaredNorm(); });
  bed.energy.let_go = bed.energy.kinetic - held + bed.energy.stored;
  bed.energy.kinetic = held;
  bed.energy.stored = 0;
  return bed;
}

std::vector<Infill::Field> SphereInfill::fields() const {
  const Impl& m = *impl_;
  const std::size_t n = m.mass.size();
  const SphereView view = m.view();
  std::vector<double> density = m.compaction->ratio(m.position), pressure(n), shear(n), vertical(n);
  parallel_for(n, [&](std::size_t i) {
    const Mat3 raw = m.pairs.stress_in(i, view, m.placed_volume[i] / density[i]);
    const Mat3 stress = 0.5 * (raw + raw.transpose());
    pressure[i] = stress.trace() / 3;
    shear[i] = std::sqrt(0.5) * (stress - pressure[i] * Mat3::Identity()).norm();
    vertical[i] = -stress(2, 2);
    density[i] *= m.density[i];
  });
  std::vector<Infill::Field> fields{{"pressure", "Pa", std::move(pressure)},
                                    {"density", "kg/m^3", std::move(density)},
                                    {"shear_stress", "Pa", std::move(shear)},
                                    {"vertical_stress", "Pa", std::move(vertical)},
                                    {"plastic_compression", "1", std::vector<double>(n, 0.0)}};
  if (m.lost_strength) fields.push_back({"lost_strength", "1", std::vector<double>(n, 0.0)});
  return fields;
}

/// Every number that a checkpoint holds.
template <class Visit>
void SphereInfill::Impl::visit_numbers(Visit&& visit) {
  visit("time", time), visit("step_before", step_before), visit("damping", damping);
  visit("largest_overlap", largest_overlap);
  visit("kinetic", kinetic), visit("potential", potential), visit("normal", normal),
      visit("tangential", tangential);
  visit("other", other.sum), visit("other_pending", other.pending);
  visit("damped", damped.sum), visit("damped_pending", damped.pending);
  visit("contact", contact.sum), visit("contact_pending", contact.pending);
}

void SphereInfill::save(h5::Group& group) {
  Impl& m = *impl_;
  const auto write = [&](const std::string& name, const Vec3Array& v) {
    group.write(name + "x", std::span<const double>(v.x));
    group.write(name + "y", std::span<const double>(v.y));
    group.write(name + "z", std::span<const double>(v.z));
  };
  write("position_", m.position), write("velocity_", m.velocity), write("spin_", m.spin);
  m.visit_numbers([&](const char* name, double value) { group.write_scalar(name, value); });
  group.write_scalar("particle_steps", m.particle_steps);
  h5::Group pairs = group.create_group("contacts");
  m.pairs.save(pairs);
}

void SphereInfill::load(const h5::Group& group) {
  Impl& m = *impl_;
  const auto read = [&](const std::string& name, Vec3Array& v) {
    const std::size_t n = v.size();
    v = {h5::read_checked(group, name + "x", n), h5::read_checked(group, name + "y", n),
         h5::read_checked(group, name + "z", n)};
  };
  read("position_", m.position), read("velocity_", m.velocity), read("spin_", m.spin);
  m.visit_numbers([&](const char* name, double& value) { value = h5::read_number(group, name); });
  m.particle_steps = h5::read_count(group, "particle_steps");
  m.displacement = 0;
  m.pairs.load(group.open_group("contacts"), m.view());
}

std::vector<std::array<double, 6>> SphereInfill::stress_moments() const {
  const Impl& m = *impl_;
  const SphereView view = m.view();
  std::vector<std::array<double, 6>> moments(m.mass.size());
  parallel_for(moments.size(), [&](std::size_t i) {
    const Mat3 raw = m.pairs.stress_in(i, view, 1.0);  // times the volume; compression positive
    const Mat3 moment = -0.5 * (raw + raw.transpose());
    moments[i] = {moment(0, 0), moment(1, 1), moment(2, 2), moment(0, 1), moment(1, 2), moment(2, 0)};
  });
  return moments;
}

}  // namespace tuft::sph
