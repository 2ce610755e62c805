#include "core/environment/weather_air.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/atmosphere/cloud_light.h"
#include "core/atmosphere/haze_light.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/scattered_again.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/broken_cloud.h"
#include "core/environment/environment.h"
#include "core/environment/thermal_surroundings.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

constexpr double kHighestM = 50e3;  // next to no scattering above

double cos_to_sun(const LightPath& path, const SunPlace& sun) {
  const double z = path.node.front().zenith_deg * kRadPerDeg, s = sun.zenith_deg * kRadPerDeg;
  return std::clamp(std::sin(z) * std::sin(s) * std::cos(sun.azimuth_deg * kRadPerDeg) +
                        std::cos(z) * std::cos(s),
                    -1.0, 1.0);
}

}  // namespace

struct WeatherAir::Parts {
  // A sky of cloud alone, or air with fog.
  struct Turbid {
    Atmosphere diffuse, beam;
    BandChoice bands;
    DirectionNodes rings;
    std::unique_ptr<const ThermalSurroundings> light;

    Turbid(Atmosphere of_sky, Atmosphere of_beam, const DirectionNodes& nodes)
        : diffuse(std::move(of_sky)), beam(std::move(of_beam)), rings(nodes) {}
    //   height_m  as the profile counts
    [[nodiscard]] static absl::StatusOr<std::unique_ptr<const Turbid>> make(
        const WeatherSpec& weather, bool overcast, double height_m, const DirectionNodes& rings);
    [[nodiscard]] PathRadiance radiance(Sight sight, const LightPath& path,
                                        const std::optional<SunPlace>& sun,
                                        const AirSpectrum& surroundings) const;
    [[nodiscard]] AirSpectrum scattered_sun(Sight sight, const LightPath& path,
                                            const PathLayers& layers, const SunPlace& sun) const;
    // Sunlight that a ray scatters once, and more often by haze.
    struct Hazy {
      AirSpectrum once, again;
    };
    [[nodiscard]] Hazy hazy_sun(const LightPath& path, const PathLayers& once,
                                const PathLayers& often, const SunPlace& sun) const;
    // Adds light that haze scatters more than once to a ray's light scattered once.
    void add_haze(PathRadiance& out, const LightPath& path, const std::optional<SunPlace>& sun,
                  const AirSpectrum& surroundings) const;
  };
  WeatherSpec weather;
  std::unique_ptr<const Environment> environment;  // of the clear sky
  std::optional<Atmosphere> clear;
  std::unique_ptr<const Turbid> fog;       // of the clear sky; null without fog
  std::unique_ptr<const Turbid> haze;      // of the clear sky; null where it scatters once
  std::unique_ptr<const Turbid> overcast;  // null without a cover
};

AirSpectrum WeatherAir::Parts::Turbid::scattered_sun(Sight sight, const LightPath& path,
                                                     const PathLayers& layers,
                                                     const SunPlace& sun) const {
  AirSpectrum out(kAirBandCount, 0.0);
  const double observer_m = path.node.front().height_m;
  const double lowest_m = std::min(diffuse.turbid_levels_m().front(), lowest_height_m(path));
  const SunAmounts amounts(diffuse, lowest_m, sun.zenith_deg, bands);
  if (!amounts.lit()) return out;
  const CloudSunlight in_cloud(*light->cloud(), amounts, sun.zenith_deg);
  ScatteredSun source = layers.scattered(amounts, nullptr, &in_cloud);
  if (sight == Sight::kDiffuse && path.end == PathEnd::kSpace && !diffuse.only_fog()) {
    // The beam's loss to the forward peak.
    const auto through = [&](const Atmosphere& air) {
      AbsorberAmounts sum;
      return SunAmounts(air, lowest_m, sun.zenith_deg, bands).add_to(sum, observer_m)
                 ? transmittance(sum)
                 : AirSpectrum(kAirBandCount, 0.0);
    };
    const AirSpectrum both = through(diffuse), alone = through(beam);
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      source.peak[b] = std::max(0.0, both[b] - alone[b]);
  }
  const double cosine = cos_to_sun(path, sun);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out[b] = source.per_sr(b, cosine) * solar_irradiance_w_m2_um(air_band_lambda_um(b)) /
             (sun.distance_au * sun.distance_au);
  }
  return out;
}

