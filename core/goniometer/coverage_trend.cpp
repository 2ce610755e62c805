#include "core/goniometer/coverage_trend.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"

namespace irsig {

absl::StatusOr<Estimate> plane_mean(const GoniometerResult& result, std::size_t channel,
                                    std::size_t source) {
  const GoniometerSpec& s = result.spec;
  double sum = 0, variance = 0;
  int count = 0;
  for (const double wanted : {0.0, 90.0, 180.0, 270.0}) {
    bool found = false;
    for (std::size_t a = 0; a < s.view_azimuth_deg.size(); ++a) {
      if (std::abs(s.view_azimuth_deg[a] - wanted) > 1e-6) continue;
      found = true;
      for (std::size_t z = 0; z < s.view_zenith_deg.size(); ++z) {
        const double zenith_deg = s.view_zenith_deg[z];
        // Nadir once for each plane.
        if (zenith_deg > kTrendZenithDeg + 1e-6 || (zenith_deg == 0 && wanted >= 180)) continue;
        const Estimate& e = result.brdf(channel, source, z, a);
        sum += e.value;
        variance += e.stderr_ * e.stderr_ * (zenith_deg == 0 ? 2 : 1);  // the same number twice
        ++count;
      }
    }
    if (!found)
      return absl::FailedPreconditionError(
          "the views have no azimuths 0, 90, 180 and 270 deg: there is no mean over the planes");
  }
  return Estimate{std::numbers::pi * sum / count, std::numbers::pi * std::sqrt(variance) / count};
}

LineFit fit_line(const std::vector<double>& x, const std::vector<Estimate>& y) {
  IRSIG_CHECK(x.size() == y.size());
  IRSIG_CHECK(x.size() >= 2u);
  const auto n = static_cast<double>(x.size());
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mx += x[i] / n;
    my += y[i].value / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    xy += (x[i] - mx) * (y[i].value - my);
  }
  LineFit fit;
  fit.slope = xx > 0 ? xy / xx : 0;
  fit.offset = my - fit.slope * mx;
  double squares = 0, noise = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double residual = y[i].value - fit.offset - fit.slope * x[i];
    squares += residual * residual;
    noise += y[i].stderr_ * y[i].stderr_;
  }
  fit.rms_residual = std::sqrt(squares / n);
  fit.rms_noise = std::sqrt(noise / n);
  return fit;
}

}  // namespace irsig
