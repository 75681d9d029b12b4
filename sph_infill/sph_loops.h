#pragma once
/// The two neighbour passes of a step and its drift. They gather: every particle writes its own entries
/// alone, sums go through fixed blocks, so that any number of threads gives the same bits.
///
/// Discretisation. With g_ij = grad_i W_ij = (dW/dr / r)(x_i - x_j), V_j the volume that gradients weigh j
/// by, and B_i = (sum_j V_j (x_j - x_i) (x) g_ij)^-1 (symmetric, as g_ij is parallel to x_j - x_i):
///
///   L_i = sum_j V_j (v_j - v_i) (x) B_i g_ij,
///
/// which is exact for v linear in x, whatever V_j. The force is its variational partner. Stress power is
///   P = sum_i v_i* sigma_i : L_i = sum_i sum_j v_i* V_j (v_j - v_i) . sigma_i B_i g_ij      (v_i* current
///   volume),
/// and f_k = -dP/dv_k collects v_k as "i" and, with g_ik = -g_ki, as "j":
///
///   f_k = sum_j (V_j v_k* sigma_k B_k + V_k v_j* sigma_j B_j) g_kj.
///
/// So sum_k f_k . v_k = -P for every velocity field, pair forces are opposite and equal, and a uniform stress
/// gives no net force where the neighbourhood is full. With S_j = (v_j*/V_j) sigma_j B_j it is
///
///   f_k = sum_j V_k V_j (S_k + S_j) g_kj.
///
/// (V and v* differ by one step's compression; keeping V through both passes is what makes them partners
/// exactly.)
///
/// Zero-energy modes. L sees the part of a neighbourhood's motion that is linear. What is left of a pair's
/// motion, r_ij = v_j - v_i - L_i (x_j - x_i), meets no stress, and gathers from rounding and contact. It is
/// damped by
///
///   D = sum_i C_i V_i/2 sum_j V_j s_ij |r_ij|^2,   s_ij = -(dW/dr / r) >= 0,   C = zeta rho c h   (Pa s),
///   f_k = -dD/dv_k = sum_j V_k V_j s_kj (C_k r_kj - C_j r_jk).
///
/// The derivatives through L vanish, for L_i is the least-squares fit with these weights:
/// sum_j V_j s_ij r_ij (x) (x_j - x_i) = 0. By the same identity the torques of the pair forces cancel
/// particle by particle. So the force takes 2 D of power, never gives any, keeps linear and angular momentum,
/// and is zero for every linear motion, free surfaces included; on smooth motion it is a viscosity of the
/// fourth derivative, of the size of zeta rho c h^3. (Particles whose correction is held back by
/// `least_support` do not fit; their C is 0.) As the loop takes it,
///
///   f_k = sum_j V_k V_j (s_kj (C_k + C_j) (v_j - v_k) - (C_k L_k + C_j L_j) g_kj).
///
/// What is summed over pairs is in single precision (particles.h), of pair forces and what follows from the
/// sums in double. Each product and sum of a pair force is such that the two ends find it to the last bit.
///
/// Loops take a group of particles at once, a particle a lane, and walk their rows side by side: no sum
/// crosses lanes, and what follows from a particle's sums finds them in registers.
#include "core/infill.h"
#include "sph_infill/neighbour_list.h"
#include "sph_infill/particles.h"
#include "sph_infill/stable_step.h"

