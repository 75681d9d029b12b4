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
/// gives no net force where the neighbourhood is full. With Q_j = v_j* sigma_j B_j the force pass needs one
/// product a pair: f_k = Q_k (sum_j V_j g_kj) + V_k sum_j Q_j g_kj, whose first sum the gradient pass has
/// formed already. (V and v* differ by one step's compression; keeping V through both passes is what makes
/// them partners exactly.)
#include "core/infill.h"
#include "sph_infill/neighbour_list.h"
#include "sph_infill/particles.h"
#include "sph_infill/stable_step.h"

namespace tuft::sph {

/// Density may not leave these bounds, relative to the reference: beyond them a run is unstable, not
/// compressed.
inline constexpr double smallest_density_ratio = 0.2, largest_density_ratio = 5;

/// Particles of one partial sum.
inline constexpr std::size_t block_size = 256;

struct LoopSettings {
  SphOptions options;
  bool artificial_viscosity = true;
  SoilEffects soil_effects;
  StepLimit step_limit;
  std::vector<SoilLaw> laws;
};

/// What the gradient pass adds up.
struct StressSums {
  double work = 0;                                               ///< J, sigma : D over the step
  double plastic = 0;                                            ///< J, of which dissipated
  double stable_step = std::numeric_limits<double>::infinity();  ///< s
  bool valid = true;  ///< all values finite, densities within bounds
};

/// Pass 1: velocity gradient at t_k, stress from t_{k-1} to t_k (drift of length dt; 0 at the start of a
/// run), Q, volumes, largest stable step. `blocks` is scratch of block_count(particles).
StressSums update_stress(const LoopSettings& settings, const NeighbourList& list, double dt,
                         Particles& particles, std::vector<StressSums>& blocks);

/// One kick from t_k - dt_before/2 to t_k + dt/2.
struct Kick {
  double step_before = 0, step = 0;    ///< s, dt_before and dt
  Vec3 gravity{0, 0, 0};               ///< m/s^2
  double damping = 0;                  ///< 1/s
  const Vec3Array* impulse = nullptr;  ///< N s for the whole window, or none
  double impulse_share = 0;            ///< of it that this substep gives
  [[nodiscard]] double duration() const { return 0.5 * (step_before + step); }
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
  Vec3 impulse{0, 0, 0}, impulse_scale{0, 0, 0};  ///< N s
  KickSums& operator+=(const KickSums& other);
};

/// Pass 2: forces at t_k, next_velocity = velocity at t_k + dt/2.
KickSums kick(const LoopSettings& settings, const NeighbourList& list, const Kick& kick, Particles& particles,
              std::vector<KickSums>& blocks);

/// What the drift finds.
struct DriftCheck {
  double largest_displacement_squared = 0;  ///< m^2, since the neighbour list was built
  bool valid = true;                        ///< all positions and velocities finite
};

/// Makes next_velocity and next_volume current and moves positions by dt.
DriftCheck drift(double dt, const Vec3Array& reference, Particles& particles,
                 std::vector<DriftCheck>& blocks);

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
