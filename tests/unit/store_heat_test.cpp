// Heat jobs in the store: what they leave is an asset, which views need, and a table for people.

#include <gmock/gmock.h>

#include "schema/store/tables/sha256.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class StoreHeat : public ::testing::Test {
 protected:
  void SetUp() override {
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    writer_ = *std::move(writer);
    ASSERT_OK(submit_heat(sweep_, "sweep-a").status());
  }
  absl::StatusOr<AddedJobs> submit_heat(const schema::ResolvedSweep& sweep,
                                        const std::string& sha256,
                                        const std::string& build_up = "steel") {
    if (auto status = writer_->begin(); !status.ok()) return status;
    auto added = writer_->add_sweep(sweep, sha256, make_heat_jobs(sweep, sha256, build_up), {});
    if (!added.ok()) {
      writer_->rollback();
      return added;
    }
    if (auto status = writer_->commit(); !status.ok()) return status;
    return added;
  }
  QueuedJob lease() {
    const auto job = writer_->lease_next("w", 100);
    EXPECT_TRUE(job.ok()) << job.status();
    EXPECT_TRUE(job->has_value());
    return job.ok() && job->has_value() ? **job : QueuedJob{};
  }
  // Leases and completes what is left; how many jobs that was.
  int finish(const schema::ResolvedSweep& sweep, float kelvin = 300) {
    EXPECT_TRUE(writer_->begin().ok());
    int done = 0;
    for (;; ++done) {
      const auto job = writer_->lease_next("w", 100);
      EXPECT_TRUE(job.ok()) << job.status();
      if (!job->has_value()) break;
      const schema::JobSpec& spec = (*job)->spec;
      const auto status = writer_->complete(
          (*job)->fencing_token,
          spec.has_heat() ? make_heat_result(sweep, spec, kelvin) : make_result(sweep, spec), "h");
      EXPECT_TRUE(status.ok()) << status;
      if (!status.ok()) break;
    }
    EXPECT_TRUE(writer_->commit().ok());
    return done;
  }
  SweepProgress progress() { return writer_->progress().value().front(); }
  std::vector<StoredTemperature> table() {
    return StoreReader::open(path_).value()->computed_temperatures({}).value();
  }
  std::string digest() { return StoreReader::open(path_).value()->digest().value(); }
  std::string text(const std::string& statement) { return sqlite_text(path_, statement); }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = with_heat(make_sweep({}));
  std::unique_ptr<StoreWriter> writer_;
};

TEST_F(StoreHeat, ViewsAreLeasedWithWhatTheHeatJobsLeft) {
  EXPECT_EQ(progress().jobs, 6U);
  EXPECT_EQ(progress().heat_jobs, 2U);
  ASSERT_OK(writer_->begin());
  const QueuedJob winter = lease(), summer = lease();
  EXPECT_EQ(winter.spec.heat().heat(), 0U);
  EXPECT_EQ(summer.spec.heat().heat(), 1U);
  EXPECT_TRUE(winter.output.empty());
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value()) << "views wait for both";
  const auto of_winter = make_heat_result(sweep_, winter.spec, 270),
             of_summer = make_heat_result(sweep_, summer.spec, 300);
  ASSERT_OK(writer_->complete(summer.fencing_token, of_summer, "h"));
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value());
  EXPECT_EQ(progress().heat_done, 1U);
  ASSERT_OK(writer_->complete(winter.fencing_token, of_winter, "h"));
  const QueuedJob view = lease();
  ASSERT_TRUE(view.spec.has_view());
  EXPECT_THAT(view.spec.needs(), ElementsAre(winter.spec.job_key(), summer.spec.job_key()));
  const std::string first = sha256_of(of_winter.heat().field()),
                    second = sha256_of(of_summer.heat().field());
  EXPECT_THAT(view.output, ElementsAre(first, second));
  EXPECT_EQ(writer_->asset(first).value(), of_winter.heat().field());
  EXPECT_EQ(writer_->asset(second).value(), of_summer.heat().field());
}

