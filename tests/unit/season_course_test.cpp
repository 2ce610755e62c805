// Weather that goes on, in sweep files: what seasons take from it, the runs of computed
// temperatures, and what is refused. Files are the shipped days (jobs/examples/weather).
#include "jobs/season_course.h"

#include <gmock/gmock.h>

#include <array>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "jobs/resolve_sweep.h"
#include "messages/environment/weather_from_message.h"
#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string shipped() {
  return irsig::text_of(std::filesystem::path(IRSIG_SOURCE_DIR) /
                        "jobs/examples/weather/san_francisco.epw");
}

// A sweep that nothing is wrong with; tests replace one piece.
struct CoursePieces {
  std::string time = "time = [\"12:00-08:00\", \"18:30-08:00\"]\n";
  std::string heat = "[heat]\n";
  std::string place = "[place]\nlatitude_deg = 37.6\nlongitude_deg = -122.4\nheading_deg = 90\n";
  std::string parts = "[[part]]\nname = \"sphere\"\nmaterial = \"paint\"\nbuild_up = \"wall\"\n";
  std::string season =
      "[[season]]\nname = \"summer\"\ndate = 2025-07-21\nweather_file = \"sf.epw\"\n";
  std::string more;
  std::string surroundings = "kind = \"sea\"\nsea_temperature_k = 286\n";
  std::string air = "model = \"atmosphere\"\naerosol = \"maritime\"\nvisibility_m = 23000\n";
};

constexpr const char* kWall =
    "[[build_up]]\nname = \"wall\"\nlayer = [{ solid = \"steel\", thickness_m = 0.01 }]\n"
    "inside = \"adiabatic\"\n";

std::string course_text_of(const CoursePieces& p) {
  return p.time + "[model]\ngenerate = \"sphere\"\ntriangles = 100\n" + p.heat + p.place + p.parts +
         p.season + p.more + (p.parts.find("build_up") == std::string::npos ? "" : kWall) +
         "[[material]]\nname = \"paint\"\nkind = \"lambert\"\nemissivity = 0.9\nsolar_absorptance "
         "= 0.6\n[[band]]\nname = \"b\"\nlambda_min_um = 8\nlambda_max_um = 12\nstep_um = 0.1\n"
         "[viewpoints]\nkind = \"ring\"\ncount = 1\nrange_m = 5000\nelevation_deg = [10]\n"
         "[surroundings]\n" +
         p.surroundings + "[air]\n" + p.air + "[transport]\nsun = true\n";
}

absl::StatusOr<schema::ResolvedSweep> resolve_course(const CoursePieces& pieces,
                                                     const std::string& content = shipped()) {
  absl::StatusOr<SweepFile> file = parse_sweep(course_text_of(pieces), "s.toml");
  if (!file.ok()) return file.status();
  const auto read = [&](const std::string&) -> absl::StatusOr<std::string> { return content; };
  if (const absl::Status status = read_weather_files(*file, read); !status.ok()) return status;
  return resolve_sweep(*file, "");
}

std::string course_error_of(const CoursePieces& pieces, const std::string& content = shipped()) {
  const auto sweep = resolve_course(pieces, content);
  return sweep.ok() ? "" : std::string(sweep.status().message());
}

const std::string kDay =
    "[[season]]\nname = \"summer\"\ndate = 2025-07-21\npressure_pa = 101300\nwind_speed_m_s = 4\n"
    "wind_from_deg = 290\nday = { air_temperature_min_k = 285, air_temperature_max_k = 293, "
    "dew_point_k = 283 }\n";
const std::string kConstant =
    "[[season]]\nname = \"summer\"\ndate = 2025-07-21\npressure_pa = 101300\nwind_speed_m_s = 4\n"
    "wind_from_deg = 290\nair_temperature_k = 290\nrelative_humidity_percent = 70\n";

