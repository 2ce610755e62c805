#pragma once

// Sweeps, jobs and results for the tests of the store: cheap to make, every number different from
// its neighbours, and a pure function of what they stand for, so that two databases can be
// compared.

#include <google/protobuf/reflection.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/accuracy/image_layers.h"
#include "schema/store/reader.h"
#include "schema/store/writer.h"
#include "tests/fault/synthetic_ledger.h"
#include "tests/fault/synthetic_pictures.h"
#include "tests/unit/test_folder.h"

namespace irsig {

#define ASSERT_OK(expression)                                        \
  do {                                                               \
    const auto ok_status = (expression);                             \
    ASSERT_TRUE(ok_status.ok()) << #expression << ": " << ok_status; \
  } while (false)

struct SweepShape {
  std::string name = "ship";
  std::vector<std::pair<double, double>> aspects = {{0, 0}, {90, 10}, {180, 45}, {270, -5}};
  std::vector<std::string> seasons = {"winter", "summer"};
  std::vector<std::string> bands = {"mwir", "lwir"};
  int parts = 2;
  double hull_temperature_k = 290;
  int wavelengths = 5;
};

inline schema::ResolvedSweep make_sweep(const SweepShape& shape) {
  schema::ResolvedSweep resolved;
  schema::Sweep& sweep = *resolved.mutable_sweep();
  sweep.set_name(shape.name);
  for (int i = 0; i < shape.parts; ++i) {
    schema::Part& part = *sweep.add_part();
    part.set_name(absl::StrCat("part", i));
    part.set_material("paint");
  }
  for (const std::string& name : shape.bands) {
    schema::Band& band = *sweep.add_band();
    band.set_name(name);
    band.set_lambda_min_um(name == "mwir" ? 3 : 8);
    band.set_lambda_max_um(name == "mwir" ? 5 : 12);
    band.set_step_um((band.lambda_max_um() - band.lambda_min_um()) / (shape.wavelengths - 1));
  }
  sweep.mutable_output()->set_thumbnail_px(16);
  for (const auto& [azimuth_deg, elevation_deg] : shape.aspects) {
    schema::Viewpoint& viewpoint = *resolved.add_viewpoint();
    viewpoint.set_aspect_azimuth_deg(azimuth_deg);
    viewpoint.set_aspect_elevation_deg(elevation_deg);
    viewpoint.set_range_m(5000);
  }
  for (std::size_t i = 0; i < shape.seasons.size(); ++i) {
    schema::Condition& condition = *resolved.add_condition();
    condition.set_season_index(static_cast<std::uint32_t>(i));
    condition.set_season(shape.seasons[i]);
    condition.set_time_utc("2025-06-21T01:30:00Z");
    for (int part = 0; part < shape.parts; ++part) {
      condition.add_part_temperature_k(shape.hull_temperature_k + part +
                                       10 * static_cast<double>(i));
    }
    condition.add_warning(shape.seasons[i] + " is odd");
    condition.add_warning("and so is this");
    condition.mutable_surroundings()->set_kind("sea");
    condition.mutable_surroundings()->set_sky_temperature_k(250);
    condition.mutable_surroundings()->set_sea_temperature_k(285);
    condition.mutable_surroundings()->set_sea_emissivity(0.98);
  }
  return resolved;
}

// One job for each viewpoint; its key names all that determines the result, as real keys do.
inline std::vector<schema::JobSpec> make_jobs(const schema::ResolvedSweep& sweep,
                                              const std::string& sweep_sha256) {
  std::string determining;
  for (const schema::Condition& c : sweep.condition()) {
    absl::StrAppend(&determining, c.season(), "@", c.time_utc(), ":", c.part_temperature_k(0), ";");
  }
  for (const schema::Band& b : sweep.sweep().band())
    absl::StrAppend(&determining, b.name(), ":", b.step_um(), ";");
  std::vector<schema::JobSpec> jobs;
  for (int v = 0; v < sweep.viewpoint_size(); ++v) {
    schema::JobSpec& job = jobs.emplace_back();
    job.set_sweep_sha256(sweep_sha256);
    job.set_job_key(absl::StrCat(determining, sweep.viewpoint(v).aspect_azimuth_deg(), ",",
                                 sweep.viewpoint(v).aspect_elevation_deg()));
    job.mutable_view()->set_viewpoint_index(static_cast<std::uint32_t>(v));
    for (int c = 0; c < sweep.condition_size(); ++c)
      job.mutable_view()->add_condition_index(static_cast<std::uint32_t>(c));
    for (int b = 0; b < sweep.sweep().band_size(); ++b)
      job.mutable_view()->add_band_index(static_cast<std::uint32_t>(b));
  }
  return jobs;
}

// Sets every number of the message that is still unset to one of its own.
inline void fill_numbers(google::protobuf::Message& message, double& next) {
  const auto& reflection = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const auto* field = message.GetDescriptor()->field(i);
    // Hot gas and a measured background are of rows that say so.
    if (field->is_repeated() || field->name() == "thumbnail" || field->name() == "spectrum" ||
        field->name() == "visible_fraction" || field->name().find("clutter") != std::string::npos ||
        field->name().find("plume") != std::string::npos)
      continue;
    switch (field->cpp_type()) {
      case google::protobuf::FieldDescriptor::CPPTYPE_DOUBLE:
        reflection.SetDouble(&message, field, next += 0.25);
        break;
      case google::protobuf::FieldDescriptor::CPPTYPE_MESSAGE:
        fill_numbers(*reflection.MutableMessage(&message, field), next);
        break;
      default:
        break;
    }
  }
}

