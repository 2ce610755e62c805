// Profiles in the database: they come with their signatures, go with them, and belong to the
// digest.

#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

constexpr std::uint32_t kPoints = 3, kReflections = 2;

schema::ResolvedSweep sweep_with_profile() {
  schema::ResolvedSweep sweep = make_sweep({});
  schema::Profile& line = *sweep.mutable_sweep()->add_profile();
  line.set_name("line");
  for (const double x : {0.0, 0.0, 0.0}) line.add_from_m(x);
  for (const double x : {1.0, 0.0, 0.0}) line.add_to_m(x);
  line.set_points(kPoints);
  line.add_reflections(0);
  line.add_reflections(4);
  schema::Published& published = *sweep.mutable_sweep()->add_published();
  published.set_profile("line");
  published.set_point_index(1);
  published.set_reflections(4);
  published.set_source_radiance_temperature_k(306);
  published.set_relation("below");
  published.set_source("a paper");
  published.set_remark("it is colder");
  return sweep;
}

void add_profile(schema::JobResult& result) {
  for (schema::SignatureRow& row : *result.mutable_view()->mutable_row())
    for (std::uint32_t p = 0; p < kPoints; ++p)
      for (std::uint32_t n = 0; n < kReflections; ++n) {
        schema::ProfileRow& out = *row.add_profile();
        out.set_point_index(p);
        out.set_reflections(4 * n);
        out.set_name("line");
        out.set_x_m(0.5 * p);
        out.set_y_m(-1);
        out.set_footprint_width_m(0.25);
        out.set_footprint_height_m(0.125);
        const double value = 50 + p + 10 * n + 100 * row.band_index();
        out.mutable_radiance_w_m2_sr()->set_value(value);
        out.mutable_radiance_w_m2_sr()->set_stderr(0.01);
        out.mutable_apparent_radiance_w_m2_sr()->set_value(0.9 * value);
        out.mutable_apparent_radiance_w_m2_sr()->set_stderr(0.009);
        out.set_truncation_bound_w_m2_sr(0.5);
        out.set_quadrature_bound_w_m2_sr(0.001);
        out.mutable_source_radiance_temperature_k()->set_value(300 + p);
        out.mutable_source_radiance_temperature_k()->set_stderr(0.02);
        out.set_target_fraction(0.75);
        out.set_samples(4096);
      }
}

