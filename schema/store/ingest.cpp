#include "schema/store/ingest.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "core/accuracy/measured.h"
#include "core/accuracy/quantities.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_result.h"
#include "schema/store/check/ingest_inputs.h"
#include "schema/store/ingest_heat.h"
#include "schema/store/sweep_table.h"
#include "schema/store/tables/spectrum_blob.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

absl::Status insert_provenance(Database& database, std::int64_t job_id,
                               const schema::JobResult& result, const std::string& worker_name,
                               const std::string& content) {
  return database.run(sql::insert_provenance, job_id, result.seed_hex(), result.physics_version(),
                      result.determinism_class(), result.build_id(), worker_name, result.samples(),
                      result.replicates(), result.target_paths(), result.rays(), result.seconds(),
                      result.guarded_backface_hits(), result.guarded_nonfinite(),
                      result.truncated_paths(), worst_relative_error(result),
                      result.guarded_negative(), content);
}

// The band's record, after its wavelengths were compared with those of the spectrum (or stored, the
// first time).
absl::StatusOr<std::int64_t> band_for(Database& database, std::int64_t sweep_id,
                                      const schema::SignatureRow& row) {
  const std::string lambda_um = wavelength_blob(row.spectrum());
  std::int64_t band_id = 0;
  {
    ASSIGN_OR_RETURN(Rows band, database.query(sql::current_band, sweep_id, row.band_index()));
    ASSIGN_OR_RETURN(const bool found, band.next());
    if (!found) return absl::InternalError(absl::StrCat("no band ", row.band_index()));
    band_id = band.integer();
    // The ends of a grid made of multiples of a step are only as exact as the sum.
    const double slack_um = 1e-9 * row.spectrum().lambda_um(0);
    const double lambda_min_um = band.real() - slack_um;
    const double lambda_max_um = band.real() + slack_um;
    const auto& lambda = row.spectrum().lambda_um();
    if (lambda[0] < lambda_min_um || lambda[lambda.size() - 1] > lambda_max_um) {
      return absl::InvalidArgumentError(absl::StrCat(
          "result: a spectrum of band ", row.band_index(), " reaches outside the band"));
    }
    if (!band.is_null()) {
      if (band.blob() == lambda_um) return band_id;
      return absl::InvalidArgumentError(absl::StrCat("result: the wavelengths of band ",
                                                     row.band_index(),
                                                     " differ from those stored with it"));
    }
  }
  IRSIG_STORE_TRY(database.run(sql::set_band_wavelengths, band_id, Blob{lambda_um}));
  return band_id;
}

const char* insert_signature_statement() {
  static const std::string statement = [] {
    std::string names, parameters;
    for (const QuantityInfo& quantity : kQuantities) {
      absl::StrAppend(&names, names.empty() ? "" : ", ", std::string(quantity.name));
      absl::StrAppend(&parameters, parameters.empty() ? "?" : ", ?");
    }
    return absl::StrReplaceAll(sql::insert_signature,
                               {{"QUANTITIES", names}, {"PARAMETERS", parameters}});
  }();
  return statement.c_str();
}

std::optional<double> if_stated(bool stated, double value) {
  return stated ? std::optional(value) : std::nullopt;
}

// The intensity at the target, with the standard errors and bounds of its row. The other bounds are
// of what lies between the target and the sensor.
Measured source_intensity(const schema::SignatureRow& row) {
  Measured out{row.intensity_w_sr().value(), row.intensity_w_sr().stderr(), {}, 0};
  out.undersampling_stderr = row.undersampling_stderr_w_sr();
  out.of(BoundOf::kTruncation) = row.truncation_bound_w_sr();
  out.of(BoundOf::kQuadrature) = row.quadrature_bound_w_sr() - row.spectral_basis_bound_w_sr();
  out.of(BoundOf::kBasis) = row.spectral_basis_bound_w_sr();
  out.of(BoundOf::kUnseen) = row.undersampling_bound_w_sr();
  out.of(BoundOf::kSky) = row.direction_interpolation_bound_w_sr();
  out.of(BoundOf::kOmitted) = row.omitted_bound_w_sr();
  out.of(BoundOf::kTemperature) = row.temperature_bound_w_sr();
  out.of(BoundOf::kPlume) = row.plume_bound_w_sr();
  return out;
}

// Returns the name of what decides the error of a row that missed its accuracy; empty: it did not.
std::string limiting_bound(const schema::SignatureRow& row) {
  const bool missed = row.stop_reason() == schema::STOP_REASON_ACCURACY_NOT_REACHED ||
                      row.stop_reason() == schema::STOP_REASON_SAMPLE_LIMIT;
  return missed ? std::string(limiting_part(source_intensity(row))) : std::string();
}

