// Rationale: sky and sea are known at nodes and through ratios taken at few layers; both are
// shortcuts. Expected: against the same quantities summed over every step of every path, errors
// below those that core/environment states. Source: Atmosphere::radiance, which is compared with
// MODTRAN elsewhere (atmosphere_reference_test.cpp).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/atmosphere/path_sums.h"
#include "core/environment/environment.h"
#include "core/environment/thermal_surroundings.h"
#include "core/spectral/solar.h"
#include "tests/physics/around_spectra.h"

namespace irsig {
namespace {

constexpr double kHeightM = 10;

std::vector<double> node_wavelengths() {  // one a band, at its centre
  std::vector<double> um;
  for (const double x : {3.5, 3.7, 3.9, 4.05, 4.7, 8.3, 8.9, 9.6, 10.2, 11.0, 11.8}) {
    um.push_back(air_band_lambda_um(*air_band(x)));
  }
  return um;
}

WeatherSpec node_weather() {
  WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {}}, true, {}, nullptr};
  w.air.aerosol.kind = AerosolKind::kMaritime;
  w.air.aerosol.visibility_m = 23e3;
  w.lower.temperature_k = 293;
  w.lower.wind_speed_m_s = 5;
  return w;
}

ConditionEnvironment node_sunny(double zenith_deg, double azimuth_deg) {
  const double z = zenith_deg * M_PI / 180, a = azimuth_deg * M_PI / 180;
  return {0, true, {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)}, 1};
}

BandChoice bands() {
  std::vector<unsigned char> wanted(kAirBandCount, 0);
  for (const double um : node_wavelengths()) wanted[*air_band(um)] = 1;
  return BandChoice(wanted);
}

// The weather's own light, to know what surrounds a path.
struct Light {
  WeatherSpec spec = node_weather();
  Atmosphere air = *Atmosphere::make(spec.air);
  std::unique_ptr<const Environment> environment;
  BandChoice choice = bands();
  std::unique_ptr<ThermalSurroundings> light;

  explicit Light(std::vector<ConditionEnvironment> conditions) {
    environment = *Environment::make({spec}, std::move(conditions), kHeightM, node_wavelengths());
    light =
        std::make_unique<ThermalSurroundings>(spec, air, kHeightM, environment->nodes(), choice, 1);
  }
};

double sensor_height_m(double range_m, double elevation_deg) {
  const double r = kEarthRadiusM + kHeightM, up = std::sin(elevation_deg * M_PI / 180);
  return std::sqrt(r * r + range_m * range_m + 2 * r * range_m * up) - kEarthRadiusM;
}

double read(const std::vector<std::vector<double>>& node, const DirectionNodes& nodes, Vec<Body> d,
            std::size_t i) {
  DirectionNodes::Share share[4];
  const int n = nodes.shares(static_cast<float>(d.x), static_cast<float>(d.y),
                             static_cast<float>(d.z), share);
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    sum += static_cast<double>(share[k].weight) * node[share[k].node][i];
  }
  return sum;
}

TEST(EnvironmentNodes, AThousandDirectionsOfTheNightSky) {
  const Light l(std::vector<ConditionEnvironment>(1));
  const std::vector<double> um = node_wavelengths();
  const ViewEnvironment v = (*l.environment->view({0, 10, body_from_aspect(0, 10), {}},
                                                  std::vector<std::uint32_t>{0}))[0];
  const auto radiance = radiance_of(v.around);
  std::mt19937_64 random(20250621);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<double> error(um.size(), 0.0), mean(um.size(), 0.0);
  PathLight light;
  light.surroundings_w_m2_sr_um = l.light->surroundings;
  constexpr int kDirections = 1000;
  for (int k = 0; k < kDirections; ++k) {
    const double up = uniform(random), a = 2 * M_PI * uniform(random);
    const double level = std::sqrt(1 - up * up), zenith_deg = std::acos(up) * 180 / M_PI;
    const Vec<Body> d = {level * std::cos(a), level * std::sin(a), -up};
    const PathLayers path(l.air, look(l.air.profile(), kHeightM, zenith_deg, INFINITY), l.choice);
    AirSpectrum direct = path.thermal_w_m2_sr_um;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      direct[b] += path.surroundings_fraction[b] * l.light->surroundings[b];
    }
    if (k < 20) {
      const AirSpectrum same = l.air.sky_radiance(kHeightM, zenith_deg, light).total_w_m2_sr_um;
      for (const double x : um) {
        EXPECT_NEAR(direct[*air_band(x)] / same[*air_band(x)], 1, 1e-9) << x;
      }
    }
    for (std::size_t i = 0; i < um.size(); ++i) {
      const std::size_t b = *air_band(um[i]);
      error[i] += std::abs(read(radiance, l.environment->nodes(), d, i) - direct[b]);
      mean[i] += direct[b];
    }
  }
  double worst = 0;
  for (std::size_t i = 0; i < um.size(); ++i) worst = std::max(worst, error[i] / mean[i]);
  std::printf("1000 directions of the night sky: mean error %.2e, stated %.2e\n", worst,
              v.sky_interpolation);
  EXPECT_LT(worst, 2e-3);
  EXPECT_LT(worst, 1.2 * v.sky_interpolation);
}