// Expected: each time's own weather, as the file's lines 12 and between 18 and 19 have it.
TEST(SeasonCourse, EachTimeHasItsOwnWeather) {
  CoursePieces p;
  p.heat = "";
  p.parts = "[[part]]\nname = \"sphere\"\nmaterial = \"paint\"\ntemperature_k = 290\n";
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->heat(), IsEmpty());
  const schema::Weather& noon = sweep->condition(0).weather();
  EXPECT_TRUE(noon.surface_stated());
  EXPECT_DOUBLE_EQ(noon.air_temperature_k(), 17.1 + 273.15);
  EXPECT_EQ(noon.pressure_pa(), 101500);
  EXPECT_EQ(noon.wind_speed_m_s(), 7.5);
  EXPECT_NE(noon.air_temperature_k(), sweep->condition(1).weather().air_temperature_k());
  EXPECT_EQ(sweep->condition(1).air_temperature_k(),
            sweep->condition(1).weather().air_temperature_k());
  EXPECT_FALSE(sweep->condition(0).has_temperature_field());
  EXPECT_FALSE(sweep->sweep().season(0).has_weather_file());
}

TEST(SeasonCourse, ARunForAllTimesOfASeason) {
  const auto sweep = resolve_course({});
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  ASSERT_THAT(sweep->heat(), SizeIs(1));
  const schema::HeatRun& run = sweep->heat(0);
  EXPECT_EQ(run.season(), "summer");
  EXPECT_THAT(run.time_utc(), ElementsAre("2025-07-21T20:00:00Z", "2025-07-22T02:30:00Z"));
  EXPECT_TRUE(run.course().periodic());
  EXPECT_EQ(run.course().record_size(), 25);
  EXPECT_EQ(run.course().radiation_interval_s(), 3600);
  EXPECT_TRUE(run.course().record(12).has_direct_normal_w_m2());
  EXPECT_EQ(run.surroundings().solar_albedo(), 0.06);
  EXPECT_EQ(run.weather().aerosol(), "maritime");
  EXPECT_THAT(run.part_temperature_k(), ElementsAre(0));
  for (const schema::Condition& condition : sweep->condition()) {
    EXPECT_EQ(condition.temperature_field().heat(), 0);
    EXPECT_THAT(condition.temperature_field().part(), ElementsAre(0));
    EXPECT_EQ(condition.part_temperature_k(0), 0);
    EXPECT_THAT(condition.warning(), IsEmpty());
  }
  EXPECT_EQ(sweep->sweep().heat().history(), "periodic");
  EXPECT_EQ(sweep->sweep().heat().rays(), 256);
  EXPECT_EQ(sweep->sweep().place().speed_m_s(), 0);
}

// Rationale: an instant is one in whatever time zone it is written.
TEST(SeasonCourse, TimeZonesChangeNothing) {
  CoursePieces west, east;
  west.time = "time = [\"05:00-08:00\"]\n";
  east.time = "time = [\"22:00+09:00\"]\n";
  const auto a = resolve_course(west), b = resolve_course(east);
  ASSERT_TRUE(a.ok() && b.ok()) << a.status() << b.status();
  EXPECT_EQ(a->heat(0).SerializeAsString(), b->heat(0).SerializeAsString());
  EXPECT_EQ(a->condition(0).weather().SerializeAsString(),
            b->condition(0).weather().SerializeAsString());
}

TEST(SeasonCourse, HoursOfATableShareTheirRun) {
  CoursePieces p;
  p.time = "";
  p.more =
      "[[condition]]\ntime = \"18:00-08:00\"\n[[condition]]\ntime = \"12:00-08:00\"\n"
      "[[condition]]\nname = \"hazy\"\ntime = \"12:00-08:00\"\nvisibility_m = 5000\n";
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  ASSERT_THAT(sweep->heat(), SizeIs(2));
  EXPECT_THAT(sweep->heat(0).time_utc(),
              ElementsAre("2025-07-21T20:00:00Z", "2025-07-22T02:00:00Z"));
  EXPECT_EQ(sweep->condition(1).temperature_field().heat(), 0);
  EXPECT_EQ(sweep->condition(2).temperature_field().heat(), 1);
  EXPECT_EQ(sweep->heat(1).weather().visibility_m(), 5000);
}