TEST_F(StoreHeat, WhatItCameToForEachPartIsATable) {
  EXPECT_TRUE(StoreReader::open(path_).value()->sweep("ship").value().heat.empty());
  EXPECT_EQ(finish(sweep_), 6);
  const auto rows = table();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].sweep, "ship");
  EXPECT_EQ(rows[0].season, "winter");
  EXPECT_EQ(rows[1].season, "summer");
  EXPECT_EQ(rows[0].time_utc, "2025-06-21T01:30:00Z");
  EXPECT_EQ(rows[0].part, "part0");
  EXPECT_EQ(rows[0].mean_k, 301);
  EXPECT_EQ(rows[0].coldest_k, 300);
  EXPECT_EQ(rows[0].hottest_k, 302);
  EXPECT_EQ(rows[0].error_k, 1);
  EXPECT_FALSE(rows[0].superseded);
  auto reader = StoreReader::open(path_).value();
  EXPECT_EQ(reader->computed_temperatures({.sweep = "", .season = "summer", .time_utc = ""})
                .value()
                .size(),
            1U);
  const auto jobs = reader->heat_jobs("ship").value();
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_TRUE(jobs[0].done);
  EXPECT_EQ(jobs[0].cpu_s, 0.5);
  EXPECT_EQ(jobs[0].warning, "the weather of winter is odd");
  const StoredSweep stored = reader->sweep("ship").value();
  ASSERT_EQ(stored.heat.size(), 2U);
  EXPECT_EQ(stored.heat[0], make_heat_result(sweep_, make_heat_jobs(sweep_, "")[0]).heat().field());
  EXPECT_EQ(reader->job_costs("ship").value().size(), 4U) << "views only";
  EXPECT_EQ(text("SELECT count(*) FROM pragma_foreign_key_check()"), "0");
  EXPECT_EQ(text("SELECT count(*) FROM part_temperature"), "2") << "part 1 in two conditions";
  EXPECT_EQ(text("SELECT temperature_field FROM condition"), "computed");
}

TEST_F(StoreHeat, TheDigestCoversFieldsAndTable) {
  const std::string before = digest();
  EXPECT_EQ(finish(sweep_), 6);
  const std::string done = digest();
  EXPECT_NE(done, before);
  ASSERT_EQ(text("UPDATE computed_temperature SET error_k = 2; SELECT 'x'"), "x");
  const std::string changed = digest();
  EXPECT_NE(changed, done);
  ASSERT_EQ(text("UPDATE computed_temperature SET error_k = 1; SELECT 'x'"), "x");
  EXPECT_EQ(digest(), done);
  ASSERT_EQ(text("INSERT INTO asset VALUES ('other', x'00'); UPDATE heat_job SET output_sha256 = "
                 "'other' WHERE season = 'winter'; SELECT 'x'"),
            "x");
  EXPECT_NE(digest(), done);
}

TEST_F(StoreHeat, ASecondResultIsRefused) {
  ASSERT_OK(writer_->begin());
  const QueuedJob job = lease();
  ASSERT_OK(writer_->complete(job.fencing_token, make_heat_result(sweep_, job.spec), "h"));
  EXPECT_TRUE(absl::IsFailedPrecondition(
      writer_->complete(job.fencing_token, make_heat_result(sweep_, job.spec, 310), "h")));
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(table().front().coldest_k, 300);
}

