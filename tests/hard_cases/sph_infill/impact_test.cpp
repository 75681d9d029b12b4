/// Blows: stiff over soft, a fast missile, a bed that lands; and next to no confinement.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/verification/sph_infill/cases/case_support.h"

namespace tuft::sph {
namespace {

constexpr double g = 9.81;

/// P = (K0/b)(exp(b e) - 1), K_un = 1.2 (K0 + b p), as PHYSICS' sets.
SoilFoamMaterial granular(double density, double k0, double b, double cohesion) {
  SoilFoamMaterial m = test::mixture_material();
  m.density = density;
  m.pressure = {};
  for (int k = 0; k <= 40; ++k) {
    m.pressure.x.push_back(0.01 * k);
    m.pressure.y.push_back(k0 / b * std::expm1(b * 0.01 * k));
  }
  m.unloading = {{0, 1e6}, {1.2 * k0, 1.2 * (k0 + b * 1e6)}};
  m.yield_a0 = cohesion * cohesion;
  m.yield_a1 = 2 * cohesion * 0.35;
  m.tension_cutoff = cohesion;
  return m;
}

bool inside(const ParticleView& p, double half_width) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (std::max(std::abs(p.x[i]), std::abs(p.y[i])) > half_width || p.z[i] < 0) return false;
  return true;
}

class SphBlow : public testing::TestWithParam<test::Numerics> {};
INSTANTIATE_TEST_SUITE_P(NumericsOf, SphBlow,
                         testing::Values(test::Numerics{test::Preset::accurate},
                                         test::Numerics{test::Preset::accurate, 0.3, 0.05},
                                         test::Numerics{test::Preset::fast, 0.3, 0.05},
                                         test::Numerics{test::Preset::paper},
                                         test::Numerics{test::Preset::paper, 0.3, 0.05}));

TEST_P(SphBlow, SandOverRubberFiftyTimesSofterLandsWithItsEnergyInBalance) {
  const int width = 8;
  const double pitch = 0.0025;
  Turf turf;
  turf.layers = {{0, 8 * pitch}, {1, 6 * pitch}};
  std::vector<Material> materials = test::single_material(granular(440, 0.4e6, 6, 20e3));
  materials.push_back(test::single_material(granular(1600, 20e6, 60, 20e3))[0]);
  const Lattice lattice = make_lattice(turf, {{width * pitch, width * pitch}, 0}, pitch);
  SphInfill infill(lattice, materials, test::settings_of(GetParam(), pitch, {0, 0, -g}));
  const std::size_t n = lattice.position.size();
  for (std::size_t i = 0; i < n; ++i) infill.set_velocity(i, {0, 0, -3});
  const double stiffness = 10 * constrained_modulus(*materials[0].continuum, 1e5) * pitch;
  const test::Tray tray(width * pitch, width * pitch, stiffness, 0.05);
  test::EnergyLedger ledger;
  ContactImpulses contact;
  double kinetic = 0, deepest = 1;
  for (double t = 0; t < 0.012;) {
    const double dt = test::step_with_walls(infill, stiffness, 0.5);
    tray.push(infill.particles(), dt, contact);
    infill.advance(dt, 1, contact);
    ledger.enter(infill.energy());
    if (t == 0) kinetic = infill.energy().kinetic;
    for (std::size_t i = 0; i < n; ++i)
      if (lattice.layer[i] == 1) deepest = std::min(deepest, infill.particles().z[i] / lattice.position.z[i]);
    t += dt;
  }
  RecordProperty("energy_error", testing::PrintToString(ledger.worst / kinetic));
  EXPECT_LT(deepest, 0.9) << "the rubber was not squeezed";
  EXPECT_TRUE(test::all_finite(infill.particles()));
  EXPECT_TRUE(inside(infill.particles(), 0.5 * width * pitch));
  EXPECT_LT(ledger.worst, 0.01 * kinetic);
}

/// A rigid ball on penalty springs; leapfrog, as the infill.
struct Missile {
  double radius = 0.0125, mass = 0.020, stiffness = 0;
  Vec3 position{0, 0, 0}, velocity{0, 0, 0};
  double kinetic = 0, spring = 0;  ///< J, centred

