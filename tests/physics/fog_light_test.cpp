// Rationale: fog scatters light many times: what it shows is neither a black body's light nor
// sunlight scattered once.
// Expected: level paths and skies in fog within 0.5 K (8-12 um), its sunlight within 10 %, of
// photons followed one by one through the same layers; a deep fog black within 0.3 K; nothing but
// a black body's light where all is as warm. Source: a Monte Carlo below, with the air's absorption
// grey in a band, and the full phase function.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/atmosphere/light_path.h"
#include "core/environment/weather_air.h"
#include "core/spectral/planck.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

constexpr double kGroundK = 294.2, kGroundAlbedo = 0.05, kObserverM = 2;
constexpr double kTopM = kFogTopM;
constexpr int kPhotons = 40000;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

WeatherSpec fog_of(AerosolKind kind, double visibility_m) {
  WeatherSpec out;
  out.air.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  out.air.aerosol.kind = kind;
  out.air.aerosol.visibility_m = visibility_m;
  out.lower.kind = SurfaceBoundary::Kind::kGround;
  out.lower.temperature_k = kGroundK;
  out.lower.emissivity = 1 - kGroundAlbedo;
  return out;
}

double kelvin(std::size_t band, double radiance) {
  const double um = air_band_lambda_um(band);
  double low = 100, high = 400;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (planck_radiance_w_m2_sr_um(um, middle) < radiance ? low : high) = middle;
  }
  return low;
}

// Photons followed backwards from an observer in the fog of one band.
class FogPhotons {
 public:
  FogPhotons(const WeatherSpec& weather, std::size_t band) : band_(band) {
    const Atmosphere air = Atmosphere::make(weather.air).value();
    AtmosphereSpec without = weather.air;
    without.aerosol.kind = AerosolKind::kRural;
    const Atmosphere clear = Atmosphere::make(std::move(without)).value();
    double depth = 0, particles = 0;
    for (double z = 0; z < kTopM; z += kStepM) {
      const AbsorberAmounts to_here = air.amounts(look(air.profile(), 0, 0, z + kStepM, false));
      const double scattering = to_here.grey(GreyAbsorber::kAerosolScattering)[band];
      const double here = -std::log(transmittance(to_here)[band]);
      const AerosolOptics optics =
          aerosol_optics(weather.air.aerosol, z + 0.5 * kStepM,
                         relative_humidity_percent(air_at(air.profile(), z + 0.5 * kStepM)), 0);
      layer_.push_back({here - depth, (scattering - particles) / (here - depth),
                        optics.asymmetry[band],
                        planck(air_at(air.profile(), z + 0.5 * kStepM).temperature_k)});
      depth = here;
      particles = scattering;
    }
    for (int i = 0; i < kSkies; ++i) {
      const double zenith_deg = std::acos((i + 0.5) / kSkies) * 180 / M_PI;
      above_.push_back(clear.sky_radiance(kTopM, zenith_deg).total_w_m2_sr_um[band]);
    }
  }

  struct Light {
    double thermal = 0, sun_per_sr = 0;
  };
  //   cosine   of the direction of sight's zenith angle
  //   range_m  behind which the path's own light ends
  //   per_m    extinction of the path up to the first collision, where it is level; 0: the layers'
  //   sun      cosine of its zenith angle; its irradiance normal to the beam at the top is 1
  [[nodiscard]] Light seen(double cosine, double range_m, double sun, double per_m) const {
    constexpr int photons = kPhotons;
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> u;
    Light sum;
    for (int i = 0; i < photons; ++i) {
      Vec<Body> d{std::sqrt(1 - cosine * cosine) * std::cos(kAzimuth),
                  std::sqrt(1 - cosine * cosine) * std::sin(kAzimuth), cosine};
      double z = kObserverM;
      for (bool first = true;; first = false) {
        const double depth = -std::log(1 - u(random));
        const bool level = first && per_m > 0;
        if (level ? depth > per_m * range_m : advance(z, d.z, depth) > range_m && first) break;
        if (z >= kTopM) {
          sum.thermal +=
              above_[std::min<std::size_t>(static_cast<std::size_t>(d.z * kSkies), kSkies - 1)];
          break;
        }
        if (z <= 0) {
          if (u(random) > kGroundAlbedo) {
            sum.thermal += planck(kGroundK);
            break;
          }
          sum.sun_per_sr += std::exp(-depth_above(0) / sun) * sun / M_PI;
          const double up = std::sqrt(u(random)), turn = 2 * M_PI * u(random);
          d = {std::sqrt(1 - up * up) * std::cos(turn), std::sqrt(1 - up * up) * std::sin(turn),
               up};
          z = 1e-9;
          continue;
        }
        const Layer& here = layer_[index(z)];
        const double albedo = level ? here.albedo * here.depth / (kStepM * per_m) : here.albedo;
        if (u(random) > albedo) {
          sum.thermal += here.planck;
          break;
        }
        const double to_sun = d.x * std::sqrt(1 - sun * sun) + d.z * sun;
        const double g = here.asymmetry, e = 1 + g * g - 2 * g * to_sun;
        sum.sun_per_sr +=
            std::exp(-depth_above(z) / sun) * (1 - g * g) / (4 * M_PI * e * std::sqrt(e));
        d = turned(d, g, u(random), 2 * M_PI * u(random));
      }
    }
    return {sum.thermal / photons, sum.sun_per_sr / photons};
  }

