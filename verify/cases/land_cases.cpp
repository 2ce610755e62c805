#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/environment/environment.h"
#include "core/land/height_field.h"
#include "core/land/land_scene.h"
#include "verify/cases/bodies.h"
#include "verify/cases/groups.h"

// Land: rays against closed forms of spheres, planes and walls, and views from places where land
// fills the sight, hides it or ends in it.
namespace irsig {
namespace {

using Height = std::function<double(double x_m, double y_m)>;

absl::StatusOr<HeightField> land_field(const Height& height, double half_x_m, double half_y_m,
                                       double spacing_m) {
  HeightGrid grid{-half_x_m, -half_y_m, spacing_m, 0, 0, {}};
  grid.columns = static_cast<std::uint32_t>(std::lround(2 * half_x_m / spacing_m));
  grid.rows = static_cast<std::uint32_t>(std::lround(2 * half_y_m / spacing_m));
  for (std::uint32_t row = 0; row <= grid.rows; ++row)
    for (std::uint32_t column = 0; column <= grid.columns; ++column)
      grid.z_m.push_back(static_cast<float>(
          height(grid.west_m + column * spacing_m, grid.south_m + row * spacing_m)));
  return HeightField::create(std::move(grid));
}

double sphere_m(double x_m, double y_m) {
  const double r2 = x_m * x_m + y_m * y_m;
  return -r2 / (kEarthRadiusM + std::sqrt(kEarthRadiusM * kEarthRadiusM - r2));
}

// Strips of land, since a horizon is seen along one azimuth at a time.
absl::StatusOr<Finding> horizon_of_a_sphere(Effort) {
  Worst worst(2e-5);
  for (const double height_m : {2.0, 20.0, 300.0, 3000.0, 30e3}) {
    const double reach_m = 1.2 * std::sqrt(2 * kEarthRadiusM * height_m);
    const double spacing_m = reach_m / 2000;
    ASSIGN_OR_RETURN(const HeightField field,
                     land_field(sphere_m, 2000 * spacing_m, 2 * spacing_m, spacing_m));
    const double dip = std::acos(kEarthRadiusM / (kEarthRadiusM + height_m));
    for (const double east : {1.0, -1.0}) {
      double sky = 0, land = 2 * dip;
      for (int i = 0; i < 60; ++i) {
        const double fall = 0.5 * (sky + land);
        const bool met =
            field.first_hit({0, 0, height_m}, {east * std::cos(fall), 0, -std::sin(fall)}, 1e7)
                .has_value();
        (met ? land : sky) = fall;
      }
      worst.see(std::abs(0.5 * (sky + land) - dip),
                [&] { return absl::StrCat("horizon from ", height_m, " m"); });
      // Where a ray meets the sphere before it: across the ray, as an angle.
      for (const double times : {1.01, 1.1, 1.5, 4.0}) {
        const double fall = std::min(times * dip, 1.5), r = kEarthRadiusM + height_m;
        const double b = r * std::sin(fall);
        const double expected_m = height_m * (r + kEarthRadiusM) /
                                  (b + std::sqrt(b * b - height_m * (r + kEarthRadiusM)));
        const auto hit =
            field.first_hit({0, 0, height_m}, {east * std::cos(fall), 0, -std::sin(fall)}, 1e7);
        if (!hit) {
          worst.require(false, [&] { return absl::StrCat("lost from ", height_m, " m"); });
          continue;
        }
        // A facet moves a hit along a grazing ray; its height says how far across.
        const double across_m =
            std::abs(hit->distance - expected_m) *
            std::sqrt(std::max(0.0, 1 - std::pow(r / kEarthRadiusM * std::cos(fall), 2)));
        worst.see(across_m / expected_m,
                  [&] { return absl::StrCat("place from ", height_m, " m, ", times, " dips"); });
      }
    }
  }
  return worst.finding();
}

// A map of one cell, and a cliff one cell wide: each ray has the hit of a plane or wall.
absl::StatusOr<Finding> smallest_maps(Effort) {
  Worst worst(1e-9);
  ASSIGN_OR_RETURN(const HeightField texel,
                   land_field([](double, double) { return 3.0; }, 5, 5, 10));
  const double cliff_m = 50;
  ASSIGN_OR_RETURN(
      const HeightField cliff,
      land_field([&](double x, double) { return x > 0 ? cliff_m : 0.0; }, 100, 100, 1));
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const Vec<Body> random = uniform_direction(17, 4 * i);
    const Vec<Enu> d{random.x, random.y, -std::abs(random.z) - 1e-6};
    const double x = 9.8 * uniform(17, 4 * i + 2) - 4.9, y = 9.8 * uniform(17, 4 * i + 3) - 4.9;
    // Begins above the point of the plane that it meets.
    const double t = 0.5 + 3 * uniform(18, i);
    const Vec<Enu> from{x - t * d.x, y - t * d.y, 3 - t * d.z};
    const auto hit = texel.first_hit(from, d, 1e6);
    worst.require(hit.has_value() && !hit->at_edge, [&] { return absl::StrCat("texel, ray ", i); });
    if (hit) worst.see(std::abs(hit->distance - t), [&] { return absl::StrCat("texel, ray ", i); });
    // From before the cliff towards its face, which rises over the cell from x = 0 to 1.
    const double z = 1 + 48 * uniform(19, 2 * i), along = 20 + 60 * uniform(19, 2 * i + 1);
    const Vec<Enu> before{-along, y, z}, level{1, 0.1 * random.y, 0};
    const auto face = cliff.first_hit(before, level, 1e6);
    worst.require(face.has_value(), [&] { return absl::StrCat("cliff, ray ", i); });
    if (face)
      worst.see(std::abs(face->distance - along - z / cliff_m),
                [&] { return absl::StrCat("cliff, ray ", i); });
    worst.require(!cliff.hidden({-along, y, cliff_m + 1e-3}, level, 150),
                  [&] { return absl::StrCat("above the cliff, ray ", i); });
  }
  return worst.finding();
}

struct World {
  std::unique_ptr<Simulator> simulator;
  ViewRequest request;
};

// A black box on black land, air and sky of one temperature but for space behind the air.
absl::StatusOr<World> world_on(const Height& height, double half_m, double spacing_m,
                               double elevation_deg, double range_m, double kelvin,
                               std::optional<Vec<Body>> sun = std::nullopt, double emissivity = 1) {
  World out;
  SceneSpec scene = one_body(needle_slab(8, 4, 2), grey_paint(emissivity));
  scene.band = {long_wave()};
  scene.spectral_breaks_um = air_band_edges_um(7, 13);
  scene.land_material = {grey_paint(emissivity)};
  ASSIGN_OR_RETURN(out.simulator, Simulator::create(scene));
  out.request = dark_view(*out.simulator, 40, elevation_deg, range_m, {kelvin});
  out.request.max_reflections = 1;
  out.request.accuracy.samples_per_replicate = 512;
  ConditionSpec& c = out.request.condition[0];
  c.surroundings.kind = SurroundingsKind::kGround;
  c.above_surface_m = 2;
  c.land_temperature_k = {kelvin};
  if (sun) put_sun(c, *sun);
  WeatherSpec weather{{afgl_profile(AfglProfile::kMidlatitudeSummer), {AerosolKind::kNone, 0}},
                      true,
                      {SurfaceBoundary::Kind::kGround, kelvin, emissivity, 0},
                      nullptr,
                      2};
  for (AirLevel& level : weather.air.profile.level) level.temperature_k = kelvin;
  std::vector<double> node_um;
  for (const BandGrid& grid : out.simulator->band_grids())
    node_um.insert(node_um.end(), grid.node_um.begin(), grid.node_um.end());
  ASSIGN_OR_RETURN(out.request.environment,
                   Environment::make({weather}, {{0, sun.has_value(), c.sun_direction, 1}}, 2,
                                     std::move(node_um)));
  ASSIGN_OR_RETURN(HeightField field, land_field(height, half_m, half_m, spacing_m));
  auto land = std::make_shared<LandScene>();
  land->field = std::make_shared<const HeightField>(std::move(field));
  land->heading_deg = 77;
  land->surface_m = land->field->z_m(0, 0).value_or(0);
  out.request.land = std::move(land);
  return out;
}

absl::StatusOr<Finding> nothing_stands_out(Effort) {
  Worst worst(1e-6);
  const struct {
    const char* name;
    Height height;
    double half_m, spacing_m, elevation_deg, range_m;
    bool before_land = true;
  } cases[] = {
      {"in a valley", [](double x, double y) { return 0.02 * (std::abs(x) + std::abs(y)); }, 3000,
       20, 20, 900},
      {"on a summit", [](double x, double y) { return -0.3 * std::hypot(x, y); }, 3000, 20, 0.5,
       900, false},
      {"from 30 km up", [](double x, double) { return 40 * std::sin(x / 300); }, 20'000, 100, 80,
       30e3},
      {"steeply on rough land",
       [](double x, double y) { return 3 * std::sin(x) * std::cos(1.3 * y) + 0.1 * x; }, 300, 0.5,
       60, 200},
      {"at the map's edge", [](double, double) { return 0.0; }, 6, 1, 20, 500},
      {"on one cell", [](double, double) { return 0.0; }, 4, 8, 40, 300},
      {"before a cliff of one cell", [](double x, double) { return x < -10 ? 80.0 : 0.0; }, 500, 1,
       20, 800},
  };
  for (const auto& c : cases) {
    ASSIGN_OR_RETURN(const World world,
                     world_on(c.height, c.half_m, c.spacing_m, c.elevation_deg, c.range_m, 290));
    ASSIGN_OR_RETURN(const ViewResult view, world.simulator->simulate(world.request));
    const SignatureResult& r = view.row.front();
    const double black = black_radiance_w_m2_sr(*world.simulator, 0, 290);
    const double most = black * r.projected_area_m2.value;
    // Where no sky is behind the target: that is not black.
    if (c.before_land) {
      worst.see(std::abs(r.contrast_intensity_w_sr.value) / most,
                [&] { return absl::StrCat(c.name, ": contrast"); });
      worst.see(std::abs(r.background_radiance_w_m2_sr.value / black - 1),
                [&] { return absl::StrCat(c.name, ": background"); });
    }
    worst.require(r.projected_area_m2.value > 0 && r.clutter.has_value() &&
                      r.clutter->clutter_sigma_w_m2_sr.value >= 0 &&
                      std::isfinite(r.clutter->clutter_mean_w_m2_sr.value),
                  [&] { return absl::StrCat(c.name, ": no clutter"); });
    worst.require(
        r.background_radiance_w_m2_sr.value < 1.0001 * black &&
            r.apparent_intensity_w_sr.value < 1.0001 * most + r.apparent_intensity_w_sr.stderr_,
        [&] { return absl::StrCat(c.name, ": brighter than a blackbody"); });
  }
  return worst.finding();
}

// The sun 0.1 deg above and below the line over a ridge.
absl::StatusOr<Finding> sun_at_a_ridge(Effort) {
  Worst worst(0);
  const double heading_deg = 77, rise = 0.2;  // tangent of the ridge's elevation
  const Height ridge = [&](double x, double) { return x > 400 ? 402 * rise : 0.0; };
  // East of the target, in its body frame; the target reaches 2 m above and 2.5 m around.
  const double azimuth = (90 - heading_deg) * kRadPerDeg;
  for (const bool above : {false, true}) {
    const double elevation = std::atan(rise) + (above ? 0.5 : -1.2) * kRadPerDeg;
    const Vec<Body> sun{std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth), -std::sin(elevation)};
    ASSIGN_OR_RETURN(const World world, world_on(ridge, 3000, 2, 60, 900, 290, sun, 0.5));
    ASSIGN_OR_RETURN(const ViewResult view, world.simulator->simulate(world.request));
    const double sunlit =
        view.row.front().cause_w_sr[static_cast<std::size_t>(Cause::kSunReflected)].value;
    worst.require((sunlit > 0) == above,
                  [&] { return absl::StrCat("sun ", above ? "above" : "behind", " the ridge"); });
  }
  return worst.finding();
}

