// Merging: databases of shards, of unfinished runs and of different sweeps become one.

#include <gmock/gmock.h>

#include <set>

#include "absl/strings/str_split.h"
#include "schema/shard.h"
#include "schema/store/whole/examine.h"
#include "schema/store/whole/merge.h"
#include "schema/store/whole/slice.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

schema::ResolvedSweep with_all(schema::ResolvedSweep sweep) {
  sweep.mutable_sweep()->mutable_uncertainty()->set_air_temperature_k(1);
  return with_heat(std::move(sweep));
}

std::string whole_sha256(const schema::ResolvedSweep& sweep) {
  return absl::StrCat("sha of ", sweep.sweep().name(), sweep.sweep().seed());
}

std::string sha256_of(const schema::ResolvedSweep& sweep) {
  return sweep.has_shard() ? absl::StrCat(whole_sha256(sweep), " ", shard_name(sweep.shard()))
                           : whole_sha256(sweep);
}

std::vector<schema::JobSpec> jobs_of(const schema::ResolvedSweep& sweep, int /*physics_version*/) {
  std::vector<schema::JobSpec> jobs = make_heat_jobs(sweep, sha256_of(sweep));
  std::erase_if(jobs, [&](const schema::JobSpec& job) {
    return job.has_view() && !in_shard(sweep, job.view().viewpoint_index());
  });
  return jobs;
}

schema::ResolvedSweep shard_of(schema::ResolvedSweep sweep, int number, int of) {
  schema::Shard shard;
  shard.set_sweep_sha256(whole_sha256(sweep));
  shard.set_number(static_cast<std::uint32_t>(number));
  shard.set_of(static_cast<std::uint32_t>(of));
  *sweep.mutable_shard() = shard;
  return sweep;
}

class StoreMerge : public ::testing::Test {
 protected:
  // Submits, and computes up to `most` of what is missing; how many jobs that was.
  int write(const std::string& name, const schema::ResolvedSweep& sweep, int most = 1 << 30) {
    auto writer = StoreWriter::open(file(name)).value();
    EXPECT_TRUE(writer->begin().ok());
    const auto added = writer->add_sweep(sweep, sha256_of(sweep), jobs_of(sweep, 1), {});
    EXPECT_TRUE(added.ok()) << added.status();
    int done = 0;
    for (; done < most; ++done) {
      const auto job = writer->lease_next("w", 100).value();
      if (!job) break;
      const auto result =
          job->spec.has_heat() ? make_heat_result(sweep, job->spec) : make_result(sweep, job->spec);
      const absl::Status completed = writer->complete(job->fencing_token, result, "h");
      EXPECT_TRUE(completed.ok()) << completed;
    }
    EXPECT_TRUE(writer->commit().ok());
    EXPECT_TRUE(writer->finish().ok());
    return done;
  }

  absl::StatusOr<Merged> try_merge(const std::vector<std::string>& from, const std::string& to,
                                   const MergeProgress& progress = {}) {
    MergeAsked asked{{}, jobs_of, 1};
    for (const std::string& name : from) asked.from.push_back(file(name));
    return merge_databases(asked, file(to), progress);
  }
  // The digest.
  std::string merge(const std::vector<std::string>& from, const std::string& to) {
    const auto merged = try_merge(from, to);
    EXPECT_TRUE(merged.ok()) << merged.status();
    if (!merged.ok()) return "";
    last_ = *merged;
    EXPECT_EQ(digest(to), merged->digest);
    EXPECT_EQ(std::filesystem::status(file(to)).permissions(), std::filesystem::perms(0600));
    return merged->digest;
  }
  // Refused, and nothing is left of it.
  std::string refusal(const std::vector<std::string>& from) {
    const std::set<std::string> before = names();
    const auto merged = try_merge(from, "refused.sigdb");
    EXPECT_FALSE(merged.ok());
    EXPECT_EQ(names(), before);
    return std::string(merged.status().message());
  }

