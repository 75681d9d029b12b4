#include "dem_bridge/host/contact_network.h"

#include <fmt/format.h>
#include <mpi.h>

#include <liggghts/lammps.h>
// LIGGGHTS' headers lean on each other's order.
#include <liggghts/atom.h>
#include <liggghts/compute_pair_gran_local.h>
#include <liggghts/force.h>
#include <liggghts/modify.h>
#include <liggghts/neigh_list.h>
#include <liggghts/pair_gran.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "core/vector.h"
#include "dem_bridge/host/contact_history.h"

namespace tuft::dem {
namespace {

/// The sums over the contacts meet the grains' own forces up to the order of additions.
constexpr double largest_difference = 1e-9;  // of the largest force of a contact

/// While it lives, grains have the velocities and spins of the shared memory.
class VelocitiesOfEvaluation {
 public:
  VelocitiesOfEvaluation(LAMMPS_NS::Atom& atom, const SharedMemory& memory) : atom_(atom) {
    for (double** const field : {atom.v, atom.omega}) {
      const std::size_t first = field == atom.v ? SharedArrays::velocity_x : SharedArrays::spin_x;
      for (int a = 0; a < atom.nlocal + atom.nghost; ++a)
        for (std::size_t c = 0; c < 3; ++c) {
          kept_.push_back(field[a][c]);
          field[a][c] = memory.array(first + c)[static_cast<std::size_t>(atom.tag[a] - 1)];
        }
    }
  }
  ~VelocitiesOfEvaluation() {
    const double* from = kept_.data();
    for (double** const field : {atom_.v, atom_.omega})
      for (int a = 0; a < atom_.nlocal + atom_.nghost; ++a, from += 3) std::copy_n(from, 3, field[a]);
  }
  VelocitiesOfEvaluation(const VelocitiesOfEvaluation&) = delete;
  VelocitiesOfEvaluation& operator=(const VelocitiesOfEvaluation&) = delete;

 private:
  LAMMPS_NS::Atom& atom_;
  std::vector<double> kept_;
};

/// While it lives, tangential springs are longer by so little that it shows in no result, and longer than
/// Coulomb's limit where they were at it. A spring that slid in the evaluation was cut to the limit, without
/// a dashpot. Evaluated anew it would pass or fail the comparison with the limit by rounding, and about half
/// of all sliding contacts would be given a dashpot that they did not have. Without friction the limit is 0,
/// and so are the springs: they get a length of nearly nothing.
class SpringsPastTheirLimit {
 public:
  explicit SpringsPastTheirLimit(LAMMPS_NS::PairGran& pair) : pair_(pair) {
    visit([&](double& component) {
      kept_.push_back(component);
      component = component == 0 ? nearly_nothing : component * (1 + stretch);
    });
  }
  ~SpringsPastTheirLimit() {
    const double* from = kept_.data();
    visit([&](double& component) { component = *from++; });
  }
  SpringsPastTheirLimit(const SpringsPastTheirLimit&) = delete;
  SpringsPastTheirLimit& operator=(const SpringsPastTheirLimit&) = delete;

 private:
  static constexpr double stretch = 1e-12, nearly_nothing = 1e-100;  // m

  template <class Visit>
  void visit(Visit&& visit_component) {
    const LAMMPS_NS::NeighList& list = *pair_.list;
    for (int k = 0; k < list.inum; ++k) {
      const int a = list.ilist[k];
      double* history = pair_.listgranhistory->firstdouble[a];
      for (int n = 0; n < list.numneigh[a]; ++n, history += pair_.dnum())
        for (int c = 0; c < 3; ++c) visit_component(history[first_vector(pair_.dnum()) + c]);
    }
  }

