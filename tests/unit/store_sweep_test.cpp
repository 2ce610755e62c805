// A sweep that is submitted again: what is done stays, what is stale is replaced in one
// transaction.

#include "schema/store/tables/sha256.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

class StoreSweep : public ::testing::Test {
 protected:
  void SetUp() override { writer_ = StoreWriter::open(path_).value(); }

  AddedJobs add(const SweepShape& shape, const std::string& sha256) {
    const auto added = submit(*writer_, make_sweep(shape), sha256);
    EXPECT_TRUE(added.ok()) << added.status();
    return *added;
  }
  void complete(const SweepShape& shape, int most = 1 << 30) {
    const auto done = complete_jobs(*writer_, make_sweep(shape), most, shape.wavelengths);
    EXPECT_TRUE(done.ok()) << done.status();
  }
  std::vector<StoredSignature> all() { return StoreReader::open(path_).value()->find({}).value(); }
  std::string digest() { return StoreReader::open(path_).value()->digest().value(); }
  // Returns the digest of a database that was never anything else.
  static std::string digest_of_fresh(const SweepShape& shape) {
    const TestFolder folder;
    const std::string path = folder.file("fresh.sigdb");
    auto writer = StoreWriter::open(path).value();
    const auto sweep = make_sweep(shape);
    EXPECT_TRUE(submit(*writer, sweep, "fresh").ok());
    EXPECT_TRUE(complete_jobs(*writer, sweep, 1 << 30, shape.wavelengths).ok());
    return StoreReader::open(path).value()->digest().value();
  }
  void expect_sound() {
    EXPECT_EQ(sqlite_text(path_, "PRAGMA foreign_key_check"), "(no row)");
    EXPECT_EQ(sqlite_text(path_, "PRAGMA integrity_check"), "ok");
    EXPECT_EQ(
        sqlite_text(path_, "SELECT count(*) - count(DISTINCT sweep || row) FROM signature_view"),
        "0");
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  std::unique_ptr<StoreWriter> writer_;
};

TEST_F(StoreSweep, TheSameAgainComputesNothing) {
  EXPECT_EQ(add({}, "a").to_compute, 4U);
  complete({}, 3);
  const auto again = add({}, "a");
  EXPECT_EQ(again.jobs, 4U);
  EXPECT_EQ(again.to_compute, 1U);
  complete({});
  const std::string before = digest();
  EXPECT_EQ(add({}, "a").to_compute, 0U);
  EXPECT_EQ(digest(), before);
}

// Words about a condition are not what it is; its weather is.
TEST_F(StoreSweep, AnotherWarningKeepsResultsAndAnotherWeatherDoesNot) {
  add({}, "a");
  complete({});
  schema::ResolvedSweep sweep = make_sweep({});
  sweep.mutable_condition(0)->clear_warning();
  sweep.mutable_condition(0)->add_warning("in other words");
  EXPECT_EQ(submit(*writer_, sweep, "b")->to_compute, 0U);
  EXPECT_EQ(all().front().warning, "in other words");
  for (int i = 0; i < sweep.condition_size(); ++i) {
    schema::Weather& weather = *sweep.mutable_condition(i)->mutable_weather();
    weather.set_profile("tropical");
    weather.set_profile_csv("height_m,temperature_k");
    weather.set_wind_speed_m_s(5.5);
  }
  EXPECT_EQ(submit(*writer_, sweep, "c")->to_compute, 4U);
  const std::string weather =
      sqlite_text(path_, "SELECT weather FROM condition WHERE superseded = 0");
  EXPECT_NE(weather.find("\"wind_speed_m_s\":5.5"), std::string::npos) << weather;
  EXPECT_NE(weather.find(sha256_of("height_m,temperature_k")), std::string::npos) << weather;
  EXPECT_FALSE(all().empty());
  for (const StoredSignature& s : all()) EXPECT_TRUE(s.superseded);
  expect_sound();
}

TEST_F(StoreSweep, MoreAndReorderedViewpointsKeepTheirResults) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.aspects = {{33, 3}, {270, -5}, {0, 0}, {44, 4}, {180, 45}, {90, 10}};
  EXPECT_EQ(add(shape, "b").to_compute, 2U);
  const auto found = all();
  ASSERT_EQ(found.size(), 16U);
  // Rows are those of the new list.
  EXPECT_EQ(found.front().row, 5U);
  EXPECT_EQ(found.front().aspect_azimuth_deg, 270);
  EXPECT_EQ(found.back().row, 24U);
  EXPECT_EQ(found.back().aspect_azimuth_deg, 90);
  complete(shape);
  EXPECT_EQ(digest(), digest_of_fresh(shape));
  expect_sound();
}

TEST_F(StoreSweep, AGoneViewpointGoesAtOnce) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.aspects = {{180, 45}, {0, 0}};
  EXPECT_EQ(add(shape, "b").to_compute, 0U);
  EXPECT_EQ(all().size(), 8U);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM viewpoint_direction"), "2");
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM spectrum"), "8");
  EXPECT_EQ(digest(), digest_of_fresh(shape));
  expect_sound();
}

