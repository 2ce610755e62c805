// Rationale: a few stored spectra give the covariance of what any two filters see of a background.
// Expected: fields of known weights and spectra, whose covariance follows by hand.
// Source: S^T Cov(weights) S, as written in core/clutter/clutter_modes.h.

#include "core/clutter/clutter_modes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/clutter/clutter.h"
#include "core/clutter/symmetric_eigen.h"

namespace irsig {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

double covariance(const SpectralSet& modes_a, const std::vector<double>& a,
                  const SpectralSet& modes_b, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < modes_a.size(); ++k) sum += dot(modes_a[k], a) * dot(modes_b[k], b);
  return sum;
}

// Fractions of independent pixels: of sources 0 and 1 together 1, source 2 by itself.
ClutterField random_field(std::size_t size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  ClutterField out{size, size, 1, 4, {}};
  for (std::size_t p = 0; p < size * size; ++p) {
    const double w = uniform(random);
    out.weight.push_back(static_cast<float>(w));
    out.weight.push_back(static_cast<float>(1 - w));
    out.weight.push_back(static_cast<float>(1e-6 * normal(random)));
    out.weight.push_back(0.5F);  // everywhere alike
  }
  return out;
}

const SpectralSet kMid = {{1, 2, 3}, {2, 2, 2}, {1e6, 0, 0}, {9, 9, 9}};
const SpectralSet kLong = {{100, 120}, {90, 125}, {0, 1e6}, {7, 7}};

TEST(ClutterModes, CovarianceOfFiltersFollowsFromWeights) {
  const auto modes =
      clutter_modes(weight_factor(random_field(400, 1), 0), std::vector<SpectralSet>{kMid, kLong});
  ASSERT_EQ(modes.band.size(), 2U);
  ASSERT_EQ(modes.band[0].size(), modes.band[1].size());
  EXPECT_EQ(modes.band[0].size(), 2U);
  EXPECT_GE(modes.fraction[0], kClutterFraction);
  EXPECT_GE(modes.fraction[1], kClutterFraction);
  EXPECT_NEAR(modes.sigma[1][0], std::sqrt(100.0 / 12), 0.02 * modes.sigma[1][0]);
  // Variance 1/12 of the fraction, 1e-12 of source 2.
  const std::vector<double> d_mid = {-1, 0, 1}, d_long = {10, -5};
  const auto truth = [&](const std::vector<double>& a, const std::vector<double>& da, double sa,
                         const std::vector<double>& b, const std::vector<double>& db,
                         double sb) { return dot(a, da) * dot(b, db) / 12 + sa * sb; };
  const std::vector<double> f = {0.5, 1, 2}, g = {0.3, -0.1};
  EXPECT_NEAR(covariance(modes.band[0], f, modes.band[0], f) / truth(f, d_mid, 0.5, f, d_mid, 0.5),
              1, 0.02);
  EXPECT_NEAR(
      covariance(modes.band[1], g, modes.band[1], g) / truth(g, d_long, -0.1, g, d_long, -0.1), 1,
      0.02);
  EXPECT_NEAR(
      covariance(modes.band[0], f, modes.band[1], g) / truth(f, d_mid, 0.5, g, d_long, -0.1), 1,
      0.02);
}

// A band of little radiance keeps its own structure beside a bright one.
TEST(ClutterModes, EveryBandKeepsItsVariance) {
  SpectralSet dim = kMid;
  for (auto& spectrum : dim)
    for (double& v : spectrum) v *= 1e-5;
  dim[2] = {0, 300, 0};  // mostly of source 2
  const auto modes =
      clutter_modes(weight_factor(random_field(100, 2), 0), std::vector<SpectralSet>{dim, kLong});
  for (const double fraction : modes.fraction) EXPECT_GE(fraction, kClutterFraction);
  EXPECT_GT(covariance(modes.band[0], {0, 1, 0}, modes.band[0], {0, 1, 0}), 0.9 * 9e-8);
}

TEST(ClutterModes, AreThoseOfMeansOverSquares) {
  const ClutterField field = random_field(300, 3);
  // 4 x 4 independent pixels.
  const auto modes = clutter_modes(weight_factor(field, 16), std::vector<SpectralSet>{kMid});
  const std::vector<double> f = {1, 0.5, 0.25};
  std::vector<double> radiance;
  for (const auto& spectrum : kMid) radiance.push_back(dot(f, spectrum));
  const auto statistics = clutter_of(field, radiance, 16);
  const double sigma = std::sqrt(covariance(modes.band[0], f, modes.band[0], f));
  EXPECT_NEAR(sigma / statistics.patch_sigma.value, 1, 0.001);
  EXPECT_NEAR(sigma / statistics.sigma.value * 4, 1, 0.02);
}