TEST(SeasonCourse, DaysOfHistoryBeginBefore) {
  CoursePieces p;
  p.heat = "[heat]\nhistory = \"days\"\nhistory_days = 1.5\n";
  p.season = absl::StrReplaceAll(p.season, {{"07-21", "07-22"}});
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  const schema::WeatherCourse& course = sweep->heat(0).course();
  EXPECT_FALSE(course.periodic());
  EXPECT_EQ(format_rfc3339_utc(utc_time(course.record(0).unix_s())), "2025-07-21T08:00:00Z");
  EXPECT_EQ(format_rfc3339_utc(utc_time(course.record(course.record_size() - 1).unix_s())),
            "2025-07-23T03:00:00Z");
  p.heat = "[heat]\nhistory = \"days\"\n";  // three
  EXPECT_THAT(course_error_of(p), HasSubstr("no record of month 7, day 19, hour"));
  p.season = kDay;
  EXPECT_THAT(course_error_of(p),
              HasSubstr("heat.history = \"days\", but season[0] has no weather_file"));
}

TEST(SeasonCourse, AStatedDayAndAConstantOne) {
  CoursePieces p;
  p.season = kDay;
  const auto day = resolve_course(p);
  ASSERT_TRUE(day.ok()) << day.status();
  EXPECT_EQ(day->heat(0).course().record_size(), 73);
  EXPECT_EQ(day->heat(0).course().record(0).wind_from_deg(), 290);
  EXPECT_FALSE(day->heat(0).course().record(0).has_sky_w_m2());
  const double noon_k = day->condition(0).weather().air_temperature_k();
  EXPECT_GT(noon_k, 291);
  EXPECT_LT(noon_k, 293);
  EXPECT_GT(day->condition(1).weather().relative_humidity_percent(), 50);
  p.season = kConstant;
  const auto constant = resolve_course(p);
  ASSERT_TRUE(constant.ok()) << constant.status();
  EXPECT_EQ(constant->heat(0).course().record(30).air_temperature_k(), 290);
  EXPECT_EQ(constant->condition(1).weather().relative_humidity_percent(), 70);
  EXPECT_EQ(constant->condition(1).weather().air_temperature_k(), 290);
}

TEST(SeasonCourse, PartsThatAreStatedStayStated) {
  CoursePieces p;
  p.parts =
      "[[part]]\nname = \"sphere\"\nmaterial = \"paint\"\nbuild_up = \"wall\"\n"
      "[[part]]\nname = \"exhaust\"\nmaterial = \"paint\"\ntemperature_k = 500\n"
      "[[part]]\nname = \"deck\"\nmaterial = \"paint\"\nbuild_up = \"wall\"\n";
  p.season += "part_temperature_k = { deck = 300 }\n";
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->heat(0).part_temperature_k(), ElementsAre(0, 500, 300));
  EXPECT_THAT(sweep->condition(1).temperature_field().part(), ElementsAre(0));
  EXPECT_THAT(sweep->condition(1).part_temperature_k(), ElementsAre(0, 500, 300));
  EXPECT_FALSE(sweep->sweep().part(0).hot());
  EXPECT_TRUE(sweep->sweep().part(1).hot());
  EXPECT_FALSE(sweep->sweep().part(2).hot());
}