  std::set<std::string> names() const {
    std::set<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      out.insert(entry.path().filename());
    return out;
  }
  std::string file(const std::string& name) const { return folder_.file(name); }
  std::string digest(const std::string& name) const {
    return StoreReader::open(file(name)).value()->digest().value();
  }
  std::string sql(const std::string& name, const std::string& statement) const {
    return sqlite_text(file(name), statement);
  }
  std::string changed_copy(const std::string& name, const std::string& statement) const {
    std::filesystem::copy_file(file(name), file("copy.sigdb"),
                               std::filesystem::copy_options::overwrite_existing);
    const std::string text = sql("copy.sigdb", statement);
    EXPECT_THAT(text, ::testing::Not(HasSubstr("error"))) << statement;
    return "copy.sigdb";
  }
  std::vector<std::string> findings(const std::string& name) const {
    std::vector<std::string> out;
    const auto found = examine(file(name), 1);
    EXPECT_TRUE(found.ok()) << found.status();
    for (const StoreFinding& f : *found)
      // The fixture's numbers are no physics, and its images are none.
      if (f.what.find("causes do not add up") == std::string::npos &&
          f.what.find("no PNG or no EXR") == std::string::npos)
        out.push_back(f.what);
    return out;
  }
  void write_shards() {
    for (int k = 1; k <= 3; ++k)
      EXPECT_EQ(write(absl::StrCat(k, ".sigdb"), shard_of(sweep_, k, 3)), k == 1 ? 4 : 3);
  }

  const TestFolder folder_;
  const schema::ResolvedSweep sweep_ = with_all(make_sweep({}));
  Merged last_;
};

TEST_F(StoreMerge, OfAllShardsIsTheUndividedRun) {
  write("whole.sigdb", sweep_);
  write_shards();
  const std::string whole = digest("whole.sigdb");
  EXPECT_EQ(merge({"1.sigdb", "2.sigdb", "3.sigdb"}, "a.sigdb"), whole);
  ASSERT_EQ(last_.sweep.size(), 1U);
  EXPECT_EQ(last_.sweep[0].rows, 16U);
  EXPECT_EQ(last_.sweep[0].done, 6U);
  EXPECT_EQ(last_.sweep[0].jobs, 6U);
  EXPECT_THAT(findings("a.sigdb"), IsEmpty());
  EXPECT_EQ(merge({"3.sigdb", "1.sigdb", "2.sigdb"}, "b.sigdb"), whole);
  merge({"3.sigdb", "1.sigdb"}, "c.sigdb");
  EXPECT_EQ(merge({"2.sigdb", "c.sigdb"}, "d.sigdb"), whole);
  EXPECT_EQ(merge({"a.sigdb", "c.sigdb", "whole.sigdb"}, "e.sigdb"), whole);
  for (const char* name : {"a.sigdb", "d.sigdb", "e.sigdb"}) {
    const auto reader = StoreReader::open(file(name)).value();
    EXPECT_EQ(reader->progress().value().front().sweep_sha256, whole_sha256(sweep_));
    const StoredSweep stored = reader->sweep("ship").value();
    EXPECT_FALSE(stored.resolved.has_shard());
    EXPECT_EQ(stored.heat.size(), 2U);
    // Table by table, those that nobody has thought of yet included.
    const std::string tables =
        sql(name,
            "SELECT group_concat(name) FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE "
            "'sqlite_%'");
    EXPECT_THAT(tables, HasSubstr("input_contribution"));
    for (const absl::string_view table : absl::StrSplit(tables, ',')) {
      const std::string count = absl::StrCat("SELECT count(*) FROM ", table);
      EXPECT_EQ(sql(name, count), sql("whole.sigdb", count)) << name << " " << table;
    }
  }
  // All of it is done.
  EXPECT_EQ(write("a.sigdb", sweep_), 0);
  EXPECT_EQ(digest("a.sigdb"), whole);
}

TEST_F(StoreMerge, RowsHaveTheNumbersOfTheWhole) {
  write("whole.sigdb", sweep_);
  write("2.sigdb", shard_of(sweep_, 2, 3));
  EXPECT_THAT(findings("2.sigdb"), IsEmpty());
  const auto whole = StoreReader::open(file("whole.sigdb")).value()->find({}).value();
  const auto rows = StoreReader::open(file("2.sigdb")).value()->find({}).value();
  ASSERT_EQ(rows.size(), 4U);
  for (const StoredSignature& s : rows) {
    const StoredSignature& same = whole[s.row - 1];
    EXPECT_EQ(same.row, s.row);
    EXPECT_EQ(same.job_key, s.job_key);
    EXPECT_EQ(same.intensity_w_sr, s.intensity_w_sr);
  }
}

