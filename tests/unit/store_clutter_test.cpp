// The background around a row's target: stored as it came, all of it or nothing, in the digest of
// rows that have it.
#include <cmath>
#include <limits>

#include "core/accuracy/spectral_modes.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

// All that a row with a measured background has beside the others.
void add_clutter(schema::SignatureRow& row) {
  row.set_clutter_window_m(640);
  row.set_clutter_pixel_m(2.5);
  double next = 1;
  for (schema::Estimate* e :
       {row.mutable_clutter_mean_w_m2_sr(), row.mutable_clutter_sigma_w_m2_sr(),
        row.mutable_clutter_skewness(), row.mutable_clutter_correlation_m(),
        row.mutable_clutter_patch_sigma_w_m2_sr()}) {
    e->set_value(next += 0.25);
    e->set_stderr(0.125);
  }
  row.mutable_clutter_skewness()->set_value(-0.5);
  row.set_clutter_cells(80);
  row.set_clutter_patch_m(10);
  row.set_clutter_modes_fraction(0.9995);
  row.set_visible_fraction(0.75);
  schema::Clutter& clutter = *row.mutable_clutter();
  std::vector<double> sigma, mode;
  for (int i = 0; i < row.spectrum().lambda_um_size(); ++i) {
    clutter.add_patch_sigma_w_m2_sr_um(static_cast<float>(0.5 + i));
    sigma.push_back(0.5 + i);
    mode.push_back(i % 2 == 0 ? 0.5 + i : -0.5 * (0.5 + i));
  }
  clutter.set_modes(encoded_modes({mode}, sigma));
  clutter.add_material_fraction(0.75);
  clutter.add_material_fraction(0);
  clutter.add_material_fraction(0.25);
}

