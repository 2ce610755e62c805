#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/environment/environment.h"
#include "scene_fixture.h"

// A box on land of a stated shape, in summer air.
namespace irsig::fixture {

inline constexpr double kGroundK = 295, kTargetK = 310, kEmissivity = 0.9;

using Height = std::function<double(double x_m, double y_m)>;

inline std::shared_ptr<const LandScene> land_of(const Height& height, double half_m = 10'000,
                                                double spacing_m = 50) {
  HeightGrid grid{-half_m, -half_m, spacing_m, 0, 0, {}};
  grid.columns = grid.rows = static_cast<std::uint32_t>(2 * half_m / spacing_m);
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column) {
      const double x = grid.west_m + column * spacing_m, y = grid.south_m + row * spacing_m;
      grid.z_m.push_back(static_cast<float>(height(x, y) - (x * x + y * y) / (2 * kEarthRadiusM)));
    }
  auto field = HeightField::create(std::move(grid));
  EXPECT_TRUE(field.ok()) << field.status();
  auto out = std::make_shared<LandScene>();
  out->field = std::make_shared<const HeightField>(*std::move(field));
  out->heading_deg = 30;
  out->surface_m = out->field->z_m(0, 0).value();
  return out;
}

struct Scene {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

// Air of a summer above a grey ground, or all of one temperature above a black one.
inline WeatherSpec scene_weather(double air_k = 0) {
  WeatherSpec weather{{afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kRural, 23e3}},
                      true,
                      {SurfaceBoundary::Kind::kGround, air_k > 0 ? air_k : kGroundK,
                       air_k > 0 ? 1 : kEmissivity, 0},
                      nullptr,
                      3};
  if (air_k > 0)
    for (AirLevel& level : weather.air.profile.level) level.temperature_k = air_k;
  return weather;
}

// A box of an emissivity of 0.6, a metre above the ground, in both bands.
inline Scene scene_on(double elevation_deg, double range_m, bool sun, double air_k = 0,
                      double land_emissivity = kEmissivity) {
  Scene out;
  SceneSpec scene = scene_of(generated("box", 300, 0, 4, 3, 2), grey(0.6), lwir());
  scene.band.push_back({"MWIR", 3.2, 5, 0.25, {}});
  scene.spectral_breaks_um = air_band_edges_um(3, 13);
  scene.land_material = {grey(land_emissivity)};
  out.simulator = simulator_of(scene);
  out.request = request(*out.simulator, 70, elevation_deg, range_m, {air_k > 0 ? air_k : kTargetK});
  out.request.max_reflections = 2;
  out.request.accuracy.samples_per_replicate = 2048;
  ConditionSpec& c = out.request.condition[0];
  c.surroundings.kind = SurroundingsKind::kGround;
  c.above_surface_m = 3;
  c.land_temperature_k = {air_k > 0 ? air_k : kGroundK};
  c.sun = sun;
  c.sun_direction = normalized(Vec<Body>{0.3, 0.5, -0.8});
  c.sun_cos_zenith = -c.sun_direction.z;
  c.sun_angular_radius_deg = 0.266;
  c.sun_scale = 1;
  const WeatherSpec weather = scene_weather(air_k);
  std::vector<double> node_um;
  for (const BandGrid& grid : out.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  auto made = Environment::make({weather}, {{0, sun, c.sun_direction, 1}}, 6, std::move(node_um));
  EXPECT_TRUE(made.ok()) << made.status();
  out.request.environment = *std::move(made);
  return out;
}

inline ViewResult view_of(Scene& scene, std::shared_ptr<const LandScene> land) {
  scene.request.land = std::move(land);
  auto view = scene.simulator->simulate(scene.request);
  EXPECT_TRUE(view.ok()) << view.status();
  return view.ok() ? *std::move(view) : ViewResult{};
}

inline double flat(double, double) { return 0; }

// A wall north, east, south or west of the target, in the frame of the land.
inline Height wall(double distance_m, double height_m, double azimuth_deg) {
  const double east = std::sin(azimuth_deg * kRadPerDeg),
               north = std::cos(azimuth_deg * kRadPerDeg);
  return [=](double x, double y) { return x * east + y * north > distance_m ? height_m : 0.0; };
}

}  // namespace irsig::fixture
