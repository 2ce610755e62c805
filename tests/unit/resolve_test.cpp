// Meaning: what resolve_sweep writes out, and every error that it finds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "core/geo/sun.h"
#include "core/spectral/solar.h"
#include "jobs/keys/expand.h"
#include "jobs/resolve_sweep.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kTarget = R"(
[model]
generate = "sphere"
triangles = 100
[[part]]
name = "sphere"
material = "hull"
temperature_k = 300
)";
constexpr const char* kBand = R"(
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
)";
constexpr const char* kSeason = R"(
[[season]]
name = "any"
date = 2025-06-21
)";
constexpr const char* kView = R"(
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = -90, elevation_deg = 0 } ]
)";
constexpr const char* kNothingAround = R"(
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
)";
constexpr const char* kVacuumNoSun = R"(
[air]
model = "vacuum"
[transport]
sun = false
)";
constexpr const char* kNoon = "time = [\"12:00Z\"]\n";

schema::ResolvedSweep resolved(const std::string& text) {
  const absl::StatusOr<schema::ResolvedSweep> sweep = resolved_text(text);
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return sweep.ok() ? *sweep : schema::ResolvedSweep{};
}

std::string minimal(const std::string& first = kNoon, const std::string& season = kSeason,
                    const std::string& view = kView) {
  return first + kTarget + kBand + season + view + kNothingAround + kVacuumNoSun;
}

TEST(ResolveSweep, WritesEveryDefaultOut) {
  const schema::ResolvedSweep resolved_sweep = resolved(minimal());
  const schema::Sweep& sweep = resolved_sweep.sweep();
  EXPECT_EQ(sweep.name(), "s");  // s.toml
  EXPECT_EQ(sweep.seed(), 1U);
  EXPECT_EQ(sweep.model().radius_m(), 1.0);
  EXPECT_THAT(sweep.part(0).match(), ElementsAre("sphere"));
  EXPECT_TRUE(sweep.part(0).has_hot());
  EXPECT_FALSE(sweep.part(0).hot());
  EXPECT_TRUE(sweep.part(0).has_two_sided());
  EXPECT_FALSE(sweep.part(0).two_sided());
  EXPECT_EQ(sweep.transport().max_reflections(), 64U);
  EXPECT_EQ(sweep.transport().job_size_vertices(), 2e9);
  EXPECT_EQ(sweep.accuracy().relative_error(), 0.01);
  EXPECT_EQ(sweep.accuracy().replicates(), 32U);
  EXPECT_EQ(sweep.accuracy().max_samples_per_replicate(), 4194304U);
  EXPECT_EQ(sweep.output().thumbnail_px(), 128U);
  EXPECT_EQ(resolved_sweep.model_sha256(), "");
}

TEST(ResolveSweep, DeclaresBuiltInMaterialsThatPartsName) {
  const schema::ResolvedSweep sweep = resolved(minimal());
  ASSERT_EQ(sweep.sweep().material_size(), 1);
  EXPECT_EQ(sweep.sweep().material(0).name(), "hull");
  EXPECT_EQ(sweep.sweep().material(0).kind(), "hull");
}

TEST(ResolveSweep, AGivenAccuracyReplacesTheDefault) {
  const schema::ResolvedSweep sweep =
      resolved(minimal() + "[accuracy]\nsamples_per_replicate = 8388608\n");
  EXPECT_FALSE(sweep.sweep().accuracy().has_relative_error());
  EXPECT_EQ(sweep.sweep().accuracy().max_samples_per_replicate(), 8388608U);
}

TEST(ResolveSweep, NormalizesAzimuths) {
  EXPECT_EQ(resolved(minimal()).viewpoint(0).aspect_azimuth_deg(), 270.0);
  const schema::ResolvedSweep full_turn = resolved(minimal(
      kNoon, kSeason,
      "[viewpoints]\nkind = \"grid\"\nrange_m = 5\nazimuth_deg = [360]\nelevation_deg = [0]\n"));
  EXPECT_EQ(full_turn.viewpoint(0).aspect_azimuth_deg(), 0.0);
}

