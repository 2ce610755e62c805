// The digest depends on the content and on nothing else.

#include <cmath>
#include <set>

#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

struct Run {
  std::vector<int> order = {};  // in which the leased jobs complete
  std::function<void(schema::JobResult&)> change = [](schema::JobResult&) {};
  bool lose_one = false;
  bool cut = false;  // one job for each condition instead of one for each viewpoint
};

std::vector<schema::JobSpec> cut_along_conditions(const std::vector<schema::JobSpec>& jobs) {
  std::vector<schema::JobSpec> pieces;
  for (const schema::JobSpec& job : jobs) {
    for (const std::uint32_t condition : job.view().condition_index()) {
      schema::JobSpec& piece = pieces.emplace_back(job);
      piece.mutable_view()->clear_condition_index();
      piece.mutable_view()->add_condition_index(condition);
      piece.set_job_key(absl::StrCat(job.job_key(), "#", condition));
    }
  }
  return pieces;
}

std::string digest_of(const Run& run) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  const auto whole = make_jobs(sweep, "sweep-a");
  const auto jobs = run.cut ? cut_along_conditions(whole) : whole;
  auto writer = StoreWriter::open(path).value();
  EXPECT_TRUE(writer->begin().ok());
  EXPECT_TRUE(writer->add_sweep(sweep, "sweep-a", jobs, {}).ok());
  if (run.lose_one) {
    const auto lost = writer->lease_next("mayfly", 1).value();
    EXPECT_TRUE(writer->release(lost->fencing_token, "lost").ok());
  }
  std::vector<QueuedJob> leased;
  while (auto job = writer->lease_next("worker", 2).value()) leased.push_back(*job);
  std::vector<int> order = run.order;
  if (order.empty()) {
    for (std::size_t i = 0; i < leased.size(); ++i) order.push_back(static_cast<int>(i));
  }
  for (const int i : order) {
    const QueuedJob& job = leased[static_cast<std::size_t>(i)];
    // The numbers are those of the viewpoint, however the work was cut.
    schema::JobResult result = make_result(sweep, whole[job.spec.view().viewpoint_index()]);
    result.set_job_key(job.spec.job_key());
    for (int r = result.view().row_size() - 1; r >= 0; --r) {
      const auto& wanted = job.spec.view().condition_index();
      if (std::find(wanted.begin(), wanted.end(), result.view().row(r).condition_index()) ==
          wanted.end()) {
        result.mutable_view()->mutable_row()->DeleteSubrange(r, 1);
      }
    }
    run.change(result);
    const auto status = writer->complete(job.fencing_token, result, absl::StrCat("host:", i));
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_TRUE(writer->commit().ok());
    EXPECT_TRUE(writer->begin().ok());
  }
  EXPECT_TRUE(writer->commit().ok());
  EXPECT_TRUE(writer->finish().ok());
  const std::string digest = StoreReader::open(path).value()->digest().value();
  EXPECT_EQ(digest.size(), 64U);
  return digest;
}

TEST(StoreDigest, DoesNotDependOnOrderTimeOrHost) {
  const std::string digest = digest_of({});
  EXPECT_EQ(digest_of({.order = {3, 1, 0, 2}, .lose_one = true}), digest);
  EXPECT_EQ(digest_of({.change =
                           [](schema::JobResult& result) {
                             result.set_seconds(77);
                             result.set_determinism_class("another");
                             result.set_build_id("another");
                             for (auto& row : *result.mutable_view()->mutable_row())
                               for (auto& effect : *row.mutable_effect()) effect.set_time_s(1);
                           }}),
            digest);
}

TEST(StoreDigest, DoesNotDependOnHowJobsWereCut) {
  EXPECT_EQ(
      digest_of({.order = {7, 2, 1, 0, 5, 6, 4, 3},
                 .change = [](schema::JobResult& result) { result.set_rays(result.rays() / 2); },
                 .cut = true}),
      digest_of({}));
}