absl::StatusOr<std::int64_t> insert_signature(Database& database, const LeasedJob& job,
                                              const schema::SignatureRow& row) {
  ASSIGN_OR_RETURN(const std::int64_t condition_id,
                   database.integer(sql::current_condition, job.sweep_id, row.condition_index()));
  ASSIGN_OR_RETURN(const std::int64_t band_id, band_for(database, job.sweep_id, row));
  // The catalogue's quantities, in its order: the message has a field of each name.
#define IRSIG_VALUE_ARGUMENTS(name, stderr_name, unit, what) \
  , row.name().value(), row.name().stderr()
#define IRSIG_NUMBER_ARGUMENT(name, kind, unit, what) , row.name()
#define IRSIG_STATED_VALUE_ARGUMENTS(name, stderr_name, unit, what) \
  , if_stated(row.has_##name(), row.name().value()),                \
      if_stated(row.has_##name(), row.name().stderr())
#define IRSIG_STATED_ARGUMENT(name, kind, unit, what) , if_stated(row.has_##name(), row.name())
  IRSIG_STORE_TRY(database.run(
      insert_signature_statement(), job.job_id, job.view.viewpoint_id, condition_id, band_id,
      row.sun_azimuth_deg(), row.sun_zenith_deg(), static_cast<int>(row.stop_reason()),
      limiting_bound(row), row.energy_gain(),
      row.reflections() IRSIG_COMPUTED_QUANTITIES(IRSIG_VALUE_ARGUMENTS, IRSIG_NUMBER_ARGUMENT)
          IRSIG_PLUME_QUANTITIES(IRSIG_STATED_VALUE_ARGUMENTS, IRSIG_STATED_ARGUMENT)
              IRSIG_CLUTTER_QUANTITIES(IRSIG_STATED_VALUE_ARGUMENTS, IRSIG_STATED_ARGUMENT)
                  IRSIG_INPUT_QUANTITIES(IRSIG_STATED_ARGUMENT)));
#undef IRSIG_VALUE_ARGUMENTS
#undef IRSIG_NUMBER_ARGUMENT
#undef IRSIG_STATED_VALUE_ARGUMENTS
#undef IRSIG_STATED_ARGUMENT
  return database.last_insert_rowid();
}

absl::Status insert_spectrum(Database& database, std::int64_t signature_id,
                             const schema::Spectrum& spectrum) {
  const SpectrumBlobs blobs(spectrum);
  return [&]<std::size_t... Array>(std::index_sequence<Array...>) {
    return database.run(sql::insert_spectrum, signature_id, Blob{blobs[Array]}...);
  }
  (std::make_index_sequence<kSpectrumArrays>());
}

// Nothing where nothing is known.
absl::Status insert_modes(Database& database, std::int64_t signature_id,
                          const schema::Spectrum& spectrum) {
  if (spectrum.spectral_intensity_modes().empty() &&
      spectrum.apparent_spectral_intensity_modes().empty() &&
      spectrum.contrast_spectral_intensity_modes().empty())
    return absl::OkStatus();
  return database.run(sql::insert_spectral_modes, signature_id,
                      Blob{spectrum.spectral_intensity_modes()},
                      Blob{spectrum.apparent_spectral_intensity_modes()},
                      Blob{spectrum.contrast_spectral_intensity_modes()});
}

absl::Status insert_clutter(Database& database, std::int64_t signature_id,
                            const schema::Clutter& clutter) {
  IRSIG_STORE_TRY(database.run(sql::insert_clutter, signature_id,
                               Blob{float_blob(clutter.patch_sigma_w_m2_sr_um())},
                               Blob{clutter.modes()}));
  for (int m = 0; m < clutter.material_fraction_size(); ++m)
    IRSIG_STORE_TRY(
        database.run(sql::insert_clutter_material, signature_id, m, clutter.material_fraction(m)));
  return absl::OkStatus();
}

absl::Status insert_profile_row(Database& database, std::int64_t signature_id,
                                const schema::ProfileRow& p) {
  return database.run(sql::insert_profile_row, signature_id, p.profile_index(), p.point_index(),
                      p.reflections(), p.name(), p.x_m(), p.y_m(), p.z_m(), p.footprint_width_m(),
                      p.footprint_height_m(), p.radiance_w_m2_sr().value(),
                      p.radiance_w_m2_sr().stderr(), p.apparent_radiance_w_m2_sr().value(),
                      p.apparent_radiance_w_m2_sr().stderr(), p.truncation_bound_w_m2_sr(),
                      p.quadrature_bound_w_m2_sr(), p.source_radiance_temperature_k().value(),
                      p.source_radiance_temperature_k().stderr(), p.target_fraction(), p.samples());
}

absl::Status insert_row(Database& database, const LeasedJob& job,
                        const std::vector<std::int64_t>& parts, const LedgerNames& names,
                        const schema::SignatureRow& row) {
  ASSIGN_OR_RETURN(const std::int64_t signature_id, insert_signature(database, job, row));
  IRSIG_STORE_TRY(insert_spectrum(database, signature_id, row.spectrum()));
  IRSIG_STORE_TRY(insert_modes(database, signature_id, row.spectrum()));
  if (row.has_clutter()) IRSIG_STORE_TRY(insert_clutter(database, signature_id, row.clutter()));
  for (const schema::PartIntensity& part : row.part()) {
    IRSIG_STORE_TRY(database.run(sql::insert_part_intensity, signature_id, parts[part.part_index()],
                                 part.intensity_w_sr().value(), part.intensity_w_sr().stderr()));
  }
  IRSIG_STORE_TRY(insert_ledger(database, names, signature_id, row));
  IRSIG_STORE_TRY(insert_inputs(database, signature_id, row));
  for (const schema::ProfileRow& p : row.profile()) {
    IRSIG_STORE_TRY(insert_profile_row(database, signature_id, p));
  }
  if (!row.has_thumbnail()) return absl::OkStatus();
  const schema::Thumbnail& thumbnail = row.thumbnail();
  IRSIG_STORE_TRY(
      database.run(sql::insert_thumbnail, signature_id, thumbnail.width_px(), thumbnail.height_px(),
                   thumbnail.pixel_rad(), thumbnail.error_relative(), thumbnail.error_k(),
                   Blob{thumbnail.png()}, Blob{thumbnail.exr()}, Blob{thumbnail.stderr_exr()}));
  for (const schema::ImageLayer& layer : row.image_layer())
    IRSIG_STORE_TRY(database.run(sql::insert_image_layer, signature_id, layer.name(),
                                 Blob{layer.exr()}, Blob{layer.stderr_exr()}));
  return absl::OkStatus();
}

absl::Status insert_silhouette(Database& database, const LeasedJob& job,
                               const std::vector<std::int64_t>& parts,
                               const schema::Silhouette& silhouette) {
  IRSIG_STORE_TRY(database.run(sql::insert_silhouette, job.job_id, silhouette.width_px(),
                               silhouette.height_px(), silhouette.pixel_samples()));
  for (const schema::PartPixels& part : silhouette.part())
    IRSIG_STORE_TRY(database.run(sql::insert_part_pixels, job.job_id, parts[part.part_index()],
                                 part.left_px(), part.top_px(), part.width_px(), part.height_px(),
                                 Blob{part.samples()}));
  for (const schema::PartSetPixels& set : silhouette.part_set()) {
    std::string names;
    for (const std::uint32_t part : set.part_index()) {
      ASSIGN_OR_RETURN(Rows row, database.query(sql::part_name, parts[part]));
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) return absl::InternalError("a part of no sweep");
      absl::StrAppend(&names, names.empty() ? "" : "\n", row.text());
    }
    IRSIG_STORE_TRY(database.run(sql::insert_part_set, job.job_id, names, set.outside_px(),
                                 Blob{set.samples()}));
  }
  return absl::OkStatus();
}

absl::Status insert_direction(Database& database, std::int64_t viewpoint_id) {
  UnitVector unit{};
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::viewpoint_without_direction, viewpoint_id));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return absl::OkStatus();
    const double azimuth_deg = row.real();
    unit = unit_vector(azimuth_deg, row.real());
  }
  return database.run(sql::insert_viewpoint_direction, viewpoint_id, unit.x, unit.y, unit.z);
}

