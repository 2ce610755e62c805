// Rationale: light in clear air is scattered once by the program, and in haze more than once.
// Expected: skies of haze (visibility 1 to 23 km, stated as aerosol) differ from those of photons
// followed one by one by no more than the stated model error says: rms z below 1.4 (of sunlight
// that is scattered more than once 0.7 to 1.4), none above 3 (3.5). Clear air is Atmosphere's, to
// the last bit, and nothing jumps where haze begins.
// Source: the photons of air_photons.h; the air's lines grey in a band.
#include "core/atmosphere/haze_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/atmosphere/light_path.h"
#include "core/atmosphere/path_layers.h"
#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/scattered_again.h"
#include "core/base/constants.h"
#include "core/environment/environment.h"
#include "core/environment/sun_light.h"
#include "core/environment/weather_air.h"
#include "tests/physics/air_photons.h"

namespace irsig {
namespace {

using namespace air_photons;

constexpr double kHazeTopM = 10e3, kHazeStepM = 250;
constexpr double kHazeZenithsDeg[] = {0, 60, 80};

WeatherSpec haze_of(AerosolKind kind, double visibility_m) {
  WeatherSpec out;
  out.air.profile = afgl_profile(AfglProfile::kMidlatitudeSummer);
  out.air.aerosol = {.kind = kind, .visibility_m = visibility_m, .summer_troposphere = true};
  out.lower.kind = SurfaceBoundary::Kind::kGround;
  out.lower.temperature_k = 294.2;
  out.lower.emissivity = 0.95;
  return out;
}

AirPhotons photons_of(const WeatherSpec& haze, std::size_t band) {
  return {haze, band, kHazeTopM, kHazeStepM, AerosolKind::kNone};
}

PathRadiance sky_of(const WeatherAir& air, double zenith_deg, const std::optional<SunPlace>& sun) {
  return air
      .radiance(
          WeatherAir::Sight::kDiffuse,
          [&](const AirProfile& profile) {
            return look(profile, kObserverM, zenith_deg, kInfinity);
          },
          sun)
      .value();
}

// Collects the least and the largest ratio.
struct Ratios {
  double least = kInfinity, most = 0;
  void add(double ratio) {
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  [[nodiscard]] std::string text() const {
    return std::to_string(least) + " to " + std::to_string(most);
  }
};

// Collects deviations over stated errors.
struct Deviations {
  double squares = 0, largest = 0;
  int count = 0;
  void add(double z) {
    squares += z * z;
    largest = std::max(largest, std::abs(z));
    ++count;
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
};

template <typename Each>
void for_hazes(const Each& each) {
  for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime})
    for (const double visibility_m : {1e3, 3e3, 10e3, 23e3}) each(kind, visibility_m);
}

TEST(Haze, SkiesShineAsPhotonsHaveItWithinTheStatedError) {
  Deviations z;
  double coldest = 0, warmest = 0;
  for_hazes([&](AerosolKind kind, double visibility_m) {
    const WeatherSpec haze = haze_of(kind, visibility_m);
    const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
    for (const double cm1 : {845.0, 935.0, 1105.0, 2605.0}) {
      const std::size_t b = air_band(1e4 / cm1).value();
      const AirPhotons photons = photons_of(haze, b);
      // Nearer to the horizon lines that are grey in a band err by more than what is looked for.
      for (const double zenith_deg : {0.0, 60.0}) {
        const PathRadiance sky = sky_of(air, zenith_deg, std::nullopt);
        const double found =
            photons.seen(std::cos(zenith_deg * M_PI / 180), kInfinity, 0.7, 0).thermal;
        const double error = sky.total_w_m2_sr_um[b] - found;
        z.add(error / sky.model_error_w_m2_sr_um[b]);
        const double warmer_k = kelvin(b, sky.total_w_m2_sr_um[b]) - kelvin(b, found);
        coldest = std::min(coldest, warmer_k);
        warmest = std::max(warmest, warmer_k);
      }
    }
  });
  RecordProperty("rms_z", std::to_string(z.rms()));
  RecordProperty("coldest_k", std::to_string(coldest));
  RecordProperty("warmest_k", std::to_string(warmest));
  EXPECT_LT(z.rms(), 1.4);
  EXPECT_LT(z.largest, 3);
}

TEST(Haze, SunlightIsAsPhotonsHaveItWithinTheStatedError) {
  Deviations once, often;
  for_hazes([&](AerosolKind kind, double visibility_m) {
    const WeatherSpec haze = haze_of(kind, visibility_m);
    const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
    const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
    const bool computed = haze_fraction(atmosphere) == 1;
    Ratios all, high;
    std::vector<std::size_t> bands;
    std::vector<AirPhotons> photons;
    for (const double cm1 : {2455.0, 2605.0, 2785.0}) {
      bands.push_back(air_band(1e4 / cm1).value());
      photons.push_back(photons_of(haze, bands.back()));
    }
    for (const double zenith_deg : kHazeZenithsDeg) {
      const AirSpectrum night = sky_of(air, zenith_deg, std::nullopt).total_w_m2_sr_um;
      for (const double sun_deg : {30.0, 60.0, 80.0}) {
        const SunPlace sun{.zenith_deg = sun_deg,
                           .azimuth_deg = AirPhotons::kAzimuth * 180 / M_PI,
                           .distance_au = 1};
        const AirSpectrum at_top = atmosphere.sun_irradiance_w_m2_um(kHazeTopM, sun),
                          day = sky_of(air, zenith_deg, sun).total_w_m2_sr_um,
                          again = scattered_again_relative(atmosphere, kObserverM, sun_deg);
        for (std::size_t i = 0; i < bands.size(); ++i) {
          const std::size_t b = bands[i];
          const double ours = day[b] - night[b];
          const double found = at_top[b] * photons[i]
                                               .seen(std::cos(zenith_deg * M_PI / 180), kInfinity,
                                                     std::cos(sun_deg * M_PI / 180), 0)
                                               .sun_per_sr;
          // Where all orders are computed, the particles of both are the same.
          const double relative = computed ? again[b] : std::hypot(kAerosolRelativeError, again[b]);
          (computed ? often : once).add((ours - found) / (relative * ours));
          all.add(ours / found);
          if (sun_deg < 80) high.add(ours / found);
        }
      }
    }
    const std::string name = (kind == AerosolKind::kRural ? "rural_" : "maritime_") +
                             std::to_string(static_cast<int>(visibility_m / 1e3)) + "_km";
    RecordProperty(name, all.text());
    RecordProperty(name + "_high_suns", high.text());
  });
  RecordProperty("once_rms_z", std::to_string(once.rms()));
  RecordProperty("once_largest_z", std::to_string(once.largest));
  RecordProperty("often_rms_z", std::to_string(often.rms()));
  RecordProperty("often_largest_z", std::to_string(often.largest));
  EXPECT_LT(once.rms(), 1.4);
  EXPECT_LT(once.largest, 3.5);
  EXPECT_GT(often.rms(), 0.7);
  EXPECT_LT(often.rms(), 1.4);
  EXPECT_LT(often.largest, 3.5);
}

// Lines that are grey in a band lack light that a low sun sends: without gases the photons have the
// same air.
TEST(Haze, WithoutGasesSunlightIsAsPhotonsHaveIt) {
  WeatherSpec haze = haze_of(AerosolKind::kMaritime, 3e3);
  for (AirLevel& level : haze.air.profile.level) level.gas = {};
  haze.air.co2_ppmv = haze.air.cfc11_ppmv = haze.air.cfc12_ppmv = 0;
  const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
  ASSERT_EQ(haze_fraction(atmosphere), 1);
  const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
  const std::size_t b = air_band(1e4 / 2785).value();
  const AirPhotons photons = photons_of(haze, b);
  Ratios all;
  for (const double zenith_deg : kHazeZenithsDeg) {
    const double night = sky_of(air, zenith_deg, std::nullopt).total_w_m2_sr_um[b];
    for (const double sun_deg : {30.0, 60.0, 80.0})
      for (const double azimuth : {0.3, 1.5, 3.0}) {
        const SunPlace sun{
            .zenith_deg = sun_deg, .azimuth_deg = azimuth / kRadPerDeg, .distance_au = 1};
        const double ours = sky_of(air, zenith_deg, sun).total_w_m2_sr_um[b] - night;
        const double found = atmosphere.sun_irradiance_w_m2_um(kHazeTopM, sun)[b] *
                             photons
                                 .seen(std::cos(zenith_deg * kRadPerDeg), kInfinity,
                                       std::cos(sun_deg * kRadPerDeg), 0, azimuth)
                                 .sun_per_sr;
        EXPECT_NEAR(ours, found, 0.15 * found) << zenith_deg << " " << sun_deg << " " << azimuth;
        all.add(ours / found);
      }
  }
  RecordProperty("ratios", all.text());
}

// Returns the sky in one direction, by night and by day.
std::vector<AirSpectrum> skies_of(AerosolKind kind, double visibility_m) {
  const WeatherAir air = WeatherAir::make(haze_of(kind, visibility_m), kObserverM).value();
  const SunPlace sun{.zenith_deg = 60, .azimuth_deg = 70, .distance_au = 1};
  std::vector<AirSpectrum> out;
  for (const double zenith_deg : {30.0, 85.0})
    for (const std::optional<SunPlace>& by : {std::optional<SunPlace>(), {sun}})
      out.push_back(sky_of(air, zenith_deg, by).total_w_m2_sr_um);
  return out;
}

double fraction_of(AerosolKind kind, double visibility_m) {
  return haze_fraction(Atmosphere::make(haze_of(kind, visibility_m).air).value());
}

TEST(Haze, ClearAirScattersOnce) {
  for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime}) {
    const WeatherSpec clear = haze_of(kind, 23e3);
    const Atmosphere atmosphere = Atmosphere::make(clear.air).value();
    EXPECT_EQ(haze_fraction(atmosphere), 0);
    const WeatherAir air = WeatherAir::make(clear, kObserverM).value();
    const SunPlace sun{.zenith_deg = 60, .azimuth_deg = 70, .distance_au = 1};
    const AirSpectrum none(kAirBandCount, 0.0);
    const LightPath path = look(atmosphere.profile(), kObserverM, 60, kInfinity);
    const PathRadiance sky =
        air.radiance(
               WeatherAir::Sight::kDiffuse, [&](const AirProfile&) { return path; }, sun, &none)
            .value();
    EXPECT_EQ(sky.total_w_m2_sr_um, atmosphere.radiance(path, {sun, none}).total_w_m2_sr_um);
  }
}

