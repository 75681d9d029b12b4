/// A body that moves as a whole must not be strained, whatever the size of the step.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "fe_carpet/shell_strain.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

using Corners = std::array<Vec3, 4>;

Triple<double> triple(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

CornerModes<double> modes(const Corners& f) {
  return corner_modes(triple(f[0]), triple(f[1]), triple(f[2]), triple(f[3]));
}

/// All modes with strains made dimensionless by `size`.
std::array<double, 18> values(const ShellModes<double>& e, double size) {
  return {e.exx,
          e.eyy,
          e.gxy,
          e.kxx * size,
          e.kyy * size,
          e.kxy * size,
          e.shear_xi / size,
          e.shear_xi_eta / size,
          e.shear_eta / size,
          e.shear_eta_xi / size,
          e.fibre_xi,
          e.fibre_eta,
          e.turn_x,
          e.turn_y,
          e.spin,
          e.spin_xi,
          e.spin_eta,
          e.spin_h};
}

/// Largest of membrane strain, curvature x size, shear and hourglass / size of one increment.
double largest_strain(const Corners& before, const Corners& after, const Vec3& rotation, double size) {
  Corners middle, displacement, rotations;
  for (std::size_t i = 0; i < 4; ++i) {
    middle[i] = 0.5 * (before[i] + after[i]);
    displacement[i] = after[i] - before[i];
    rotations[i] = rotation;
  }
  const ShellModes<double> e =
      strain_increments(shell_frame(modes(middle)), modes(displacement), modes(rotations), triple(rotation));
  double largest = 0;
  for (const double v : values(e, size)) largest = std::max(largest, std::abs(v));
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
  const ShellFrame<double> g = shell_frame(modes(warped));
  const ShellFrame<double> shifted = shell_frame(modes({warped[1], warped[2], warped[3], warped[0]}));
  EXPECT_NEAR(g.area, shifted.area, 1e-14 * g.area);
  EXPECT_NEAR(dot(g.axes.e3, shifted.axes.e3), 1, 1e-14);
  EXPECT_NEAR(dot(g.axes.e2, shifted.axes.e1), 1,
              1e-14);  // numbering turned by one side turns the axes by 90 degrees
}

/// Forces and moments on the four corners.
struct CornerLoads {
  Corners force, moment;
};

CornerLoads corner_loads(const ShellForces<double>& f) {
  const auto vector = [](const Triple<double>& t) { return Vec3(t.x, t.y, t.z); };
  CornerLoads loads;
  constexpr std::array<double, 4> xi{-1, 1, 1, -1}, eta{-1, -1, 1, 1}, h{1, -1, 1, -1};
  for (std::size_t i = 0; i < 4; ++i) {
    loads.force[i] =
        0.25 * (xi[i] * vector(f.force.xi) + eta[i] * vector(f.force.eta) + h[i] * vector(f.force.h));
    loads.moment[i] = 0.25 * (xi[i] * vector(f.moment.xi) + eta[i] * vector(f.moment.eta) +
                              h[i] * vector(f.moment.h) + vector(f.mean_moment));
  }
  return loads;
}

const ShellModes<double> some_forces{3,    -2,    1.5,  0.001, -0.002, 0.0005, 0.7,  -0.4, 0.3,
                                     -0.2, 0.006, -0.3, 1e-3,  -2e-3,  2e-3,   1e-3, 3e-3, -1e-3};

TEST(RigidMotion, ElementForcesBalanceForcesAndMomentsEvenWhenWarped) {
  const CornerLoads loads = corner_loads(nodal_forces(shell_frame(modes(warped)), some_forces));
  Vec3 force(0, 0, 0), moment(0, 0, 0);
  double scale = 0, moment_scale = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    force += loads.force[i];
    moment += warped[i].cross(loads.force[i]) + loads.moment[i];
    scale = std::max(scale, loads.force[i].norm());
    moment_scale = std::max(moment_scale, loads.moment[i].norm());
  }
  EXPECT_LT(force.norm(), 1e-14 * scale);
  EXPECT_LT(moment.norm(), 1e-14 * (moment_scale + 0.003 * scale));
}

TEST(RigidMotion, ElementForcesDoTheWorkOfTheirStrainsInAnyMotion) {
  const ShellFrame<double> f = shell_frame(modes(warped));
  const CornerLoads loads = corner_loads(nodal_forces(f, some_forces));
  for (int seed = 1; seed < 20; ++seed) {
    Corners d, r;
    Vec3 mean(0, 0, 0);
    for (std::size_t i = 0; i < 4; ++i)
      for (Eigen::Index c = 0; c < 3; ++c) {
        const double k =
            static_cast<double>(seed) * (1.7 * static_cast<double>(i) + 0.9 * static_cast<double>(c) + 1);
        d[i][c] = 1e-5 * std::sin(k);
        r[i][c] = 1e-2 * std::cos(1.3 * k);
      }
    for (const Vec3& rotation : r) mean += 0.25 * rotation;
    double at_corners = 0, scale = 0, inside = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      at_corners += loads.force[i].dot(d[i]) + loads.moment[i].dot(r[i]);
      scale += std::abs(loads.force[i].dot(d[i])) + std::abs(loads.moment[i].dot(r[i]));
    }
    const auto e = values(strain_increments(f, modes(d), modes(r), triple(mean)), 1),
               s = values(some_forces, 1);
    for (std::size_t i = 0; i < e.size(); ++i) inside += e[i] * s[i];
    EXPECT_NEAR(at_corners, inside, 1e-13 * scale);
  }
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
      EXPECT_LT(spin.hourglass_energy_share, 1e-2 * centrifugal)
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
