#include "core/environment/sensor_path.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {

absl::StatusOr<NodeWavelengths> node_wavelengths(const std::vector<double>& um) {
  NodeWavelengths out;
  out.um = um;
  std::vector<unsigned char> wanted(kAirBandCount, 0);
  for (const double lambda_um : um) {
    ASSIGN_OR_RETURN(const std::size_t band, air_band(lambda_um));
    out.band.push_back(band);
    wanted[band] = 1;
    out.solar_shape.push_back(solar_irradiance_w_m2_um(lambda_um) /
                              solar_irradiance_w_m2_um(air_band_lambda_um(band)));
  }
  out.bands = BandChoice(wanted);
  std::vector<std::uint32_t> place(kAirBandCount);
  for (std::uint32_t b = 0; b < kAirBandCount; ++b) {
    place[b] = static_cast<std::uint32_t>(out.used.size());
    if (wanted[b] != 0) out.used.push_back(b);
  }
  for (const std::size_t b : out.band) out.used_band.push_back(place[b]);
  return out;
}

std::vector<double> NodeWavelengths::of_used(const AirSpectrum& of_band) const {
  std::vector<double> out;
  out.reserve(used.size());
  for (const std::uint32_t b : used) out.push_back(of_band[b]);
  return out;
}

namespace {

// The middle of what the Earth leaves in sight of a target, straight above its point.
struct InSight {
  absl::StatusOr<LightPath> path;
  double elevation_deg = 0;  // of the sensor there, geometric
};
InSight in_sight(const WeatherSpec& spec, const AirProfile& profile, double sensor_m,
                 double central_angle_rad, double hidden_m, double highest_m) {
  const double half_chord = std::sin(0.5 * central_angle_rad);
  const auto at = [&](double height_m) {
    const double rise_m = sensor_m - height_m, r = kEarthRadiusM + height_m;
    const double range_m =
        std::hypot(rise_m, 2 * half_chord * std::sqrt(r * (kEarthRadiusM + sensor_m)));
    const double up_m = rise_m - 2 * (kEarthRadiusM + sensor_m) * half_chord * half_chord;
    return InSight{look_between(profile, sensor_m, height_m, range_m, spec.refraction),
                   std::asin(std::clamp(up_m / range_m, -1.0, 1.0)) / kRadPerDeg};
  };
  if (!(highest_m > hidden_m)) return {absl::OutOfRangeError("nothing is higher"), 0};
  InSight top = at(highest_m);
  if (!top.path.ok()) return top;
  double low_m = hidden_m, high_m = highest_m;
  for (int i = 0; i < 12; ++i) {
    const double middle_m = 0.5 * (low_m + high_m);
    (at(middle_m).path.ok() ? high_m : low_m) = middle_m;
  }
  InSight middle = at(0.5 * (high_m + highest_m));
  return middle.path.ok() ? middle : top;
}

// Returns the highest of the target's places, as the profile counts; 0: none is stated.
double highest_m(const SensorLine& line, double reference_m) {
  double out = 0;
  for (const SensorLine::End& end : line.end) {
    out = std::max(out, end.height_m + reference_m);
  }
  return out;
}

}  // namespace

absl::StatusOr<SensorRay> sensor_ray(const WeatherSpec& spec, const Atmosphere& atmosphere,
                                     double height_m, const SensorLine& line,
                                     const BandChoice& bands) {
  const double reference_m = spec.above_surface_m;
  if (!(line.range_m >= 0 && std::isfinite(line.range_m) && line.elevation_deg >= -90 &&
        line.elevation_deg <= 90)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "a line of sight of range_m %g at elevation_deg %g", line.range_m, line.elevation_deg));
  }
  const AirProfile& profile = atmosphere.profile();
  const double bottom_m = profile.level.front().height_m;
  const double r = kEarthRadiusM + height_m, d = line.range_m;
  const double rise_m = d * std::sin(line.elevation_deg * kRadPerDeg);
  // r' - r without the loss of digits
  const double r_sensor = std::sqrt(r * r + d * d + 2 * r * rise_m);
  SensorRay out;
  out.sensor_height_m = height_m + (d * d + 2 * r * rise_m) / (r_sensor + r);
  if (out.sensor_height_m < bottom_m) {
    return absl::InvalidArgumentError(
        absl::StrFormat("the sensor, %g m away at %g deg, would be %.4g m below the surface", d,
                        line.elevation_deg, bottom_m - out.sensor_height_m));
  }
  double elevation_deg = line.elevation_deg;
  absl::StatusOr<LightPath> path =
      look_between(profile, out.sensor_height_m, height_m, d, spec.refraction);
  if (absl::IsOutOfRange(path.status())) {
    const double sensor_m = out.sensor_height_m;
    const double along_m = d * std::cos(line.elevation_deg * kRadPerDeg);
    const InSight seen = in_sight(spec, profile, sensor_m, std::atan2(along_m, r + rise_m),
                                  height_m, highest_m(line, reference_m));
    if (seen.path.ok()) {
      path = seen.path;
      elevation_deg = seen.elevation_deg;
    }
  }
  if (!path.ok()) return absl::InvalidArgumentError(path.status().message());
  out.path = *std::move(path);
  if (spec.refraction && !out.path.step_m.empty()) {
    out.lift_rad = (out.path.node.back().zenith_deg - 90 - elevation_deg) * kRadPerDeg;
  }
  if (!spec.imported) return out;

  const absl::StatusOr<const ImportedPath*> found =
      find_path(*spec.imported, out.sensor_height_m, height_m, d);
  if (!found.ok()) return absl::InvalidArgumentError(found.status().message());
  out.imported = *found;
  const AirSpectrum& radiance = out.imported->radiance_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands, b)) continue;
    if (std::isnan(out.imported->transmittance[b]) ||
        (!radiance.empty() && std::isnan(radiance[b]))) {
      return absl::InvalidArgumentError(absl::StrFormat("%s:%d: no value at %.4g um",
                                                        spec.imported->file, out.imported->line,
                                                        air_band_lambda_um(b)));
    }
  }
  return out;
}

