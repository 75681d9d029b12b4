#include "dem_bridge/host/liggghts_engine.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "dem_bridge/host/contact_network.h"
#include "dem_bridge/host/engine_impl.h"
#include "dem_bridge/host/screen_ring.h"

namespace tuft::dem {

using Clock = std::chrono::steady_clock;

LiggghtsEngine::Impl::Impl(SharedMemory& shared_memory, int rank)
    : memory(shared_memory),
      shared(shared_memory.state()),
      report(shared_memory.rank(static_cast<std::size_t>(rank))) {
  const char* arguments[] = {"liggghts", "-log", "none", "-nocite", "-screen", "none"};
  std::vector<char*> pointers;
  for (const char* text : arguments) pointers.push_back(const_cast<char*>(text));  // LIGGGHTS only reads them
  lammps = new LAMMPS_NS::LAMMPS(static_cast<int>(pointers.size()), pointers.data(), MPI_COMM_WORLD);
  lammps->screen = open_screen_ring(report);
}

/// x(t), v(t - dt/2), own forces at t. After the last substep they are published; the window's load on grains
/// comes with the next. After the others grains step on.
void LiggghtsEngine::Impl::callback(void* self, LAMMPS_NS::bigint timestep, int count, int*, double**,
                                    double** external) {
  auto& engine = *static_cast<Impl*>(self);
  if (count > 0 && timestep % external_forces_every == 0)
    std::fill_n(external[0], 3 * static_cast<std::size_t>(count), 0.0);  // rows follow each other
  if (!engine.stepping) return;
  if (++engine.substep < engine.shared.substeps) {
    engine.step_grains(true);
    return;
  }
  const auto start = Clock::now();
  engine.clumps->clear_forces();  // of the kick before; LIGGGHTS sums their own after this
  engine.publish_state();
  engine.copy_seconds = seconds_since(start);
}

/// Spheres make their whole kick with the step that comes; of clumps the half kick that the pair forces have
/// made already must be half of it.
void LiggghtsEngine::Impl::set_step(double step) {
  auto* const update = lammps->update;
  if (step == update->dt) return;
  if (started) change_clump_step(0.5 * (step - update->dt));
  update->update_time();
  update->dt = step;
  update->integrate->reset_dt();
  lammps->force->pair->reset_dt();
  for (int i = 0; i < lammps->modify->nfix; ++i) lammps->modify->fix[i]->reset_dt();
  clumps->take_step();
}

/// First pair forces, from positions and velocities alone, and the half kick of clumps that they make.
void LiggghtsEngine::Impl::start() {
  take_velocities();
  command("run 0 post no");
  clumps->clear_forces();  // the set-up has summed them once already
  lammps->modify->final_integrate();
  started = true;
}

LiggghtsEngine::LiggghtsEngine(SharedMemory& memory, int rank)
    : impl_(std::make_unique<Impl>(memory, rank)) {}
LiggghtsEngine::~LiggghtsEngine() = default;

void LiggghtsEngine::set_up(const std::string& commands) {
  Impl& my = *impl_;
  std::istringstream stream(commands);
  for (std::string line; std::getline(stream, line);) my.command(line);
  my.command(contact_forces_command);
  auto* coupling = dynamic_cast<LAMMPS_NS::FixExternal*>(my.lammps->modify->find_fix_id("coupling"));
  if (coupling == nullptr) throw std::runtime_error("the commands define no `fix coupling all external`");
  coupling->set_callback(&Impl::callback, &my);
  my.clumps = std::make_unique<Clumps>(*my.lammps);
  my.command("run 0 post no");
  my.report.grains = static_cast<std::uint64_t>(my.local_count());
  const auto mass = my.memory.array(SharedArrays::mass), radius = my.memory.array(SharedArrays::radius);
  for (int a = 0; a < my.local_count(); ++a) {
    mass[my.index(a)] = my.clumps->share(a) * my.lammps->atom->rmass[a];
    radius[my.index(a)] = my.lammps->atom->radius[a];
  }
}

void LiggghtsEngine::resume() {
  Impl& my = *impl_;
  my.set_step(my.shared.step);
  my.restore_own_forces();
  my.find_parked();
  my.started = true;
}

void LiggghtsEngine::advance() {
  Impl& my = *impl_;
  const auto begin = Clock::now();
  my.set_step(my.shared.step);
  if (!my.started) my.start();
  RankState& report = my.report;
  report.impulse_received = report.impulse_scale = {};
  report.pair_work = report.contact_work = report.damping_work = 0;
  my.step_grains(false);

  my.stepping = true;
  my.substep = 0;
  my.copy_seconds = 0;
  my.command(fmt::format("run {} pre no post no", my.shared.substeps));
  my.stepping = false;
  report.copy_seconds = my.copy_seconds;
  report.run_seconds = seconds_since(begin) - report.copy_seconds;
  report.grains = static_cast<std::uint64_t>(my.local_count());
  if (!my.trouble.empty()) throw std::runtime_error(my.trouble);
}

void LiggghtsEngine::take_census() {
  const auto present = impl_->memory.array(SharedArrays::coordination);
  for (int a = 0; a < impl_->local_count(); ++a) present[impl_->index(a)] = 1;
}

void LiggghtsEngine::compute_stored_energy() {
  impl_->report.stored_energy = impl_->stored_energy(false);
}

std::string LiggghtsEngine::list_overlaps() {
  return impl_->list_overlaps();
}

std::string LiggghtsEngine::list_contacts() {
  return dem::list_contacts(*impl_->lammps, impl_->memory, impl_->started);
}

/// Writing a restart file alone would let this run and one resumed from the file part in the order of their
/// sums; the set-up after it (`run 0`) brings both to the same order. It evaluates the forces anew without
/// advancing the springs, which is a slightly different force: so the old ones are put back, here and after
/// reading.
void LiggghtsEngine::save(const std::string& restart_file) {
  Impl& my = *impl_;
  my.publish_own_forces();
  my.command("write_restart " + restart_file);
  my.command("run 0 post no");
  my.report.grains = static_cast<std::uint64_t>(my.local_count());
  my.restore_own_forces();
}

}  // namespace tuft::dem
