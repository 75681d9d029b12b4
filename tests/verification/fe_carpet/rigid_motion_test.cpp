/// A body that moves as a whole must not be strained, whatever the size of the step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "fe_carpet/plane_stress.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

using Corners = std::array<Vec3, 4>;

DiagonalForm<double> diagonals(const Corners& f) {
  std::array<Triple<double>, 4> t{};
  for (std::size_t i = 0; i < 4; ++i) t[i] = {f[i].x(), f[i].y(), f[i].z()};
  return diagonal_form(t[0], t[1], t[2], t[3]);
}

/// Largest of membrane strain, curvature x size, shear and hourglass / size of one increment.
double largest_strain(const Corners& before, const Corners& after, const Vec3& rotation, double size) {
  Corners middle, displacement, rotations;
  for (std::size_t i = 0; i < 4; ++i) {
    middle[i] = 0.5 * (before[i] + after[i]);
    displacement[i] = after[i] - before[i];
    rotations[i] = rotation;
  }
  const Vec3 sum = 4 * rotation;
  ShellStrain<double> e{};
  ShellHourglass<double> h{};
  strain_increments(shell_geometry(diagonals(middle)), diagonals(displacement), diagonals(rotations),
                    Triple<double>{sum.x(), sum.y(), sum.z()}, e, h);
  double largest = 0;
  for (const double v : {e.exx, e.eyy, e.gxy, e.kxx * size, e.kyy * size, e.kxy * size, e.gxz, e.gyz,
                         h.mx / size, h.my / size, h.w / size, h.tx, h.ty})
    largest = std::max(largest, std::abs(v));
  return largest;
}

// Neither a parallelogram nor flat: node 3 stands 0.4 mm above the plane of the others.
const Corners warped{Vec3(0, 0, 0), Vec3(0.003, 0.0002, 0), Vec3(0.0027, 0.0016, 0.0004),
                     Vec3(-0.0003, 0.0013, 0)};

TEST(RigidMotion, FiniteTurnsOfADistortedWarpedElementGiveNoStrain) {
  const Vec3 axis = Vec3(0.3, -0.8, 0.52).normalized(), centre(0.01, 0.02, -0.03);
  for (const int steps_per_turn : {12, 360, 5000}) {
    const double angle = 2 * std::numbers::pi / steps_per_turn;
    // The rotation vector of a chord: as the displacements, it belongs to the configuration halfway.
    const Vec3 rotation = 2 * std::tan(angle / 2) * axis;
    Corners before = warped;
    double accumulated = 0;
    for (int step = 1; step <= steps_per_turn; ++step) {
      Corners after;
      for (std::size_t i = 0; i < 4; ++i)
        after[i] = centre + Eigen::AngleAxisd(step * angle, axis) * (warped[i] - centre) +
                   step * angle * Vec3(0.01, 0.002, 0.03);
      accumulated += largest_strain(before, after, rotation, 0.002);
      before = after;
    }
    EXPECT_LT(accumulated, 2e-14 * steps_per_turn)
        << steps_per_turn << " steps a turn: rounding of each only";
  }
}

TEST(RigidMotion, LocalAxesDoNotDependOnWhichNodeIsFirst) {
  const ShellGeometry<double> g = shell_geometry(diagonals(warped));
  const ShellGeometry<double> shifted =
      shell_geometry(diagonals({warped[1], warped[2], warped[3], warped[0]}));
  EXPECT_NEAR(g.area, shifted.area, 1e-14 * g.area);
  EXPECT_NEAR(dot(g.axes.e3, shifted.axes.e3), 1, 1e-14);
  EXPECT_NEAR(dot(g.axes.e2, shifted.axes.e1), 1,
              1e-14);  // numbering turned by one side turns the axes by 90 degrees
}

TEST(RigidMotion, ElementForcesBalanceForcesAndMomentsEvenWhenWarped) {
  const ShellGeometry<double> g = shell_geometry(diagonals(warped));
  const ShellResultants<double> s{3, -2, 1.5, 0.001, -0.002, 0.0005, 0.7, -0.4};
  const ShellHourglass<double> q{0.02, -0.03, 0.015, 1e-6, -2e-6};
  const ShellForces<double> f = nodal_forces(g, s, q);
  const auto vector = [](const Triple<double>& t) { return Vec3(t.x, t.y, t.z); };
  const Vec3 h = vector(f.force.hourglass), mh = vector(f.moment.hourglass), mean = vector(f.mean_moment);
  const std::array<double, 4> sign{1, -1, 1, -1};
  const Corners along{vector(f.force.along13), vector(f.force.along24), -vector(f.force.along13),
                      -vector(f.force.along24)};
  Vec3 force(0, 0, 0), moment(0, 0, 0);
  double scale = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 corner = along[i] + sign[i] * h;
    force += corner;
    moment += warped[i].cross(corner) + mean;  // moments along the diagonals cancel in pairs
    scale = std::max(scale, corner.norm());
  }
  moment += (sign[0] + sign[1] + sign[2] + sign[3]) * mh;
  EXPECT_LT(force.norm(), 1e-14 * scale);
  EXPECT_LT(moment.norm(), 1e-14 * scale);
}

