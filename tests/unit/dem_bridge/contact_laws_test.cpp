/// Hooke's springs and cohesion as pure functions, and what two kinds of grains have between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/vector.h"
#include "dem_bridge/cohesion.h"
#include "dem_bridge/grain_contact.h"
#include "dem_bridge/hertz.h"
#include "dem_bridge/hooke.h"
#include "dem_bridge/hooke_hysteresis.h"

namespace tuft::dem {
namespace {

TEST(Hooke, CollisionAtTheCharacteristicVelocityOverlapsAsUnderHertz) {
  const double young = 5e6, radius = 0.0006, mass = 3e-6;
  for (const double velocity : {0.1, 2.85}) {
    const double energy = 0.5 * mass * velocity * velocity;
    const double overlap = std::sqrt(2 * energy / hooke_stiffness(young, radius, mass, velocity));
    EXPECT_NEAR(normal_energy(young, radius, overlap), energy, 1e-12 * energy);
  }
}

TEST(Hooke, DampingRatioThrowsBackTheShareOfSpeed) {
  for (const double restitution : {0.2, 0.6, 0.95}) {
    const double z = hooke_damping_ratio(restitution);
    EXPECT_NEAR(std::exp(-std::numbers::pi * z / std::sqrt(1 - z * z)), restitution, 1e-12);
  }
  EXPECT_EQ(hooke_damping_ratio(1), 0);
}

/// Slip in a contact with normal n, of grains that move as the wave (u, theta) exp(i p) with phase p from one
/// centre to the other: (1 - e^ip) u + (1 + e^ip) theta x n, with theta by radius. Real parts first.
using Wave = std::array<Vec3, 4>;  // u, theta: real; u, theta: imaginary
std::array<Vec3, 2> slip_of(const Wave& w, const Vec3& n, double phase) {
  const double c = std::cos(phase), s = std::sin(phase);
  const Vec3 turn = w[1].cross(n), other = w[3].cross(n);
  return {(1 - c) * w[0] + s * w[2] + (1 + c) * turn - s * other,
          (1 - c) * w[2] - s * w[0] + (1 + c) * other + s * turn};
}

/// Largest omega^2, over k/m, of waves in a face-centred cubic packing of spheres with springs k, tangential
/// ones too: power iterations for waves on a grid.
double largest_squared_frequency() {
  std::vector<Vec3> normals;  // one of each pair of opposite contacts
  for (int a = 0; a < 3; ++a)
    for (const double sign : {-1.0, 1.0}) {
      Vec3 n = Vec3::Zero();
      n[a] = std::sqrt(0.5);
      n[(a + 1) % 3] = sign * std::sqrt(0.5);
      normals.push_back(n);
    }
  const double inertia = 0.4;  // of spin by radius, over the mass
  double largest = 0;
  constexpr int steps = 6;
  for (int i = 0; i < steps * steps * steps; ++i) {
    // Half a face-centred cube's reciprocal cell along each axis, lengths over a diameter.
    const Vec3 vector = std::numbers::sqrt2 * std::numbers::pi / (steps - 1) *
                        Vec3(i % steps, i / steps % steps, i / steps / steps);
    Wave wave{Vec3(1, 0.3, -0.2), Vec3(0.4, -1, 0.1), Vec3(0.2, 0.5, 0.7), Vec3(-0.3, 0.6, 1)};
    double value = 0;
    for (int iteration = 0; iteration < 300; ++iteration) {
      Wave force{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
      for (const Vec3& n : normals) {
        const double phase = vector.dot(n), c = std::cos(phase), s = std::sin(phase);
        const auto [real, imaginary] = slip_of(wave, n, phase);
        force[0] += (1 - c) * real - s * imaginary;
        force[2] += s * real + (1 - c) * imaginary;
        force[1] += n.cross((1 + c) * real + s * imaginary);
        force[3] += n.cross(-s * real + (1 + c) * imaginary);
      }
      force[1] /= inertia;
      force[3] /= inertia;
      double squared = 0, overlap = 0, own = 0;
      for (std::size_t p = 0; p < 4; ++p) {
        const double mass = p % 2 == 0 ? 1 : inertia;
        overlap += mass * force[p].dot(wave[p]);
        own += mass * wave[p].squaredNorm();
        squared += force[p].squaredNorm();
      }
      value = overlap / own;
      for (std::size_t p = 0; p < 4; ++p)
        wave[p] = squared > 0 ? Vec3(force[p] / std::sqrt(squared)) : wave[p];
    }
    largest = std::max(largest, value);
  }
  return largest;
}

TEST(Hooke, StableStepBoundsTheStiffestWaveOfTheDensestPacking) {
  const double stiffness = 1000, mass = 5e-6;
  const double critical = 2 / std::sqrt(largest_squared_frequency() * stiffness / mass);
  const double step = stable_hooke_step(stiffness, mass, 1);
  EXPECT_LE(step, critical * (1 + 1e-12));
  EXPECT_GT(step, 0.9 * critical);
  RecordProperty("step_over_critical", std::to_string(step / critical));
  EXPECT_LT(stable_hooke_step(stiffness, mass, 0.5), 0.5 * step) << "damping shortens it";
}

TEST(Hysteresis, LinesMeetWhereTheyChange) {
  const Hysteresis law{3, 0.1, 0.5};
  const double k = 1000, r = 0.0006, limit = largest_plastic_overlap(law, r);
  EXPECT_NEAR(limit, 1.5 * 0.1 * 2 * r, 1e-15);
  for (const double largest : {0.3 * limit, limit, 2 * limit}) {
    const double k2 = unloading_stiffness(law, k, r, largest);
    // At its largest overlap a contact is on both lines, up to the limit; from there on it is elastic.
    const double top = std::min(largest, limit);
    EXPECT_NEAR(hysteretic_force(law, k, r, top, largest), k * top, 1e-12 * k * top);
    const double dent = top * (1 - k / k2), h = 1e-6 * top;
    EXPECT_NEAR(hysteretic_force(law, k, r, dent, largest), 0, 1e-9 * k * top);
    EXPECT_EQ(hysteretic_energy(law, k, r, dent, largest) < 1e-15, true);
    EXPECT_NEAR(
        (hysteretic_force(law, k, r, dent + h, largest) - hysteretic_force(law, k, r, dent, largest)) / h, k2,
        1e-6 * k2);
    // On that line the energy's derivative is the force.
    const double d = 0.5 * (dent + top);
    EXPECT_NEAR(
        (hysteretic_energy(law, k, r, d + h, largest) - hysteretic_energy(law, k, r, d - h, largest)) /
            (2 * h),
        hysteretic_force(law, k, r, d, largest), 1e-6 * k * top);
    EXPECT_NEAR(hysteretic_force(law, k, r, 0.01 * dent, largest), -0.5 * k * 0.01 * dent, 1e-12 * k * top);
  }
  EXPECT_EQ(unloading_stiffness(law, k, r, 2 * limit), 3 * k);
}

TEST(Cohesion, ForceIsTheDerivativeOfTheOverlapsVolume) {
  const double r1 = 0.001, r2 = 0.0004;
  for (const double distance : {0.00139, 0.0012, 0.0008}) {
    const double h = 1e-8;
    EXPECT_NEAR((overlap_volume(r1, r2, distance - h) - overlap_volume(r1, r2, distance + h)) / (2 * h),
                cohesion_area(r1, r2, distance), 1e-6 * cohesion_area(r1, r2, distance));
  }
  EXPECT_EQ(overlap_volume(r1, r2, r1 + r2), 0);
  EXPECT_EQ(cohesion_area(r1, r2, 1.01 * (r1 + r2)), 0);
  // The smaller one with its centre on the other's surface is half inside a plane, nearly.
  const double half = 2.0 / 3 * std::numbers::pi * 1e-12;
  EXPECT_NEAR(overlap_volume(1.0, 1e-4, 1.0), half, 1e-4 * half);
}

TEST(Cohesion, SmallOverlapsMeetInACircleOfTwiceTheEffectiveRadius) {
  const double r1 = 0.001, r2 = 0.0004, effective = r1 * r2 / (r1 + r2), overlap = 1e-8;
  const double area = 2 * std::numbers::pi * effective * overlap;
  EXPECT_NEAR(cohesion_area(r1, r2, r1 + r2 - overlap), area, 1e-4 * area);
}

TEST(Cohesion, PullOffForceIsTheLargestThatHolds) {
  const double young = 5e6, r1 = 0.001, r2 = 0.0004, radius = r1 * r2 / (r1 + r2), cohesion = 2e4;
  const double balance = cohesive_overlap(cohesion, young) * radius;
  const auto pull = [&](double overlap) {
    return cohesion * cohesion_area(r1, r2, r1 + r2 - overlap) -
           4.0 / 3 * young * std::sqrt(radius) * std::pow(overlap, 1.5);
  };
  double largest = 0;
  for (int i = 1; i < 1000; ++i) largest = std::max(largest, pull(balance * i / 1000));
  const double expected = pull_off_force(cohesion, young, radius);
  EXPECT_NEAR(largest, expected, 1e-3 * expected);
  EXPECT_NEAR(pull(balance), 0, 1e-3 * expected);
}

class Contact : public ::testing::Test {
 protected:
  Contact() {
    materials_.resize(2);
    materials_[0].name = "sand";
    materials_[0].grain = GrainMaterial{2650, 50e6, 0.25, 0.6, 0.5, 0.1, 0.0002, 0.0012};
    materials_[1].name = "rubber";
    materials_[1].grain = GrainMaterial{1150, 8e6, 0.45, 0.5, 0.7, 0.2, 0.0008, 0.0017};
    hooke_.contact = GrainContact::hooke;
    hooke_.characteristic_velocity = 2;
  }
  std::vector<Material> materials_;
  DemOptions hertz_, hooke_;
  const std::vector<Index> kinds_{0, 1};
};

TEST_F(Contact, StepWithHooksSpringsIsTheSmallerOfBothAndKnowsTheStiffestPartner) {
  const std::vector<Index> rubber{1};
  const double radius = 0.0006, density = 1150;
  const double alone = stable_step_of_grain(radius, density, 1, rubber, materials_, hooke_);
  const double mass = 4.0 / 3 * std::numbers::pi * std::pow(radius, 3) * density;
  const double among_equals =
      hooke_stiffness(effective_young_modulus(8e6, 0.45, 8e6, 0.45), 0.5 * radius, 0.5 * mass, 2);
  EXPECT_NEAR(alone, stable_hooke_step(among_equals, mass, 0.5), 1e-12 * alone);
  EXPECT_LT(stable_step_of_grain(radius, density, 1, kinds_, materials_, hooke_), 0.9 * alone);
  hooke_.characteristic_velocity = 1e-3;  // soft springs: Rayleigh's time is smaller
  EXPECT_EQ(stable_step_of_grain(radius, density, 1, kinds_, materials_, hooke_),
            stable_step_of_grain(radius, density, 1, kinds_, materials_, hertz_));
}

TEST_F(Contact, CohesionThatOvercomesHookesSpringsIsRefused) {
  materials_[1].grain->cohesion_energy_density = 1e5;
  const double ratio = cohesion_over_hooke(1, 1, materials_, hooke_);
  ASSERT_LT(ratio, 1);
  EXPECT_NO_THROW(check_cohesion(kinds_, materials_, hooke_));
  materials_[1].grain->cohesion_energy_density = 1.01e5 / ratio;
  EXPECT_NO_THROW(check_cohesion(kinds_, materials_, hertz_));
  try {
    check_cohesion(kinds_, materials_, hooke_);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("cohesion of rubber is 1.01 times as stiff"), std::string::npos)
        << error.what();
  }
}

TEST_F(Contact, RemarksNameWhatIsBeyondWhatWasTried) {
  EXPECT_TRUE(contact_remarks(kinds_, true, materials_, hertz_).empty());
  hertz_.material_coarse_graining["sand"] = 4;
  materials_[1].grain->cohesion_energy_density = 1e6;
  const auto remarks = contact_remarks(kinds_, true, materials_, hertz_);
  ASSERT_EQ(remarks.size(), 3u);
  EXPECT_NE(remarks[0].find("sand are drawn 4 times too large"), std::string::npos) << remarks[0];
  EXPECT_NE(remarks[1].find("presses grains of sand on rubber together"), std::string::npos) << remarks[1];
  EXPECT_NE(remarks[2].find("presses grains of rubber together by 0.88"), std::string::npos) << remarks[2];
  EXPECT_EQ(contact_remarks(kinds_, false, materials_, hertz_).size(), 1u) << "cohesion is off";
  const auto hooke = contact_remarks(kinds_, true, materials_, hooke_);
  ASSERT_EQ(hooke.size(), 2u);
  EXPECT_NE(hooke[0].find("holds nothing together"), std::string::npos) << hooke[0];
}

}  // namespace
}  // namespace tuft::dem
