#include "core/clutter/clutter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/clutter/lag_sums.h"
#include "core/clutter/patch_means.h"

namespace irsig {
namespace {

// Means along rows of so many values that begin at each column.
PixelGrid means_along(const PixelGrid& grid, double side_px) {
  const auto whole = static_cast<std::size_t>(side_px);
  const double rest = side_px - static_cast<double>(whole);
  const std::size_t taken = whole + (rest > 0 ? 1 : 0);
  PixelGrid out{grid.columns - taken + 1, grid.rows, {}};
  out.value.reserve(out.columns * out.rows);
  for (std::size_t r = 0; r < grid.rows; ++r) {
    const double* row = &grid.value[r * grid.columns];
    for (std::size_t c = 0; c < out.columns; ++c) {
      double sum = 0;
      for (std::size_t k = 0; k < whole; ++k) sum += row[c + k];
      if (rest > 0) sum += rest * row[c + whole];
      out.value.push_back(sum / side_px);
    }
  }
  return out;
}

PixelGrid transposed(const PixelGrid& grid) {
  PixelGrid out{grid.rows, grid.columns, std::vector<double>(grid.value.size())};
  for (std::size_t r = 0; r < grid.rows; ++r)
    for (std::size_t c = 0; c < grid.columns; ++c)
      out.value[c * grid.rows + r] = grid.value[r * grid.columns + c];
  return out;
}

double mean_of(const std::vector<double>& values) {
  // Differences from the first value are exactly 0 where all are equal.
  double sum = 0;
  for (const double v : values) sum += v - values.front();
  return values.front() + sum / static_cast<double>(values.size());
}

void subtract_mean(std::vector<double>& values) {
  const double mean = mean_of(values);
  for (double& v : values) v -= mean;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return sum / static_cast<double>(values.size());
}

// Influence function of the standard deviation of values with mean 0.
PixelGrid influence_of_sigma(const PixelGrid& grid, double variance) {
  PixelGrid out = grid;
  const double sigma = std::sqrt(variance);
  for (double& v : out.value) v = (v * v - variance) / (2 * sigma);
  return out;
}

// Variance and correlation area, corrected for the removal of the window's own mean.
struct Spread {
  double variance, area_px;
};
Spread corrected(const LagSums& sums, const LagSums::Ellipse& inside, double pixels) {
  const double variance = sums.covariance(0, 0);
  const auto integral = sums.integral(inside);
  const double fraction = std::clamp(integral.sum / variance / pixels, 1 / pixels, 0.5);
  const double of_mean = variance * fraction / (1 - fraction);
  const double all = variance + of_mean;
  return {all, std::clamp((integral.sum + static_cast<double>(integral.lags) * of_mean) / all, 1.0,
                          pixels)};
}

}  // namespace

double patch_px(const ClutterField& field, double target_area_m2) {
  const double most = 0.5 * static_cast<double>(std::min(field.columns, field.rows));
  return std::max(1.0, std::min(std::sqrt(target_area_m2) / field.pixel_m, most));
}

PixelGrid patch_means(const PixelGrid& grid, double side_px) {
  return transposed(means_along(transposed(means_along(grid, side_px)), side_px));
}

ClutterStatistics clutter_of(const ClutterField& field, std::span<const double> radiance,
                             double target_area_m2) {
  const std::size_t pixels = field.pixels();
  IRSIG_CHECK(pixels > 0);
  IRSIG_CHECK(field.pixel_m > 0);
  IRSIG_CHECK(radiance.size() == field.sources);
  IRSIG_CHECK(field.weight.size() == pixels * field.sources);
  PixelGrid grid{field.columns, field.rows, std::vector<double>(pixels, 0.0)};
  for (std::size_t p = 0; p < pixels; ++p)
    for (std::size_t s = 0; s < field.sources; ++s)
      grid.value[p] += static_cast<double>(field.weight[p * field.sources + s]) * radiance[s];

  ClutterStatistics out;
  const double side_px = patch_px(field, target_area_m2);
  out.patch_m = side_px * field.pixel_m;
  out.mean.value = mean_of(grid.value);
  subtract_mean(grid.value);
  // In units of the largest deviation, small numbers can be squared.
  double unit = 0;
  for (const double v : grid.value) unit = std::max(unit, std::abs(v));
  if (!(unit > 0)) return out;
  for (double& v : grid.value) v /= unit;
  subtract_mean(grid.value);

  const double variance = mean_square(grid.value), sigma = std::sqrt(variance);
  const auto n = static_cast<double>(pixels);
  const auto [sums, sums_of_sigma] = LagSums::of(grid, influence_of_sigma(grid, variance));
  const auto inside = sums.first_zeros();
  const Spread spread = corrected(sums, inside, n);
  out.cells = n / spread.area_px;
  out.mean.stderr_ = unit * std::sqrt(spread.variance / out.cells);
  out.sigma = {unit * std::sqrt(spread.variance), unit * sums_of_sigma.stderr_of_mean()};
  out.correlation_m.value = field.pixel_m * std::sqrt(spread.area_px / std::numbers::pi);

  // Influence functions. With z = deviation / sigma, that of the skewness g = mean of z^3 is z^3 -
  // g - 3 z - 3/2 g (z^2 - 1). With S the sum around a pixel, that of the correlation area r =
  // mean(v S) / mean(v^2) is (v S - r v^2) / sigma^2.
  const PixelGrid around = sums_around(grid, inside);
  double cubes = 0, products = 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double v = grid.value[p];
    cubes += v * v * v / (variance * sigma);
    products += v * around.value[p];
  }
  out.skewness.value = cubes / n;
  const double area = products / n / variance;
  PixelGrid of_skewness = grid, of_area = grid;
  for (std::size_t p = 0; p < pixels; ++p) {
    const double v = grid.value[p], z = v / sigma, g = out.skewness.value;
    of_skewness.value[p] = z * z * z - g - 3 * z - 1.5 * g * (z * z - 1);
    of_area.value[p] = (v * around.value[p] - area * v * v) / variance;
  }
  const auto [sums_of_skewness, sums_of_area] = LagSums::of(of_skewness, of_area);
  out.skewness.stderr_ = sums_of_skewness.stderr_of_mean();
  // dl / l = dA / (2 A). Where to cut is as uncertain as half axes that are shorter by a quarter
  // change the area: with 80 cells the fixed ellipse's own error is too small by 1.7.
  if (area > 0) {
    const double cut =
        sums.integral(inside).sum - sums.integral({0.75 * inside.x, 0.75 * inside.y}).sum;
    out.correlation_m.stderr_ =
        out.correlation_m.value * 0.5 *
        std::hypot(sums_of_area.stderr_of_mean() / area, cut / variance / spread.area_px);
  }

  if (side_px <= 1) {
    out.patch_sigma = out.sigma;
    return out;
  }
  PixelGrid patch = patch_means(grid, side_px);
  subtract_mean(patch.value);
  const double patch_variance = mean_square(patch.value);
  // Means of squares that all have the same (stripes of their side).
  if (!(patch_variance > 1e-28)) return out;
  const auto [of_patch, of_patch_sigma] =
      LagSums::of(patch, influence_of_sigma(patch, patch_variance));
  // The mean of squares is that of the window: as uncertain.
  out.patch_sigma = {unit * std::sqrt(patch_variance + spread.variance / out.cells),
                     unit * of_patch_sigma.stderr_of_mean()};
  return out;
}

}  // namespace irsig
