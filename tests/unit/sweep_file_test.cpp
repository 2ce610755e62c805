// The TOML reader: every kind of value, the place of every key, and what it refuses.
#include "jobs/text/sweep_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "jobs/text/nearest_name.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

SweepFile parsed(std::string_view text) {
  absl::StatusOr<SweepFile> file = parse_sweep(text, "s.toml");
  EXPECT_TRUE(file.ok()) << file.status();
  return file.ok() ? *file : SweepFile{};
}

std::string file_error_of(std::string_view text) {
  const absl::StatusOr<SweepFile> file = parse_sweep(text, "s.toml");
  EXPECT_EQ(file.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(file.status().message());
}

TEST(ParseSweep, ReadsEveryKindOfValue) {
  const SweepFile file = parsed(R"(
name = "a \"b\" ü"
seed = 9223372036854775807
time = ["10:30Z", "11:30Z"]
[model]
triangles = 2e5
unit_m = 1
[[part]]
name = "x"
two_sided = true
[[part]]
temperature_k = 300.5
[[season]]
date = 2025-12-21
part_temperature_k = { x = 300, "a.b" = 280.5 }
[viewpoints]
azimuth_deg = [0, 90.5]
count = 24.0
aspect = [ { azimuth_deg = 1 }, { elevation_deg = 2 } ]
)");
  const schema::Sweep& sweep = file.sweep;
  EXPECT_EQ(sweep.name(), "a \"b\" ü");
  EXPECT_EQ(sweep.seed(), 9223372036854775807U);
  ASSERT_EQ(sweep.time_size(), 2);
  EXPECT_EQ(sweep.time(1), "11:30Z");
  EXPECT_EQ(sweep.model().triangles(), 200000U);
  EXPECT_EQ(sweep.model().unit_m(), 1.0);
  ASSERT_EQ(sweep.part_size(), 2);
  EXPECT_TRUE(sweep.part(0).two_sided());
  EXPECT_EQ(sweep.part(1).temperature_k(), 300.5);
  EXPECT_EQ(sweep.season(0).date(), "2025-12-21");
  ASSERT_EQ(sweep.season(0).part_temperature_k_size(), 2);
  EXPECT_EQ(sweep.season(0).part_temperature_k().at("a.b"), 280.5);
  EXPECT_EQ(sweep.viewpoints().azimuth_deg(1), 90.5);
  EXPECT_EQ(sweep.viewpoints().count(), 24U);
  EXPECT_EQ(sweep.viewpoints().aspect(1).elevation_deg(), 2.0);
}

TEST(ParseSweep, AbsentIsNotZero) {
  const SweepFile file = parsed("[place]\nlatitude_deg = 0\n");
  EXPECT_TRUE(file.sweep.place().has_latitude_deg());
  EXPECT_FALSE(file.sweep.place().has_longitude_deg());
  EXPECT_FALSE(file.sweep.has_seed());
}

TEST(ParseSweep, RemembersWhereEachKeyStands) {
  const SweepFile file = parsed(
      "time = [\"1\",\n  \"2\"]\n[model]\n  file = \"a\"\n[[part]]\n[[part]]\nname = \"p\"\n"
      "[[season]]\n[season.surroundings]\nkind = \"sea\"\n[season.part_temperature_k]\n\"a.b\" = "
      "3\n");
  EXPECT_EQ(file.location("time[1]"), "s.toml:2:3");
  EXPECT_EQ(file.location("model"), "s.toml:3:2");
  EXPECT_EQ(file.location("model.file"), "s.toml:4:3");
  EXPECT_EQ(file.location("part[1]"), "s.toml:6:1");
  EXPECT_EQ(file.location("part[1].name"), "s.toml:7:1");
  EXPECT_EQ(file.location("season[0].surroundings.kind"), "s.toml:10:1");
  EXPECT_EQ(file.location("season[0].part_temperature_k.a.b"), "s.toml:12:1");
}

TEST(ParseSweep, PlacesAnAbsentKeyAtItsTable) {
  const SweepFile file = parsed("name = \"x\"\n[[part]]\nname = \"p\"\n");
  EXPECT_EQ(file.location("part[0].material"), "s.toml:2:1");
  EXPECT_EQ(file.location("part[7].material"), file.location("part"));
  EXPECT_EQ(file.location("air.model"), "s.toml:1:1");
  EXPECT_EQ(file.location(""), "s.toml:1:1");
}

TEST(ParseSweep, ReportsASyntaxErrorAlone) {
  const std::string error = file_error_of("nane = 1\n[model\nseed = \"x\"\n");
  EXPECT_THAT(error, StartsWith("s.toml:2:7: "));
  EXPECT_EQ(error.find('\n'), std::string::npos);
  EXPECT_THAT(file_error_of("seed = 1\nseed = 2\n"), StartsWith("s.toml:2:"));
}

TEST(ParseSweep, ReportsAllOtherErrorsInTheOrderOfTheFile) {
  EXPECT_EQ(file_error_of("seed = -1\nnane = 1\n[air]\npressure_pa = nan\n[model]\nfile = 3\n"),
            "s.toml:1:1: seed = -1, expected a whole number from 0 to 18446744073709551615\n"
            "s.toml:2:1: unknown key \"nane\", did you mean \"name\"?\n"
            "s.toml:4:1: air.pressure_pa is nan, expected a finite number\n"
            "s.toml:6:1: model.file is an integer, expected a string in quotes");
}

TEST(ParseSweep, RefusesWhatIsNoWholeNumber) {
  for (const char* seed : {"-1", "1.5", "-0.5", "nan", "inf", "1e300", "\"1\"", "true"}) {
    EXPECT_THAT(file_error_of(std::string("seed = ") + seed), HasSubstr("whole number")) << seed;
  }
  EXPECT_THAT(file_error_of("[output]\nthumbnail_px = 4294967296"), HasSubstr("from 0 to 4096"));
}

// They came out as uninitialised memory.
TEST(ParseSweep, RefusesWholeNumbersThatADoubleDoesNotHold) {
  for (const char* number : {"9007199254740993", "10000000000000000", "9223372036854775807",
                             "-9007199254740993", "0x7fffffffffffffff"}) {
    EXPECT_THAT(file_error_of(std::string("[place]\nlatitude_deg = ") + number),
                StartsWith("s.toml:2:1: place.latitude_deg = "))
        << number;
    EXPECT_THAT(file_error_of(std::string("[viewpoints]\nazimuth_deg = [0, ") + number + "]"),
                HasSubstr("s.toml:2:19: viewpoints.azimuth_deg[1] = "))
        << number;
  }
  // An integer that does not fit into 64 bits, and numbers that are none.
  EXPECT_THAT(file_error_of("[place]\nlatitude_deg = 9223372036854775808"),
              StartsWith("s.toml:2:"));
  for (const char* number : {"1e999", "-1e999", "nan", "inf"})
    EXPECT_THAT(file_error_of(std::string("[place]\nlatitude_deg = ") + number),
                StartsWith("s.toml:2:"))
        << number;
  EXPECT_EQ(parsed("[air]\nvisibility_m = 9007199254740992\n").sweep.air().visibility_m(), 0x1p53);
  EXPECT_EQ(parsed("[air]\nvisibility_m = -9007199254740992\n").sweep.air().visibility_m(),
            -0x1p53);
  EXPECT_EQ(parsed("[air]\nvisibility_m = 0x10\n").sweep.air().visibility_m(), 16.0);
}

TEST(ParseSweep, KeepsEachErrorOnOneLine) {
  EXPECT_EQ(file_error_of("\"a\\nb\" = 1").find('\n'), std::string::npos);
}

TEST(ParseSweep, TakesADateWithoutQuotesForADateOnly) {
  EXPECT_THAT(file_error_of("name = 2025-12-21"), HasSubstr("name is a date, expected a string"));
}

TEST(ParseSweep, SaysWhatAMistakeInTheGrammarIsAbout) {
  const std::pair<const char*, const char*> cases[] = {
      {"name = \"box\nseed = 1\n", "s.toml:1:12: "},
      {"name = \"box\nseed = 1\n", "(the closing quote of this text is missing)"},
      {"[transport]\nsun = yes\n", "(a switch is true or false"},
      {"[transport]\nsun = True\n", "(a switch is true or false"},
      {"[viewpoints]\nrange_m = 5 km\n", "(a number stands alone, without its unit)"},
      {"[viewpoints]\nrange_m = 5,5\n", "(numbers have a decimal point: 54.3)"},
      {"[accuracy]\nrelative_error = 1%\n", "(a fraction: 1 % is 0.01)"},
      {"[accuracy]\nrelative_error = .01\n", "(a number begins with a digit: 0.01)"},
      {"name: \"box\"\n", "(KEY = VALUE)"},
      {"name = box\n", "(text stands in \"straight quotes\")"},
      {"seed = 1\nseed = 2\n", "(each key stands once in its table: delete one)"}};
  for (const auto& [text, said] : cases) EXPECT_THAT(file_error_of(text), HasSubstr(said)) << text;
}

TEST(ParseSweep, SaysWhichKeyHasAnotherUnit) {
  EXPECT_THAT(file_error_of("[weather]\nair_temperature_c = 20\n"),
              HasSubstr("s.toml:2:1: unknown key \"air_temperature_c\" in weather, expected "
                        "\"air_temperature_k\" (20 C are 293.15 K)"));
  EXPECT_THAT(file_error_of("[viewpoints]\nrange_km = 5\n"),
              HasSubstr("expected \"range_m\" (5 km are 5000 m)"));
  EXPECT_THAT(file_error_of("[[band]]\nlambda_um = 5\n"),
              HasSubstr("in band[0], expected \"lambda_min_um\", \"lambda_max_um\""));
}

TEST(Suggestion, NamesTheNearestOrAll) {
  const std::vector<std::string> known = {"season", "surroundings", "a"};
  EXPECT_EQ(suggestion("sesaon", known), "did you mean \"season\"?");
  EXPECT_EQ(suggestion("surrounding", known), "did you mean \"surroundings\"?");
  EXPECT_EQ(suggestion("b", known), "expected one of \"season\", \"surroundings\", \"a\"");
  EXPECT_EQ(suggestion("SEASON", known), "did you mean \"season\"?");
  EXPECT_EQ(suggestion("x", {}), "there are none");
}

}  // namespace
}  // namespace irsig
