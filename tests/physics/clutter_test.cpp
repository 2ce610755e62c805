// Rationale: a background's structure becomes a few numbers with errors.
// Expected: closed forms of checkerboards, stripes and Gaussian random fields of a stated
// autocorrelation, whole and cut into two materials; scatter over seeds for the stated errors.
// Source: [vanmarcke1983] and arithmetic in this file.

#include "core/clutter/clutter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "core/clutter/lag_sums.h"

namespace irsig {
namespace {

constexpr double kPixel = 2.5;

// A field of one source, whose weights are the values.
ClutterField field_of(std::size_t columns, std::size_t rows,
                      const std::function<double(std::size_t, std::size_t)>& value) {
  ClutterField out{columns, rows, kPixel, 1, {}};
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) out.weight.push_back(static_cast<float>(value(c, r)));
  return out;
}

ClutterStatistics statistics(const ClutterField& field, double radiance = 1, double area_m2 = 0) {
  return clutter_of(field, std::vector<double>{radiance}, area_m2);
}

// White noise smoothed by exp(-2 r^2 / l^2): mean 0, sigma 1, autocorrelation exp(-r^2 / l^2). l_x
// and l_y in pixels.
std::vector<double> gaussian_field(std::size_t columns, std::size_t rows, double l_x, double l_y,
                                   unsigned seed) {
  const auto kernel = [](double l) {
    const auto reach = static_cast<int>(3 * l);
    std::vector<double> out;
    double squares = 0;
    for (int k = -reach; k <= reach; ++k) {
      out.push_back(std::exp(-2.0 * k * k / (l * l)));
      squares += out.back() * out.back();
    }
    for (double& v : out) v /= std::sqrt(squares);
    return out;
  };
  const auto x = kernel(l_x), y = kernel(l_y);
  const std::size_t wide = columns + x.size() - 1, high = rows + y.size() - 1;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> noise(wide * high), along(columns * high, 0.0), out(columns * rows, 0.0);
  for (double& v : noise) v = normal(random);
  for (std::size_t r = 0; r < high; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      for (std::size_t k = 0; k < x.size(); ++k)
        along[r * columns + c] += x[k] * noise[r * wide + c + k];
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < y.size(); ++k)
      for (std::size_t c = 0; c < columns; ++c)
        out[r * columns + c] += y[k] * along[(r + k) * columns + c];
  return out;
}

ClutterField gaussian(std::size_t size, double l, unsigned seed, double offset = 0) {
  const auto values = gaussian_field(size, size, l, l, seed);
  return field_of(size, size,
                  [&](std::size_t c, std::size_t r) { return offset + values[r * size + c]; });
}

// Scatter of means over squares of side d [px] of a field of sigma 1, along one axis:
// (1 / d^2) sum_{ij} exp(-(i - j)^2 / l^2).
double mean_over_side(std::size_t d, double l) {
  double sum = 0;
  for (std::size_t i = 0; i < d; ++i)
    for (std::size_t j = 0; j < d; ++j) {
      const double lag = static_cast<double>(i) - static_cast<double>(j);
      sum += std::exp(-lag * lag / (l * l));
    }
  return sum / static_cast<double>(d * d);
}

TEST(Clutter, CheckerboardHasItsSigma) {
  for (const std::size_t cell : {1U, 3U, 7U}) {
    const auto s = statistics(field_of(420, 420,
                                       [&](std::size_t c, std::size_t r) {
                                         return (c / cell + r / cell) % 2 == 0 ? 1 : 3;
                                       }),
                              10);
    EXPECT_NEAR(s.mean.value, 20, 1e-12);
    EXPECT_NEAR(s.sigma.value / 10, 1, 0.02) << cell;
    EXPECT_NEAR(s.skewness.value, 0, 1e-9);
    // Two values that are equally frequent are all as far from the mean.
    EXPECT_NEAR(s.sigma.stderr_, 0, 1e-9);
    // The autocorrelation is (1 - 2 |x| / a) (1 - 2 |y| / a) up to a cell, with a 0 at half of it.
    double area = 0;
    const double side = static_cast<double>(cell), cut = 0.5 * (side + 1);
    for (double y = -std::floor(cut); y <= cut; ++y)
      for (double x = -std::floor(cut); x <= cut; ++x)
        if (std::hypot(x, y) < cut)
          area += (1 - 2 * std::abs(x) / side) * (1 - 2 * std::abs(y) / side);
    EXPECT_NEAR(s.correlation_m.value / (kPixel * std::sqrt(area / std::numbers::pi)), 1, 0.02)
        << cell;
  }
}

TEST(Clutter, LongGaussianFieldIsRecovered) {
  // 12 600 cells: the statistics scatter by less than 0.9 %.
  constexpr double kLength = 6;
  constexpr std::size_t kSize = 1200, kSide = 10;
  const auto values = gaussian_field(kSize, kSize, kLength, kLength, 7);
  const auto s =
      statistics(field_of(kSize, kSize,
                          [&](std::size_t c, std::size_t r) { return 5 + values[r * kSize + c]; }),
                 2, kSide * kSide * kPixel * kPixel);
  EXPECT_NEAR(s.mean.value, 10, 4 * s.mean.stderr_);
  EXPECT_NEAR(s.sigma.value / 2, 1, 0.02);
  EXPECT_NEAR(s.skewness.value, 0, 0.06);
  EXPECT_NEAR(s.correlation_m.value / (kLength * kPixel), 1, 0.02);
  EXPECT_NEAR(s.cells / (kSize * kSize / (std::numbers::pi * kLength * kLength)), 1, 0.04);
  EXPECT_DOUBLE_EQ(s.patch_m, kSide * kPixel);
  EXPECT_NEAR(s.patch_sigma.value / (2 * mean_over_side(kSide, kLength)), 1, 0.02);
}

// Land seen at a low angle is shorter in the image than wide.
TEST(Clutter, AnisotropicFieldHasTheAreaOfItsEllipse) {
  const auto values = gaussian_field(1360, 680, 16, 2, 3);
  const auto s = statistics(
      field_of(1360, 680, [&](std::size_t c, std::size_t r) { return values[r * 1360 + c]; }));
  EXPECT_NEAR(s.correlation_m.value / (std::sqrt(16.0 * 2) * kPixel), 1, 0.02);
}

// Root mean squares of (estimate - truth) / stated error over seeds.
struct Scores {
  double sum[5] = {};
  int seeds = 0;
  void add(const ClutterStatistics& s, const std::array<double, 5>& truth) {
    const Estimate* of[] = {&s.mean, &s.sigma, &s.skewness, &s.correlation_m, &s.patch_sigma};
    for (std::size_t k = 0; k < 5; ++k) {
      const double z = (of[k]->value - truth[k]) / of[k]->stderr_;
      sum[k] += z * z;
    }
    ++seeds;
  }
  [[nodiscard]] double rms(std::size_t k) const { return std::sqrt(sum[k] / seeds); }
};
constexpr const char* kNames[] = {"mean", "sigma", "skewness", "correlation_m", "patch_sigma"};

TEST(Clutter, StatedErrorsCoverGaussianFields) {
  for (const auto& [size, length] : {std::pair{128U, 4.0}, {160U, 8.0}, {96U, 2.0}}) {
    Scores scores;
    constexpr std::size_t kSide = 6;
    for (unsigned seed = 1; seed <= 100; ++seed)
      scores.add(statistics(gaussian(size, length, seed, 20), 1, kSide * kSide * kPixel * kPixel),
                 {20, 1, 0, length * kPixel, mean_over_side(kSide, length)});
    for (std::size_t k = 0; k < 5; ++k) {
      std::printf("%u px, l = %g px, %s: rms z %.2f\n", size, length, kNames[k], scores.rms(k));
      EXPECT_GT(scores.rms(k), 0.7) << kNames[k] << " " << length;
      EXPECT_LT(scores.rms(k), 1.4) << kNames[k] << " " << length;
    }
  }
}

// Two materials, a fifth of the window the warm one: sigma^2 = p (1 - p), skewness (1 - 2 p) /
// sigma.
TEST(Clutter, StatedErrorsCoverTwoMaterials) {
  constexpr double kFraction = 0.2, kQuantile = 0.8416212335729143;
  Scores scores;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const auto values = gaussian_field(160, 160, 6, 6, seed);
    ClutterField field{160, 160, kPixel, 2, {}};
    for (const double v : values) {
      field.weight.push_back(v > kQuantile ? 1 : 0);
      field.weight.push_back(v > kQuantile ? 0 : 1);
    }
    const auto s = clutter_of(field, std::vector<double>{12, 10}, 0);
    const double sigma = std::sqrt(kFraction * (1 - kFraction));
    scores.add(s, {10 + 2 * kFraction, 2 * sigma, (1 - 2 * kFraction) / sigma, 1, 2 * sigma});
  }
  for (const std::size_t k : {0U, 1U, 2U, 4U}) {
    std::printf("two materials, %s: rms z %.2f\n", kNames[k], scores.rms(k));
    EXPECT_GT(scores.rms(k), 0.7) << kNames[k];
    EXPECT_LT(scores.rms(k), 1.4) << kNames[k];
  }
}

