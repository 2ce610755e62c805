// A result that is not exactly its job's is refused, names the field, and leaves nothing behind.

#include <cmath>
#include <limits>

#include "schema/store/check/check_picture.h"
#include "schema/store/ingest.h"
#include "schema/store/open_database.h"
#include "schema/store/queue.h"
#include "schema/store/tables/content.h"
#include "tests/unit/store_fixture.h"

namespace irsig {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Damage {
  std::string expected_message;
  std::function<void(schema::JobResult&)> apply;
};

TEST(StoreResult, WhatDoesNotMatchItsJobIsRefused) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  auto writer = StoreWriter::open(path).value();
  ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
  ASSERT_OK(complete_jobs(*writer, sweep, 1).status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();

  const std::vector<Damage> damages = {
      {"job_key", [](auto& r) { r.set_job_key("another"); }},
      {"seed_hex is not of 16", [](auto& r) { r.clear_seed_hex(); }},
      {"seed_hex is not of 16", [](auto& r) { r.set_seed_hex("00000000000000AA"); }},
      {"seed_hex is not of 16", [](auto& r) { r.set_seed_hex("000000000000000aa"); }},
      {"missing for condition 1, band 1",
       [](auto& r) { r.mutable_view()->mutable_row()->RemoveLast(); }},
      {"kind is not the job's", [](auto& r) { r.clear_view(); }},
      {"comes twice", [](auto& r) { *r.mutable_view()->add_row() = r.view().row(0); }},
      {"does not belong to the job",
       [](auto& r) { r.mutable_view()->mutable_row(0)->set_condition_index(7); }},
      {"row[2].intensity_w_sr.value is not a finite number",
       [](auto& r) {
         r.mutable_view()->mutable_row(2)->mutable_intensity_w_sr()->set_value(kNan);
       }},
      {"row[2].sun_azimuth_deg is not a finite number",
       [](auto& r) { r.mutable_view()->mutable_row(2)->set_sun_azimuth_deg(INFINITY); }},
      {"row[0].intensity_w_sr.stderr is negative",
       [](auto& r) { r.mutable_view()->mutable_row(0)->mutable_intensity_w_sr()->set_stderr(-1); }},
      {"row[0].projected_area_m2.value is negative",
       [](auto& r) {
         r.mutable_view()->mutable_row(0)->mutable_projected_area_m2()->set_value(-1);
       }},
      {"row[0].emitted_w_sr is missing",
       [](auto& r) { r.mutable_view()->mutable_row(0)->clear_emitted_w_sr(); }},
      {"row[0].spectrum is missing",
       [](auto& r) { r.mutable_view()->mutable_row(0)->clear_spectrum(); }},
      {"row[1].spectrum.emitted_w_sr_um has 4 values for 5 wavelengths",
       [](auto& r) {
         r.mutable_view()
             ->mutable_row(1)
             ->mutable_spectrum()
             ->mutable_emitted_w_sr_um()
             ->RemoveLast();
       }},
      {"row[1].spectrum.sky_reflected_w_sr_um[3] is not a finite number",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_spectrum()->set_sky_reflected_w_sr_um(3, NAN);
       }},
      {"lambda_um does not increase",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_spectrum()->set_lambda_um(
             3, r.view().row(1).spectrum().lambda_um(2));
       }},
      {"differ from those stored",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_spectrum()->set_lambda_um(
             3, r.view().row(1).spectrum().lambda_um(3) + 1e-6);
       }},
      {"reaches outside the band",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_spectrum()->set_lambda_um(
             4, r.view().row(1).spectrum().lambda_um(4) + 1);
       }},
      {"1 of the sweep's 2 parts",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_part()->RemoveLast(); }},
      {"names part 0 twice",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_part(1)->set_part_index(0); }},
      {"names part 9 twice, or it does not exist",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_part(1)->set_part_index(9); }},
      {"row[0].contrast_intensity_w_sr is missing",
       [](auto& r) { r.mutable_view()->mutable_row(0)->clear_contrast_intensity_w_sr(); }},
      {"row[0].contrast_numerical_error_w_sr is negative",
       [](auto& r) { r.mutable_view()->mutable_row(0)->set_contrast_numerical_error_w_sr(-1); }},
      {"row[1].spectrum.path_transmittance has 0 values for 5 wavelengths",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_spectrum()->clear_path_transmittance();
       }},
      {"row[1].spectrum.contrast_spectral_intensity_modes has 9 bytes, expected a multiple of 10",
       [](auto& r) {
         r.mutable_view()
             ->mutable_row(1)
             ->mutable_spectrum()
             ->set_contrast_spectral_intensity_modes(std::string(9, '\0'));
       }},
      {"row[0].effect lacks refraction",
       [](auto& r) { r.mutable_view()->mutable_row(0)->mutable_effect()->RemoveLast(); }},
      {"row[0].effect lacks ", [](auto& r) { r.mutable_view()->mutable_row(0)->clear_effect(); }},
      {"row[1].effect[19] is there twice: direct_sun",
       [](auto& r) {
         *r.mutable_view()->mutable_row(1)->add_effect() = r.view().row(1).effect(1);
       }},
      {"row[1].effect[2] names an unknown effect: \"moonlight\"",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_effect(2)->set_effect("moonlight");
       }},
      {"row[1].effect[2] (diffuse_sun) has an unknown reason: \"mood\"",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(2)->set_reason("mood"); }},
      {"row[1].effect[2] (diffuse_sun) has no state",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(2)->clear_state(); }},
      {"row[1].effect[1] (direct_sun) is off without a bound",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_effect(1)->clear_contrast_bound_w_sr();
       }},
      {"row[1].effect[1].bound_w_sr is negative",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(1)->set_bound_w_sr(-1); }},
      {"row[1].effect[0].fraction_w_sr is not a finite number",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_effect(0)->set_fraction_w_sr(INFINITY);
       }},
      {"row[1].effect[1].time_s is negative",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_effect(1)->set_time_s(-1); }},
      {"row[1].energy is missing",
       [](auto& r) { r.mutable_view()->mutable_row(1)->clear_energy(); }},
      {"row[1].energy is incomplete",
       [](auto& r) { r.mutable_view()->mutable_row(1)->mutable_energy()->clear_cut_off(); }},
      {"row[1].energy.balance.value is not a finite number",
       [](auto& r) {
         r.mutable_view()->mutable_row(1)->mutable_energy()->mutable_balance()->set_value(kNan);
       }},
      {"row[1].absolute_floor_w_sr is negative",
       [](auto& r) { r.mutable_view()->mutable_row(1)->set_absolute_floor_w_sr(-1); }},
      {"stop_reason is not stated",
       [](auto& r) { r.mutable_view()->mutable_row(3)->clear_stop_reason(); }},
      {"thumbnail is incomplete",
       [](auto& r) { r.mutable_view()->mutable_row(3)->mutable_thumbnail()->clear_exr(); }},
      {"thumbnail is missing",
       [](auto& r) { r.mutable_view()->mutable_row(3)->clear_thumbnail(); }},
      {"thumbnail is incomplete",
       [](auto& r) { r.mutable_view()->mutable_row(3)->mutable_thumbnail()->clear_stderr_exr(); }},
      {"silhouette is missing", [](auto& r) { r.mutable_view()->clear_silhouette(); }},
      {"silhouette is of another size",
       [](auto& r) { r.mutable_view()->mutable_silhouette()->set_width_px(15); }},
      {"silhouette names part 1 twice",
       [](auto& r) { r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_part_index(1); }},
      {"silhouette has a set of parts twice",
       [](auto& r) {
         auto& s = *r.mutable_view()->mutable_silhouette();
         *s.add_part_set() = s.part_set(0);
       }},
      {"silhouette has a set of parts twice, in no order",
       [](auto& r) {
         auto* parts = r.mutable_view()->mutable_silhouette()->mutable_part_set(1);
         parts->set_part_index(0, 1);
       }},
      {"of parts that do not exist",
       [](auto& r) {
         r.mutable_view()->mutable_silhouette()->mutable_part_set(1)->set_part_index(1, 9);
       }},
      {"silhouette names part 9 twice, or it does not exist",
       [](auto& r) { r.mutable_view()->mutable_silhouette()->mutable_part(0)->set_part_index(9); }},
      {"seconds is not a finite number", [](auto& r) { r.set_seconds(kNan); }},
      {"rays does not fit", [](auto& r) { r.set_rays(~0ULL); }},
  };
  for (const Damage& damage : damages) {
    schema::JobResult result = make_result(sweep, job.spec);
    damage.apply(result);
    const absl::Status status = writer->complete(job.fencing_token, result, "w");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_NE(status.message().find(damage.expected_message), absl::string_view::npos) << status;
  }
  // The lease is still good, and the sound result is welcome.
  EXPECT_EQ(writer->progress()->front().leased, 1U);
  ASSERT_OK(writer->complete(job.fencing_token, make_result(sweep, job.spec), "w"));
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
  EXPECT_EQ(StoreReader::open(path).value()->find({})->size(), 8U);
}