TEST(ClutterModes, AreOrthogonalAndTheLargestFirst) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  ClutterField field{60, 60, 1, 12, {}};
  for (std::size_t p = 0; p < 3600 * 12; ++p)
    field.weight.push_back(static_cast<float>(normal(random)));
  SpectralSet spectra(12, std::vector<double>(20));
  for (std::size_t s = 0; s < 12; ++s)
    for (double& v : spectra[s]) v = normal(random) / static_cast<double>((s + 1) * (s + 1));
  const auto modes = clutter_modes(weight_factor(field, 0), std::vector<SpectralSet>{spectra});
  ASSERT_GE(modes.band[0].size(), 3U);
  EXPECT_LE(modes.band[0].size(), kMostClutterModes);
  for (std::size_t a = 0; a < modes.band[0].size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const auto &x = modes.band[0][a], &y = modes.band[0][b];
      EXPECT_NEAR(dot(x, y) / std::sqrt(dot(x, x) * dot(y, y)), 0, 1e-8);
      EXPECT_LE(dot(x, x), dot(y, y));
    }
}

// More sources than are summed side by side, and more pixels than are summed at once.
TEST(ClutterModes, FactorsMultiplyToTheCovariance) {
  constexpr std::size_t kSources = 70, kSide = 23, kPixels = kSide * kSide;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  ClutterField field{kSide, kSide, 1, kSources, {}};
  for (std::size_t p = 0; p < kPixels * kSources; ++p)
    field.weight.push_back(static_cast<float>(normal(random)));
  const SpectralSet factor = weight_factor(field, 0);
  const auto weight = [&](std::size_t p, std::size_t s) {
    return static_cast<double>(field.weight[p * kSources + s]);
  };
  std::vector<double> mean(kSources, 0.0);
  for (std::size_t s = 0; s < kSources; ++s)
    for (std::size_t p = 0; p < kPixels; ++p) mean[s] += weight(p, s) / kPixels;
  for (std::size_t s = 0; s < kSources; ++s)
    for (std::size_t t = 0; t <= s; ++t) {
      double expected = 0, product = 0;
      for (std::size_t p = 0; p < kPixels; ++p)
        expected += (weight(p, s) - mean[s]) * (weight(p, t) - mean[t]) / kPixels;
      for (const auto& f : factor) product += f[s] * f[t];
      ASSERT_NEAR(product, expected, 1e-12) << s << ' ' << t;
    }
}

// The factor of some sources is that of a field of them alone, to the last bit.
TEST(ClutterModes, SourcesThatDoNotShineChangeNothing) {
  const ClutterField all = random_field(40, 5);
  const std::vector<std::size_t> some = {2, 3, 0};
  ClutterField alone{40, 40, 1, some.size(), {}};
  for (std::size_t p = 0; p < all.pixels(); ++p)
    for (const std::size_t s : some) alone.weight.push_back(all.weight[p * all.sources + s]);
  EXPECT_EQ(WeightDeviations(all, 9).factor(some), weight_factor(alone, 9));
  EXPECT_EQ(weight_factor(alone, 9).front().size(), some.size());
}

TEST(ClutterModes, OneMaterialHasNone) {
  ClutterField field{8, 8, 1, 1, std::vector<float>(64, 1)};
  EXPECT_TRUE(weight_factor(field, 4).empty());
  const auto modes =
      clutter_modes(weight_factor(field, 4), std::vector<SpectralSet>{{{1, 2}}, {{3}}});
  ASSERT_EQ(modes.band.size(), 2U);
  EXPECT_TRUE(modes.band[0].empty());
  EXPECT_EQ(modes.fraction[1], 1);
  ClutterField pixel{1, 1, 1, 2, {0.25F, 0.75F}};
  EXPECT_TRUE(weight_factor(pixel, 4).empty());
}

// Sources of nearly equal radiance, a million times what tells them apart.
TEST(ClutterModes, NothingCancels) {
  ClutterField field{64, 64, 1, 2, {}};
  for (std::size_t p = 0; p < 4096; ++p) {
    const auto w = static_cast<float>(p % 2);
    field.weight.push_back(w);
    field.weight.push_back(1 - w);
  }
  const auto modes = clutter_modes(weight_factor(field, 0),
                                   std::vector<SpectralSet>{{{1e6, 1e6 + 1}, {1e6 + 2, 1e6 - 1}}});
  ASSERT_EQ(modes.band[0].size(), 1U);
  EXPECT_NEAR(std::abs(modes.band[0][0][0]), 1, 1e-6);
  EXPECT_NEAR(std::abs(modes.band[0][0][1]), 1, 1e-6);
}

TEST(ClutterModes, EigenvectorsDiagonalise) {
  const std::vector<std::vector<double>> m = {{4, 1, 0.5}, {1, 3, -1}, {0.5, -1, 2}};
  const auto e = symmetric_eigen(m, 1e-15);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(dot(m[i], e.vector[k]), e.value[k] * e.vector[k][i], 1e-12);
  EXPECT_GT(e.value[0], e.value[1]);
  EXPECT_GT(e.value[1], e.value[2]);
}

}  // namespace
}  // namespace irsig
