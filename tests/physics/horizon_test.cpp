// Rationale: where the sea ends, what it hides and what air a line of sight meets are one geometry;
// a target that stands above the horizon has the sky behind it, down to the true dip.
// Expected: the ray that touches the surface by its closed form without refraction and by a
// quadrature of Bouguer's law with it; the step in what stands behind exactly where rays that are
// traced from the sensor pass and meet the surface; radiance there as summed over every step of the
// path; no other step.
// Source: sphere geometry; n r sin(zenith) = const [born1999, 3.2]; Atmosphere::sky_radiance.
#include <gtest/gtest.h>

#include <cmath>

#include "core/environment/environment.h"
#include "core/environment/line_horizon.h"
#include "core/environment/thermal_surroundings.h"

namespace irsig {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const AirProfile& air() { return afgl_profile(AfglProfile::kMidlatitudeSummer); }

// n - 1 as docs/explanation/methods/atmosphere.md has it.
double refractivity(double height_m) {
  const AirLevel a = air_at(air(), height_m);
  const double p_hpa = 1e-2 * a.pressure_pa;
  return 1e-6 * ((77.46 + 0.459e-8 * 4e6) * p_hpa / a.temperature_k -
                 1e-6 * a.gas.h2o_ppmv * p_hpa / 1013.25 * (43.49 - 0.347e-8 * 4e6));
}

// Central angle from where a ray touches the surface to where it is so high: the integral of
// dr / (r sqrt((n r / n0 r0)^2 - 1)), in t = sqrt(height), which takes the pole at the surface
// away.
double angle_by_bouguer(double height_m) {
  const double n0 = refractivity(0), end = std::sqrt(height_m);
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) * end / kSteps, h = t * t;
    // n r / (n0 r0) - 1 without the loss of digits
    const double q = (h / kEarthRadiusM * (1 + refractivity(h)) + refractivity(h) - n0) / (1 + n0);
    sum += 2 * t / ((kEarthRadiusM + h) * std::sqrt(q * (2 + q)));
  }
  return sum * end / kSteps;
}

TEST(GrazingRay, WithoutRefractionIsATangent) {
  const GrazingRay ray(air(), false), airless;
  for (const double h : {0.0, 1e-3, 2.0, 20.0, 1e3, 1e5, 4e7}) {
    const double angle = std::acos(kEarthRadiusM / (kEarthRadiusM + h));
    EXPECT_NEAR(ray.angle_rad(h), angle, 1e-8 + 1e-9 * angle);
    EXPECT_NEAR(ray.height_m(ray.angle_rad(h)), h, 1e-9 * (1 + h));
    EXPECT_NEAR(ray.dip_rad(h), ray.angle_rad(h), 1e-15);
    EXPECT_EQ(airless.angle_rad(h), ray.angle_rad(h));
  }
}

TEST(GrazingRay, WithRefractionObeysBouguersLaw) {
  const GrazingRay ray(air());
  for (const double h : {2.0, 7.0, 20.0, 100.0, 600.0, 2.5e3, 10e3, 20e3}) {
    const double angle = angle_by_bouguer(h);
    EXPECT_NEAR(ray.height_m(angle), h, 0.01 + 1e-4 * h) << h;
    EXPECT_NEAR(ray.angle_rad(ray.height_m(angle)), angle, 1e-10) << h;
    // cos(dip) = n0 r0 / (n r)
    const double q =
        (h / kEarthRadiusM * (1 + refractivity(h)) + refractivity(h) - refractivity(0)) /
        (1 + refractivity(0));
    EXPECT_NEAR(ray.dip_rad(h), std::acos(1 / (1 + q)), 1e-3 * ray.dip_rad(h)) << h;
  }
}

Environment::Line line_of(double sensor_m, double target_m, double along_m) {
  // The straight line between two points above places that are so far apart.
  const double turn = along_m / kEarthRadiusM, s = kEarthRadiusM + sensor_m;
  const double x = s * std::sin(turn), y = s * std::cos(turn) - kEarthRadiusM - target_m;
  const double elevation_deg = std::atan2(y, x) / kRadPerDeg;
  return {std::hypot(x, y), elevation_deg, body_from_aspect(180, elevation_deg), {}};
}