TEST_F(StoreHeat, ResultsAreHeldAgainstTheirRun) {
  ASSERT_OK(writer_->begin());
  const QueuedJob job = lease();
  const auto refused = [&](const std::function<void(schema::JobResult&, schema::HeatField&)>& spoil,
                           const std::string& why) {
    schema::JobResult result = make_heat_result(sweep_, job.spec);
    schema::HeatField field;
    ASSERT_TRUE(field.ParseFromString(result.heat().field()));
    spoil(result, field);
    if (result.has_heat() && result.heat().field() != "rubbish")
      result.mutable_heat()->set_field(field.SerializeAsString());
    const absl::Status status = writer_->complete(job.fencing_token, result, "h");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status << ", expected " << why;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  };
  const auto put = [](std::string& bytes, std::size_t at, float value) {
    std::memcpy(bytes.data() + 4 * at, &value, 4);
  };
  refused([](auto& r, auto&) { r.set_job_key("other"); }, "job_key is other");
  refused([](auto& r, auto&) { r.set_seed_hex("0000000000000001"); },
          "seed_hex is 0000000000000001, expected that of the sweep, 0000000000000000");
  refused([](auto& r, auto&) { r.set_seed_hex("0"); }, "seed_hex is not of 16 hexadecimal");
  refused([](auto& r, auto&) { r.mutable_view(); }, "kind is not the job's");
  refused([](auto& r, auto&) { r.mutable_heat()->set_field("rubbish"); }, "field cannot be read");
  refused([](auto&, auto& f) { f.set_unix_s(0, 1750469401); }, "field.unix_s[0] is not the time");
  refused([](auto&, auto& f) { f.add_unix_s(1750473000); }, "has 2 of the 1 times");
  refused([](auto&, auto& f) { f.set_facets(4); }, "field.kelvin has 12 bytes");
  refused([](auto&, auto& f) { f.mutable_error_k()->pop_back(); }, "field.error_k has 11 bytes");
  refused([&](auto&, auto& f) { put(*f.mutable_kelvin(), 1, INFINITY); }, "field.kelvin[1] is inf");
  refused([&](auto&, auto& f) { put(*f.mutable_kelvin(), 0, -3); }, "field.kelvin[0] is -3");
  refused([&](auto&, auto& f) { put(*f.mutable_kelvin(), 2, 300); }, "field.error_k[2] is nan");
  refused([&](auto&, auto& f) { put(*f.mutable_error_k(), 0, -1); }, "field.error_k[0] is -1");
  refused([](auto& r, auto&) { r.mutable_heat()->clear_part(); }, "part is missing for part 0");
  refused([](auto& r, auto&) { *r.mutable_heat()->add_part() = r.heat().part(0); }, "comes twice");
  refused([](auto& r, auto&) { r.mutable_heat()->mutable_part(0)->set_part_index(1); },
          "was not asked for");
  refused([](auto& r, auto&) { r.mutable_heat()->mutable_part(0)->set_mean_k(299); },
          "has a coldest, mean and hottest temperature");
  refused([](auto& r, auto&) { r.mutable_heat()->mutable_part(0)->set_error_k(-1); },
          "error_k is negative");
  refused([](auto& r, auto&) { r.mutable_heat()->set_warning(0, "a\nb"); }, "control characters");
  EXPECT_EQ(text("SELECT count(*) FROM asset"), "0");
  ASSERT_OK(writer_->complete(job.fencing_token, make_heat_result(sweep_, job.spec), "h"));
}

TEST_F(StoreHeat, AnotherBandKeepsTheTemperatures) {
  EXPECT_EQ(finish(sweep_), 6);
  SweepShape shape;
  shape.bands.emplace_back("nir");
  const schema::ResolvedSweep more = with_heat(make_sweep(shape));
  EXPECT_EQ(submit_heat(more, "sweep-b")->to_compute, 4U);
  EXPECT_EQ(progress().heat_done, 2U);
  ASSERT_OK(writer_->begin());
  const QueuedJob view = lease();
  EXPECT_EQ(view.output.size(), 2U) << "what was computed before";
  EXPECT_EQ(writer_->asset(view.output[0]).value().empty(), false);
}

TEST_F(StoreHeat, StaleTemperaturesStayUntilTheirReplacementIsStored) {
  EXPECT_EQ(finish(sweep_), 6);
  EXPECT_EQ(submit_heat(sweep_, "sweep-b", "wood")->to_compute, 6U);
  ASSERT_EQ(table().size(), 2U);
  EXPECT_TRUE(table()[0].superseded);
  EXPECT_TRUE(StoreReader::open(path_).value()->sweep("ship").value().heat.empty());
  ASSERT_OK(writer_->begin());
  const QueuedJob winter = lease();
  ASSERT_OK(
      writer_->complete(winter.fencing_token, make_heat_result(sweep_, winter.spec, 310), "h"));
  ASSERT_OK(writer_->commit());
  ASSERT_EQ(table().size(), 2U);
  EXPECT_FALSE(table()[0].superseded);
  EXPECT_EQ(table()[0].coldest_k, 310);
  EXPECT_TRUE(table()[1].superseded);
  EXPECT_EQ(finish(sweep_, 320), 5);
  ASSERT_EQ(table().size(), 2U);
  EXPECT_EQ(table()[1].coldest_k, 320);
  EXPECT_EQ(text("SELECT count(*) FROM asset"), "2") << "those of before are gone";
  EXPECT_EQ(text("SELECT count(*) FROM pragma_foreign_key_check()"), "0");
}