TEST(StoreResult, LayersAreThoseThatTheSweepAsksFor) {
  const TestFolder folder;
  schema::ResolvedSweep sweep = make_sweep({});
  for (const char* layer : {"sun", "at_sensor"})
    sweep.mutable_sweep()->mutable_image()->add_layers(layer);
  auto writer = StoreWriter::open(folder.file("a.sigdb")).value();
  ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();
  const schema::JobResult good = make_result(sweep, job.spec);
  const auto row = [](schema::JobResult& r) { return r.mutable_view()->mutable_row(1); };
  for (const std::function<void(schema::JobResult&)>& change :
       std::vector<std::function<void(schema::JobResult&)>>{
           [&](auto& r) { row(r)->clear_image_layer(); },
           [&](auto& r) { row(r)->mutable_image_layer()->RemoveLast(); },
           [&](auto& r) { *row(r)->add_image_layer() = row(r)->image_layer(0); },
           [&](auto& r) { row(r)->mutable_image_layer(0)->set_name("sky"); },
           [&](auto& r) { row(r)->mutable_image_layer()->SwapElements(0, 1); }}) {
    schema::JobResult bad = good;
    change(bad);
    const absl::Status status = writer->complete(job.fencing_token, bad, "w");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
    EXPECT_THAT(std::string(status.message()), testing::HasSubstr("image_layer"));
  }
  // A worker that lies may send these.
  for (const std::function<void(schema::ImageLayer&)>& change :
       std::vector<std::function<void(schema::ImageLayer&)>>{
           [](auto& l) { l.set_name("sunn"); }, [](auto& l) { l.clear_exr(); },
           [](auto& l) { l.mutable_exr()->resize(40); }, [](auto& l) { l.clear_stderr_exr(); },
           [](auto& l) { l.set_name("path"); }}) {
    schema::ImageLayer bad = good.view().row(1).image_layer(0);
    change(bad);
    const absl::Status status = check_image_layer(bad, 16, 9, "layer");
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << status;
  }
  for (const schema::ImageLayer& layer : good.view().row(1).image_layer())
    ASSERT_OK(check_image_layer(layer, 16, 9, "layer"));
  ASSERT_OK(writer->complete(job.fencing_token, good, "w"));
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
}

