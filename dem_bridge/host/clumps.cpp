#include "dem_bridge/host/clumps.h"

#include <fmt/format.h>
#include <mpi.h>

#include <liggghts/lammps.h>
// LIGGGHTS' headers lean on each other's order.
#include <liggghts/atom.h>
#include <liggghts/fix_multisphere.h>
#include <liggghts/fix_property_atom.h>
#include <liggghts/modify.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <stdexcept>

#include "dem_bridge/protocol.h"

namespace tuft::dem {
namespace {

using Rows = LAMMPS_NS::VectorContainer<double, 3>;

Rows& rows(LAMMPS_NS::FixMultisphere& fix, const char* name) {
  auto* const container = fix.data().prop().getElementProperty<Rows>(name);
  if (container == nullptr)
    throw std::runtime_error(fmt::format("LIGGGHTS' bodies have no property {}", name));
  return *container;
}

Vec3 row(Rows& values, int place) {
  return Vec3(values.begin()[place]);
}
void set_row(Rows& values, int place, const Vec3& value) {
  std::copy_n(value.data(), 3, values.begin()[place]);
}

template <class Record>
bool read_record(std::ifstream& file, Record& record) {
  return static_cast<bool>(file.read(reinterpret_cast<char*>(&record), sizeof record));
}

}  // namespace

struct Clumps::Fields {
  explicit Fields(LAMMPS_NS::FixMultisphere& fix)
      : centre(rows(fix, "xcm")),
        velocity(rows(fix, "vcm")),
        angular_momentum(rows(fix, "angmom")),
        force(rows(fix, "fcm")),
        torque(rows(fix, "torque")),
        added_force(rows(fix, "dragforce_cm")),
        added_torque(rows(fix, "hdtorque_cm")),
        inertia(rows(fix, "inertia")),
        axis_x(rows(fix, "ex_space")),
        axis_y(rows(fix, "ey_space")),
        axis_z(rows(fix, "ez_space")) {}