TEST(Haze, NothingJumpsWhereItBegins) {
  constexpr double kHair = 1e-5;
  constexpr AerosolKind kKind = AerosolKind::kMaritime;
  // The fraction's rise has two ends.
  for (const double end : {0.0, 1.0}) {
    double dense_m = 1e3, clear_m = 40e3;
    ASSERT_EQ(fraction_of(kKind, dense_m), 1);
    ASSERT_EQ(fraction_of(kKind, clear_m), 0);
    while (clear_m - dense_m > kHair * dense_m) {
      const double middle_m = 0.5 * (dense_m + clear_m), at = fraction_of(kKind, middle_m);
      (end == 0 ? at > 0 : at == 1) ? dense_m = middle_m : clear_m = middle_m;
    }
    const std::vector<AirSpectrum> dense = skies_of(kKind, dense_m),
                                   clear = skies_of(kKind, clear_m);
    for (std::size_t i = 0; i < dense.size(); ++i)
      for (std::size_t b = 0; b < kAirBandCount; ++b)
        EXPECT_NEAR(dense[i][b], clear[i][b], 10 * kHair * clear[i][b]) << i << " " << b;
  }
}

// On the way between, no step of 5 % in visibility changes the light by more than a tenth.
TEST(Haze, LightChangesSteadilyWithHaze) {
  constexpr double kStep = 1.05, kMost = 0.1;
  std::vector<AirSpectrum> before;
  for (double visibility_m = 16.5e3; visibility_m > 9e3; visibility_m /= kStep) {
    const std::vector<AirSpectrum> here = skies_of(AerosolKind::kMaritime, visibility_m);
    for (std::size_t i = 0; i < before.size(); ++i)
      for (const double cm1 : {945.0, 1155.0, 2605.0}) {
        const std::size_t b = air_band(1e4 / cm1).value();
        EXPECT_NEAR(here[i][b] / before[i][b], 1, kMost) << visibility_m << " " << i << " " << cm1;
      }
    before = here;
  }
}