TEST(RigidMotion, TranslationOfAFreeStripGivesExactlyNoForce) {
  const Strip strip = make_strip({}, false);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  const Vec3 velocity(3, -2, 5);
  for (std::size_t n = 0; n < strip.node_count(); ++n) carpet.set_velocity(n, velocity, Vec3(0, 0, 0));
  const Vec3Array load = no_load(strip.node_count());
  for (int i = 0; i < 1000; ++i) carpet.step(1e-6, load);
  const NodeView nodes = carpet.nodes();
  for (std::size_t n = 0; n < strip.node_count(); ++n)
    EXPECT_LT((Vec3(nodes.vx[n], nodes.vy[n], nodes.vz[n]) - velocity).norm(), 1e-9);
  EXPECT_LT(carpet.energy().strain, 1e-20 * carpet.energy().kinetic);
}

/// A free strip, twisted by `twist` (rad) so that its elements are warped, spun by one full turn.
struct Spin {
  double strain_energy_share;  // of the kinetic energy, largest
  double hourglass_energy_share;
  double length_change;  // relative, between the end nodes, largest
  double energy_error;   // relative, largest
  double returned;       // distance of the end node from its start after the turn over its path
};

Spin spin_free_strip(double rate, const Vec3& axis, double twist) {
  StripShape shape{0.03, 0.0013, 0.0001, 10, 1};
  Strip strip = make_strip(shape, false);
  const Vec3 middle(shape.length / 2, shape.width / 2, 0);
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    const Vec3 p = strip.mesh.nodes[n] - middle;
    strip.mesh.nodes.set(n, Eigen::AngleAxisd(twist * p.x() / shape.length, Vec3::UnitX()) * p);
  }
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  const double dt = 0.9 * carpet.stable_step();
  const auto steps = static_cast<int>(std::lround(2 * std::numbers::pi / rate / dt));
  const double angle = 2 * std::numbers::pi / steps;
  for (std::size_t n = 0; n < strip.node_count(); ++n) {
    // Chord velocity of the half step that ends at the start.
    const Vec3 p = strip.mesh.nodes[n], earlier = Eigen::AngleAxisd(-angle, axis) * p;
    carpet.set_velocity(n, (p - earlier) / dt, angle / dt * axis);
  }
  const Vec3Array load = no_load(strip.node_count());
  const Index first = strip.node(0, 0), last = strip.node(shape.along, 1);
  const Vec3 start = position(carpet, last);
  const double length = (start - position(carpet, first)).norm();
  const double energy = total(carpet.energy());
  Spin spin{};
  for (int i = 0; i < steps; ++i) {
    carpet.step(dt, load);
    const CarpetEnergy e = carpet.energy();
    spin.energy_error = std::max(spin.energy_error, std::abs(total(e) / energy - 1));
    spin.strain_energy_share = std::max(spin.strain_energy_share, e.strain / e.kinetic);
    spin.hourglass_energy_share = std::max(spin.hourglass_energy_share, e.hourglass / e.kinetic);
    const double now = (position(carpet, last) - position(carpet, first)).norm();
    spin.length_change = std::max(spin.length_change, std::abs(now / length - 1));
  }
  spin.returned = (position(carpet, last) - start).norm() / (std::numbers::pi * length);
  return spin;
}

TEST(RigidMotion, FullTurnOfAFreeStripStrainsItByCentrifugalForceOnly) {
  // Centrifugal strain of a bar of half length l: rho (rate l)^2 / 2E in the middle; applied suddenly it
  // swings to twice that. Its energy over the kinetic one is of the same order, so all must fall with the
  // square of the rate.
  const ShellMaterial m = polyethylene();
  for (const Vec3& axis : {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitX())})
    for (const double rate : {100.0, 1000.0}) {
      const double centrifugal = m.density * std::pow(rate * 0.015, 2) / (2 * m.young_modulus);
      const Spin spin = spin_free_strip(rate, axis, 0);
      EXPECT_LT(spin.length_change, 2.5 * centrifugal) << "rate " << rate << " axis " << axis.transpose();
      EXPECT_LT(spin.strain_energy_share, 4 * centrifugal) << "rate " << rate << " axis " << axis.transpose();
      EXPECT_LT(spin.hourglass_energy_share, 1e-3 * centrifugal)
          << "rate " << rate << " axis " << axis.transpose();
      EXPECT_LT(spin.returned, 2.5 * centrifugal) << "rate " << rate << " axis " << axis.transpose();
      EXPECT_LT(spin.energy_error, 5e-6);
    }
}

TEST(RigidMotion, FullTurnOfATwistedStripKeepsItsEnergyAndItsShape) {
  // Warped elements. A twisted strip in a spin turns flat a little: its strain and hourglass energies stay of
  // the order of the centrifugal strain.
  const double rate = 100, centrifugal = 920 * std::pow(rate * 0.015, 2) / (2 * 0.5e9);
  for (const Vec3& axis : {Vec3(Vec3::UnitZ()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitX())}) {
    const Spin spin = spin_free_strip(rate, axis, 0.5);
    EXPECT_LT(spin.energy_error, 1e-6) << "axis " << axis.transpose();
    EXPECT_LT(spin.strain_energy_share + spin.hourglass_energy_share, 10 * centrifugal) << axis.transpose();
    EXPECT_LT(spin.returned, 20 * centrifugal) << "axis " << axis.transpose();
  }
}

}  // namespace
}  // namespace tuft::fe::test
