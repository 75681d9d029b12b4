/// Patch tests: fields of constant membrane strain and constant curvature on regular and distorted meshes.
#include <gtest/gtest.h>

#include "tests/verification/fe_carpet/linear_model.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

constexpr std::array<Index, 4> inner_nodes{4, 5, 6, 7};

/// The five-element patch of MacNeal & Harder (Finite Elem. Anal. Des. 1, 1985), 0.24 x 0.12 m, four nodes
/// inside.
ShellMesh distorted_patch() {
  ShellMesh mesh;
  for (const auto& [x, y] : std::initializer_list<std::array<double, 2>>{{0, 0},
                                                                         {0.24, 0},
                                                                         {0.24, 0.12},
                                                                         {0, 0.12},
                                                                         {0.04, 0.02},
                                                                         {0.18, 0.03},
                                                                         {0.16, 0.08},
                                                                         {0.08, 0.08}})
    mesh.nodes.push_back({x, y, 0});
  mesh.quads = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}};
  mesh.thickness.assign(5, 0.001);
  mesh.material.assign(5, 0);
  mesh.surface.assign(5, 0);
  mesh.clamped.assign(8, 0);
  mesh.surface_count = 1;
  return mesh;
}

/// A 4 x 4 patch with graded rectangles, sheared into parallelograms by `shear`.
ShellMesh graded_patch(double shear) {
  ShellMesh mesh = make_strip({0.04, 0.02, 0.001, 4, 4}, false).mesh;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double x = mesh.nodes.x[n] + 5 * mesh.nodes.x[n] * mesh.nodes.x[n];
    mesh.nodes.set(n, {x + shear * mesh.nodes.y[n], mesh.nodes.y[n], 0});
  }
  return mesh;
}

std::vector<bool> on_edge(const ShellMesh& mesh) {
  std::vector<int> elements(mesh.nodes.size(), 0);
  for (const auto& quad : mesh.quads)
    for (const Index n : quad) ++elements[static_cast<std::size_t>(n)];
  std::vector<bool> edge;
  edge.reserve(elements.size());
  for (const int count : elements) edge.push_back(count < 3);
  return edge;
}

constexpr double exx = 1e-3, eyy = 5e-4, gxy = -8e-4;

NodalVector membrane_field(const ShellMesh& mesh) {
  NodalVector u;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double x = mesh.nodes.x[n], y = mesh.nodes.y[n];
    u.push_back({exx * x + gxy / 2 * y, eyy * y + gxy / 2 * x, 0, 0, 0, 0});
  }
  return u;
}

/// w = (kx x^2 + ky y^2)/2 + kxy x y, with the rotations of its slopes: rx = dw/dy, ry = -dw/dx. The
/// element's curvatures are then -kx, -ky and -2 kxy everywhere.
NodalVector bending_field(const ShellMesh& mesh, double kx, double ky, double kxy) {
  NodalVector u;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const double x = mesh.nodes.x[n], y = mesh.nodes.y[n];
    u.push_back({0, 0, (kx * x * x + ky * y * y) / 2 + kxy * x * y, ky * y + kxy * x, -kx * x - kxy * y, 0});
  }
  return u;
}

struct Residual {
  double force = 0, moment = 0;            // largest on inner nodes
  double edge_force = 0, edge_moment = 0;  // largest on edge nodes
};

const std::array<ShellSection, 2> both_elements{{{ElementKind::one_point}, {ElementKind::fully_integrated}}};

Residual residual(const ShellMesh& mesh, const NodalVector& u, const ShellSection& section) {
  const NodalVector f = LinearModel(mesh, {polyethylene()}, section).internal_forces(u);
  const std::vector<bool> edge = on_edge(mesh);
  Residual r;
  for (std::size_t n = 0; n < f.size(); ++n) {
    const double force = Vec3(f[n][0], f[n][1], f[n][2]).norm(),
                 moment = Vec3(f[n][3], f[n][4], f[n][5]).norm();
    double& largest_force = edge[n] ? r.edge_force : r.force;
    double& largest_moment = edge[n] ? r.edge_moment : r.moment;
    largest_force = std::max(largest_force, force);
    largest_moment = std::max(largest_moment, moment);
  }
  return r;
}

TEST(MembranePatch, ConstantStrainIsExactInEveryElementOfADistortedMesh) {
  const ShellMesh mesh = distorted_patch();
  const NodalVector u = membrane_field(mesh);
  const LinearModel model(mesh, {polyethylene()}, {});
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const ShellModes<double> s = model.strains(e, u);
    // Invariants, since every element has its own axes.
    EXPECT_NEAR(s.exx + s.eyy, exx + eyy, 1e-15);
    EXPECT_NEAR(s.exx * s.eyy - s.gxy * s.gxy / 4, exx * eyy - gxy * gxy / 4, 1e-18);
    EXPECT_NEAR(s.fibre_xi, 0, 1e-16);
    EXPECT_NEAR(s.fibre_eta, 0, 1e-16);
    EXPECT_NEAR(s.spin, 0, 1e-16);
  }
}