TEST(Haze, RowsHaveTheSkyOfSingleRays) {
  const WeatherSpec haze = haze_of(AerosolKind::kMaritime, 5e3);
  const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
  const std::size_t b = air_band(3.84).value();
  const std::vector<double> um = {air_band_lambda_um(b)};
  const auto environment = Environment::make({haze}, {ConditionEnvironment{}}, kObserverM, um);
  const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
  const NodeWavelengths wavelengths = node_wavelengths(um).value();
  const DirectionNodes& nodes = (*environment)->nodes();
  const ThermalSurroundings sky(haze, atmosphere, kObserverM, nodes, wavelengths.bands, 1);
  ASSERT_NE(sky.haze(), nullptr);
  const double sun_deg = 60;
  const Vec<Body> to_sun{std::sin(sun_deg * kRadPerDeg), 0, -std::cos(sun_deg * kRadPerDeg)};
  ConditionEnvironment condition{};
  condition.sun_distance_au = 1;
  const SunLight sun(condition, {to_sun, 1, 1, to_sun, true}, sky, haze.lower, atmosphere,
                     atmosphere, kObserverM, nodes, wavelengths);
  for (const std::size_t ring : {std::size_t{10}, sky.sky.size() / 2, sky.sky.size() - 1})
    for (const double azimuth_deg : {0.0, 50.0, 180.0}) {
      const double sine = sky.sky[ring].sin_elevation, zenith_deg = std::acos(sine) / kRadPerDeg;
      const double level = std::sqrt(1 - sine * sine), azimuth = azimuth_deg * kRadPerDeg;
      const SunPlace place{.zenith_deg = sun_deg, .azimuth_deg = azimuth_deg, .distance_au = 1};
      const double night = sky_of(air, zenith_deg, std::nullopt).total_w_m2_sr_um[b],
                   day = sky_of(air, zenith_deg, place).total_w_m2_sr_um[b];
      EXPECT_NEAR(sky.sky[ring].total[b], night, 0.01 * night);
      const double ours = sun.sky_towards(
          {level * std::cos(azimuth), level * std::sin(azimuth), -sine}, ring, 0)[b];
      EXPECT_NEAR(ours, day - night, 0.05 * (day - night)) << zenith_deg << " " << azimuth_deg;
    }
}

