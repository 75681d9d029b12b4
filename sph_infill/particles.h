#pragma once
/// State of all particles as structures of arrays. Index i is the same particle everywhere and for ever.
///
/// Pair loops read neighbours in no order that memory likes: what they need of one lies together, as a
/// record.
#include <array>
#include <bit>
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
  /// Factors of the viscous pair force, of each particle one: sqrt(rho c), sqrt(rho).
  float viscous_linear = 0, viscous_quadratic = 0;
  float wave_speed = 0;  ///< m/s
  std::array<float, 4> unused{};

  static constexpr std::size_t values = 12, room = 16;
};

/// What the force loop reads where zero-energy modes are controlled; see sph_loops.h.
struct alignas(64) ResidualRecord {
  std::array<float, 9> c_l{};  ///< C L by rows, Pa
  float c = 0;                 ///< C/h, Pa s/m
  std::array<float, 6> unused{};

  static constexpr std::size_t values = 12, room = 16;
};

/// The records of the particles named, a lane each, as columns. Of a motion's the first three are integers:
/// integer_difference.
[[nodiscard]] inline std::array<SinglePack, MotionRecord::values> load_records(const MotionRecord* records,
                                                                               const Index* index) {
  return load_columns<MotionRecord::values>(reinterpret_cast<const float*>(records), MotionRecord::values,
                                            index);
}
template <class Record>
[[nodiscard]] inline std::array<SinglePack, Record::values> load_records(const Record* records,
                                                                         const Index* index) {
  return load_columns<Record::values>(reinterpret_cast<const float*>(records), Record::room, index);
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
  double smoothing_length = 0;              ///< h, m: the unit of records

  // What follows from the above in every step.
  std::vector<MotionRecord> motion;
  std::vector<StressRecord> stress;
  std::vector<float>
      own_step;  ///< s, stable step of each; empty where all take the same (individual_steps.h)
  std::vector<ResidualRecord> residual;  ///< empty where zero-energy modes are not controlled

  [[nodiscard]] std::size_t size() const { return mass.size(); }

  /// `count` particles, all values zero. smoothing_length: h, m.
  void assign(std::size_t count, double h) {
    smoothing_length = h;
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
    motion[i].inverse_mass = static_cast<float>(1 / mass[i]);
    renew_motion(i, i + 1);
  }
  void record_motion() {
    for (std::size_t i = 0; i < size(); ++i) record_motion(i);
  }
  /// Those of the particles from `begin` to before `end`, whose masses are as they were.
  void renew_motion(std::size_t begin, std::size_t end) {
    const double per_unit = 1 / (smoothing_length * MotionRecord::position_unit);
    const double per_volume = 1 / (smoothing_length * smoothing_length * smoothing_length);
    // The sum has no binary digits behind the point, and the integer, modulo 2^32, in its last 32.
    const auto units = [per_unit](double x) {
      return static_cast<std::int32_t>(
          static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(x * per_unit + 0x1.8p52)));
    };
    for (std::size_t i = begin; i < end; ++i) {
      MotionRecord& m = motion[i];
      m.x = units(position.x[i]), m.y = units(position.y[i]), m.z = units(position.z[i]);
      m.volume = static_cast<float>(volume[i] * per_volume);
      m.vx = static_cast<float>(velocity.x[i]), m.vy = static_cast<float>(velocity.y[i]);
      m.vz = static_cast<float>(velocity.z[i]);
    }
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
