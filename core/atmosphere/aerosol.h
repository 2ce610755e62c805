#pragma once

#include <vector>

#include "absl/status/status.h"
#include "core/atmosphere/absorber_amounts.h"

namespace irsig {

enum class AerosolKind {
  kNone,
  kRural,
  kUrban,
  kMaritime,
  kTropospheric,
  kNavyMaritime,
  kAdvectionFog,
  kRadiationFog
};

// Fog is as dense up to the lower height as on the ground, and is gone at the upper one.
inline constexpr double kFogDenseTopM = 1000, kFogTopM = 2000;
[[nodiscard]] inline bool is_fog(AerosolKind kind) {
  return kind == AerosolKind::kAdvectionFog || kind == AerosolKind::kRadiationFog;
}

// The particles of the lowest 2 km; from 3 to 10 km always those of the tropospheric model, from 11
// to 30 km the background stratosphere's, from 35 km meteoric dust. Between two of them both are
// there, each the less the nearer the other.                        [shettle1979, gathman1983]
struct AerosolSpec {
  AerosolKind kind = AerosolKind::kNone;

  // Meteorological range, 3.912 / (extinction at 0.55 um + 0.0116 km-1 of clean air). 100-100,000
  // m. Required by all but kNone and kNavyMaritime; there 0 means: as the wind and the humidity
  // have it.
  double visibility_m = 0;

  // kNavyMaritime only.
  double air_mass = 3;            // 1 open ocean ... 10 strong continental influence
  double wind_speed_m_s = 0;      // now, 0-20
  double wind_speed_24h_m_s = 0;  // mean of the last 24 h, 0-20

  bool summer_troposphere = true;  // spring-summer or fall-winter amounts above 2 km
};

[[nodiscard]] absl::Status check_aerosol(const AerosolSpec& spec);

// Optical properties of the aerosol at one height, per metre of path and per band of the air's
// grid.
struct AerosolOptics {
  AirSpectrum absorption_per_m;
  AirSpectrum scattering_per_m;
  AirSpectrum asymmetry;  // mean cosine of the scattering angle, [-1, 1]
};

// Computes the vertical optical depth of all particles at 0.55 um, from the ground to 100 km.
// Limits of humidity as in aerosol_optics.
[[nodiscard]] double aerosol_depth_550(const AerosolSpec& spec, double surface_humidity_percent);

// Looks up the optical properties of the particles at a height. Extinction, absorption and
// asymmetry are tabulated against wavelength and humidity (log(100 - humidity), the Navy model's in
// humidity; logarithms of the coefficients), and extinction at 0.55 um against height and
// visibility. Humidities above 99 % (Navy model: 98 %) count as 99 % (98 %).
//   relative_humidity_percent  of the air at that height
//   surface_humidity_percent   at the surface, on which alone the Navy model depends
//   bands                      0 in others
// Accuracy: LOWTRAN7's tables as they are; against its runs docs/evidence/validation.md.
[[nodiscard]] AerosolOptics aerosol_optics(const AerosolSpec& spec, double height_m,
                                           double relative_humidity_percent,
                                           double surface_humidity_percent,
                                           const BandChoice& bands = BandChoice());

}  // namespace irsig