 private:
  static constexpr double kStepM = 25, kAzimuth = 1.5;
  static constexpr int kSkies = 8;
  struct Layer {
    double depth, albedo, asymmetry, planck;
  };

  [[nodiscard]] double planck(double kelvin) const {
    return planck_radiance_w_m2_sr_um(air_band_lambda_um(band_), kelvin);
  }
  [[nodiscard]] std::size_t index(double z) const {
    return std::min(static_cast<std::size_t>(z / kStepM), layer_.size() - 1);
  }
  [[nodiscard]] double depth_above(double z) const {
    double sum = 0;
    for (std::size_t i = index(z); i < layer_.size(); ++i)
      sum += layer_[i].depth * (i == index(z) ? (static_cast<double>(i) + 1) - z / kStepM : 1);
    return sum;
  }
  // Moves z along a direction by an optical depth, or to a boundary; returns the way. [m]
  [[nodiscard]] double advance(double& z, double rise, double depth) const {
    double way = 0;
    for (;;) {
      const std::size_t i = index(z);
      const double per_m = layer_[i].depth / kStepM;
      const double edge =
          rise > 0 ? (static_cast<double>(i) + 1) * kStepM : static_cast<double>(i) * kStepM;
      const double to_edge = std::abs(rise) > 1e-12 ? (edge - z) / rise : kInfinity;
      if (per_m * to_edge >= depth) {
        z += rise * depth / per_m;
        return way + depth / per_m;
      }
      depth -= per_m * to_edge;
      way += to_edge;
      z = edge + (rise > 0 ? 1e-9 : -1e-9);
      if (z <= 0 || z >= kTopM) return way;
    }
  }
  static Vec<Body> turned(const Vec<Body>& d, double g, double u, double azimuth) {
    const double s = (1 - g * g) / (1 - g + 2 * g * u);
    const double cosine = (1 + g * g - s * s) / (2 * g);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Vec<Body> axis = std::abs(d.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
    const Vec<Body> p = normalized(cross(d, axis)), q = cross(d, p);
    return normalized(cosine * d + sine * std::cos(azimuth) * p + sine * std::sin(azimuth) * q);
  }

  std::size_t band_;
  std::vector<Layer> layer_;  // from the ground up
  std::vector<double> above_;
};

struct Fog {
  AerosolKind kind;
  double visibility_m;
};
const Fog kFogs[] = {{AerosolKind::kAdvectionFog, 200},
                     {AerosolKind::kRadiationFog, 500},
                     {AerosolKind::kAdvectionFog, 1000},
                     {AerosolKind::kRadiationFog, 1000}};

std::size_t band_of(double wavenumber_cm1) { return air_band(1e4 / wavenumber_cm1).value(); }

TEST(Fog, LevelPathsShineAsPhotonsHaveIt) {
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const PathRadiance path =
        air.radiance(WeatherAir::Sight::kSharp,
                     [](const AirProfile&) { return level_path(kObserverM, 1000); }, {})
            .value();
    for (const double cm1 : {845.0, 935.0, 1105.0, 1185.0}) {
      const std::size_t b = band_of(cm1);
      const double photons = FogPhotons(weather, b)
                                 .seen(0, 1000, 0.7, -1e-3 * std::log(path.transmittance[b]))
                                 .thermal;
      // Thinner fog is a thinner layer: two streams know less of its directions.
      EXPECT_NEAR(kelvin(b, path.total_w_m2_sr_um[b]), kelvin(b, photons),
                  fog.visibility_m < 1000 ? 0.5 : 1.0)
          << cm1 << " cm-1, " << fog.visibility_m << " m";
    }
  }
}

