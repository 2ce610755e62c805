#include "core/atmosphere/atmosphere.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/status_macros.h"

namespace irsig {

namespace {

constexpr double kSameLevelM = 1e-3;

std::vector<double> joined_levels(std::vector<double> a, const std::vector<double>& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end());
  a.erase(std::unique(a.begin(), a.end(),
                      [](double low, double high) { return high - low < kSameLevelM; }),
          a.end());
  return a;
}

// Returns the profile with levels at these heights, between whose neighbours they lie.
AirProfile with_levels(AirProfile profile, const std::vector<double>& height_m) {
  AirProfile out = profile;
  for (const double at_m : height_m) {
    const bool known = std::any_of(
        profile.level.begin(), profile.level.end(),
        [&](const AirLevel& level) { return std::abs(level.height_m - at_m) < kSameLevelM; });
    if (known) continue;
    out.level.push_back(air_at(profile, at_m));
    out.level.back().height_m = at_m;
  }
  std::sort(out.level.begin(), out.level.end(),
            [](const AirLevel& a, const AirLevel& b) { return a.height_m < b.height_m; });
  return out;
}

// Light in fog changes within some optical depths of the ground, and where the fog thins out.
// Levels 100 m apart keep sunlight linear between them: 250 m apart, a low sun's would be 8 %
// stronger.
std::vector<double> fog_levels_m(const AirProfile& profile, const AerosolSpec& spec) {
  const double ground_m = profile.level.front().height_m;
  std::vector<double> out;
  if (ground_m >= kFogTopM - kSameLevelM) return out;
  const double per_m = 3.912 / spec.visibility_m;
  for (const double depth : {0.0, 0.3, 1.0, 2.5, 5.0, 9.0}) {
    const double at_m = ground_m + depth / per_m;
    if (at_m < kFogDenseTopM) out.push_back(at_m);
  }
  for (double at_m = ground_m + 100; at_m < kFogTopM; at_m += 100) out.push_back(at_m);
  if (ground_m < kFogDenseTopM) out.push_back(kFogDenseTopM);
  out.push_back(kFogTopM);
  return joined_levels(std::move(out), {});
}

}  // namespace

Atmosphere::Atmosphere(AtmosphereSpec spec)
    : spec_(std::move(spec)),
      surface_humidity_percent_(relative_humidity_percent(spec_.profile.level.front())) {}

absl::StatusOr<Atmosphere> Atmosphere::make(AtmosphereSpec spec) {
  RETURN_IF_ERROR(check_profile(spec.profile));
  RETURN_IF_ERROR(check_aerosol(spec.aerosol));
  if (!(spec.co2_ppmv >= 0 && spec.co2_ppmv <= 5000)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("co2_ppmv %g: expected 0 to 5000", spec.co2_ppmv));
  }
  for (const double cfc : {spec.cfc11_ppmv, spec.cfc12_ppmv}) {
    if (!(cfc >= 0 && cfc <= 0.01)) {
      return absl::InvalidArgumentError(absl::StrFormat("cfc ppmv %g: expected 0 to 0.01", cfc));
    }
  }
  for (AirLevel& level : spec.profile.level) level.gas.co2_ppmv = spec.co2_ppmv;
  const double humidity_percent = irsig::relative_humidity_percent(spec.profile.level.front());
  CloudOptics cloud;
  std::vector<double> cloud_levels_m;
  if (spec.cloud) {
    RETURN_IF_ERROR(check_cloud(*spec.cloud));
    cloud = cloud_optics(*spec.cloud, spec.forward_peak);
    cloud_levels_m = irsig::cloud_levels_m(spec.profile, *spec.cloud);
    spec.profile = with_cloud(spec.profile, *spec.cloud);
  }
  std::vector<double> turbid_levels_m = cloud_levels_m;
  if (is_fog(spec.aerosol.kind)) {
    const std::vector<double> fog = fog_levels_m(spec.profile, spec.aerosol);
    spec.profile = with_levels(std::move(spec.profile), fog);
    turbid_levels_m = joined_levels(turbid_levels_m, fog);
    // And the air between fog and cloud.
    std::vector<double> between;
    for (const AirLevel& level : spec.profile.level) {
      if (!fog.empty() && level.height_m > fog.back() && level.height_m < turbid_levels_m.back())
        between.push_back(level.height_m);
    }
    turbid_levels_m = joined_levels(std::move(turbid_levels_m), between);
  }
  Atmosphere out(std::move(spec));
  out.surface_humidity_percent_ = humidity_percent;
  out.cloud_ = std::move(cloud);
  out.cloud_levels_m_ = std::move(cloud_levels_m);
  out.turbid_levels_m_ = std::move(turbid_levels_m);
  return out;
}

}  // namespace irsig
