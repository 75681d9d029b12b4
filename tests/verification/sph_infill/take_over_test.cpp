// The switch from spheres to the continuum: what it keeps, what it lets go, and the state it begins in.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "core/error.h"
#include "sph_infill/sphere_infill.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

SphSettings continuum(const SoilEffects& effects = {}) {
  SphSettings settings;
  settings.options = test::options_of(test::Preset::accurate, pitch);
  settings.gravity = {0, 0, 0};
  settings.soil_effects = effects;
  settings.zero_energy_control = true;
  return settings;
}

SphereInfill spheres_at(const Lattice& lattice, const Vec3Array& position) {
  SphereSettings settings;
  settings.options = continuum().options;
  settings.gravity = {0, 0, 0};
  settings.modulus = 8e7;
  settings.friction = 0.5;
  settings.damping_ratio = {0.2};
  return {lattice, test::single_material(test::mixture_with_effects()), position, settings};
}

/// A block, pressed evenly to 0.9 of its height: spheres overlap. Particles touch as cubes (scene_lattice).
struct PressedBlock {
  Lattice lattice = test::block(8, 8, 8, pitch);
  Vec3Array pressed = lattice.position;
  PressedBlock() {
    lattice.radius.clear(), lattice.half_height.clear();
    for (double& z : pressed.z) z *= 0.9;
  }
};

double field_mean(const SphInfill& infill, const std::string& name) {
  for (const Infill::Field& field : infill.fields())
    if (field.name == name) {
      double sum = 0;
      for (const double v : field.values) sum += v;
      return sum / static_cast<double>(field.values.size());
    }
  ADD_FAILURE() << name;
  return 0;
}

TEST(TakeOver, KeepsTheKineticEnergyOfTranslationAndLetsGoOfSpringsAndSpin) {
  const PressedBlock block;
  SphereInfill spheres = spheres_at(block.lattice, block.pressed);
  const ParticleView p = spheres.particles();
  const Vec3 velocity(0.3, -0.1, 0.2);
  double translation = 0, rotation = 0, springs = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    spheres.set_velocity(i, velocity);
    spheres.set_spin(i, {0, 5, 0});
    translation += 0.5 * p.mass[i] * velocity.squaredNorm();
    rotation += 0.5 * 0.4 * p.mass[i] * std::pow(0.5 * pitch, 2) * 25;
  }
  // 7 springs in each of 64 columns, k = modulus (r + r), overlapped by a tenth of the pitch.
  springs = 64 * 7 * 0.5 * (8e7 * pitch) * std::pow(0.1 * pitch, 2);
  const CompactedBed bed = spheres.hand_over();
  EXPECT_NEAR(bed.energy.kinetic, translation, 1e-12 * translation);
  EXPECT_NEAR(bed.energy.let_go, rotation + springs, 1e-9 * springs);
  EXPECT_EQ(bed.energy.stored, 0);

  SphInfill taken(block.lattice, test::single_material(test::mixture_material()), continuum(), bed,
                  ConditionedState::automatic);
  const ParticleView q = taken.particles();
  for (std::size_t i = 0; i < q.size(); ++i) EXPECT_EQ(q.velocity(i), bed.velocity[i]);
  EXPECT_TRUE(std::ranges::equal(p.mass, q.mass) && std::ranges::equal(p.radius, q.radius));
}

TEST(TakeOver, EnergyOfMovingSpheresThatMeetIsAccountedForAcrossTheSwitch) {
  const PressedBlock block;
  SphereInfill spheres = spheres_at(block.lattice, block.lattice.position);
  const ParticleView p = spheres.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    spheres.set_velocity(i, -40 * (p.position(i) - Vec3(0, 0, 4 * pitch)) + Vec3(0, 0.05, 0));
  const auto total = [](const InfillEnergy& e) {
    return e.kinetic + e.stored + e.dissipated + e.gravity_potential + e.damping + e.let_go - e.contact_work;
  };
  spheres.set_damping(50);
  for (int k = 0; k < 5; ++k) spheres.advance(0.5 * spheres.stable_step(), 1, {});
  const double before = total(spheres.energy()), moving = spheres.energy().kinetic;
  ASSERT_GT(moving, 1e-6);
  const CompactedBed bed = spheres.hand_over();
  EXPECT_NEAR(total(bed.energy), before, 2e-3 * before);
  SphInfill taken(block.lattice, test::single_material(test::mixture_material()), continuum(), bed,
                  ConditionedState::initial);
  for (int k = 0; k < 5; ++k) taken.advance(0.2 * taken.stable_step(), 1, {});
  EXPECT_NEAR(total(taken.energy()), before, 5e-3 * before);
  EXPECT_GT(taken.energy().let_go, 0);
}

