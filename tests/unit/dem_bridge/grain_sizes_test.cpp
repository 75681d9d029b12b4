/// Distributions of grain sizes against closed forms, and what is drawn from them against the distributions.
#include "dem_bridge/grain_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/error.h"

namespace tuft::dem {
namespace {

constexpr double low = 0.5e-3, high = 2e-3, density = 1150;

GrainMaterial grains(SizeLaw law, SizeShares by) {
  GrainMaterial grain;
  grain.density = density;
  grain.diameter_min = low;
  grain.diameter_max = high;
  grain.sizes.law = law;
  grain.sizes.by = by;
  if (law == SizeLaw::lognormal) {
    grain.sizes.median = 0.9e-3;
    grain.sizes.geometric_deviation = 1.5;
  }
  if (law == SizeLaw::sieve) grain.sizes.sieve = {{low, 0.8e-3, 1e-3, 1.4e-3, high}, {0, 0.1, 0.1, 0.7, 1}};
  return grain;
}

/// What the law says of its own shares, written out here: finer than d.
double own_shares_below(const GrainMaterial& grain, double d) {
  const GrainSizes& sizes = grain.sizes;
  if (sizes.law == SizeLaw::uniform) return (d - low) / (high - low);
  if (sizes.law == SizeLaw::lognormal) {
    const auto normal = [&](double x) {
      return 0.5 * (1 + std::erf(std::log(x / sizes.median) / std::log(sizes.geometric_deviation) /
                                 std::numbers::sqrt2));
    };
    return (normal(d) - normal(low)) / (normal(high) - normal(low));
  }
  for (std::size_t i = 1; i < sizes.sieve.x.size(); ++i) {
    const double from = sizes.sieve.x[i - 1], to = sizes.sieve.x[i];
    if (d <= to)
      return sizes.sieve.y[i - 1] +
             (sizes.sieve.y[i] - sizes.sieve.y[i - 1]) * std::log(d / from) / std::log(to / from);
  }
  return 1;
}

constexpr SizeLaw laws[] = {SizeLaw::uniform, SizeLaw::lognormal, SizeLaw::sieve};
constexpr SizeShares kinds_of_shares[] = {SizeShares::number, SizeShares::mass};

void for_all_laws(const std::function<void(const GrainMaterial&)>& check) {
  for (const SizeLaw law : laws)
    for (const SizeShares by : kinds_of_shares) {
      SCOPED_TRACE(::testing::Message() << "law " << static_cast<int>(law) << " by " << static_cast<int>(by));
      check(grains(law, by));
    }
}

double sphere_mass(double diameter) {
  return density * std::numbers::pi / 6 * std::pow(diameter, 3);
}

TEST(GrainSizes, SharesAreThoseOfTheLawByItsOwnMeasure) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution sizes(grain, 1);
    for (double d = low; d <= high; d *= 1.07) {
      const double share = grain.sizes.by == SizeShares::mass ? sizes.mass_below(d) : sizes.number_below(d);
      EXPECT_NEAR(share, own_shares_below(grain, d), 1e-13) << d;
    }
  });
}

TEST(GrainSizes, MassIsTheNumberWeightedByTheCube) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution sizes(grain, 1);
    constexpr int steps = 20000;
    double cubes = 0, at_half = 0;
    const double middle = 1.1e-3;
    for (int i = 0; i < steps; ++i) {
      const double a = low + (high - low) * i / steps, b = low + (high - low) * (i + 1) / steps;
      cubes += std::pow(0.5 * (a + b), 3) * (sizes.number_below(b) - sizes.number_below(a));
      if (b <= middle) at_half = cubes;
    }
    EXPECT_NEAR(sizes.mean_cube(), cubes, 1e-6 * cubes);
    EXPECT_NEAR(sizes.mass_below(middle), at_half / cubes, 2e-4);
  });
}

TEST(GrainSizes, DiameterOfAShareInvertsTheNumbers) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution sizes(grain, 1);
    EXPECT_DOUBLE_EQ(sizes.diameter_of(0), low);
    EXPECT_DOUBLE_EQ(sizes.diameter_of(1), high);
    for (double p = 1e-6; p < 1; p += 0.0137)
      EXPECT_NEAR(sizes.number_below(sizes.diameter_of(p)), p, 1e-12) << p;
  });
}

TEST(GrainSizes, LognormalByMassIsLognormalByNumberAtHatchAndChoatesMedian) {
  GrainMaterial grain = grains(SizeLaw::lognormal, SizeShares::mass);
  grain.diameter_min = 1e-6;
  grain.diameter_max = 1;  // hardly cut off
  const GrainSizeDistribution sizes(grain, 1);
  const double s = std::log(1.5);
  EXPECT_NEAR(sizes.mass_below(0.9e-3), 0.5, 1e-12);
  EXPECT_NEAR(sizes.number_below(0.9e-3 * std::exp(-3 * s * s)), 0.5, 1e-12);
  EXPECT_NEAR(sizes.mean_cube(), std::pow(0.9e-3, 3) * std::exp(-4.5 * s * s), 1e-12 * std::pow(0.9e-3, 3));
}

TEST(GrainSizes, LognormalCutOffFarInItsTailsIsStillInverted) {
  for (const double median : {0.1e-3, 20e-3}) {
    GrainMaterial grain = grains(SizeLaw::lognormal, SizeShares::number);
    grain.sizes.median = median;
    grain.sizes.geometric_deviation = 1.3;  // 6 and 9 deviations away
    const GrainSizeDistribution sizes(grain, 1);
    for (double p = 0.001; p < 1; p += 0.0173)
      EXPECT_NEAR(sizes.number_below(sizes.diameter_of(p)), p, 1e-9) << median << " " << p;
  }
}