TEST(StoreDigest, SeesEveryBitOfTheContent) {
  std::set<std::string> digests = {digest_of({})};
  const std::vector<std::function<void(schema::JobResult&)>> changes = {
      [](auto& r) {
        r.mutable_view()->mutable_row(0)->mutable_intensity_w_sr()->set_value(
            std::nextafter(r.view().row(0).intensity_w_sr().value(), 1e9));
      },
      [](auto& r) { r.mutable_view()->mutable_row(1)->set_sun_zenith_deg(1); },
      [](auto& r) {
        r.mutable_view()->mutable_row(1)->mutable_interreflected_w_sr()->set_stderr(1e-9);
      },
      [](auto& r) {
        r.mutable_view()
            ->mutable_row(3)
            ->mutable_spectrum()
            ->set_apparent_spectral_intensity_stderr_w_sr_um(4, 1e-9F);
      },
      [](auto& r) {
        for (auto& row : *r.mutable_view()->mutable_row())
          row.mutable_spectrum()->set_lambda_um(1, row.spectrum().lambda_um(1) + 1e-9);
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_thumbnail()->mutable_exr()->back() ^= 1;
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_thumbnail()->mutable_png()->back() ^= 1;
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_thumbnail()->mutable_stderr_exr()->back() ^= 1;
      },
      [](auto& r) { r.mutable_view()->mutable_silhouette()->set_pixel_samples(16); },
      [](auto& r) { r.mutable_view()->mutable_silhouette()->mutable_part(1)->set_left_px(0); },
      [](auto& r) {
        r.mutable_view()->mutable_silhouette()->mutable_part(0)->mutable_samples()->back() ^= 1;
      },
      [](auto& r) { r.mutable_view()->mutable_silhouette()->mutable_part()->RemoveLast(); },
      [](auto& r) {
        r.mutable_view()->mutable_silhouette()->mutable_part_set(0)->set_outside_px(2);
      },
      [](auto& r) { r.mutable_view()->mutable_silhouette()->mutable_part_set()->RemoveLast(); },
      [](auto& r) { r.mutable_view()->mutable_silhouette()->clear_part_set(); },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_part(1)->mutable_intensity_w_sr()->set_value(-1);
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->set_energy_gain(!r.view().row(2).energy_gain());
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->set_stop_reason(schema::STOP_REASON_SAMPLE_LIMIT);
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_contrast_intensity_w_sr()->set_value(0);
      },
      [](auto& r) {
        r.mutable_view()->mutable_row(0)->set_direction_interpolation_bound_w_sr(1e-9);
      },
      [](auto& r) { r.mutable_view()->mutable_row(0)->set_path_radiance_w_m2_sr(1e-9); },
      [](auto& r) {
        r.mutable_view()->mutable_row(1)->mutable_spectrum()->set_path_radiance_w_m2_sr_um(2,
                                                                                           1e-9F);
      },
      [](auto& r) { r.mutable_view()->mutable_row(0)->set_contrast_omitted_bound_w_sr(1e-9); },
      [](auto& r) { r.mutable_view()->mutable_row(0)->set_absolute_floor_w_sr(1e-9); },
      [](auto& r) { r.mutable_view()->mutable_row(0)->set_reflections(7); },
      [](auto& r) {
        r.mutable_view()->mutable_row(1)->mutable_effect(1)->set_apparent_bound_w_sr(1e-9);
      },
      [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(2)->set_reason("forced"); },
      [](auto& r) {
        r.mutable_view()->mutable_row(1)->mutable_effect(2)->set_state(schema::EFFECT_STATE_ON);
      },
      [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(0)->clear_fraction_w_sr(); },
      [](auto& r) {
        r.mutable_view()->mutable_row(2)->mutable_energy()->mutable_cut_off()->set_value(1e-9);
      },
      [](auto& r) { r.set_samples(1); },
      [](auto& r) { r.set_seed_hex("00000000000000ab"); },
      [](auto& r) { r.set_physics_version(2); },
  };
  for (const auto& change : changes)
    EXPECT_TRUE(digests.insert(digest_of({.change = change})).second);
  // A result that is missing is a difference, too.
  EXPECT_TRUE(digests.insert(digest_of({.order = {0, 1, 2}})).second);
}

}  // namespace
}  // namespace irsig
