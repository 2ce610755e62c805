// Every field comes out as it went in, through the writer and the reader.

#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>

#include <fstream>
#include <random>

#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

using google::protobuf::util::MessageDifferencer;

class StoreContent : public ::testing::Test {
 protected:
  void SetUp() override {
    auto writer = StoreWriter::open(path_);
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
    ASSERT_OK(complete_jobs(**writer, sweep_).status());
    ASSERT_OK((*writer)->finish());
    writer->reset();
    auto reader = StoreReader::open(path_);
    ASSERT_OK(reader.status());
    reader_ = *std::move(reader);
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.sigdb");
  schema::ResolvedSweep sweep_ = make_sweep({});
  std::unique_ptr<StoreReader> reader_;
};

TEST_F(StoreContent, ContentsAreWhatThereIsToChooseFrom) {
  const auto contents = reader_->contents();
  ASSERT_OK(contents.status());
  ASSERT_EQ(contents->size(), 1U);
  const SweepContents& c = contents->front();
  EXPECT_EQ(c.name, "ship");
  EXPECT_EQ(c.viewpoints, 4U);
  EXPECT_EQ(c.rows, 16U);
  EXPECT_EQ(c.whole_rows, 16U);
  ASSERT_EQ(c.condition.size(), 2U);
  EXPECT_EQ(c.condition[1].season, "summer");
  EXPECT_EQ(c.condition[1].time_utc, "2025-06-21T01:30:00Z");
  ASSERT_EQ(c.band.size(), 2U);
  EXPECT_EQ(c.band[1].name, "lwir");
  EXPECT_EQ(c.band[1].lambda_max_um, 12);
  EXPECT_EQ(c.range_m, std::vector<double>{5000});
  EXPECT_TRUE(c.thumbnails);
}

TEST_F(StoreContent, ValuesAreThoseOfTheRows) {
  ValueFilter filter{"ship", "summer", "2025-06-21T01:30:00Z", "lwir", 5000};
  for (const auto& [quantity, value, value_stderr, error] :
       {std::tuple{SignatureQuantity::kIntensity, &StoredSignature::intensity_w_sr,
                   &StoredSignature::intensity_stderr_w_sr, &StoredSignature::numerical_error_w_sr},
        std::tuple{SignatureQuantity::kApparentIntensity, &StoredSignature::apparent_intensity_w_sr,
                   &StoredSignature::apparent_intensity_stderr_w_sr,
                   &StoredSignature::apparent_numerical_error_w_sr},
        std::tuple{SignatureQuantity::kContrastIntensity, &StoredSignature::contrast_intensity_w_sr,
                   &StoredSignature::contrast_intensity_stderr_w_sr,
                   &StoredSignature::contrast_numerical_error_w_sr},
        std::tuple{SignatureQuantity::kBackgroundRadiance,
                   &StoredSignature::background_radiance_w_m2_sr,
                   &StoredSignature::background_radiance_stderr_w_m2_sr,
                   &StoredSignature::background_radiance_stderr_w_m2_sr}}) {
    filter.quantity = quantity;
    const auto values = reader_->values(filter);
    ASSERT_OK(values.status());
    SignatureFilter same;
    same.season = "summer";
    same.band = "lwir";
    const auto rows = reader_->find(same);
    ASSERT_OK(rows.status());
    ASSERT_EQ(values->size(), 4U);
    ASSERT_EQ(rows->size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ((*values)[i].row, (*rows)[i].row);
      EXPECT_EQ((*values)[i].aspect_azimuth_deg, (*rows)[i].aspect_azimuth_deg);
      EXPECT_EQ((*values)[i].aspect_elevation_deg, (*rows)[i].aspect_elevation_deg);
      EXPECT_EQ((*values)[i].value, (*rows)[i].*value);
      EXPECT_EQ((*values)[i].value_stderr, (*rows)[i].*value_stderr);
      EXPECT_EQ((*values)[i].numerical_error, (*rows)[i].*error);
    }
  }
  for (auto* name : {&filter.sweep, &filter.season, &filter.time_utc, &filter.band}) {
    const std::string kept = *name;
    *name = "other";
    EXPECT_TRUE(reader_->values(filter)->empty());
    *name = kept;
  }
  filter.range_m = 5001;
  EXPECT_TRUE(reader_->values(filter)->empty());
}

TEST_F(StoreContent, EveryScalarComesBack) {
  const auto found = reader_->find({});
  ASSERT_OK(found.status());
  ASSERT_EQ(found->size(), 16U);
  const auto jobs = make_jobs(sweep_, "sweep-a");
  std::size_t n = 0;
  for (std::uint32_t v = 0; v < 4; ++v) {
    const schema::JobResult result = make_result(sweep_, jobs[v]);
    for (const schema::SignatureRow& row : result.view().row()) {
      const StoredSignature& s = (*found)[n++];
      EXPECT_EQ(s.row, ((v * 2) + row.condition_index()) * 2 + row.band_index() + 1);
      EXPECT_EQ(s.row, n);
      EXPECT_EQ(s.sweep, "ship");
      EXPECT_EQ(s.season, row.condition_index() == 0 ? "winter" : "summer");
      EXPECT_EQ(s.time_utc, "2025-06-21T01:30:00Z");
      EXPECT_EQ(s.band, row.band_index() == 0 ? "mwir" : "lwir");
      EXPECT_EQ(s.lambda_min_um, row.band_index() == 0 ? 3 : 8);
      EXPECT_EQ(s.lambda_max_um, row.band_index() == 0 ? 5 : 12);
      EXPECT_EQ(s.aspect_azimuth_deg, 90.0 * v);
      EXPECT_EQ(s.aspect_elevation_deg,
                sweep_.viewpoint(static_cast<int>(v)).aspect_elevation_deg());
      EXPECT_EQ(s.range_m, 5000);
      EXPECT_EQ(s.sun_azimuth_deg, row.sun_azimuth_deg());
      EXPECT_EQ(s.sun_zenith_deg, row.sun_zenith_deg());
      EXPECT_EQ(s.intensity_w_sr, row.intensity_w_sr().value());
      EXPECT_EQ(s.intensity_stderr_w_sr, row.intensity_w_sr().stderr());
      EXPECT_EQ(s.numerical_error_w_sr, row.numerical_error_w_sr());
      EXPECT_EQ(s.apparent_intensity_w_sr, row.apparent_intensity_w_sr().value());
      EXPECT_EQ(s.apparent_intensity_stderr_w_sr, row.apparent_intensity_w_sr().stderr());
      EXPECT_EQ(s.apparent_numerical_error_w_sr, row.apparent_numerical_error_w_sr());
      EXPECT_EQ(s.projected_area_m2, row.projected_area_m2().value());
      EXPECT_EQ(s.projected_area_stderr_m2, row.projected_area_m2().stderr());
      EXPECT_EQ(s.source_radiance_temperature_k, row.source_radiance_temperature_k());
      EXPECT_EQ(s.emitted_w_sr, row.emitted_w_sr().value());
      EXPECT_EQ(s.emitted_stderr_w_sr, row.emitted_w_sr().stderr());
      EXPECT_EQ(s.sun_reflected_w_sr, row.sun_reflected_w_sr().value());
      EXPECT_EQ(s.sun_reflected_stderr_w_sr, row.sun_reflected_w_sr().stderr());
      EXPECT_EQ(s.sky_reflected_w_sr, row.sky_reflected_w_sr().value());
      EXPECT_EQ(s.sky_reflected_stderr_w_sr, row.sky_reflected_w_sr().stderr());
      EXPECT_EQ(s.surface_reflected_w_sr, row.surface_reflected_w_sr().value());
      EXPECT_EQ(s.surface_reflected_stderr_w_sr, row.surface_reflected_w_sr().stderr());
      EXPECT_EQ(s.interreflected_w_sr, row.interreflected_w_sr().value());
      EXPECT_EQ(s.interreflected_stderr_w_sr, row.interreflected_w_sr().stderr());
      EXPECT_EQ(s.truncation_bound_w_sr, row.truncation_bound_w_sr());
      EXPECT_EQ(s.quadrature_bound_w_sr, row.quadrature_bound_w_sr());
      EXPECT_EQ(s.undersampling_bound_w_sr, row.undersampling_bound_w_sr());
      EXPECT_EQ(s.spectral_basis_bound_w_sr, row.spectral_basis_bound_w_sr());
      EXPECT_EQ(s.direction_interpolation_bound_w_sr, row.direction_interpolation_bound_w_sr());
      EXPECT_LT(s.contrast_intensity_w_sr, 0);
      EXPECT_EQ(s.contrast_intensity_w_sr, row.contrast_intensity_w_sr().value());
      EXPECT_EQ(s.contrast_intensity_stderr_w_sr, row.contrast_intensity_w_sr().stderr());
      EXPECT_EQ(s.contrast_numerical_error_w_sr, row.contrast_numerical_error_w_sr());
      EXPECT_EQ(s.background_radiance_w_m2_sr, row.background_radiance_w_m2_sr().value());
      EXPECT_EQ(s.background_radiance_stderr_w_m2_sr, row.background_radiance_w_m2_sr().stderr());
      EXPECT_EQ(s.model_error_w_sr, row.model_error_w_sr());
      EXPECT_EQ(s.apparent_model_error_w_sr, row.apparent_model_error_w_sr());
      EXPECT_EQ(s.path_transmittance, row.path_transmittance());
      EXPECT_EQ(s.path_radiance_w_m2_sr, row.path_radiance_w_m2_sr());
      EXPECT_EQ(s.omitted_bound_w_sr, row.omitted_bound_w_sr());
      EXPECT_EQ(s.apparent_omitted_bound_w_sr, row.apparent_omitted_bound_w_sr());
      EXPECT_EQ(s.contrast_omitted_bound_w_sr, row.contrast_omitted_bound_w_sr());
      EXPECT_EQ(s.absolute_floor_w_sr, row.absolute_floor_w_sr());
      EXPECT_EQ(s.reflections, 3U);
      EXPECT_EQ(s.warning, s.season + " is odd\nand so is this");
      EXPECT_EQ(s.stop_reason, "accuracy_reached");
      EXPECT_EQ(s.energy_gain, row.energy_gain());
      EXPECT_EQ(s.samples, result.samples());
      EXPECT_EQ(s.target_paths, result.target_paths());
      EXPECT_EQ(s.rays, result.rays());
      EXPECT_EQ(s.replicates, 32U);
      EXPECT_EQ(s.seconds, 0.5);
      EXPECT_EQ(s.guarded_backface_hits, 3U);
      EXPECT_EQ(s.guarded_nonfinite, 1U);
      EXPECT_EQ(s.truncated_paths, 2U);
      EXPECT_EQ(s.guarded_negative, 4U);
      EXPECT_EQ(s.job_key, jobs[v].job_key());
      EXPECT_EQ(s.seed_hex, "00000000000000aa");
      EXPECT_EQ(s.determinism_class, "test-class");
      EXPECT_EQ(s.build_id, "test-build");
      EXPECT_EQ(s.physics_version, 1U);
    }
  }
}

TEST_F(StoreContent, SpectraPartsAndThumbnailsComeBack) {
  const auto found = reader_->find({});
  ASSERT_OK(found.status());
  const auto jobs = make_jobs(sweep_, "sweep-a");
  std::size_t n = 0;
  for (const schema::JobSpec& job : jobs) {
    const schema::JobResult result = make_result(sweep_, job);
    for (const schema::SignatureRow& row : result.view().row()) {
      const std::int64_t id = (*found)[n++].signature_id;
      const auto spectrum = reader_->spectrum(id);
      ASSERT_OK(spectrum.status());
      EXPECT_TRUE(MessageDifferencer::Equals(*spectrum, row.spectrum()));
      const auto thumbnail = reader_->thumbnail(id);
      ASSERT_OK(thumbnail.status());
      ASSERT_TRUE(thumbnail->has_value());
      EXPECT_TRUE(MessageDifferencer::Equals(**thumbnail, row.thumbnail()));
      const auto parts = reader_->parts(id);
      ASSERT_OK(parts.status());
      ASSERT_EQ(parts->size(), 2U);
      EXPECT_EQ((*parts)[1].part, "part1");
      EXPECT_EQ((*parts)[1].intensity_w_sr, row.part(1).intensity_w_sr().value());
      EXPECT_EQ((*parts)[1].intensity_stderr_w_sr, row.part(1).intensity_w_sr().stderr());
    }
  }
  EXPECT_TRUE(absl::IsNotFound(reader_->spectrum(4711).status()));
  EXPECT_TRUE(absl::IsNotFound(reader_->parts(4711).status()));
  EXPECT_TRUE(absl::IsNotFound(reader_->thumbnail(4711).status()));
}

// schema/README.md promises this to readers in other languages.
TEST_F(StoreContent, BlobsAreLittleEndianFloat32) {
  const schema::JobResult result = make_result(sweep_, make_jobs(sweep_, "")[0]);
  const float first = result.view().row(0).spectrum().emitted_w_sr_um(0);
  std::uint32_t bits = 0;
  std::memcpy(&bits, &first, 4);
  std::string hex;
  for (int byte = 0; byte < 4; ++byte) {
    absl::StrAppend(&hex, absl::Hex(bits >> (8 * byte) & 0xff, absl::kZeroPad2));
  }
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT lower(hex(substr(emitted_w_sr_um, 1, 4))) FROM spectrum"
                        " JOIN signature_view USING (signature_id) WHERE row = 1"),
            hex);
}