// A file that says so is damaged, and costs no memory.
TEST(StoreResult, ASilhouetteOfImpossibleSizeIsNotRead) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  {
    auto writer = StoreWriter::open(path).value();
    ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
    ASSERT_OK(complete_jobs(*writer, sweep).status());
    ASSERT_OK(writer->finish());
  }
  const std::int64_t id = StoreReader::open(path).value()->find({})->front().signature_id;
  ASSERT_OK(StoreReader::open(path).value()->silhouette(id).status());
  for (const char* change :
       {"width_px = 2000000000", "height_px = 5000", "pixel_samples = 70000"}) {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    const std::string sql = absl::StrCat(
        "DELETE FROM part_pixels; UPDATE silhouette SET width_px = 16, height_px = 9, "
        "pixel_samples = 8; UPDATE silhouette SET ",
        change);
    ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
    const auto read = StoreReader::open(path).value()->silhouette(id);
    EXPECT_TRUE(absl::IsDataLoss(read.status())) << change << ": " << read.status();
  }
}

// Zeros pack well: 60 boxes of 4096 x 4096 pixels took 2 GB to inflate.
TEST(StoreResult, BoxesOfZerosAreRefusedBeforeTheyAreInflated) {
  schema::Silhouette silhouette;
  silhouette.set_width_px(4096);
  silhouette.set_height_px(4096);
  silhouette.set_pixel_samples(8);
  for (std::uint32_t p = 0; p < 21; ++p) {
    schema::PartPixels& part = *silhouette.add_part();
    part.set_part_index(p);
    part.set_width_px(4096);
    part.set_height_px(4096);
    part.set_samples("no zlib");
  }
  const auto visit = [&] {
    return visit_silhouette(silhouette, [](int, std::uint32_t, std::uint16_t) {});
  };
  EXPECT_THAT(std::string(visit().message()), testing::HasSubstr("in boxes of more than"));
  silhouette.mutable_part()->RemoveLast();
  EXPECT_THAT(std::string(visit().message()), testing::HasSubstr("damaged samples"));
  silhouette.mutable_part(1)->set_part_index(0);
  EXPECT_THAT(std::string(visit().message()), testing::HasSubstr("names part 0 twice"));
}

