#pragma once

#include <vector>

#include "core/goniometer/goniometer.h"

namespace irsig {

// Views of the trend: the source's plane and the one across it, up to this zenith. With steps of 20
// deg these are the 14 views (nadir counted in both planes) of [carson2015], figure 8.
inline constexpr double kTrendZenithDeg = 60;

// Returns the mean of pi x BRDF over the views at azimuths 0, 90, 180 and 270. FAILED_PRECONDITION:
// such views are missing.
[[nodiscard]] absl::StatusOr<Estimate> plane_mean(const GoniometerResult& result,
                                                  std::size_t channel, std::size_t source);

// A straight line through (x, value) by least squares: its slope, the rms of the residuals, and
// what the standard errors alone would make of that rms.
struct LineFit {
  double offset = 0, slope = 0;
  double rms_residual = 0, rms_noise = 0;
};
[[nodiscard]] LineFit fit_line(const std::vector<double>& x, const std::vector<Estimate>& y);

}  // namespace irsig