TEST_F(StoreSweep, ANewSeasonReplacesViewByView) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.seasons = {"winter", "spring", "summer"};
  EXPECT_EQ(add(shape, "b").to_compute, 4U);
  // The old rows stay readable, at their places in the new sweep.
  auto found = all();
  ASSERT_EQ(found.size(), 16U);
  EXPECT_EQ(found[0].season, "winter");
  EXPECT_EQ(found[0].row, 1U);
  EXPECT_EQ(found[2].season, "summer");
  EXPECT_EQ(found[2].row, 5U);
  const std::string old_key = found[0].job_key;
  complete(shape, 1);
  found = all();
  ASSERT_EQ(found.size(), 18U);
  EXPECT_NE(found[0].job_key, old_key);
  EXPECT_EQ(found[5].row, 6U);
  EXPECT_EQ(found[6].row, 7U);
  expect_sound();
  complete(shape);
  EXPECT_EQ(all().size(), 24U);
  EXPECT_EQ(digest(), digest_of_fresh(shape));
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM job"), "4") << "superseded jobs are gone";
  expect_sound();
}

TEST_F(StoreSweep, AChangedTemperatureKeepsTheOldDefinitionUntilReplaced) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.hull_temperature_k = 295;
  EXPECT_EQ(add(shape, "b").to_compute, 4U);
  EXPECT_EQ(all().size(), 16U);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM condition"), "4");
  complete(shape, 3);
  expect_sound();
  EXPECT_EQ(sqlite_text(path_, "SELECT min(temperature_k) FROM part_temperature"), "290.0");
  complete(shape);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM condition"), "2");
  EXPECT_EQ(sqlite_text(path_, "SELECT min(temperature_k) FROM part_temperature"), "295.0");
  EXPECT_EQ(digest(), digest_of_fresh(shape));
}

TEST_F(StoreSweep, AFinerBandHasItsOwnWavelengths) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.wavelengths = 9;
  EXPECT_EQ(add(shape, "b").to_compute, 4U);
  complete(shape, 1);
  auto reader = StoreReader::open(path_).value();
  const auto found = reader->find({}).value();
  EXPECT_EQ(reader->spectrum(found.front().signature_id)->lambda_um_size(), 9);
  EXPECT_EQ(reader->spectrum(found.back().signature_id)->lambda_um_size(), 5);
  reader.reset();
  complete(shape);
  EXPECT_EQ(digest(), digest_of_fresh(shape));
}

TEST_F(StoreSweep, AGoneSeasonBandOrPartGoes) {
  add({}, "a");
  complete({});
  SweepShape shape;
  shape.seasons = {"summer"};
  shape.bands = {"lwir"};
  shape.parts = 1;
  EXPECT_EQ(add(shape, "b").to_compute, 4U);
  EXPECT_EQ(all().size(), 4U) << "summer lwir has a place in the new sweep, the rest has none";
  complete(shape);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM part"), "1");
  EXPECT_EQ(digest(), digest_of_fresh(shape));
  expect_sound();
}

TEST_F(StoreSweep, BackAndForthRecomputesOnlyWhatWasReplaced) {
  SweepShape warm;
  warm.hull_temperature_k = 295;
  add({}, "a");
  complete({});
  add(warm, "b");
  complete(warm, 1);
  EXPECT_EQ(add({}, "a").to_compute, 1U);
  complete({});
  EXPECT_EQ(digest(), digest_of_fresh({}));
  expect_sound();
}

TEST_F(StoreSweep, ALeaseOfAGoneJobIsRevoked) {
  add({}, "a");
  ASSERT_OK(writer_->begin());
  const QueuedJob job = writer_->lease_next("w", 0).value().value();
  ASSERT_OK(writer_->commit());
  SweepShape shape;
  shape.hull_temperature_k = 300;
  add(shape, "b");
  ASSERT_OK(writer_->begin());
  EXPECT_TRUE(absl::IsFailedPrecondition(
      writer_->complete(job.fencing_token, make_result(make_sweep({}), job.spec), "w")));
  writer_->rollback();
}

TEST_F(StoreSweep, TwoSweepsShareAFile) {
  SweepShape other;
  other.name = "boat";
  other.parts = 1;
  add({}, "a");
  add(other, "b");
  complete({}, 4);
  complete(other, 4);
  EXPECT_EQ(all().size(), 32U);
  SignatureFilter filter;
  filter.sweep = "boat";
  filter.row = 3;
  const auto found = StoreReader::open(path_).value()->find(filter).value();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].sweep, "boat");
  EXPECT_EQ(writer_->progress()->size(), 2U);
  expect_sound();
}