  LAMMPS_NS::PairGran& pair_;
  std::vector<double> kept_;
};

std::vector<ContactRecord> read_records(LAMMPS_NS::ComputePairGranLocal& compute) {
  std::vector<ContactRecord> records(static_cast<std::size_t>(compute.get_ncount()));
  double** const rows = compute.get_data();
  const int id = compute.offset_id1(), other = compute.offset_id2(), force = compute.offset_f();
  for (std::size_t r = 0; r < records.size(); ++r) {
    ContactRecord& record = records[r];
    record.first = static_cast<std::int32_t>(rows[r][id]) - 1;
    record.second = static_cast<std::int32_t>(rows[r][other]) - 1;
    std::copy_n(rows[r] + force, 3, record.force.begin());
    if (record.first < record.second) continue;
    std::swap(record.first, record.second);
    for (double& component : record.force) component = -component;
  }
  // LIGGGHTS' order depends on when its lists were built.
  std::sort(records.begin(), records.end(), [](const ContactRecord& a, const ContactRecord& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return records;
}

/// Of the grains of this rank that touch none of another rank's: of a contact between two ranks' grains
/// LIGGGHTS lists it on one of them alone.
void check_sums(const std::vector<ContactRecord>& records, const LAMMPS_NS::Atom& atom,
                const LAMMPS_NS::NeighList& list, std::size_t grains) {
  std::vector<char> across(static_cast<std::size_t>(atom.nlocal), 0);
  for (int k = 0; k < list.inum; ++k)
    for (int n = 0; n < list.numneigh[list.ilist[k]]; ++n)
      if ((list.firstneigh[list.ilist[k]][n] & NEIGHMASK) >= atom.nlocal)
        across[static_cast<std::size_t>(list.ilist[k])] = 1;
  std::vector<Vec3> left(grains, Vec3(0, 0, 0));
  for (int a = 0; a < atom.nlocal; ++a)
    left[static_cast<std::size_t>(atom.tag[a] - 1)] = Vec3(atom.f[a][0], atom.f[a][1], atom.f[a][2]);
  double largest = 0;
  for (const ContactRecord& record : records) {
    const Vec3 force(record.force[0], record.force[1], record.force[2]);
    left[static_cast<std::size_t>(record.first)] -= force;
    left[static_cast<std::size_t>(record.second)] += force;
    largest = std::max(largest, force.norm());
  }
  for (int a = 0; a < atom.nlocal; ++a) {
    const auto i = static_cast<std::size_t>(atom.tag[a] - 1);
    if (across[static_cast<std::size_t>(a)] != 0) continue;
    if (!(left[i].norm() <= largest_difference * largest))
      throw std::runtime_error(
          fmt::format("the contacts of grain {} add up to a force that differs from its own by {:.3g} N (the "
                      "largest of a contact is {:.3g} N)",
                      i, left[i].norm(), largest));
  }
}

}  // namespace

std::string list_contacts(LAMMPS_NS::LAMMPS& lammps, const SharedMemory& memory, bool own_forces_current) {
  const int index = lammps.modify->find_compute("contact_forces");
  auto* compute =
      index < 0 ? nullptr : dynamic_cast<LAMMPS_NS::ComputePairGranLocal*>(lammps.modify->compute[index]);
  if (compute == nullptr) throw std::runtime_error("LIGGGHTS was not told to compute the forces of contacts");
  auto* pair = dynamic_cast<LAMMPS_NS::PairGran*>(lammps.force->pair);
  if (pair == nullptr || pair->list == nullptr || pair->listgranhistory == nullptr)
    throw std::runtime_error("LIGGGHTS has no granular neighbour list");
  {
    const VelocitiesOfEvaluation velocities(*lammps.atom, memory);
    const SpringsPastTheirLimit springs(*pair);
    compute->compute_local();
  }
  const std::vector<ContactRecord> records = read_records(*compute);
  if (own_forces_current) check_sums(records, *lammps.atom, *pair->list, memory.grains());
  std::string bytes(records.size() * sizeof(ContactRecord), '\0');
  if (!records.empty()) std::memcpy(bytes.data(), records.data(), bytes.size());
  return bytes;
}

}  // namespace tuft::dem
