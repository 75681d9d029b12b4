#include "dem_bridge/liggghts_script.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

std::vector<Material> three_materials() {
  std::vector<Material> materials{grain_material(8e6, 0.45, 1150, 0.5, 0.7), Material{},
                                  grain_material(50e6, 0.25, 2650, 0.7, 0.5)};
  materials[2].grain->rolling_friction = 0.2;
  return materials;
}

std::string commands(const std::vector<Material>& materials, const DemSettings& settings) {
  return set_up_commands("read_data grains", {0, 2}, materials, settings, {10, 0.001, 0.002}, 1e-6);
}

TEST(Script, UnlikePairsTakeTheMeanUnlessGiven) {
  DemSettings settings = settings_in_box(0.1);
  const auto materials = three_materials();
  EXPECT_NE(commands(materials, settings)
                .find("coefficientFriction peratomtypepair 2 0.69999999999999996 0.59999999999999998 "
                      "0.59999999999999998 0.5\n"),
            std::string::npos)
      << commands(materials, settings);
  settings.options.pairs = {{{2, 0}, 0.25}};
  EXPECT_NE(commands(materials, settings)
                .find("coefficientFriction peratomtypepair 2 0.69999999999999996 0.25 0.25 0.5\n"),
            std::string::npos);
}

TEST(Script, PairsGiveEachPropertyOfTheirsAndLeaveTheOthers) {
  DemSettings settings = settings_in_box(0.1);
  settings.rolling_resistance = settings.cohesion = true;
  auto materials = three_materials();
  materials[0].grain->cohesion_energy_density = 1000;
  materials[0].grain->rolling_friction = 0.25;
  const std::string means = commands(materials, settings);
  EXPECT_NE(means.find("coefficientRestitution peratomtypepair 2 0.5 0.59999999999999998 0.59999999999999998 "
                       "0.69999999999999996\n"),
            std::string::npos)
      << means;
  EXPECT_NE(means.find("cohesionEnergyDensity peratomtypepair 2 1000 500 500 0\n"), std::string::npos)
      << means;
  settings.options.pairs = {{.materials = {0, 2}, .restitution = 0.125, .cohesion_energy_density = 64}};
  const std::string given = commands(materials, settings);
  EXPECT_NE(given.find("coefficientRestitution peratomtypepair 2 0.5 0.125 0.125 0.69999999999999996\n"),
            std::string::npos)
      << given;
  EXPECT_NE(given.find("cohesionEnergyDensity peratomtypepair 2 1000 64 64 0\n"), std::string::npos) << given;
  EXPECT_NE(given.find("0.59999999999999998 0.59999999999999998 0.5\n"), std::string::npos)
      << "friction is the mean still";
  settings.options.pairs[0] = {.materials = {0, 2}, .rolling_friction = 0.75};
  EXPECT_NE(commands(materials, settings)
                .find("coefficientRollingFriction peratomtypepair 2 0.25 0.75 0.75 0.20000000000000001\n"),
            std::string::npos);
}

TEST(Script, ModelsAreThoseThatWereChosen) {
  const auto model_of = [](const DemSettings& settings) {
    const std::string text = commands(three_materials(), settings);
    const std::size_t from = text.find("pair_style ");
    return text.substr(from, text.find('\n', from) - from);
  };
  DemSettings settings = settings_in_box(0.1);
  EXPECT_EQ(model_of(settings), "pair_style gran model hertz tangential history");
  settings.rolling_resistance = true;
  settings.options.rolling = RollingModel::cdt;
  EXPECT_EQ(model_of(settings), "pair_style gran model hertz tangential history rolling_friction cdt");
  settings.cohesion = true;
  settings.options.contact = GrainContact::hooke;
  settings.options.characteristic_velocity = 1.5;
  EXPECT_EQ(model_of(settings),
            "pair_style gran model hooke tangential history cohesion sjkr rolling_friction cdt");
  EXPECT_NE(commands(three_materials(), settings).find("characteristicVelocity scalar 1.5\n"),
            std::string::npos);
}