TEST_F(StoreMerge, WhatNobodyHasDoneWaits) {
  write("whole.sigdb", sweep_);
  write_shards();
  merge({"3.sigdb", "2.sigdb"}, "a.sigdb");
  EXPECT_EQ(last_.sweep[0].done, 4U);
  EXPECT_EQ(last_.sweep[0].jobs, 6U);
  EXPECT_EQ(write("a.sigdb", sweep_), 2);
  EXPECT_EQ(digest("a.sigdb"), digest("whole.sigdb"));
  // A shard alone becomes the whole, of which most waits.
  merge({"1.sigdb"}, "b.sigdb");
  EXPECT_EQ(write("b.sigdb", sweep_), 2);
  EXPECT_EQ(digest("b.sigdb"), digest("whole.sigdb"));
  // Cases: nothing done at all; the heat jobs alone; views wait for them where they are not done.
  write("none.sigdb", sweep_, 0);
  write("heat.sigdb", sweep_, 1);
  merge({"none.sigdb", "heat.sigdb"}, "c.sigdb");
  EXPECT_EQ(last_.sweep[0].done, 1U);
  EXPECT_EQ(sql("c.sigdb", "SELECT min(unmet_needs) FROM job WHERE kind = 1"), "1");
  EXPECT_EQ(write("c.sigdb", sweep_), 5);
  EXPECT_EQ(digest("c.sigdb"), digest("whole.sigdb"));
  // Runs of the same sweep that ended early, with overlap.
  write("four.sigdb", sweep_, 4);
  EXPECT_EQ(merge({"four.sigdb", "3.sigdb", "none.sigdb", "2.sigdb"}, "d.sigdb"),
            merge({"3.sigdb", "four.sigdb"}, "e.sigdb"));
  EXPECT_EQ(write("d.sigdb", sweep_), 1);
  EXPECT_EQ(digest("d.sigdb"), digest("whole.sigdb"));
}

TEST_F(StoreMerge, AFileTwiceIsAFileOnce) {
  write("whole.sigdb", sweep_);
  const std::string whole = digest("whole.sigdb");
  std::filesystem::copy_file(file("whole.sigdb"), file("copy.sigdb"));
  std::filesystem::create_symlink(file("whole.sigdb"), file("link.sigdb"));
  EXPECT_EQ(merge({"whole.sigdb", "whole.sigdb", "link.sigdb"}, "a.sigdb"), whole);
  EXPECT_EQ(merge({"whole.sigdb", "copy.sigdb", "a.sigdb"}, "b.sigdb"), whole);
  EXPECT_EQ(last_.sweep[0].rows, 16U);
}

TEST_F(StoreMerge, DifferentSweepsStandSideBySide) {
  const schema::ResolvedSweep other = with_all(make_sweep({.name = "boat", .aspects = {{10, 3}}}));
  write("both.sigdb", sweep_);
  write("both.sigdb", other);
  write("ship.sigdb", sweep_);
  write("boat.sigdb", other, 1);
  EXPECT_NE(merge({"boat.sigdb", "ship.sigdb"}, "a.sigdb"), digest("both.sigdb"));
  EXPECT_EQ(write("a.sigdb", other), 2);
  EXPECT_EQ(digest("a.sigdb"), digest("both.sigdb"));
  EXPECT_THAT(findings("a.sigdb"), IsEmpty());
}