TEST(SeasonCourse, WhatIsWrongWithHeat) {
  CoursePieces p;
  p.heat = "";
  EXPECT_THAT(course_error_of(p), HasSubstr("part[0].build_up = \"wall\", but [heat] is missing"));
  p = {};
  p.place = "";
  EXPECT_THAT(course_error_of(p), HasSubstr("[heat] needs [place]"));
  p = {};
  p.place += "speed_m_s = 8\n";
  EXPECT_EQ(course_error_of(p), "");
  p.heat = "";
  EXPECT_THAT(course_error_of(p),
              HasSubstr("place.speed_m_s does not apply without [heat] or a funnel's [plume]"));
  p = {};
  p.air = "model = \"vacuum\"\n";
  EXPECT_THAT(course_error_of(p),
              AllOf(HasSubstr("[heat] needs air.model = \"atmosphere\""),
                    HasSubstr("season[0].weather_file does not apply to air.model")));
  p = {};
  p.heat = "[heat]\nhistory = \"weeks\"\nhistory_days = 4\n";
  EXPECT_THAT(course_error_of(p), AllOf(HasSubstr("heat.history = \"weeks\""),
                                        HasSubstr("heat.history_days does not apply")));
  p = {};
  p.parts += "[[part]]\nname = \"deck\"\nmaterial = \"paint\"\n";
  EXPECT_THAT(course_error_of(p), HasSubstr("or build_up here: then it is computed"));
  p.parts = "[[part]]\nname = \"sphere\"\nmaterial = \"paint\"\ntemperature_k = 290\n";
  EXPECT_THAT(course_error_of(p),
              HasSubstr("[heat], but the temperatures of all parts are stated"));
  p = {};
  p.surroundings = "kind = \"ground\"\nground_temperature_k = 290\nground_emissivity = 0.95\n";
  EXPECT_THAT(course_error_of(p), HasSubstr("surroundings.solar_albedo is missing"));
  p.surroundings += "solar_albedo = 0.2\n";
  EXPECT_EQ(course_error_of(p), "");
  p = {};
  p.season = "[[season]]\nname = \"summer\"\ndate = 2025-07-21\nair_temperature_k = 290\n";
  EXPECT_THAT(course_error_of(p),
              AllOf(HasSubstr("season[0].wind_speed_m_s is missing, expected it, a weather_file"),
                    HasSubstr("season[0].relative_humidity_percent is missing")));
  p.season = absl::StrReplaceAll(kConstant, {{"wind_from_deg = 290\n", ""}});
  EXPECT_THAT(course_error_of(p), HasSubstr("season[0].wind_from_deg is missing"));
}

TEST(SeasonCourse, WhatIsWrongWithADay) {
  CoursePieces p;
  p.season = absl::StrReplaceAll(kDay, {{"dew_point_k = 283", "dew_point_k = 286"}});
  EXPECT_THAT(course_error_of(p),
              HasSubstr("season[0].day.dew_point_k = 286 is above air_temperature_min_k = 285"));
  p.season = absl::StrReplaceAll(kDay, {{"max_k = 293", "max_k = 280"}});
  EXPECT_THAT(course_error_of(p), HasSubstr("air_temperature_max_k = 280 is below"));
  p.season = absl::StrReplaceAll(kDay, {{"pressure_pa = 101300\n", ""}});
  EXPECT_THAT(course_error_of(p),
              HasSubstr("season[0].pressure_pa is missing, expected it beside the"));
  p.season = kDay + "weather_file = \"sf.epw\"\n";
  EXPECT_THAT(course_error_of(p), HasSubstr("is stated beside "));
  p.season = kDay + "air_temperature_k = 291\n";
  EXPECT_THAT(course_error_of(p),
              HasSubstr("season[0].air_temperature_k = 291, but season[0].day has 29"));
  p.season = absl::StrReplaceAll(
      kDay, {{"warm", "warm"}, {"dew_point_k = 283", "dew_point_k = 283, warmest_hour = 25"}});
  EXPECT_THAT(course_error_of(p), HasSubstr("season[0].day.warmest_hour = 25"));
}