// Height above a place at which a ray from the sensor passes; < 0: it meets the surface before.
double passes_m(double sensor_m, double zenith_deg, double along_m, bool refraction) {
  const LightPath path = look(air(), sensor_m, zenith_deg, kInfinity, refraction);
  const double turn_deg = along_m / kEarthRadiusM / kRadPerDeg;
  for (std::size_t i = 1; i < path.node.size(); ++i) {
    const LightPath::Node &a = path.node[i - 1], &b = path.node[i];
    if (b.central_angle_deg < turn_deg) continue;
    // The height is that of the end of a path of that length.
    double low = 0, high = path.step_m[i - 1], before = 0;
    for (std::size_t k = 0; k + 1 < i; ++k) before += path.step_m[k];
    (void)a;
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (low + high);
      const LightPath cut = look(air(), sensor_m, zenith_deg, before + middle, refraction);
      (cut.node.back().central_angle_deg < turn_deg ? low : high) = middle;
    }
    return look(air(), sensor_m, zenith_deg, before + high, refraction).node.back().height_m;
  }
  return -1;
}

TEST(LineHorizon, IsWhereRaysFromTheSensorPassAndMeetTheSea) {
  for (const bool refraction : {false, true}) {
    const GrazingRay ray(air(), refraction);
    for (const double sensor_m : {3.0, 10.0, 20.0, 200.0, 3000.0}) {
      double above = 90, below = 120;
      for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (above + below);
        const bool meets =
            look(air(), sensor_m, middle, kInfinity, refraction).end == PathEnd::kSurface;
        (meets ? below : above) = middle;
      }
      for (const double along_m : {500.0, 5e3, 12e3, 26e3, 60e3}) {
        const double highest_m = passes_m(sensor_m, above, along_m, refraction);
        ASSERT_GE(highest_m, 0);
        if (highest_m > 300) continue;
        const Environment::Line line = line_of(sensor_m, 10, along_m);
        const LineHorizon horizon(ray, 10, line, 0);
        // The straight line at that z passes the vertical of the target so high.
        const double e = line.elevation_deg * kRadPerDeg, z = static_cast<double>(horizon.z());
        const double height_m =
            10 + line.range_m * (std::sin(e) - std::cos(e) * z / std::sqrt(1 - z * z));
        EXPECT_NEAR(height_m, highest_m, 0.05 + 2e-3 * highest_m)
            << sensor_m << " m, " << along_m << " m, refraction " << refraction;
      }
    }
  }
}

// A sphere of the equivalent radius hides from lifted straight lines all that the ray which touches
// the surface passes below.
TEST(LineHorizon, TheEquivalentSphereHidesAsMuch) {
  const GrazingRay ray(air());
  for (const double sensor_m : {5.0, 20.0, 1000.0}) {
    const double horizon_m = kEarthRadiusM * ray.angle_rad(sensor_m);
    for (const double beyond_m : {2e3, 8e3, 20e3}) {
      const double hidden_m = ray.height_m(beyond_m / kEarthRadiusM);
      const Environment::Line line = line_of(sensor_m, 10, horizon_m + beyond_m);
      const Environment::Horizon h = LineHorizon(ray, 10, line, 0).horizon();
      const double k = 1 - kEarthRadiusM / h.earth_radius_m;
      EXPECT_GT(k, 0.1) << "air bends rays towards the Earth by a sixth of its curvature";
      EXPECT_LT(k, 0.25);
      // At this height above the sphere the lifted line to the sensor touches it.
      const double e = line.elevation_deg * kRadPerDeg;
      const auto lowest_m = [&](double height_m) {
        const double up = line.range_m * std::sin(e) + 10 - height_m;
        const double elevation = std::atan2(up, line.range_m * std::cos(e)) + h.lift_rad;
        EXPECT_LT(elevation, 0);
        return (h.earth_radius_m + height_m) * std::cos(elevation) - h.earth_radius_m;
      };
      EXPECT_NEAR(lowest_m(hidden_m), 0, 0.02 + 2e-3 * hidden_m) << sensor_m << " " << beyond_m;
      EXPECT_GT(std::abs(lowest_m(0.6 * hidden_m)), 0.02 + 2e-3 * hidden_m);
    }
  }
}

constexpr double kHorizonHeightM = 7;

