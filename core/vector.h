#pragma once
/// Small vectors for single points. Bulk state lives in structures of arrays (one std::vector per component).
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

/// Marks functions that must compile for host and device. Empty until a device compiler is used.
#ifdef __CUDACC__
#define TUFT_HD __host__ __device__
#else
#define TUFT_HD
#endif

namespace tuft {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Index = std::int32_t;

/// Owning structure of arrays of 3-vectors; x, y and z always have one size.
struct Vec3Array {
  std::vector<double> x, y, z;

  void assign(std::size_t count, double value) {
    x.assign(count, value);
    y.assign(count, value);
    z.assign(count, value);
  }
  void push_back(const Vec3& v) {
    x.push_back(v.x());
    y.push_back(v.y());
    z.push_back(v.z());
  }
  [[nodiscard]] std::size_t size() const { return x.size(); }
  [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  void set(std::size_t i, const Vec3& v) {
    x[i] = v.x();
    y[i] = v.y();
    z[i] = v.z();
  }
  void add(std::size_t i, const Vec3& v) {
    x[i] += v.x();
    y[i] += v.y();
    z[i] += v.z();
  }
};

}  // namespace tuft
