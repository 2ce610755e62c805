#include "core/atmosphere/scattered_again.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/atmosphere/haze_light.h"
#include "core/atmosphere/path_layers.h"
#include "core/base/constants.h"

namespace irsig {

AirSpectrum scattered_again_relative(const Atmosphere& atmosphere, double height_m,
                                     double zenith_deg, const BandChoice& bands) {
  constexpr double kPerDepth = 0.6, kSkySlant = 2, kLowestCosine = 0.1, kMost = 1e4,
                   kNoAzimuth = 0.65, kComputed = 0.14;
  AirSpectrum out(kAirBandCount, 0.0);
  if (atmosphere.only_fog()) {
    out.assign(kAirBandCount, kNoAzimuth * std::pow(std::sin(zenith_deg * kRadPerDeg), 8));
    return out;
  }
  if (!atmosphere.turbid_levels_m().empty() || atmosphere.spec().aerosol.kind == AerosolKind::kNone)
    return out;
  const double computed = haze_fraction(atmosphere);
  const AbsorberAmounts up = atmosphere.amounts(
      look(atmosphere.profile(), height_m, 0, std::numeric_limits<double>::infinity(), false),
      bands);
  const double slant = 1 / std::max(kLowestCosine, std::cos(zenith_deg * kRadPerDeg)) + kSkySlant;
  const AirSpectrum& scattering = up.grey(GreyAbsorber::kAerosolScattering);
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    out[b] = std::clamp(std::expm1(kPerDepth * scattering[b] * slant) - kAerosolRelativeError, 0.0,
                        kMost);
  if (computed > 0)
    for (double& x : out) x = std::lerp(x, kComputed, computed);
  return out;
}

double low_sun_relative(double zenith_deg) {
  constexpr double kFromDeg = 85, kAtDeg = 88, kThere = 0.12, kPerDeg = 0.81, kMost = 1.5;
  if (zenith_deg < kFromDeg) return 0;
  return std::min(kMost, kThere * std::exp(kPerDeg * (zenith_deg - kAtDeg)));
}

}  // namespace irsig
