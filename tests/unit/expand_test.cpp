// Jobs: their order, how they are cut, and what their keys depend on.
#include "jobs/keys/expand.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>

#include "tests/unit/sweep_text.h"

namespace irsig {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using ::testing::ElementsAre;

const std::filesystem::path kExpandedExamples =
    std::filesystem::path(IRSIG_SOURCE_DIR) / "jobs/examples";

schema::ResolvedSweep quickstart() {
  const auto sweep = resolved_file(kExpandedExamples / "quickstart.toml");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return *sweep;
}

// FIPS 180-4, the examples of NIST.
TEST(Sha256, MatchesThePublishedDigests) {
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(CanonicalEncoding, IsTheDocumentedText) {
  schema::ResolvedSweep sweep;
  sweep.mutable_sweep()->set_name("a\"\n\xc3\xbc");
  sweep.mutable_sweep()->set_seed(7);
  schema::Season& season = *sweep.mutable_sweep()->add_season();
  (*season.mutable_part_temperature_k())["z"] = 0.1;
  (*season.mutable_part_temperature_k())["a"] = -0.0;
  sweep.mutable_sweep()->mutable_air();
  sweep.mutable_sweep()->mutable_transport()->set_sun(false);
  sweep.add_condition()->add_part_temperature_k(300);
  EXPECT_EQ(canonical_encoding(sweep),
            "1 message\n"
            "1.1 string \"a\\x22\\x0a\\xc3\\xbc\"\n"
            "1.3 uint 7\n"
            "1.8[0] message\n"
            "1.8[0].3{\"a\"} double 0x0p+0\n"
            "1.8[0].3{\"z\"} double 0x1.999999999999ap-4\n"
            "1.13 message\n"
            "1.14 message\n"
            "1.14.2 bool false\n"
            "3[0] message\n"
            "3[0].5[0] double 0x1.2cp+8\n");
}

TEST(CanonicalEncoding, SurvivesSerialization) {
  const schema::ResolvedSweep sweep = quickstart();
  schema::ResolvedSweep copy;
  ASSERT_TRUE(copy.ParseFromString(sweep.SerializeAsString()));
  EXPECT_EQ(canonical_encoding(copy), canonical_encoding(sweep));
}

TEST(ExpandJobs, OneForEachViewpointInOrder) {
  const schema::ResolvedSweep sweep = quickstart();
  const std::vector<schema::JobSpec> jobs = expand_jobs(sweep, 1);
  ASSERT_EQ(jobs.size(), 24U);
  std::set<std::string> keys;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    EXPECT_EQ(jobs[i].view().viewpoint_index(), i);
    EXPECT_THAT(jobs[i].view().condition_index(), ElementsAre(0, 1, 2));
    EXPECT_THAT(jobs[i].view().band_index(), ElementsAre(0, 1));
    EXPECT_EQ(jobs[i].sweep_sha256(), sha256_hex(canonical_encoding(sweep)));
    keys.insert(jobs[i].job_key());
  }
  EXPECT_EQ(keys.size(), jobs.size());
}

// A fixed sweep in code, so that editing an example does not move the golden key.
schema::ResolvedSweep golden_sweep() {
  const auto sweep = resolved_text(R"(
time = ["12:00Z"]
[model]
generate = "sphere"
triangles = 100
[[material]]
name = "paint"
kind = "lambert"
emissivity = 0.9
[[part]]
name = "sphere"
material = "paint"
temperature_k = 300
[[season]]
name = "any"
date = 2025-06-21
[[band]]
name = "lwir"
lambda_min_um = 8
lambda_max_um = 12
step_um = 0.1
[viewpoints]
kind = "list"
range_m = 1000
aspect = [ { azimuth_deg = 0, elevation_deg = 0 }, { azimuth_deg = 90, elevation_deg = 30 } ]
[surroundings]
kind = "none"
sky_radiance_w_m2_sr_um = 0
lower_radiance_w_m2_sr_um = 0
[air]
model = "vacuum"
[transport]
sun = false
)");
  EXPECT_TRUE(sweep.ok()) << sweep.status();
  return *sweep;
}

// 8.2 - 8.1 is less than 0.1 by rounding.
TEST(ExpandJobs, AStepMayBeAsWideAsItsBand) {
  std::string text = text_of(kExpandedExamples / "disk.toml");
  for (const auto& [is, becomes] :
       {std::pair<std::string, std::string>{"min_um = 3.0", "min_um = 8.1"},
        {"max_um = 5.0", "max_um = 8.2"},
        {"step_um = 0.05", "step_um = 0.1"}}) {
    ASSERT_NE(text.find(is), std::string::npos) << is;
    text.replace(text.find(is), is.size(), becomes);
  }
  EXPECT_TRUE(resolved_text(text).ok()) << resolved_text(text).status();
  text.replace(text.find("step_um = 0.1"), 13, "step_um = 0.2");
  EXPECT_FALSE(resolved_text(text).ok());
}

// Stored databases are resumed by their keys: if this fails, every stored job is computed anew.
// Change it only on purpose.
TEST(ExpandJobs, GoldenKey) {
  EXPECT_EQ(expand_jobs(golden_sweep(), 1)[1].job_key(),
            "16f36785c56ff4c36a3dc460304e5f1b6bdb77f4c12224fe26b5fa4be3c35e87");
}

TEST(ExpandJobs, KeysDependOnThePhysicsVersion) {
  EXPECT_NE(expand_jobs(golden_sweep(), 1)[0].job_key(),
            expand_jobs(golden_sweep(), 2)[0].job_key());
}

TEST(ExpandJobs, InsertingAViewpointKeepsTheOtherKeys) {
  schema::ResolvedSweep sweep = golden_sweep();
  const std::vector<schema::JobSpec> before = expand_jobs(sweep, 1);
  schema::Viewpoint inserted = sweep.viewpoint(0);
  inserted.set_aspect_azimuth_deg(45);
  *sweep.add_viewpoint() = sweep.viewpoint(1);
  *sweep.mutable_viewpoint(1) = inserted;
  sweep.mutable_sweep()->mutable_viewpoints()->add_aspect()->set_azimuth_deg(45);
  const std::vector<schema::JobSpec> after = expand_jobs(sweep, 1);
  ASSERT_EQ(after.size(), 3U);
  EXPECT_EQ(after[0].job_key(), before[0].job_key());
  EXPECT_NE(after[1].job_key(), before[1].job_key());
  EXPECT_EQ(after[2].job_key(), before[1].job_key());
}

// Calls `visit` for each scalar that is present, with its path, while it is changed.
void with_each_scalar_changed(Message& message, const std::string& prefix,
                              const std::function<void(const std::string&)>& visit) {
  const google::protobuf::Reflection& r = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  r.ListFields(message, &fields);
  for (const FieldDescriptor* f : fields) {
    const bool many = f->is_repeated();
    for (int i = 0; i < (many ? r.FieldSize(message, f) : 1); ++i) {
      const std::string path = prefix + f->name();
      switch (f->cpp_type()) {
        case FieldDescriptor::CPPTYPE_MESSAGE:
          with_each_scalar_changed(
              many ? *r.MutableRepeatedMessage(&message, f, i) : *r.MutableMessage(&message, f),
              path + ".", visit);
          break;
        case FieldDescriptor::CPPTYPE_STRING: {
          const auto set = [&](const std::string& v) {
            many ? r.SetRepeatedString(&message, f, i, v) : r.SetString(&message, f, v);
          };
          const std::string before =
              many ? r.GetRepeatedString(message, f, i) : r.GetString(message, f);
          set(before + "x");
          visit(path);
          set(before);
          break;
        }
        case FieldDescriptor::CPPTYPE_DOUBLE: {
          const auto set = [&](double v) {
            many ? r.SetRepeatedDouble(&message, f, i, v) : r.SetDouble(&message, f, v);
          };
          const double before = many ? r.GetRepeatedDouble(message, f, i) : r.GetDouble(message, f);
          set(std::nextafter(before, 1e300));  // the smallest change there is
          visit(path);
          set(before);
          break;
        }
        case FieldDescriptor::CPPTYPE_UINT32: {
          const auto set = [&](std::uint32_t v) {
            many ? r.SetRepeatedUInt32(&message, f, i, v) : r.SetUInt32(&message, f, v);
          };
          const std::uint32_t before =
              many ? r.GetRepeatedUInt32(message, f, i) : r.GetUInt32(message, f);
          set(before + 1);
          visit(path);
          set(before);
          break;
        }
        case FieldDescriptor::CPPTYPE_UINT64:
          r.SetUInt64(&message, f, r.GetUInt64(message, f) + 1);
          visit(path);
          r.SetUInt64(&message, f, r.GetUInt64(message, f) - 1);
          break;
        case FieldDescriptor::CPPTYPE_BOOL:
          r.SetBool(&message, f, !r.GetBool(message, f));
          visit(path);
          r.SetBool(&message, f, !r.GetBool(message, f));
          break;
        default:
          FAIL() << path << " has an unexpected type";
      }
    }
  }
}

// Whatever is present in a resolved sweep changes the key, except what is listed here.
TEST(ExpandJobs, KeysChangeWithEveryDeterminingField) {
  const std::set<std::string> not_determining = {
      "sweep.name", "sweep.description", "sweep.time", "sweep.transport.job_size_vertices",
      "sweep.part.temperature_k",
      // written out into condition.weather
      "sweep.air.aerosol", "sweep.air.visibility_m", "sweep.air.co2_ppmv", "sweep.air.refraction",
      "condition.weather.profile_file_name", "condition.weather.modtran_file_name",
      "condition.warning"};
  const auto is_free = [&](const std::string& path) {
    for (const char* written_out :
         {"sweep.season.", "sweep.surroundings.", "sweep.viewpoints.", "sweep.precompute."}) {
      if (path.rfind(written_out, 0) == 0) return true;
    }
    return not_determining.contains(path);
  };
  const auto original = resolved_file(kExpandedExamples / "frigate.toml");
  ASSERT_TRUE(original.ok()) << original.status();
  schema::ResolvedSweep one_view = *original;
  // The frigate does without these fields.
  one_view.mutable_condition(0)->mutable_weather()->set_profile_csv("text");
  one_view.mutable_condition(0)->mutable_weather()->set_profile_file_name("sonde.csv");
  one_view.mutable_condition(0)->mutable_weather()->set_modtran_text("text");
  one_view.mutable_condition(0)->mutable_weather()->set_modtran_file_name("winter.tp7");
  one_view.mutable_condition(0)->add_warning("season[0].profile is odd");
  one_view.mutable_viewpoint()->DeleteSubrange(1, one_view.viewpoint_size() - 1);
  const std::string key = expand_jobs(one_view, 1)[0].job_key();
  schema::ResolvedSweep sweep = one_view;
  std::set<std::string> seen;
  with_each_scalar_changed(sweep, "", [&](const std::string& path) {
    seen.insert(path);
    const std::string changed_key = expand_jobs(sweep, 1)[0].job_key();
    EXPECT_EQ(changed_key == key, is_free(path)) << path;
  });
  EXPECT_EQ(canonical_encoding(sweep), canonical_encoding(one_view));  // everything was put back
  for (const char* path :
       {"condition.part_temperature_k", "condition.surroundings.sea_temperature_k",
        "condition.weather.profile_csv", "condition.weather.modtran_text", "condition.warning",
        "condition.weather.wind_speed_m_s", "sweep.air.model", "viewpoint.range_m",
        "sweep.band.step_um", "sweep.part.match", "sweep.seed", "condition.sun_irradiance_w_m2"}) {
    EXPECT_TRUE(seen.contains(path)) << path;
  }
}

// The golden sweep with two heat runs and all that a sweep can say of them.
schema::ResolvedSweep heated_sweep() {
  schema::ResolvedSweep sweep = golden_sweep();
  schema::Sweep& asked = *sweep.mutable_sweep();
  schema::BuildUp& wall = *asked.add_build_up();
  wall.set_name("wall");
  wall.set_inside("adiabatic");
  wall.add_layer()->set_thickness_m(0.01);
  asked.mutable_part(0)->set_build_up("wall");
  asked.mutable_part(0)->set_hot(false);
  asked.mutable_heat()->set_tolerance_k(0.01);
  asked.mutable_effects()->set_mode("auto");
  asked.mutable_place()->set_latitude_deg(50);
  for (const char* season : {"any", "other"}) {
    schema::HeatRun& run = *sweep.add_heat();
    run.set_season(season);
    run.add_time_utc("2025-06-21T12:00:00Z");
    schema::WeatherRecord& record = *run.mutable_course()->add_record();
    record.set_unix_s(1750507200);
    record.set_air_temperature_k(290 + sweep.heat_size());
    run.mutable_surroundings()->set_kind("none");
    run.mutable_weather()->set_profile_csv("text");
    run.mutable_weather()->set_profile_file_name("sonde.csv");
    run.add_part_temperature_k(0);
  }
  schema::ConditionField& from = *sweep.mutable_condition(0)->mutable_temperature_field();
  from.set_heat(0);
  from.add_part(0);
  return sweep;
}

TEST(ExpandJobs, ViewsNeedTheHeatJobsThatComeFirst) {
  const std::vector<schema::JobSpec> jobs = expand_jobs(heated_sweep(), 1);
  ASSERT_EQ(jobs.size(), 4U);
  EXPECT_EQ(jobs[0].heat().heat(), 0U);
  EXPECT_EQ(jobs[1].heat().heat(), 1U);
  EXPECT_NE(jobs[0].job_key(), jobs[1].job_key());
  for (const std::size_t view : {2, 3}) {
    EXPECT_TRUE(jobs[view].has_view());
    EXPECT_THAT(jobs[view].needs(), ElementsAre(jobs[0].job_key(), jobs[1].job_key()));
  }
  for (const schema::JobSpec& job : jobs)
    EXPECT_EQ(job.sweep_sha256(), sha256_hex(canonical_encoding(heated_sweep())));
  EXPECT_NE(expand_jobs(heated_sweep(), 2)[0].job_key(), jobs[0].job_key());
}

// Whatever is present in the sweep changes the key of a heat run, except what is listed here: a
// changed band or viewpoint does not compute its temperatures anew.
TEST(ExpandJobs, KeysOfHeatRunsChangeWithEveryDeterminingField) {
  const auto is_free = [](const std::string& path) {
    for (const char* prefix :
         {"viewpoint.", "condition.", "sweep.viewpoints.", "sweep.band.", "sweep.accuracy.",
          "sweep.effects.", "sweep.output.", "sweep.season.", "sweep.surroundings."})
      if (path.rfind(prefix, 0) == 0) return true;
    return std::set<std::string>{"sweep.name",
                                 "sweep.description",
                                 "sweep.time",
                                 "sweep.transport.job_size_vertices",
                                 "sweep.part.temperature_k",
                                 "sweep.part.hot",
                                 "heat.weather.profile_file_name",
                                 "heat.season"}
        .contains(path);
  };
  schema::ResolvedSweep sweep = heated_sweep();
  sweep.mutable_heat()->RemoveLast();
  const std::string key = expand_jobs(sweep, 1)[0].job_key();
  std::set<std::string> seen;
  with_each_scalar_changed(sweep, "", [&](const std::string& path) {
    seen.insert(path);
    EXPECT_EQ(expand_jobs(sweep, 1)[0].job_key() == key, is_free(path)) << path;
  });
  for (const char* path :
       {"heat.time_utc", "heat.course.record.air_temperature_k", "heat.weather.profile_csv",
        "heat.surroundings.kind", "sweep.build_up.layer.thickness_m", "sweep.heat.tolerance_k",
        "sweep.part.build_up", "sweep.material.emissivity", "sweep.seed", "sweep.model.triangles",
        "sweep.place.latitude_deg", "sweep.band.step_um", "viewpoint.range_m"})
    EXPECT_TRUE(seen.contains(path)) << path;
  schema::ResolvedSweep stated = sweep;
  stated.mutable_heat(0)->set_part_temperature_k(0, 300);
  EXPECT_NE(expand_jobs(stated, 1)[0].job_key(), key);
  schema::ResolvedSweep two = heated_sweep();
  EXPECT_EQ(expand_jobs(two, 1)[0].job_key(), key) << "another run does not matter";
}

TEST(ExpandJobs, KeysOfViewsCoverWhatTheyNeed) {
  const std::vector<schema::JobSpec> jobs = expand_jobs(heated_sweep(), 1);
  schema::ResolvedSweep warmer = heated_sweep();
  warmer.mutable_heat(1)->mutable_course()->mutable_record(0)->set_air_temperature_k(299);
  const std::vector<schema::JobSpec> changed = expand_jobs(warmer, 1);
  EXPECT_EQ(changed[0].job_key(), jobs[0].job_key());
  EXPECT_NE(changed[1].job_key(), jobs[1].job_key());
  EXPECT_NE(changed[2].job_key(), jobs[2].job_key());
  schema::ResolvedSweep renamed = heated_sweep();
  renamed.mutable_heat(0)->mutable_weather()->set_profile_file_name("sonde2.csv");
  EXPECT_EQ(expand_jobs(renamed, 1)[2].job_key(), jobs[2].job_key());
}

TEST(ExpandJobs, ARenamedModelFileKeepsTheKeysAndAnotherOneDoesNot) {
  const auto original = resolved_file(kExpandedExamples / "primitives.toml");
  ASSERT_TRUE(original.ok()) << original.status();
  const std::string key = expand_jobs(*original, 1)[0].job_key();
  schema::ResolvedSweep renamed = *original;
  renamed.mutable_sweep()->mutable_model()->set_file("elsewhere/p.OBJ");
  renamed.set_model_file_name("p.OBJ");
  EXPECT_EQ(expand_jobs(renamed, 1)[0].job_key(), key);
  schema::ResolvedSweep other = *original;
  other.set_model_sha256(sha256_hex("other"));
  EXPECT_NE(expand_jobs(other, 1)[0].job_key(), key);
}

// 4 hours x 2 seasons x 2 bands, all with the sun: each condition costs 0.25 tracing for the sun
// and 0.01 x 82 / 122 for its wavelengths: all eight 2.054.
schema::ResolvedSweep sixteen_rows(double job_size_in_tracings) {
  schema::ResolvedSweep sweep = golden_sweep();
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.clear_time();
  for (int i = 0; i < 4; ++i) asked.add_time("t" + std::to_string(i));
  *asked.add_season() = asked.season(0);
  *asked.add_band() = asked.band(0);
  const schema::Condition condition = sweep.condition(0);
  sweep.clear_condition();
  for (int i = 0; i < 8; ++i) {
    *sweep.add_condition() = condition;
    sweep.mutable_condition(i)->set_sun_irradiance_w_m2(1000);
  }
  asked.mutable_accuracy()->clear_relative_error();
  asked.mutable_accuracy()->set_target_paths(1e6);
  asked.mutable_transport()->set_max_reflections(3);  // tracing: 4e6 vertices
  asked.mutable_transport()->set_job_size_vertices(job_size_in_tracings * 4e6);
  return sweep;
}

std::vector<std::string> pieces_of_first_view(const schema::ResolvedSweep& sweep) {
  std::vector<std::string> pieces;
  for (const schema::JobSpec& job : expand_jobs(sweep, 1)) {
    if (job.view().viewpoint_index() != 0) continue;
    std::string text;
    for (const auto c : job.view().condition_index()) text += std::to_string(c);
    text += "/";
    for (const auto b : job.view().band_index()) text += std::to_string(b);
    pieces.push_back(text);
  }
  return pieces;
}

std::vector<std::string> pieces_of_first_view(double job_size_in_tracings) {
  return pieces_of_first_view(sixteen_rows(job_size_in_tracings));
}

TEST(ExpandJobs, CutsAlongTime) {
  EXPECT_THAT(pieces_of_first_view(3.06), ElementsAre("01234567/01"));
  EXPECT_THAT(pieces_of_first_view(3.05), ElementsAre("0145/01", "2367/01"));
}

// However small the target: pieces of up to one tracing of shading. Half of the hours are 1.027.
TEST(ExpandJobs, NeverCutsBelowTheCostOfTracing) {
  EXPECT_THAT(pieces_of_first_view(1e-9), ElementsAre("04/01", "15/01", "26/01", "37/01"));
  EXPECT_THAT(pieces_of_first_view(2.03), ElementsAre("0145/01", "2367/01"));
}

// One time and 200 seasons: 51.3 tracings of shading in pieces of at most 10, so 6 of 33 or 34
// seasons.
TEST(ExpandJobs, CutsAlongSeasonWhereTimeIsNotEnough) {
  schema::ResolvedSweep sweep = sixteen_rows(11);
  schema::Sweep& asked = *sweep.mutable_sweep();
  asked.mutable_time()->DeleteSubrange(1, 3);
  while (asked.season_size() < 200) *asked.add_season() = asked.season(0);
  while (sweep.condition_size() < 200) *sweep.add_condition() = sweep.condition(0);
  std::vector<int> sizes;
  for (const schema::JobSpec& job : expand_jobs(sweep, 1)) {
    if (job.view().viewpoint_index() == 0) sizes.push_back(job.view().condition_index_size());
    EXPECT_EQ(job.view().band_index_size(), 2);
  }
  EXPECT_THAT(sizes, ElementsAre(33, 33, 34, 33, 33, 34));
}

// 2 x 40001 wavelengths cost 6.56 tracings in each condition: time and season alone are not enough
// for 4.
TEST(ExpandJobs, CutsAlongBandLast) {
  schema::ResolvedSweep sweep = sixteen_rows(5);
  for (schema::Band& band : *sweep.mutable_sweep()->mutable_band()) band.set_step_um(1e-4);
  std::vector<std::string> pieces;
  for (const schema::JobSpec& job : expand_jobs(sweep, 1)) {
    if (job.view().viewpoint_index() != 0) continue;
    ASSERT_EQ(job.view().condition_index_size(), 1);
    ASSERT_EQ(job.view().band_index_size(), 1);
    pieces.push_back(std::to_string(job.view().condition_index(0)) + "/" +
                     std::to_string(job.view().band_index(0)));
  }
  ASSERT_EQ(pieces.size(), 16U);
  EXPECT_THAT(std::vector(pieces.begin(), pieces.begin() + 6),
              ElementsAre("0/0", "0/1", "4/0", "4/1", "1/0", "1/1"));
}

// Images of 16 MB a row, of which eight are 128 MB; of 128 MB, each alone.
TEST(ExpandJobs, CutsSoThatImagesFitIntoAResult) {
  schema::ResolvedSweep sweep = sixteen_rows(1e9);
  schema::Image& image = *sweep.mutable_sweep()->mutable_image();
  for (const std::uint32_t pixels : {1000, 1000}) image.add_pixels(pixels);
  for (const char* layer : {"sun", "at_sensor"}) image.add_layers(layer);
  EXPECT_THAT(pieces_of_first_view(sweep), ElementsAre("0145/01", "2367/01"));
  image.set_pixels(0, 4000);
  image.set_pixels(1, 2000);
  EXPECT_EQ(pieces_of_first_view(sweep).size(), 16U);
  sweep.mutable_sweep()->mutable_output()->set_thumbnail_px(0);  // as a pilot has it
  EXPECT_THAT(pieces_of_first_view(sweep), ElementsAre("01234567/01"));
}

TEST(ExpandJobs, PiecesCoverEveryRowOnceAndHaveTheirOwnKeys) {
  for (const double size : {1e-9, 2.1, 2.5, 3.0, 4.0}) {
    std::set<std::string> rows, keys;
    std::size_t count = 0;
    const auto jobs = expand_jobs(sixteen_rows(size), 1);
    for (const schema::JobSpec& job : jobs) {
      keys.insert(job.job_key());
      for (const auto c : job.view().condition_index()) {
        for (const auto b : job.view().band_index()) {
          rows.insert(std::to_string(job.view().viewpoint_index()) + "," + std::to_string(c) + "," +
                      std::to_string(b));
          ++count;
        }
      }
    }
    EXPECT_EQ(rows.size(), 2U * 8 * 2);
    EXPECT_EQ(count, rows.size());
    EXPECT_EQ(keys.size(), jobs.size());
  }
}

}  // namespace
}  // namespace irsig