namespace tuft::sph {

/// Density may not leave these bounds, relative to the reference: beyond them a run is unstable, not
/// compressed.
inline constexpr double smallest_density_ratio = 0.2, largest_density_ratio = 5;

class Sleep;
class IndividualSteps;

struct LoopSettings {
  SphOptions options;
  bool artificial_viscosity = true;
  bool zero_energy_control = false;
  SoilEffects soil_effects;
  StepLimit step_limit;
  std::vector<SoilLaw> laws;  ///< by material
};

/// What the gradient pass adds up.
struct StressSums {
  double work = 0;                                               ///< J, sigma : D over the step
  double plastic = 0;                                            ///< J, of which dissipated
  double stable_step = std::numeric_limits<double>::infinity();  ///< s
  bool valid = true;  ///< all values finite, densities within bounds
};

/// Pass 1: velocity gradient at t_k, stress from t_{k-1} to t_k (drift of length dt; 0 at the start of a
/// run), Q, volumes, largest stable step. `blocks` has block_count(particles) entries; those of sleeping
/// blocks stay. sleep: null where none sleeps. steps: null where all particles take the same; else a group's
/// drift is since its last strain.
StressSums update_stress(const LoopSettings& settings, const NeighbourList& list, double dt,
                         Particles& particles, std::vector<StressSums>& blocks, const Sleep* sleep = nullptr,
                         IndividualSteps* steps = nullptr);

/// One kick about t_k: from half a step before to half a step after, or as long as SphSettings::kick_length
/// wants it where steps change.
struct Kick {
  /// Of the change of velocity, doubled: what belongs before t_k. 1 where all steps are the same.
  double share_before = 1;
  double duration = 0;                 ///< s
  Vec3 gravity{0, 0, 0};               ///< m/s^2
  double damping = 0;                  ///< 1/s
  const Vec3Array* impulse = nullptr;  ///< N s for the whole window, or none
  double impulse_share = 0;            ///< of it that this substep gives
};

/// Work of one kind of force over a kick, J: its impulse times the mean of the velocities before and after.
/// `until_now` is the part of it that belongs before t_k.
struct KickWork {
  double until_now = 0, whole = 0;
  KickWork& operator+=(const KickWork& other) {
    until_now += other.until_now;
    whole += other.whole;
    return *this;
  }
};

/// What the kick adds up, energies as of t_k.
///
/// The leapfrog keeps E_k = sum m v_{k-1/2} . v_{k+1/2} / 2 + work taken by forces, where each force's work
/// from t_k to t_{k+1} is the trapezoid (F_k + F_{k+1})/2 . v_{k+1/2} dt: this is an identity, for any
/// forces. So kinetic energy is that product, and a kick's work splits into F_k . v_{k-1/2} dt/2 before t_k
/// and F_k . v_{k+1/2} dt/2 after. (The mean of the kinetic energies half a step before and after is larger
/// by m |v_{k+1/2} - v_{k-1/2}|^2/4, which comes and goes with every oscillation: 5 % of the energy of a cube
/// eight particles wide at the stable step.)
struct KickSums {
  double kinetic = 0;
  double gravity_potential = 0;                   ///< -m g . x
  KickWork viscous, damping;                      ///< taken out
  KickWork contact;                               ///< put in
  KickWork holding;                               ///< taken out, to hold particles still
  Vec3 impulse{0, 0, 0}, impulse_scale{0, 0, 0};  ///< N s
  double unrest = 0;                              ///< of a block, not summed; see sleep.h
  KickSums& operator+=(const KickSums& other);
};

/// Pass 2: forces at t_k; velocities become those at t_k + dt/2.
KickSums kick(const LoopSettings& settings, const NeighbourList& list, const Kick& kick, Particles& particles,
              std::vector<KickSums>& blocks, const Sleep* sleep = nullptr,
              const IndividualSteps* steps = nullptr);

/// What the drift finds.
struct DriftCheck {
  double largest_speed_squared = 0;  ///< (m/s)^2, relative to the frame
  Vec3 velocity_sum{0, 0, 0};        ///< m/s, over all particles
  bool valid = true;                 ///< all positions and velocities finite
  bool outside = false;              ///< a position is not within the box
};

struct TurfBox;

/// Moves positions by dt and renews the records of motion. frame: m/s, speeds are measured relative to it.
DriftCheck drift(double dt, const Vec3& frame, const TurfBox& box, Particles& particles,
                 std::vector<DriftCheck>& blocks, const Sleep* sleep = nullptr);

/// Pass 1's first half for one particle: moment matrix and sums before correction (for tests too).
struct GradientSums {
  SymmetricTensor moment;    ///< sum_j V_j (x_j - x_i) (x) g_ij
  Mat3 velocity;             ///< sum_j V_j (v_j - v_i) (x) g_ij, 1/s
  Vec3 gradient;             ///< sum_j V_j g_ij, 1/m
  SymmetricTensor mobility;  ///< sum_j V_j^2/m_j g_ij (x) g_ij, 1/(kg m^2), for the stable step
};
GradientSums sum_gradients(const LoopSettings& settings, const NeighbourList& list,
                           const Particles& particles, std::size_t i);

[[nodiscard]] inline std::size_t block_count(const Particles& particles) {
  return (particles.size() + block_size - 1) / block_size;
}

}  // namespace tuft::sph
