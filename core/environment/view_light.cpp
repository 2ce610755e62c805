#include "core/environment/view_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "core/base/constants.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Direct sunlight at the ground against LOWTRAN7: within 10 % in the windows, in the mean 5 %.
constexpr double kSunRelativeError = 0.05;

// Rings at which near air is taken into account exactly; between them the ratio of the radiance
// behind near air to that at the target, a smooth function, is cubic in the number of the ring.
std::vector<std::size_t> exact_rings(std::size_t count) {
  constexpr std::size_t kExact = 8;
  std::vector<std::size_t> ring;
  for (std::size_t i = 0; i < kExact; ++i) {
    const std::size_t r = (i * (count - 1) + (kExact - 1) / 2) / (kExact - 1);
    if (ring.empty() || r > ring.back()) ring.push_back(r);
  }
  return ring;
}

// Lagrange's polynomial through up to four neighbours of x.
struct Stencil {
  std::size_t first = 0, count = 0;
  std::array<double, 4> weight{};
};
Stencil cubic(const std::vector<double>& at, double x) {
  Stencil s;
  s.count = std::min<std::size_t>(4, at.size());
  std::size_t above =
      static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), x) - at.begin());
  above = std::clamp<std::size_t>(above, 2, std::max<std::size_t>(2, at.size()));
  s.first = std::min(above - 2, at.size() - s.count);
  for (std::size_t i = 0; i < s.count; ++i) {
    double w = 1;
    for (std::size_t j = 0; j < s.count; ++j) {
      if (j != i) w *= (x - at[s.first + j]) / (at[s.first + i] - at[s.first + j]);
    }
    s.weight[i] = w;
  }
  return s;
}

// ratio[ring] at the exact rings -> at all.
std::vector<AirSpectrum> fill_in(const std::vector<std::size_t>& exact,
                                 const std::vector<AirSpectrum>& ratio, std::size_t rings) {
  const std::vector<double> at(exact.begin(), exact.end());
  std::vector<AirSpectrum> all(rings, AirSpectrum(kAirBandCount, 0.0));
  for (std::size_t r = 0; r < rings; ++r) {
    const Stencil s = cubic(at, static_cast<double>(r));
    for (std::size_t i = 0; i < s.count; ++i) {
      if (s.weight[i] == 0) continue;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        all[r][b] += s.weight[i] * ratio[s.first + i][b];
      }
    }
    for (double& x : all[r]) x = std::max(0.0, x);
  }
  return all;
}

}  // namespace

absl::StatusOr<NodeWavelengths> node_wavelengths(const std::vector<double>& um) {
  NodeWavelengths out;
  out.um = um;
  out.bands.assign(kAirBandCount, 0);
  for (const double lambda_um : um) {
    const absl::StatusOr<std::size_t> band = air_band(lambda_um);
    if (!band.ok()) return band.status();
    out.band.push_back(*band);
    out.bands[*band] = 1;
    out.solar_shape.push_back(solar_irradiance_w_m2_um(lambda_um) /
                              solar_irradiance_w_m2_um(air_band_lambda_um(*band)));
  }
  return out;
}

ViewLight::ViewLight(const WeatherLight& light, const Environment::Line& line,
                     const DirectionNodes& nodes, const NodeWavelengths& wavelengths)
    : light_(&light), line_(line), nodes_(&nodes), wavelengths_(&wavelengths) {}

