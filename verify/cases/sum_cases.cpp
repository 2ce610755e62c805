#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "core/accuracy/replicates.h"
#include "core/base/status_macros.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

namespace irsig {
namespace {

// 1e9 terms that do not cancel, of which a float sum would keep the first 2e7 (0.1 + i mod 2).
absl::StatusOr<Finding> statistics_1e9(Effort effort) {
  const std::uint64_t pairs = effort == Effort::kFull ? 500'000'000 : 50'000'000;
  Worst worst(0x1p-53 * std::sqrt(2 * static_cast<double>(pairs) / 3));
  constexpr double kLow[] = {1000.1, 0.1}, kHigh[] = {1000.2, 1.1};
  ReplicateStatistics statistics(2);
  for (std::uint64_t i = 0; i < pairs; ++i) {
    statistics.add(kLow);
    statistics.add(kHigh);
  }
  const auto n = 2 * static_cast<double>(pairs);
  for (std::size_t q = 0; q < 2; ++q) {
    const Estimate e = statistics.estimate(q);
    const double mean = 0.5 * (kLow[q] + kHigh[q]), half = 0.5 * (kHigh[q] - kLow[q]);
    worst.see(std::abs(e.value / mean - 1), [&] { return absl::StrCat("mean of ", n, " terms"); });
    // The spread is a difference of terms and mean: it has their rounding, relative to itself.
    worst.see(std::abs(e.stderr_ / (half / std::sqrt(n - 1)) - 1) * half / mean,
              [&] { return absl::StrCat("standard error of ", n, " terms, number ", q); });
  }
  return worst.finding();
}

// As many equal path weights as a replicate may have: each sum is the plate's area.
absl::StatusOr<Finding> path_weights(Effort effort) {
  Worst worst(1e-6);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(plate(1, 1), grey_paint(1))));
  ViewRequest r = dark_view(*simulator, 0, 0, 1e6, {300});
  r.accuracy.replicates = effort == Effort::kFull ? 120 : 2;
  r.accuracy.samples_per_replicate = 1u << 23;
  ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
  const SignatureResult& row = view.row[0];
  const double black = black_radiance_w_m2_sr(*simulator, 0, 300);
  const auto where = [&] {
    return absl::StrCat(view.target_paths, " paths: ", row.projected_area_m2.value, " m2");
  };
  worst.see(std::abs(row.intensity_w_sr.value / (row.projected_area_m2.value * black) - 1), where);
  // The edge of the plate: a net of n points misplaces about n^-3/4 of an area.
  worst.see(0.02 * std::abs(row.projected_area_m2.value - 1), where);
  return worst.finding();
}

// Every pixel inside a plate has the plate's radiance, however many rays it has. A picture of one
// pixel holds the plate's edges, which its rays misplace by up to 1e-3 of its area.
absl::StatusOr<Finding> picture(Effort) {
  constexpr double kOfEdges = 1e-3;
  Worst worst(1e-6);
  ASSIGN_OR_RETURN(const auto simulator, Simulator::create(one_body(plate(1, 1), grey_paint(1))));
  const double black = black_radiance_w_m2_sr(*simulator, 0, 300);
  for (const std::uint32_t side_px : {1u, 16u, 128u}) {
    ViewRequest r = dark_view(*simulator, 0, 0, 1e6, {300});
    r.thumbnail_px = side_px;
    ASSIGN_OR_RETURN(const auto view, simulator->simulate(r));
    const std::vector<float>& pixel = view.row[0].image_w_m2_sr;
    for (std::size_t i = 0; i < pixel.size(); ++i) {
      const std::size_t x = i % side_px, y = i / side_px;
      const bool edge = x == 0 || y == 0 || x + 1 == side_px || y + 1 == side_px;
      if (edge && side_px > 1) continue;
      const double radiance = static_cast<double>(pixel[i]);
      worst.see((edge ? 1e-6 / kOfEdges : 1) * std::abs(radiance / black - 1), [&] {
        return absl::StrCat("pixel ", i, " of ", side_px, " x ", side_px, ": ", radiance,
                            " W/(m2 sr), expected ", black);
      });
    }
  }
  return worst.finding();
}

}  // namespace

std::vector<HardCase> sum_cases() {
  return {
      {"sums", "statistics_1e9",
       "mean, and standard error in units of the mean's, of 1e8 (full: 1e9) terms, relative",
       "each step rounds the mean by 2^-53 of it, and step k's rounding stays with weight k / n: a "
       "random walk of 2^-53 sqrt(n / 3)",
       statistics_1e9},
      {"sums", "path_weights", "1.7e7 (full: 1e9) equal weights: their sum, relative",
       "a weight is a float (6e-8 each, of one sign at worst a few times); sums are doubles",
       path_weights},
      {"sums", "picture", "each pixel inside a plate, of 1, 256 and 16384: radiance, relative",
       "a pixel is a float (6e-8) of a sum in double; of one pixel with edges 1e-3 is asked",
       picture},
  };
}

}  // namespace irsig
