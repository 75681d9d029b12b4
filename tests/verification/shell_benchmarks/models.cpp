#include "tests/verification/shell_benchmarks/models.h"

#include <cmath>
#include <numbers>

namespace tuft::fe::test {
namespace {

constexpr double pi = std::numbers::pi;

using Map = std::function<Vec3(double, double)>;

/// A grid of along x across elements over the unit square, mapped.
struct Grid {
  BenchmarkModel model;
  int along, across;
  [[nodiscard]] Index node(int i, int j) const { return static_cast<Index>(j * (along + 1) + i); }
  void hold(int i, int j, int bits) {
    std::uint8_t& mask = model.mesh.constraints[static_cast<std::size_t>(node(i, j))];
    mask = static_cast<std::uint8_t>(mask | bits);
  }
  void hold_start() {
    for (int j = 0; j <= across; ++j) hold(0, j, all);
  }
  /// A load spread evenly over the end i = along: half at the corners.
  void load_end(Vec3Array& loads, const Vec3& total) {
    for (int j = 0; j <= across; ++j)
      loads.add(static_cast<std::size_t>(node(along, j)),
                (j == 0 || j == across ? 0.5 : 1.0) / across * total);
  }
  void probe(Index at, const Vec3& direction) { model.probes.push_back({{at}, direction}); }
  void probe_end(const Vec3& direction) {
    BenchmarkModel::Probe probe{{}, direction};
    for (int j = 0; j <= across; ++j) probe.nodes.push_back(node(along, j));
    model.probes.push_back(std::move(probe));
  }
};

Grid make_grid(int along, int across, double thickness, const ShellMaterial& material, const Map& map) {
  Grid grid{{}, along, across};
  ShellMesh& mesh = grid.model.mesh;
  for (int j = 0; j <= across; ++j)
    for (int i = 0; i <= along; ++i)
      mesh.nodes.push_back(map(static_cast<double>(i) / along, static_cast<double>(j) / across));
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i)
      mesh.quads.push_back(
          {grid.node(i, j), grid.node(i + 1, j), grid.node(i + 1, j + 1), grid.node(i, j + 1)});
  mesh.thickness.assign(mesh.quads.size(), thickness);
  mesh.material.assign(mesh.quads.size(), 0);
  mesh.surface.assign(mesh.quads.size(), 0);
  mesh.surface_count = 1;
  mesh.clamped.assign(mesh.nodes.size(), 0);
  mesh.constraints.assign(mesh.nodes.size(), 0);
  grid.model.material = material;
  grid.model.force.assign(mesh.nodes.size(), 0.0);
  grid.model.moment.assign(mesh.nodes.size(), 0.0);
  return grid;
}

BenchmarkModel scordelis_lo(int n) {
  const double radius = 25, length = 25, angle = 40 * pi / 180;
  Grid grid = make_grid(n, n, 0.25, {4.32e8, 0, 1}, [&](double a, double b) {
    return Vec3(radius * std::sin(angle * a), length * b, radius * std::cos(angle * a));
  });
  for (int k = 0; k <= n; ++k) {
    grid.hold(0, k, ux | ry | rz);
    grid.hold(k, 0, ux | uz);
    grid.hold(k, n, uy | rx | rz);
  }
  for (const auto& quad : grid.model.mesh.quads) {
    std::array<Vec3, 4> x;
    for (std::size_t c = 0; c < 4; ++c) x[c] = grid.model.mesh.nodes[static_cast<std::size_t>(quad[c])];
    const double area = 0.5 * (x[2] - x[0]).cross(x[3] - x[1]).norm();
    for (const Index node : quad)
      grid.model.force.add(static_cast<std::size_t>(node), Vec3(0, 0, -90 * area / 4));
  }
  grid.probe(grid.node(n, n), Vec3(0, 0, -1));
  return grid.model;
}

BenchmarkModel pinched_cylinder(int n) {
  const double radius = 300, length = 300;
  Grid grid = make_grid(n, n, 3, {3e6, 0.3, 1}, [&](double a, double b) {
    return Vec3(radius * std::sin(pi / 2 * a), length * b, radius * std::cos(pi / 2 * a));
  });
  for (int k = 0; k <= n; ++k) {
    grid.hold(0, k, ux | ry | rz);
    grid.hold(n, k, uz | rx | ry);
    grid.hold(k, 0, ux | uz);
    grid.hold(k, n, uy | rx | rz);
  }
  grid.probe(grid.node(0, n), Vec3(0, 0, -1));
  grid.model.force.set(static_cast<std::size_t>(grid.node(0, n)), Vec3(0, 0, -0.25));
  return grid.model;
}

/// A quarter with a hole of 18 degrees at the pole; load on each of the two points, outward and inward.
BenchmarkModel hemisphere(int n, double load) {
  const double radius = 10;
  Grid grid = make_grid(n, n, 0.04, {6.825e7, 0.3, 1}, [&](double a, double b) {
    const double latitude = b * 72 * pi / 180, longitude = a * pi / 2;
    return Vec3(radius * std::cos(latitude) * std::cos(longitude),
                radius * std::cos(latitude) * std::sin(longitude), radius * std::sin(latitude));
  });
  for (int k = 0; k <= n; ++k) {
    grid.hold(0, k, uy | rx | rz);
    grid.hold(n, k, ux | ry | rz);
  }
  grid.hold(0, 0, uz);
  grid.model.force.add(static_cast<std::size_t>(grid.node(0, 0)), Vec3(load, 0, 0));
  grid.model.force.add(static_cast<std::size_t>(grid.node(n, 0)), Vec3(0, -load, 0));
  grid.probe(grid.node(0, 0), Vec3(1, 0, 0));
  grid.probe(grid.node(n, 0), Vec3(0, -1, 0));
  return grid.model;
}

BenchmarkModel twisted_beam(int n, double thickness, const Vec3& load) {
  Grid grid = make_grid(n, std::max(2, n / 6), thickness, {29e6, 0.22, 1}, [&](double a, double b) {
    const double across = 1.1 * (b - 0.5), angle = pi / 2 * a;
    return Vec3(12 * a, across * std::cos(angle), across * std::sin(angle));
  });
  grid.hold_start();
  grid.load_end(grid.model.force, load);
  grid.probe_end(load.normalized());
  return grid.model;
}

enum class Sides { regular, trapezoid, parallelogram };

/// MacNeal and Harder's six elements over a strip 0.2 deep have sides at 45 degrees to it; finer ones split
/// each element evenly. How far along the strip the point (a, b) lies from where it would with upright sides.
double along_strip(Sides sides, double a, double b) {
  const auto offset = [sides](int i) {  // of the side between the elements i and i + 1 of the six, at the top
    if (i == 0 || i == 6 || sides == Sides::regular) return 0.0;
    if (sides == Sides::parallelogram) return 0.1;
    return i % 2 ? 0.1 : -0.1;
  };
  const int whole = std::min(5, static_cast<int>(std::floor(6 * a + 1e-9)));
  const double part = 6 * a - whole, lean = 2 * b - 1;
  return lean * ((1 - part) * offset(whole) + part * offset(whole + 1));
}

/// 6 x 0.2 x 0.1.
BenchmarkModel straight_cantilever(int n, Sides sides, const Vec3& load) {
  Grid grid = make_grid(n, std::max(1, n / 6), 0.1, {1e7, 0.3, 1}, [&](double a, double b) {
    return Vec3(6 * a + along_strip(sides, a, b), 0.2 * b, 0);
  });
  grid.hold_start();
  grid.load_end(grid.model.force, load);
  grid.probe_end(load.normalized());
  return grid.model;
}

/// A quarter of a circle. Sides are at 45 degrees to the radius halfway through the depth.
BenchmarkModel curved_cantilever(int n, Sides sides, const Vec3& load) {
  Grid grid = make_grid(n, std::max(1, n / 6), 0.1, {1e7, 0.25, 1}, [&](double a, double b) {
    const double radius = 4.12 + 0.2 * b, angle = pi / 2 * a + along_strip(sides, a, b) / 4.22;
    return Vec3(radius * std::sin(angle), radius * std::cos(angle), 0);
  });
  grid.hold_start();
  grid.load_end(grid.model.force, load);
  grid.probe_end(load.normalized());
  return grid.model;
}

BenchmarkModel flat_cantilever(int n, double length, const Vec3& force, const Vec3& moment) {
  Grid grid = make_grid(n, std::max(1, n / 16), 0.1, {1.2e6, 0, 1},
                        [&](double a, double b) { return Vec3(length * a, b, 0); });
  grid.hold_start();
  grid.load_end(grid.model.force, force);
  grid.load_end(grid.model.moment, moment);
  grid.probe_end(Vec3(0, 0, 1));
  grid.probe_end(Vec3(-1, 0, 0));
  return grid.model;
}

/// Lifted at one side of the slit, the other clamped; along the circle first.
BenchmarkModel slit_annular_plate(int n) {
  const int across = std::max(2, n / 8);
  Grid grid = make_grid(n, across, 0.03, {21e6, 0, 1}, [&](double a, double b) {
    const double radius = 10 - 4 * b, angle = 2 * pi * a;
    return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0);
  });
  grid.hold_start();
  grid.load_end(grid.model.force, Vec3(0, 0, 0.8 * 4));
  grid.probe(grid.node(n, across), Vec3(0, 0, 1));
  grid.probe(grid.node(n, 0), Vec3(0, 0, 1));
  return grid.model;
}

