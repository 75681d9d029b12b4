/// Strips of a viscoelastic material, strained at once and held: both elements relax alike.
#include <gtest/gtest.h>

#include "fe_carpet/viscoelastic.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

/// So heavy that forces move its nodes by nothing: they go as they are told. Slit film otherwise.
ShellMaterial immovable() {
  ShellMaterial material{2 * 0.3273e9 * 1.42, 0.42, 1e17};
  material.relaxation = {{0.0663e9, 10}, {0.2e9, 1000}};
  return material;
}

/// Young's modulus once the shear modulus has relaxed to G, over the instantaneous one.
double uniaxial_share(double shear) {
  const ViscoelasticLaw law = viscoelastic_law(immovable());
  return 9 * law.bulk * shear / (3 * law.bulk + shear) / immovable().young_modulus;
}

class HeldStrip {
 public:
  explicit HeldStrip(const ShellSection& section) : carpet_(strip_.mesh, {immovable()}, options(section)) {
    // A curvature of 1e-8/m in the plane, within 1e-7 s.
    constexpr double curvature = 1e-8, dt = 1e-8;
    for (int i = 0; i < 10; ++i) {
      for (std::size_t n = 0; n < strip_.node_count(); ++n) {
        const double x = strip_.mesh.nodes.x[n], y = strip_.mesh.nodes.y[n] - 0.00065;
        carpet_.set_velocity(n, curvature * 1e7 * Vec3(-x * y, 0.5 * x * x, 0),
                             curvature * 1e7 * Vec3(0, 0, x));
      }
      carpet_.step(dt, load_);
    }
    first_ = hold(1, 1e-9);
  }
  /// The bending moment at the tip after more steps, over that at first.
  double share_after(int steps, double dt) { return hold(steps, dt) / first_; }
  [[nodiscard]] CarpetEnergy energy() const { return carpet_.energy(); }

 private:
  static CarpetOptions options(const ShellSection& section) {
    CarpetOptions options = no_gravity();
    options.section = section;
    return options;
  }
  double hold(int steps, double dt) {
    double moment = 0;
    for (int i = 0; i < steps; ++i) {
      for (std::size_t n = 0; n < strip_.node_count(); ++n)
        carpet_.set_velocity(n, Vec3(0, 0, 0), Vec3(0, 0, 0));
      carpet_.step(dt, load_);
      const NodeView v = carpet_.nodes();
      moment = 0;
      for (Index j = 0; j <= 1; ++j) {
        const auto n = static_cast<std::size_t>(strip_.node(4, j));
        moment += (strip_.mesh.nodes.y[n] - 0.00065) * v.mass[n] * v.vx[n] / dt;
      }
    }
    for (std::size_t n = 0; n < strip_.node_count(); ++n)
      carpet_.set_velocity(n, Vec3(0, 0, 0), Vec3(0, 0, 0));
    return moment;
  }

  Strip strip_ = make_strip({0.012, 0.0013, 0.0001, 4, 1}, false);
  Vec3Array load_ = no_load(strip_.node_count());
  Carpet carpet_;
  double first_ = 0;
};

TEST(HeldStrip, OneElementWideBentInItsPlaneRelaxesToTheSameShareWithBothElements) {
  ShellSection one, full;
  full.element = ElementKind::fully_integrated;
  full.thickness_points = 3;
  HeldStrip a(one), b(full);
  for (const auto& [steps, dt] : {std::pair{10, 1e-4}, {40, 1e-4}, {50, 1e-3}, {50, 1e-1}}) {
    const double of_one = a.share_after(steps, dt), of_full = b.share_after(steps, dt);
    RecordProperty("one_point_" + std::to_string(steps * dt), std::to_string(of_one));
    RecordProperty("fully_integrated_" + std::to_string(steps * dt), std::to_string(of_full));
    EXPECT_LT(of_one, 0.8);
    // The fully integrated element's fibres keep the instantaneous contraction: up to 0.6 % stiffer.
    EXPECT_NEAR(of_one / of_full, 1, 0.007) << steps * dt;
  }
  EXPECT_NEAR(a.share_after(1, 1e-3) / uniaxial_share(0.061e9), 1, 1e-3);
}

TEST(HeldStrip, HourglassModesOfTheOnePointElementRelaxByTheirCoefficientToo) {
  ShellSection section;
  section.hourglass_coefficient = 0.1;
  HeldStrip strip(section);
  EXPECT_NEAR(strip.share_after(50, 0.1) / uniaxial_share(0.061e9), 1, 1e-3);
}

TEST(HeldStrip, BooksTheWorkThatBentItAndNothingWhileItRelaxes) {
  const ShellSection section;
  HeldStrip strip(section);
  const double bent = strip.energy().strain + strip.energy().hourglass;
  EXPECT_GT(bent, 0);
  strip.share_after(50, 1e-3);
  EXPECT_NEAR((strip.energy().strain + strip.energy().hourglass) / bent, 1, 1e-3);
}

}  // namespace
}  // namespace tuft::fe::test
