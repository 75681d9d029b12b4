#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/unit/sph_infill/sph_test_support.h"

namespace tuft::sph {
namespace {

constexpr double pitch = 0.002;

SphSettings settings_of() {
  SphSettings settings;
  settings.options = test::options_of(test::Preset::accurate, pitch);
  return settings;
}

template <class Error, class Action>
void expect_error(Action&& action, const std::vector<std::string>& words) {
  try {
    action();
    FAIL() << "no error, expected: " << words.front();
  } catch (const Error& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(SphGuards, NanVelocityStopsTheRunNamingParticleTimeAndField) {
  SphInfill infill(test::block(6, 6, 6, pitch), test::single_material(test::mixture_material()),
                   settings_of());
  infill.set_velocity(17, {0, std::nan(""), 0});
  expect_error<RunError>([&] { infill.advance(1e-5, 3, {}); },
                         {"particle 17 ", "t = 0 s", "velocity", "nan"});
}

TEST(SphGuards, NonFiniteContactImpulseIsCaughtInTheStepItCameIn) {
  SphInfill infill(test::block(6, 6, 6, pitch), test::single_material(test::mixture_material()),
                   settings_of());
  infill.advance(2e-5, 2, {});
  ContactImpulses contact;
  contact.linear.assign(216, 0);
  contact.linear.z[101] = std::numeric_limits<double>::infinity();
  expect_error<RunError>([&] { infill.advance(1e-5, 1, contact); },
                         {"particle 101 ", "t = 2e-05 s", "velocity"});
}

TEST(SphGuards, AbsurdDensityStopsTheRunNamingParticleAndRatio) {
  // Where nothing tears: a torn particle's density stops at a half, see soil_update.h.
  SphSettings settings = settings_of();
  settings.tension_cutoff = false;
  SphInfill infill(test::block(6, 6, 6, pitch), test::single_material(test::mixture_material()), settings);
  const ParticleView p = infill.particles();
  for (std::size_t i = 0; i < p.size(); ++i) infill.set_velocity(i, 1e5 * p.position(i));  // blown apart
  expect_error<RunError>([&] { infill.advance(2e-4, 40, {}); }, {"particle 0 ", "density is ", "[0.2, 5]"});
}

TEST(SphGuards, RejectsWhatCannotBeAdvanced) {
  SphInfill infill(test::block(4, 4, 4, pitch), test::single_material(test::mixture_material()),
                   settings_of());
  ContactImpulses too_few;
  too_few.linear.assign(63, 0);
  expect_error<RunError>([&] { infill.advance(1e-5, 1, too_few); },
                         {"contact impulses for 63 particles", "64"});
  expect_error<RunError>([&] { infill.advance(0, 1, {}); }, {"window of 0 s"});
  expect_error<RunError>([&] { infill.advance(1e-5, 0, {}); }, {"0 substeps"});
  expect_error<InputError>([&] { infill.set_damping(-1); }, {"damping rate", "-1"});
}

TEST(SphGuards, RejectsMaterialsItCannotUse) {
  auto materials = test::single_material(test::mixture_material());
  const auto build = [&] { SphInfill(test::block(4, 4, 4, pitch), materials, settings_of()); };
  materials[0].continuum->shear_ratio = 0;
  expect_error<InputError>(build, {"test.toml", "\"test\"", "shear_ratio is 0"});
  materials[0].continuum.reset();
  expect_error<InputError>(build, {"test.toml", "\"test\"", "no [continuum] block"});
  materials.clear();
  expect_error<InputError>(build, {"material number 0"});
}

TEST(SphGuards, RejectsSettingsItCannotUse) {
  const auto materials = test::single_material(test::mixture_material());
  SphSettings settings = settings_of();
  settings.options.smoothing_length = 0;
  expect_error<InputError>([&] { SphInfill(test::block(4, 4, 4, pitch), materials, settings); },
                           {"smoothing_length is 0"});
  Lattice broken = test::block(4, 4, 4, pitch);
  broken.position.y[5] = std::nan("");
  expect_error<InputError>([&] { SphInfill(broken, materials, settings_of()); }, {"particle 5 ", "nan"});
}

}  // namespace
}  // namespace tuft::sph