  void push(const ParticleView& p, double window, ContactImpulses& contact) {
    Vec3 received(0, 0, 0);
    spring = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Vec3 from = p.position(i) - position;
      const double distance = from.norm(), overlap = radius + p.radius[i] - distance;
      if (overlap <= 0) continue;
      const Vec3 impulse = window * stiffness * overlap / distance * from;
      contact.linear.add(i, impulse);
      received -= impulse;
      spring += 0.5 * stiffness * overlap * overlap;
    }
    const Vec3 before = velocity;
    velocity += received / mass;
    kinetic = 0.5 * mass * before.dot(velocity);
    position += window * velocity;
  }
};

TEST_P(SphBlow, AMissileAtThirtyMetresPerSecondIsStoppedWithItsEnergyInBalance) {
  const int width = 14, rows = 12;
  const double pitch = 0.0035;
  const SoilFoamMaterial mixture = granular(977, 1.5e6, 10, 20e3);
  const Lattice lattice = test::block(width, width, rows, pitch);
  SphInfill infill(lattice, test::single_material(mixture), test::settings_of(GetParam(), pitch, {0, 0, 0}));
  const double stiffness = 10 * constrained_modulus(mixture, 1e6) * pitch;
  const test::Tray tray(width * pitch, width * pitch, stiffness, 0);
  Missile missile;
  missile.stiffness = stiffness;
  missile.position = Vec3(0.1 * pitch, 0.2 * pitch, rows * pitch + missile.radius);
  missile.velocity = Vec3(0, 0, -30);
  const double brought = 0.5 * missile.mass * 900;
  ContactImpulses contact;
  double first = 0, worst = 0, lowest = 1;
  for (double t = 0; t < 0.0025;) {
    const double dt = test::step_with_walls(infill, stiffness, 0.5);
    double springs = tray.push(infill.particles(), dt, contact);
    missile.push(infill.particles(), dt, contact);
    springs += missile.spring;
    infill.advance(dt, 1, contact);
    const InfillEnergy e = infill.energy();
    const double all = e.kinetic + e.stored + e.dissipated + missile.kinetic + springs;
    if (t == 0) first = all;
    worst = std::max(worst, std::abs(all - first));
    lowest = std::min(lowest, missile.position.z() - missile.radius);
    t += dt;
  }
  RecordProperty("energy_error", testing::PrintToString(worst / brought));
  RecordProperty("depth_mm", testing::PrintToString(1e3 * (rows * pitch - lowest)));
  EXPECT_TRUE(test::all_finite(infill.particles()));
  EXPECT_TRUE(inside(infill.particles(), 0.5 * width * pitch));
  EXPECT_GT(missile.velocity.z(), -15) << "not slowed";
  EXPECT_GT(lowest, 0) << "through the floor";
  EXPECT_LT(worst, 0.02 * brought);
}