TEST(EnvironmentNodes, EnergyAndLobesOfTheSunlitSky) {
  // Irradiance on planes, and lobes of cos^20 as a rough surface sees them, from the nodes and from
  // the sky itself.
  const Light l({node_sunny(60, 77)});
  const DirectionNodes& nodes = l.environment->nodes();
  const std::vector<double> um = node_wavelengths();
  const ViewEnvironment v = (*l.environment->view({0, 10, body_from_aspect(0, 10), {}},
                                                  std::vector<std::uint32_t>{0}))[0];
  const auto radiance = radiance_of(v.around);
  constexpr int kSines = 100, kAzimuths = 144;
  const double lobe_deg[][2] = {{60, 77}, {40, 90}, {75, 60}, {20, 77}, {60, 200}};
  double by_nodes[5] = {}, direct[5] = {}, plane_nodes = 0, plane_direct = 0;
  const std::size_t i = 1;  // 3.7 um
  const std::size_t b = *air_band(um[i]);
  const SunAmounts sun(l.air, kHeightM, 60);
  const double outside = solar_irradiance_w_m2_um(air_band_lambda_um(b));
  const Vec<Body> towards_sun = node_sunny(60, 77).sun_direction;
  for (int s = 0; s < kSines; ++s) {
    const double up = std::pow((s + 0.5) / kSines, 1.5), step = 1.5 * std::sqrt((s + 0.5) / kSines);
    const double level = std::sqrt(1 - up * up), zenith_deg = std::acos(up) * 180 / M_PI;
    const PathLayers path(l.air, look(l.air.profile(), kHeightM, zenith_deg, INFINITY), l.choice);
    const ScatteredSun source = path.scattered(sun);
    const double thermal =
        path.thermal_w_m2_sr_um[b] + path.surroundings_fraction[b] * l.light->surroundings[b];
    for (int j = 0; j < kAzimuths; ++j) {
      const double a = 2 * M_PI * (j + 0.5) / kAzimuths;
      const Vec<Body> d = {level * std::cos(a), level * std::sin(a), -up};
      const double here = thermal + outside * source.per_sr(b, dot(d, towards_sun));
      const double there = read(radiance, nodes, d, i);
      plane_nodes += step * up * there;
      plane_direct += step * up * here;
      for (int k = 0; k < 5; ++k) {
        const double z = lobe_deg[k][0] * M_PI / 180, t = lobe_deg[k][1] * M_PI / 180;
        const double c =
            dot(d, {std::sin(z) * std::cos(t), std::sin(z) * std::sin(t), -std::cos(z)});
        if (c <= 0) continue;
        by_nodes[k] += step * std::pow(c, 20) * there;
        direct[k] += step * std::pow(c, 20) * here;
      }
    }
  }
  std::printf("sunlit sky at 3.7 um: plane %.4f, lobes", plane_nodes / plane_direct);
  for (int k = 0; k < 5; ++k) std::printf(" %.4f", by_nodes[k] / direct[k]);
  std::printf("; stated %.2e\n", v.sky_interpolation);
  EXPECT_NEAR(plane_nodes / plane_direct, 1, 2e-3);
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(by_nodes[k] / direct[k], 1, 0.015) << k;
}

