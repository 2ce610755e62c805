#pragma once

namespace irsig {

// Weather that no file states: sunlight and long-wave radiation of the sky, from surface weather.
// Open programs disagree about the constants of these formulas: forward share 0.84 or 0.85,
// exponent of ozone -0.3034 or -0.3035, 1013 or 1013.25 hPa, air mass of 1966 or 1989, 0.9662 (for
// a solar constant of 1353 W/m2) or 0.9751 (1367), together 2 % of sunlight; forms of the cloud
// factor. The numbers below are those of the papers named, as far as open programs that cite them
// agree.

// Horizontal irradiance under a clear sky [bird1981]:
struct ClearSkyInput {
  double sun_zenith_deg;         // [0, 180]
  double extraterrestrial_w_m2;  // normal to the sun, on this day: extraterrestrial_w_m2()
  double pressure_pa;            // at the surface
  double ozone_cm;               // at standard pressure and temperature
  double precipitable_water_cm;
  double aerosol_depth_380, aerosol_depth_500;  // vertical optical depths at 380 and 500 nm
  double ground_albedo;                         // [0, 1]
};
struct ClearSkyIrradiance {
  double direct_normal_w_m2;
  double diffuse_horizontal_w_m2;  // with what ground and sky reflect to each other
  bool low_sun;                    // elevation below 5 deg: the model is then untested
};
// Computes the irradiance under a clear sky. Rayleigh scattering, ozone, uniformly mixed gases,
// water and aerosol are factors of the direct beam; the diffuse part has a forward fraction of
// aerosol scattering of 0.84 and an albedo of aerosol absorption K1 = 0.1. Relative air mass of
// [kasten1966]. All inputs must be finite and >= 0; 0 for a sun at or below the horizon. Within 10
// % of rigorous codes, by its authors; zenith below 85 deg.
[[nodiscard]] ClearSkyIrradiance clear_sky_irradiance(const ClearSkyInput& input);

// Returns the extraterrestrial irradiance on a day of the year [1, 366]: 1361 W/m2 [kopp2011] times
// the inverse square of the distance, by the series of [spencer1971]: 0.01 %.
[[nodiscard]] double extraterrestrial_w_m2(double day_of_year);

// Returns the pressure of water vapour in air with this dew point; at saturation, that of the air:
// 611.2 Pa exp(17.62 t / (243.12 + t)), t in deg C [sonntag1990]: 0.3 % from -45 to 60 deg C.
[[nodiscard]] double vapour_pressure_pa(double dew_point_k);
// Inverts vapour_pressure_pa(). Vapour pressure > 0.
[[nodiscard]] double dew_point_k(double vapour_pressure_pa);

// Returns the water in a column whose vapour decreases as usual with height [prata1996]: 46.5 cm
// K/hPa e / T.
[[nodiscard]] double precipitable_water_cm(double air_k, double vapour_pressure_pa);

// Returns the long-wave emissivity of the clear sky: horizontal irradiance = emissivity sigma
// T_air^4.
//
// 1 - (1 + w) exp(-sqrt(1.2 + 3 w)), w = precipitable_water_cm [prata1996].
[[nodiscard]] double sky_emissivity_prata(double air_k, double vapour_pressure_pa);
// Returns 0.711 + 0.56 d + 0.73 d^2 + 0.013 cos(2 pi hour / 24) + 0.00012 (p - 1000 hPa), d = dew
// point in 100 deg C, hour of local solar time [berdahl1984].
[[nodiscard]] double sky_emissivity_berdahl_martin(double dew_point_k, double solar_hour,
                                                   double pressure_pa);

}  // namespace irsig
