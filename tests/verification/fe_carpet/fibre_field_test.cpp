/// The field of 50 000 fibre shells that speeds are measured on, thrown hard.
#include <gtest/gtest.h>

#include "bench/fibre_field.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

class FibreField : public testing::TestWithParam<ShellSection> {};

TEST_P(FibreField,
       OfFiftyThousandRelaxingShellsThrownAtFiveMetresPerSecondKeepsItsEnergyAllAlongAtTheDefaultStep) {
  const ShellMesh mesh = bench::fibre_field();
  ASSERT_GE(mesh.quads.size(), 50000U);
  CarpetOptions options;
  options.section = GetParam();
  const ShellMaterial slit_film = bench::field_case(3).material;
  ASSERT_FALSE(slit_film.relaxation.empty());
  Carpet carpet(mesh, {slit_film}, options);
  const double height = bench::element_length * bench::elements_per_strand;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    if (mesh.clamped[n]) continue;
    const double direction = 0.1 * static_cast<double>(n / (2 * (bench::elements_per_strand + 1)));
    carpet.set_velocity(n, mesh.nodes.z[n] / height * 5 * Vec3(std::cos(direction), std::sin(direction), 0),
                        Vec3(0, 0, 0));
  }
  const Vec3Array load = no_load(mesh.nodes.size());
  const double start = total(carpet.energy()), dt = Numerics{}.step_safety * carpet.stable_step();
  double largest = 0;
  for (int i = 1; i <= 3000; ++i) {
    carpet.step(dt, load);
    if (i % 20 == 0) largest = std::max(largest, std::abs(total(carpet.energy()) / start - 1));
  }
  EXPECT_LT(largest, 5e-4);
}

INSTANTIATE_TEST_SUITE_P(Of, FibreField,
                         testing::Values(ShellSection{ElementKind::one_point, 1},
                                         ShellSection{ElementKind::fully_integrated, 1},
                                         ShellSection{ElementKind::fully_integrated, 3}),
                         [](const auto& p) { return name_of(p.param); });

}  // namespace
}  // namespace tuft::fe::test