TEST_F(StoreContent, ViewsAreReadableByPeople) {
  EXPECT_EQ(
      sqlite_text(
          path_,
          "SELECT season || ' ' || band || ' ' || row || ' ' || stop_reason FROM signature_view"
          " WHERE viewpoint_id IS NULL OR row = 7"),
      "error: no such column: viewpoint_id");
  EXPECT_EQ(
      sqlite_text(
          path_,
          "SELECT season || ' ' || band || ' ' || stop_reason FROM signature_view WHERE row = 7"),
      "summer mwir accuracy_reached");
  EXPECT_EQ(sqlite_text(path_, "SELECT state || ' ' || done_by FROM job_view WHERE job_index = 3"),
            "done host:1");
  EXPECT_EQ(sqlite_text(path_, "SELECT done || '/' || jobs FROM sweep_view"), "4/4");
  EXPECT_EQ(sqlite_text(path_, "SELECT outcome FROM attempt_view WHERE job_index = 3"), "done");
  EXPECT_EQ(sqlite_text(path_,
                        "SELECT temperature_k FROM part_temperature_view WHERE season = 'summer'"
                        " AND part = 'part1'"),
            "301.0");
  EXPECT_EQ(sqlite_text(path_, "SELECT count(*) FROM part_intensity_view"), "32");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA integrity_check"), "ok");
  EXPECT_EQ(sqlite_text(path_, "PRAGMA foreign_key_check"), "(no row)");
  EXPECT_EQ(
      sqlite_text(
          path_,
          "SELECT count(*) FROM pragma_table_list WHERE schema = 'main' AND type = 'table'"
          " AND NOT strict AND name NOT LIKE 'sqlite_%' AND name NOT LIKE 'viewpoint_direction%'"),
      "0");
}