// Each table, changed in one place, on either side.
TEST_F(StoreMerge, EqualJobsHaveEqualContent) {
  write("whole.sigdb", sweep_);
  write("1.sigdb", shard_of(sweep_, 1, 2));
  for (const auto& [table, statement] : std::initializer_list<std::pair<const char*, const char*>>{
           {"signature", "UPDATE signature SET emitted_w_sr = emitted_w_sr + 1e-9 WHERE rowid = 3"},
           {"signature", "UPDATE signature SET plume_w_sr = 1 WHERE rowid = 1"},
           {"spectrum", "UPDATE spectrum SET emitted_w_sr_um = zeroblob(20) WHERE rowid = 4"},
           {"spectrum", "DELETE FROM spectrum WHERE rowid = 2"},
           {"spectral_modes", "DELETE FROM spectral_modes WHERE rowid = 2"},
           {"part_intensity",
            "UPDATE part_intensity SET intensity_w_sr = 7 WHERE signature_id = 3"},
           {"thumbnail", "UPDATE thumbnail SET png = x'00' WHERE rowid = 1"},
           {"silhouette", "UPDATE silhouette SET pixel_samples = 16 WHERE job_id = 3"},
           {"part_pixels", "UPDATE part_pixels SET left_px = 0 WHERE job_id = 3"},
           {"part_pixels", "DELETE FROM part_pixels WHERE job_id = 3"},
           {"part_set", "UPDATE part_set SET outside_px = 2 WHERE job_id = 3"},
           {"part_set", "DELETE FROM part_set WHERE job_id = 3"},
           {"ledger", "UPDATE ledger SET bound_w_sr = 8 WHERE signature_id = 2 AND effect = 3"},
           {"ledger", "DELETE FROM ledger WHERE signature_id = 2 AND effect = 3"},
           {"energy", "UPDATE energy SET absorbed = 2 WHERE rowid = 4"},
           {"input_contribution", "UPDATE input_contribution SET contribution_w_sr = 3"},
           {"provenance", "UPDATE provenance SET samples = samples + 1 WHERE job_id = 3"},
           {"computed_temperature", "UPDATE computed_temperature SET hottest_k = 400"},
           {"computed_temperature", "DELETE FROM computed_temperature WHERE job_id = 2"},
           {"heat_job", "UPDATE heat_job SET warning = 'another' WHERE heat_index = 1"}}) {
    const std::string copy = changed_copy("1.sigdb", statement);
    for (const auto& from : {std::vector<std::string>{"whole.sigdb", copy}, {copy, "1.sigdb"}}) {
      const std::string said = refusal(from);
      EXPECT_THAT(said, HasSubstr(absl::StrCat("`", table, "` is not the same"))) << statement;
      for (const std::string& name : from) EXPECT_THAT(said, HasSubstr(file(name)));
    }
  }
  const std::string said =
      refusal({"whole.sigdb", changed_copy("1.sigdb",
                                           "UPDATE signature SET emitted_w_sr = 1 WHERE "
                                           "signature_id = (SELECT max(signature_id) FROM "
                                           "signature)")});
  EXPECT_THAT(said, HasSubstr("the sweep \"ship\", row 12, job "));
  // Worker, time and duration are no content.
  changed_copy("whole.sigdb",
               "UPDATE provenance SET seconds = 9, worker_name = 'x', build_id = 'y';"
               "UPDATE ledger SET time_s = 9; UPDATE attempt SET leased_unix_s = 7");
  EXPECT_EQ(merge({"copy.sigdb", "whole.sigdb"}, "a.sigdb"), digest("whole.sigdb"));
}

