// Tests the text of `irsig explain` and of the ledger of `irsig plan`.
#include "view/report/explain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/fake_database.h"
#include "view/report/effect_ledger.h"
#include "view/report/temperatures.h"

namespace irsig {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::Pair;

constexpr double kUnknown = kNotComputed;

StoredLedger some_ledger(double scale) {
  StoredLedger ledger;
  ledger.effect = {
      {"self_emission", "on", "always", kUnknown, kUnknown, kUnknown, 0.75 * scale, kUnknown},
      {"direct_sun", "on", "above_fraction", 0.5 * scale, 0.45 * scale, 0.45 * scale, 0.25 * scale,
       0.02},
      {"sky_reflected", "off", "within_fraction", 2e-4 * scale, 1e-4 * scale, 1e-4 * scale,
       kUnknown, 0.5},
      {"mirrored_sun", "absent", "not_in_scene", 0, 0, 0, kUnknown, kUnknown},
      {"joined_lines", "off", "forced", kUnknown, kUnknown, kUnknown, kUnknown, kUnknown}};
  ledger.energy = StoredEnergy{0.9, 1e-3, 0.06, 1e-3, 0.03, 1e-3, 0.01, 1e-4, 1, 2e-5};
  return ledger;
}

// Row 4: spring, lwir of the first viewpoint.
FakeDatabase with_ledger() {
  FakeDatabase db = fake_database();
  StoredSignature& s = db.signatures[3];
  s.truncation_bound_w_sr = 1e-3 * s.intensity_w_sr;
  s.omitted_bound_w_sr = 2e-4 * s.intensity_w_sr;
  s.absolute_floor_w_sr = 3;
  s.reflections = 4;
  s.warning = "it is odd";
  db.ledgers[s.signature_id] = some_ledger(s.intensity_w_sr);
  auto& accuracy = *db.sweeps["box ship"].resolved.mutable_sweep()->mutable_accuracy();
  accuracy.set_relative_error(0.01);
  accuracy.set_absolute_error_k(0.05);
  return db;
}

std::string explained(FakeDatabase db, std::uint64_t row, const std::string& format = "text") {
  std::ostringstream out;
  const absl::Status status = explain_row(db, "", row, format, out);
  EXPECT_TRUE(status.ok()) << status;
  return out.str();
}

TEST(Explain, ShowsTheCloudOfTheCondition) {
  FakeDatabase db = with_ledger();
  EXPECT_THAT(explained(db, 4), Not(HasSubstr("cloud: ")));
  EXPECT_THAT(explained(db, 4, "json"), HasSubstr("\"cloud\": []"));
  const StoredSignature& s = db.signatures[3];
  schema::ResolvedSweep& resolved = db.sweeps["box ship"].resolved;
  for (const bool own : {false, true}) {
    schema::Condition& condition = *resolved.add_condition();
    condition.set_season(own ? s.season : "other");
    condition.set_time_utc(s.time_utc);
    schema::Weather& weather = *condition.mutable_weather();
    weather.set_cloud_cover(own ? 0.8 : 0.1);
    schema::CloudLayer& layer = *weather.mutable_cloud();
    layer.set_type("stratus");
    layer.set_phase("water");
    layer.set_base_m(330);
    layer.set_top_m(1000);
    layer.set_water_path_g_m2(200);
    layer.set_effective_radius_um(7.9);
  }
  EXPECT_THAT(
      explained(db, 4),
      HasSubstr("\ncloud: stratus covers 0.8 of the sky, 330 to 1000 m above the surface, 200 "
                "g/m2 of water with an effective radius of 7.9 um\n"));
  EXPECT_THAT(explained(db, 4, "json"),
              AllOf(HasSubstr("\"cover\": 0.8"), HasSubstr("\"type\": \"stratus\""),
                    HasSubstr("\"base_m\": 330"), HasSubstr("\"water_path_g_m2\": 200")));
}

TEST(Explain, ShowsTheBackgroundOfATargetOnLand) {
  FakeDatabase db = with_ledger();
  EXPECT_THAT(explained(db, 4), AllOf(Not(HasSubstr("clutter")), HasSubstr("air, sky and sea")));
  StoredSignature& s = db.signatures[3];
  s.clutter_patch_sigma_w_m2_sr = 0.3;
  s.clutter_patch_sigma_stderr_w_m2_sr = 0.03;
  s.clutter_patch_m = 4;
  s.clutter_mean_w_m2_sr = 2;
  s.clutter_cells = 9;
  s.visible_fraction = 0.75;
  schema::Clutter& clutter = db.clutters[s.signature_id];
  for (int k = 0; k < db.spectra[s.signature_id].lambda_um_size(); ++k)
    clutter.add_patch_sigma_w_m2_sr_um(0.1F);
  schema::Land& land = *db.sweeps["box ship"].resolved.mutable_sweep()->mutable_land();
  for (const auto& [material, fraction] :
       {std::pair{"grass", 0.25}, std::pair{"asphalt", 0.7}, std::pair{"sand", 0.0}}) {
    land.add_material()->set_material(material);
    clutter.add_material_fraction(fraction);
  }
  EXPECT_THAT(
      explained(db, 4),
      AllOf(HasSubstr("air, sky and ground, land behind the target\n"),
            HasSubstr("0.3 W/(m2 sr), scatter of means over squares of 4 m, the target's"),
            HasSubstr("9 independent values"), HasSubstr("grass                          25 %"),
            HasSubstr("asphalt                        70 %"), Not(HasSubstr("sand  ")),
            HasSubstr("75 % of the target's silhouette")));
  EXPECT_THAT(explained(db, 4, "json"),
              AllOf(HasSubstr("\"material\": \"grass\""), HasSubstr("\"fraction\": 0.25")));
}

TEST(Explain, ShowsTheTemperaturesThatAJobHasComputed) {
  FakeDatabase db = with_ledger();
  EXPECT_THAT(explained(db, 4), Not(HasSubstr("temperatures that a job")));
  const StoredSignature& s = db.signatures[3];
  db.temperatures.push_back(
      {s.sweep, s.season, s.time_utc, "hull", 301.5, 290, 320, 0.75, false, "key"});
  db.temperatures.push_back(
      {s.sweep, "other", s.time_utc, "deck", 301.5, 290, 320, 0.75, false, "key"});
  EXPECT_THAT(explained(db, 4),
              HasSubstr("hull                   301.50 K, 290.00 to 320.00 K, +- 0.75 K\n"));
  EXPECT_THAT(explained(db, 4), Not(HasSubstr("deck")));
  EXPECT_THAT(explained(db, 4, "json"), HasSubstr("\"mean_k\": 301.5"));
}

TEST(Temperatures, AreATableOfWhatPassesTheFilter) {
  FakeDatabase db = with_ledger();
  std::ostringstream out;
  EXPECT_TRUE(absl::IsNotFound(write_temperatures(db, {}, "csv", out)));
  db.temperatures = {
      {"ship", "june", "2025-06-21T12:00:00Z", "hull", 301.5, 290, 320, 0.75, false, "key"},
      {"ship", "july", "2025-07-21T12:00:00Z", "hull", 302.5, 291, 321, 0.5, true, "key"}};
  TemperatureFilter filter;
  filter.season = "july";
  out.str("");
  ASSERT_TRUE(write_temperatures(db, filter, "csv", out).ok());
  EXPECT_EQ(out.str(),
            "sweep,season,time_utc,part,mean_k,coldest_k,hottest_k,error_k,superseded\n"
            "ship,july,2025-07-21T12:00:00Z,hull,302.5,291,321,0.5,true\n");
  filter.season = NameSet(std::vector<std::string>{"june", "july"});
  out.str("");
  ASSERT_TRUE(write_temperatures(db, filter, "csv", out).ok());
  EXPECT_THAT(out.str(), HasSubstr("ship,june,"));
  EXPECT_THAT(out.str(), HasSubstr("ship,july,"));
  for (const auto& names : {std::vector<std::string>{"may"}, {"june", "may"}}) {
    filter.season = NameSet(names);
    const absl::Status said = write_temperatures(db, filter, "text", out);
    EXPECT_TRUE(absl::IsNotFound(said));
    EXPECT_THAT(std::string(said.message()),
                HasSubstr("no season \"may\" in this database; there is: july, june"));
  }
}

TEST(Explain, SaysWhatTheRowIsAndEveryErrorOfIt) {
  const std::string text = explained(with_ledger(), 4);
  EXPECT_THAT(text, HasSubstr("row 4 of box ship: spring 2025-03-20T01:30:00Z, lwir (8 to 12 um)"));
  EXPECT_THAT(text, HasSubstr("warning: it is odd"));
  for (const char* line :
       {"standard error +[0-9.]+ +0.1 %", "truncation bound +[0-9.]+ +0.1 %",
        "omitted bound +[0-9.]+ +0.02 %", "numerical error +[0-9.]+ +0.125 %",
        "asked +1 % of the intensity: [0-9.e+]+ W/sr, or the floor of 0.05 K: 3 W/sr",
        "stopped +ACCURACY_REACHED", "samples +65536 in 32 replicates", "of at most 4 reflections"})
    EXPECT_THAT(text, ContainsRegex(line)) << line;
}

TEST(Explain, TellsWhatEachEffectDid) {
  const std::string text = explained(with_ledger(), 4);
  for (const char* line :
       {"self_emission +on +- +- +- +75 % +-  never left out unasked",
        "direct_sun +on +50 % +50 % +[0-9.e+]+ % +25 % +20 ms  the error asked for has no room",
        "sky_reflected +off +0.02 % +0.011 % +[0-9.]+ % +- +saved 500 ms  the error asked for has "
        "room",
        "mirrored_sun +absent +- +- +- +- +-  nothing in this scene",
        "joined_lines +off +- +- +- +- +-  forced: the user's word", "absorbed +0.9 \\+- 0.001",
        "to the sky +0.06 ", "sum +1 \\+- 2e-05", "emitted +[0-9.]+ +75 %",
        "sun reflected +[0-9.]+ +25 %", "hull +[0-9.]+ +70 %", "funnel +[0-9.]+ +30 %"})
    EXPECT_THAT(text, ContainsRegex(line)) << line << "\n" << text;
}

TEST(Explain, ARowOfAnOlderFileHasNoLedger) {
  FakeDatabase db = with_ledger();
  db.ledgers.clear();
  using S = StoredSignature;
  for (double S::*number : {&S::omitted_bound_w_sr, &S::absolute_floor_w_sr})
    db.signatures[3].*number = kNotComputed;
  db.signatures[3].reflections.reset();
  const std::string text = explained(db, 4);
  EXPECT_THAT(text, HasSubstr("no ledger of effects: an older irsig stored this row"));
  EXPECT_THAT(text, ContainsRegex("omitted bound +not stored"));
  EXPECT_THAT(text, Not(HasSubstr("absent")));
  EXPECT_THAT(text, Not(HasSubstr(": nan")));
  EXPECT_THAT(text, Not(HasSubstr("floor")));
  EXPECT_THAT(text, ContainsRegex("hull +[0-9.]+ +70 %"));
}

TEST(Explain, JsonHasEveryNumber) {
  const std::string text = explained(with_ledger(), 4, "json");
  EXPECT_THAT(
      text,
      AllOf(HasSubstr("{\"signature\": [\n {\"row\": 4, "), HasSubstr("\"reflections\": 4"),
            HasSubstr("{\"effect\": \"mirrored_sun\", \"state\": \"absent\", \"reason\": "
                      "\"not_in_scene\", \"bound_w_sr\": 0,"),
            HasSubstr("\"effect\": \"joined_lines\", \"state\": \"off\", \"reason\": \"forced\", "
                      "\"bound_w_sr\": null"),
            HasSubstr("\"absorbed\": 0.9, \"absorbed_stderr\": 0.001"),
            HasSubstr("\"part\": \"funnel\""), Not(HasSubstr(": nan"))));
}

TEST(Explain, RefusesRowsThatAreNotOne) {
  FakeDatabase db = with_ledger();
  std::ostringstream out;
  const absl::Status beyond = explain_row(db, "", 99999, "text", out);
  EXPECT_TRUE(absl::IsNotFound(beyond));
  EXPECT_THAT(std::string(beyond.message()), HasSubstr("no row 99999"));
  EXPECT_THAT(std::string(beyond.message()), HasSubstr("the last one is 1146"));
  EXPECT_TRUE(absl::IsNotFound(explain_row(db, "canoe", 4, "text", out)));
  EXPECT_TRUE(absl::IsInvalidArgument(explain_row(db, "", 4, "xml", out)));
  StoredSignature other = db.signatures[3];
  other.sweep = "canoe";
  db.signatures.push_back(other);
  db.sweeps["canoe"] = db.sweeps["box ship"];
  const absl::Status two = explain_row(db, "", 4, "text", out);
  EXPECT_TRUE(absl::IsInvalidArgument(two));
  EXPECT_THAT(std::string(two.message()),
              HasSubstr("2 sweeps have a row 4: choose one of box ship, canoe with --sweep"));
  EXPECT_EQ(out.str(), "");
  EXPECT_TRUE(explain_row(db, "canoe", 4, "text", out).ok());
  const absl::Status missing = explain_row(db, "canoe", 5, "text", out);
  EXPECT_TRUE(absl::IsNotFound(missing)) << missing;
}

TEST(EffectSummary, CountsRowsAndEachViewsTimeOnce) {
  const FakeDatabase db = fake_database();
  std::vector<LedgerRow> rows;
  for (const int i : {0, 1, 6}) {  // two rows of one view, one of another
    const StoredSignature& s = db.signatures[static_cast<std::size_t>(i)];
    rows.push_back({s, some_ledger(s.intensity_w_sr)});
  }
  rows[2].ledger.effect[2].state = "on";
  rows[2].ledger.effect[2].reason = "other_row";
  rows[1].ledger.effect[2].bound_w_sr *= 3;
  rows.push_back({db.signatures[7], {}});  // of an older file
  const auto summary = summarize_effects(rows);
  ASSERT_EQ(summary.size(), 5U);
  const EffectSummary& sky = summary[2];
  EXPECT_EQ(sky.effect, "sky_reflected");
  EXPECT_EQ(sky.on, 1U);
  EXPECT_EQ(sky.off, 2U);
  EXPECT_EQ(sky.absent, 0U);
  EXPECT_NEAR(sky.largest_bound, 6e-4, 1e-12);
  EXPECT_THAT(sky.reason, ElementsAre(Pair("other_row", 1), Pair("within_fraction", 2)));
  EXPECT_DOUBLE_EQ(sky.saved_s, 0.5);
  EXPECT_DOUBLE_EQ(sky.spent_s, 0.5);
  EXPECT_EQ(summary[3].absent, 3U);
  EXPECT_TRUE(summary[3].reason.empty());
  EXPECT_TRUE(std::isnan(summary[4].largest_bound)) << "one bound is not known";
  EXPECT_DOUBLE_EQ(summary[1].spent_s, 0.04);
  EXPECT_TRUE(std::isnan(summary[1].saved_s));
  EXPECT_TRUE(std::isnan(summary[4].saved_s)) << "nobody knows";
  const std::string table = summary_table(summary);
  EXPECT_THAT(table, ContainsRegex("sky_reflected +1 +2 +0 +0.06 % +500 ms +500 ms  another row of "
                                   "the view needs it \\(1\\); the error asked for has room for "
                                   "its bound \\(2\\)"));
  EXPECT_THAT(table, ContainsRegex("mirrored_sun +0 +0 +3 +- +- +-"));
}

}  // namespace
}  // namespace irsig