// A ray may be cut: near air and what lies behind it are the whole.
TEST(Haze, BehindNearAirIsTheRestOfTheRay) {
  const WeatherSpec haze = haze_of(AerosolKind::kMaritime, 5e3);
  const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
  const BandChoice all;
  GroundBelow ground{AirSpectrum(kAirBandCount, 0.0), AirSpectrum(kAirBandCount, 0.05)};
  planck_spectrum(ground.planck, haze.lower.temperature_k, all);
  const HazeLight light(atmosphere, ground, 1, false, all);
  const AirProfile& air = atmosphere.profile();
  for (const double zenith_deg : {30.0, 80.0})
    for (const double near_m : {300.0, 3000.0}) {
      const LightPath near = look(air, kObserverM, zenith_deg, near_m, false);
      const LightPath::Node& cut = near.node.back();
      const PathLayers of_near(atmosphere, near, all, nullptr, &light),
          whole(atmosphere, look(air, kObserverM, zenith_deg, kInfinity, false), all, nullptr,
                &light),
          rest(atmosphere, look(air, cut.height_m, cut.zenith_deg, kInfinity, false), all, nullptr,
               &light);
      const PathLayers::Behind behind = rest.behind(of_near.amounts(), of_near.transmittance);
      for (const double cm1 : {945.0, 1155.0, 2605.0}) {
        const std::size_t b = air_band(1e4 / cm1).value();
        EXPECT_NEAR(of_near.thermal_w_m2_sr_um[b] + behind.thermal_w_m2_sr_um[b],
                    whole.thermal_w_m2_sr_um[b], 0.005 * whole.thermal_w_m2_sr_um[b])
            << zenith_deg << " " << near_m << " " << cm1;
      }
      const double sun_deg = 60;
      const SunAmounts sun(atmosphere, kObserverM, sun_deg);
      const HazeSunlight again(light, atmosphere, sun_deg);
      const AbsorberAmounts amounts = of_near.amounts();
      const std::size_t b = air_band(1e4 / 2605).value();
      const double cosine = std::cos(sun_deg * kRadPerDeg) * std::cos(zenith_deg * kRadPerDeg);
      const double whole_sun = whole.scattered(sun, nullptr, nullptr, &again).per_sr(b, cosine);
      EXPECT_NEAR(of_near.scattered(sun, nullptr, nullptr, &again).per_sr(b, cosine) +
                      rest.scattered(sun, &amounts, nullptr, &again).per_sr(b, cosine),
                  whole_sun, 0.02 * whole_sun)
          << zenith_deg << " " << near_m;
    }
}