// Fills the contributions of uncertain inputs to a row, if the sweep states some.
inline void fill_inputs(const schema::ResolvedSweep& sweep, schema::SignatureRow& row,
                        double& next) {
  row.clear_input_uncertainty_w_sr();
  row.clear_apparent_input_uncertainty_w_sr();
  row.clear_contrast_input_uncertainty_w_sr();
  row.clear_heat_model_error_w_sr();
  row.clear_apparent_heat_model_error_w_sr();
  row.clear_contrast_heat_model_error_w_sr();
  const schema::Uncertainty& stated = sweep.sweep().uncertainty();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  stated.GetReflection()->ListFields(stated, &fields);
  if (fields.empty()) return;
  for (const auto* field : fields) {
    schema::InputContribution& input = *row.add_input();
    input.set_input(field->name());
    for (schema::Estimate* e :
         {input.mutable_contribution_w_sr(), input.mutable_apparent_contribution_w_sr(),
          input.mutable_contrast_contribution_w_sr()}) {
      e->set_value(-(next += 0.25));
      e->set_stderr(0.125);
    }
  }
  row.set_input_uncertainty_w_sr(next += 0.25);
  row.set_apparent_input_uncertainty_w_sr(next += 0.25);
  row.set_contrast_input_uncertainty_w_sr(next += 0.25);
}

