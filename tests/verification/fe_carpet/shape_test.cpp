/// A shape carries how a carpet stands and how it is stressed to another carpet of the same mesh.
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/verification/fe_carpet/shaken.h"

namespace tuft::fe::test {
namespace {

constexpr double step = 2e-7;  // s

class Shape : public testing::TestWithParam<ElementKind> {
 protected:
  [[nodiscard]] std::unique_ptr<Carpet> strip(double failure_strain = 0) const {
    CarpetOptions options = no_gravity();
    options.section.element = GetParam();
    options.section.thickness_points = 3;
    ShellMaterial material = polyethylene();
    material.failure_strain = failure_strain;
    return std::make_unique<Carpet>(strip_.mesh, std::vector{material}, options);
  }
  /// On the tip, which bends the strip by more than a third of its length.
  [[nodiscard]] Vec3Array load(double newtons) const {
    Vec3Array force = no_load(strip_.node_count());
    for (Index j = 0; j <= 1; ++j)
      force.z[static_cast<std::size_t>(strip_.node(strip_.shape.along, j))] = 0.5 * newtons;
    return force;
  }
  [[nodiscard]] Vec3 tip(const Carpet& carpet) const {
    return position(carpet, strip_.node(strip_.shape.along, 0));
  }
  /// At rest under the load.
  [[nodiscard]] std::unique_ptr<Carpet> bent() const {
    auto carpet = strip();
    carpet->set_damping(2000);
    for (int i = 0; i < 90'000; ++i) carpet->step(step, load(0.001));
    carpet->stop();
    return carpet;
  }
  Strip strip_ = make_strip({0.008, 0.0013, 0.0001, 6, 1}, true);
};

TEST_P(Shape, IsAtRestUnderTheLoadThatBentItAndSpringsBackWithoutIt) {
  const auto original = bent();
  const Vec3 start = tip(*original);
  ASSERT_GT(start.z(), 0.0025);
  const auto copy = strip(), freed = strip();
  copy->take_shape(original->shape());
  freed->take_shape(original->shape());
  EXPECT_EQ(tip(*copy), start);
  EXPECT_EQ(copy->energy().strain, original->energy().strain);
  EXPECT_EQ(copy->energy().kinetic, 0);
  double moved = 0;
  original->set_damping(0);
  for (int i = 0; i < 5000; ++i) {
    original->step(step, load(0));
    freed->step(step, load(0));
    copy->step(step, load(0.001));
    moved = std::max(moved, (tip(*copy) - start).norm());
  }
  EXPECT_LT(moved, 1e-5 * start.z()) << "under its load";
  EXPECT_GT((tip(*freed) - start).norm(), 0.2 * start.z()) << "freed";
  // A carpet that was stopped begins with half a kick, one as built with a whole one.
  const auto end = static_cast<std::size_t>(strip_.node(strip_.shape.along, 0));
  const double in_a_step = step * std::abs(freed->nodes().vz[end]);
  EXPECT_LT((tip(*freed) - tip(*original)).norm(), in_a_step + 1e-5 * start.z()) << "freed, as the original";
}

/// Grains are laid among strands that cannot fail; in the run they may.
TEST_P(Shape, IsTakenByACarpetWhoseShellsCanFailAndWhichThenFails) {
  const auto original = bent();
  const auto copy = strip(0.02);
  copy->take_shape(original->shape());
  const Vec3 start = tip(*copy);
  for (int i = 0; i < 5000; ++i) copy->step(step, load(0.001));
  EXPECT_LT((tip(*copy) - start).norm(), 1e-5 * start.z());
  EXPECT_EQ(copy->eroded_count(), 0u);
  const CarpetShape again = copy->shape();
  EXPECT_EQ(again.position.size(), strip_.node_count());
  EXPECT_EQ(again.element_state.size(), original->shape().element_state.size());
  for (int i = 0; i < 20'000 && copy->eroded_count() == 0; ++i) copy->step(step, load(2));
  EXPECT_GT(copy->eroded_count(), 0u) << "pulled";
  EXPECT_NEAR(copy->energy().balance(), original->energy().strain + original->energy().hourglass,
              1e-3 * std::abs(copy->energy().external_work));
}

INSTANTIATE_TEST_SUITE_P(Elements, Shape,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& element) { return name_of(element.param); });

TEST(ShapeErrors, AShapeThatDoesNotFitIsRefusedAndNoneIsTakenUnderWay) {
  const Carpet turf(small_turf(0.02), turf_materials(), no_gravity());
  Carpet other(small_turf(0.03), turf_materials(), no_gravity());
  EXPECT_THROW(other.take_shape(turf.shape()), RunError);
  Carpet moving(small_turf(0.02), turf_materials(), no_gravity());
  run_turf(moving, 0, 1);
  EXPECT_THROW(moving.take_shape(turf.shape()), std::logic_error);
  Carpet none(ShellMesh{}, {}, no_gravity());
  none.take_shape(Carpet(ShellMesh{}, {}, no_gravity()).shape());
}

}  // namespace
}  // namespace tuft::fe::test