class StoreProfile : public ::testing::Test {
 protected:
  // Completes every job with what `change` makes of its result; the first refusal.
  absl::Status complete(const schema::ResolvedSweep& sweep, const std::string& sha256,
                        const std::function<void(schema::JobResult&)>& change) {
    auto writer = StoreWriter::open(path_);
    if (!writer.ok()) return writer.status();
    if (auto added = submit(**writer, sweep, sha256); !added.ok()) return added.status();
    if (auto status = (*writer)->begin(); !status.ok()) return status;
    while (auto job = (*writer)->lease_next("worker", 0).value()) {
      schema::JobResult result = make_result(sweep, job->spec);
      change(result);
      if (auto status = (*writer)->complete(job->fencing_token, result, "host:1"); !status.ok())
        return status;
    }
    if (auto status = (*writer)->commit(); !status.ok()) return status;
    return (*writer)->finish();
  }
  std::vector<StoredProfileRow> stored(const ProfileFilter& filter = {}) {
    return StoreReader::open(path_).value()->profiles(filter).value();
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
};

TEST_F(StoreProfile, GivesBackWhatWasStored) {
  const schema::ResolvedSweep sweep = sweep_with_profile();
  ASSERT_OK(complete(sweep, "a", add_profile));
  const std::size_t signatures = StoreReader::open(path_).value()->find({})->size();
  const std::vector<StoredProfileRow> rows = stored();
  ASSERT_EQ(rows.size(), signatures * kPoints * kReflections);
  const StoredProfileRow& r = rows[3];  // the first signature's point 1 after 4 reflections
  EXPECT_EQ(r.row, 1U);
  EXPECT_EQ(r.profile, "line");
  EXPECT_EQ(r.point_index, 1U);
  EXPECT_EQ(r.reflections, 4U);
  EXPECT_EQ(r.x_m, 0.5);
  EXPECT_EQ(r.y_m, -1);
  EXPECT_EQ(r.footprint_width_m, 0.25);
  EXPECT_EQ(r.footprint_height_m, 0.125);
  EXPECT_EQ(r.radiance_w_m2_sr, 61);
  EXPECT_EQ(r.radiance_stderr_w_m2_sr, 0.01);
  EXPECT_EQ(r.apparent_radiance_w_m2_sr, 0.9 * 61);
  EXPECT_EQ(r.apparent_radiance_stderr_w_m2_sr, 0.009);
  EXPECT_EQ(r.truncation_bound_w_m2_sr, 0.5);
  EXPECT_EQ(r.quadrature_bound_w_m2_sr, 0.001);
  EXPECT_EQ(r.source_radiance_temperature_k, 301);
  EXPECT_EQ(r.source_radiance_temperature_stderr_k, 0.02);
  EXPECT_EQ(r.target_fraction, 0.75);
  EXPECT_EQ(r.samples, 4096U);
  EXPECT_EQ(r.replicates, 32U);
  EXPECT_EQ(r.seed_hex, "00000000000000aa");
  EXPECT_EQ(r.build_id, "test-build");
  EXPECT_EQ(stored({.sweep = "", .season = "", .band = sweep.sweep().band(0).name(), .profile = ""})
                .size(),
            rows.size() / static_cast<std::size_t>(sweep.sweep().band_size()));
  EXPECT_TRUE(stored({.sweep = "", .season = "", .band = "", .profile = "other"}).empty());
  const auto published = StoreReader::open(path_).value()->published("").value();
  ASSERT_EQ(published.size(), 1U);
  EXPECT_EQ(published[0].source_radiance_temperature_k, 306);
  EXPECT_EQ(published[0].relation, "below");
  EXPECT_EQ(published[0].remark, "it is colder");
}

TEST_F(StoreProfile, RefusesAnIncompleteProfile) {
  const schema::ResolvedSweep sweep = sweep_with_profile();
  const std::vector<std::pair<const char*, std::function<void(schema::JobResult&)>>> mistakes = {
      {"of the sweep's 6 rows", [](auto&) {}},
      {"of the sweep's 6 rows",
       [](auto& r) {
         add_profile(r);
         r.mutable_view()->mutable_row(0)->mutable_profile()->RemoveLast();
       }},
      {"twice",
       [](auto& r) {
         add_profile(r);
         r.mutable_view()->mutable_row(0)->mutable_profile(1)->set_reflections(0);
       }},
      {"without radiance",
       [](auto& r) {
         add_profile(r);
         r.mutable_view()->mutable_row(0)->mutable_profile(1)->clear_radiance_w_m2_sr();
       }},
      {"finite",
       [](auto& r) {
         add_profile(r);
         r.mutable_view()
             ->mutable_row(0)
             ->mutable_profile(1)
             ->mutable_radiance_w_m2_sr()
             ->set_value(HUGE_VAL);
       }},
      {"negative", [](auto& r) {
         add_profile(r);
         r.mutable_view()->mutable_row(0)->mutable_profile(1)->set_truncation_bound_w_m2_sr(-1);
       }}};
  for (const auto& [text, mistake] : mistakes) {
    const absl::Status status = complete(sweep, "a", mistake);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_THAT(std::string(status.message()), ::testing::HasSubstr(text));
  }
}

TEST_F(StoreProfile, IsPartOfTheDigest) {
  std::set<std::string> digests;
  const auto digest_of = [&](const schema::ResolvedSweep& sweep,
                             const std::function<void(schema::JobResult&)>& change) {
    const TestFolder folder;
    path_ = folder.file("b.sigdb");
    EXPECT_TRUE(complete(sweep, "a", change).ok());
    return StoreReader::open(path_).value()->digest().value();
  };
  const schema::ResolvedSweep sweep = sweep_with_profile();
  digests.insert(digest_of(sweep, add_profile));
  EXPECT_FALSE(digests.insert(digest_of(sweep, add_profile)).second);
  EXPECT_TRUE(digests
                  .insert(digest_of(
                      sweep,
                      [](auto& r) {
                        add_profile(r);
                        r.mutable_view()->mutable_row(0)->mutable_profile(1)->set_target_fraction(
                            std::nextafter(0.75, 1));
                      }))
                  .second);
  schema::ResolvedSweep other = sweep;
  other.mutable_sweep()->mutable_published(0)->set_remark("otherwise");
  EXPECT_TRUE(digests.insert(digest_of(other, add_profile)).second);
}

TEST_F(StoreProfile, GoesWithItsSignatureWhenTheSweepChanges) {
  schema::ResolvedSweep sweep = sweep_with_profile();
  ASSERT_OK(complete(sweep, "a", add_profile));
  const std::size_t before = stored().size();
  sweep.mutable_sweep()->mutable_published(0)->set_source_radiance_temperature_k(305);
  sweep.mutable_viewpoint()->RemoveLast();
  ASSERT_OK(complete(sweep, "b", add_profile));
  const auto viewpoints = static_cast<std::size_t>(sweep.viewpoint_size());
  EXPECT_EQ(stored().size(), before / (viewpoints + 1) * viewpoints);
  EXPECT_EQ(
      StoreReader::open(path_).value()->published("").value()[0].source_radiance_temperature_k,
      305);
}

}  // namespace
}  // namespace irsig