/// Half a cylinder clamped at one end, pinched at the middle of the other; half of it, with the load's half.
/// Along the axis first.
BenchmarkModel half_cylinder(int n) {
  const double radius = 1.016, length = 3.048;
  Grid grid = make_grid(n, n, 0.03, {2.0685e7, 0.3, 1}, [&](double a, double b) {
    return Vec3(length * a, radius * std::sin(pi / 2 * b), radius * std::cos(pi / 2 * b));
  });
  grid.hold_start();
  for (int i = 0; i <= n; ++i) {
    grid.hold(i, 0, uy | rx | rz);  // plane of symmetry
    grid.hold(i, n, uz | rx | ry);  // long edges on the ground: no height, no turn about the axis
  }
  grid.model.force.set(static_cast<std::size_t>(grid.node(n, 0)), Vec3(0, 0, -1000));
  grid.probe(grid.node(n, 0), Vec3(0, 0, -1));
  return grid.model;
}

}  // namespace

std::vector<Benchmark> shell_benchmarks() {
  const std::string macneal = "MacNeal & Harder 1985", sze = "Sze, Liu & Lo 2004";
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), none(0, 0, 0);
  std::vector<Benchmark> list;
  const auto linear = [&list](std::string name, std::string source, std::vector<Quantity> quantities,
                              double scale, std::array<int, 3> levels,
                              std::function<BenchmarkModel(int)> model) {
    list.push_back({std::move(name), std::move(source), std::move(quantities), true, scale, 0, levels,
                    std::move(model)});
  };
  const auto nonlinear = [&list](std::string name, std::string source, std::vector<Quantity> quantities,
                                 double ramp, std::array<int, 3> levels,
                                 std::function<BenchmarkModel(int)> model) {
    list.push_back({std::move(name), std::move(source), std::move(quantities), false, 1, ramp, levels,
                    std::move(model)});
  };
  linear("scordelis_lo", macneal, {{"w", 0.3024}}, 1e-3, {8, 16, 32}, scordelis_lo);
  linear("pinched_cylinder", macneal, {{"w", 1.8248e-5}}, 1e-2, {16, 32, 48}, pinched_cylinder);
  // The reference belongs to both points alike; the nonlinear one has them apart.
  linear("pinched_hemisphere", macneal, {{"u", 0.094}, {"v", 0.094}}, 1e-3, {8, 16, 24},
         [](int n) { return hemisphere(n, 1); });
  linear("twisted_beam_in_plane", macneal, {{"w", 5.424e-3}}, 1, {12, 24, 48},
         [=](int n) { return twisted_beam(n, 0.32, z); });
  linear("twisted_beam_out_of_plane", macneal, {{"v", 1.754e-3}}, 1, {12, 24, 48},
         [=](int n) { return twisted_beam(n, 0.32, y); });
  const std::string thin = "Belytschko, Wong & Stolarski 1989";
  linear("thin_twisted_beam_in_plane", thin, {{"w", 5.256e-3}}, 1e-2, {6, 12, 24},
         [=](int n) { return twisted_beam(n, 0.0032, Vec3(1e-6 * z)); });
  linear("thin_twisted_beam_out_of_plane", thin, {{"v", 1.294e-3}}, 1e-2, {6, 12, 24},
         [=](int n) { return twisted_beam(n, 0.0032, Vec3(1e-6 * y)); });
  for (const auto& [name, sides] : {std::pair{"regular", Sides::regular},
                                    {"trapezoid", Sides::trapezoid},
                                    {"parallelogram", Sides::parallelogram}}) {
    const std::array<int, 3> levels =
        sides == Sides::regular ? std::array{6, 12, 24} : std::array{12, 24, 48};
    linear(std::string("straight_cantilever_in_plane_") + name, macneal, {{"v", 0.1081}}, 1e-3, levels,
           [=, s = sides](int n) { return straight_cantilever(n, s, y); });
    linear(std::string("straight_cantilever_out_of_plane_") + name, macneal, {{"w", 0.4321}}, 1e-3, levels,
           [=, s = sides](int n) { return straight_cantilever(n, s, z); });
  }
  for (const auto& [name, sides] : {std::pair{"", Sides::regular},
                                    {"_trapezoid", Sides::trapezoid},
                                    {"_parallelogram", Sides::parallelogram}}) {
    linear(std::string("curved_cantilever_in_plane") + name, macneal, {{"u", 0.08734}}, 1e-3, {12, 24, 48},
           [=, s = sides](int n) { return curved_cantilever(n, s, x); });
    linear(std::string("curved_cantilever_out_of_plane") + name, macneal, {{"w", 0.5022}}, 1e-3, {12, 24, 48},
           [=, s = sides](int n) { return curved_cantilever(n, s, z); });
  }

  // Sze tabulates the whole path of load; each share of it is a case of its own.
  const auto end_shear = [&](const char* name, double share, std::vector<Quantity> quantities) {
    nonlinear(name, sze, std::move(quantities), 5, {8, 16, 32},
              [=](int n) { return flat_cantilever(n, 10, share * 4 * z, none); });
  };
  end_shear("cantilever_end_shear_tenth", 0.1, {{"w", 1.309}});
  end_shear("cantilever_end_shear_fifth", 0.2, {{"w", 2.493}});
  end_shear("cantilever_end_shear_half", 0.5, {{"w", 4.933}, {"u", 1.604}});
  end_shear("cantilever_end_shear", 1, {{"w", 6.698}, {"u", 3.286}});
  // At half the moment half a circle; at the whole one the tip is back at the root: u is the whole length, w
  // nothing, so that it is the length that w is measured by too. There the loaded end is not stable with two
  // elements across: out of rounding its last row folds, once the whole moment is on. Over ramps of 9 to 50 s
  // the tip came to rest 0.03 to 1.8 % of the length away (one point), 0.03 to 1.4 % (2 x 2); the rest of the
  // strip is a circle within 0.1 % of the length.
  nonlinear("roll_up_half_circle", "closed form", {{"w", 24 / pi}, {"u", 12}}, 10, {16, 24, 32},
            [=](int n) { return flat_cantilever(n, 12, none, Vec3(-25 * pi / 3 * y)); });
  nonlinear("roll_up_full_circle", "closed form", {{"w", 0, 12}, {"u", 12}}, 10, {16, 24, 32},
            [=](int n) { return flat_cantilever(n, 12, none, Vec3(-50 * pi / 3 * y)); });
  nonlinear("slit_annular_plate", sze, {{"w inside", 13.891}, {"w outside", 17.528}}, 10, {32, 48, 64},
            slit_annular_plate);
  nonlinear("clamped_half_cylinder", "as tabulated by Project Chrono, two decimals", {{"w", 1.71}}, 1,
            {12, 24, 32}, half_cylinder);
  nonlinear("pinched_hemisphere_large", sze, {{"u", 4.067}, {"v", 8.178}}, 1, {8, 16, 24},
            [](int n) { return hemisphere(n, 200); });
  return list;
}