TEST_P(SphBlow, ABedThrownUpwardLandsAndComesToRestAtItsDensity) {
  const int width = 6, rows = 6;
  const double pitch = 0.004;
  for (const double cohesion : {0.0, 20e3}) {
    const SoilFoamMaterial mixture = granular(977, 1.5e6, 10, cohesion);
    const Lattice lattice = test::block(width, width, rows, pitch);
    SphInfill infill(lattice, test::single_material(mixture),
                     test::settings_of(GetParam(), pitch, {0, 0, -g}));
    const std::size_t n = lattice.position.size();
    for (std::size_t i = 0; i < n; ++i) infill.set_velocity(i, {0, 0, 0.2});
    const double stiffness = 10 * constrained_modulus(mixture, 1e4) * pitch;
    const test::Tray tray(width * pitch, width * pitch, stiffness, 0.5);
    test::EnergyLedger ledger;
    ContactImpulses contact;
    double kinetic = 0, highest = 0, height = 0;
    for (double t = 0; t < 0.3;) {
      const double dt = test::step_with_walls(infill, stiffness, 0.7);
      tray.push(infill.particles(), dt, contact);
      infill.advance(dt, 1, contact);
      ledger.enter(infill.energy());
      if (t == 0) kinetic = infill.energy().kinetic;
      highest = std::max(highest, infill.particles().z[0] - lattice.position.z[0]);
      t += dt;
    }
    for (std::size_t i = 0; i < n; ++i) height += infill.particles().z[i] / static_cast<double>(n);
    RecordProperty(fmt::format("energy_error_{}", cohesion), testing::PrintToString(ledger.worst / kinetic));
    RecordProperty(fmt::format("mean_height_{}", cohesion),
                   testing::PrintToString(height / (0.5 * rows * pitch)));
    RecordProperty(fmt::format("kinetic_left_{}", cohesion),
                   testing::PrintToString(infill.energy().kinetic / kinetic));
    EXPECT_NEAR(highest, 0.2 * 0.2 / (2 * g), 1e-4);
    EXPECT_TRUE(inside(infill.particles(), 0.5 * width * pitch));
    EXPECT_NEAR(height / (0.5 * rows * pitch), 1, 0.02) << "cohesion " << cohesion;
    EXPECT_LT(infill.energy().kinetic, 1e-3 * kinetic);
    EXPECT_LT(ledger.worst, 0.01 * kinetic);
  }
}

TEST_P(SphBlow, AFreeBlockOnAFloorStandsByItsCohesionAndSlumpsWithoutIt) {
  const int width = 8, rows = 5;
  const double pitch = 0.004;
  for (const double cohesion : {0.0, 20e3}) {
    const SoilFoamMaterial mixture = granular(977, 1.5e6, 10, cohesion);
    const Lattice lattice = test::block(width, width, rows, pitch);
    SphInfill infill(lattice, test::single_material(mixture),
                     test::settings_of(GetParam(), pitch, {0, 0, -g}));
    const std::size_t n = lattice.position.size();
    const double stiffness = 10 * constrained_modulus(mixture, 1e4) * pitch;
    const test::FrictionPlane floor{{{0, 0, 0}, {0, 0, 1}, stiffness, 0.1}, 0.5};
    test::EnergyLedger ledger;
    ContactImpulses contact;
    for (double t = 0; t < 0.3;) {
      const double dt = test::step_with_walls(infill, stiffness, 0.7);
      contact.linear.assign(n, 0);
      floor.push(infill.particles(), dt, contact);
      infill.advance(dt, 1, contact);
      ledger.enter(infill.energy());
      t += dt;
    }
    double moved = 0, potential = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 x = infill.particles().position(i);
      moved = std::max(moved, (x - lattice.position[i]).norm());
      potential += infill.particles().mass[i] * g * lattice.position.z[i];
      EXPECT_GT(x.z(), 0);
    }
    RecordProperty(fmt::format("energy_error_{}", cohesion),
                   testing::PrintToString(ledger.worst / potential));
    RecordProperty(fmt::format("moved_{}", cohesion), testing::PrintToString(moved / pitch));
    RecordProperty(fmt::format("kinetic_left_{}", cohesion),
                   testing::PrintToString(infill.energy().kinetic / potential));
    EXPECT_TRUE(test::all_finite(infill.particles()));
    if (cohesion > 0) {
      EXPECT_LT(moved, 0.1 * pitch);
    } else {
      EXPECT_GT(moved, pitch);
      EXPECT_LT(moved, width * pitch);
    }
    // What a slumped heap still creeps with hangs on rounding: between 0.12 % and 0.70 % over 64 runs from
    // positions moved by less than 1e-12 m.
    EXPECT_LT(infill.energy().kinetic, 1e-2 * potential);
    EXPECT_LT(ledger.worst, 1e-3 * potential);
  }
}

}  // namespace
}  // namespace tuft::sph