std::vector<double> horizon_wavelengths() {
  std::vector<double> um;
  for (const double x : {3.5, 3.7, 3.9, 4.05, 8.3, 8.9, 10.2, 11.0, 11.8}) {
    um.push_back(air_band_lambda_um(*air_band(x)));
  }
  return um;
}

WeatherSpec horizon_weather(bool refraction = true) {
  WeatherSpec w{{air(), {}}, refraction, {}, nullptr};
  w.air.aerosol.kind = AerosolKind::kMaritime;
  w.air.aerosol.visibility_m = 50e3;
  w.lower.temperature_k = 292;
  w.lower.wind_speed_m_s = 5;
  return w;
}

ConditionEnvironment low_sun(double elevation_deg) {
  const double e = elevation_deg * kRadPerDeg;
  return {0, true, {std::cos(e), 0, -std::sin(e)}, 1};
}

std::unique_ptr<const Environment> horizon_environment(bool refraction = true,
                                                       double sun_deg = 9.8) {
  auto made = Environment::make({horizon_weather(refraction)}, {low_sun(sun_deg), {}},
                                kHorizonHeightM, horizon_wavelengths());
  EXPECT_TRUE(made.ok()) << made.status();
  return *std::move(made);
}

// Returns the radiance at the sensor, without the air in front: [wavelength].
std::vector<double> behind(const Environment& e, Environment::Line line, double z,
                           std::uint32_t condition) {
  line.behind = BackgroundDirections({static_cast<float>(z)});
  return (*e.view(line, std::vector<std::uint32_t>{condition}))[0].background_apparent[0];
}

double mwir(const std::vector<double>& spectrum) {
  return spectrum[0] + spectrum[1] + spectrum[2] + spectrum[3];
}

// A sensor 10 m up, a target at 5 km: the sun's glitter is on the sea beyond, and above the dip
// there is none of it.
TEST(Behind, HasOneStepAtTheDip) {
  for (const bool refraction : {false, true}) {
    const auto e = horizon_environment(refraction);
    const Environment::Line line = line_of(10, kHorizonHeightM, 5e3);
    const double dip_z = static_cast<double>(e->horizons_z(line)[0]);
    EXPECT_GT(dip_z, 5e-4) << "below the horizontal of the target";
    double last = 0;
    int steps = 0;
    for (int i = -60; i <= 60; ++i) {
      const double z = dip_z + (i + 0.5) * 2e-5;
      const double here = mwir(behind(*e, line, z, 0));
      if (i > -60 && std::abs(here / last - 1) > 0.3) {
        ++steps;
        EXPECT_EQ(i, 0) << "z " << z;
        EXPECT_GT(here, 3 * last) << "glitter below, sky above";
      }
      last = here;
    }
    EXPECT_EQ(steps, 1) << "refraction " << refraction;
  }
}