TEST_F(StoreHeat, TemperaturesOfTheSameKeyAreTakenOverFromAnotherSweep) {
  EXPECT_EQ(finish(sweep_), 6);
  schema::ResolvedSweep other = sweep_;
  other.mutable_sweep()->set_name("other");
  EXPECT_EQ(submit_heat(other, "sweep-b")->to_compute, 6U);
  ASSERT_OK(writer_->begin());
  const QueuedJob winter = lease();
  EXPECT_FALSE(writer_->take_over(winter.fencing_token, "another class").value());
  EXPECT_TRUE(writer_->take_over(winter.fencing_token, "test-class").value());
  EXPECT_TRUE(
      absl::IsFailedPrecondition(writer_->take_over(winter.fencing_token, "test-class").status()));
  EXPECT_TRUE(writer_->take_over(lease().fencing_token, "test-class").value());
  const QueuedJob view = lease();
  ASSERT_TRUE(view.spec.has_view());
  EXPECT_FALSE(writer_->take_over(view.fencing_token, "test-class").value());
  EXPECT_EQ(view.output.size(), 2U);
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(text("SELECT count(*) FROM asset"), "1") << "all four have left the same field";
  auto reader = StoreReader::open(path_).value();
  TemperatureFilter filter;
  filter.sweep = "other";
  const auto rows = reader->computed_temperatures(filter).value();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].hottest_k, 302);
  EXPECT_EQ(reader->heat_jobs("other").value()[0].cpu_s, 0);
  EXPECT_EQ(reader->sweep("other").value().heat, reader->sweep("ship").value().heat);
  // The first sweep goes its way: what both have left stays.
  ASSERT_OK(submit(*writer_, make_sweep({}), "sweep-c").status());
  EXPECT_EQ(text("SELECT count(*) FROM asset"), "1");
  EXPECT_EQ(text("SELECT count(*) FROM pragma_foreign_key_check()"), "0");
}

TEST_F(StoreHeat, SeasonsMayShareARunAndWriteItsTimesTheirOwnWay) {
  schema::ResolvedSweep shared = sweep_;
  shared.mutable_heat()->RemoveLast();
  shared.mutable_heat(0)->set_time_utc(0, "2025-06-21T01:30:00.0000000Z");
  shared.mutable_condition(1)->mutable_temperature_field()->set_heat(0);
  ASSERT_OK(submit_heat(shared, "sweep-b").status());
  EXPECT_EQ(finish(shared), 5);
  const auto rows = table();
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].season, "winter");
  EXPECT_EQ(rows[1].season, "summer");
  EXPECT_EQ(rows[1].time_utc, "2025-06-21T01:30:00Z");
  EXPECT_EQ(rows[1].job_key, rows[0].job_key);
}

TEST_F(StoreHeat, WhatNobodyReplacesGoesAtOnce) {
  EXPECT_EQ(finish(sweep_), 6);
  ASSERT_OK(submit(*writer_, make_sweep({}), "sweep-b").status());  // all temperatures stated
  EXPECT_TRUE(table().empty());
  EXPECT_EQ(text("SELECT count(*) FROM asset"), "0");
  EXPECT_EQ(text("SELECT count(*) FROM heat_job"), "0");
  EXPECT_EQ(progress().heat_jobs, 0U);
}

// A version in between had only one of the times: what it removed is computed again.
TEST_F(StoreHeat, ATimeThatWentAndCameBackIsComputedAgain) {
  schema::ResolvedSweep two = sweep_;
  for (int c = 0; c < 2; ++c) {
    schema::Condition later = two.condition(c);
    later.set_time_utc("2025-06-21T02:30:00Z");
    *two.add_condition() = later;
    two.mutable_heat(c)->add_time_utc("2025-06-21T02:30:00Z");
  }
  ASSERT_OK(submit_heat(two, "sweep-b").status());
  EXPECT_EQ(finish(two), 6);
  ASSERT_EQ(table().size(), 4U);
  EXPECT_EQ(submit_heat(sweep_, "sweep-c")->to_compute, 6U);
  EXPECT_EQ(table().size(), 2U);
  EXPECT_EQ(submit_heat(two, "sweep-d")->to_compute, 6U);
  EXPECT_EQ(finish(two), 6);
  EXPECT_EQ(table().size(), 4U);
}