// A mirror sees one direction, and no errors cancel.
TEST(EnvironmentNodes, EveryDirectionOfTheSunlitSkyIsWithinItsNodesErrors) {
  for (const double zenith_deg : {20.0, 60.0, 85.0}) {
    const Light l({node_sunny(zenith_deg, 77)});
    const DirectionNodes& nodes = l.environment->nodes();
    const std::vector<double> um = node_wavelengths();
    const ViewEnvironment v = (*l.environment->view({0, 10, body_from_aspect(0, 10), {}},
                                                    std::vector<std::uint32_t>{0}))[0];
    const auto node = radiance_of(v.around), interpolation = interpolation_of(v.around);
    ASSERT_EQ(interpolation.size(), nodes.count());
    const SunAmounts sun(l.air, kHeightM, zenith_deg);
    const Vec<Body> towards_sun = node_sunny(zenith_deg, 77).sun_direction;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    double worst = 0, worst_relative = 0, sum_error = 0, sum_stated = 0;
    constexpr int kDirections = 600;
    for (int k = 0; k < kDirections; ++k) {
      Vec<Body> d{};
      if (k % 3 == 0) {  // the aureole
        const Vec<Body> off = {uniform(random) - 0.5, uniform(random) - 0.5, uniform(random) - 0.5};
        d = normalized(towards_sun + 0.6 * off);
        if (d.z > -0.004) continue;
      } else {
        const double up = std::pow(uniform(random), k % 3), a = 2 * M_PI * uniform(random);
        d = {std::sqrt(1 - up * up) * std::cos(a), std::sqrt(1 - up * up) * std::sin(a), -up};
      }
      const PathLayers path(
          l.air, look(l.air.profile(), kHeightM, std::acos(-d.z) * 180 / M_PI, INFINITY), l.choice);
      const ScatteredSun source = path.scattered(sun);
      for (std::size_t i = 0; i < um.size(); ++i) {
        const std::size_t b = *air_band(um[i]);
        const double direct =
            path.thermal_w_m2_sr_um[b] + path.surroundings_fraction[b] * l.light->surroundings[b] +
            solar_irradiance_w_m2_um(air_band_lambda_um(b)) * source.per_sr(b, dot(d, towards_sun));
        const double error = std::abs(read(node, nodes, d, i) - direct),
                     stated = read(interpolation, nodes, d, i);
        worst = std::max(worst, error / (stated + 1e-3 * direct));
        worst_relative = std::max(worst_relative, error / direct);
        sum_error += error / direct;
        sum_stated += stated / direct;
      }
    }
    std::printf(
        "sun %g deg from the zenith: errors up to %.2g of the radiance, %.2f of what is stated, "
        "which is %.1f times the error in the mean\n",
        zenith_deg, worst_relative, worst, sum_stated / sum_error);
    EXPECT_LT(worst, 1.2) << zenith_deg;
    EXPECT_LT(sum_stated, 15 * sum_error) << zenith_deg;
  }
}

TEST(EnvironmentNodes, SkyBehindAirAsSummedOverEveryStep) {
  const Light night(std::vector<ConditionEnvironment>(1));
  const std::vector<double> um = node_wavelengths();
  const DirectionNodes& nodes = night.environment->nodes();
  PathLight light;
  light.surroundings_w_m2_sr_um = night.light->surroundings;
  double worst = 0, product = 0;
  for (const auto& [range_m, elevation_deg] :
       {std::pair{2000.0, 5.0}, std::pair{15e3, 0.5}, std::pair{40e3, 30.0}}) {
    const Environment::Line line{range_m, elevation_deg, body_from_aspect(0, elevation_deg), {}};
    const ViewEnvironment v = (*night.environment->view(line, std::vector<std::uint32_t>{0}))[0];
    const auto at_target = radiance_of(v.around), apparent = apparent_of(v.around);
    const AbsorberAmounts near = night.air.amounts(*look_between(
        night.air.profile(), sensor_height_m(range_m, elevation_deg), kHeightM, range_m));
    for (std::uint32_t node = 0; node < nodes.sky(); node += 3) {
      const double zenith_deg = std::acos(nodes.sin_elevation(node)) * 180 / M_PI;
      const AirSpectrum all =
          night.air.sky_radiance(kHeightM, zenith_deg, light, &near).total_w_m2_sr_um;
      for (std::size_t i = 0; i < um.size(); ++i) {
        const std::size_t b = *air_band(um[i]);
        // Light that is lost in the path's own radiance does not matter.
        if (all[b] < 1e-3 * v.path_radiance[i]) continue;
        worst = std::max(worst, std::abs(apparent[node][i] / all[b] - 1));
        product = std::max(product, v.transmittance[i] * at_target[node][i] / all[b] - 1);
      }
    }
  }
  std::printf("night sky behind air: largest error %.4f; of the product of means %.2f\n", worst,
              product);
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(product, 0.5);
}

// Returns the angle by which a ray from the sensor points lower at the target than the straight
// line. [rad]
double lift_of(double range_m, double elevation_deg) {
  if (range_m == 0) return 0;
  const LightPath path = *look_between(afgl_profile(AfglProfile::kMidlatitudeSummer),
                                       sensor_height_m(range_m, elevation_deg), kHeightM, range_m);
  return (path.node.back().zenith_deg - 90 - elevation_deg) * M_PI / 180;
}

