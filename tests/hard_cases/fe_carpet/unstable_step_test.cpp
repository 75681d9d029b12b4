// A step 5 % over the limit, and who stops it: the shells' own guard, and the run's energy ledger.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "core/error.h"
#include "core/scene.h"
#include "coupler/carpet_terms.h"
#include "coupler/energy_ledger.h"
#include "tests/verification/fe_carpet/linear_model.h"
#include "tests/verification/fe_carpet/strip.h"

namespace tuft::fe::test {
namespace {

/// A free strip of four shells that swings in bending: slow against the step, so that the balance closes by
/// itself. An unstable mode grows from rounding by a factor of 1.9 a step.
class StepOverTheLimit : public testing::TestWithParam<ElementKind> {
 protected:
  StepOverTheLimit() : strip_(make_strip({0.012, 0.003, 0.0001, 4, 1}, false)) {
    section_.element = GetParam();
  }

  /// s, of the mesh's fastest mode; the shells' own estimate is on the safe side of it.
  [[nodiscard]] double true_limit() const {
    return 2 /
           std::sqrt(LinearModel(strip_.mesh, {polyethylene()}, section_).largest_frequency_squared(3000));
  }

  /// What stopped the steps, and after how many; empty: nothing did.
  struct Stop {
    std::string text;
    int steps = 0;
  };
  /// `after_step` sees the carpet and the time after each step.
  [[nodiscard]] Stop run(double dt, int steps,
                         const std::function<void(const Carpet&, double)>& after_step) const {
    CarpetOptions options = no_gravity();
    options.section = section_;
    Carpet carpet(strip_.mesh, {polyethylene()}, options);
    for (std::size_t n = 0; n < strip_.node_count(); ++n) {
      const double x = 2 * strip_.mesh.nodes.x[n] / 0.012 - 1;
      constexpr double bend = 0.1;  // m/s; turned along, or all of it would go into shear
      carpet.set_velocity(n, Vec3(0, 0, bend * (x * x - 1.0 / 3)), Vec3(0, -bend * 4 * x / 0.012, 0));
    }
    const Vec3Array load = no_load(strip_.node_count());
    Stop stop;
    try {
      for (; stop.steps < steps; ++stop.steps) {
        carpet.step(dt, load);
        after_step(carpet, (stop.steps + 1) * dt);
      }
    } catch (const RunError& error) {
      stop.text = error.what();
    }
    return stop;
  }

  /// As a run that has nothing but this carpet keeps it, a row every so many steps, at its default limit.
  struct Kept {
    coupler::EnergyLedger ledger{Numerics{}.energy_error_limit, 0};
    Stop stop;
  };
  [[nodiscard]] Kept run_with_ledger(double dt, int steps, int every) const {
    Kept kept;
    int step = 0;
    kept.stop = run(dt, steps, [&](const Carpet& carpet, double time) {
      if (step++ % every == 0)
        kept.ledger.enter(time, coupler::terms_of(carpet.energy()),
                          [] { return std::string("node 0 is fastest"); });
    });
    return kept;
  }

 private:
  Strip strip_;
  ShellSection section_;
};

TEST_P(StepOverTheLimit, ByFivePercentIsStoppedByTheShellsThemselvesWhichNameAnElementOrNode) {
  const Stop stop = run(1.05 * true_limit(), 20000, [](const Carpet&, double) {});
  EXPECT_TRUE(stop.text.find("element ") != std::string::npos || stop.text.find("node ") != std::string::npos)
      << stop.text;
}

TEST_P(StepOverTheLimit, ByFivePercentIsStoppedByTheEnergyLedgerBeforeTheShellsThemselvesWould) {
  ASSERT_EQ(Numerics{}.energy_error_limit, 0.05);
  const double dt = 1.05 * true_limit();
  const int of_shells = run(dt, 20000, [](const Carpet&, double) {}).steps;
  for (const int every : {1, 6}) {  // a run looks once a history row, 6 steps in inputs/clegg_small.toml
    const Kept kept = run_with_ledger(dt, 20000, every);
    EXPECT_NE(kept.stop.text.find("passes numerics.energy_error_limit (5 %)"), std::string::npos)
        << every << ": " << kept.stop.text;
    EXPECT_LT(kept.stop.steps, of_shells) << every;
  }
}

TEST_P(StepOverTheLimit, ByMinusFivePercentIsNoneAndTheLedgerStaysClosed) {
  const Kept kept = run_with_ledger(0.95 * true_limit(), 20000, 1);
  EXPECT_EQ(kept.stop.text, "");
  EXPECT_EQ(kept.stop.steps, 20000);
  EXPECT_LT(kept.ledger.largest_error(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Of, StepOverTheLimit,
                         testing::Values(ElementKind::one_point, ElementKind::fully_integrated),
                         [](const auto& p) { return name_of(p.param); });

}  // namespace
}  // namespace tuft::fe::test
