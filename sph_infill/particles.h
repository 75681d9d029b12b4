#pragma once
/// State of all particles as structures of arrays. Index i is the same particle everywhere and for ever.
///
/// Pair loops read neighbours in no order that memory likes: what they need of one lies together, as a
/// record.
#include <array>
#include <cstdint>
#include <vector>

#include "core/lane_columns.h"
#include "sph_infill/soil_law.h"

namespace tuft::sph {

/// What both pair loops read of a neighbour: half a cache line. It stands still from one drift to the next,
/// so that both see the same motion and weights, though velocities and volumes change between them.
///
/// Loops over pairs work in single precision, on numbers that lose nothing which matters to a pair. Positions
/// are integers, in h/2^22 and modulo 2^32: their differences are exact, wherever the bed lies, since
/// neighbours are closer than 4 h, and a position is off by at most 1.2e-7 h. What is rounded of velocities
/// is 6e-8 of their size; what moves together is rounded together. docs/theory/sph.md has what it changes.
struct alignas(32) MotionRecord {
  std::int32_t x, y, z;  ///< h/2^22
  float volume;          ///< h^3
  float vx, vy, vz;      ///< m/s
  float inverse_mass;    ///< 1/kg

  static constexpr std::size_t values = 8;
  /// h; a power of two, so that products with it are exact.
  static constexpr float position_unit = 0x1p-22F;
};

/// What the force loop reads besides.
struct alignas(64) StressRecord {
  std::array<float, 9>
      s{};  ///< S of sph_loops.h by rows, Pa: the half of a pair force that a particle brings
  /// Factors of the viscous pair force (pair_forces.h), of each particle one: sqrt(alpha rho c e), sqrt(beta
  /// rho) e, e the unit of positions over h.
  float viscous_linear = 0, viscous_quadratic = 0;
  float wave_speed = 0;  ///< m/s
  std::array<float, 4> unused{};

  static constexpr std::size_t values = 12;
};

/// What the force loop reads where zero-energy modes are controlled; see sph_loops.h.
struct alignas(64) ResidualRecord {
  std::array<float, 9> c_l{};  ///< C L by rows, Pa
  float c = 0;                 ///< C over the unit of positions, Pa s/m
  std::array<float, 6> unused{};

  static constexpr std::size_t values = 12;
};

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
  std::vector<double> strained_share;       ///< of its cell, see row_shares.h; 1: all
  std::vector<Index> layer, material;       ///< material: also the index into the laws
  double smoothing_length = 0;              ///< h, m: the unit of records

  // What follows from the above in every step.
  std::vector<MotionRecord> motion;
  std::vector<StressRecord> stress;
  std::vector<float>
      own_step;  ///< s, stable step of each; empty where all take the same (individual_steps.h)
  std::vector<ResidualRecord> residual;  ///< empty where zero-energy modes are not controlled

  [[nodiscard]] std::size_t size() const { return mass.size(); }
  /// Units of motion's records, m and m^3.
  [[nodiscard]] double position_unit() const { return smoothing_length * MotionRecord::position_unit; }
  [[nodiscard]] double volume_unit() const { return smoothing_length * smoothing_length * smoothing_length; }

  /// `count` particles, all values zero. smoothing_length: h, m.
  void assign(std::size_t count, double h) {
    smoothing_length = h;
    position.assign(count, 0), velocity.assign(count, 0);
    for (auto* values : {&compression, &largest_compression, &plastic_compression, &pressure, &bulk_modulus,
                         &volume, &mass, &reference_volume})
      values->assign(count, 0);
    for (auto& values : deviator) values.assign(count, 0);
    strained_share.assign(count, 1);
    layer.assign(count, 0), material.assign(count, 0);
    motion.assign(count, {});
    stress.assign(count, {});
  }

  /// Makes motion's records current: those of the particles from `begin` to before `end`, of one, of all.
  void record_motion(std::size_t begin, std::size_t end);
  void record_motion(std::size_t i) { record_motion(i, i + 1); }
  void record_motion() { record_motion(0, size()); }

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
