#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/hdf5_file.h"
#include "tests/unit/fe_carpet/expect_error.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

Carpet strip_carpet(const CarpetOptions& options = no_gravity(),
                    const ShellMaterial& material = polyethylene()) {
  return Carpet(make_strip({}, true).mesh, {material}, options);
}

TEST(CarpetInput, UnusableMaterialsAreNamed) {
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    expect_error<InputError>([&] { strip_carpet(no_gravity(), {bad, 0.3, 900}); }, {"material 0", "Young"});
    expect_error<InputError>([&] { strip_carpet(no_gravity(), {1e9, 0.3, bad}); }, {"material 0", "density"});
  }
  for (const double bad : {0.5, -0.1, std::nan("")})
    expect_error<InputError>([&] { strip_carpet(no_gravity(), {1e9, bad, 900}); }, {"material 0", "Poisson"});
}

TEST(CarpetInput, AMaterialThatIsMissingNamesTheElement) {
  ShellMesh mesh = make_strip({}, true).mesh;
  mesh.material[3] = 1;
  expect_error<InputError>([&] { Carpet(mesh, {polyethylene()}, no_gravity()); },
                           {"element 3", "material 1"});
}

TEST(CarpetInput, UnusableOptionsAreNamed) {
  CarpetOptions options;
  options.section.thickness_points = 6;
  expect_error<InputError>([&] { strip_carpet(options); }, {"6 thickness points", "1 to 5"});
  options = {};
  options.section.hourglass_coefficient = 1.5;
  expect_error<InputError>([&] { strip_carpet(options); }, {"hourglass coefficient 1.5"});
  options = {};
  options.damping = -1;
  expect_error<InputError>([&] { strip_carpet(options); }, {"damping is -1"});
  Carpet carpet(make_strip({}, true).mesh, {polyethylene()}, no_gravity());
  expect_error<InputError>([&] { carpet.set_damping(std::nan("")); }, {"damping is nan"});
}

TEST(CarpetInput, CallsThatWouldBeIgnoredAreDefects) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  const Vec3 v(1, 0, 0);
  EXPECT_THROW(carpet.set_velocity(0, v, v), std::logic_error);  // clamped
  EXPECT_THROW(carpet.set_velocity(10000, v, v), std::logic_error);
  EXPECT_THROW(carpet.step(0, no_load(strip.node_count())), std::logic_error);
  EXPECT_THROW(carpet.step(1e-6, no_load(3)), std::logic_error);
  carpet.step(1e-6, no_load(strip.node_count()));
  EXPECT_THROW(carpet.set_position(5, v), std::logic_error);
}

TEST(CarpetInstability, ALoadThatIsNotFiniteNamesNodeAxisAndTime) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  Vec3Array load = no_load(strip.node_count());
  for (int i = 0; i < 10; ++i) carpet.step(1e-6, load);
  load.y[7] = std::nan("");
  expect_error<RunError>([&] { carpet.step(1e-6, load); }, {"load y on node 7", "nan", "t = 1e-05 s"});
}

TEST(CarpetInstability, ALoadOnAClampThatIsNotFiniteIsCaughtToo) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  Vec3Array load = no_load(strip.node_count());
  load.x[0] = std::numeric_limits<double>::infinity();
  expect_error<RunError>([&] { carpet.step(1e-6, load); }, {"load x on node 0", "inf"});
}

TEST(CarpetInstability, ANodeFasterThanSoundIsNamed) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  carpet.set_velocity(9, Vec3(0, 900, 0), Vec3(0, 0, 0));  // c = sqrt(E / (rho (1 - nu^2))) = 804 m/s
  expect_error<RunError>([&] { carpet.step(1e-9, no_load(strip.node_count())); },
                         {"node 9", "900 m/s", "804.4 m/s"});
}

TEST(CarpetInstability, ASpinThatOverflowsNamesTheNode) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  carpet.set_velocity(12, Vec3(0, 0, 0), Vec3(1e160, 0, 0));
  expect_error<RunError>([&] { carpet.step(1e-6, no_load(strip.node_count())); },
                         {"node 12", "angular velocity x"});
}

TEST(CarpetInstability, AnElementCrushedToNothingIsNamed) {
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  for (const Index corner : strip.mesh.quads[4])
    carpet.set_position(static_cast<std::size_t>(corner), Vec3(0.02, 0, 0));
  expect_error<RunError>([&] { carpet.step(1e-6, no_load(strip.node_count())); },
                         {"stress of element 4", "surface 0"});
}

TEST(CarpetCheckpoint, OfAnotherCarpetIsRefusedAndChangesNothing) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "tuft_fe_carpet_other.h5";
  {
    const Carpet other(make_strip({0.06, 0.0013, 0.0001, 11, 1}, true).mesh, {polyethylene()}, no_gravity());
    h5::File file = h5::File::create_atomically(path);
    h5::Group group = file.root().create_group("carpet");
    other.save(group);
    file.commit();
  }
  const Strip strip = make_strip({}, true);
  Carpet carpet(strip.mesh, {polyethylene()}, no_gravity());
  expect_error<InputError>([&] { carpet.load(h5::File::open(path).root().open_group("carpet")); },
                           {"position_x", "another scene"});
  EXPECT_EQ(position(carpet, 5), strip.mesh.nodes[5]);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace tuft::fe::test
