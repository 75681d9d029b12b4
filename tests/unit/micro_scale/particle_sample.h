#pragma once
/// Particles with contacts for tests: what a view of an infill holds.
#include <cmath>
#include <vector>

#include "core/infill.h"

namespace tuft::micro::test {

struct Sample {
  Vec3Array position, velocity;
  std::vector<double> radius, mass;
  std::vector<Index> layer, material;
  ContactNetwork network;

  void add(const Vec3& x, const Vec3& v, double m) {
    position.push_back(x);
    velocity.push_back(v);
    radius.push_back(0.001);
    mass.push_back(m);
    layer.push_back(0);
    material.push_back(0);
  }
  /// `force` on particle i, of particle j.
  void touch(Index i, Index j, const Vec3& force) {
    const Vec3 branch = position[static_cast<std::size_t>(j)] - position[static_cast<std::size_t>(i)];
    network.add(ContactKind::grain, i, j, branch, -branch.normalized(), force, 1e-5);
  }
  /// `force` on particle i, of a body that it touches at `branch` from its centre.
  void lean(Index i, const Vec3& branch, const Vec3& force) {
    network.add(ContactKind::body, i, 0, branch, -branch.normalized(), force, 1e-5);
  }
  [[nodiscard]] ParticleView view() const {
    ParticleView v;
    v.x = position.x, v.y = position.y, v.z = position.z;
    v.vx = velocity.x, v.vy = velocity.y, v.vz = velocity.z;
    v.radius = radius, v.mass = mass;
    v.layer = layer, v.material = material;
    return v;
  }
  /// Everything turned about the origin.
  [[nodiscard]] Sample turned(const Mat3& rotation) const {
    Sample other = *this;
    const auto turn = [&](Vec3Array& vectors) {
      for (std::size_t i = 0; i < vectors.size(); ++i) vectors.set(i, rotation * vectors[i]);
    };
    for (Vec3Array* vectors : {&other.position, &other.velocity, &other.network.branch,
                               &other.network.normal_force, &other.network.tangential_force})
      turn(*vectors);
    return other;
  }
};

/// A cloud without order in a cube about the origin, each particle in contact with the next under some force.
inline Sample cloud(std::size_t count, double half_size) {
  Sample sample;
  for (std::size_t n = 0; n < count; ++n) {
    const double a = 1.0 + 0.7 * static_cast<double>(n), b = 2.0 + 1.3 * static_cast<double>(n);
    sample.add(half_size * Vec3(std::sin(3 * a), std::cos(5 * b), std::sin(a + b)),
               Vec3(std::cos(a), std::sin(b), std::cos(a - b)), 1e-6 * (1.5 + std::sin(b)));
  }
  for (std::size_t n = 0; n + 1 < count; ++n)
    sample.touch(
        static_cast<Index>(n), static_cast<Index>(n + 1),
        0.01 * Vec3(std::sin(2.0 * static_cast<double>(n)), std::cos(3.0 * static_cast<double>(n)), 0.3));
  return sample;
}

/// Simple cubic, `side` particles in each direction at `pitch`, the first at half a pitch from the origin;
/// neighbours press each other with `pressed` (N) along x, y and z.
inline Sample cubic_lattice(int side, double pitch, const Vec3& pressed) {
  Sample sample;
  const auto index = [&](int i, int j, int k) { return static_cast<Index>(i + side * (j + side * k)); };
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) sample.add(pitch * Vec3(i + 0.5, j + 0.5, k + 0.5), Vec3::Zero(), 1e-6);
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        if (i + 1 < side) sample.touch(index(i, j, k), index(i + 1, j, k), Vec3(-pressed.x(), 0, 0));
        if (j + 1 < side) sample.touch(index(i, j, k), index(i, j + 1, k), Vec3(0, -pressed.y(), 0));
        if (k + 1 < side) sample.touch(index(i, j, k), index(i, j, k + 1), Vec3(0, 0, -pressed.z()));
      }
  return sample;
}

}  // namespace tuft::micro::test