PathRadiance WeatherAir::Parts::Turbid::radiance(Sight sight, const LightPath& path,
                                                 const std::optional<SunPlace>& sun,
                                                 const AirSpectrum& surroundings) const {
  const AirSpectrum dark(kAirBandCount, 0.0);
  PathRadiance out;
  if (path.step_m.empty()) {
    out.transmittance = AirSpectrum(kAirBandCount, 1.0);
    out.thermal_w_m2_sr_um = out.scattered_w_m2_sr_um = out.total_w_m2_sr_um = dark;
    out.model_error_transmittance = out.model_error_w_m2_sr_um = dark;
    return out;
  }
  SkyRing ring{std::cos(path.node.front().zenith_deg * kRadPerDeg),
               std::make_shared<const PathLayers>(sight == Sight::kSharp ? beam : diffuse, path,
                                                  bands, light->cloud()),
               {}};
  const PathLayers& layers = *ring.layers;
  const AbsorberAmounts amounts = beam.amounts(path);
  out.transmittance = transmittance(amounts);
  out.thermal_w_m2_sr_um = layers.thermal_w_m2_sr_um;
  out.scattered_w_m2_sr_um = layers.surroundings_fraction;
  for (std::size_t b = 0; b < kAirBandCount; ++b) out.scattered_w_m2_sr_um[b] *= surroundings[b];
  ModelError error = model_error(amounts, out.transmittance, out.scattered_w_m2_sr_um,
                                 layers.warmest_k(), bands, &surroundings);
  ring.total = dark;
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    ring.total[b] = out.thermal_w_m2_sr_um[b] + out.scattered_w_m2_sr_um[b];
  out.model_error_transmittance = std::move(error.transmittance);
  out.model_error_w_m2_sr_um =
      sight == Sight::kDiffuse ? light->model_error_of(ring) : std::move(error.radiance_w_m2_sr_um);
  if (sun) {
    const AirSpectrum of_sun = scattered_sun(sight, path, layers, *sun);
    const UnknownCloud* unknown = light->unknown_cloud();
    const double observer_m = path.node.front().height_m;
    const AirSpectrum by_cloud = unknown
                                     ? unknown->diffuse_sun_relative(observer_m, sun->zenith_deg)
                                     : dark,
                      again = scattered_again_relative(diffuse, observer_m, sun->zenith_deg, bands);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      out.scattered_w_m2_sr_um[b] += of_sun[b];
      out.model_error_w_m2_sr_um[b] +=
          std::hypot(kAerosolRelativeError, by_cloud[b], again[b]) * of_sun[b];
    }
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    out.total_w_m2_sr_um.push_back(out.thermal_w_m2_sr_um[b] + out.scattered_w_m2_sr_um[b]);
  return out;
}

WeatherAir::Parts::Turbid::Hazy WeatherAir::Parts::Turbid::hazy_sun(const LightPath& path,
                                                                    const PathLayers& once,
                                                                    const PathLayers& often,
                                                                    const SunPlace& sun) const {
  Hazy out{AirSpectrum(kAirBandCount, 0.0), AirSpectrum(kAirBandCount, 0.0)};
  const SunAmounts amounts(beam, lowest_height_m(path), sun.zenith_deg, bands);
  if (!amounts.lights_any()) return out;
  const HazeSunlight again(*light->haze(), beam, sun.zenith_deg);
  const ScatteredSun all = often.scattered(amounts, nullptr, nullptr, &again),
                     single = once.scattered(amounts);
  const double cosine = cos_to_sun(path, sun);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double outside =
        solar_irradiance_w_m2_um(air_band_lambda_um(b)) / (sun.distance_au * sun.distance_au);
    out.once[b] = outside * single.per_sr(b, cosine);
    out.again[b] = outside * all.per_sr(b, cosine) - out.once[b];
  }
  return out;
}