class StoreClutter : public ::testing::Test {
 protected:
  void write(bool clutter) {
    auto writer = StoreWriter::open(path_).value();
    ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
    ASSERT_OK(writer->begin());
    while (true) {
      const auto job = writer->lease_next("worker", 0).value();
      if (!job) break;
      schema::JobResult result = make_result(sweep_, job->spec);
      if (clutter)
        for (auto& row : *result.mutable_view()->mutable_row()) add_clutter(row);
      ASSERT_OK(writer->complete(job->fencing_token, result, "w"));
    }
    ASSERT_OK(writer->commit());
    ASSERT_OK(writer->finish());
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

TEST_F(StoreClutter, ComesBackAsItCame) {
  ASSERT_NO_FATAL_FAILURE(write(true));
  auto reader = StoreReader::open(path_).value();
  const auto rows = reader->find({}).value();
  ASSERT_FALSE(rows.empty());
  for (const StoredSignature& s : rows) {
    EXPECT_EQ(s.clutter_window_m, 640);
    EXPECT_EQ(s.clutter_mean_w_m2_sr, 1.25);
    EXPECT_EQ(s.clutter_sigma_stderr_w_m2_sr, 0.125);
    EXPECT_EQ(s.clutter_skewness, -0.5);
    EXPECT_EQ(s.clutter_patch_sigma_w_m2_sr, 2.25);
    EXPECT_EQ(s.visible_fraction, 0.75);
    const auto clutter = reader->clutter(s.signature_id).value();
    ASSERT_TRUE(clutter.has_value());
    const auto bins = reader->spectrum(s.signature_id).value().lambda_um_size();
    ASSERT_EQ(clutter->patch_sigma_w_m2_sr_um_size(), bins);
    EXPECT_EQ(clutter->patch_sigma_w_m2_sr_um(1), 1.5F);
    const auto& sigma = clutter->patch_sigma_w_m2_sr_um();
    const auto errors =
        SumErrors::make({sigma.data(), static_cast<std::size_t>(bins)}, clutter->modes()).value();
    ASSERT_EQ(errors.modes().size(), 1U);
    EXPECT_NEAR(errors.modes()[0][1], -0.75, 1e-4);
    ASSERT_EQ(clutter->material_fraction_size(), 3);
    EXPECT_EQ(clutter->material_fraction(2), 0.25);
  }
  const std::string digest = reader->digest().value();
  reader.reset();
  std::string before = digest;
  for (const char* change :
       {"UPDATE signature SET clutter_cells = 81",
        "UPDATE clutter SET modes = zeroblob(length(modes))",
        "UPDATE clutter_material SET fraction = 0.5 WHERE material_index = 1"}) {
    sqlite_text(path_, change);
    const std::string after = StoreReader::open(path_).value()->digest().value();
    EXPECT_NE(after, before) << change;
    before = after;
  }
}

TEST_F(StoreClutter, RowsWithoutHaveNone) {
  ASSERT_NO_FATAL_FAILURE(write(false));
  auto reader = StoreReader::open(path_).value();
  for (const StoredSignature& s : reader->find({}).value()) {
    EXPECT_TRUE(std::isnan(s.clutter_window_m));
    EXPECT_TRUE(std::isnan(s.clutter_patch_sigma_w_m2_sr));
    EXPECT_TRUE(std::isnan(s.visible_fraction));
    EXPECT_FALSE(reader->clutter(s.signature_id).value().has_value());
  }
}

TEST_F(StoreClutter, PiecesOfItAreRefused) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const auto job = writer->lease_next("worker", 0).value();
  ASSERT_TRUE(job.has_value());
  const auto refused = [&](auto change, const std::string& what) {
    schema::JobResult result = make_result(sweep_, job->spec);
    add_clutter(*result.mutable_view()->mutable_row(1));
    change(*result.mutable_view()->mutable_row(1));
    const absl::Status status = writer->complete(job->fencing_token, result, "w");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_NE(status.message().find("row[1]." + what), absl::string_view::npos) << status;
  };
  refused([](auto& row) { row.clear_clutter_skewness(); }, "clutter_skewness");
  refused([](auto& row) { row.clear_clutter_window_m(); }, "clutter_pixel_m");
  refused([](auto& row) { row.clear_visible_fraction(); }, "visible_fraction");
  refused([](auto& row) { row.clear_clutter(); }, "clutter");
  refused([](auto& row) { row.mutable_clutter_sigma_w_m2_sr()->set_value(-1); },
          "clutter_sigma_w_m2_sr.value is negative");
  refused(
      [](auto& row) {
        row.mutable_clutter_mean_w_m2_sr()->set_value(std::numeric_limits<double>::quiet_NaN());
      },
      "clutter_mean_w_m2_sr.value is not a finite number");
  refused([](auto& row) { row.set_visible_fraction(-0.1); }, "visible_fraction is negative");
  refused([](auto& row) { row.set_clutter_cells(0.5); }, "clutter_cells is less than 1");
  refused([](auto& row) { row.set_clutter_pixel_m(0); }, "clutter has a window, pixel");
  refused([](auto& row) { row.mutable_clutter()->add_patch_sigma_w_m2_sr_um(1); },
          "clutter.patch_sigma_w_m2_sr_um has ");
  refused([](auto& row) { row.mutable_clutter()->set_patch_sigma_w_m2_sr_um(0, -1); },
          "clutter.patch_sigma_w_m2_sr_um[0] is negative");
  refused([](auto& row) { row.mutable_clutter()->set_modes("x"); }, "clutter.modes has 1 bytes");
  refused([](auto& row) { row.mutable_clutter()->set_material_fraction(1, -1); },
          "clutter.material_fraction[1] is negative");
}

TEST_F(StoreClutter, DamageIsFound) {
  ASSERT_NO_FATAL_FAILURE(write(true));
  sqlite_text(path_, "UPDATE clutter SET modes = x'01' WHERE rowid = 2");
  auto reader = StoreReader::open(path_).value();
  EXPECT_TRUE(absl::IsDataLoss(reader->clutter(2).status())) << reader->clutter(2).status();
  EXPECT_TRUE(reader->clutter(1).ok());
}

}  // namespace
}  // namespace irsig