TEST(SeasonCourse, WhatIsWrongWithAFile) {
  CoursePieces p;
  p.season += "air_temperature_k = 300\n";
  EXPECT_THAT(course_error_of(p),
              HasSubstr("s.toml:18:1: season[0].air_temperature_k = 300, but "
                        "season[0].weather_file has 290.25 at 2025-07-21T20:00:00Z"));
  p = {};
  p.season += "wind_from_deg = 20\ncloud_cover = 0.5\n";
  EXPECT_THAT(course_error_of(p),
              AllOf(HasSubstr("season[0].wind_from_deg does not apply: the weather"),
                    HasSubstr("season[0].cloud_cover does not apply")));
  p = {};
  p.place = absl::StrReplaceAll(p.place, {{"37.6", "35.6"}});
  EXPECT_THAT(course_error_of(p),
              HasSubstr("sf.epw:1:1: season[0].weather_file: the file is of latitude"));
  p = {};
  p.season = absl::StrReplaceAll(p.season, {{"2025-07-21", "2024-02-29"}, {"summer", "x"}});
  EXPECT_THAT(course_error_of(p), HasSubstr("typical years have no 29 February"));
  p = {};
  EXPECT_THAT(course_error_of(p, absl::StrReplaceAll(shipped(), {{"-122.40,-8.0", "-122.40,4"}})),
              HasSubstr("below the horizon at the sweep's place"));
  EXPECT_THAT(course_error_of(p, "nonsense"),
              HasSubstr("sf.epw:1:1: there is no line DATA PERIODS"));
  p = {};
  p.season += "cloud_cover = 0.5\n";
  EXPECT_THAT(course_error_of(p),
              HasSubstr("season[0].cloud_cover does not apply: the weather file has it"));
}

// The layer that a season states is that of its rows and of its walls, whatever the file has.
TEST(SeasonCourse, AStatedLayerWinsOverTheFilesCover) {
  CoursePieces p;
  p.season += "cloud = [{ type = \"altostratus\", cover = 0.25 }]\n";
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  for (const schema::Condition& condition : sweep->condition()) {
    EXPECT_EQ(condition.weather().cloud_cover(), 0.25);
    EXPECT_EQ(condition.weather().cloud().type(), "altostratus");
    EXPECT_THAT(condition.warning(),
                ::testing::Contains(HasSubstr("cover is used in place of the weather file's")));
  }
  for (const schema::WeatherRecord& record : sweep->heat(0).course().record())
    EXPECT_EQ(record.cloud_cover(), 0.25);
}

// A cover that is uncertain may be moved from 0: rows and walls need the layer that then appears.
TEST(SeasonCourse, AnUncertainCoverHasALayerWhereNothingIsCovered) {
  for (const bool uncertain : {false, true}) {
    CoursePieces p;
    p.season = kConstant + "cloud_cover = 0\ncloud_type = \"stratocumulus\"\n";
    if (uncertain) p.more = "[uncertainty]\ncloud_cover = 0.2\n";
    const auto sweep = resolve_course(p);
    ASSERT_TRUE(sweep.ok()) << sweep.status();
    EXPECT_EQ(sweep->condition(0).weather().cloud_cover(), 0);
    EXPECT_EQ(sweep->condition(0).weather().cloud().type(), uncertain ? "stratocumulus" : "");
    EXPECT_EQ(sweep->heat(0).weather().has_cloud(), uncertain);
  }
}

TEST(SeasonCourse, AnUnknownBaseIsUncertain) {
  CoursePieces p;
  const auto bases = [&](const std::string& cloud) {
    p.season = kConstant + cloud;
    const auto sweep = resolve_course(p);
    EXPECT_TRUE(sweep.ok()) << sweep.status();
    const auto weather =
        weather_from_message(sweep->condition(0).weather(), sweep->condition(0).surroundings());
    EXPECT_TRUE(weather.ok()) << weather.status();
    return weather->cloud_base_range_m;
  };
  EXPECT_EQ(bases("cloud_cover = 0.5\n"), (std::array{300.0, 2500.0}));
  EXPECT_EQ(bases("cloud_cover = 0.5\ncloud_type = \"stratus\"\n"), std::nullopt);
}

TEST(SeasonCourse, AnHourOfAnotherDayIsSaid) {
  CoursePieces p;
  p.time = "time = [\"02:00Z\"]\n";
  const auto sweep = resolve_course(p);
  ASSERT_TRUE(sweep.ok()) << sweep.status();
  EXPECT_THAT(sweep->condition(0).warning(),
              ElementsAre(HasSubstr("2025-07-21T02:00:00Z is not within 2025-07-21 at the place")));
}

}  // namespace
}  // namespace irsig