// Rays that fall and miss the Earth, against Atmosphere's sum over every step.
TEST(Behind, SkyBelowTheHorizontalAsSummedOverEveryStep) {
  const auto e = horizon_environment();
  const WeatherSpec spec = horizon_weather();
  const Atmosphere atmosphere = *Atmosphere::make(spec.air);
  std::vector<unsigned char> wanted(kAirBandCount, 0);
  for (const double um : horizon_wavelengths()) wanted[*air_band(um)] = 1;
  const ThermalSurroundings of_weather(spec, atmosphere, kHorizonHeightM, e->nodes(),
                                       BandChoice(wanted), 0);
  PathLight light;
  light.surroundings_w_m2_sr_um = of_weather.surroundings;
  const std::vector<double> um = horizon_wavelengths();
  const GrazingRay ray(air());
  double worst = 0;
  for (const double along_m : {0.0, 5e3}) {
    const Environment::Line line = along_m > 0
                                       ? line_of(10, kHorizonHeightM, along_m)
                                       : Environment::Line{0, 0, body_from_aspect(180, 0), {}};
    const double sensor_m = along_m > 0 ? 10 : kHorizonHeightM;
    const LightPath near_path = *look_between(air(), sensor_m, kHorizonHeightM, line.range_m);
    const AbsorberAmounts near = atmosphere.amounts(near_path);
    const double lift =
        line.range_m > 0 ? (near_path.node.back().zenith_deg - 90 - line.elevation_deg) * kRadPerDeg
                         : 0;
    for (const double part : {0.999, 0.9, 0.7, 0.4, 0.1}) {
      // The ray that passes the target's own height: it falls there by a part of the dip.
      const double z = std::sin(part * ray.dip_rad(kHorizonHeightM) - lift);
      if (along_m > 0 && std::abs(z - std::sin(line.elevation_deg * kRadPerDeg)) > 1) continue;
      Environment::Line at = line;
      if (along_m > 0) {  // a sensor whose line to the target is that ray
        at = line_of(10, kHorizonHeightM, along_m);
      }
      const std::vector<double> seen = behind(*e, at, z, 1);
      // A line that passes at another height has another horizon, and sees the corresponding part
      // of it.
      const double el = line.elevation_deg * kRadPerDeg;
      const double height_m =
          along_m > 0 ? kHorizonHeightM +
                            line.range_m * (std::sin(el) - std::cos(el) * z / std::sqrt(1 - z * z))
                      : kHorizonHeightM;
      if (height_m < 0) continue;
      const double zenith_deg = 90 + part * ray.dip_rad(kHorizonHeightM) / kRadPerDeg;
      if (look(air(), height_m, zenith_deg, kInfinity).end == PathEnd::kSurface) continue;
      const AirSpectrum all =
          atmosphere.sky_radiance(height_m, zenith_deg, light, &near).total_w_m2_sr_um;
      for (std::size_t i = 0; i < um.size(); ++i) {
        worst = std::max(worst, std::abs(seen[i] / all[*air_band(um[i])] - 1));
        EXPECT_NEAR(seen[i] / all[*air_band(um[i])], 1, 0.01)
            << um[i] << " um, " << part << " of the dip, passes at " << height_m << " m";
      }
    }
  }
  std::printf("sky below the horizontal: largest error %.4f\n", worst);
}

// Raising the sensor by 1 mm moves nothing but the dip.
TEST(Behind, RaisingTheSensorChangesItContinuously) {
  const auto e = horizon_environment();
  const double along_m = 5e3;
  for (const double sensor_m : {2.0, 6.999, 7.0, 8.0, 8.9615, 10.0, 40.0}) {
    const Environment::Line low = line_of(sensor_m, kHorizonHeightM, along_m),
                            high = line_of(sensor_m + 1e-3, kHorizonHeightM, along_m);
    const float dip_low = e->horizons_z(low)[0], dip_high = e->horizons_z(high)[0];
    EXPECT_NEAR(static_cast<double>(dip_low), static_cast<double>(dip_high), 1e-6);
    for (const double offset : {-3e-3, -5e-4, -2e-5, 2e-4, 1e-3, 5e-3}) {
      const auto a = behind(*e, low, static_cast<double>(dip_low) + offset, 0),
                 b = behind(*e, high, static_cast<double>(dip_high) + offset, 0);
      for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_NEAR(a[i] / b[i], 1, 3e-4) << sensor_m << " " << offset << " " << i;
    }
  }
}

// The stated bound of reading straight lines between the nodes that a view has.
TEST(Behind, InterpolatesWithinItsBound) {
  const auto e = horizon_environment();
  for (const auto& [sensor_m, along_m] : {std::pair{10.0, 5e3}, {25.0, 5e3}, {300.0, 8e3}}) {
    Environment::Line line = line_of(sensor_m, kHorizonHeightM, along_m);
    const double z = -line.direction.z;
    line.behind = BackgroundDirections::spanning(z - 0.012, z + 0.012, e->horizons_z(line), 0);
    for (const std::uint32_t condition : {0u, 1u}) {
      const ViewEnvironment v = (*e->view(line, std::vector<std::uint32_t>{condition}))[0];
      double worst = 0, error = 0, bound = 0;
      for (int i = 0; i < 400; ++i) {
        const double at = z - 0.012 + 0.024 * (i + 0.5) / 400;
        BackgroundDirections::Share share[2];
        const int n = line.behind.shares(static_cast<float>(at), share);
        const std::vector<double> direct = behind(*e, line, at, condition);
        for (std::size_t k = 0; k < direct.size(); ++k) {
          double linear = 0, allowed = 0;
          for (int j = 0; j < n; ++j) {
            const auto w = static_cast<double>(share[j].weight);
            linear += w * v.background_apparent[share[j].node][k];
            allowed += w * v.background_interpolation[share[j].node][k];
          }
          error += std::abs(linear - direct[k]);
          bound += allowed;
          EXPECT_LE(std::abs(linear - direct[k]), 2 * allowed + 1e-6 * direct[k])
              << sensor_m << " m, z " << at << ", " << k;
          worst = std::max(worst, std::abs(linear / direct[k] - 1));
        }
      }
      std::printf("sensor %4.0f m, condition %u: largest error %.4f, error / bound %.2f\n",
                  sensor_m, condition, worst, error / bound);
      EXPECT_LT(worst, 0.03);
      EXPECT_GT(error, 0.1 * bound);
    }
  }
}