// A target that cannot be seen is refused with a message.
absl::StatusOr<Finding> unseen_is_refused(Effort) {
  Worst worst(0);
  const auto message_of = [](const Height& height, double elevation_deg,
                             double range_m) -> absl::StatusOr<std::string> {
    ASSIGN_OR_RETURN(const World world, world_on(height, 3000, 10, elevation_deg, range_m, 290));
    return std::string(world.simulator->simulate(world.request).status().message());
  };
  ASSIGN_OR_RETURN(const std::string below,
                   message_of([](double x, double y) { return 0.1 * std::hypot(x, y); }, 3, 900));
  worst.require(below.find("below the land") != std::string::npos, [&] { return below; });
  ASSIGN_OR_RETURN(const std::string hidden, message_of(
                                                 [](double x, double y) {
                                                   const double r = std::hypot(x, y);
                                                   return r > 100 && r < 200 ? 60.0 : 0.0;
                                                 },
                                                 5, 900));
  worst.require(hidden.find("hides all of it") != std::string::npos, [&] { return hidden; });
  return worst.finding();
}

}  // namespace

std::vector<HardCase> land_cases() {
  return {
      {"land", "horizon",
       "a sphere of cells from 2 m to 30 km up: dip of the horizon, and places before it across "
       "the ray, as angles [rad]",
       "chords of cells of a 2000th of the horizon's distance", horizon_of_a_sphere},
      {"land", "smallest_maps",
       "20000 rays on a map of one cell and on a cliff of one cell: distance of the hit [m]",
       "double precision", smallest_maps},
      {"land", "one_temperature",
       "black box on black land: in a valley, on a summit, from 30 km up, at the map's edge, on "
       "one cell, before a cliff: contrast over a blackbody's intensity, and the background "
       "against it",
       "weights of paths are sums of floats", nothing_stands_out},
      {"land", "ridge",
       "the sun 0.5 deg above and 1.2 deg below the line over a ridge: sunlight where there is "
       "none, or none where there is",
       "the target is 0.4 deg high at the ridge's distance", sun_at_a_ridge},
      {"land", "refused",
       "a sensor below the land, a target behind a wall: another message than the reason",
       "a silent zero is a defect", unseen_is_refused},
  };
}

}  // namespace irsig