// png_bytes, exr_bytes: so many instead of pictures.
inline schema::JobResult make_result(const schema::ResolvedSweep& sweep, const schema::JobSpec& job,
                                     int wavelengths = 5, std::size_t png_bytes = 0,
                                     std::size_t exr_bytes = 0) {
  schema::JobResult result;
  result.set_job_key(job.job_key());
  const std::size_t hash = std::hash<std::string>()(job.job_key());
  double next = 1 + static_cast<double>(hash % 1000);
  for (const std::uint32_t c : job.view().condition_index()) {
    for (const std::uint32_t b : job.view().band_index()) {
      schema::SignatureRow& row = *result.mutable_view()->add_row();
      row.set_condition_index(c);
      row.set_band_index(b);
      fill_numbers(row, next);
      fill_inputs(sweep, row, next);
      row.mutable_intensity_w_sr()->set_value(
          row.emitted_w_sr().value() + row.sun_reflected_w_sr().value() +
          row.sky_reflected_w_sr().value() + row.surface_reflected_w_sr().value() +
          row.interreflected_w_sr().value());
      row.mutable_contrast_intensity_w_sr()->set_value(-row.contrast_intensity_w_sr().value());
      row.set_path_transmittance(1 / row.path_transmittance());
      row.set_backface_fraction(0);  // else a warning
      row.set_stop_reason(schema::STOP_REASON_ACCURACY_REACHED);
      row.set_energy_gain(c == 1);
      add_synthetic_ledger(row, [&next] { return next += 0.25; });
      for (int p = 0; p < sweep.sweep().part_size(); ++p) {
        schema::PartIntensity& part = *row.add_part();
        part.set_part_index(static_cast<std::uint32_t>(p));
        part.mutable_intensity_w_sr()->set_value(next += 0.25);
        part.mutable_intensity_w_sr()->set_stderr(next += 0.25);
      }
      schema::Spectrum& spectrum = *row.mutable_spectrum();
      const schema::Band& band = sweep.sweep().band(static_cast<int>(b));
      for (int i = 0; i < wavelengths; ++i) {
        spectrum.add_lambda_um(band.lambda_min_um() +
                               (band.lambda_max_um() - band.lambda_min_um()) * i /
                                   (wavelengths - 1));
      }
      for (int f = 0; f < spectrum.GetDescriptor()->field_count(); ++f) {
        const auto* field = spectrum.GetDescriptor()->field(f);
        if (field->cpp_type() != google::protobuf::FieldDescriptor::CPPTYPE_FLOAT ||
            field->name().find("plume") != std::string::npos)
          continue;
        for (int i = 0; i < wavelengths; ++i) {
          spectrum.GetReflection()->AddFloat(&spectrum, field, static_cast<float>(next += 0.125));
        }
      }
      // A mode for the first, two for the second, none of the third; below the variance.
      const auto bytes = static_cast<std::size_t>(2 * wavelengths);
      spectrum.set_spectral_intensity_modes(std::string(bytes, static_cast<char>(hash % 64)));
      spectrum.set_apparent_spectral_intensity_modes(
          std::string(2 * bytes, static_cast<char>(hash % 63)));
      schema::Thumbnail& thumbnail = *row.mutable_thumbnail();
      thumbnail.set_width_px(16);
      thumbnail.set_height_px(9);
      thumbnail.set_pixel_rad(1e-4);
      std::mt19937_64 random(hash + 1000 * c + b);
      thumbnail.set_png(png_bytes > 0 ? noise(random, png_bytes) : synthetic_png(16, 9, random));
      thumbnail.set_exr(exr_bytes > 0 ? noise(random, exr_bytes)
                                      : synthetic_exr(16, 9, 200, random));
      thumbnail.set_stderr_exr(synthetic_exr(16, 9, 100, random));
      for (const std::string& name : sweep.sweep().image().layers()) {
        schema::ImageLayer& layer = *row.add_image_layer();
        layer.set_name(name);
        layer.set_exr(synthetic_exr(16, 9, 200, random));
        if (has_standard_error(*image_layer_of(name)))
          layer.set_stderr_exr(synthetic_exr(16, 9, 100, random));
      }
    }
  }
  std::mt19937_64 random(hash);
  add_synthetic_silhouette(16, 9, sweep.sweep().part_size(), random, *result.mutable_view());
  result.set_samples(1000 + hash % 7);
  result.set_replicates(32);
  result.set_target_paths(500 + hash % 5);
  result.set_rays(9000 + hash % 11);
  result.set_seconds(0.5);
  result.set_guarded_backface_hits(3);
  result.set_guarded_nonfinite(1);
  result.set_truncated_paths(2);
  result.set_guarded_negative(4);
  result.set_seed_hex("00000000000000aa");
  result.set_physics_version(1);
  result.set_determinism_class("test-class");
  result.set_build_id("test-build");
  return result;
}

inline absl::StatusOr<AddedJobs> submit(StoreWriter& writer, const schema::ResolvedSweep& sweep,
                                        const std::string& sweep_sha256) {
  if (auto status = writer.begin(); !status.ok()) return status;
  auto added = writer.add_sweep(sweep, sweep_sha256, make_jobs(sweep, sweep_sha256), {});
  if (!added.ok()) {
    writer.rollback();
    return added;
  }
  if (auto status = writer.commit(); !status.ok()) return status;
  return added;
}

// Leases and completes up to `most` jobs, in one transaction. Returns how many.
inline absl::StatusOr<int> complete_jobs(StoreWriter& writer, const schema::ResolvedSweep& sweep,
                                         int most = 1 << 30, int wavelengths = 5) {
  if (auto status = writer.begin(); !status.ok()) return status;
  int done = 0;
  for (; done < most; ++done) {
    auto job = writer.lease_next("worker", 0);
    if (!job.ok()) return job.status();
    if (!job->has_value()) break;
    auto status = writer.complete((*job)->fencing_token,
                                  make_result(sweep, (*job)->spec, wavelengths), "host:1");
    if (!status.ok()) return status;
  }
  if (auto status = writer.commit(); !status.ok()) return status;
  return done;
}