// Only a row that missed its accuracy has a limit, which follows from the row's own numbers.
TEST_F(StoreContent, ARowThatMissedItsAccuracyNamesTheLimit) {
  struct Case {
    schema::StopReason stop;
    const char* bound;  // that is made large
    std::string limit;
  };
  const Case cases[] = {
      {schema::STOP_REASON_ACCURACY_NOT_REACHED, "temperature_bound_w_sr", "temperature"},
      {schema::STOP_REASON_SAMPLE_LIMIT, "omitted_bound_w_sr", "omitted"},
      {schema::STOP_REASON_SAMPLE_LIMIT, "undersampling_stderr_w_sr", "undersampling"},
      {schema::STOP_REASON_ACCURACY_NOT_REACHED, "quadrature_bound_w_sr", "quadrature"},
      {schema::STOP_REASON_ACCURACY_REACHED, "temperature_bound_w_sr", ""},
      {schema::STOP_REASON_FLOOR_REACHED, "temperature_bound_w_sr", ""}};
  for (const Case& c : cases) {
    TestFolder folder;
    auto writer = StoreWriter::open(folder.file("b.sigdb"));
    ASSERT_OK(writer.status());
    ASSERT_OK(submit(**writer, sweep_, "sweep-a").status());
    ASSERT_OK((*writer)->begin());
    const auto job = (*writer)->lease_next("worker", 0);
    ASSERT_OK(job.status());
    ASSERT_TRUE(job->has_value());
    schema::JobResult result = make_result(sweep_, (*job)->spec);
    for (schema::SignatureRow& row : *result.mutable_view()->mutable_row()) {
      row.set_stop_reason(c.stop);
      const auto* field = row.GetDescriptor()->FindFieldByName(c.bound);
      row.GetReflection()->SetDouble(&row, field, 1e6);
    }
    ASSERT_OK((*writer)->complete((*job)->fencing_token, result, "host:1"));
    ASSERT_OK((*writer)->commit());
    ASSERT_OK((*writer)->finish());
    writer->reset();
    EXPECT_EQ(sqlite_text(
                  folder.file("b.sigdb"),
                  "SELECT group_concat(DISTINCT coalesce(limiting_bound, '')) FROM signature_view"),
              c.limit)
        << c.bound;
    const auto reader = StoreReader::open(folder.file("b.sigdb"));
    ASSERT_OK(reader.status());
    const auto values = (*reader)->find({});
    ASSERT_OK(values.status());
    for (const StoredSignature& row : *values) EXPECT_EQ(row.limiting_bound, c.limit) << c.bound;
  }
}