  Rows &centre, &velocity, &angular_momentum, &force, &torque, &added_force, &added_torque, &inertia, &axis_x,
      &axis_y, &axis_z;
};

Clumps::~Clumps() = default;

Clumps::Clumps(LAMMPS_NS::LAMMPS& lammps) : lammps_(&lammps) {
  fix_ = dynamic_cast<LAMMPS_NS::FixMultisphere*>(lammps.modify->find_fix_id(clumps_fix));
  if (fix_ == nullptr) return;
  fields_ = std::make_unique<Fields>(*fix_);
  if (fix_->n_body() == 0) make_bodies();
  list_bodies();
}

/// As LIGGGHTS' own insertion does it for a particle: a body, the place of each sphere in it, and the whole
/// mass to each sphere, which is what contacts of a sphere feel.
void Clumps::make_bodies() {
  auto* const atom = lammps_->atom;
  // The first set-up gives atoms the defaults of fixes that are new, which would undo what is made here.
  fix_->just_created = 0;
  lammps_->modify->find_fix_id("volumeweight_ms")->just_created = 0;
  Vec3 none(0, 0, 0);
  for (int a = 0; a < atom->nlocal; ++a) fix_->set_body_displace(a, none.data(), -1, 1.0);
  std::ifstream file(bodies_file_name, std::ios::binary);
  if (!file) throw std::runtime_error("the file of bodies is missing");
  for (BodyRecord record; read_record(file, record);) {
    const auto first = static_cast<int>(record.first), count = static_cast<int>(record.count);
    if (first < 0 || count < 1 || first + count > atom->nlocal || atom->tag[first] != first + 1)
      throw std::runtime_error(
          fmt::format("the body of grains {} to {} is not where it should be", first, first + count - 1));
    std::array<bool, 3> free{true, true, true};
    auto& a = record.axes;
    fix_->data().add_body(count, record.centre.data(), none.data(), record.reach, none.data(), none.data(),
                          record.mass, record.density, atom->type[first], 1, record.inertia.data(),
                          a[0].data(), a[1].data(), a[2].data(), nullptr, free.data(), free.data());
    for (int k = first; k < first + count; ++k) {
      BodySphere sphere;
      if (!read_record(file, sphere)) throw std::runtime_error("the file of bodies ends too early");
      atom->rmass[k] = record.mass;
      constexpr int without_a_number = -2;  // which add_body_finalize() hands out
      fix_->set_body_displace(k, sphere.place.data(), without_a_number, sphere.share);
    }
  }
  fix_->add_body_finalize();
}

void Clumps::list_bodies() {
  const int count = lammps_->atom->nlocal;
  of_atom_.assign(static_cast<std::size_t>(count), -1);
  for (int a = 0; a < count; ++a) {
    const int number = fix_->belongs_to(a);
    if (number < 0) continue;
    if (bodies_.empty() || a == 0 || fix_->belongs_to(a - 1) != number)
      bodies_.push_back({a, 0, fix_->data().map(number)});
    ++bodies_.back().count;
    of_atom_[static_cast<std::size_t>(a)] = static_cast<int>(bodies_.size()) - 1;
  }
  for (const Body& body : bodies_)
    if (body.place < 0 || body.count != fix_->data().nrigid(body.place))
      throw std::runtime_error(
          fmt::format("the spheres of the body of grain {} do not follow each other", body.first));
}

double Clumps::share(int atom) const {
  return fix_ == nullptr ? 1 : fix_->get_volumeweight()->vector_atom[atom];
}

Vec3 Clumps::centre(const Body& body) const {
  return row(fields_->centre, body.place);
}

double Clumps::mass(const Body& body) const {
  return fix_->data().mass(body.place);
}

BodyState Clumps::state(const Body& body) const {
  const auto* const atom = lammps_->atom;
  BodyState state;
  state.velocity = row(fields_->velocity, body.place);
  state.angular_momentum = row(fields_->angular_momentum, body.place);
  state.pair_force = state.pair_torque = Vec3(0, 0, 0);
  const Vec3 middle = centre(body);
  for (int a = body.first; a < body.first + body.count; ++a) {
    const Vec3 force(atom->f[a]), lever = Vec3(atom->x[a]) - middle;
    state.pair_force += force;
    state.pair_torque += Vec3(atom->torque[a]) + lever.cross(force);
  }
  state.mass = mass(body);
  Mat3 axes;
  axes << row(fields_->axis_x, body.place), row(fields_->axis_y, body.place),
      row(fields_->axis_z, body.place);
  state.inverse_inertia =
      axes * row(fields_->inertia, body.place).cwiseInverse().asDiagonal() * axes.transpose();
  return state;
}

void Clumps::set_motion(const Body& body, const Vec3& velocity, const Vec3& angular_momentum) {
  set_row(fields_->velocity, body.place, velocity);
  set_row(fields_->angular_momentum, body.place, angular_momentum);
}

void Clumps::set_velocity_and_spin(const Body& body, const Vec3& velocity, const Vec3& spin) {
  set_row(fields_->velocity, body.place, velocity);
  Vec3 omega = spin;
  fix_->data().set_angmom_via_omega_body(body.place, omega.data());
}

void Clumps::set_forces(const Body& body, const Vec3& force, const Vec3& torque) {
  set_row(fields_->force, body.place, force);
  set_row(fields_->torque, body.place, torque);
}

void Clumps::set_added(const Body& body, const Vec3& force, const Vec3& torque) {
  set_row(fields_->added_force, body.place, force);
  set_row(fields_->added_torque, body.place, torque);
}

void Clumps::clear_forces() {
  if (fix_ != nullptr) fix_->data().reset_forces(true);
}

void Clumps::move_spheres() {
  if (fix_ != nullptr) fix_->set_v_communicate();
}

/// The fix has a copy of the step, and no reset_dt of its own.
void Clumps::take_step() {
  if (fix_ != nullptr) fix_->init();
}

void Clumps::park(const Body& body, const Vec3& place) {
  set_row(fields_->centre, body.place, place);
  for (int a = body.first; a < body.first + body.count; ++a) {
    fix_->scale_displace(a, 1e-6);
    for (int c = 0; c < 3; ++c) lammps_->atom->x[a][c] = place[c];
    lammps_->atom->radius[a] *= 1e-6;
  }
}

}  // namespace tuft::dem