TEST(TakeOver, ABedAtRestStaysExactlyAtRestForItIsFreeOfStress) {
  const PressedBlock block;
  for (const ConditionedState state : {ConditionedState::initial, ConditionedState::compacted}) {
    SphereInfill spheres = spheres_at(block.lattice, block.pressed);
    CompactedBed bed = spheres.hand_over();
    SphInfill taken(block.lattice, test::single_material(test::mixture_with_effects()),
                    continuum(test::all_soil_effects), bed, state);
    for (int k = 0; k < 50; ++k) taken.advance(0.8 * taken.stable_step(), 1, {});
    const ParticleView q = taken.particles();
    double fastest = 0;
    for (std::size_t i = 0; i < q.size(); ++i) fastest = std::max(fastest, q.velocity(i).norm());
    EXPECT_EQ(fastest, 0);
  }
}

TEST(TakeOver, DensityIsMassOverTheVolumeOfThePressedBed) {
  const PressedBlock block;
  for (const ConditionedState state : {ConditionedState::initial, ConditionedState::compacted}) {
    SphereInfill spheres = spheres_at(block.lattice, block.pressed);
    const CompactedBed bed = spheres.hand_over();
    SphInfill taken(block.lattice, test::single_material(test::mixture_with_effects()),
                    continuum(test::all_soil_effects), bed, state);
    EXPECT_NEAR(field_mean(taken, "density"), 977 / 0.9, 0.02 * 977);  // outermost rows: compaction.h
  }
}

TEST(TakeOver, StateIsTheMaterialsOwnOrThatOfAPressedAndReleasedPointAsAsked) {
  const PressedBlock block;
  const auto plastic = [&](const SoilFoamMaterial& material, const SoilEffects& effects,
                           ConditionedState state) {
    SphereInfill spheres = spheres_at(block.lattice, block.pressed);
    const CompactedBed bed = spheres.hand_over();
    return field_mean(
        SphInfill(block.lattice, test::single_material(material), continuum(effects), bed, state),
        "plastic_compression");
  };
  SoilEffects hardening;
  hardening.density_hardening = true;
  const SoilFoamMaterial with = test::mixture_with_effects(), without = test::mixture_material();
  const double pressed = std::log(1 / 0.9);
  EXPECT_NEAR(plastic(with, hardening, ConditionedState::compacted), pressed, 0.02);
  EXPECT_NEAR(plastic(with, hardening, ConditionedState::automatic), pressed, 0.02);
  EXPECT_EQ(plastic(with, hardening, ConditionedState::initial), 0);
  EXPECT_EQ(plastic(without, {}, ConditionedState::automatic), 0);
}

TEST(TakeOver, ParticlesLooserThanAsPlacedGetTheVolumeTheyWerePlacedWith) {
  const PressedBlock block;
  Vec3Array spread = block.lattice.position;
  for (double& z : spread.z) z *= 1.1;
  SphereInfill spheres = spheres_at(block.lattice, spread);
  const CompactedBed bed = spheres.hand_over();
  const SphInfill taken(block.lattice, test::single_material(test::mixture_material()), continuum(), bed,
                        ConditionedState::automatic);
  EXPECT_EQ(taken.loosest_started(), block.lattice.volume.size());
  EXPECT_NEAR(field_mean(taken, "density"), 977, 1e-9);
}

TEST(TakeOver, ALawThatCompactionCannotLeaveSoDenseIsRefusedWithAWayOut) {
  const PressedBlock block;
  SphereInfill spheres = spheres_at(block.lattice, block.pressed);
  const CompactedBed bed = spheres.hand_over();
  try {
    SphInfill(block.lattice, test::single_material(test::elastic_material(1e6, 977)), continuum(), bed,
              ConditionedState::compacted);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("conditioning.state = \"initial\""), std::string::npos)
        << error.what();
  }
}

TEST(TakeOver, LoadedIntoInfillOfTheLatticeGoesOnWithTheSameBits) {
  const PressedBlock block;
  const auto material = test::single_material(test::mixture_material());
  SphereInfill spheres = spheres_at(block.lattice, block.pressed);
  CompactedBed bed = spheres.hand_over();
  for (std::size_t i = 0; i < bed.velocity.size(); ++i) bed.velocity.set(i, -20 * bed.position[i]);
  SphInfill through(block.lattice, material, continuum(), bed, ConditionedState::automatic);
  for (int k = 0; k < 20; ++k) through.advance(1e-5, 1, {});
  SphInfill resumed(block.lattice, material, continuum());
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("tuft-take-over-" + std::to_string(::getpid()) + ".h5");
  {
    h5::File file = h5::File::create_atomically(path);
    h5::Group root = file.root();
    through.save(root);
    file.commit();
  }
  resumed.load(h5::File::open(path).root());
  std::filesystem::remove(path);
  for (int k = 0; k < 20; ++k) through.advance(1e-5, 1, {}), resumed.advance(1e-5, 1, {});
  EXPECT_TRUE(std::ranges::equal(through.particles().vz, resumed.particles().vz));
  EXPECT_EQ(through.energy().stored, resumed.energy().stored);
  EXPECT_EQ(through.energy().let_go, resumed.energy().let_go);
}

}  // namespace
}  // namespace tuft::sph