// Turning sun and line of sight together turns the nodes' azimuths beneath them. A line that falls
// on the sea sees sunlit air and reflected sky in front of it, whatever the angle to the sun.
TEST(Behind, TurningTheWorldStaysWithinItsBound) {
  constexpr double kSunDeg = 40;
  double worst = 0, moved = 0;
  for (const double from_sun_deg : {0.0, 25.0, 70.0, 150.0}) {
    std::vector<std::vector<double>> seen, bound;
    for (const double turn_deg : {0.0, 3.0, 7.5, 11.0}) {
      const double turn = turn_deg * kRadPerDeg, e = kSunDeg * kRadPerDeg,
                   sun = (turn_deg + from_sun_deg) * kRadPerDeg;
      const ConditionEnvironment sunny{
          0, true, {std::cos(e) * std::cos(sun), std::cos(e) * std::sin(sun), -std::sin(e)}, 1};
      const auto made =
          *Environment::make({horizon_weather()}, {sunny}, kHorizonHeightM, horizon_wavelengths());
      Environment::Line line = line_of(500, kHorizonHeightM, 4e3);
      line.direction = body_from_aspect(180 + turn_deg, line.elevation_deg);
      line.behind = BackgroundDirections({static_cast<float>(-line.direction.z)}, turn);
      const ViewEnvironment v = (*made->view(line, std::vector<std::uint32_t>{0}))[0];
      seen.push_back(v.background_apparent[0]);
      bound.push_back(v.background_interpolation[0]);
    }
    for (std::size_t turn = 1; turn < seen.size(); ++turn)
      for (std::size_t k = 0; k < seen[0].size(); ++k) {
        const double change = std::abs(seen[turn][k] - seen[0][k]);
        EXPECT_LE(change, bound[turn][k] + bound[0][k] + 1e-6 * seen[0][k])
            << from_sun_deg << " deg from the sun, turn " << turn << ", wavelength " << k;
        moved = std::max(moved, change / seen[0][k]);
        worst = std::max(worst, bound[turn][k] / seen[0][k]);
      }
  }
  std::printf("turned: largest change %.1e, largest bound %.1e of the radiance\n", moved, worst);
  EXPECT_GT(worst, 0) << "reflected sky is known at azimuths of nodes alone";
  EXPECT_LT(worst, 0.04);
}

// Waves that shade each other would change nothing at noon and a third at 2 deg.
TEST(Behind, GrazingGlitterHasAModelError) {
  const auto towards = [](double elevation_deg, double azimuth_deg) {
    const double e = elevation_deg * kRadPerDeg, a = azimuth_deg * kRadPerDeg;
    return Vec<Body>{std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), -std::sin(e)};
  };
  const double low = glint_model_relative(towards(2, 180), towards(2, 0), 5);
  EXPECT_GT(low, 0.25);
  EXPECT_LT(low, 0.6);
  EXPECT_LT(glint_model_relative(towards(60, 180), towards(60, 0), 5), 0.2);
  // Slopes are held at those of 20 m/s; what they would be more is an error.
  EXPECT_EQ(glint_per_sr(towards(60, 180), towards(60, 0), 26),
            glint_per_sr(towards(60, 180), towards(60, 0), 20));
  EXPECT_GT(glint_model_relative(towards(60, 180), towards(60, 0), 26),
            0.00512 * 6 / sea_slope_variance(20) * 0.9);
  // The higher of two suns is shaded less.
  EXPECT_LT(glint_model_relative(towards(2, 180), towards(20, 0), 5), low);
}

}  // namespace
}  // namespace irsig