absl::StatusOr<ViewLight> ViewLight::make(const WeatherSpec& spec, const Atmosphere& atmosphere,
                                          const WeatherLight& light, double height_m,
                                          const Environment::Line& line,
                                          const DirectionNodes& nodes,
                                          const NodeWavelengths& wavelengths) {
  if (!(line.range_m >= 0 && std::isfinite(line.range_m) && line.elevation_deg >= -90 &&
        line.elevation_deg <= 90)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "a line of sight of range_m %g at elevation_deg %g", line.range_m, line.elevation_deg));
  }
  ViewLight view(light, line, nodes, wavelengths);
  const double bottom_m = atmosphere.profile().level.front().height_m;
  const double r = kEarthRadiusM + height_m, d = line.range_m;
  const double rise_m = d * std::sin(line.elevation_deg * kRadPerDeg);
  // r' - r without the loss of digits
  const double r_sensor = std::sqrt(r * r + d * d + 2 * r * rise_m);
  const double sensor_m = height_m + (d * d + 2 * r * rise_m) / (r_sensor + r);
  if (sensor_m < bottom_m) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the sensor, %g m away at %g deg, would be %.4g m below the surface", d,
                        line.elevation_deg, bottom_m - sensor_m));
  }
  const absl::StatusOr<LightPath> path =
      look_between(atmosphere.profile(), sensor_m, height_m, d, spec.refraction);
  if (!path.ok()) return absl::InvalidArgumentError(path.status().message());
  view.leg_.emplace(atmosphere, *path, wavelengths.bands);
  const PathLayers& leg = *view.leg_;

  view.transmittance_ = leg.transmittance;
  view.path_radiance_ = leg.thermal_w_m2_sr_um;
  AirSpectrum scattered = leg.surroundings_share;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    scattered[b] *= light.surroundings[b];
    view.path_radiance_[b] += scattered[b];
  }
  view.error_ = model_error(leg.amounts(), leg.transmittance, scattered, leg.warmest_k(),
                            wavelengths.bands, &light.surroundings);
  const double temperature_k = air_at(atmosphere.profile(), height_m).temperature_k;
  for (std::size_t i = 0; i < wavelengths.um.size(); ++i) {
    const double centre_um = air_band_lambda_um(wavelengths.band[i]);
    view.thermal_shape_.push_back(planck_radiance_w_m2_sr_um(wavelengths.um[i], temperature_k) /
                                  planck_radiance_w_m2_sr_um(centre_um, temperature_k));
  }
  if (spec.imported) {
    const absl::Status s = view.take_import(*spec.imported, sensor_m, height_m);
    if (!s.ok()) return s;
  }
  view.see_sky();
  view.see_lower();
  for (std::size_t i = 0; i < view.sky_.size(); ++i) {
    view.ring_.push_back(view.spread_thermal(light.sky[i].total));
    view.ring_apparent_.push_back(view.spread_thermal(view.sky_[i]));
  }
  for (std::size_t i = 0; i < view.lower_.size(); ++i) {
    view.ring_.push_back(view.spread_thermal(light.lower[i].total));
    view.ring_apparent_.push_back(view.spread_thermal(view.lower_[i]));
  }
  return view;
}

absl::Status ViewLight::take_import(const ImportedPaths& paths, double sensor_height_m,
                                    double height_m) {
  const absl::StatusOr<const ImportedPath*> found =
      find_path(paths, sensor_height_m, height_m, line_.range_m);
  if (!found.ok()) return absl::InvalidArgumentError(found.status().message());
  const ImportedPath& path = **found;
  imported_ = true;
  imported_radiance_ = !path.radiance_w_m2_sr_um.empty();
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(wavelengths_->bands, b)) continue;
    if (std::isnan(path.transmittance[b]) ||
        (imported_radiance_ && std::isnan(path.radiance_w_m2_sr_um[b]))) {
      return absl::InvalidArgumentError(absl::StrFormat("%s:%d: no value at %.4g um", paths.file,
                                                        path.line, air_band_lambda_um(b)));
    }
    const double own = transmittance_[b];
    transmittance_[b] = path.transmittance[b];
    if (imported_radiance_) {
      path_radiance_[b] = path.radiance_w_m2_sr_um[b];
    } else {
      // The air's mean radiance along the path is the embedded model's.
      path_radiance_[b] *= own < 1 ? (1 - transmittance_[b]) / (1 - own) : 0;
    }
  }
  return absl::OkStatus();
}

void ViewLight::see_sky() {
  const std::size_t rings = light_->sky.size();
  std::vector<AirSpectrum> ratio;
  if (imported_) {
    ratio.assign(rings, transmittance_);
  } else {
    const std::vector<std::size_t> exact = exact_rings(rings);
    for (const std::size_t r : exact) {
      ratio.push_back(light_->sky_ratio(static_cast<std::uint32_t>(r), leg_->amounts()));
    }
    ratio = fill_in(exact, ratio, rings);
  }
  for (std::size_t r = 0; r < rings; ++r) {
    sky_.push_back(light_->sky[r].total);
    for (std::size_t b = 0; b < kAirBandCount; ++b) sky_[r][b] *= ratio[r][b];
  }
}

