// Contributions of uncertain inputs to a row are stored as they came, refused if the sweep asks for
// others, and absent from everything where a sweep asks for none.
#include <cmath>

#include "absl/strings/str_cat.h"
#include "schema/store/check/check_heat_result.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

class StoreInputs : public ::testing::Test {
 protected:
  StoreInputs() {
    schema::Uncertainty& stated = *sweep_.mutable_sweep()->mutable_uncertainty();
    stated.set_air_temperature_k(1);
    stated.set_emissivity(0.02);
    stated.set_part_temperature_k(2);
    stated.set_sea_temperature_k(1);
  }
  void write() {
    auto writer = StoreWriter::open(path_).value();
    ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
    ASSERT_OK(complete_jobs(*writer, sweep_).status());
    ASSERT_OK(writer->finish());
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
};

TEST_F(StoreInputs, ComeBackAsTheyCame) {
  ASSERT_NO_FATAL_FAILURE(write());
  auto reader = StoreReader::open(path_).value();
  const auto rows = reader->find({}).value();
  ASSERT_EQ(rows.size(), 16U);
  const auto jobs = make_jobs(sweep_, "sweep-a");
  for (const StoredSignature& s : rows) {
    EXPECT_GT(s.input_uncertainty_w_sr, 0);
    EXPECT_GT(s.contrast_input_uncertainty_w_sr, s.apparent_input_uncertainty_w_sr);
    const auto inputs = reader->inputs(s.signature_id);
    ASSERT_OK(inputs.status());
    ASSERT_EQ(inputs->size(), 4U);
    EXPECT_EQ((*inputs)[0].input, "air_temperature_k");
    EXPECT_EQ((*inputs)[1].input, "emissivity");
    EXPECT_EQ((*inputs)[1].source.stderr_w_sr, 0.125);
    EXPECT_TRUE(std::isnan((*inputs)[1].source.curvature_w_sr));
    // They fall from one to the next: the last three, from the largest on.
    EXPECT_EQ(s.dominant_inputs.rfind("sea_temperature_k=-", 0), 0U) << s.dominant_inputs;
    EXPECT_NE(s.dominant_inputs.find(", part_temperature_k=-"), std::string::npos);
    EXPECT_EQ(s.dominant_inputs.find("air_temperature_k"), std::string::npos);
  }
  const std::string digest = reader->digest().value();
  reader.reset();
  sqlite_text(path_, "UPDATE input_contribution SET contribution_w_sr = contribution_w_sr * 1.001");
  EXPECT_NE(StoreReader::open(path_).value()->digest().value(), digest);
}

// Noise is not called dominant.
TEST_F(StoreInputs, WithinTheirNoiseAreNotNamed) {
  ASSERT_NO_FATAL_FAILURE(write());
  sqlite_text(
      path_,
      "UPDATE input_contribution SET contribution_stderr_w_sr = 0.51 * abs(contribution_w_sr)"
      " WHERE input <> 'emissivity'");
  const auto rows = StoreReader::open(path_).value()->find({}).value();
  ASSERT_EQ(rows.size(), 16U);
  for (const StoredSignature& s : rows) {
    EXPECT_EQ(s.dominant_inputs.rfind("emissivity=-", 0), 0U) << s.dominant_inputs;
    EXPECT_EQ(s.dominant_inputs.find(','), std::string::npos);
  }
}

TEST_F(StoreInputs, ThatTheSweepDoesNotAskForAreRefused) {
  auto writer = StoreWriter::open(path_).value();
  ASSERT_OK(submit(*writer, sweep_, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const auto job = writer->lease_next("worker", 0).value();
  ASSERT_TRUE(job.has_value());
  const auto refused = [&](auto change, const std::string& what) {
    schema::JobResult result = make_result(sweep_, job->spec);
    change(*result.mutable_view()->mutable_row(1));
    const absl::Status status = writer->complete(job->fencing_token, result, "w");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_NE(status.message().find("row[1]." + what), absl::string_view::npos) << status;
  };
  refused([](auto& row) { row.mutable_input()->RemoveLast(); },
          "input has 3 of the sweep's 4 uncertain inputs");
  refused([](auto& row) { row.mutable_input(0)->set_input("emissivity"); },
          "input[0] is not the sweep's, air_temperature_k");
  refused([](auto& row) { row.mutable_input(2)->clear_apparent_contribution_w_sr(); },
          "input[2] is incomplete");
  refused([](auto& row) { row.clear_contrast_input_uncertainty_w_sr(); },
          "input_uncertainty_w_sr is missing");
  refused([](auto& row) { row.set_input_uncertainty_w_sr(-1); },
          "input_uncertainty_w_sr is negative");
  refused([](auto& row) { row.mutable_input(0)->mutable_contribution_w_sr()->set_value(NAN); },
          "input[0].contribution_w_sr.value is not a finite number");
  ASSERT_OK(writer->complete(job->fencing_token, make_result(sweep_, job->spec), "w"));
}

// A row of a sweep that states none has none, and its digest knows nothing of them.
TEST_F(StoreInputs, AreAbsentWhereNoneAreStated) {
  sweep_.mutable_sweep()->clear_uncertainty();
  ASSERT_NO_FATAL_FAILURE(write());
  auto reader = StoreReader::open(path_).value();
  const auto rows = reader->find({}).value();
  ASSERT_EQ(rows.size(), 16U);
  for (const StoredSignature& s : rows) {
    EXPECT_TRUE(std::isnan(s.input_uncertainty_w_sr));
    EXPECT_TRUE(std::isnan(s.contrast_input_uncertainty_w_sr));
    EXPECT_EQ(s.dominant_inputs, "");
    EXPECT_TRUE(reader->inputs(s.signature_id).value().empty());
  }
}

// Heat jobs of moved inputs have a change for each, and no temperature.
TEST(HeatChanges, ThatWereNotAskedForAreRefused) {
  schema::HeatRun run;
  run.set_season("winter");
  run.add_time_utc("2025-06-21T01:30:00Z");
  run.add_part_temperature_k(0);
  for (const char* name : {"air_temperature_k", "emissivity"}) run.add_input()->set_name(name);
  const auto checked = [&](auto change) {
    schema::HeatField field;
    field.add_unix_s(1750469400);
    field.set_facets(3);
    for (int input = 0; input < 2; ++input) {
      std::string& bytes = *field.add_change_k();
      for (const float value : {1.0F, -2.0F, NAN})
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    schema::JobResult result;
    result.set_job_key("key");
    result.set_seed_hex("0000000000000000");
    change(field, *result.mutable_heat());
    result.mutable_heat()->set_field(field.SerializeAsString());
    return check_heat_result(result, "key", run, 0);
  };
  ASSERT_OK(checked([](auto&, auto&) {}));
  const auto refused = [&](auto change, const std::string& what) {
    const absl::Status status = checked(change);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_NE(status.message().find(what), absl::string_view::npos) << status;
  };
  refused([](auto& f, auto&) { f.mutable_change_k()->RemoveLast(); }, "has 1 changes for 2 inputs");
  refused([](auto& f, auto&) { f.set_kelvin("hot"); }, "or temperatures");
  refused([](auto& f, auto&) { f.mutable_change_k(1)->resize(8); },
          "field.change_k[1] has 8 bytes for 1 times and 3 facets");
  refused(
      [](auto& f, auto&) {
        const float infinite = INFINITY;
        f.mutable_change_k(0)->replace(4, 4, reinterpret_cast<const char*>(&infinite), 4);
      },
      "field.change_k[0][1] is inf");
  refused([](auto&, auto& heat) { heat.add_part()->set_mean_k(300); }, "was not asked for");
}

}  // namespace
}  // namespace irsig
