#pragma once

#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Volume mixing ratios of one level, 1e-6 each.
struct GasMix {
  double h2o_ppmv, co2_ppmv, o3_ppmv, n2o_ppmv, co_ppmv, ch4_ppmv;
};

struct AirLevel {
  double height_m;
  double pressure_pa;
  double temperature_k;
  GasMix gas;
};

// Levels of increasing height, the first at the surface. Between levels ln(pressure), temperature
// and ln(mixing ratio) are linear in height. The air ends at the last level.
struct AirProfile {
  std::vector<AirLevel> level;
};

// Checks a profile. INVALID_ARGUMENT unless it has at least two levels, increasing heights,
// decreasing pressures, all quantities in range, and water vapour at most saturated over water
// (within 1 % of relative humidity, and only up to 20 km).
[[nodiscard]] absl::Status check_profile(const AirProfile& profile);

// Returns the air at a height inside the profile; outside, the nearest level's.
[[nodiscard]] AirLevel air_at(const AirProfile& profile, double height_m);

// Returns the saturation pressure over water, also below 0 C, as meteorology defines relative
// humidity. [sonntag1990]
[[nodiscard]] double saturation_pressure_pa(double temperature_k);
[[nodiscard]] double relative_humidity_percent(const AirLevel& level);

// The six model atmospheres of the Air Force Geophysics Laboratory, 0-120 km.        [anderson1986]
// Their CO2 is 330 ppmv: AtmosphereSpec::co2_ppmv replaces it.
enum class AfglProfile {
  kTropical,
  kMidlatitudeSummer,
  kMidlatitudeWinter,
  kSubarcticSummer,
  kSubarcticWinter,
  kUsStandard1976
};
[[nodiscard]] const AirProfile& afgl_profile(AfglProfile which);
[[nodiscard]] absl::StatusOr<AfglProfile> afgl_profile_named(std::string_view name);
[[nodiscard]] std::string_view name_of(AfglProfile which);

// Returns the profile for a place where none is stated: tropical within 30 deg of the equator,
// subarctic beyond 55 deg, mid-latitude between; the summer one from April to September in the
// north, from October to March in the south.
[[nodiscard]] AfglProfile default_afgl_profile(double latitude_deg, int month);

// Returns the profile above a place: the air of the heights above mean sea level, from the place
// up, with heights counted from the place. Its first level is interpolated. A place at or below sea
// level has the whole profile. INVALID_ARGUMENT: the place is less than 1 km below the last level.
//
// The standard atmospheres of LOWTRAN's GNDALT and of 6S are cut at the ground in the same way.
[[nodiscard]] absl::StatusOr<AirProfile> profile_above(const AirProfile& profile, double place_m);

// Parses a radiosonde or other profile in CSV. Lines that start with # are comments; the first
// other line names the columns with their units:
//   height_m | height_km
//   pressure_pa | pressure_hpa
//   temperature_k | temperature_c
//   h2o_ppmv | h2o_g_kg (mixing ratio, g per kg of dry air) | relative_humidity_percent |
//   dew_point_k
//     | dew_point_c
// and one line follows per level. The heights are above mean sea level; the lowest may be up to
// 100 m above the place. The other gases, and all above the last level, are `base`'s, whose
// pressures are scaled to join. INVALID_ARGUMENT lists every error as file:line:column: ...
//   base     heights above mean sea level, as those of the result
//   place_m  height of the place; of one below sea level, 0
[[nodiscard]] absl::StatusOr<AirProfile> parse_profile_csv(std::string_view text,
                                                           std::string_view file,
                                                           const AirProfile& base,
                                                           double place_m = 0);

// The weather at the surface, as a condition of a sweep states it.
struct SurfaceWeather {
  double air_temperature_k;
  double relative_humidity_percent;
  double pressure_pa;
};

// Bends a profile to the weather at its surface. Below 2 km temperature and relative humidity are
// shifted by the difference at the surface times (1 - height / 2 km), and the pressure follows from
// the surface's by hydrostatic balance; above 2 km only the pressure is scaled to join.
// INVALID_ARGUMENT: temperatures outside 180-340 K, humidity outside 0-100 %, pressure outside
// 500-1100 hPa.
[[nodiscard]] absl::StatusOr<AirProfile> bend_to_surface(const AirProfile& profile,
                                                         const SurfaceWeather& weather);

}  // namespace irsig