TEST(ResolveSweep, AnAspectMayHaveItsOwnRange) {
  const schema::ResolvedSweep sweep = resolved(minimal(kNoon, kSeason, R"([viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 0, range_m = 50 }, { azimuth_deg = 0, elevation_deg = 0 } ]
)"));
  ASSERT_EQ(sweep.viewpoint_size(), 2);
  EXPECT_EQ(sweep.viewpoint(0).range_m(), 50.0);
  EXPECT_EQ(sweep.viewpoint(1).range_m(), 1000.0);
}

TEST(ResolveSweep, ConditionsAreSeasonMajorInUtc) {
  const schema::ResolvedSweep sweep =
      resolved(minimal("time = [\"10:30+09:00\", \"00:00:01.5Z\"]\n", R"(
[[season]]
name = "winter"
date = 2025-12-21
part_temperature_k = { sphere = 280 }
[[season]]
name = "new year"
date = 2025-01-01
)"));
  ASSERT_EQ(sweep.condition_size(), 4);
  const auto row = [&](int i) {
    const schema::Condition& c = sweep.condition(i);
    return std::to_string(c.season_index()) + std::to_string(c.time_index()) + " " + c.season() +
           " " + c.time_utc();
  };
  EXPECT_EQ(row(0), "00 winter 2025-12-21T01:30:00Z");
  EXPECT_EQ(row(1), "01 winter 2025-12-21T00:00:01.5Z");
  EXPECT_EQ(row(2), "10 new year 2025-01-01T01:30:00Z");
  EXPECT_EQ(row(3), "11 new year 2025-01-01T00:00:01.5Z");
  EXPECT_THAT(sweep.condition(1).part_temperature_k(), ElementsAre(280.0));
  EXPECT_THAT(sweep.condition(2).part_temperature_k(), ElementsAre(300.0));
}

TEST(ResolveSweep, AnOffsetCanMoveTheDate) {
  const schema::ResolvedSweep sweep = resolved(
      minimal("time = [\"08:00+09:00\"]\n", "[[season]]\nname = \"a\"\ndate = \"2025-01-01\"\n"));
  EXPECT_EQ(sweep.condition(0).time_utc(), "2024-12-31T23:00:00Z");
}

TEST(ResolveSweep, SeasonsOverrideSurroundingsKeyByKey) {
  const std::string text = std::string(kNoon) + kTarget + kBand + kView + kVacuumNoSun + R"(
[surroundings]
kind = "sea"
sky_temperature_k = 260
sea_temperature_k = 280
sea_emissivity = 0.96
[[season]]
name = "a"
date = 2025-06-21
[[season]]
name = "b"
date = 2025-06-22
surroundings = { sea_temperature_k = 290, sky_radiance_w_m2_sr_um = 2 }
)";
  const schema::ResolvedSweep sweep = resolved(text);
  const schema::Surroundings& a = sweep.condition(0).surroundings();
  EXPECT_EQ(a.sky_temperature_k(), 260);
  EXPECT_EQ(a.sea_temperature_k(), 280);
  const schema::Surroundings& b = sweep.condition(1).surroundings();
  EXPECT_EQ(b.kind(), "sea");
  EXPECT_FALSE(b.has_sky_temperature_k());
  EXPECT_EQ(b.sky_radiance_w_m2_sr_um(), 2);
  EXPECT_EQ(b.sea_temperature_k(), 290);
  EXPECT_EQ(b.sea_emissivity(), 0.96);
}

// Hot: 30 K above the coldest part in any one condition, not above the coldest of another season.
TEST(ResolveSweep, MarksHotPartsByTheirContrastWithinACondition) {
  const auto hot_parts = [](double winter_b, double summer_a, double summer_b,
                            const std::string& more) {
    const schema::ResolvedSweep sweep = resolved(
        std::string(kNoon) + kBand + kView + kNothingAround + kVacuumNoSun +
        "[model]\ngenerate = \"box\"\ntriangles = 12\n[[part]]\nname = \"a\"\nmaterial = "
        "\"hull\"\n[[part]]\nname = \"b\"\nmaterial = \"hull\"\n" +
        more + "[[season]]\nname = \"w\"\ndate = 2025-12-21\npart_temperature_k = { a = 280, b = " +
        std::to_string(winter_b) +
        " }\n[[season]]\nname = \"s\"\ndate = 2025-06-21\npart_temperature_k = { a = " +
        std::to_string(summer_a) + ", b = " + std::to_string(summer_b) + " }\n");
    return std::to_string(sweep.sweep().part(0).hot()) +
           std::to_string(sweep.sweep().part(1).hot());
  };
  EXPECT_EQ(hot_parts(290, 320, 320, ""), "00");  // hot summer, no contrast
  EXPECT_EQ(hot_parts(309.9, 320, 349.9, ""), "00");
  EXPECT_EQ(hot_parts(310, 320, 320, ""), "01");  // in winter only
  EXPECT_EQ(hot_parts(290, 330, 300, ""), "10");  // in summer only
  EXPECT_EQ(hot_parts(310, 320, 320, "hot = false\n"), "00");
  EXPECT_EQ(hot_parts(290, 320, 320, "hot = true\n"), "01");
}

constexpr const char* kSunny = R"(
[air]
model = "vacuum"
[transport]
sun = true
[place]
latitude_deg = 25
longitude_deg = 130
heading_deg = 0
)";