TEST(Script, PlasticSpringsHaveTheirThreeNumbersForEveryPair) {
  DemSettings settings = settings_in_box(0.1);
  settings.options.contact = GrainContact::hooke_hysteresis;
  settings.options.characteristic_velocity = 1.5;
  settings.options.unloading_ratio = 4, settings.options.plastic_depth = 0.25,
  settings.options.adhesion_ratio = 0.5;
  const std::string text = commands(three_materials(), settings);
  for (const char* line : {"pair_style gran model hooke/hysteresis tangential history\n",
                           "coefficientMaxElasticStiffness peratomtypepair 2 4 4 4 4\n",
                           "coefficientPlasticityDepth peratomtypepair 2 0.25 0.25 0.25 0.25\n",
                           "coefficientAdhesionStiffness peratomtypepair 2 0.5 0.5 0.5 0.5\n",
                           "characteristicVelocity scalar 1.5\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
}

TEST(Script, SoftAndHardGrainsAreAnnounced) {
  const DemSettings settings = settings_in_box(0.1);
  auto materials = three_materials();
  EXPECT_EQ(commands(materials, settings).find("_particles"), std::string::npos);
  materials[0].grain->young_modulus = 1e6;
  EXPECT_NE(commands(materials, settings).find("soft_particles yes"), std::string::npos);
  materials[2].grain->young_modulus = 48e9;
  EXPECT_NE(commands(materials, settings).find("hard_particles yes"), std::string::npos);
}

TEST(Script, RollingResistanceThatIsOffIsNotThere) {
  DemSettings settings = settings_in_box(0.1);
  EXPECT_EQ(commands(three_materials(), settings).find("olling"), std::string::npos);
  settings.rolling_resistance = true;
  EXPECT_NE(commands(three_materials(), settings).find("rolling_friction epsd2"), std::string::npos);
}

TEST(Script, FreshAndContinuedRunsDifferInTheirSourceOnly) {
  const DemSettings settings = settings_in_box(0.1);
  std::string fresh = commands(three_materials(), settings);
  std::string resumed =
      set_up_commands("read_restart grains", {0, 2}, three_materials(), settings, {10, 0.001, 0.002}, 1e-6);
  const auto cut = [](std::string& text) {
    text.erase(text.find("read_"), text.find("neighbor") - text.find("read_"));
  };
  cut(fresh);
  cut(resumed);
  EXPECT_EQ(fresh, resumed);
}

TEST(Script, DataFileGivesPositionsBackToTheBit) {
  ShakenBlock block(3);
  for (std::size_t i = 0; i < block.grains.size(); ++i)
    block.grains.position.x[i] += 1e-5 / (3.0 + static_cast<double>(i));
  const auto bytes = data_file(block.grains, {0}, {Vec3(-1, -1, -1), Vec3(1, 1, 1)});
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  std::string line;
  while (std::getline(stream, line) && line != "Atoms") {
  }
  std::getline(stream, line);
  for (std::size_t i = 0; i < block.grains.size(); ++i) {
    ASSERT_TRUE(std::getline(stream, line));
    std::istringstream words(line);
    std::string id, type, diameter, density, x, y, z;
    words >> id >> type >> diameter >> density >> x >> y >> z;
    EXPECT_EQ(id, std::to_string(i + 1));
    EXPECT_EQ(std::strtod(diameter.c_str(), nullptr), 2 * block.grains.radius[i]);
    EXPECT_EQ(std::strtod(x.c_str(), nullptr), block.grains.position.x[i]);
    EXPECT_EQ(std::strtod(z.c_str(), nullptr), block.grains.position.z[i]);
  }
}

/// Spheres are moved by the bridge.
TEST(Script, IntegratesClumpsAsBodiesAndNothingElse) {
  const DemSettings settings = settings_in_box(0.1);
  const auto materials = three_materials();
  const std::string spheres = commands(materials, settings);
  for (const char* word : {"nve", "multisphere", "group"}) EXPECT_EQ(spheres.find(word), std::string::npos);
  const auto with = [&](const std::vector<bool>& clumped) {
    return set_up_commands("read_data grains", {0, 2}, materials, settings, {10, 0.001, 0.002}, 1e-6,
                           clumped);
  };
  EXPECT_EQ(with({false, false}), spheres);
  std::string clumps = spheres;
  clumps.insert(clumps.find("fix coupling"), "fix clumps all multisphere\n");
  EXPECT_EQ(with({true, true}), clumps);
  EXPECT_EQ(with({false, true}), clumps);
}

}  // namespace
}  // namespace tuft::dem::test