// Each number is one of a ray that a pixel has, but together they would fill the memory.
TEST(StoreResult, ASilhouetteOfTooManyNumbersIsRefused) {
  schema::Silhouette silhouette;
  silhouette.set_width_px(64);
  silhouette.set_height_px(64);
  silhouette.set_pixel_samples(65535);
  const std::vector<std::uint32_t> skipped(4096, 0);
  const std::vector<std::uint16_t> counts(4096, 1);
  add_part_set({0}, skipped, counts, silhouette);
  std::uint64_t visited = 0;
  const auto visit = [&] {
    return visit_part_sets(silhouette, [&](int, std::uint32_t, std::uint16_t) { ++visited; });
  };
  ASSERT_OK(visit());
  EXPECT_EQ(visited, 4096u);
  for (int i = 0; i < 1100; ++i) *silhouette.add_part_set() = silhouette.part_set(0);
  EXPECT_THAT(std::string(visit().message()), testing::HasSubstr("numbers of pixels and parts"));
}

// A full disk, simulated by a limit on the file's pages.
TEST(StoreResult, AFullDiskLosesNothingThatWasCommitted) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  {
    auto writer = StoreWriter::open(path).value();
    ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
    ASSERT_OK(complete_jobs(*writer, sweep, 1).status());
  }
  {
    auto opened = open_for_writing(path).value();
    Database& database = *opened.database;
    ASSERT_OK(database.script("BEGIN IMMEDIATE"));
    const QueuedJob job = lease_next_job(database, "w", 0).value().value();
    const LeasedJob leased = leased_job(database, job.fencing_token).value();
    const auto pages = database.integer("PRAGMA page_count").value();
    ASSERT_OK(database.script(absl::StrCat("PRAGMA max_page_count = ", pages + 2)));
    const auto result = make_result(sweep, job.spec, 5, 4000, 100000);
    const absl::Status status = store_result(database, leased, result, "w", "");
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
    EXPECT_NE(status.message().find("full"), absl::string_view::npos) << status;
    EXPECT_NE(status.message().find(path), absl::string_view::npos) << status;
    if (database.in_transaction()) ASSERT_OK(database.script("ROLLBACK"));
    // With room again, the same connection goes on.
    ASSERT_OK(database.script("PRAGMA max_page_count = 1000000"));
    ASSERT_OK(database.script("BEGIN IMMEDIATE"));
    const QueuedJob again = lease_next_job(database, "w", 0).value().value();
    EXPECT_EQ(again.spec.job_key(), job.spec.job_key());
    ASSERT_OK(
        store_result(database, leased_job(database, again.fencing_token).value(), result, "w", ""));
    ASSERT_OK(database.script("ROLLBACK"));
  }
  EXPECT_EQ(StoreReader::open(path).value()->find({})->size(), 4U);
  EXPECT_EQ(sqlite_text(path, "PRAGMA integrity_check"), "ok");
}