void ViewLight::see_lower() {
  const std::size_t rings = light_->lower.size();
  if (imported_) {
    for (const LowerRing& ring : light_->lower) {
      lower_.push_back(ring.total);
      for (std::size_t b = 0; b < kAirBandCount; ++b) lower_.back()[b] *= transmittance_[b];
    }
    return;
  }
  // Reflected sky through both legs; its lines are those of the ring that most of it comes from.
  const AbsorberAmounts& near = leg_->amounts();
  const std::vector<std::size_t> exact = exact_rings(rings);
  std::vector<AirSpectrum> ratio;
  for (const std::size_t r : exact) {
    const LowerRing& ring = light_->lower[r];
    AirSpectrum both = light_->sky_ratio(ring.mirrored_ring, ring.layers.amounts() + near);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const double alone = ring.reflected_ratio[b];
      both[b] = alone > 0 ? both[b] / alone : 0;
    }
    ratio.push_back(std::move(both));
  }
  ratio = fill_in(exact, ratio, rings);
  for (std::size_t r = 0; r < rings; ++r) {
    const LowerRing& ring = light_->lower[r];
    const PathLayers::Emission air = ring.layers.behind(near);
    const AirSpectrum both = transmittance(ring.layers.amounts() + near, wavelengths_->bands);
    AirSpectrum seen = air.thermal_w_m2_sr_um;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      seen[b] += air.surroundings_share[b] * light_->surroundings[b] + both[b] * ring.emission[b] +
                 ratio[r][b] * ring.reflected_ratio[b] * ring.reflected[b];
    }
    lower_.push_back(std::move(seen));
  }
}

std::vector<double> ViewLight::spread_thermal(const AirSpectrum& thermal) const {
  std::vector<double> out(wavelengths_->um.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = thermal[wavelengths_->band[i]] * thermal_shape_[i];
  }
  return out;
}

std::vector<double> ViewLight::plus_solar(std::vector<double> thermal,
                                          const AirSpectrum& solar) const {
  for (std::size_t i = 0; i < thermal.size(); ++i) {
    thermal[i] += solar[wavelengths_->band[i]] * wavelengths_->solar_shape[i];
  }
  return thermal;
}

ViewLight::Solar ViewLight::solar(const SunLight& sun) const {
  Solar s;
  s.irradiance = s.scattered = AirSpectrum(kAirBandCount, 0.0);
  if (!sun.shines()) return s;
  const std::size_t rings = light_->sky.size();
  if (!imported_radiance_) s.scattered = sun.scattered_by(*leg_, line_.direction);
  if (imported_) {
    s.irradiance = sun.irradiance;
    for (std::size_t b = 0; b < kAirBandCount; ++b) s.irradiance[b] *= transmittance_[b];
    s.sky_ratio.assign(rings, transmittance_);
    s.lower_air_ratio.assign(light_->lower.size(), transmittance_);
    s.lower_surface_ratio = s.lower_air_ratio;
    return s;
  }
  const AbsorberAmounts& near = leg_->amounts();
  SunLight::Near behind = sun.behind(near, *light_);
  s.irradiance = std::move(behind.irradiance);
  s.lower_air_ratio = std::move(behind.lower_air);
  s.lower_surface_ratio = std::move(behind.lower_surface);
  const std::vector<std::size_t> exact = exact_rings(rings);
  std::vector<AirSpectrum> ratio;
  for (const std::size_t r : exact) ratio.push_back(sun.sky_ratio(r, near, *light_));
  s.sky_ratio = fill_in(exact, ratio, rings);
  return s;
}

ViewEnvironment ViewLight::seen_under(const SunLight& sun) const {
  ViewEnvironment out;
  const std::size_t count = wavelengths_->um.size();
  const Solar solar = this->solar(sun);
  AirSpectrum error = error_.radiance_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    error[b] += kAerosolRelativeError * solar.scattered[b];
  }
  for (std::size_t i = 0; i < count; ++i) {
    out.transmittance.push_back(transmittance_[wavelengths_->band[i]]);
    out.model_error_transmittance.push_back(error_.transmittance[wavelengths_->band[i]]);
    out.model_error_path_radiance.push_back(error[wavelengths_->band[i]]);
  }
  out.path_radiance = plus_solar(spread_thermal(path_radiance_), solar.scattered);
  const std::vector<double> dark(count, 0.0);
  out.sun = plus_solar(dark, sun.irradiance);
  out.sun_apparent = plus_solar(dark, solar.irradiance);

  const std::uint32_t sky = nodes_->sky(), azimuths = nodes_->azimuths();
  AirSpectrum here(kAirBandCount), there(kAirBandCount);
  for (std::uint32_t n = 0; n < nodes_->count(); ++n) {
    const std::vector<double>&thermal = ring_[n / azimuths],
          &apparent = ring_apparent_[n / azimuths];
    if (!sun.shines()) {
      out.node.push_back(thermal);
      out.node_apparent.push_back(apparent);
      continue;
    }
    if (n < sky) {
      here = sun.sky[n];
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        there[b] = here[b] * solar.sky_ratio[n / azimuths][b];
      }
    } else {
      const std::uint32_t k = n - sky, r = k / azimuths;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        here[b] = sun.lower_air[k][b] + sun.lower_surface[k][b];
        there[b] = sun.lower_air[k][b] * solar.lower_air_ratio[r][b] +
                   sun.lower_surface[k][b] * solar.lower_surface_ratio[r][b];
      }
    }
    out.node.push_back(plus_solar(thermal, here));
    out.node_apparent.push_back(plus_solar(apparent, there));
  }
  add_behind(out, sun, solar);
  out.sky_interpolation = sun.shines() ? sun.sky_interpolation : light_->sky_interpolation;
  out.lower_interpolation = sun.shines() ? sun.lower_interpolation : light_->lower_interpolation;
  // Products of band means err by up to 40 % for the sky's and 11 % for the sun's lines over 5 km.
  out.sky_model_relative = std::hypot(sun.sky_model_relative, imported_ ? 0.2 : 0.0);
  out.lower_model_relative = std::hypot(light_->lower_model_relative, imported_ ? 0.05 : 0.0);
  out.sun_model_relative = std::hypot(kSunRelativeError, imported_ ? 0.1 : 0.0);
  return out;
}