absl::Status make_room(Database& database, const LeasedJob& job,
                       const schema::ViewJobResult& result) {
  ASSIGN_OR_RETURN(const std::int64_t earlier,
                   database.integer(sql::count_signatures_of_viewpoint, job.view.viewpoint_id));
  if (earlier == 0) return insert_direction(database, job.view.viewpoint_id);
  for (const schema::SignatureRow& row : result.row()) {
    IRSIG_STORE_TRY(database.run(sql::delete_signature_at_place, job.sweep_id,
                                 job.view.viewpoint_id, row.condition_index(), row.band_index()));
  }
  return absl::OkStatus();
}

// Jobs of an earlier version of the sweep end with what they left; the definitions that only
// they used, with the last of these jobs.
absl::Status remove_superseded(Database& database, const LeasedJob& job) {
  if (job.kind == JobKind::kView) {
    IRSIG_STORE_TRY(database.run(sql::delete_superseded_jobs_of_viewpoint, job.view.viewpoint_id));
    if (database.changes() == 0) return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(const std::int64_t left,
                   database.integer(sql::has_superseded_jobs, job.sweep_id));
  if (left != 0) return absl::OkStatus();
  IRSIG_STORE_TRY(database.run(sql::delete_superseded_conditions, job.sweep_id));
  IRSIG_STORE_TRY(database.run(sql::delete_superseded_bands, job.sweep_id));
  IRSIG_STORE_TRY(database.run(sql::delete_superseded_parts, job.sweep_id));
  return database.run(sql::delete_unused_assets);
}

absl::Status store_temperatures(Database& database, const LeasedJob& job,
                                const schema::JobResult& result, const std::string& worker_name,
                                const std::string& content) {
  ASSIGN_OR_RETURN(std::unique_ptr<Savepoint> savepoint, Savepoint::open(database));
  IRSIG_STORE_TRY(store_heat(database, job, result));
  IRSIG_STORE_TRY(insert_provenance(database, job.job_id, result, worker_name, content));
  IRSIG_STORE_TRY(remove_superseded(database, job));
  return savepoint->keep();
}

// Returns the names in a column of the sweep that separates them by commas.
absl::StatusOr<std::vector<std::string>> listed_names(Database& database, const char* query,
                                                      std::int64_t sweep_id) {
  ASSIGN_OR_RETURN(Rows row, database.query(query, sweep_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::InternalError("a job of no sweep");
  return std::vector<std::string>(absl::StrSplit(row.text(), ',', absl::SkipEmpty()));
}

absl::Status store_view(Database& database, const LeasedJob& job, const schema::JobResult& result,
                        const std::string& worker_name, const std::string& content) {
  ASSIGN_OR_RETURN(const std::vector<std::int64_t> parts, part_ids(database, job.sweep_id));
  const absl::StatusOr<std::int64_t> thumbnail =
      database.integer(sql::wants_thumbnail, job.sweep_id);
  if (!thumbnail.ok() && !absl::IsNotFound(thumbnail.status())) return thumbnail.status();
  ASSIGN_OR_RETURN(const std::int64_t profile_rows,
                   database.integer(sql::wanted_profile_rows, job.sweep_id));
  ASSIGN_OR_RETURN(const LedgerNames names, ledger_names(database));
  ASSIGN_OR_RETURN(const std::vector<std::string> inputs,
                   listed_names(database, sql::uncertain_inputs, job.sweep_id));
  ASSIGN_OR_RETURN(const std::vector<std::string> layers,
                   listed_names(database, sql::image_layers, job.sweep_id));
  IRSIG_STORE_TRY(check_result(
      result, {.job_key = job.job_key,
               .condition_index = job.view.condition_index,
               .band_index = job.view.band_index,
               .parts = parts.size(),
               .profile_rows = static_cast<std::size_t>(profile_rows),
               .thumbnail = thumbnail.ok() ? std::optional<bool>(*thumbnail != 0) : std::nullopt,
               .image_layers = layers,
               .ledger = names,
               .inputs = inputs}));
  ASSIGN_OR_RETURN(std::unique_ptr<Savepoint> savepoint, Savepoint::open(database));
  IRSIG_STORE_TRY(make_room(database, job, result.view()));
  IRSIG_STORE_TRY(insert_provenance(database, job.job_id, result, worker_name, content));
  for (const schema::SignatureRow& row : result.view().row()) {
    IRSIG_STORE_TRY(insert_row(database, job, parts, names, row));
  }
  IRSIG_STORE_TRY(database.run(sql::delete_silhouette, job.job_id));
  if (result.view().has_silhouette())
    IRSIG_STORE_TRY(insert_silhouette(database, job, parts, result.view().silhouette()));
  IRSIG_STORE_TRY(remove_superseded(database, job));
  return savepoint->keep();
}

}  // namespace

double worst_relative_error(const schema::JobResult& result) {
  double worst = 0;
  for (const schema::SignatureRow& row : result.view().row()) {
    const double error = row.numerical_error_w_sr();
    const double intensity = std::abs(row.intensity_w_sr().value());
    if (error > 0)
      worst = std::max(worst,
                       intensity > 0 ? error / intensity : std::numeric_limits<double>::infinity());
  }
  return worst;
}

absl::Status store_result(Database& database, const LeasedJob& job, const schema::JobResult& result,
                          const std::string& worker_name, const std::string& content) {
  switch (job.kind) {
    case JobKind::kView:
      return store_view(database, job, result, worker_name, content);
    case JobKind::kHeat:
      return store_temperatures(database, job, result, worker_name, content);
  }
  return absl::InternalError("a job of no known kind");
}

}  // namespace irsig