TEST(Clutter, ConstantFieldAndSinglePixelHaveNoScatter) {
  for (const auto& [columns, rows] : {std::pair{32U, 16U}, {1U, 1U}, {7U, 1U}}) {
    const auto s = statistics(field_of(columns, rows, [](auto, auto) { return 0.1; }), 3, 1e4);
    EXPECT_NEAR(s.mean.value, 0.3, 1e-7);
    for (const Estimate& e : {s.sigma, s.skewness, s.correlation_m, s.patch_sigma}) {
      EXPECT_EQ(e.value, 0);
      EXPECT_EQ(e.stderr_, 0);
    }
    EXPECT_EQ(s.mean.stderr_, 0);
    EXPECT_EQ(s.cells, 1);
  }
}

TEST(Clutter, EveryShapeHasFiniteNumbers) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const std::size_t columns : {1U, 2U, 3U, 17U})
    for (const std::size_t rows : {1U, 2U, 5U})
      for (const double scale : {1.0, 1e-200})
        for (const double area_m2 : {0.0, 30.0, 1e6}) {
          const auto s = statistics(
              field_of(columns, rows, [&](auto, auto) { return normal(random); }), scale, area_m2);
          for (const Estimate& e : {s.mean, s.sigma, s.skewness, s.correlation_m, s.patch_sigma}) {
            EXPECT_TRUE(std::isfinite(e.value) && std::isfinite(e.stderr_)) << columns << rows;
            EXPECT_GE(e.stderr_, 0);
          }
          EXPECT_GE(s.cells, 1);
          EXPECT_LE(s.cells, static_cast<double>(columns * rows));
          EXPECT_GE(s.patch_m, kPixel);
        }
}

