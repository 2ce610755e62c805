// Assets that are damaged: nobody gets their bytes, and they are replaced.

#include <gmock/gmock.h>

#include "schema/store/tables/sha256.h"
#include "schema/store/whole/examine.h"
#include "schema/store/whole/merge.h"
#include "schema/store/whole/slice.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using ::testing::HasSubstr;

class StoreAsset : public ::testing::Test {
 protected:
  void SetUp() override {
    sweep_ = with_heat(make_sweep({}));
    sweep_.set_model_sha256(sha256_of(model_));
    writer_ = StoreWriter::open(path_).value();
    ASSERT_OK(add(sweep_, {{sweep_.model_sha256(), model_}}).status());
  }
  absl::StatusOr<AddedJobs> add(const schema::ResolvedSweep& sweep,
                                const std::vector<Asset>& assets,
                                const std::string& sha256 = "sweep-a") {
    if (auto status = writer_->begin(); !status.ok()) return status;
    auto added = writer_->add_sweep(sweep, sha256, make_heat_jobs(sweep, sha256), assets);
    if (!added.ok()) {
      writer_->rollback();
      return added;
    }
    if (auto status = writer_->commit(); !status.ok()) return status;
    return added;
  }
  // Completes what waits; how many.
  int complete() {
    EXPECT_TRUE(writer_->begin().ok());
    int done = 0;
    for (;; ++done) {
      const auto job = writer_->lease_next("w", 0).value();
      if (!job) break;
      // Each season's field is its own.
      const auto result =
          job->spec.has_heat()
              ? make_heat_result(sweep_, job->spec,
                                 300 + 10 * static_cast<float>(job->spec.heat().heat()))
              : make_result(sweep_, job->spec);
      EXPECT_TRUE(writer_->complete(job->fencing_token, result, "w").ok());
    }
    EXPECT_TRUE(writer_->commit().ok());
    return done;
  }
  // One bit of the assets that `where` says.
  void damage(const std::string& where) {
    const std::string before = sqlite_text(path_, "SELECT count(*) FROM asset WHERE " + where);
    ASSERT_EQ(before, "1") << where;
    ASSERT_EQ(sqlite_text(path_,
                          "UPDATE asset SET bytes = CAST(substr(bytes, 1, 3) || "
                          "iif(substr(bytes, 4, 1) = x'00', x'01', x'00') || substr(bytes, 5) AS "
                          "BLOB) WHERE " +
                              where + "; SELECT 'damaged'"),
              "damaged");
  }
  [[nodiscard]] std::string is_model() const { return "sha256 = '" + sweep_.model_sha256() + "'"; }
  const char* is_of_winter_ =
      "sha256 = (SELECT output_sha256 FROM heat_job WHERE season = 'winter')";
  absl::StatusOr<StoredSweep> read(SweepFiles files = SweepFiles::kAll) {
    return StoreReader::open(path_).value()->sweep("ship", files);
  }
  std::string digest() { return StoreReader::open(path_).value()->digest().value(); }
  static void is_damaged(const absl::Status& status, const std::string& what) {
    EXPECT_TRUE(absl::IsDataLoss(status)) << status;
    for (const std::string& words :
         {what, std::string("its bytes have another SHA-256"), std::string("--resume")})
      EXPECT_THAT(std::string(status.message()), HasSubstr(words));
  }
  absl::Status slice() {
    std::filesystem::remove(folder_.file("slice.sigdb"));
    const SliceAsked asked{.filter = {}, .filter_text = "", .source_digest = false};
    return slice_database(path_, asked, folder_.file("slice.sigdb"), nullptr).status();
  }
  absl::Status merge() {
    std::filesystem::remove(folder_.file("merged.sigdb"));
    return merge_databases({.from = {path_},
                            .jobs = [](const schema::ResolvedSweep& sweep,
                                       int) { return make_heat_jobs(sweep, "sweep-a"); },
                            .physics_version = 1},
                           folder_.file("merged.sigdb"), nullptr)
        .status();
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  const std::string model_ = "a mesh of a ship";
  schema::ResolvedSweep sweep_;
  std::unique_ptr<StoreWriter> writer_;
};

TEST_F(StoreAsset, NobodyGetsTheBytesOfADamagedFile) {
  EXPECT_EQ(complete(), 6);
  ASSERT_OK(slice());
  ASSERT_OK(merge());
  ASSERT_NO_FATAL_FAILURE(damage(is_model()));
  const std::string what = "(a file of the sweep \"ship\")";
  is_damaged(writer_->asset(sweep_.model_sha256()).status(), what);
  is_damaged(read().status(), what);
  is_damaged(slice(), what);
  is_damaged(merge(), what);
  // A worker that needs no file goes on.
  EXPECT_EQ(read(SweepFiles::kNone)->resolved.sweep().name(), "ship");
  EXPECT_EQ(read(SweepFiles::kTemperatures)->heat.size(), 2U);
}

TEST_F(StoreAsset, NobodyGetsTheBytesOfDamagedTemperatures) {
  EXPECT_EQ(complete(), 6);
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  const std::string what =
      "(temperatures computed for the season \"winter\" of the sweep \"ship\")";
  is_damaged(read().status(), what);
  is_damaged(read(SweepFiles::kTemperatures).status(), what);
  is_damaged(slice(), what);
  is_damaged(merge(), what);
  ASSERT_OK(read(SweepFiles::kNone).status());
}

TEST_F(StoreAsset, ASubmissionReplacesADamagedFile) {
  EXPECT_EQ(complete(), 6);
  const std::string before = digest();
  ASSERT_NO_FATAL_FAILURE(damage(is_model()));
  is_damaged(add(sweep_, {}).status(), "(a file of the sweep \"ship\")");
  EXPECT_EQ(add(sweep_, {{sweep_.model_sha256(), model_}})->to_compute, 0U);
  EXPECT_EQ(writer_->asset(sweep_.model_sha256()).value(), model_);
  // A file that comes in pieces is checked likewise; one of another length, too.
  ASSERT_EQ(
      sqlite_text(path_, "UPDATE asset SET bytes = x'00' WHERE " + is_model() + "; SELECT 'short'"),
      "short");
  auto file = SpooledFile::make(folder_.path()).value();
  ASSERT_OK(file->append(model_));
  EXPECT_EQ(add(sweep_, {{sweep_.model_sha256(), "", std::move(file)}})->to_compute, 0U);
  EXPECT_EQ(writer_->asset(sweep_.model_sha256()).value(), model_);
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM pragma_foreign_key_check()"), "0");
}

TEST_F(StoreAsset, DamagedTemperaturesAreComputedAgain) {
  EXPECT_EQ(complete(), 6);
  const std::string before = digest();
  const auto reopened = [&] {
    EXPECT_TRUE(writer_->begin().ok());
    const auto jobs = writer_->reopen_damaged();
    EXPECT_TRUE(writer_->commit().ok());
    return jobs.value();
  };
  EXPECT_EQ(reopened(), 0U);
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  EXPECT_EQ(reopened(), 1U);
  EXPECT_EQ(reopened(), 0U) << "it waits already";
  EXPECT_EQ(writer_->progress().value()[0].done, 5U) << "views that are done stay";
  EXPECT_EQ(complete(), 1);
  ASSERT_OK(read().status());
  EXPECT_EQ(digest(), before);
  // Also by a submission to a coordinator that goes on.
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  EXPECT_EQ(add(sweep_, {{sweep_.model_sha256(), model_}})->to_compute, 1U);
  EXPECT_EQ(complete(), 1);
  EXPECT_EQ(digest(), before);
}

TEST_F(StoreAsset, ViewsWaitForTemperaturesThatAreComputedAgain) {
  ASSERT_OK(writer_->begin());
  for (int heat = 0; heat < 2; ++heat) {
    const QueuedJob job = writer_->lease_next("w", 0).value().value();
    ASSERT_TRUE(job.spec.has_heat());
    ASSERT_OK(writer_->complete(
        job.fencing_token, make_heat_result(sweep_, job.spec, 300 + 10 * static_cast<float>(heat)),
        "w"));
  }
  ASSERT_OK(writer_->commit());
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  ASSERT_OK(writer_->begin());
  EXPECT_EQ(writer_->reopen_damaged().value(), 1U);
  EXPECT_TRUE(writer_->lease_next("w", 0).value()->spec.has_heat());
  EXPECT_FALSE(writer_->lease_next("w", 0).value().has_value());
  writer_->rollback();
}

TEST_F(StoreAsset, DamagedTemperaturesAreNotTakenOver) {
  EXPECT_EQ(complete(), 6);
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  schema::ResolvedSweep other = sweep_;
  other.mutable_sweep()->set_name("other");
  EXPECT_EQ(add(other, {{sweep_.model_sha256(), model_}}, "sweep-b")->to_compute, 6U);
  ASSERT_OK(writer_->begin());
  const QueuedJob winter = writer_->lease_next("w", 0).value().value();
  EXPECT_FALSE(writer_->take_over(winter.fencing_token, "test-class").value());
  // Its own result replaces the bytes, for both sweeps.
  ASSERT_OK(
      writer_->complete(winter.fencing_token, make_heat_result(other, winter.spec, 300), "w"));
  const QueuedJob summer = writer_->lease_next("w", 0).value().value();
  EXPECT_TRUE(writer_->take_over(summer.fencing_token, "test-class").value());
  ASSERT_OK(writer_->commit());
  EXPECT_EQ(read()->heat.size(), 2U);
}

TEST_F(StoreAsset, TheExaminationNamesThemAndTheRemedy) {
  EXPECT_EQ(complete(), 6);
  EXPECT_TRUE(examine(path_, 1)->empty());
  ASSERT_NO_FATAL_FAILURE(damage(is_of_winter_));
  ASSERT_NO_FATAL_FAILURE(damage(is_model()));
  const auto findings = examine(path_, 1).value();
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, StoreFinding::Kind::kDamaged);
  for (const char* words :
       {"not those of their SHA-256", "(a file of the sweep \"ship\")",
        "(temperatures computed for the season \"winter\" of the sweep \"ship\")",
        "`irsig run SWEEP --db "})
    EXPECT_THAT(findings[0].what, HasSubstr(words));
}

}  // namespace
}  // namespace irsig
