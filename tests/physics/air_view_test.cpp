// Rationale: from the air's tables to a stored row, every hand-over in between must fit: nodes and
// their order, wavelengths and bands, what arrives and what is added, target and background.
// Expected: in a world of one temperature behind opaque air everything is a blackbody, the contrast
// is zero; a body warmer or colder than that is seen with the right sign and size; what is computed
// beside changes no bit.
// Source: Kirchhoff, Planck.
#include <cmath>
#include <numbers>

#include "core/environment/environment.h"
#include "core/spectral/planck.h"
#include "scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

constexpr double kWorldK = 290;

WeatherSpec weather(AerosolKind aerosol, double visibility_m, double wind_m_s) {
  WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {aerosol, visibility_m}},
                true,
                {SurfaceBoundary::Kind::kRoughSea, kWorldK, 1, wind_m_s},
                nullptr};
  return w;
}

WeatherSpec one_temperature_fog(double visibility_m) {
  WeatherSpec w = weather(AerosolKind::kAdvectionFog, visibility_m, 7);
  for (AirLevel& level : w.air.profile.level) {
    level.temperature_k = kWorldK;
    level.gas.h2o_ppmv = std::min(level.gas.h2o_ppmv, 1e4);
  }
  return w;
}

struct World {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

// A ship of `hull` under each weather, by day or by night, in the bands of the fixture.
World world(const std::vector<WeatherSpec>& weathers, bool sun, double elevation_deg,
            double range_m, double ship_k) {
  World out;
  SceneSpec scene = scene_of(generated("frigate", 3000), *builtin_material("hull"), lwir());
  scene.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  out.simulator = simulator_of(scene);
  out.request = request(*out.simulator, 70, elevation_deg, range_m, {ship_k});
  out.request.max_reflections = 8;
  out.request.accuracy.samples_per_replicate = 512;
  out.request.condition.assign(weathers.size(), out.request.condition[0]);
  std::vector<ConditionEnvironment> conditions;
  for (std::uint32_t i = 0; i < weathers.size(); ++i) {
    ConditionSpec& c = out.request.condition[i];
    c.surroundings.kind = SurroundingsKind::kSea;
    c.sea_wind_m_s = weathers[i].lower.wind_speed_m_s;
    c.sun = sun;
    c.sun_direction = normalized(Vec<Body>{0.3, 0.5 + 0.1 * i, -0.8});
    c.sun_cos_zenith = -c.sun_direction.z;
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    conditions.push_back({i, sun, c.sun_direction, 1});
    if (i > 0) out.request.selected_condition.push_back(i);
  }
  std::vector<double> node_um;
  for (const BandGrid& grid : out.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto made = Environment::make(weathers, conditions, 6, node_um);
  EXPECT_TRUE(made.ok()) << made.status();
  out.request.environment = *std::move(made);
  return out;
}

double planck_in_band(std::uint32_t band, double kelvin) {
  return band == 0 ? planck_band_radiance_w_m2_sr(8, 12, kelvin)
                   : planck_band_radiance_w_m2_sr(3.2, 5, kelvin);
}

TEST(AirView, AWorldOfOneTemperatureIsABlackbody) {
  // Far behind opaque fog, and so near that the ship is seen against it. The sensor is within the
  // fog: from above, its particles scatter the cold sky.
  const struct {
    double visibility_m, elevation_deg, range_m;
  } cases[] = {{200, 2, 5000}, {200, 30, 1500}, {1000, 30, 250}};
  for (const auto& c : cases) {
    const World w =
        world({one_temperature_fog(c.visibility_m)}, false, c.elevation_deg, c.range_m, kWorldK);
    const auto view = w.simulator->simulate(w.request);
    ASSERT_TRUE(view.ok()) << view.status();
    for (const SignatureResult& r : view->row) {
      const double black = planck_in_band(r.band, kWorldK) * r.projected_area_m2.value;
      expect_within_t(r.intensity_w_sr, black, 6, "source", 1e-2, 3e-4 * black);
      EXPECT_NEAR(r.apparent_intensity_w_sr.value, black, 4e-3 * black);
      EXPECT_NEAR(r.contrast_intensity_w_sr.value, 0, 4e-3 * black);
      EXPECT_NEAR(r.background_radiance_w_m2_sr.value, planck_in_band(r.band, kWorldK),
                  5e-3 * planck_in_band(r.band, kWorldK));
      // The target's depth does not matter where it is as bright as the air.
      EXPECT_LT(r.apparent_numerical_error_w_sr,
                r.apparent_intensity_w_sr.stderr_ + r.numerical_error_w_sr + 3e-3 * black);
      if (c.range_m > 1000)
        EXPECT_LT(r.path_transmittance, 1e-6);
      else
        EXPECT_GT(r.path_transmittance, 0.1) << "or a contrast of 0 would say nothing";
    }
  }
}

// Near and clear: a warmer ship stands out, a colder one is dark, and both by about what Planck
// says of their emission.
TEST(AirView, ContrastHasTheSignOfTheDifference) {
  const WeatherSpec clear = weather(AerosolKind::kMaritime, 50e3, 5);
  double contrast[3];
  const double kelvin[3] = {280, 290, 300};
  double area = 0;
  for (int i = 0; i < 3; ++i) {
    const World w = world({clear}, false, 30, 2000, kelvin[i]);
    const auto view = w.simulator->simulate(w.request);
    ASSERT_TRUE(view.ok()) << view.status();
    const SignatureResult& r = view->row[0];
    contrast[i] = r.contrast_intensity_w_sr.value;
    area = r.projected_area_m2.value;
    // The apparent intensity is the source through the air, and the path.
    EXPECT_LT(r.apparent_numerical_error_w_sr, 0.02 * r.apparent_intensity_w_sr.value);
    EXPECT_GT(r.path_transmittance, 0.4);
    EXPECT_LT(r.path_transmittance, 0.95);
    EXPECT_NEAR(r.contrast_intensity_w_sr.value,
                r.apparent_intensity_w_sr.value - area * r.background_radiance_w_m2_sr.value,
                1e-6 * r.apparent_intensity_w_sr.value)
        << "ray by ray, or as a whole: the same sum";
  }
  EXPECT_LT(contrast[0], contrast[1]);
  EXPECT_LT(contrast[1], contrast[2]);
  EXPECT_LT(contrast[0], 0);
  EXPECT_GT(contrast[2], 0);
  const World w = world({clear}, false, 30, 2000, 290);
  const double step = area * (planck_in_band(0, 300) - planck_in_band(0, 280));
  EXPECT_GT(contrast[2] - contrast[0], 0.4 * 0.7 * step);
  EXPECT_LT(contrast[2] - contrast[0], 0.95 * step);
}

TEST(AirView, BitsDoNotDependOnWhatIsComputedBeside) {
  const World w =
      world({weather(AerosolKind::kMaritime, 23e3, 5), weather(AerosolKind::kRural, 10e3, 12)},
            true, 10, 5000, 300);
  const auto together = w.simulator->simulate(w.request);
  ASSERT_TRUE(together.ok()) << together.status();
  for (std::uint32_t c = 0; c < 2; ++c)
    for (std::uint32_t b = 0; b < 2; ++b) {
      ViewRequest one = w.request;
      one.selected_condition = {c};
      one.selected_band = {b};
      const auto alone = w.simulator->simulate(one);
      ASSERT_TRUE(alone.ok());
      const SignatureResult &x = alone->row[0], &y = together->row[2 * c + b];
      EXPECT_EQ(x.intensity_w_sr.value, y.intensity_w_sr.value);
      EXPECT_EQ(x.numerical_error_w_sr, y.numerical_error_w_sr);
      EXPECT_EQ(x.apparent_spectral.value, y.apparent_spectral.value);
      EXPECT_EQ(x.contrast_spectral.stderr_, y.contrast_spectral.stderr_);
      EXPECT_EQ(x.background_spectral.value, y.background_spectral.value);
      EXPECT_EQ(x.apparent_model_error_w_sr, y.apparent_model_error_w_sr);
    }
}

// Day and night differ by sunlight alone: its sky, its glitter, its own.
TEST(AirView, TheSunOnlyAdds) {
  const WeatherSpec clear = weather(AerosolKind::kMaritime, 23e3, 5);
  const World day = world({clear}, true, 15, 3000, 295),
              night = world({clear}, false, 15, 3000, 295);
  const auto lit = day.simulator->simulate(day.request),
             dark = night.simulator->simulate(night.request);
  ASSERT_TRUE(lit.ok() && dark.ok());
  for (std::size_t row = 0; row < 2; ++row) {
    const SignatureResult &x = lit->row[row], &y = dark->row[row];
    const auto cause = [](const SignatureResult& r, Cause c) {
      return r.cause_w_sr[static_cast<std::size_t>(c)].value;
    };
    EXPECT_EQ(cause(x, Cause::kEmitted), cause(y, Cause::kEmitted)) << "the same paths";
    EXPECT_EQ(cause(y, Cause::kSunReflected), 0);
    EXPECT_GT(cause(x, Cause::kSunReflected), 0);
    EXPECT_GT(cause(x, Cause::kSkyReflected), cause(y, Cause::kSkyReflected) * 0.998);
    EXPECT_GT(cause(x, Cause::kSeaReflected), cause(y, Cause::kSeaReflected) * 0.998);
    EXPECT_GT(x.path_radiance_w_m2_sr, y.path_radiance_w_m2_sr);
    EXPECT_NEAR(x.path_transmittance, y.path_transmittance, 1e-12);
  }
}

}  // namespace
}  // namespace irsig
