// Tests the views of profiles: the table over reflections, the comparison, CSV and SVG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "view/report/profile.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

StoredProfileRow row_of(const std::string& profile, std::uint64_t index, std::uint64_t point,
                        std::uint64_t reflections, double temperature_k) {
  StoredProfileRow r{};
  r.sweep = "cavity";
  r.season = "any";
  r.time_utc = "2006-08-01T12:00:00Z";
  r.band = "lwir";
  r.lambda_min_um = 8;
  r.lambda_max_um = 14;
  r.aspect_azimuth_deg = 180;
  r.aspect_elevation_deg = 45;
  r.range_m = 100000;
  r.row = 1;
  r.profile = profile;
  r.profile_index = index;
  r.point_index = point;
  r.y_m = 0.5 * static_cast<double>(point);
  r.reflections = reflections;
  r.radiance_w_m2_sr = 60;
  r.source_radiance_temperature_k = temperature_k;
  r.source_radiance_temperature_stderr_k = 0.002;
  return r;
}

std::vector<StoredProfileRow> points() {
  return {row_of("deep", 0, 0, 0, 298.124), row_of("deep", 0, 0, 3, 305.796),
          row_of("shallow", 1, 0, 0, 298.124), row_of("shallow", 1, 0, 3, 0)};
}

TEST(ProfileSummary, HasATableOverReflections) {
  const std::string text = profile_summary(points(), {});
  EXPECT_THAT(text, HasSubstr("cavity: any 2006-08-01T12:00:00Z, lwir (8 to 14 um), from azimuth"));
  EXPECT_THAT(text, HasSubstr("standard error 2 mK at most"));
  EXPECT_THAT(text, HasSubstr("  profile      N=0      N=3\n"
                              "  deep     298.124  305.796\n"
                              "  shallow  298.124        -\n"));
  EXPECT_THAT(text, Not(HasSubstr("published")));
}

TEST(ProfileSummary, PutsPublishedNumbersBesideOurs) {
  const std::string text = profile_summary(
      points(), {{"cavity", "deep", 0, 3, 306, "equal", "A paper, Figure 4", "the sky"},
                 {"cavity", "deep", 0, 0, 298, "below", "A paper", ""},
                 {"another", "deep", 0, 0, 111, "equal", "not this sweep", ""}});
  EXPECT_THAT(text, HasSubstr("306    305.796 +- 0.002  -0.204 K\n      A paper, Figure 4\n"
                              "      Why: the sky\n"));
  EXPECT_THAT(text, HasSubstr("< 298    298.124 +- 0.002  +0.124 K, does not agree\n"));
  EXPECT_THAT(text, Not(HasSubstr("not this sweep")));
}

std::vector<StoredProfileRow> line() {
  std::vector<StoredProfileRow> rows;
  for (std::uint64_t p = 0; p < 5; ++p)
    for (const std::uint64_t n : {0U, 8U})
      rows.push_back(row_of("throat", 0, p, n, 290 + 2.0 * static_cast<double>(p * (n > 0))));
  return rows;
}

TEST(ProfileSummary, StatesTheExtentOfALine) {
  EXPECT_THAT(profile_summary(line(), {}),
              HasSubstr("throat: 5 points, N=8: 290.00 K (point 0) to 298.00 K (point 4)"));
}

TEST(ProfileRows, AreWrittenAsCsv) {
  std::ostringstream out;
  ASSERT_TRUE(write_profiles(points(), "csv", out).ok());
  EXPECT_THAT(out.str(), HasSubstr("profile,point_index,x_m,y_m,z_m,reflections,radiance_w_m2_sr,"
                                   "radiance_stderr_w_m2_sr,source_radiance_temperature_k,"));
  EXPECT_THAT(out.str(), HasSubstr("deep,0,0,0,0,3,60,0,305.796,0.002"));
  EXPECT_THAT(out.str(), HasSubstr("shallow,0,0,0,0,3,60,0,,,"));  // no radiance, no temperature
}

TEST(PlotProfile, DrawsALineOrReflections) {
  const auto along = plot_profile(line(), {});
  ASSERT_TRUE(along.ok()) << along.status();
  EXPECT_THAT(*along, HasSubstr("Distance along the profile in m"));
  EXPECT_THAT(*along, HasSubstr("N = 8"));
  const auto over = plot_profile(points(), {{"cavity", "deep", 0, 3, 306, "below", "", ""}});
  ASSERT_TRUE(over.ok()) << over.status();
  EXPECT_THAT(*over, HasSubstr("Number of reflections"));
  EXPECT_THAT(*over, HasSubstr("shallow"));
  EXPECT_EQ(plot_profile(points(), {}), plot_profile(points(), {}));
}

TEST(PlotProfile, ShowsOneSignature) {
  std::vector<StoredProfileRow> rows = line();
  rows.back().row = 2;
  EXPECT_EQ(plot_profile(rows, {}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(plot_profile({}, {}).status().code(), absl::StatusCode::kNotFound);
}

TEST(ProfileNotes, SayWhichRowsMissTheErrorAskedFor) {
  schema::Sweep sweep;
  sweep.set_name("cavity");
  schema::Profile& deep = *sweep.add_profile();
  deep.set_name("deep");
  deep.set_source_radiance_temperature_stderr_k(0.001);
  std::vector<StoredProfileRow> rows = {row_of("deep", 0, 0, 0, 298), row_of("deep", 0, 1, 0, 299),
                                        row_of("deep", 0, 2, 0, 300)};
  rows[1].source_radiance_temperature_stderr_k = 0.0009;
  rows[2].source_radiance_temperature_stderr_k = 0.005;
  const std::vector<std::string> notes = profile_notes(rows, sweep);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_THAT(notes[0], HasSubstr("\"deep\": 2 of 3 rows miss"));
  EXPECT_THAT(notes[0], HasSubstr("5 mK at most, 1 mK asked"));
  rows[0].sweep = rows[2].sweep = "another";
  EXPECT_TRUE(profile_notes(rows, sweep).empty()) << "of this sweep alone";
  deep.clear_source_radiance_temperature_stderr_k();
  deep.set_samples(1000);
  rows[0].sweep = "cavity";
  EXPECT_TRUE(profile_notes(rows, sweep).empty()) << "no error was asked for";
}

}  // namespace
}  // namespace irsig
