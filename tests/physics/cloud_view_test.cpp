// Rationale: rows and pictures under clouds are made of the light of two skies; what is exact of
// single spectra has to be exact of rows, and a picture has to show what its row states.
// Expected: rows with stated temperatures are linear in the cover to 1e-9, wherever the sensor is;
// the pixels of a picture add up to its row within both errors, under clear, broken and overcast
// skies, in fog, and in fog below a cloud. Source: the mixture's definition; the row.
#include <algorithm>
#include <cmath>

#include "core/environment/environment.h"
#include "tests/physics/scene_fixture.h"

namespace irsig {
namespace {

using namespace fixture;

const CloudSpec kStratus = {CloudPhase::kWater, 330, 1000, 0.201, 7.9};

WeatherSpec weather(double cover, const CloudSpec& cloud = kStratus,
                    AerosolKind aerosol = AerosolKind::kMaritime, double visibility_m = 23e3) {
  WeatherSpec w{{afgl_profile(AfglProfile::kMidlatitudeSummer), {aerosol, visibility_m}},
                true,
                {SurfaceBoundary::Kind::kRoughSea, 291, 1, 5},
                nullptr};
  w.cloud_cover = cover;
  if (cover > 0) w.cloud = cloud;
  return w;
}

struct World {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

// A ship by day under each weather.
World world(const std::vector<WeatherSpec>& weathers, double elevation_deg, double range_m) {
  World out;
  SceneSpec scene = scene_of(generated("frigate", 3000), *builtin_material("hull"), lwir());
  scene.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  out.simulator = simulator_of(scene);
  out.request = request(*out.simulator, 70, elevation_deg, range_m, {300});
  out.request.max_reflections = 8;
  out.request.accuracy.samples_per_replicate = 512;
  out.request.condition.assign(weathers.size(), out.request.condition[0]);
  std::vector<ConditionEnvironment> conditions;
  for (std::uint32_t i = 0; i < weathers.size(); ++i) {
    ConditionSpec& c = out.request.condition[i];
    c.surroundings.kind = SurroundingsKind::kSea;
    c.sea_wind_m_s = weathers[i].lower.wind_speed_m_s;
    c.sun = true;
    c.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
    c.sun_cos_zenith = -c.sun_direction.z;
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    conditions.push_back({i, true, c.sun_direction, 1});
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

ViewResult simulated(const World& w) {
  auto view = w.simulator->simulate(w.request);
  EXPECT_TRUE(view.ok()) << view.status();
  return *std::move(view);
}

// Rationale: sunlight that the air scatters is known to 30 %, thermal light to a few percent, and a
// row has one relative error for all of its reflected sky.
// Expected: in each band it is that of the sky's light there, under a clear and an overcast sky; in
// 8-12 um, where the sun hardly counts, it is below 8 %. Source: the sky's mean and its error,
// integrated over the band.
TEST(CloudView, ModelErrorOfAReflectedSkyIsThatOfItsLightInTheBand) {
  const World w = world({weather(0), weather(1)}, 20, 1000);
  const ViewResult view = simulated(w);
  Environment::Line line{1000, 20, body_from_aspect(70, 20), {}};
  line.behind = BackgroundDirections({0.1f, 0.6f});
  const std::vector<std::uint32_t> all = {0, 1};
  const auto light = *w.request.environment->view(line, all);
  ASSERT_EQ(view.row.size(), 4U);
  for (const SignatureResult& row : view.row) {
    const ViewEnvironment& e = light[row.condition];
    std::size_t first = 0;
    for (std::uint32_t b = 0; b < row.band; ++b)
      first += w.simulator->band_grids()[b].node_um.size();
    const BandGrid& grid = w.simulator->band_grids()[row.band];
    double mean = 0, error = 0;
    for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
      mean += grid.band_weight[i] * e.sky_mean[first + i];
      error += grid.band_weight[i] * e.sky_model_error[first + i];
    }
    const auto cause = [&](Cause which) {
      return row.cause_w_sr[static_cast<std::size_t>(which)].value;
    };
    const double sky = error / mean * cause(Cause::kSkyReflected);
    EXPECT_NEAR(row.model_error_w_sr,
                std::hypot(sky, e.lower_model_relative * cause(Cause::kSeaReflected),
                           e.sun_model_relative * cause(Cause::kSunReflected)),
                1e-6 * row.model_error_w_sr)
        << row.condition << " " << row.band;
    EXPECT_GT(sky, 0.1 * row.model_error_w_sr);
    if (row.band == 0) {
      EXPECT_LT(error, 0.08 * mean) << row.condition;
    }
  }
}

// Expected: in a world of one temperature below an opaque cloud nothing is to be seen.
TEST(CloudView, HasNoContrastInAWorldOfOneTemperature) {
  constexpr double kKelvin = 285;
  WeatherSpec w = weather(1, {CloudPhase::kWater, 330, 1000, 50, 7.9});
  for (AirLevel& level : w.air.profile.level) {
    level.temperature_k = kKelvin;
    level.gas.h2o_ppmv = std::min(level.gas.h2o_ppmv, 100.0);
  }
  w.lower = {SurfaceBoundary::Kind::kGround, kKelvin, 0.9, 0};
  World below = world({w}, 5, 1000);
  ConditionSpec& c = below.request.condition[0];
  c.part_temperature_k = {kKelvin};
  c.surroundings.kind = SurroundingsKind::kGround;
  c.sun = false;
  for (const SignatureResult& row : simulated(below).row) {
    EXPECT_NEAR(row.contrast_intensity_w_sr.value, 0,
                3 * row.contrast_numerical_error_w_sr + 1e-6 * row.apparent_intensity_w_sr.value);
    EXPECT_NEAR(row.source_radiance_temperature_k, kKelvin, 0.1);  // 0.2 % of the sky's light
    EXPECT_NEAR(row.apparent_temperature_k, kKelvin, 0.1);
  }
}

// A plate of reflectance 0.4 under a stratus based at 330 m, seen from 60 deg up. Expected: what it
// reflects of the sky is within 3 % (8-12 um) and 5 % (3-5 um) of a black base's, 286.0 K: 42.7 and
// 1.54 W/sr; sunlight is below 1 % of the 3.37 W/sr that it reflects under a clear sky.
TEST(CloudView, APlateReflectsTheBaseOfAStratus) {
  const double zenith_rad = 26 * M_PI / 180;
  SceneSpec scene = scene_of(generated("box", 12, 0, 2, 2, 0.1), grey(0.6), lwir());
  scene.band[0].step_um = 0.1;
  scene.band.push_back({"MWIR", 3, 5, 0.05, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  const auto simulator = simulator_of(scene);
  ViewRequest view = request(*simulator, 0, 60, 100, {290});
  view.max_reflections = 1;
  view.accuracy.samples_per_replicate = 512;
  view.condition.assign(2, view.condition[0]);
  view.selected_condition = {0, 1};
  WeatherSpec w{{afgl_profile(AfglProfile::kUsStandard1976), {AerosolKind::kRural, 23e3}},
                true,
                {SurfaceBoundary::Kind::kGround, 293, 0.95, 0},
                nullptr};
  w.cloud = kStratus;
  w.cloud_cover = 1;
  std::vector<ConditionEnvironment> conditions;
  for (const bool sun : {false, true}) {
    ConditionSpec& c = view.condition[conditions.size()];
    c.surroundings.kind = SurroundingsKind::kGround;
    c.sun = sun;
    c.sun_direction = {std::sin(zenith_rad), 0, -std::cos(zenith_rad)};
    c.sun_cos_zenith = std::cos(zenith_rad);
    c.sun_angular_radius_deg = 0.266;
    c.sun_scale = 1;
    conditions.push_back({0, sun, c.sun_direction, 1});
  }
  std::vector<double> node_um;
  for (const BandGrid& grid : simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  view.environment = *Environment::make({w}, conditions, 1, node_um);
  const ViewResult seen = *simulator->simulate(view);
  const auto sky = [&](std::uint32_t condition, std::uint32_t band) {
    double sum = 0;
    for (const SignatureResult& r : seen.row)
      if (r.condition == condition && r.band == band)
        for (const Cause cause : {Cause::kSkyReflected, Cause::kSunReflected})
          sum += r.cause_w_sr[static_cast<std::size_t>(cause)].value;
    return sum;
  };
  RecordProperty("w_sr_8_12", std::to_string(sky(0, 0)));
  RecordProperty("w_sr_3_5", std::to_string(sky(0, 1)));
  EXPECT_NEAR(sky(0, 0), 42.7, 0.03 * 42.7);
  EXPECT_NEAR(sky(0, 1), 1.54, 0.05 * 1.54);
  EXPECT_GT(sky(1, 1), sky(0, 1));
  EXPECT_LT(sky(1, 1) - sky(0, 1), 0.01 * 3.37);
}

// Rationale: under a broken sky a target has one sky or the other; a sky that is brighter in the
// hull is brighter in the sea behind it, too.
// Expected: one sigma of the choice, sqrt(c (1 - c)) times the difference of the rows under both
// skies, is part of the model error of each intensity, and beside it no more than both skies' own:
// rms z of 0.7 to 1.4 over all rows, which an error of the parts, each counted by itself, fails.
TEST(CloudView, StatesWhichOfBothSkiesATargetHasAsModelError) {
  using Row = SignatureResult;
  const std::vector<double> covers = {0, 1, 0.05, 0.3, 0.5, 0.9};
  std::vector<WeatherSpec> weathers;
  for (const double cover : covers) weathers.push_back(weather(cover));
  double squares = 0;
  int count = 0;
  for (const auto& [elevation_deg, range_m] :
       {std::pair{2.0, 4000.0}, {5.0, 1000.0}, {40.0, 1000.0}, {60.0, 3000.0}}) {
    const ViewResult view = simulated(world(weathers, elevation_deg, range_m));
    ASSERT_EQ(view.row.size(), 2 * covers.size());
    const auto row = [&](std::size_t condition, std::uint32_t band) -> const Row& {
      return *std::find_if(view.row.begin(), view.row.end(), [&](const Row& r) {
        return r.condition == condition && r.band == band;
      });
    };
    for (const std::uint32_t band : {0u, 1u}) {
      const Row &none = row(0, band), &all = row(1, band);
      for (std::size_t k = 2; k < covers.size(); ++k) {
        const Row& some = row(k, band);
        const auto check = [&](const char* what, auto&& value, auto&& error) {
          const double choice =
              std::sqrt(covers[k] * (1 - covers[k])) * std::abs(value(all) - value(none));
          EXPECT_GE(error(some), (1 - 1e-6) * choice) << what << " " << covers[k];
          EXPECT_LE(error(some), std::hypot(choice, error(none) + error(all)))
              << what << " " << covers[k] << " " << elevation_deg << " " << band;
          squares += std::pow(choice / error(some), 2);
          ++count;
        };
        check(
            "source", [](const Row& r) { return r.intensity_w_sr.value; },
            [](const Row& r) { return r.model_error_w_sr; });
        check(
            "apparent", [](const Row& r) { return r.apparent_intensity_w_sr.value; },
            [](const Row& r) { return r.apparent_model_error_w_sr; });
        check(
            "contrast", [](const Row& r) { return r.contrast_intensity_w_sr.value; },
            [](const Row& r) { return r.contrast_model_error_w_sr; });
      }
    }
  }
  const double rms = std::sqrt(squares / count);
  RecordProperty("rms_z", std::to_string(rms));
  EXPECT_GT(rms, 0.7);
  EXPECT_LT(rms, 1.4);
}

// Below the cloud, inside it, above it; all covers on the same paths.
TEST(CloudView, RowsAreLinearInTheCover) {
  const std::vector<double> covers = {0, 1, 1e-9, 0.3};
  const CloudSpec on_ground = {CloudPhase::kWater, 0, 300, 0.003, 8};
  for (const CloudSpec& cloud : {kStratus, on_ground}) {
    std::vector<WeatherSpec> weathers;
    for (const double cover : covers) weathers.push_back(weather(cover, cloud));
    for (const auto& [elevation_deg, range_m] :
         {std::pair{5.0, 1000.0}, {40.0, 1000.0}, {60.0, 3000.0}}) {
      const ViewResult view = simulated(world(weathers, elevation_deg, range_m));
      ASSERT_EQ(view.row.size(), 2 * covers.size());
      const auto row = [&](std::uint32_t condition, std::uint32_t band) -> const SignatureResult& {
        for (const SignatureResult& r : view.row)
          if (r.condition == condition && r.band == band) return r;
        ADD_FAILURE() << "no row";
        return view.row.front();
      };
      for (const std::uint32_t band : {0u, 1u}) {
        const SignatureResult &none = row(0, band), &all = row(1, band);
        for (std::uint32_t k = 2; k < covers.size(); ++k) {
          const SignatureResult& some = row(k, band);
          const auto linear = [&](const char* what, auto&& of, double scale) {
            const double mixed = (1 - covers[k]) * of(none) + covers[k] * of(all);
            EXPECT_NEAR(of(some), mixed, 1e-9 * scale)
                << what << " " << covers[k] << " " << elevation_deg << " " << band;
          };
          using Row = SignatureResult;
          const auto source = [](const Row& r) { return r.intensity_w_sr.value; };
          const auto apparent = [](const Row& r) { return r.apparent_intensity_w_sr.value; };
          const auto contrast = [](const Row& r) { return r.contrast_intensity_w_sr.value; };
          const auto behind = [](const Row& r) { return r.background_radiance_w_m2_sr.value; };
          linear("intensity", source, source(some));
          linear("apparent", apparent, apparent(some));
          linear("contrast", contrast, std::abs(contrast(some)));
          linear("background", behind, behind(some));
          linear(
              "path", [](const Row& r) { return r.path_radiance_w_m2_sr; },
              some.path_radiance_w_m2_sr);
          linear(
              "transmittance", [](const Row& r) { return r.path_transmittance; },
              some.path_transmittance);
        }
      }
    }
  }
}

TEST(CloudView, PixelsAddUpToTheRow) {
  constexpr std::uint32_t kPx = 64;
  const CloudSpec on_ground = {CloudPhase::kWater, 0, 300, 0.003, 8};
  const struct {
    const char* name;
    WeatherSpec weather;
  } skies[] = {
      {"clear", weather(0)},
      {"almost clear", weather(1e-9)},
      {"broken", weather(0.5)},
      {"overcast", weather(1)},
      {"cloud on the ground", weather(1, on_ground)},
      {"broken cloud on the ground", weather(0.4, on_ground)},
      {"fog", weather(0, kStratus, AerosolKind::kAdvectionFog, 1000)},
      {"fog below a cloud", weather(1, kStratus, AerosolKind::kAdvectionFog, 1000)},
      {"fog below a broken cloud", weather(0.5, kStratus, AerosolKind::kAdvectionFog, 1000)}};
  for (const auto& sky : skies) {
    World w = world({sky.weather}, 10, 800);
    w.request.accuracy.samples_per_replicate = 1u << 12;
    ImageSpec image;
    image.width_px = image.height_px = kPx;
    image.margin = 4;  // the target is 7 pixels long
    image.layer = {ImageLayer::kPath, ImageLayer::kBackground, ImageLayer::kAtSensor};
    w.request.image = image;
    const ViewResult view = simulated(w);
    ASSERT_EQ(view.row.size(), 2U);
    for (const SignatureResult& row : view.row) {
      ASSERT_EQ(row.layer.size(), 3U);
      const LayerImage &path = row.layer[0], &behind = row.layer[1], &seen = row.layer[2];
      double source = 0, contrast = 0, square = 0;
      const double of_pixel = std::pow(view.pixel_rad * w.request.viewpoint.range_m, 2);
      for (std::size_t i = 0; i < seen.value.size(); ++i) {
        const double x = (static_cast<double>(i % kPx) - 0.5 * (kPx - 1)) * view.pixel_rad,
                     y = (static_cast<double>(i / kPx) - 0.5 * (kPx - 1)) * view.pixel_rad;
        const double m2 = of_pixel * std::pow(1 + x * x + y * y, -1.5);
        source += m2 * static_cast<double>(row.image_w_m2_sr[i]);
        contrast += m2 * (static_cast<double>(seen.value[i]) - static_cast<double>(path.value[i]) -
                          static_cast<double>(behind.value[i]));
        square += std::pow(m2 * std::max(static_cast<double>(seen.stderr_[i]),
                                         6e-8 * static_cast<double>(seen.value[i])),
                           2);
      }
      const double error = std::hypot(std::sqrt(square), row.contrast_numerical_error_w_sr);
      EXPECT_NEAR(contrast, row.contrast_intensity_w_sr.value, 3 * error)
          << sky.name << " " << row.band;
      EXPECT_LT(error, 0.02 * row.intensity_w_sr.value) << sky.name;
      // The picture has paths of its own.
      EXPECT_NEAR(source, row.intensity_w_sr.value,
                  3 * row.numerical_error_w_sr + 0.002 * row.intensity_w_sr.value)
          << sky.name << " " << row.band;
    }
  }
}

}  // namespace
}  // namespace irsig