// Dense haze dims the sun between the few nodes at which a single ray knows its amounts: light
// scattered once becomes that of rows by the same fraction as light that is scattered again, and so
// does the error.
void WeatherAir::Parts::Turbid::add_haze(PathRadiance& out, const LightPath& path,
                                         const std::optional<SunPlace>& sun,
                                         const AirSpectrum& surroundings) const {
  const HazeLight& haze = *light->haze();
  const double fraction = haze.fraction();
  const PathLayers once(beam, path, bands), often(beam, path, bands, nullptr, &haze);
  AirSpectrum around = often.surroundings_fraction;
  for (std::size_t b = 0; b < kAirBandCount; ++b) around[b] *= surroundings[b];
  const ModelError error = model_error(often.amounts(), often.transmittance, around,
                                       often.warmest_k(), bands, &surroundings, 1);
  AirSpectrum relative;
  Hazy of_sun;
  if (sun) {
    of_sun = hazy_sun(path, once, often, *sun);
    relative = scattered_again_relative(beam, path.node.front().height_m, sun->zenith_deg, bands);
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double before =
        out.scattered_w_m2_sr_um[b] - once.surroundings_fraction[b] * surroundings[b];
    double light_of_sun = 0, its_error = 0;
    if (sun) {
      light_of_sun = std::lerp(before, of_sun.once[b], fraction) + of_sun.again[b];
      its_error = light_of_sun *
                  std::hypot(kAerosolRelativeError, relative[b], low_sun_relative(sun->zenith_deg));
    }
    out.scattered_w_m2_sr_um[b] =
        around[b] + often.thermal_w_m2_sr_um[b] - once.thermal_w_m2_sr_um[b] + light_of_sun;
    out.total_w_m2_sr_um[b] = out.thermal_w_m2_sr_um[b] + out.scattered_w_m2_sr_um[b];
    out.model_error_w_m2_sr_um[b] = std::lerp(out.model_error_w_m2_sr_um[b],
                                              error.radiance_w_m2_sr_um[b] + its_error, fraction);
  }
  out.scattering_optical_depth *= 1 - fraction;
}

absl::StatusOr<std::unique_ptr<const WeatherAir::Parts::Turbid>> WeatherAir::Parts::Turbid::make(
    const WeatherSpec& weather, bool overcast, double height_m, const DirectionNodes& rings) {
  ASSIGN_OR_RETURN(Atmosphere diffuse, turbid_atmosphere(weather, ForwardPeak::kDiffuse, overcast));
  ASSIGN_OR_RETURN(Atmosphere beam, turbid_atmosphere(weather, ForwardPeak::kBeam, overcast));
  auto out = std::make_unique<Turbid>(std::move(diffuse), std::move(beam), rings);
  out->light = std::make_unique<const ThermalSurroundings>(weather, out->diffuse, height_m,
                                                           out->rings, out->bands, 0);
  return out;
}

WeatherAir::WeatherAir(std::unique_ptr<const Parts> parts) : parts_(std::move(parts)) {}
WeatherAir::WeatherAir(WeatherAir&&) noexcept = default;
WeatherAir& WeatherAir::operator=(WeatherAir&&) noexcept = default;
WeatherAir::~WeatherAir() = default;