// Thermal light is cubic in the sine of the elevation: where one sees the target before the sea,
// the difference of the two must not drown in the error of a linear interpolation. Aureole and
// glint are those of the very direction.
void ViewLight::add_behind(ViewEnvironment& out, const SunLight& sun, const Solar& solar) const {
  const std::uint32_t azimuths = nodes_->azimuths();
  std::vector<double> up, down;
  for (const SkyRing& r : light_->sky) up.push_back(r.sin_elevation);
  for (const LowerRing& r : light_->lower) down.push_back(r.sin_elevation);
  for (std::uint32_t n = 0; n < line_.behind.count(); ++n) {
    const Vec<Body> direction = line_.behind.direction(n);
    const bool above = n < line_.behind.sky();
    const std::vector<double>& sine = above ? up : down;
    const double s = std::clamp(std::abs(direction.z), sine.front(), sine.back());
    const Stencil stencil = cubic(sine, s);
    AirSpectrum thermal(kAirBandCount, 0.0), light(kAirBandCount, 0.0);
    for (std::size_t i = 0; i < stencil.count; ++i) {
      const AirSpectrum& from = (above ? sky_ : lower_)[stencil.first + i];
      for (std::size_t b = 0; b < kAirBandCount; ++b) thermal[b] += stencil.weight[i] * from[b];
    }
    for (double& x : thermal) x = std::max(0.0, x);
    if (sun.shines()) {
      const auto next = std::upper_bound(sine.begin(), sine.end(), s);
      const std::size_t ring =
          std::min(static_cast<std::size_t>(next - sine.begin()) - 1, sine.size() - 2);
      const double f = (s - sine[ring]) / (sine[ring + 1] - sine[ring]);
      const auto between = [&](const std::vector<AirSpectrum>& of, std::size_t b) {
        return (1 - f) * of[ring][b] + f * of[ring + 1][b];
      };
      if (above) {
        light = sun.sky_towards(direction, ring, f);
        for (std::size_t b = 0; b < kAirBandCount; ++b) light[b] *= between(solar.sky_ratio, b);
      } else {
        light = sun.glint_towards(direction, ring, f);
        double turn = std::atan2(direction.y, direction.x) / (2 * std::numbers::pi);
        turn = (turn < 0 ? turn + 1 : turn) * azimuths;
        const std::uint32_t a = std::min(static_cast<std::uint32_t>(turn), azimuths - 1);
        const double g = std::min(1.0, turn - a);
        const auto around = [&](const std::vector<AirSpectrum>& of, std::size_t r, std::size_t b) {
          return (1 - g) * of[r * azimuths + a][b] + g * of[r * azimuths + (a + 1) % azimuths][b];
        };
        for (std::size_t b = 0; b < kAirBandCount; ++b) {
          light[b] *= between(solar.lower_surface_ratio, b);
          for (std::size_t k = 0; k < 2; ++k) {
            const double w = k == 0 ? 1 - f : f;
            const std::size_t r = ring + k;
            light[b] += w * (around(sun.lower_air, r, b) * solar.lower_air_ratio[r][b] +
                             around(sun.lower_surface, r, b) * solar.lower_surface_ratio[r][b]);
          }
        }
      }
    }
    out.behind_apparent.push_back(plus_solar(spread_thermal(thermal), light));
  }
}

}  // namespace irsig