// A million sigma of offset: nothing cancels.
TEST(Clutter, OffsetChangesNothing) {
  const auto values = gaussian_field(64, 64, 3, 3, 11);
  ClutterField field{64, 64, kPixel, 2, {}};
  for (const double v : values) {
    field.weight.push_back(static_cast<float>(v));
    field.weight.push_back(1);
  }
  const auto near = clutter_of(field, std::vector<double>{1, 0}, 100);
  const auto far = clutter_of(field, std::vector<double>{1, 1e6}, 100);
  EXPECT_NEAR(far.mean.value - 1e6, near.mean.value, 1e-8);
  EXPECT_NEAR(far.sigma.value, near.sigma.value, 1e-8);
  EXPECT_NEAR(far.skewness.value, near.skewness.value, 1e-7);
  EXPECT_NEAR(far.correlation_m.value, near.correlation_m.value, 1e-6);
  EXPECT_NEAR(far.patch_sigma.value, near.patch_sigma.value, 1e-8);
  EXPECT_NEAR(far.sigma.stderr_, near.sigma.stderr_, 1e-8);
}

TEST(Clutter, SquaresAreOfTheTargetWithinTheWindow) {
  const ClutterField field = field_of(40, 20, [](auto, auto) { return 1; });
  EXPECT_DOUBLE_EQ(patch_px(field, 16 * kPixel * kPixel), 4);
  EXPECT_DOUBLE_EQ(patch_px(field, 0.01), 1);
  EXPECT_DOUBLE_EQ(patch_px(field, 1e9), 10);
}

// Transforms against sums.
TEST(Clutter, CovariancesAreThoseOfAllPairs) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  PixelGrid a{11, 6, {}}, b = a;
  for (int k = 0; k < 66; ++k) {
    a.value.push_back(normal(random));
    b.value.push_back(normal(random));
  }
  const auto [of_a, of_b] = LagSums::of(a, b);
  for (int dy = -3; dy <= 3; ++dy)
    for (int dx = -5; dx <= 5; ++dx)
      for (const auto& [grid, sums] : {std::pair{&a, &of_a}, {&b, &of_b}}) {
        double sum = 0;
        int pairs = 0;
        for (int r = 0; r < 6; ++r)
          for (int c = 0; c < 11; ++c)
            if (r + dy >= 0 && r + dy < 6 && c + dx >= 0 && c + dx < 11) {
              sum += grid->value[static_cast<std::size_t>(r * 11 + c)] *
                     grid->value[static_cast<std::size_t>((r + dy) * 11 + c + dx)];
              ++pairs;
            }
        EXPECT_NEAR(sums->covariance(dx, dy), sum / pairs, 1e-12);
      }
}

}  // namespace
}  // namespace irsig