// The sweep with a heat run of each season: part 0 is computed, the others are stated.
inline schema::ResolvedSweep with_heat(schema::ResolvedSweep sweep) {
  for (int c = 0; c < sweep.condition_size(); ++c) {
    schema::Condition& condition = *sweep.mutable_condition(c);
    schema::HeatRun& run = *sweep.add_heat();
    run.set_season(condition.season());
    run.add_time_utc(condition.time_utc());
    condition.set_part_temperature_k(0, 0);
    *run.mutable_part_temperature_k() = condition.part_temperature_k();
    schema::ConditionField& from = *condition.mutable_temperature_field();
    from.set_heat(static_cast<std::uint32_t>(c));
    from.add_part(0);
  }
  return sweep;
}

// Heat jobs first; `build_up` stands for all that only temperatures depend on.
inline std::vector<schema::JobSpec> make_heat_jobs(const schema::ResolvedSweep& sweep,
                                                   const std::string& sweep_sha256,
                                                   const std::string& build_up = "steel") {
  std::vector<schema::JobSpec> jobs, views = make_jobs(sweep, sweep_sha256);
  std::vector<std::string> keys;
  for (int run = 0; run < sweep.heat_size(); ++run) {
    schema::JobSpec& job = jobs.emplace_back();
    job.set_sweep_sha256(sweep_sha256);
    job.set_job_key(absl::StrCat("heat of ", sweep.heat(run).season(), ", ", build_up, ", ",
                                 sweep.heat(run).time_utc_size(), " times"));
    job.mutable_heat()->set_heat(static_cast<std::uint32_t>(run));
    keys.push_back(job.job_key());
  }
  for (schema::JobSpec& view : views) {
    view.mutable_needs()->Add(keys.begin(), keys.end());
    view.set_job_key(absl::StrCat(view.job_key(), ",", build_up, keys.front()));
    jobs.push_back(view);
  }
  return jobs;
}

// Three facets, of which the last one's temperature is stated.
inline schema::JobResult make_heat_result(const schema::ResolvedSweep& sweep,
                                          const schema::JobSpec& job, float kelvin = 300) {
  const schema::HeatRun& run = sweep.heat(static_cast<int>(job.heat().heat()));
  schema::JobResult result = make_result(sweep, schema::JobSpec());
  result.set_job_key(job.job_key());
  result.set_seed_hex(absl::StrCat(absl::Hex(sweep.sweep().seed(), absl::kZeroPad16)));
  schema::HeatField field;
  field.set_facets(3);
  for (int time = 0; time < run.time_utc_size(); ++time) {
    const float hour = static_cast<float>(time);
    field.add_unix_s(1750469400 + 3600 * time);  // 2025-06-21T01:30:00Z and hours after it
    for (const float value : {kelvin + hour, kelvin + hour + 2, NAN})
      field.mutable_kelvin()->append(reinterpret_cast<const char*>(&value), sizeof value);
    for (const float value : {0.5F, 1.5F, NAN})
      field.mutable_error_k()->append(reinterpret_cast<const char*>(&value), sizeof value);
    schema::PartTemperature& part = *result.mutable_heat()->add_part();
    part.set_part_index(0);
    part.set_time_index(static_cast<std::uint32_t>(time));
    part.set_mean_k(static_cast<double>(kelvin + hour) + 1);
    part.set_coldest_k(static_cast<double>(kelvin + hour));
    part.set_hottest_k(static_cast<double>(kelvin + hour) + 2);
    part.set_error_k(1);
  }
  result.mutable_heat()->set_field(field.SerializeAsString());
  result.mutable_heat()->add_warning("the weather of " + run.season() + " is odd");
  return result;
}

// Returns what any SQLite client sees: the first column of the first row, as text.
inline std::string sqlite_text(const std::string& path, const std::string& statement) {
  sqlite3* handle = nullptr;
  std::string text = "(no row)";
  if (sqlite3_open_v2(path.c_str(), &handle, SQLITE_OPEN_READWRITE, nullptr) == SQLITE_OK) {
    char* message = nullptr;
    sqlite3_exec(
        handle, statement.c_str(),
        [](void* out, int, char** values, char**) {
          *static_cast<std::string*>(out) = values[0] == nullptr ? "NULL" : values[0];
          return 0;
        },
        &text, &message);
    if (message != nullptr) text = absl::StrCat("error: ", message);
    sqlite3_free(message);
  }
  sqlite3_close(handle);
  return text;
}

}  // namespace irsig