TEST_F(StoreHeat, AViewWithoutTemperaturesIsGivenUpWithTheReason) {
  ASSERT_OK(writer_->begin());
  const QueuedJob winter = lease(), summer = lease();
  ASSERT_OK(writer_->complete(summer.fencing_token, make_heat_result(sweep_, summer.spec), "h"));
  std::uint64_t token = winter.fencing_token;
  for (const char* worker : {"a", "b", "c"}) {
    ASSERT_OK(writer_->fail(token, worker, "no steady state"));
    if (std::string(worker) != "c") token = lease().fencing_token;
  }
  EXPECT_EQ(progress().waiting, 0U) << "a farm would wait for ever";
  EXPECT_EQ(progress().quarantined, 5U);
  EXPECT_THAT(progress().failures,
              ElementsAre("job 0 (temperatures of \"winter\") on c: no steady state",
                          "4 jobs (2 to 5): need job 0, which was given up"));
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(submit_heat(sweep_, "sweep-a")->to_compute, 5U) << "summer stays";
  EXPECT_EQ(finish(sweep_), 5);
}

TEST_F(StoreHeat, SweepsWhoseJobsDoNotFitTheirRunsAreRefused) {
  using Jobs = std::vector<schema::JobSpec>;
  const auto refused = [&](const std::function<void(schema::ResolvedSweep&, Jobs&)>& spoil,
                           const std::string& why) {
    schema::ResolvedSweep sweep = sweep_;
    sweep.mutable_sweep()->set_name("other");
    Jobs jobs = make_heat_jobs(sweep, "x");
    spoil(sweep, jobs);
    ASSERT_OK(writer_->begin());
    const absl::Status status = writer_->add_sweep(sweep, "x", jobs, {}).status();
    writer_->rollback();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status << ", expected " << why;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  };
  refused([](auto&, auto& j) { j[2].clear_needs(); }, "does not need the sweep's 2 heat jobs");
  refused([](auto&, auto& j) { j[2].mutable_needs()->SwapElements(0, 1); }, "does not need");
  refused([](auto&, auto& j) { std::swap(j[0], j[1]); }, "out of order");
  refused([](auto&, auto& j) { j[1].add_needs(j[0].job_key()); }, "or needs another job");
  refused([](auto& s, auto&) { s.mutable_heat(0)->clear_time_utc(); }, "has no times");
  refused([](auto& s, auto&) { s.mutable_heat(0)->set_part_temperature_k(0, 280); },
          "has nothing to compute");
  refused([](auto& s, auto&) { s.mutable_heat(0)->add_part_temperature_k(280); },
          "has 3 temperatures for 2 parts");
  refused([](auto& s, auto&) { s.mutable_heat(0)->set_season("a\nb"); }, "control characters");
  refused([](auto& s, auto&) { s.mutable_condition(0)->mutable_temperature_field()->set_heat(2); },
          "heat run 2 of 2");
  refused(
      [](auto& s, auto&) { s.mutable_condition(0)->mutable_temperature_field()->set_part(0, 1); },
      "which its heat run does not compute");
  refused([](auto& s, auto&) { s.mutable_heat(0)->set_time_utc(0, "2025-06-21T01:31:00Z"); },
          "is no time of its heat run");
}

// Two materials of land, the first of which every run computes.
schema::ResolvedSweep with_land(schema::ResolvedSweep sweep) {
  for (const char* name : {"grass", "asphalt"})
    sweep.mutable_sweep()->mutable_land()->add_material()->set_material(name);
  for (schema::HeatRun& run : *sweep.mutable_heat())
    for (const double kelvin : {0, 280}) run.add_land_temperature_k(kelvin);
  for (schema::Condition& c : *sweep.mutable_condition()) {
    c.set_land_heat(c.temperature_field().heat());
    for (const double kelvin : {0, 280}) c.add_land_temperature_k(kelvin);
  }
  return sweep;
}

