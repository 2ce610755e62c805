#include "core/atmosphere/air_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "absl/strings/str_format.h"
#include "core/atmosphere/band_loops.h"
#include "core/atmosphere/embedded.h"
#include "core/base/check.h"

namespace irsig {
namespace {

constexpr std::array<std::string_view, 6> kNames = {"tropical",           "midlatitude_summer",
                                                    "midlatitude_winter", "subarctic_summer",
                                                    "subarctic_winter",   "us_standard_1976"};

constexpr double kBentHeightM = 2000;

std::array<AirProfile, 6> read_afgl_profiles() {
  std::array<AirProfile, 6> profiles;
  for (const auto& row : csv_rows(embedded_afgl_profiles())) {
    IRSIG_CHECK(row.size() == 10U);
    const auto which = static_cast<std::size_t>(std::ranges::find(kNames, row[0]) - kNames.begin());
    IRSIG_CHECK(which < kNames.size());
    profiles[which].level.push_back({1e3 * number(row[1]), 100 * number(row[2]), number(row[3]),
                                     GasMix{number(row[4]), number(row[5]), number(row[6]),
                                            number(row[7]), number(row[8]), number(row[9])}});
  }
  return profiles;
}

LevelQuantities quantities(const AirLevel& l) {
  return {l.pressure_pa,  l.gas.h2o_ppmv, l.gas.co2_ppmv, l.gas.o3_ppmv,
          l.gas.n2o_ppmv, l.gas.co_ppmv,  l.gas.ch4_ppmv, 1};
}

double humidity_to_ppmv(double percent, double temperature_k, double pressure_pa) {
  return 1e4 * percent * saturation_pressure_pa(temperature_k) / pressure_pa;
}

}  // namespace

absl::Status check_profile(const AirProfile& profile) {
  const auto& level = profile.level;
  if (level.size() < 2) return absl::InvalidArgumentError("a profile needs at least two levels");
  for (std::size_t i = 0; i < level.size(); ++i) {
    const AirLevel& l = level[i];
    const auto wrong = [&](std::string_view what, double value) {
      return absl::InvalidArgumentError(
          absl::StrFormat("level %d at %g m: %s %g", i + 1, l.height_m, what, value));
    };
    if (!(l.height_m >= 0 && l.height_m <= 2e5)) return wrong("height", l.height_m);
    if (!(l.pressure_pa > 0 && l.pressure_pa <= 1.2e5)) return wrong("pressure_pa", l.pressure_pa);
    if (!(l.temperature_k >= 120 && l.temperature_k <= 1000)) {
      return wrong("temperature_k", l.temperature_k);
    }
    for (const double ppmv : {l.gas.h2o_ppmv, l.gas.co2_ppmv, l.gas.o3_ppmv, l.gas.n2o_ppmv,
                              l.gas.co_ppmv, l.gas.ch4_ppmv}) {
      if (!(ppmv >= 0 && ppmv < 5e5)) return wrong("volume mixing ratio in ppmv", ppmv);
    }
    if (l.height_m <= 20e3 && relative_humidity_percent(l) > 101) {
      return wrong("more water vapour than saturates the air: relative humidity in %",
                   relative_humidity_percent(l));
    }
    if (i > 0 && !(l.height_m > level[i - 1].height_m)) {
      return wrong("is not above the level before it, at", level[i - 1].height_m);
    }
    if (i > 0 && !(l.pressure_pa < level[i - 1].pressure_pa)) {
      return wrong("its pressure is not below that of the level before it, pressure_pa",
                   level[i - 1].pressure_pa);
    }
  }
  return absl::OkStatus();
}

AirLevel air_at(const AirProfile& profile, double height_m) {
  const auto& level = profile.level;
  IRSIG_CHECK(level.size() >= 2U);
  if (height_m <= level.front().height_m) return level.front();
  if (height_m >= level.back().height_m) return level.back();
  const auto above = std::ranges::upper_bound(level, height_m, std::less<>{}, &AirLevel::height_m);
  const AirLevel &b = *above, &a = *(above - 1);
  const double f = (height_m - a.height_m) / (b.height_m - a.height_m);
  // Logarithms are linear, unless one of the two is 0.
  const LevelQuantities q = between_levels(quantities(a), quantities(b), f);
  return {height_m, q[0], a.temperature_k + (b.temperature_k - a.temperature_k) * f,
          GasMix{q[1], q[2], q[3], q[4], q[5], q[6]}};
}

double saturation_pressure_pa(double temperature_k) {
  const double t = std::max(temperature_k, 150.0);
  return 100 * std::exp(-6096.9385 / t + 16.635794 - 2.711193e-2 * t + 1.673952e-5 * t * t +
                        2.433502 * std::log(t));
}

double relative_humidity_percent(const AirLevel& level) {
  return 1e-4 * level.gas.h2o_ppmv * level.pressure_pa /
         saturation_pressure_pa(level.temperature_k);
}

const AirProfile& afgl_profile(AfglProfile which) {
  static const std::array<AirProfile, 6> profiles = read_afgl_profiles();
  return profiles[static_cast<std::size_t>(which)];
}

absl::StatusOr<AfglProfile> afgl_profile_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<AfglProfile>(i);
  }
  std::string known;
  for (const std::string_view n : kNames) known += (known.empty() ? "" : ", ") + std::string(n);
  return absl::InvalidArgumentError(
      absl::StrFormat("no profile \"%s\"; there are %s", name, known));
}