TEST(GrainSizes, CoarseGrainingScalesEveryDiameter) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution fine(grain, 1), coarse(grain, 2.5);
    for (double p = 0; p <= 1; p += 0.05)
      EXPECT_NEAR(coarse.diameter_of(p), 2.5 * fine.diameter_of(p), 1e-12 * high) << p;
    EXPECT_NEAR(coarse.mean_cube(), std::pow(2.5, 3) * fine.mean_cube(), 1e-12 * std::pow(5e-3, 3));
  });
}

TEST(GrainSizes, GrainsOfOneSizeAreAllOfIt) {
  GrainMaterial grain = grains(SizeLaw::uniform, SizeShares::mass);
  grain.diameter_max = low;
  const GrainSizeDistribution sizes(grain, 1);
  const auto drawn = quota_diameters(sizes, 10.2 * sphere_mass(low), density);
  EXPECT_EQ(drawn, std::vector<double>(10, low));
}

/// Largest difference between the steps of a sample (rising) and a curve.
double kolmogorov_distance(const std::vector<double>& sample, const std::function<double(double)>& curve) {
  double distance = 0;
  const auto n = static_cast<double>(sample.size());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double share = curve(sample[k]);
    distance =
        std::max({distance, share - static_cast<double>(k) / n, static_cast<double>(k + 1) / n - share});
  }
  return distance;
}

TEST(DrawnGrains, NumbersFollowTheCurveWithinOneGrainOfAll) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution sizes(grain, 1);
    const double mean = sphere_mass(std::cbrt(sizes.mean_cube()));
    for (const double count : {10.0, 100.0, 3000.0}) {
      const auto drawn = quota_diameters(sizes, count * mean, density);
      EXPECT_EQ(drawn.size(), static_cast<std::size_t>(count));
      EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
      EXPECT_LE(kolmogorov_distance(drawn, [&](double d) { return sizes.number_below(d); }),
                (1 + 1e-9) / count);
    }
  });
}

TEST(DrawnGrains, WeighWhatIsAskedFor) {
  for_all_laws([](const GrainMaterial& grain) {
    const GrainSizeDistribution sizes(grain, 1);
    const double mean = sphere_mass(std::cbrt(sizes.mean_cube()));
    // The sieve curve has a gap from 0.8 to 1 mm: one grain is on the one side of it or on the other.
    const bool gap = grain.sizes.law == SizeLaw::sieve;
    const double across_gap = gap ? 0.5 * (sphere_mass(1e-3) - sphere_mass(0.8e-3)) : 0;
    for (double mass = 0.02 * mean; mass < 1000 * mean; mass *= 1.31) {
      double sum = 0;
      for (const double d : quota_diameters(sizes, mass, density)) sum += sphere_mass(d);
      const double handful = 0.5 * mean * (1 + 1e-9);
      EXPECT_NEAR(sum, mass, mass > 20 * mean ? std::max(1e-9 * mass, across_gap) : handful) << mass / mean;
    }
    EXPECT_TRUE(quota_diameters(sizes, 0.49 * sphere_mass(low), density).empty());
  });
}

TEST(DrawnGrains, SievedGiveTheCurveTheyWereDrawnFrom) {
  for (const SizeShares by : kinds_of_shares) {
    const GrainMaterial grain = grains(SizeLaw::sieve, by);
    const double mass = 2e-3;  // kg, some thousand grains
    const auto drawn = quota_diameters(GrainSizeDistribution(grain, 1), mass, density);
    ASSERT_GT(drawn.size(), 1000u);
    const Curve& curve = grain.sizes.sieve;
    double largest_error = 0;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      double passing = 0;
      for (const double d : drawn)
        if (d <= curve.x[i] * (1 + 1e-12))
          passing += by == SizeShares::mass ? sphere_mass(d) / mass : 1.0 / static_cast<double>(drawn.size());
      largest_error = std::max(largest_error, std::abs(passing - curve.y[i]));
    }
    const double one_grain =
        by == SizeShares::mass ? sphere_mass(high) / mass : 1.0 / static_cast<double>(drawn.size());
    EXPECT_LE(largest_error, 1.01 * one_grain);
    RecordProperty(by == SizeShares::mass ? "by_mass" : "by_number", std::to_string(largest_error));
  }
}

TEST(GrainSizes, LawsThatAreNoneAreRefused) {
  const auto refused = [](const std::function<void(GrainMaterial&)>& spoil, SizeLaw law) {
    GrainMaterial grain = grains(law, SizeShares::mass);
    spoil(grain);
    try {
      (void)GrainSizeDistribution(grain, 1);
    } catch (const InputError&) {
      return true;
    }
    return false;
  };
  for (const SizeLaw law : laws) EXPECT_FALSE(refused([](GrainMaterial&) {}, law));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.diameter_min = 0; }, SizeLaw::uniform));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.diameter_max = 0.1e-3; }, SizeLaw::uniform));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.sizes.median = 0; }, SizeLaw::lognormal));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.sizes.geometric_deviation = 1; }, SizeLaw::lognormal));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.sizes.sieve = {}; }, SizeLaw::sieve));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.sizes.sieve.y[1] = 0.3; }, SizeLaw::sieve));
  EXPECT_TRUE(refused([](GrainMaterial& g) { g.sizes.sieve.x[1] = 1.1e-3; }, SizeLaw::sieve));
}

}  // namespace
}  // namespace tuft::dem
