#include "core/thermal/clear_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"

namespace irsig {

ClearSkyIrradiance clear_sky_irradiance(const ClearSkyInput& in) {
  ClearSkyIrradiance out{0, 0, in.sun_zenith_deg > 85};
  if (in.sun_zenith_deg >= 90) return out;
  const double cosine = std::cos(in.sun_zenith_deg * kRadPerDeg);
  const double mass = 1 / (cosine + 0.15 * std::pow(93.885 - in.sun_zenith_deg, -1.253));
  const double heavy = mass * in.pressure_pa / 101325;  // air mass by pressure
  const double rayleigh =
      std::exp(-0.0903 * std::pow(heavy, 0.84) * (1 + heavy - std::pow(heavy, 1.01)));
  const double o = in.ozone_cm * mass;
  const double ozone = 1 - 0.1611 * o * std::pow(1 + 139.48 * o, -0.3035) -
                       0.002715 * o / (1 + 0.044 * o + 0.0003 * o * o);
  const double mixed = std::exp(-0.0127 * std::pow(heavy, 0.26));
  const double w = in.precipitable_water_cm * mass;
  const double water = 1 - 2.4959 * w / (std::pow(1 + 79.034 * w, 0.6828) + 6.385 * w);
  const double depth = 0.2758 * in.aerosol_depth_380 + 0.35 * in.aerosol_depth_500;
  const double aerosol = std::exp(-std::pow(depth, 0.873) * (1 + depth - std::pow(depth, 0.7088)) *
                                  std::pow(mass, 0.9108));
  const double absorbed = 1 - 0.1 * (1 - mass + std::pow(mass, 1.06)) * (1 - aerosol);
  const double scattered = aerosol / absorbed;
  constexpr double kForward = 0.84;

  out.direct_normal_w_m2 =
      std::max(0.0, 0.9662 * in.extraterrestrial_w_m2 * rayleigh * ozone * mixed * water * aerosol);
  const double direct = out.direct_normal_w_m2 * cosine;
  const double once = 0.79 * in.extraterrestrial_w_m2 * cosine * ozone * mixed * water * absorbed *
                      (0.5 * (1 - rayleigh) + kForward * (1 - scattered)) /
                      (1 - mass + std::pow(mass, 1.02));
  const double sky_albedo = 0.0685 + (1 - kForward) * (1 - scattered);
  out.diffuse_horizontal_w_m2 =
      std::max(0.0, (direct + once) / (1 - in.ground_albedo * sky_albedo) - direct);
  return out;
}

double extraterrestrial_w_m2(double day_of_year) {
  const double day = 2 * std::numbers::pi * (day_of_year - 1) / 365;
  return 1361 * (1.000110 + 0.034221 * std::cos(day) + 0.001280 * std::sin(day) +
                 0.000719 * std::cos(2 * day) + 0.000077 * std::sin(2 * day));
}

double vapour_pressure_pa(double temperature_k) {
  const double t = temperature_k - 273.15;
  return 611.2 * std::exp(17.62 * t / (243.12 + t));
}

double dew_point_k(double vapour_pressure_pa) {
  const double ln = std::log(vapour_pressure_pa / 611.2);
  return 273.15 + 243.12 * ln / (17.62 - ln);
}

double precipitable_water_cm(double air_k, double vapour_pressure_pa) {
  return 0.465 * vapour_pressure_pa / air_k;
}

double sky_emissivity_prata(double air_k, double vapour_pressure_pa) {
  const double w = precipitable_water_cm(air_k, vapour_pressure_pa);
  return 1 - (1 + w) * std::exp(-std::sqrt(1.2 + 3 * w));
}

double sky_emissivity_berdahl_martin(double dew_point, double solar_hour, double pressure_pa) {
  const double d = (dew_point - 273.15) / 100;
  return 0.711 + 0.56 * d + 0.73 * d * d +
         0.013 * std::cos(2 * std::numbers::pi * solar_hour / 24) +
         0.00012 * (pressure_pa / 100 - 1000);
}

}  // namespace irsig
