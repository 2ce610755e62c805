// Rationale: the core takes land as a value, and each number in it comes from another table of the
// sweep. Expected: materials by their numbers in the scene, heights and fractions of the samples in
// the files, temperatures by condition. Source: generate_terrain, arithmetic here.
#include "runner/sweep_land.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/land/generate_terrain.h"
#include "core/land/map_edge.h"
#include "core/land/objects/land_objects.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_land.h"
#include "jobs/resolve_sweep.h"
#include "runner/job_runner.h"
#include "runner/spec_to_request.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::AllOf;
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
absl::StatusOr<OnLand> sweep_of(const std::string& text,
                                const std::map<std::string, std::string>& files) {
  auto file = parse_sweep(text, "s.toml");
  if (!file.ok()) return file.status();
  const absl::Status read =
      read_land_files(*file, [&](const std::string& name) -> absl::StatusOr<std::string> {
        if (const auto at = files.find(name); at != files.end()) return at->second;
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

absl::StatusOr<OnLand> on_land(const std::string& more = "",
                               const std::map<std::string, std::string>& files = {}) {
  return sweep_of(kOnLand + more, files);
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

// A plain of 1.6 km inside a rim of other heights, with a sensor at that elevation.
absl::StatusOr<OnLand> within_rim(double rim_m, double elevation_deg, const std::string& key = "",
                                  double wall_m = 0) {
  std::string heights =
      "ncols 101\nnrows 101\nxllcenter -1000\nyllcenter -1000\ncellsize 20\nnodata_value -9999\n";
  for (int row = 0; row <= 100; ++row)
    for (int column = 0; column <= 100; ++column) {
      const int from_middle = 20 * std::max(std::abs(row - 50), std::abs(column - 50));
      const double height_m = from_middle > 800 ? rim_m : from_middle == 600 ? wall_m : 0;
      absl::StrAppend(&heights, height_m, column == 100 ? "\n" : " ");
    }
  std::string text = kOnLand;
  const auto replace = [&](const std::string& old, const std::string& by) {
    text.replace(text.find(old), old.size(), by);
  };
  replace("elevation_deg = 20", absl::StrCat("elevation_deg = ", elevation_deg));
  replace("range_m = 1000", "range_m = 500");
  replace("geoid_m = 40", "geoid_m = 7\n" + key);
  return sweep_of(text, {{"heights.asc", heights}});
}

std::string refusal(const absl::StatusOr<OnLand>& on) {
  if (!on.ok()) return std::string(on.status().message());
  return std::string(JobRunner::create(on->sweep, on->assets, {}, std::nullopt).status().message());
}

TEST(SweepLandEdge, ACliffInSightIsRefusedWithItsRemedy) {
  for (const double rim_m : {-2.0, 2.0})
    EXPECT_THAT(refusal(within_rim(rim_m, 0.5)),
                AllOf(HasSubstr("land.heights: 1 of 1 viewpoints see a cliff at the edge of the "
                                "map: from azimuth 0, elevation 0.5 deg, range 500 m, the land "
                                "ends 2.0"),
                      HasSubstr(rim_m < 0 ? " m below the ground" : " m above the ground"),
                      HasSubstr("use a map that reaches farther, or state land.edge_fade_m")));
  EXPECT_EQ(refusal(within_rim(0.9, 0.5)), "");
}

TEST(SweepLandEdge, ACliffOutOfSightIsHarmless) {
  EXPECT_EQ(refusal(within_rim(25, 20)), "");
  EXPECT_EQ(refusal(within_rim(-25, 0.5, "", 30)), "");
  EXPECT_THAT(refusal(within_rim(-25, 0.5, "", 0.5)), HasSubstr("see a cliff"));
}

TEST(SweepLandEdge, AFadeLeavesNoCliff) {
  const auto on = within_rim(-25, 0.5, "edge_fade_m = 150");
  EXPECT_EQ(refusal(on), "");
  const auto land = land_from_sweep(on->sweep, on->assets);
  ASSERT_TRUE(land.ok()) << land.status();
  EXPECT_TRUE((*land)->edge_step.empty());
  EXPECT_NEAR(*(*land)->field->z_m(1000, 300), level_z_m({48, 11, 7}, 0, 1000, 300), 5e-3);
  EXPECT_NEAR(*(*land)->field->z_m(840, 300), level_z_m({48, 11, 7}, 0, 840, 300) - 25, 5e-3);
  EXPECT_THAT(refusal(within_rim(-25, 0.5, "edge_fade_m = 990")),
              HasSubstr("land.edge_fade_m: a fade over 990 m reaches the target, whose place lies "
                        "1000 m from the edge of the map; expected at most 980 m"));
  EXPECT_THAT(refusal(within_rim(-25, 0.5, "edge_fade_m = 0")), HasSubstr("see a cliff"));
  EXPECT_THAT(refusal(within_rim(-25, 0.5, "edge_fade_m = -5")),
              HasSubstr("land.edge_fade_m = -5, expected a number from 0 to 400000"));
}

// A camera that shows more than the window of the clutter.
TEST(SweepLandEdge, AnImageThatShowsACliffIsRefused) {
  auto on = within_rim(25, 20);
  ASSERT_TRUE(on.ok()) << on.status();
  schema::Image& image = *on->sweep.mutable_sweep()->mutable_image();
  image.set_kind("camera");
  image.add_pixels(64);
  image.add_pixels(32);
  for (const double wide_deg : {4.0, 60.0}) {
    image.set_field_of_view_deg(wide_deg);
    const auto scene = scene_from_sweep(on->sweep, on->assets, {});
    ASSERT_TRUE(scene.ok()) << scene.status();
    const auto simulator = Simulator::create(*scene);
    ASSERT_TRUE(simulator.ok()) << simulator.status();
    EXPECT_EQ(check_land_edge(on->sweep, (*simulator)->target(), nullptr, scene->land.get()).ok(),
              wide_deg < 10)
        << wide_deg;
  }
}

// A tent: two groups, open at the ends.
constexpr const char* kTent =
    "v -2 -1 0\nv 2 -1 0\nv 2 1 0\nv -2 1 0\nv -2 0 3\nv 2 0 3\n"
    "o sides\nf 1 2 6 5\nf 3 4 5 6\no floor\nf 4 3 2 1\n";
constexpr const char* kCube =
    "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\nv 1 1 2\nv -1 1 2\n"
    "o cube\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
constexpr const char* kCanvas = R"([[land.material]]
material = "leaves"
objects_only = true
temperature_k = 290
)";

std::string object_of(const std::string& rest, const std::string& model = "tent.obj") {
  return "[[land.object]]\nmodel = \"" + model +
         "\"\nunit_m = 1\nforward_axis = \"+x\"\nup_axis = \"+z\"\n" + rest;
}

TEST(SweepLand, ObjectsStandOnTheLandOfTheirSweep) {
  const auto on = on_land(
      kCanvas +
          object_of("material = \"leaves\"\npart = [{ match = \"floor\", material = \"asphalt\" "
                    "}]\nplaces_file = \"tents.csv\"\nscale = 2\nsink_m = 0.5\n") +
          object_of("material = \"leaves\"\ncount = 40\nwithin = \"grass\"\ninner_radius_m = "
                    "200\nradius_m = 900\n",
                    "cube.obj"),
      {{"tent.obj", kTent}, {"cube.obj", kCube}, {"tents.csv", "east_m,north_m\n300,-400\n"}});
  ASSERT_TRUE(on.ok()) << on.status();
  const auto scene = scene_from_sweep(on->sweep, on->assets, {});
  ASSERT_TRUE(scene.ok()) << scene.status();
  const LandScene& land = *scene->land;
  ASSERT_NE(land.objects, nullptr);
  EXPECT_EQ(land.cover.materials(), 3U);
  ASSERT_EQ(land.objects->count(), 41U);
  const double ground_m = land.field->z_m(300, -400).value();
  // The lowest land below the base is a little lower than its middle; a tent is 6 m high.
  EXPECT_NEAR(land.objects->middle_m(0).z, ground_m - 0.5 + 3, 1.5);
  EXPECT_LT(land.objects->middle_m(0).z, ground_m - 0.5 + 3);
  const auto roof = land.objects->first_hit({300.5, -399, ground_m + 50}, {0, 0, -1}, 1e9);
  ASSERT_TRUE(roof.has_value());
  EXPECT_EQ(roof->material, 2U);
  const auto floor = land.objects->first_hit({300.5, -399, ground_m - 50}, {0, 0, 1}, 1e9);
  ASSERT_TRUE(floor.has_value());
  EXPECT_EQ(floor->material, 1U);
  std::vector<float> fraction(3);
  for (std::size_t i = 1; i < 41; ++i) {
    const Vec<Enu> at = land.objects->middle_m(i);
    land.cover.at(at.x, at.y, fraction);
    EXPECT_GT(fraction[0], 0);
    EXPECT_GT(std::hypot(at.x, at.y), 199);
  }
  EXPECT_GT(bytes_of(&land),
            land.field->memory_bytes() + land.cover.memory_bytes() + 41 * sizeof(double));
}

TEST(SweepLand, ObjectsThatCannotStandAreRefused) {
  const auto refused = [](const std::string& object, const std::string& places = "") {
    auto on = on_land(kCanvas + object, {{"tent.obj", kTent},
                                         {"cube.obj", kCube},
                                         {"places.csv", places},
                                         {"wrong.obj", "v 1 2 3\nf 1 2 3\n"}});
    if (!on.ok()) return std::string(on.status().message());
    return std::string(
        JobRunner::create(on->sweep, on->assets, {}, std::nullopt).status().message());
  };
  const std::string leaves = "material = \"leaves\"\n",
                    there = "place = [{ east_m = 100, north_m = 0 }]\n";
  EXPECT_THAT(refused(object_of("part = [{ match = \"sides\", material = \"leaves\" }]\n" + there)),
              HasSubstr("land.object[0]: no part matches group \"floor\" of the model; add "
                        "[[land.object.part]], or state material for all other groups"));
  EXPECT_THAT(
      refused(object_of(leaves + "part = [{ match = \"roof\", material = \"leaves\" }]\n" + there)),
      HasSubstr("land.object[0].part[0].match: \"roof\" matches no group of the model that an "
                "earlier part leaves; its groups are: \"sides\", \"floor\""));
  EXPECT_THAT(refused(object_of(leaves + there, "wrong.obj")),
              HasSubstr("land.object[0].model: wrong.obj:2:"));
  EXPECT_THAT(refused(object_of(leaves + "place = [{ east_m = 100, north_m = 0 }, { east_m = 5000, "
                                         "north_m = 0 }]\n")),
              HasSubstr("land.object[0].place[1]: the object at east_m = 5000, north_m = 0 stands "
                        "beyond the map of heights"));
  EXPECT_THAT(refused(object_of(leaves + "places_file = \"places.csv\"\n"),
                      "east_m,north_m\n1,2\n30,4000\n"),
              HasSubstr("land.object[0].places_file: places.csv:3:1: the object at"));
  EXPECT_THAT(
      refused(object_of(leaves + "places_file = \"places.csv\"\n"), "east_m,north_m\n1,two\n"),
      HasSubstr(
          "land.object[0].places_file: places.csv:2:3: north_m = \"two\", expected a number"));
  EXPECT_THAT(
      refused(object_of(leaves + "place = [{ east_m = 0, north_m = 0, scale = 5 }]\n", "cube.obj")),
      HasSubstr("land.object[0].place[0]: the object covers a part of the target; move it "
                "away from the target"));
  // The sensor is 1 km to the bow's side, 342 m above the target.
  EXPECT_THAT(refused(object_of(leaves + "place = [{ east_m = 539, north_m = 770, scale = 200 }]\n",
                                "cube.obj")),
              HasSubstr("lies inside an object on the land (land.object[0].place[0])"));
  EXPECT_THAT(refused(object_of(leaves + "count = 9\nwithin = \"asphalt\"\ninner_radius_m = "
                                         "5000\nradius_m = 6000\n")),
              HasSubstr("land.object[0].count: only 0 of 9 places were found in 9000 tries"));
}

}  // namespace
}  // namespace irsig