SensorRay end_path(const WeatherSpec& spec, const Atmosphere& atmosphere, double height_m,
                   const SensorRay& line, const SensorLine::End& end) {
  const AirProfile& profile = atmosphere.profile();
  const double lowest_m = std::max(end.height_m, profile.level.front().height_m);
  constexpr int kSteps = 8;
  for (int i = 0; i < kSteps; ++i) {
    const double rise = static_cast<double>(i) / kSteps;
    absl::StatusOr<LightPath> path =
        look_between(profile, line.sensor_height_m, std::lerp(lowest_m, height_m, rise),
                     end.range_m, spec.refraction);
    if (path.ok()) return {*std::move(path), line.sensor_height_m, 0, nullptr};
  }
  return {line.path, line.sensor_height_m, 0, nullptr};
}

SensorRay land_path(const WeatherSpec& spec, const Atmosphere& atmosphere, double height_m,
                    const SensorRay& line, const SensorLine& sight, double range_m) {
  // Height of the straight line at that range, above a spherical Earth.
  const double beyond_m = sight.range_m - range_m, r = kEarthRadiusM + height_m;
  const double rise_m = beyond_m * std::sin(sight.elevation_deg * kRadPerDeg);
  const double r_land = std::sqrt(r * r + beyond_m * beyond_m + 2 * r * rise_m);
  const double land_m = height_m + (beyond_m * beyond_m + 2 * r * rise_m) / (r_land + r);
  return end_path(spec, atmosphere, height_m, line, {range_m, land_m});
}

SensorPath::SensorPath(const SensorRay& path, const Atmosphere& atmosphere, double height_m,
                       const NodeWavelengths& wavelengths, const CloudLight* cloud,
                       const HazeLight* haze)
    : layers(atmosphere, path.path, wavelengths.bands, cloud, haze),
      transmittance(layers.transmittance),
      imported(path.imported != nullptr),
      imported_radiance(imported && !path.imported->radiance_w_m2_sr_um.empty()),
      lowest_m(std::min({path.sensor_height_m, height_m, lowest_height_m(path.path)})),
      highest_m(std::max(path.sensor_height_m, height_m)),
      wavelengths_(&wavelengths),
      import_(path.imported) {
  for (std::size_t b = 0; imported && b < kAirBandCount; ++b) {
    if (chosen(wavelengths.bands, b)) transmittance[b] = import_->transmittance[b];
  }
  const double temperature_k = air_at(atmosphere.profile(), height_m).temperature_k;
  for (std::size_t i = 0; i < wavelengths.um.size(); ++i) {
    const double centre_um = air_band_lambda_um(wavelengths.band[i]);
    thermal_shape_.push_back(planck_radiance_w_m2_sr_um(wavelengths.um[i], temperature_k) /
                             planck_radiance_w_m2_sr_um(centre_um, temperature_k));
  }
}

AirSpectrum SensorPath::radiance(const AirSpectrum* surroundings) const {
  AirSpectrum out = layers.thermal_w_m2_sr_um;
  for (std::size_t b = 0; surroundings && b < kAirBandCount; ++b) {
    out[b] += layers.surroundings_fraction[b] * (*surroundings)[b];
  }
  for (std::size_t b = 0; imported && b < kAirBandCount; ++b) {
    if (!chosen(wavelengths_->bands, b)) continue;
    if (imported_radiance) {
      out[b] = import_->radiance_w_m2_sr_um[b];
    } else {
      // The air's mean radiance along the path is the embedded model's.
      const double own = layers.transmittance[b];
      out[b] *= own < 1 ? (1 - transmittance[b]) / (1 - own) : 0;
    }
  }
  return out;
}

std::vector<double> SensorPath::per_wavelength(const AirSpectrum& of_band) const {
  std::vector<double> out;
  for (const std::size_t band : wavelengths_->band) out.push_back(of_band[band]);
  return out;
}

std::vector<double> SensorPath::spread_thermal(const AirSpectrum& thermal) const {
  std::vector<double> out(wavelengths_->um.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = thermal[wavelengths_->band[i]] * thermal_shape_[i];
  }
  return out;
}

IncidentRadiance::Shapes SensorPath::shapes() const {
  return {wavelengths_->used.size(), wavelengths_->used_band, thermal_shape_,
          wavelengths_->solar_shape};
}

std::vector<double> SensorPath::plus_solar(std::vector<double> thermal,
                                           const AirSpectrum& solar) const {
  for (std::size_t i = 0; i < thermal.size(); ++i) {
    thermal[i] += solar[wavelengths_->band[i]] * wavelengths_->solar_shape[i];
  }
  return thermal;
}

}  // namespace irsig
