// Hot gas of a row: stored as it came, all of it or nothing, in the digest of rows that have it.
#include <cmath>

#include "core/effects/effects.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

// All that a row with hot gas has beside the others.
void add_plume(schema::SignatureRow& row) {
  double next = 1;
  for (schema::Estimate* e : {row.mutable_plume_w_sr(), row.mutable_apparent_plume_w_sr(),
                              row.mutable_contrast_plume_w_sr()}) {
    e->set_value(-(next += 0.25));
    e->set_stderr(0.125);
  }
  row.set_plume_emitted_w_sr(next += 1);
  row.set_apparent_plume_emitted_w_sr(next += 1);
  row.set_plume_bound_w_sr(next += 1);
  row.set_apparent_plume_bound_w_sr(next += 1);
  row.set_contrast_plume_bound_w_sr(next += 1);
  row.set_plume_model_error_w_sr(next += 1);
  for (schema::Estimate* e :
       {row.mutable_plume_reflected_w_sr(), row.mutable_apparent_plume_reflected_w_sr()}) {
    e->set_value(-0.5);
    e->set_stderr(0.0625);
  }
  for (const EffectInfo& effect : plume_effect_table()) {
    schema::EffectEntry& entry = *row.add_effect();
    entry.set_effect(std::string(effect.name));
    entry.set_state(schema::EFFECT_STATE_ON);
    entry.set_reason("not_asked");
  }
  row.mutable_plume_area_m2()->set_value(next += 1);
  row.mutable_plume_area_m2()->set_stderr(0.125);
  row.set_plume_voxel_error_w_sr(next += 1);
  schema::Spectrum& spectrum = *row.mutable_spectrum();
  for (int f = 0; f < spectrum.GetDescriptor()->field_count(); ++f) {
    const auto* field = spectrum.GetDescriptor()->field(f);
    if (field->name().find("plume") == std::string::npos) continue;
    for (int i = 0; i < spectrum.lambda_um_size(); ++i)
      spectrum.GetReflection()->AddFloat(&spectrum, field, static_cast<float>(next += 0.5));
  }
}

class StorePlume : public ::testing::Test {
 protected:
  // Every row of the first job with hot gas.
  void write(bool plume) {
    auto writer = StoreWriter::open(path_).value();
    ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
    ASSERT_OK(writer->begin());
    while (true) {
      const auto job = writer->lease_next("worker", 0).value();
      if (!job) break;
      schema::JobResult result = make_result(sweep_, job->spec);
      if (plume)
        for (auto& row : *result.mutable_view()->mutable_row()) add_plume(row);
      ASSERT_OK(writer->complete(job->fencing_token, result, "w"));
    }
    ASSERT_OK(writer->commit());
    ASSERT_OK(writer->finish());
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

TEST_F(StorePlume, ComesBackAsItCame) {
  ASSERT_NO_FATAL_FAILURE(write(true));
  auto reader = StoreReader::open(path_).value();
  const auto rows = reader->find({}).value();
  ASSERT_FALSE(rows.empty());
  for (const StoredSignature& s : rows) {
    EXPECT_EQ(s.plume_w_sr, -1.25);
    EXPECT_EQ(s.contrast_plume_w_sr, -1.75);
    EXPECT_EQ(s.contrast_plume_stderr_w_sr, 0.125);
    EXPECT_EQ(s.plume_emitted_w_sr, 2.75);
    EXPECT_EQ(s.plume_model_error_w_sr, 7.75);
    EXPECT_EQ(s.plume_reflected_w_sr, -0.5);
    EXPECT_EQ(s.apparent_plume_reflected_stderr_w_sr, 0.0625);
    EXPECT_EQ(reader->ledger(s.signature_id).value().effect.size(), kEffects + kPlumeEffects);
    EXPECT_EQ(s.plume_area_m2, 8.75);
    EXPECT_EQ(s.plume_area_stderr_m2, 0.125);
    EXPECT_EQ(s.plume_voxel_error_w_sr, 9.75);
    const auto spectrum = reader->spectrum(s.signature_id).value();
    EXPECT_EQ(spectrum.plume_w_sr_um_size(), spectrum.lambda_um_size());
    EXPECT_EQ(spectrum.plume_w_sr_um(0), 10.25F);
    EXPECT_GT(spectrum.contrast_plume_stderr_w_sr_um(0), spectrum.contrast_plume_w_sr_um(0));
  }
  const std::string digest = reader->digest().value();
  reader.reset();
  sqlite_text(path_, "UPDATE signature SET plume_bound_w_sr = 1.001 * plume_bound_w_sr");
  const std::string bound = StoreReader::open(path_).value()->digest().value();
  EXPECT_NE(bound, digest);
  sqlite_text(path_, "UPDATE signature SET plume_area_m2 = 1.001 * plume_area_m2");
  const std::string other = StoreReader::open(path_).value()->digest().value();
  EXPECT_NE(other, bound);
  sqlite_text(path_, "UPDATE spectrum SET apparent_plume_w_sr_um = plume_w_sr_um");
  EXPECT_NE(StoreReader::open(path_).value()->digest().value(), other);
}

TEST_F(StorePlume, RowsWithoutHaveNone) {
  ASSERT_NO_FATAL_FAILURE(write(false));
  auto reader = StoreReader::open(path_).value();
  const auto rows = reader->find({}).value();
  ASSERT_FALSE(rows.empty());
  for (const StoredSignature& s : rows) {
    EXPECT_TRUE(std::isnan(s.plume_w_sr));
    EXPECT_TRUE(std::isnan(s.plume_model_error_w_sr));
    EXPECT_TRUE(std::isnan(s.plume_area_m2));
    EXPECT_TRUE(std::isnan(s.plume_voxel_error_w_sr));
    EXPECT_EQ(reader->spectrum(s.signature_id).value().plume_w_sr_um_size(), 0);
  }
}

TEST_F(StorePlume, PiecesOfItAreRefused) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const auto job = writer->lease_next("worker", 0).value();
  ASSERT_TRUE(job.has_value());
  const auto refused = [&](auto change, const std::string& what) {
    schema::JobResult result = make_result(sweep_, job->spec);
    add_plume(*result.mutable_view()->mutable_row(1));
    change(*result.mutable_view()->mutable_row(1));
    const absl::Status status = writer->complete(job->fencing_token, result, "w");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_NE(status.message().find("row[1]." + what), absl::string_view::npos) << status;
  };
  refused([](auto& row) { row.clear_apparent_plume_w_sr(); }, "apparent_plume_w_sr");
  refused([](auto& row) { row.clear_plume_bound_w_sr(); }, "plume_bound_w_sr");
  refused([](auto& row) { row.clear_plume_w_sr(); }, "apparent_plume_w_sr");
  refused([](auto& row) { row.clear_plume_reflected_w_sr(); }, "plume_reflected_w_sr");
  refused([](auto& row) { row.mutable_effect()->RemoveLast(); },
          "effect lacks hot_line_correlation");
  refused([](auto& row) { row.set_plume_bound_w_sr(-1); }, "plume_bound_w_sr is negative");
  refused([](auto& row) { row.mutable_spectrum()->clear_contrast_plume_w_sr_um(); },
          "spectrum.contrast_plume_w_sr_um has 0 values");
  refused([](auto& row) { row.clear_plume_area_m2(); }, "plume_area_m2");
  refused([](auto& row) { row.set_plume_voxel_error_w_sr(-1); },
          "plume_voxel_error_w_sr is negative");
}

}  // namespace
}  // namespace irsig
