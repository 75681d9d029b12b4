/// A bed that falls into a box: through the bridge, its walls made by the driver, and by LIGGGHTS alone, its
/// walls made by LIGGGHTS (fix wall/gran). Walls are elastic and smooth, so that the driver can say their
/// Hertz force in a line.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "dem_bridge/hertz.h"
#include "dem_bridge/liggghts_script.h"
#include "tests/verification/dem_bridge/bridge_scene.h"

namespace tuft::dem::test {
namespace {

namespace fs = std::filesystem;

constexpr double half = 0.006, gravity = 9.81;  // m, half the box's width; m/s^2

/// Grains of 2 mm, 5 x 5 x 8 of them, apart from each other and off the lattice, with room to fall.
Grains loose_bed() {
  Grains grains;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) {
        const double a = i + 5 * j + 25 * k;
        const Vec3 shift = 1e-4 * Vec3(std::sin(1.7 * a), std::cos(2.3 * a), std::sin(0.9 * a + 1));
        add_grain(grains, 0.0023 * Vec3(i - 2, j - 2, k + 0.6) + shift,
                  0.001 - 2e-5 * (static_cast<int>(a) % 7), 1150);
      }
  return grains;
}

struct Motion {
  Vec3Array position, velocity;
};

Motion through_the_bridge(const Grains& grains, double dt, int steps) {
  DemInfill infill(grains, {rubber()}, settings_in_box(0.05, Vec3(0, 0, -gravity)));
  // LIGGGHTS begins with half a kick from v(0); the bridge's velocities are those of half a step before.
  for (std::size_t i = 0; i < grains.size(); ++i)
    infill.set_velocity(i, Vec3(0, 0, 0.5 * gravity * dt), Vec3(0, 0, 0));
  const double young = effective_young_modulus(8e6, 0.45, 8e6, 0.45);
  ContactImpulses contact = no_impulses(grains.size());
  for (int k = 0; k < steps; ++k) {
    const ParticleView view = infill.particles();
    for (std::size_t i = 0; i < view.size(); ++i) {
      const double r = view.radius[i];
      const auto wall = [&](double distance) {
        const double depth = r - distance;
        return depth > 0 ? 4.0 / 3 * young * std::sqrt(r) * depth * std::sqrt(depth) : 0.0;
      };
      contact.linear.set(i, dt * Vec3(wall(half + view.x[i]) - wall(half - view.x[i]),
                                      wall(half + view.y[i]) - wall(half - view.y[i]), wall(view.z[i])));
    }
    infill.advance(dt, 1, contact);
  }
  Motion motion;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    motion.position.push_back(infill.particles().position(i));
    motion.velocity.push_back(infill.particles().velocity(i));
  }
  return motion;
}

std::string script(const fs::path& data, const fs::path& dump, double dt, int steps) {
  // Type 2 is the walls: the same stuff, elastic and smooth against grains.
  std::ostringstream text;
  text.precision(17);
  text << "units si\natom_style granular\natom_modify map array\nboundary f f f\nnewton off\n"
       << "communicate single vel yes\nread_data " << data.string() << "\nneighbor 0.00025 bin\n"
       << "neigh_modify delay 0 every 1 check yes contact_distance_factor 1.02\n"
       << "fix m1 all property/global youngsModulus peratomtype 8e6 8e6\n"
       << "fix m2 all property/global poissonsRatio peratomtype 0.45 0.45\n"
       << "fix m3 all property/global coefficientRestitution peratomtypepair 2 0.5 1 1 1\n"
       << "fix m4 all property/global coefficientFriction peratomtypepair 2 0.6 0 0 0\n"
       << "pair_style gran model hertz tangential history\npair_coeff * *\ntimestep " << dt << "\n"
       << "fix integrate all nve/sphere\nfix weight all gravity " << gravity << " vector 0 0 -1\n";
  const auto wall = [&](const char* name, const char* plane, double at) {
    text << "fix " << name << " all wall/gran model hertz tangential history primitive type 2 " << plane
         << " " << at << "\n";
  };
  wall("floor", "zplane", 0);
  wall("x_low", "xplane", -half);
  wall("x_high", "xplane", half);
  wall("y_low", "yplane", -half);
  wall("y_high", "yplane", half);
  text << "dump motion all custom " << steps << " " << dump.string() << " id x y z vx vy vz\n"
       << "dump_modify motion format \"%d %.17g %.17g %.17g %.17g %.17g %.17g\"\n"
       << "thermo_style custom step\nthermo 1000000000\nrun " << steps << "\n";
  return text.str();
}

Motion alone(const Grains& grains, double dt, int steps) {
  const fs::path folder = fs::temp_directory_path() / ("liggghts-alone-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  // Two types, of which the grains are the first.
  const std::vector<std::uint8_t> data = data_file(grains, {0, 1}, host_domain(settings_in_box(0.05)));
  std::ofstream(folder / "one.data", std::ios::binary)
      .write(reinterpret_cast<const char*>(data.data()), static_cast<std::streamsize>(data.size()));
  std::ofstream(folder / "commands") << script(folder / "one.data", folder / "dump", dt, steps);
  const int code = std::system((std::string(LIGGGHTS_ALONE) + " " + (folder / "commands").string()).c_str());
  EXPECT_EQ(code, 0);
  Motion motion;
  motion.position.assign(grains.size(), std::nan(""));
  motion.velocity.assign(grains.size(), std::nan(""));
  std::ifstream dump(folder / "dump");
  bool wanted = false;
  for (std::string line; std::getline(dump, line);) {
    if (line.starts_with("ITEM: TIMESTEP")) {
      std::getline(dump, line);
      wanted = std::stol(line) == steps;
    }
    if (!line.starts_with("ITEM: ATOMS") || !wanted) continue;
    for (std::size_t n = 0; n < grains.size() && std::getline(dump, line); ++n) {
      std::istringstream values(line);
      std::size_t id = 0;
      Vec3 x, v;
      values >> id >> x.x() >> x.y() >> x.z() >> v.x() >> v.y() >> v.z();
      motion.position.set(id - 1, x);
      motion.velocity.set(id - 1, v);
    }
  }
  fs::remove_all(folder);
  return motion;
}

double farthest(const Motion& a, const Motion& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.position.size(); ++i)
    most = std::max(most, (a.position[i] - b.position[i]).norm());
  return most;
}

double mean_height(const Motion& m) {
  double sum = 0;
  for (const double z : m.position.z) sum += z;
  return sum / static_cast<double>(m.position.size());
}

TEST(ABedThatFallsIntoABox, MovesThroughTheBridgeAsByLiggghtsAlone) {
  const Grains grains = loose_bed();
  constexpr double dt = 5e-6;
  // 15 ms: it has landed and most grains have collided. What rounding adds grows with every collision after
  // that.
  const double apart = farthest(through_the_bridge(grains, dt, 3000), alone(grains, dt, 3000));
  EXPECT_LT(apart, 1e-9 * 0.001);
}

TEST(ABedThatFallsIntoABox, ComesToTheSameRestThroughTheBridgeAsByLiggghtsAlone) {
  const Grains grains = loose_bed();
  constexpr double dt = 1e-5;
  const Motion bridge = through_the_bridge(grains, dt, 15000), by_itself = alone(grains, dt, 15000);
  const double height = mean_height(by_itself);
  EXPECT_NEAR(mean_height(bridge), height, 0.03 * height);
}

}  // namespace
}  // namespace tuft::dem::test