std::string_view name_of(AfglProfile which) { return kNames[static_cast<std::size_t>(which)]; }

AfglProfile default_afgl_profile(double latitude_deg, int month) {
  const bool northern_summer = month >= 4 && month <= 9;
  const bool summer = northern_summer == (latitude_deg >= 0);
  if (std::abs(latitude_deg) < 30) return AfglProfile::kTropical;
  if (std::abs(latitude_deg) <= 55) {
    return summer ? AfglProfile::kMidlatitudeSummer : AfglProfile::kMidlatitudeWinter;
  }
  return summer ? AfglProfile::kSubarcticSummer : AfglProfile::kSubarcticWinter;
}

absl::StatusOr<AirProfile> profile_above(const AirProfile& profile, double place_m) {
  constexpr double kLeastAirM = 1000, kSameLevelM = 1e-3;
  if (!(place_m > 0)) return profile;
  if (!(place_m <= profile.level.back().height_m - kLeastAirM)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("a place at %g m: the profile ends at %g m, and a place needs 1 km of air "
                        "above it",
                        place_m, profile.level.back().height_m));
  }
  AirProfile above;
  above.level.push_back(air_at(profile, place_m));
  above.level.back().height_m = 0;
  for (AirLevel level : profile.level) {
    level.height_m -= place_m;
    if (level.height_m > kSameLevelM) above.level.push_back(level);
  }
  return above;
}

absl::StatusOr<AirProfile> bend_to_surface(const AirProfile& profile,
                                           const SurfaceWeather& weather) {
  const auto in = [](double x, double low, double high) { return x >= low && x <= high; };
  if (!in(weather.air_temperature_k, 180, 340)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("air_temperature_k %g: expected 180 to 340", weather.air_temperature_k));
  }
  if (!in(weather.relative_humidity_percent, 0, 100)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "relative_humidity_percent %g: expected 0 to 100", weather.relative_humidity_percent));
  }
  if (!in(weather.pressure_pa, 5e4, 1.1e5)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("pressure_pa %g: expected 50000 to 110000", weather.pressure_pa));
  }

  const AirLevel surface = profile.level.front();
  const double top_m = surface.height_m + kBentHeightM;
  std::vector<double> heights_m;
  for (const double h : {0., 100., 250., 500., 750., 1000., 1250., 1500., 1750., 2000.}) {
    heights_m.push_back(surface.height_m + h);
  }
  for (const AirLevel& l : profile.level) {
    if (l.height_m < top_m) heights_m.push_back(l.height_m);
  }
  std::ranges::sort(heights_m);
  heights_m.erase(std::ranges::unique(heights_m).begin(), heights_m.end());

  const double warmer_k = weather.air_temperature_k - surface.temperature_k;
  const double wetter = weather.relative_humidity_percent - relative_humidity_percent(surface);
  AirProfile bent;
  for (const double h : heights_m) {
    const AirLevel old = air_at(profile, h);
    const double share = 1 - (h - surface.height_m) / kBentHeightM;
    AirLevel now = old;
    now.temperature_k += share * warmer_k;
    if (bent.level.empty()) {
      now.pressure_pa = weather.pressure_pa;
    } else {
      // Dry hydrostatics: the ratio of both profiles' pressures follows from their temperatures.
      constexpr double kGravityMolarMassOverR = 9.80665 * 28.9647e-3 / 8.31446261815324;
      const AirLevel& below = bent.level.back();
      now.pressure_pa =
          below.pressure_pa * std::exp(-kGravityMolarMassOverR * (h - below.height_m) /
                                       (0.5 * (now.temperature_k + below.temperature_k)));
    }
    const double humidity = std::clamp(relative_humidity_percent(old) + share * wetter, 0.0, 100.0);
    now.gas.h2o_ppmv = humidity_to_ppmv(humidity, now.temperature_k, now.pressure_pa);
    bent.level.push_back(now);
  }
  const double ratio = bent.level.back().pressure_pa / air_at(profile, top_m).pressure_pa;
  for (const AirLevel& l : profile.level) {
    if (l.height_m <= top_m) continue;
    AirLevel now = l;
    now.pressure_pa *= ratio;
    bent.level.push_back(now);
  }
  return bent;
}

}  // namespace irsig