TEST(EnvironmentNodes, SunlitSkyInOneDirectionAsSummedOverEveryStep) {
  // Where the background is wanted, the aureole is that of the very direction.
  const Light day({node_sunny(50, 0)});
  const std::vector<double> um = node_wavelengths();
  PathLight light;
  light.surroundings_w_m2_sr_um = day.light->surroundings;
  double worst = 0;
  for (const auto& [range_m, elevation_deg] : {std::pair{0.0, 5.0}, std::pair{8e3, 2.0}}) {
    for (const double azimuth : {0.1, 1.0, 1.9, 2.8, 3.7, 4.6, 5.5}) {
      Environment::Line line{range_m, elevation_deg, body_from_aspect(0, elevation_deg),
                             BackgroundDirections({-0.95f, -0.6f, -0.2f, -0.02f}, azimuth)};
      const ViewEnvironment v = (*day.environment->view(line, std::vector<std::uint32_t>{0}))[0];
      const AbsorberAmounts near = day.air.amounts(*look_between(
          day.air.profile(), sensor_height_m(range_m, elevation_deg), kHeightM, range_m));
      const double lift = lift_of(range_m, elevation_deg);
      for (std::uint32_t n = 0; n < line.behind.count(); ++n) {
        // The ray itself points lower there than the straight line.
        const Vec<Body> d = line.behind.direction(
            std::sin(std::asin(static_cast<double>(line.behind.z(n))) + lift));
        light.sun = SunPlace{50, -std::atan2(d.y, d.x) * 180 / M_PI};
        const AirSpectrum all =
            day.air.sky_radiance(kHeightM, std::acos(-d.z) * 180 / M_PI, light, &near)
                .total_w_m2_sr_um;
        for (std::size_t i = 0; i < um.size(); ++i) {
          const std::size_t b = *air_band(um[i]);
          if (all[b] < 1e-3 * v.path_radiance[i]) continue;
          worst = std::max(worst, std::abs(v.background_apparent[n][i] / all[b] - 1));
        }
      }
    }
  }
  std::printf("sunlit sky in one direction: largest error %.4f\n", worst);
  EXPECT_LT(worst, 0.05);
}

TEST(EnvironmentNodes, SunlightScatteredByLayersAsStepByStep) {
  // The sun's own path from every node of the ray, no interpolation of amounts, every step with its
  // own phase function.
  const Light l(std::vector<ConditionEnvironment>(1));
  constexpr double kSunZenithDeg = 50;
  const SunAmounts sun(l.air, kHeightM, kSunZenithDeg);
  double worst = 0;
  for (const double zenith_deg : {0.0, 60.0, 80.0, 88.0, 90.0}) {
    const LightPath path = look(l.air.profile(), kHeightM, zenith_deg, INFINITY);
    std::vector<AirSpectrum> through;
    std::vector<StepScattering> step(path.step_m.size());
    AbsorberAmounts so_far;
    for (std::size_t i = 0; i < path.node.size(); ++i) {
      through.push_back(transmittance(
          so_far + *l.air.sun_amounts(path.node[i].height_m, kSunZenithDeg), l.choice));
      if (i < step.size()) {
        add_step(so_far, &step[i], l.air, path, i);
      }
    }
    const ScatteredSun layered = PathLayers(l.air, path, l.choice).scattered(sun);
    for (const double azimuth_deg : {5.0, 60.0, 170.0}) {
      const double z = zenith_deg * M_PI / 180, s = kSunZenithDeg * M_PI / 180;
      const double cosine = std::cos(z) * std::cos(s) +
                            std::sin(z) * std::sin(s) * std::cos(azimuth_deg * M_PI / 180);
      for (const double um : node_wavelengths()) {
        const std::size_t b = *air_band(um);
        double sum = 0;
        for (std::size_t i = 0; i < step.size(); ++i) {
          sum +=
              mean_of_sunlight(through[i][b], through[i + 1][b], step[i].grey_depth[b]) *
              (step[i].aerosol_depth[b] * henyey_greenstein_per_sr(step[i].asymmetry[b], cosine) +
               step[i].molecular_depth[b] * rayleigh_per_sr(cosine));
        }
        worst = std::max(worst, std::abs(layered.per_sr(b, cosine) / sum - 1));
      }
    }
  }
  std::printf("sunlight scattered by layers: largest error %.4f\n", worst);
  EXPECT_LT(worst, 0.03);
}

