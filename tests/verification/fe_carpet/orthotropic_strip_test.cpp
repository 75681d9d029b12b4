/// Strips of an orthotropic material turned against their sides, bent in their plane.
#include <gtest/gtest.h>

#include <numbers>

#include "fe_carpet/orthotropic.h"
#include "fe_carpet/relaxation.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

ShellMaterial cloth(double turned) {
  ShellMaterial material{200e6, 0.3, 950};
  material.across_young_modulus = 50e6;
  material.shear_modulus = 8e6;
  material.along = {std::cos(turned), std::sin(turned), 0};
  return material;
}

constexpr double length = 0.08, width = 0.004, thickness = 0.0005;  // m

/// Deflection in the plane under an end load over that of a beam with the modulus along the strip:
/// P L^3 / 3EI + 6/5 P L / GA, both moduli of the turned material.
double relative_deflection(double turned, ElementKind element, Index along, Index across, double skew) {
  Strip strip = make_strip({length, width, thickness, along, across}, true);
  // Parallelograms in the middle, both ends upright.
  for (Index i = 1; i < along; ++i)
    for (Index j = 0; j <= across; ++j) {
      const auto n = static_cast<std::size_t>(strip.node(i, j));
      strip.mesh.nodes.x[n] += skew * (strip.mesh.nodes.y[n] - width / 2);
    }
  const ShellMaterial material = cloth(turned);
  const OrthotropicLaw<double> law = orthotropic_law(material, turned);
  const double area = width * thickness, inertia = area * width * width / 12;
  const double per_force = length * length * length * law.s11 / (3 * inertia) + 1.2 * length * law.s66 / area;
  const double expected = 1e-4 * length, force = expected / per_force;
  CarpetOptions options = no_gravity();
  options.section.element = element;
  Carpet carpet(strip.mesh, {material}, options);
  const auto pull = [&](const NodeView& /*nodes*/, double share, Vec3Array& load, Vec3Array& /*moment*/) {
    for (Index j = 0; j <= across; ++j)
      load.y[static_cast<std::size_t>(strip.node(along, j))] =
          share * force / across * (j == 0 || j == across ? 0.5 : 1.0);
  };
  EXPECT_TRUE(relax(carpet, pull, {}).at_rest);
  double mean = 0;
  for (Index j = 0; j <= across; ++j)
    mean += (position(carpet, strip.node(along, j)) -
             strip.mesh.nodes[static_cast<std::size_t>(strip.node(along, j))])
                .y() /
            (across + 1);
  return mean / expected;
}

class TurnedStrip : public testing::TestWithParam<ElementKind> {};

constexpr double degree = std::numbers::pi / 180;

TEST_P(TurnedStrip, OneElementWideBendsInItsPlaneAsTheBeamOfItsModulus) {
  for (const double turned : {0.0, 30.0, 45.0, 60.0, 90.0}) {
    const double relative = relative_deflection(turned * degree, GetParam(), 20, 1, 0);
    RecordProperty("at_" + std::to_string(static_cast<int>(turned)), std::to_string(relative));
    EXPECT_NEAR(relative, 1, 0.02) << turned << " degrees";
  }
}

TEST_P(TurnedStrip, OfSkewElementsDoesTheSame) {
  for (const double turned : {0.0, 45.0, 90.0, 135.0}) {
    const double relative = relative_deflection(turned * degree, GetParam(), 20, 1, 0.3);
    RecordProperty("at_" + std::to_string(static_cast<int>(turned)), std::to_string(relative));
    EXPECT_NEAR(relative, 1, 0.03) << turned << " degrees";
  }
}

TEST_P(TurnedStrip, OfAFineMeshDoesTheSame) {
  const double relative = relative_deflection(45 * degree, GetParam(), 60, 3, 0);
  RecordProperty("fine", std::to_string(relative));
  EXPECT_NEAR(relative, 1, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Of, TurnedStrip,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& p) { return name_of(p.param); });

}  // namespace
}  // namespace tuft::fe::test
