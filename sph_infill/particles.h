#pragma once
/// State of all particles as structures of arrays. Index i is the same particle everywhere and for ever.
///
/// Pair loops read neighbours in no order that memory likes: what they need of one lies together, as a
/// record.
#include <array>
#include <vector>

#include "core/lane_columns.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

/// What both pair loops read of a neighbour: a cache line. It stands still from one drift to the next, so
/// that both see the same motion and weights, though velocities and volumes change between them.
struct alignas(64) MotionRecord {
  double x, y, z;       ///< m
  double vx, vy, vz;    ///< m/s
  double volume;        ///< m^3
  double inverse_mass;  ///< 1/kg

  static constexpr std::size_t values = 8;
};

/// What the force loop reads besides. Single precision: both ends of a pair take the same rounded values, so
/// that momentum is kept as well as in double precision, and the power of the forces meets the stress power
/// to 1e-7.
struct alignas(64) StressRecord {
  /// V sigma B by columns, N m: the half of the pair force a particle brings. Fourth rows are 0.
  std::array<std::array<float, 4>, 3> v_sigma_b{};
  /// Factors of the viscous pair force: sqrt(m V) sqrt(c), sqrt(m V).
  float viscous_linear = 0, viscous_quadratic = 0;
  float wave_speed = 0;  ///< m/s
  float unused = 0;

  static constexpr std::size_t values = 16;
};

/// The records of the particles named, a lane each, as columns.
[[nodiscard]] inline std::array<Pack, MotionRecord::values> load_records(const MotionRecord* records,
                                                                         const Index* index) {
  return load_columns<MotionRecord::values>(reinterpret_cast<const double*>(records), MotionRecord::values,
                                            index);
}
/// Of them viscous_linear, viscous_quadratic, wave_speed and what is unused.
[[nodiscard]] inline std::array<Pack, 4> load_viscous(const StressRecord* records, const Index* index) {
  return load_columns<4>(&records->viscous_linear, StressRecord::values, index);
}

/// What the force loop reads where zero-energy modes are controlled; see sph_loops.h.
struct alignas(64) ResidualRecord {
  std::array<float, 9> v_c_l;  ///< V C L by rows, m^3 Pa
  float v_c;                   ///< V C, m^3 Pa s
  std::array<float, 2> unused;

  static constexpr std::size_t values = 12, room = 16;
};
[[nodiscard]] inline std::array<Pack, ResidualRecord::values> load_records(const ResidualRecord* records,
                                                                           const Index* index) {
  return load_columns<ResidualRecord::values>(reinterpret_cast<const float*>(records), ResidualRecord::room,
                                              index);
}

struct Particles {
  // What a checkpoint holds.
  Vec3Array position;  ///< m, at t_k
  Vec3Array velocity;  ///< m/s, at t_k - dt/2
  std::vector<double> compression, largest_compression, plastic_compression;
  std::vector<double> pressure, bulk_modulus;   ///< Pa
  std::array<std::vector<double>, 6> deviator;  ///< Pa; xx yy zz xy yz zx
  std::vector<double> lost_strength;            ///< [0, 1]; empty without effect strength_softening

  /// m^3. By the last stress evaluation; gradients weigh neighbours by that of the one before, see
  /// MotionRecord.
  std::vector<double> volume;

  // What never changes.
  std::vector<double> mass;                 ///< kg
  std::vector<double> radius, half_height;  ///< m, of contact; half_height: empty where it is the radius
  std::vector<double> reference_volume;     ///< m^3 at no strain: mass over the law's density, unless a
                                            ///< compacted bed made the density it had reached the reference
  std::vector<Index> layer, material;       ///< material: also the index into the laws

  // What follows from the above in every step.
  std::vector<MotionRecord> motion;
  std::vector<StressRecord> stress;
  std::vector<float>
      own_step;  ///< s, stable step of each; empty where all take the same (individual_steps.h)
  std::vector<ResidualRecord> residual;  ///< empty where zero-energy modes are not controlled

  [[nodiscard]] std::size_t size() const { return mass.size(); }

  /// `count` particles, all values zero.
  void assign(std::size_t count) {
    position.assign(count, 0), velocity.assign(count, 0);
    for (auto* values : {&compression, &largest_compression, &plastic_compression, &pressure, &bulk_modulus,
                         &volume, &mass, &reference_volume})
      values->assign(count, 0);
    for (auto& values : deviator) values.assign(count, 0);
    layer.assign(count, 0), material.assign(count, 0);
    motion.assign(count, {});
    stress.assign(count, {});
  }

  /// Makes the motion's record of particle i current.
  void record_motion(std::size_t i) {
    motion[i] = {position.x[i], position.y[i], position.z[i], velocity.x[i],
                 velocity.y[i], velocity.z[i], volume[i],     1 / mass[i]};
  }
  void record_motion() {
    for (std::size_t i = 0; i < size(); ++i) record_motion(i);
  }

  [[nodiscard]] SoilState soil_state(std::size_t i) const {
    return {compression[i],
            largest_compression[i],
            plastic_compression[i],
            pressure[i],
            bulk_modulus[i],
            {deviator[0][i], deviator[1][i], deviator[2][i], deviator[3][i], deviator[4][i], deviator[5][i]},
            lost_strength.empty() ? 0 : lost_strength[i]};
  }
  void set_soil_state(std::size_t i, const SoilState& s) {
    compression[i] = s.compression;
    largest_compression[i] = s.largest_compression;
    plastic_compression[i] = s.plastic_compression;
    pressure[i] = s.pressure;
    bulk_modulus[i] = s.bulk_modulus;
    const SymmetricTensor& d = s.deviator;
    deviator[0][i] = d.xx, deviator[1][i] = d.yy, deviator[2][i] = d.zz;
    deviator[3][i] = d.xy, deviator[4][i] = d.yz, deviator[5][i] = d.zx;
    if (!lost_strength.empty()) lost_strength[i] = s.lost_strength;
  }
};

}  // namespace tuft::sph