TEST_F(StoreContent, TheSweepComesBack) {
  const auto sweep = reader_->sweep("ship");
  ASSERT_OK(sweep.status());
  EXPECT_TRUE(MessageDifferencer::Equals(sweep->resolved, sweep_));
  EXPECT_TRUE(sweep->assets.empty());
  EXPECT_TRUE(absl::IsNotFound(reader_->sweep("boat").status()));
}

// A filter on names must not read the whole table.
TEST_F(StoreContent, FiltersByName) {
  SignatureFilter filter;
  filter.season = "summer";
  filter.band = "lwir";
  auto found = reader_->find(filter);
  ASSERT_OK(found.status());
  ASSERT_EQ(found->size(), 4U);
  for (const StoredSignature& s : *found) EXPECT_EQ(s.season + s.band, "summerlwir");
  filter.sweep = "another";
  found = reader_->find(filter);
  ASSERT_OK(found.status());
  EXPECT_TRUE(found->empty());
  filter = {};
  filter.row = 6;
  found = reader_->find(filter);
  ASSERT_OK(found.status());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().row, 6U);
  for (const std::uint64_t row : {0U, 17U}) {
    filter.row = row;
    found = reader_->find(filter);
    ASSERT_OK(found.status());
    EXPECT_TRUE(found->empty()) << row;
  }
}