// However dense the haze and low the sun, light is finite, and no warmer than the warmest air.
TEST(Haze, OfAnyDensityIsALight) {
  for (const double visibility_m : {100.0, 600.0}) {
    const WeatherSpec haze = haze_of(AerosolKind::kMaritime, visibility_m);
    const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
    for (const double zenith_deg : {0.0, 89.0}) {
      const PathRadiance night = sky_of(air, zenith_deg, std::nullopt);
      EXPECT_EQ(night.scattering_optical_depth, 0);
      for (const double sun_deg : {0.0, 89.9, 94.0}) {
        const PathRadiance day = sky_of(
            air, zenith_deg, SunPlace{.zenith_deg = sun_deg, .azimuth_deg = 10, .distance_au = 1});
        for (std::size_t b = 0; b < kAirBandCount; ++b) {
          EXPECT_LT(night.total_w_m2_sr_um[b],
                    1.01 * planck_radiance_w_m2_sr_um(air_band_lambda_um(b), 294.2));
          EXPECT_GE(night.total_w_m2_sr_um[b], 0);
          // The difference of two sums may lose its last digits.
          EXPECT_GE(day.total_w_m2_sr_um[b], (1 - 1e-9) * night.total_w_m2_sr_um[b])
              << visibility_m << " " << zenith_deg << " " << sun_deg << " " << b;
          EXPECT_LT(day.total_w_m2_sr_um[b], 100);
          EXPECT_GE(day.model_error_w_m2_sr_um[b], 0);
        }
      }
    }
  }
}

// Haze below a cloud scatters once: rows mix both skies in proportion.
TEST(Haze, BrokenCloudsMixBothSkies) {
  WeatherSpec haze = haze_of(AerosolKind::kMaritime, 5e3);
  haze.cloud = CloudSpec{CloudPhase::kWater, 1500, 1800, 0.1, 10};
  const auto sky = [&](double cover) {
    haze.cloud_cover = cover;
    return sky_of(WeatherAir::make(haze, kObserverM).value(), 40,
                  SunPlace{.zenith_deg = 60, .azimuth_deg = 70, .distance_au = 1})
        .total_w_m2_sr_um;
  };
  const AirSpectrum clear = sky(0), half = sky(0.5), overcast = sky(1);
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    EXPECT_NEAR(half[b], 0.5 * (clear[b] + overcast[b]), 1e-9 * half[b]);
}

