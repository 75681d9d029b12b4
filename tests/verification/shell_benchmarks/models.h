#pragma once
/// The shell benchmarks of the literature as meshes, loads and supports, each at several fineness levels.
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "fe_carpet/relaxation.h"

namespace tuft::fe::test {

/// Bits of ShellMesh::constraints.
enum Held : std::uint8_t { ux = 1, uy = 2, uz = 4, rx = 8, ry = 16, rz = 32, all = 63 };

struct BenchmarkModel {
  ShellMesh mesh;
  ShellMaterial material;
  Vec3Array force, moment;  ///< full load, N and N m, per node
  /// What is compared: means of a component of the displacement over some nodes, one per quantity.
  struct Probe {
    std::vector<Index> nodes;
    Vec3 direction{0, 0, 1};
  };
  std::vector<Probe> probes;
};

/// A displacement to be met.
struct Quantity {
  std::string name;
  double reference = 0;  ///< in the units of the source
  double length = 0;     ///< of the model, what a reference of 0 is measured by
  [[nodiscard]] double scale() const { return reference != 0 ? reference : length; }
};

struct Benchmark {
  std::string name;
  std::string source;
  std::vector<Quantity> quantities;  ///< in the order of the model's probes
  bool linear = true;                ///< small displacements: load and displacement are scaled
  double load_scale = 1;             ///< linear: share of the load that is applied
  /// s in the model's units; slow against the lowest period. 0: at once.
  double ramp_time = 0;
  std::array<int, 3> levels{};  ///< elements along the first direction
  std::function<BenchmarkModel(int)> model;
};

void PrintTo(const Benchmark& benchmark, std::ostream* stream);  ///< its name, for test reports

/// All of them.
[[nodiscard]] std::vector<Benchmark> shell_benchmarks();

struct BenchmarkAnswer {
  std::vector<double> ratio;  ///< of the displacements to their references, or to lengths where these are 0
  std::vector<double> error;  ///< of the displacements, over the same
  std::size_t elements = 0;
  RelaxationResult relaxation;
};

inline constexpr double benchmark_tolerance = 1e-9;

/// By dynamic relaxation.
[[nodiscard]] BenchmarkAnswer solve(const Benchmark& benchmark, int level, const ShellSection& section,
                                    double tolerance);

}  // namespace tuft::fe::test