TEST_F(StoreContent, FiltersByRelativeError) {
  const auto all = reader_->find({});
  ASSERT_OK(all.status());
  std::vector<double> errors;
  for (const StoredSignature& s : *all) errors.push_back(s.numerical_error_w_sr / s.intensity_w_sr);
  std::sort(errors.begin(), errors.end());
  SignatureFilter filter;
  filter.max_relative_error = (errors[6] + errors[7]) / 2;
  const auto found = reader_->find(filter);
  ASSERT_OK(found.status());
  EXPECT_EQ(found->size(), 7U);
}

// The error is that of the quantity asked for; contrast is negative in the fixture.
TEST_F(StoreContent, FiltersByTheRelativeErrorOfAQuantity) {
  const auto all = reader_->find({});
  ASSERT_OK(all.status());
  using S = StoredSignature;
  struct Case {
    SignatureQuantity of;
    double S::*value, S::*error;
  };
  for (const Case& c :
       {Case{SignatureQuantity::kApparentIntensity, &S::apparent_intensity_w_sr,
             &S::apparent_numerical_error_w_sr},
        Case{SignatureQuantity::kContrastIntensity, &S::contrast_intensity_w_sr,
             &S::contrast_numerical_error_w_sr},
        Case{SignatureQuantity::kBackgroundRadiance, &S::background_radiance_w_m2_sr,
             &S::background_radiance_stderr_w_m2_sr}}) {
    std::vector<double> errors;
    for (const S& s : *all) errors.push_back(s.*c.error / std::abs(s.*c.value));
    std::sort(errors.begin(), errors.end());
    SignatureFilter filter;
    filter.max_relative_error = (errors[4] + errors[5]) / 2;
    filter.error_of = c.of;
    auto found = reader_->find(filter);
    ASSERT_OK(found.status());
    EXPECT_EQ(found->size(), 5U) << static_cast<int>(c.of);
    filter.direction = {0, 0};  // the other statement
    found = reader_->find(filter);
    ASSERT_OK(found.status());
    EXPECT_EQ(found->size(), 5U) << static_cast<int>(c.of);
  }
}

TEST_F(StoreContent, DirectionsThatMakeNoSenseAreRefused) {
  SignatureFilter filter;
  filter.nearest = 1;
  EXPECT_TRUE(absl::IsInvalidArgument(reader_->find(filter).status()));
  filter.direction = {0, 0};
  filter.within_deg = 1;
  EXPECT_TRUE(absl::IsInvalidArgument(reader_->find(filter).status()));
  filter.within_deg.reset();
  filter.direction = {0, 91};
  EXPECT_TRUE(absl::IsInvalidArgument(reader_->find(filter).status()));
}

}  // namespace
}  // namespace irsig