TEST_F(StoreMerge, RefusesWhatDoesNotGoTogether) {
  write("1.sigdb", shard_of(sweep_, 1, 2));
  write("2.sigdb", shard_of(sweep_, 2, 2));
  EXPECT_THAT(
      refusal({"1.sigdb", changed_copy("2.sigdb",
                                       "UPDATE provenance SET "
                                       "determinism_class = 'other'")}),
      ::testing::AllOf(HasSubstr("determinism class test-class in "), HasSubstr(" and other in ")));
  EXPECT_THAT(refusal({changed_copy("2.sigdb",
                                    "UPDATE provenance SET determinism_class = 'other' "
                                    "WHERE job_id = 1")}),
              HasSubstr("determinism class"));
  EXPECT_THAT(
      refusal({"1.sigdb", changed_copy("2.sigdb", "UPDATE provenance SET physics_version = 2")}),
      HasSubstr("physics version 1 in "));
  EXPECT_THAT(refusal({changed_copy("2.sigdb", "UPDATE job SET job_key = 'k' WHERE job_id = 4")}),
              HasSubstr("has a job k, which it has not by this irsig"));
  EXPECT_THAT(refusal({changed_copy("2.sigdb", "DELETE FROM signature WHERE signature_id = 1")}),
              HasSubstr("rows are missing"));
  EXPECT_THAT(refusal({"1.sigdb", changed_copy("2.sigdb",
                                               "UPDATE band SET lambda_um = "
                                               "zeroblob(40)")}),
              HasSubstr("other wavelengths"));
  EXPECT_THAT(refusal({"1.sigdb", changed_copy("2.sigdb",
                                               "CREATE TRIGGER t AFTER INSERT ON asset "
                                               "BEGIN DELETE FROM sweep; END")}),
              HasSubstr("trigger"));
  std::filesystem::copy_file(file("2.sigdb"), file("old.sigdb"));
  ASSERT_EQ(sqlite_text(file("old.sigdb"), "PRAGMA user_version = 19; SELECT 'older'"), "older");
  EXPECT_THAT(refusal({"1.sigdb", "old.sigdb"}), HasSubstr("has format version 19"));
  schema::ResolvedSweep changed = sweep_;
  changed.mutable_sweep()->set_seed(7);
  write("changed.sigdb", changed);
  EXPECT_THAT(refusal({"1.sigdb", "changed.sigdb"}),
              ::testing::AllOf(HasSubstr("the definition sha of ship0 in "),
                               HasSubstr("and sha of ship7 in ")));
  ASSERT_OK(slice_database(file("1.sigdb"), {{}, "", false}, file("slice.sigdb")).status());
  EXPECT_FALSE(StoreReader::open(file("slice.sigdb")).value()->sweep("ship")->resolved.has_shard());
  EXPECT_THAT(refusal({"2.sigdb", "slice.sigdb"}), HasSubstr("holds a slice"));
  const auto checked = merge_databases(
      {{file("1.sigdb")},
       [](const schema::ResolvedSweep&, int) -> absl::StatusOr<std::vector<schema::JobSpec>> {
         return absl::InvalidArgumentError("it is no sweep");
       },
       1},
      file("refused.sigdb"));
  EXPECT_EQ(checked.status().message(), file("1.sigdb") + ": the sweep \"ship\": it is no sweep");
  EXPECT_THAT(refusal({"1.sigdb", "absent.sigdb"}), HasSubstr("no such file"));
  const auto over = try_merge({"1.sigdb"}, "2.sigdb");
  EXPECT_TRUE(absl::IsInvalidArgument(over.status())) << over.status();
  EXPECT_THAT(over.status().message(), HasSubstr("exists already"));
  sql("empty.sigdb", "SELECT 1");
  ASSERT_OK(StoreWriter::open(file("empty.sigdb")).value()->finish());
  EXPECT_THAT(refusal({"empty.sigdb"}), HasSubstr("nothing to merge"));
}

// A coordinator would give the waiting jobs of both to the workers of one.
TEST_F(StoreMerge, OneClassForAllUnfinishedSweeps) {
  const schema::ResolvedSweep other = with_all(make_sweep({.name = "boat"}));
  write("ship.sigdb", sweep_, 3);
  write("boat.sigdb", other, 3);
  const char* change = "UPDATE provenance SET determinism_class = 'other'";
  EXPECT_THAT(refusal({"ship.sigdb", changed_copy("boat.sigdb", change)}),
              HasSubstr("both unfinished"));
  write("boat.sigdb", other);
  merge({"ship.sigdb", changed_copy("boat.sigdb", change)}, "a.sigdb");
  EXPECT_EQ(sql("a.sigdb", "SELECT group_concat(determinism_class) FROM sweep"),
            "test-class,other");
}

TEST_F(StoreMerge, RowsOfAnEarlierVersionStayBehind) {
  write("a.sigdb", with_all(make_sweep({})));
  const schema::ResolvedSweep changed = with_all(make_sweep({.hull_temperature_k = 295}));
  write("a.sigdb", changed, 3);
  merge({"a.sigdb"}, "b.sigdb");
  EXPECT_EQ(last_.sweep[0].left_behind, 16 - last_.sweep[0].rows);
  EXPECT_GT(last_.sweep[0].left_behind, 0U);
  EXPECT_EQ(sql("b.sigdb", "SELECT max(superseded) FROM job"), "0");
}