// Rationale: the growth of the stated error with depth and slant was fitted to the hazes and suns
// above. Expected: it holds in hazes that the fit has not seen, of 2 and 5 km among others, under
// suns 45 and 15 deg high, and 5 deg above the horizon. Where all orders are computed, sunlight is
// within 32 % and thermal light within 3 K. Prints what is missing.
TEST(Haze, OtherSkiesAreWithinTheStatedError) {
  Deviations sunlight, thermal;
  for (const AerosolKind kind : {AerosolKind::kRural, AerosolKind::kMaritime})
    for (const double visibility_m : {2e3, 5e3, 10e3, 23e3}) {
      const WeatherSpec haze = haze_of(kind, visibility_m);
      const WeatherAir air = WeatherAir::make(haze, kObserverM).value();
      const Atmosphere atmosphere = Atmosphere::make(haze.air).value();
      const bool computed = haze_fraction(atmosphere) == 1;
      for (const double cm1 : {2605.0, 945.0, 1155.0}) {
        const std::size_t b = air_band(1e4 / cm1).value();
        const AirPhotons photons = photons_of(haze, b);
        for (const double zenith_deg : {0.0, 45.0, 85.0}) {
          const double cosine = std::cos(zenith_deg * M_PI / 180);
          const PathRadiance night = sky_of(air, zenith_deg, std::nullopt);
          const double own = night.total_w_m2_sr_um[b];
          std::printf("%s %2.0f km, %4.0f cm-1, %2.0f deg:",
                      kind == AerosolKind::kRural ? "rural" : "maritime", visibility_m / 1e3, cm1,
                      zenith_deg);
          const double seen = photons.seen(cosine, kInfinity, 0.7, 0).thermal;
          std::printf(" thermal %+5.1f K", kelvin(b, own) - kelvin(b, seen));
          if (computed) {
            EXPECT_NEAR(kelvin(b, own), kelvin(b, seen), 3);
          }
          // Nearer to the horizon lines that are grey in a band err by more.
          if (zenith_deg < 80) thermal.add((own - seen) / night.model_error_w_m2_sr_um[b]);
          for (const double sun_deg : {45.0, 75.0}) {
            if (cm1 < 2000) continue;  // sunlight is below 1 % there
            const SunPlace sun{.zenith_deg = sun_deg,
                               .azimuth_deg = AirPhotons::kAzimuth * 180 / M_PI,
                               .distance_au = 1};
            const double ours = sky_of(air, zenith_deg, sun).total_w_m2_sr_um[b] - own;
            const double found =
                atmosphere.sun_irradiance_w_m2_um(kHazeTopM, sun)[b] *
                photons.seen(cosine, kInfinity, std::cos(sun_deg * M_PI / 180), 0).sun_per_sr;
            const double relative =
                std::hypot(kAerosolRelativeError,
                           scattered_again_relative(atmosphere, kObserverM, sun_deg)[b]);
            const double z = (ours - found) / (relative * ours);
            std::printf("; sun %2.0f deg high: %.2f, stated +-%.2f, z %+.1f", 90 - sun_deg,
                        ours / found, relative, z);
            sunlight.add(z);
            if (computed) {
              EXPECT_NEAR(ours / found, 1, 0.32);
            }
          }
          std::printf("\n");
        }
      }
    }
  RecordProperty("sunlight_rms_z", std::to_string(sunlight.rms()));
  RecordProperty("sunlight_largest_z", std::to_string(sunlight.largest));
  RecordProperty("thermal_rms_z", std::to_string(thermal.rms()));
  EXPECT_LT(sunlight.rms(), 1.4);
  EXPECT_LT(sunlight.largest, 3.5);
  EXPECT_LT(thermal.rms(), 1.4);
  EXPECT_LT(thermal.largest, 3);
}

}  // namespace
}  // namespace irsig