TEST(ResolveSweep, TheSunIsAsStated) {
  const schema::ResolvedSweep sweep =
      resolved(std::string(kNoon) + kTarget + kBand + kSeason + "sun_irradiance_w_m2 = 700\n" +
               kView + kNothingAround + kSunny);
  EXPECT_EQ(sweep.condition(0).sun_irradiance_w_m2(), 700);
  EXPECT_FALSE(sweep.condition(0).sun_irradiance_from_distance());
  EXPECT_EQ(sweep.sweep().place().height_m(), 0);
  EXPECT_TRUE(sweep.sweep().place().has_height_m());
}

// Rationale: an irradiance that is not stated is E490's at the sun's distance.
// Expected: kSolarConstantWM2 / r^2; at the solstice of June the sun is near its farthest: r
// = 1.0163. Source: ASTM E490-00a total; r from core/geo/sun.h, checked there against ERFA and SPA.
TEST(ResolveSweep, AnAbsentSunIsE490AtItsDistance) {
  const schema::ResolvedSweep sweep =
      resolved(std::string(kNoon) + kTarget + kBand + kSeason + kView + kNothingAround + kSunny);
  const auto sun = sun_position(*parse_rfc3339("2025-06-21T12:00:00Z"), 25, 130, 0);
  ASSERT_TRUE(sun.ok());
  EXPECT_DOUBLE_EQ(sweep.condition(0).sun_irradiance_w_m2(),
                   kSolarConstantWM2 / (sun->distance_au * sun->distance_au));
  EXPECT_NEAR(sweep.condition(0).sun_irradiance_w_m2(), 1366.1 / (1.0163 * 1.0163), 0.2);
  EXPECT_TRUE(sweep.condition(0).sun_irradiance_from_distance());
}

TEST(ResolveSweep, WithoutSunAStatedIrradianceIsNotUsed) {
  const schema::ResolvedSweep sweep = resolved(minimal(
      kNoon, std::string(kSeason) + "sun_irradiance_w_m2 = 700\nair_temperature_k = 280\n"));
  EXPECT_EQ(sweep.condition(0).sun_irradiance_w_m2(), 0);
  EXPECT_EQ(sweep.condition(0).air_temperature_k(), 0);
}

TEST(ResolveSweep, AHeightAloneIsAPlace) {
  const std::string rest =
      absl::StrCat(kTarget, kBand, kSeason, kView, kNothingAround, kVacuumNoSun);
  const schema::ResolvedSweep high =
      resolved(absl::StrCat(kNoon, "[place]\nabove_surface_m = 3000\n", rest));
  EXPECT_EQ(high.sweep().place().above_surface_m(), 3000);
  EXPECT_FALSE(high.sweep().place().has_latitude_deg());
  EXPECT_THAT(std::string(resolved_text(absl::StrCat(kNoon, "[place]\nabove_surface_m = 3000\n",
                                                     "longitude_deg = 3\n", rest))
                              .status()
                              .message()),
              HasSubstr("place.latitude_deg is missing"));
}