TEST(Fog, SkiesShineAsPhotonsHaveIt) {
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    for (const double zenith_deg : {0.0, 60.0, 80.0}) {
      const PathRadiance sky =
          air.radiance(WeatherAir::Sight::kDiffuse,
                       [&](const AirProfile& profile) {
                         return look(profile, kObserverM, zenith_deg, kInfinity);
                       },
                       {})
              .value();
      for (const double cm1 : {845.0, 1105.0}) {
        const std::size_t b = band_of(cm1);
        const double photons = FogPhotons(weather, b)
                                   .seen(std::cos(zenith_deg * M_PI / 180), kInfinity, 0.7, 0)
                                   .thermal;
        EXPECT_NEAR(kelvin(b, sky.total_w_m2_sr_um[b]), kelvin(b, photons), 1.0)
            << cm1 << " cm-1, " << fog.visibility_m << " m, " << zenith_deg;
      }
    }
  }
}

TEST(Fog, SunlightAsPhotonsHaveIt) {
  const std::size_t b = band_of(2605);
  for (const Fog& fog : kFogs) {
    const WeatherSpec weather = fog_of(fog.kind, fog.visibility_m);
    const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
    const Atmosphere beam = Atmosphere::make(weather.air).value();
    const SunPlace sun{.zenith_deg = 45, .azimuth_deg = 90, .distance_au = 1};
    const double at_top = beam.sun_irradiance_w_m2_um(kTopM, sun)[b];
    for (const double zenith_deg : {0.0, 60.0}) {
      const auto sky = [&](const std::optional<SunPlace>& by) {
        return air
            .radiance(
                WeatherAir::Sight::kDiffuse,
                [&](const AirProfile& profile) {
                  return look(profile, kObserverM, zenith_deg, kInfinity);
                },
                by)
            .value()
            .total_w_m2_sr_um[b];
      };
      const double photons =
          at_top * FogPhotons(weather, b)
                       .seen(std::cos(zenith_deg * M_PI / 180), kInfinity, std::sqrt(0.5), 0)
                       .sun_per_sr;
      // What comes through a depth of 20 is lost in what the fog emits.
      const double lost = 5e-3 * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kGroundK);
      EXPECT_NEAR(sky(sun) - sky({}), photons,
                  (fog.visibility_m < 1000 ? 0.1 : 0.25) * photons + lost)
          << fog.visibility_m << " m, " << zenith_deg;
    }
  }
}

TEST(Fog, DeepIsBlack) {
  const WeatherAir air =
      WeatherAir::make(fog_of(AerosolKind::kAdvectionFog, 200), kObserverM).value();
  const PathRadiance path =
      air.radiance(WeatherAir::Sight::kSharp,
                   [](const AirProfile&) { return level_path(kObserverM, 5000); }, {})
          .value();
  for (std::size_t b = band_of(835); b <= band_of(1245); ++b)
    EXPECT_NEAR(kelvin(b, path.total_w_m2_sr_um[b]), kGroundK, 0.3) << air_band_centre_cm1(b);
}

TEST(Fog, OfIsothermalAirIsABlackBody) {
  WeatherSpec weather = fog_of(AerosolKind::kRadiationFog, 500);
  for (AirLevel& level : weather.air.profile.level) level.temperature_k = kGroundK;
  const WeatherAir air = WeatherAir::make(weather, kObserverM).value();
  for (const double range_m : {300.0, 3000.0}) {
    const PathRadiance path =
        air.radiance(WeatherAir::Sight::kSharp,
                     [&](const AirProfile&) { return level_path(kObserverM, range_m); }, {})
            .value();
    // In 8-12 um the fog's own top lets some of a cold space's light in.
    const std::size_t b = band_of(675);
    EXPECT_NEAR(
        path.total_w_m2_sr_um[b],
        (1 - path.transmittance[b]) * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kGroundK),
        2e-3 * path.total_w_m2_sr_um[b]);
  }
}

}  // namespace
}  // namespace irsig
