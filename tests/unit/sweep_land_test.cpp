// Rationale: the core takes land as a value, and each number in it comes from another table of the
// sweep. Expected: materials by their numbers in the scene, heights and fractions of the samples in
// the files, temperatures by condition. Source: generate_terrain, arithmetic here.
#include "runner/sweep_land.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/land/generate_terrain.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "runner/job_runner.h"
#include "runner/spec_to_request.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kOnLand = R"(
time = ["12:00Z"]
[model]
generate = "box"
triangles = 64
[place]
latitude_deg = 48
longitude_deg = 11
heading_deg = 35
height_m = 7
[[part]]
name = "box"
material = "generic_grey_paint"
temperature_k = 300
[[season]]
name = "summer"
date = 2025-06-21
[[season]]
name = "winter"
date = 2025-12-21
land_temperature_k = { asphalt = 270 }
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [{ azimuth_deg = 0, elevation_deg = 20 }]
[surroundings]
kind = "ground"
ground_temperature_k = 290
ground_emissivity = 0.95
[air]
model = "atmosphere"
aerosol = "none"
[transport]
sun = false
[land]
heights = "heights.asc"
geoid_m = 40
[[land.material]]
material = "grass"
temperature_k = 288
[[land.material]]
material = "asphalt"
fraction_file = "asphalt.asc"
temperature_k = 310
)";

struct OnLand {
  schema::ResolvedSweep sweep;
  Assets assets;
};
absl::StatusOr<OnLand> on_land() {
  auto file = parse_sweep(kOnLand, "s.toml");
  if (!file.ok()) return file.status();
  const absl::Status read =
      read_land_files(*file, [](const std::string& name) -> absl::StatusOr<std::string> {
        const auto layer = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20},
                                            name.substr(0, name.find('.')));
        if (!layer.ok()) return layer.status();
        return write_asc(*layer);
      });
  if (!read.ok()) return read;
  auto sweep = resolve_sweep(*file, "");
  if (!sweep.ok()) return sweep.status();
  OnLand out{*std::move(sweep), {}};
  for (const auto& [key, bytes] : land_bytes(*file))
    out.assets[sha256_hex(bytes)] = std::string(bytes);
  return out;
}

TEST(SweepLand, RequestsCarryTheLandOfTheirSweep) {
  const auto on = on_land();
  ASSERT_TRUE(on.ok()) << on.status();
  const auto scene = scene_from_sweep(on->sweep, on->assets, {});
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_NE(scene->land, nullptr);
  const LandScene& land = *scene->land;
  ASSERT_EQ(scene->material.size(), 3U);
  ASSERT_EQ(scene->land_material.size(), 2U);
  EXPECT_EQ(scene->land_material[0].name, "grass");
  EXPECT_EQ(scene->land_material[1].name, "asphalt");
  EXPECT_EQ(land.heading_deg, 35);

  const auto heights = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20}, "heights");
  const auto asphalt = generate_terrain({.seed = 1, .width_m = 2000, .spacing_m = 20}, "asphalt");
  ASSERT_TRUE(heights.ok() && asphalt.ok());
  // The middle sample, above the geoid, from the ellipsoid to the place's own height.
  EXPECT_NEAR(land.surface_m, heights->height_m[50 * 101 + 50] + 40.0 - 7.0, 0.01);
  std::vector<float> fraction(2);
  double road = 0;
  for (std::uint32_t row = 0; row < 101; ++row)
    for (std::uint32_t column = 0; column < 101; ++column) {
      land.cover.at(-1000.0 + 20 * column, 1000.0 - 20 * row, fraction);
      const float expected = asphalt->height_m[row * 101 + column];
      ASSERT_NEAR(fraction[1], expected, 0.5 / 255 + 1e-6) << row << " " << column;
      road += expected;
    }
  EXPECT_GT(road, 1);
  EXPECT_GT(bytes_of(&land), 4U * 100 * 100 + 2U * 101 * 101);

  schema::ViewJob job;
  job.add_condition_index(0);
  job.add_band_index(0);
  const auto simulator = Simulator::create(*scene);
  ASSERT_TRUE(simulator.ok()) << simulator.status();
  const auto environment = environment_from_sweep(on->sweep, (*simulator)->band_grids());
  ASSERT_TRUE(environment.ok()) << environment.status();
  const auto request =
      request_from_job(on->sweep, job, *environment, scene->temperatures, scene->land, {});
  ASSERT_TRUE(request.ok()) << request.status();
  EXPECT_EQ(request->land, scene->land);
  EXPECT_THAT(request->condition[0].land_temperature_k, ElementsAre(288, 310));
  EXPECT_THAT(request->condition[1].land_temperature_k, ElementsAre(288, 270));
}

TEST(SweepLand, TheMapIsPartOfARunnersMemory) {
  auto on = on_land();
  ASSERT_TRUE(on.ok()) << on.status();
  const auto with = JobRunner::create(on->sweep, on->assets, {}, std::nullopt);
  ASSERT_TRUE(with.ok()) << with.status();
  ASSERT_EQ((*with)->warnings().size(), 1U);
  EXPECT_THAT((*with)->warnings()[0].text,
              HasSubstr("place.height_m = 7.0, but the map's height at the target is"));
  on->assets.clear();
  EXPECT_THAT(
      std::string(JobRunner::create(on->sweep, on->assets, {}, std::nullopt).status().message()),
      HasSubstr("land.heights: heights.asc:1:1: "));
}

}  // namespace
}  // namespace irsig