TEST(StoreResult, ARolledBackCompletionLeavesNothing) {
  const TestFolder folder;
  const std::string path = folder.file("a.sigdb");
  const schema::ResolvedSweep sweep = make_sweep({});
  auto writer = StoreWriter::open(path).value();
  ASSERT_OK(submit(*writer, sweep, "sweep-a").status());
  ASSERT_OK(writer->begin());
  const QueuedJob job = writer->lease_next("w", 0).value().value();
  ASSERT_OK(writer->complete(job.fencing_token, make_result(sweep, job.spec), "w"));
  writer->rollback();
  EXPECT_EQ(writer->progress()->front().waiting, 4U);
  ASSERT_OK(writer->begin());
  ASSERT_OK(writer->commit());
  ASSERT_OK(writer->finish());
  EXPECT_EQ(StoreReader::open(path).value()->find({})->size(), 0U);
}

// Every field of a result but two, by itself.
TEST(ResultContent, IsAllButWhoAndHowLong) {
  const schema::ResolvedSweep sweep = make_sweep({});
  schema::JobResult result = make_result(sweep, make_jobs(sweep, "sha")[0]);
  const std::string before = content_sha256(result);
  EXPECT_EQ(content_sha256(std::as_const(result)), before);
  const std::string bytes = result.SerializeAsString();
  const auto* type = result.GetDescriptor();
  const auto& reflection = *result.GetReflection();
  for (int f = 0; f < type->field_count(); ++f) {
    const auto* field = type->field(f);
    schema::JobResult other = result;
    using F = google::protobuf::FieldDescriptor;
    switch (field->cpp_type()) {
      case F::CPPTYPE_STRING:
        reflection.SetString(&other, field, reflection.GetString(other, field) + "x");
        break;
      case F::CPPTYPE_UINT64:
        reflection.SetUInt64(&other, field, reflection.GetUInt64(other, field) + 1);
        break;
      case F::CPPTYPE_UINT32:
        reflection.SetUInt32(&other, field, reflection.GetUInt32(other, field) + 1);
        break;
      case F::CPPTYPE_DOUBLE:
        reflection.SetDouble(&other, field, reflection.GetDouble(other, field) + 1);
        break;
      case F::CPPTYPE_MESSAGE:
        if (field->name() == "heat") {
          other.mutable_heat()->set_field("x");
        } else {
          ASSERT_EQ(field->name(), "view");
          auto& row = *other.mutable_view()->mutable_row(0);
          row.set_sun_azimuth_deg(std::nextafter(row.sun_azimuth_deg(), 1e9));
        }
        break;
      default:
        FAIL() << field->full_name() << ": what kind is it?";
    }
    const bool no_content = field->name() == "seconds" || field->name() == "build_id";
    EXPECT_EQ(content_sha256(other) == before, no_content) << field->full_name();
  }
  EXPECT_EQ(result.SerializeAsString(), bytes) << "it is left as it was";
}

}  // namespace
}  // namespace irsig