TEST_F(StoreSweep, AssetsAreStoredByHash) {
  schema::ResolvedSweep sweep = make_sweep({});
  const std::string model = "a mesh";
  sweep.set_model_sha256(sha256_of(model));
  EXPECT_TRUE(absl::IsInvalidArgument(submit(*writer_, sweep, "a").status()))
      << "the model is missing";
  EXPECT_TRUE(writer_->progress()->empty());
  ASSERT_OK(writer_->begin());
  EXPECT_TRUE(absl::IsInvalidArgument(
      writer_->add_sweep(sweep, "a", make_jobs(sweep, "a"), {{sweep.model_sha256(), "other bytes"}})
          .status()));
  ASSERT_OK(writer_->add_sweep(sweep, "a", make_jobs(sweep, "a"), {{sweep.model_sha256(), model}})
                .status());
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(writer_->asset(sweep.model_sha256()).value(), model);
  schema::ResolvedSweep stored;
  ASSERT_TRUE(stored.ParseFromString(writer_->asset("a").value()));
  EXPECT_EQ(stored.SerializeAsString(), sweep.SerializeAsString());
  EXPECT_TRUE(absl::IsNotFound(writer_->asset("unknown").status()));
  // The next version needs another model: the first one goes.
  add({}, "b");
  EXPECT_TRUE(absl::IsNotFound(writer_->asset(sweep.model_sha256()).status()));
}

TEST_F(StoreSweep, SweepsThatCannotBeStoredAreRefused) {
  const schema::ResolvedSweep sound = make_sweep({});
  const auto refused =
      [&](const std::function<void(schema::ResolvedSweep&, std::vector<schema::JobSpec>&)>& damage,
          const std::string& message) {
        schema::ResolvedSweep sweep = sound;
        auto jobs = make_jobs(sound, "a");
        damage(sweep, jobs);
        ASSERT_OK(writer_->begin());
        const auto status = writer_->add_sweep(sweep, "a", jobs, {}).status();
        EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
        EXPECT_NE(status.message().find(message), absl::string_view::npos) << status;
        writer_->rollback();
      };
  refused([](auto& s, auto&) { s.mutable_sweep()->clear_name(); }, "no name");
  refused([](auto& s, auto&) { s.clear_viewpoint(); }, "no viewpoints");
  refused([](auto& s, auto&) { *s.mutable_viewpoint(1) = s.viewpoint(0); }, "comes twice");
  refused([](auto& s, auto&) { s.mutable_viewpoint(1)->set_range_m(0); }, "out of range");
  refused([](auto& s, auto&) { *s.mutable_condition(1) = s.condition(0); }, "comes twice");
  refused([](auto& s, auto&) { s.mutable_sweep()->mutable_band(1)->set_name("mwir"); },
          "comes twice");
  refused([](auto& s, auto&) { s.mutable_condition(1)->add_part_temperature_k(1); },
          "temperatures for 2 parts");
  // Names are printed: none may hold what a terminal obeys, nor may the refusal.
  const std::string escape = "a\x1b[2J";
  const std::string what = "\"a?[2J\" has control characters";
  refused([&](auto& s, auto&) { s.mutable_sweep()->set_name(escape); }, "the name " + what);
  refused([&](auto& s, auto&) { s.mutable_sweep()->mutable_band(1)->set_name(escape); },
          "the band " + what);
  refused([&](auto& s, auto&) { s.mutable_sweep()->mutable_part(1)->set_name(escape); },
          "the part " + what);
  refused([&](auto& s, auto&) { s.mutable_condition(1)->set_season(escape); },
          "the season " + what);
  refused([&](auto& s, auto&) { s.mutable_condition(1)->set_warning(0, escape); },
          "the warning " + what);
  refused(
      [](auto& s, auto&) {
        s.mutable_condition(1)->set_season(
            "\xC2\x9b"
            "31m");
      },
      "the season \"?31m\" has control characters");
  refused([](auto&, auto& j) { j.pop_back(); }, "its jobs compute 12 of 16 rows");
  refused([](auto&, auto& j) { j[1].mutable_view()->set_viewpoint_index(0); },
          "two jobs compute the same row");
  refused([](auto&, auto& j) { j[1].mutable_view()->set_viewpoint_index(9); }, "does not exist");
  refused([](auto&, auto& j) { j[1].set_job_key(j[0].job_key()); }, "comes twice");
  refused([](auto&, auto& j) { j[1].clear_view(); }, "is of no known kind");
  refused([](auto&, auto& j) { j[1].add_needs("nobody"); }, "which is no job before it");
  refused([](auto&, auto& j) { j[1].add_needs(j[1].job_key()); }, "which is no job before it");
  refused([](auto&, auto& j) { j[1].add_needs(j[2].job_key()); }, "which is no job before it");
  refused(
      [](auto&, auto& j) {
        j[2].add_needs(j[1].job_key());
        j[2].add_needs(j[1].job_key());
      },
      "needs it twice");
}

}  // namespace
}  // namespace irsig