TEST(EnvironmentNodes, PathScattersAsTheAtmosphereSays) {
  const Light l({node_sunny(50, 40)});
  const std::vector<double> um = node_wavelengths();
  for (const auto& [range_m, elevation_deg] : {std::pair{5000.0, 3.0}, std::pair{30e3, 20.0}}) {
    const Vec<Body> towards = body_from_aspect(10, elevation_deg);
    const ViewEnvironment v = (*l.environment->view({range_m, elevation_deg, towards, {}},
                                                    std::vector<std::uint32_t>{0}))[0];
    const double sensor_m = sensor_height_m(range_m, elevation_deg);
    PathLight light;
    light.surroundings_w_m2_sr_um = l.light->surroundings;
    // The path leads back, to azimuth 190; the sun stands at 40.
    light.sun = SunPlace{50, 40 - 190};
    const PathRadiance direct =
        l.air.radiance(*look_between(l.air.profile(), sensor_m, kHeightM, range_m), light);
    for (std::size_t i = 0; i < um.size(); ++i) {
      const std::size_t b = *air_band(um[i]);
      EXPECT_NEAR(v.transmittance[i], direct.transmittance[b], 1e-9) << um[i];
      EXPECT_NEAR(v.path_radiance[i] / direct.total_w_m2_sr_um[b], 1, 0.01) << um[i];
    }
  }
}

// The sea in one direction: every facet's own direction in the sky, with no nodes in between.
std::vector<double> sea_by_facets(const Light& l, double down) {
  const std::vector<double> um = node_wavelengths();
  PathLight light;
  light.surroundings_w_m2_sr_um = l.light->surroundings;
  const LightPath path = look(l.air.profile(), kHeightM, std::acos(-down) * 180 / M_PI, INFINITY);
  const PathRadiance air = l.air.radiance(path, light);
  const AbsorberAmounts near = l.air.amounts(path);
  const Vec<Body> to_observer = {-std::sqrt(1 - down * down), 0, -down};
  std::vector<double> mirrored(um.size(), 0.0), emissivity(um.size(), 0.0);
  // Facets that mirror from below the horizon (4 % here) are left to the next order.
  double above = 0;
  for (const SeaFacet& f : sea_facets(to_observer, 5)) {
    if (f.mirrored.z >= 0 || f.mirrored.y < 0) continue;  // by symmetry half of them will do
    above += f.share;
    const AirSpectrum sky =
        l.air.sky_radiance(kHeightM, std::acos(-f.mirrored.z) * 180 / M_PI, light, &near)
            .total_w_m2_sr_um;
    for (std::size_t i = 0; i < um.size(); ++i) {
      const double rho = water_reflectance(sea_water_index(um[i]), f.cos_incidence);
      mirrored[i] += f.share * rho * sky[*air_band(um[i])];
      emissivity[i] += f.share * (1 - rho);
    }
  }
  EXPECT_GT(above, 0.47);
  std::vector<double> sum;
  for (std::size_t i = 0; i < um.size(); ++i) {
    const std::size_t b = *air_band(um[i]);
    sum.push_back(air.total_w_m2_sr_um[b] + mirrored[i] / above +
                  air.transmittance[b] * emissivity[i] / above * l.light->surface_planck[b]);
  }
  return sum;
}

TEST(EnvironmentNodes, SeaFromFacetsRayByRay) {
  const Light l(std::vector<ConditionEnvironment>(1));
  const DirectionNodes& nodes = l.environment->nodes();
  const float between = 0.147f;  // half way between two rings
  const ViewEnvironment v = (*l.environment->view(
      {0, 10, body_from_aspect(0, 10), BackgroundDirections({-0.5f, between})},
      std::vector<std::uint32_t>{0}))[0];
  const auto radiance = radiance_of(v.around);
  std::uint32_t node = nodes.sky();
  while (nodes.sin_elevation(node) > -0.2) node += nodes.azimuths();
  const std::vector<double> at_node = sea_by_facets(l, -nodes.sin_elevation(node));
  const std::vector<double> behind = sea_by_facets(l, static_cast<double>(between));
  double worst = 0;
  for (std::size_t i = 0; i < at_node.size(); ++i) {
    EXPECT_NEAR(radiance[node][i] / at_node[i], 1, 0.005) << i;
    EXPECT_NEAR(v.background_apparent[1][i] / behind[i], 1, 0.005) << i;
    worst = std::max({worst, std::abs(radiance[node][i] / at_node[i] - 1),
                      std::abs(v.background_apparent[1][i] / behind[i] - 1)});
  }
  std::printf("sea by its facets: largest error %.4f\n", worst);
}

}  // namespace
}  // namespace irsig