TEST(MembranePatch, ConstantStrainLeavesInnerNodesOfADistortedMeshInBalance) {
  for (const ShellSection& section : both_elements) {
    const Residual r = residual(distorted_patch(), membrane_field(distorted_patch()), section);
    EXPECT_GT(r.edge_force, 1);
    EXPECT_LT(r.force, 1e-13 * r.edge_force);
    EXPECT_LT(r.moment, 1e-13 * 0.24 * r.edge_force);
  }
}

TEST(MembranePatch, SteppedCarpetStoresExactlyTheEnergyOfTheStrain) {
  const ShellMesh mesh = distorted_patch();
  Carpet carpet(mesh, {polyethylene()}, no_gravity());
  // One step of a velocity field that is linear in the coordinates, small enough to be linear.
  const double dt = 0.5 * carpet.stable_step(), scale = 1e-6;
  const NodalVector u = membrane_field(mesh);
  for (std::size_t n = 0; n < u.size(); ++n)
    carpet.set_velocity(n, scale / dt * Vec3(u[n][0], u[n][1], u[n][2]), Vec3(0, 0, 0));
  const Vec3Array load = no_load(u.size());
  carpet.step(dt, load);  // moves the nodes; the strain is taken at the next force evaluation
  carpet.step(dt, load);
  const IsotropicLaw law = instantaneous_law(polyethylene());
  const double density =
      0.5 * (law.direct * (exx * exx + eyy * eyy) + 2 * law.coupled * exx * eyy + law.shear * gxy * gxy);
  const double expected = density * scale * scale * 0.24 * 0.12 * 0.001;
  EXPECT_NEAR(carpet.energy().strain / expected, 1, 1e-8);
  EXPECT_LT(carpet.energy().hourglass, 1e-20 * expected);
  // The inner nodes feel no force and keep their velocity.
  for (const Index node : inner_nodes) {
    const auto n = static_cast<std::size_t>(node);
    EXPECT_NEAR(carpet.nodes().vx[n], scale / dt * u[n][0], 1e-9 * scale / dt * exx * 0.24);
    EXPECT_NEAR(carpet.nodes().vy[n], scale / dt * u[n][1], 1e-9 * scale / dt * exx * 0.24);
  }
}

void expect_balance(const ShellMesh& mesh, const NodalVector& u, const ShellSection& section) {
  const Residual r = residual(mesh, u, section);
  EXPECT_GT(r.edge_moment, 1e-5);
  EXPECT_LT(r.moment, 1e-10 * r.edge_moment);
  EXPECT_LT(r.force * 0.01, 1e-10 * r.edge_moment);
}

TEST(BendingPatch, BendingAndTwistAreExactOnRectanglesAndParallelograms) {
  for (const ShellSection& section : both_elements)
    for (const double shear : {0.0, 0.4}) {
      const ShellMesh mesh = graded_patch(shear);
      expect_balance(mesh, bending_field(mesh, 0.3, -0.2, 0), section);
      // A constant twist is a hyperbolic paraboloid, whose deflection is no hourglass.
      expect_balance(mesh, bending_field(mesh, 0.3, -0.2, 0.25), section);
    }
}

TEST(BendingPatch, CurvaturesAreExactAndTransverseShearVanishesInEveryElementOfADistortedMesh) {
  const ShellMesh mesh = distorted_patch();
  const NodalVector u = bending_field(mesh, 0.3, -0.2, 0.25);
  const LinearModel model(mesh, {polyethylene()}, {});
  for (std::size_t e = 0; e < mesh.quads.size(); ++e) {
    const ShellModes<double> s = model.strains(e, u);
    EXPECT_NEAR(s.kxx + s.kyy, -(0.3 - 0.2), 1e-14);
    EXPECT_NEAR(s.kxx * s.kyy - s.kxy * s.kxy / 4, 0.3 * -0.2 - 0.25 * 0.25, 1e-14);
    for (const double shear : {s.shear_xi, s.shear_eta, s.shear_xi_eta, s.shear_eta_xi})
      EXPECT_NEAR(shear, 0, 1e-16);
    EXPECT_NEAR(s.turn_x, 0, 1e-16);
    EXPECT_NEAR(s.turn_y, 0, 1e-16);
  }
}

TEST(BendingPatch, ConstantMomentLeavesInnerNodesOfADistortedMeshInBalance) {
  for (const ShellSection& section : both_elements)
    expect_balance(distorted_patch(), bending_field(distorted_patch(), 0.3, -0.2, 0.25), section);
}

}  // namespace
}  // namespace tuft::fe::test