BenchmarkAnswer solve(const Benchmark& benchmark, int level, const ShellSection& section, double tolerance) {
  const BenchmarkModel model = benchmark.model(level);
  CarpetOptions options;
  options.gravity = Vec3(0, 0, 0);
  options.section = section;
  Carpet carpet(model.mesh, {model.material}, options);
  RelaxationOptions relaxation;
  relaxation.tolerance = tolerance;
  relaxation.to = benchmark.linear ? benchmark.load_scale : 1.0;
  relaxation.ramp_time = benchmark.ramp_time;
  const auto scaled = [](const Vec3Array& from, double share, Vec3Array& to) {
    for (std::size_t n = 0; n < from.size(); ++n) to.set(n, share * from[n]);
  };
  BenchmarkAnswer answer;
  answer.elements = model.mesh.quads.size();
  answer.relaxation = relax(
      carpet,
      [&](const NodeView& /*nodes*/, double share, Vec3Array& force, Vec3Array& moment) {
        scaled(model.force, share, force);
        scaled(model.moment, share, moment);
      },
      relaxation);
  for (std::size_t q = 0; q < benchmark.quantities.size(); ++q) {
    const BenchmarkModel::Probe& probe = model.probes[q];
    double mean = 0;
    for (const Index node : probe.nodes) {
      const auto n = static_cast<std::size_t>(node);
      const Vec3 now(carpet.nodes().x[n], carpet.nodes().y[n], carpet.nodes().z[n]);
      mean += (now - model.mesh.nodes[n]).dot(probe.direction) / static_cast<double>(probe.nodes.size());
    }
    const Quantity& quantity = benchmark.quantities[q];
    const double displacement = mean / relaxation.to;
    answer.ratio.push_back(displacement / quantity.scale());
    answer.error.push_back((displacement - quantity.reference) / quantity.scale());
  }
  return answer;
}

}  // namespace tuft::fe::test