TEST_F(StoreMerge, CanBeInterrupted) {
  write_shards();
  const std::set<std::string> before = names();
  std::uint64_t told = 0;
  const auto ended = try_merge({"1.sigdb", "2.sigdb", "3.sigdb"}, "a.sigdb",
                               [&](std::uint64_t rows, std::uint64_t of) {
                                 EXPECT_EQ(of, 16U);
                                 told = rows;
                                 return rows > 8 ? absl::AbortedError("enough") : absl::OkStatus();
                               });
  EXPECT_TRUE(absl::IsAborted(ended.status())) << ended.status();
  EXPECT_EQ(told, 12U);
  EXPECT_EQ(names(), before);
}

// While a coordinator writes: what was committed.
TEST_F(StoreMerge, ReadsADatabaseThatIsBeingWritten) {
  const schema::ResolvedSweep shard = shard_of(sweep_, 1, 2);
  auto writer = StoreWriter::open(file("live.sigdb")).value();
  ASSERT_OK(writer->begin());
  ASSERT_OK(writer->add_sweep(shard, sha256_of(shard), jobs_of(shard, 1), {}).status());
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->begin());
  for (int i = 0; i < 3; ++i) {
    const auto job = writer->lease_next("w", 1).value();
    ASSERT_OK(writer->complete(
        job->fencing_token,
        job->spec.has_heat() ? make_heat_result(shard, job->spec) : make_result(shard, job->spec),
        "h"));
    if (i < 2) {
      ASSERT_OK(writer->commit());
      ASSERT_OK(writer->begin());
    }
  }
  write("2.sigdb", shard_of(sweep_, 2, 2));
  merge({"live.sigdb", "2.sigdb"}, "a.sigdb");
  EXPECT_EQ(last_.sweep[0].done, 4U);
  ASSERT_OK(writer->commit());
}

TEST_F(StoreMerge, AShardGoesIntoADatabaseOfItsOwn) {
  write("whole.sigdb", sweep_);
  write("1.sigdb", shard_of(sweep_, 1, 2));
  const auto added = [&](const std::string& name, const schema::ResolvedSweep& sweep) {
    const auto writer = StoreWriter::open(file(name)).value();
    EXPECT_TRUE(writer->begin().ok());
    return writer->add_sweep(sweep, sha256_of(sweep), jobs_of(sweep, 1), {}).status();
  };
  EXPECT_TRUE(absl::IsInvalidArgument(added("whole.sigdb", shard_of(sweep_, 1, 2))));
  EXPECT_TRUE(absl::IsInvalidArgument(added("1.sigdb", shard_of(sweep_, 2, 2))));
  EXPECT_TRUE(absl::IsInvalidArgument(added("1.sigdb", shard_of(sweep_, 1, 3))));
  EXPECT_EQ(write("1.sigdb", shard_of(sweep_, 1, 2)), 0);
  // The whole goes on where the shard has ended.
  EXPECT_EQ(write("1.sigdb", sweep_), 2);
  EXPECT_EQ(digest("1.sigdb"), digest("whole.sigdb"));
}

// One more viewpoint in front: the old ones are those of other shards now.
TEST_F(StoreMerge, AShardOfAChangedSweepKeepsNoRowsOfOthers) {
  write("1.sigdb", shard_of(sweep_, 1, 2));
  const schema::ResolvedSweep longer =
      with_all(make_sweep({.aspects = {{45, 45}, {0, 0}, {90, 10}, {180, 45}, {270, -5}}}));
  write("1.sigdb", shard_of(longer, 1, 2));
  EXPECT_EQ(sql("1.sigdb", "SELECT count(*) FROM signature"), "12");
  EXPECT_EQ(sql("1.sigdb", "SELECT max(superseded) FROM job"), "0");
  EXPECT_THAT(findings("1.sigdb"), IsEmpty());
}

}  // namespace
}  // namespace irsig