TEST_F(StoreHeat, LandIsHeldAgainstItsRun) {
  schema::ResolvedSweep sweep = with_land(sweep_);
  sweep.mutable_sweep()->set_name("on land");
  ASSERT_OK(submit_heat(sweep, "sweep-b", "ground").status());
  ASSERT_OK(writer_->begin());
  QueuedJob job = lease();
  while (job.spec.job_key() != make_heat_jobs(sweep, "sweep-b", "ground")[0].job_key())
    job = lease();
  const auto result_with = [&](const std::function<void(schema::HeatField&)>& spoil) {
    schema::JobResult result = make_heat_result(sweep, job.spec);
    schema::HeatField field;
    EXPECT_TRUE(field.ParseFromString(result.heat().field()));
    const auto append = [](std::string& bytes, std::initializer_list<float> values) {
      for (const float value : values)
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    append(*field.mutable_land()->mutable_kelvin(), {290, 291, 280});
    append(*field.mutable_land()->mutable_error_k(), {0.1F, 0.2F, 0});
    append(*field.mutable_land()->mutable_interpolation_k(), {0.1F, NAN});
    spoil(field);
    result.mutable_heat()->set_field(field.SerializeAsString());
    return result;
  };
  const auto put = [](std::string& bytes, std::size_t at, float value) {
    std::memcpy(bytes.data() + 4 * at, &value, 4);
  };
  const std::pair<const char*, std::function<void(schema::HeatField&)>> spoils[] = {
      {"field.land is missing", [](auto& f) { f.clear_land(); }},
      {"field.land.kelvin and error_k have 0 and 12 bytes",
       [](auto& f) { f.mutable_land()->clear_kelvin(); }},
      {"field.land.kelvin and error_k have 12 and 11 bytes",
       [](auto& f) { f.mutable_land()->mutable_error_k()->pop_back(); }},
      {"field.land.interpolation_k has 0 bytes for 1 times and 2 materials",
       [](auto& f) { f.mutable_land()->clear_interpolation_k(); }},
      {"field.land.kelvin[1] is nan",
       [&](auto& f) { put(*f.mutable_land()->mutable_kelvin(), 1, NAN); }},
      {"field.land.error_k[0] is -1",
       [&](auto& f) { put(*f.mutable_land()->mutable_error_k(), 0, -1); }},
  };
  for (const auto& [why, spoil] : spoils) {
    const absl::Status status = writer_->complete(job.fencing_token, result_with(spoil), "h");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status << ", expected " << why;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why));
  }
  ASSERT_OK(writer_->complete(job.fencing_token, result_with([](auto&) {}), "h"));
}

TEST_F(StoreHeat, ConditionsNameRunsThatComputeTheirLand) {
  const auto refused = [&](const std::function<void(schema::ResolvedSweep&)>& spoil,
                           const std::string& why) {
    schema::ResolvedSweep sweep = with_land(sweep_);
    sweep.mutable_sweep()->set_name("other");
    spoil(sweep);
    ASSERT_OK(writer_->begin());
    const absl::Status status =
        writer_->add_sweep(sweep, "x", make_heat_jobs(sweep, "x"), {}).status();
    writer_->rollback();
    EXPECT_THAT(std::string(status.message()), HasSubstr(why)) << status;
  };
  refused([](auto& s) { s.mutable_condition(0)->set_land_heat(2); }, "the land of heat run 2 of 2");
  refused([](auto& s) { s.mutable_heat(0)->set_land_temperature_k(0, 280); },
          "is no time of the heat run of its land");
  refused([](auto& s) { s.mutable_heat(0)->add_land_temperature_k(280); },
          "has 3 temperatures for 2 materials of the land");
  // A run may compute land alone.
  schema::ResolvedSweep alone = with_land(sweep_);
  alone.mutable_sweep()->set_name("alone");
  for (schema::HeatRun& run : *alone.mutable_heat()) run.set_part_temperature_k(0, 290);
  for (schema::Condition& c : *alone.mutable_condition()) c.clear_temperature_field();
  ASSERT_OK(submit_heat(alone, "y", "other ground").status());
}

}  // namespace
}  // namespace irsig