TEST(ResolveSweep, HeightsOfConditionsAreTheirWeathers) {
  const auto text = [](const std::string& place, const std::string& seasons) {
    return absl::StrCat(kNoon, place, kTarget, kBand, seasons, R"(
[viewpoints]
kind = "list"
range_m = 500
aspect = [ { azimuth_deg = 0, elevation_deg = -30 } ]
[surroundings]
kind = "ground"
ground_temperature_k = 290
ground_emissivity = 0.9
[air]
model = "atmosphere"
profile = "midlatitude_summer"
aerosol = "none"
[transport]
sun = false
)");
  };
  const std::string low = "[[season]]\nname = \"low\"\ndate = 2025-06-21\n";
  const std::string high =
      "[[season]]\nname = \"high\"\ndate = 2025-06-21\n"
      "above_surface_m = 4000\n";
  const schema::ResolvedSweep both = resolved(text("[place]\nabove_surface_m = 300\n", low + high));
  EXPECT_EQ(both.condition(0).weather().above_surface_m(), 300);
  EXPECT_EQ(both.condition(1).weather().above_surface_m(), 4000);
  // Without the key nothing is written, so that keys of jobs stay what they were.
  const std::string ground = low + "[vary]\nabove_surface_m = [ 500, 600 ]\n";
  EXPECT_EQ(resolved(text("", ground)).condition(1).weather().above_surface_m(), 600);
  const auto error = [&](const std::string& place, const std::string& seasons) {
    return std::string(resolved_text(text(place, seasons)).status().message());
  };
  EXPECT_THAT(error("", low + high), HasSubstr("lies under the ground"));
  EXPECT_THAT(error("[place]\nabove_surface_m = 200\n", low), HasSubstr("lies under the ground"));
  std::string level = text("", low + high);
  level.replace(level.find("-30"), 3, "30");
  EXPECT_THAT(std::string(resolved_text(level).status().message()),
              HasSubstr("season[0].above_surface_m is missing, but other conditions have it"));
}

TEST(ResolveSweep, HashesTheModelFile) {
  const absl::StatusOr<SweepFile> file = parse_sweep(
      std::string(kNoon) + kBand + kSeason + kView + kNothingAround + kVacuumNoSun +
          "[model]\nfile = \"ships/A.OBJ\"\nunit_m = 1\nforward_axis = \"+x\"\nup_axis = \"+z\"\n"
          "[[part]]\nname = \"a\"\nmaterial = \"hull\"\ntemperature_k = 300\n",
      "s.toml");
  ASSERT_TRUE(file.ok()) << file.status();
  const auto sweep = resolve_sweep(*file, "abc");
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_EQ(sweep->model_sha256(), sha256_hex("abc"));
  EXPECT_EQ(sweep->model_file_name(), "A.OBJ");
  EXPECT_EQ(sweep->sweep().model().reference(), "origin");
}

// Every file of bad_sweeps/ is refused with exactly the lines that stand beside it.
TEST(ResolveSweep, RefusesTheBadSweeps) {
  const std::filesystem::path folder =
      std::filesystem::path(IRSIG_SOURCE_DIR) / "tests/unit/bad_sweeps";
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  }
  EXPECT_GT(files.size(), 40U);
  for (const std::filesystem::path& path : files) {
    const std::string name = path.filename().string();
    const absl::StatusOr<SweepFile> file = parse_sweep(text_of(path), name);
    const absl::Status status = file.ok() ? resolve_sweep(*file, "").status() : file.status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_EQ(std::string(status.message()) + "\n",
              text_of(std::filesystem::path(path).replace_extension(".expected")))
        << name;
  }
}

}  // namespace
}  // namespace irsig