absl::StatusOr<WeatherAir> WeatherAir::make(WeatherSpec weather, double height_m) {
  auto parts = std::make_unique<Parts>();
  weather.imported = nullptr;
  weather.above_surface_m = 0;
  parts->weather = std::move(weather);
  const WeatherSpec& of = parts->weather;
  IRSIG_CHECK((of.cloud_cover >= 0 && of.cloud_cover <= 1));
  ASSIGN_OR_RETURN(Atmosphere clear, Atmosphere::make(of.air));
  parts->clear.emplace(std::move(clear));
  const double lowest_m = parts->clear->profile().level.front().height_m;
  const double above_m = std::clamp(height_m - lowest_m, kLowestAirPointM, kHighestM);
  std::vector<double> um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) um.push_back(air_band_lambda_um(b));
  WeatherSpec without = of;
  without.cloud_cover = 0;
  ASSIGN_OR_RETURN(parts->environment, Environment::make({without}, {{0, false, {0, 0, -1}, 1}},
                                                         above_m, std::move(um)));
  const DirectionNodes& rings = parts->environment->nodes(false);
  if (of.cloud_cover > 0) {
    IRSIG_CHECK(of.cloud.has_value());
    ASSIGN_OR_RETURN(parts->overcast, Parts::Turbid::make(of, true, lowest_m + above_m, rings));
  }
  if (!parts->clear->turbid_levels_m().empty()) {
    ASSIGN_OR_RETURN(parts->fog, Parts::Turbid::make(of, false, lowest_m + above_m, rings));
  } else if (haze_fraction(*parts->clear) > 0) {
    ASSIGN_OR_RETURN(parts->haze, Parts::Turbid::make(of, false, lowest_m + above_m, rings));
  }
  return WeatherAir(std::move(parts));
}

absl::StatusOr<PathRadiance> WeatherAir::radiance(
    Sight sight, const Ray& ray, const std::optional<SunPlace>& sun,
    const AirSpectrum* surroundings_w_m2_sr_um) const {
  const auto through = [&](const Parts::Turbid& of) -> absl::StatusOr<PathRadiance> {
    ASSIGN_OR_RETURN(const LightPath path, ray(of.diffuse.profile()));
    AirSpectrum around =
        surroundings_w_m2_sr_um ? *surroundings_w_m2_sr_um : of.light->surroundings;
    around.resize(kAirBandCount, 0.0);
    return of.radiance(sight, path, sun, around);
  };
  const auto through_clear = [&]() -> absl::StatusOr<PathRadiance> {
    if (parts_->fog) return through(*parts_->fog);
    ASSIGN_OR_RETURN(const LightPath path, ray(parts_->clear->profile()));
    PathLight light;
    light.sun = sun;
    light.surroundings_w_m2_sr_um = surroundings_w_m2_sr_um
                                        ? *surroundings_w_m2_sr_um
                                        : parts_->environment->surroundings_w_m2_sr_um(0);
    PathRadiance out = parts_->clear->radiance(path, light);
    if (parts_->haze && !path.step_m.empty())
      parts_->haze->add_haze(out, path, sun, light.surroundings_w_m2_sr_um);
    return out;
  };
  ASSIGN_OR_RETURN(PathRadiance clear, through_clear());
  if (!parts_->overcast) return clear;
  ASSIGN_OR_RETURN(const PathRadiance overcast, through(*parts_->overcast));
  const CloudMixer mix{parts_->weather.cloud_cover};
  PathRadiance out;
  out.transmittance = mix(clear.transmittance, overcast.transmittance);
  out.thermal_w_m2_sr_um = mix(clear.thermal_w_m2_sr_um, overcast.thermal_w_m2_sr_um);
  out.scattered_w_m2_sr_um = mix(clear.scattered_w_m2_sr_um, overcast.scattered_w_m2_sr_um);
  out.total_w_m2_sr_um = mix(clear.total_w_m2_sr_um, overcast.total_w_m2_sr_um);
  out.model_error_transmittance =
      mix.error(clear.model_error_transmittance, overcast.model_error_transmittance,
                clear.transmittance, overcast.transmittance);
  out.model_error_w_m2_sr_um =
      mix.error(clear.model_error_w_m2_sr_um, overcast.model_error_w_m2_sr_um,
                clear.total_w_m2_sr_um, overcast.total_w_m2_sr_um);
  out.scattering_optical_depth = clear.scattering_optical_depth;
  return out;
}

AirSpectrum WeatherAir::sun_irradiance_w_m2_um(double height_m, const SunPlace& sun) const {
  AirSpectrum clear = parts_->clear->sun_irradiance_w_m2_um(height_m, sun);
  if (!parts_->overcast) return clear;
  return CloudMixer{parts_->weather.cloud_cover}(
      clear, parts_->overcast->beam.sun_irradiance_w_m2_um(height_m, sun));
}

}  // namespace irsig
