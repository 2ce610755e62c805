#include "schema/store/reader.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/accuracy/spectral_modes.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_picture.h"
#include "schema/store/find_contents.h"
#include "schema/store/find_heat.h"
#include "schema/store/find_inputs.h"
#include "schema/store/find_ledger.h"
#include "schema/store/find_profiles.h"
#include "schema/store/find_signatures.h"
#include "schema/store/open_database.h"
#include "schema/store/queue.h"
#include "schema/store/tables/cost.h"
#include "schema/store/tables/digest.h"
#include "schema/store/tables/spectrum_blob.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"

namespace irsig {
namespace {

// Several statements that must see the same commit.
template <typename Work>
auto in_one_snapshot(Database& database, const Work& work) -> decltype(work()) {
  IRSIG_STORE_TRY(database.run("BEGIN"));
  auto result = work();
  IRSIG_STORE_TRY(database.run("COMMIT"));
  return result;
}

}  // namespace

StoreReader::StoreReader(std::unique_ptr<Database> database) : database_(std::move(database)) {}

StoreReader::~StoreReader() = default;

absl::StatusOr<std::vector<StoredSignature>> StoreReader::find(const SignatureFilter& filter) {
  return in_one_snapshot(*database_, [&]() -> absl::StatusOr<std::vector<StoredSignature>> {
    ASSIGN_OR_RETURN(const auto ids, find_signature_ids(*database_, filter));
    return read_signatures(*database_, ids);
  });
}

absl::StatusOr<std::vector<std::int64_t>> StoreReader::find_ids(const SignatureFilter& filter) {
  return in_one_snapshot(*database_, [&] { return find_signature_ids(*database_, filter); });
}

absl::StatusOr<std::vector<StoredSignature>> StoreReader::read(std::span<const std::int64_t> ids) {
  return in_one_snapshot(*database_, [&] { return read_signatures(*database_, ids); });
}

absl::StatusOr<std::vector<SweepContents>> StoreReader::contents() {
  return in_one_snapshot(*database_, [&] { return find_contents(*database_); });
}

absl::StatusOr<std::vector<StoredValue>> StoreReader::values(const ValueFilter& filter) {
  return find_values(*database_, filter);
}

absl::StatusOr<schema::Spectrum> StoreReader::spectrum(std::int64_t signature_id) {
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::spectrum_of_signature, signature_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::NotFoundError(absl::StrCat("no spectrum of signature ", signature_id));
  const std::string lambda_um = row.text();
  std::array<std::string, kSpectrumArrays> arrays;
  for (std::string& array : arrays) array = row.text();
  auto spectrum = spectrum_from_blobs(lambda_um, arrays);
  if (!spectrum.ok())
    return absl::Status(spectrum.status().code(),
                        absl::StrCat("signature ", signature_id, ": ", spectrum.status().message(),
                                     "; `irsig doctor` lists what is damaged"));
  for (std::string* modes : {spectrum->mutable_spectral_intensity_modes(),
                             spectrum->mutable_apparent_spectral_intensity_modes(),
                             spectrum->mutable_contrast_spectral_intensity_modes()}) {
    *modes = row.text();
    if (const std::string wrong =
            wrong_modes(*modes, static_cast<std::size_t>(spectrum->lambda_um_size()));
        !wrong.empty())
      return absl::DataLossError(absl::StrCat("signature ", signature_id, ": modes of errors: ",
                                              wrong, "; `irsig doctor` lists what is damaged"));
  }
  return spectrum;
}

absl::StatusOr<std::optional<schema::Clutter>> StoreReader::clutter(std::int64_t signature_id) {
  const auto damaged = [&](const std::string& what) {
    return absl::DataLossError(absl::StrCat("signature ", signature_id, ": clutter: ", what,
                                            "; `irsig doctor` lists what is damaged"));
  };
  schema::Clutter out;
  {
    ASSIGN_OR_RETURN(Rows row, database_->query(sql::clutter_of_signature, signature_id));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return std::nullopt;
    const auto bins = static_cast<int>(row.text().size() / sizeof(double));
    const auto sigma = floats_from_blob(row.text(), bins);
    if (!sigma.ok()) return damaged(std::string(sigma.status().message()));
    *out.mutable_patch_sigma_w_m2_sr_um() = *sigma;
    out.set_modes(row.text());
    if (const std::string wrong = wrong_modes(out.modes(), static_cast<std::size_t>(bins));
        !wrong.empty())
      return damaged(wrong);
  }
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::clutter_materials_of_signature, signature_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    if (row.integer() != out.material_fraction_size()) return damaged("a material is missing");
    out.add_material_fraction(row.real());
  }
}

absl::StatusOr<StoredSweep> StoreReader::sweep(const std::string& name, SweepFiles files) {
  return in_one_snapshot(*database_, [&] { return stored_sweep(name, files); });
}

absl::StatusOr<std::vector<StoredPart>> StoreReader::parts(std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  std::vector<StoredPart> parts;
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::parts_of_signature, signature_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return parts;
    StoredPart& part = parts.emplace_back();
    part.part = row.text();
    part.intensity_w_sr = row.real();
    part.intensity_stderr_w_sr = row.real();
  }
}

absl::StatusOr<StoredLedger> StoreReader::ledger(std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  return find_ledger(*database_, signature_id);
}
absl::StatusOr<std::vector<StoredInput>> StoreReader::inputs(std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  return find_inputs(*database_, signature_id);
}

absl::StatusOr<std::optional<schema::Thumbnail>> StoreReader::thumbnail(std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::thumbnail_of_signature, signature_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return std::nullopt;
  schema::Thumbnail thumbnail;
  thumbnail.set_width_px(static_cast<std::uint32_t>(row.integer()));
  thumbnail.set_height_px(static_cast<std::uint32_t>(row.integer()));
  thumbnail.set_pixel_rad(row.real());
  thumbnail.set_error_relative(row.real());
  thumbnail.set_error_k(row.real());
  thumbnail.set_png(row.text());
  thumbnail.set_exr(row.text());
  thumbnail.set_stderr_exr(row.text());
  return thumbnail;
}

absl::StatusOr<std::vector<schema::ImageLayer>> StoreReader::image_layers(
    std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  std::vector<schema::ImageLayer> layers;
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::image_layers_of_signature, signature_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return layers;
    schema::ImageLayer& layer = layers.emplace_back();
    layer.set_name(row.text());
    layer.set_exr(row.text());
    layer.set_stderr_exr(row.text());
  }
}

absl::StatusOr<std::optional<schema::ImageLayer>> StoreReader::image_layer(
    std::int64_t signature_id, const std::string& name) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::image_layer_of_signature, signature_id, name));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return std::nullopt;
  schema::ImageLayer layer;
  layer.set_name(name);
  layer.set_exr(row.text());
  layer.set_stderr_exr(row.text());
  return layer;
}

absl::StatusOr<std::optional<StoredSilhouette>> StoreReader::silhouette(std::int64_t signature_id) {
  IRSIG_STORE_TRY(check_exists(signature_id));
  schema::Silhouette silhouette;
  std::int64_t job_id = 0;
  {
    ASSIGN_OR_RETURN(Rows row, database_->query(sql::silhouette_of_signature, signature_id));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return std::nullopt;
    job_id = row.integer();
    silhouette.set_width_px(static_cast<std::uint32_t>(row.integer()));
    silhouette.set_height_px(static_cast<std::uint32_t>(row.integer()));
    silhouette.set_pixel_samples(static_cast<std::uint32_t>(row.integer()));
  }
  StoredSilhouette out{
      silhouette.width_px(), silhouette.height_px(), silhouette.pixel_samples(), {}, {}};
  {
    ASSIGN_OR_RETURN(Rows row, database_->query(sql::part_pixels_of_job, job_id));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      schema::PartPixels& packed = *silhouette.add_part();
      packed.set_part_index(static_cast<std::uint32_t>(out.part.size()));
      out.part.push_back({row.text(), {}});
      packed.set_left_px(static_cast<std::uint32_t>(row.integer()));
      packed.set_top_px(static_cast<std::uint32_t>(row.integer()));
      packed.set_width_px(static_cast<std::uint32_t>(row.integer()));
      packed.set_height_px(static_cast<std::uint32_t>(row.integer()));
      packed.set_samples(row.text());
    }
  }
  IRSIG_STORE_TRY(
      visit_silhouette(silhouette, [&](int part, std::uint32_t pixel, std::uint16_t count) {
        out.part[static_cast<std::size_t>(part)].pixel.push_back({pixel, count});
      }));
  {
    ASSIGN_OR_RETURN(Rows row, database_->query(sql::part_sets_of_job, job_id));
    for (;;) {
      ASSIGN_OR_RETURN(const bool found, row.next());
      if (!found) break;
      out.part_set.push_back({absl::StrSplit(row.text(), '\n'), 0, {}});
      schema::PartSetPixels& packed = *silhouette.add_part_set();
      packed.set_outside_px(out.part_set.back().outside_px = row.real());
      packed.set_samples(row.text());
    }
  }
  IRSIG_STORE_TRY(
      visit_part_sets(silhouette, [&](int set, std::uint32_t pixel, std::uint16_t count) {
        out.part_set[static_cast<std::size_t>(set)].pixel.push_back({pixel, count});
      }));
  return out;
}

absl::StatusOr<std::vector<StoredProfileRow>> StoreReader::profiles(const ProfileFilter& filter) {
  return find_profile_rows(*database_, filter);
}

absl::StatusOr<std::vector<StoredPublished>> StoreReader::published(const std::string& sweep) {
  return find_published(*database_, sweep);
}

absl::StatusOr<std::vector<SweepProgress>> StoreReader::progress() {
  return in_one_snapshot(*database_, [&] { return sweep_progress(*database_); });
}

absl::StatusOr<std::optional<StoredPrediction>> StoreReader::prediction(
    const std::string& sweep_sha256) {
  return find_prediction(*database_, sweep_sha256);
}

absl::StatusOr<std::vector<StoredJobCost>> StoreReader::job_costs(const std::string& sweep) {
  return find_job_costs(*database_, sweep);
}

absl::StatusOr<std::map<std::string, std::uint64_t>> StoreReader::rows_of_jobs(
    const std::string& sweep) {
  return find_rows_of_jobs(*database_, sweep);
}

absl::StatusOr<std::vector<StoredTemperature>> StoreReader::computed_temperatures(
    const TemperatureFilter& filter) {
  return find_computed_temperatures(*database_, filter);
}

absl::StatusOr<std::vector<StoredHeatJob>> StoreReader::heat_jobs(const std::string& sweep) {
  return find_heat_jobs(*database_, sweep);
}

absl::StatusOr<StoredOutcome> StoreReader::outcome(const std::string& sweep) {
  return in_one_snapshot(*database_, [&] { return find_outcome(*database_, sweep); });
}

absl::Status StoreReader::visit_errors(const std::string& sweep,
                                       const std::function<void(const StoredSignature&)>& visit) {
  return in_one_snapshot(*database_, [&] { return irsig::visit_errors(*database_, sweep, visit); });
}

absl::StatusOr<std::uint64_t> StoreReader::bytes() { return database_bytes(*database_); }

absl::StatusOr<std::string> StoreReader::digest() {
  return in_one_snapshot(*database_, [&] { return content_digest(*database_); });
}

absl::StatusOr<StoredSweep> StoreReader::stored_sweep(const std::string& name, SweepFiles files) {
  ASSIGN_OR_RETURN(Rows row, database_->query(sql::sweep_by_name, name));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::NotFoundError(absl::StrCat("no sweep \"", name, "\""));
  StoredSweep sweep;
  if (!sweep.resolved.ParseFromString(row.text()))
    return absl::DataLossError(absl::StrCat("the sweep \"", name, "\" cannot be read"));
  if (files == SweepFiles::kNone) return sweep;
  ASSIGN_OR_RETURN(HeatOutputs heat, find_heat_outputs(*database_, name));
  if (heat.size() == static_cast<std::size_t>(sweep.resolved.heat_size()))
    sweep.heat = std::move(heat);
  if (files == SweepFiles::kTemperatures) return sweep;
  for (const std::string& sha256 : needed_assets(sweep.resolved)) {
    absl::StatusOr<std::string> bytes = read_asset(*database_, sha256);
    if (absl::IsNotFound(bytes.status())) continue;
    if (!bytes.ok()) return bytes.status();
    sweep.assets[sha256] = *std::move(bytes);
  }
  return sweep;
}

absl::Status StoreReader::check_exists(std::int64_t signature_id) {
  ASSIGN_OR_RETURN(const std::int64_t count,
                   database_->integer(sql::signature_exists, signature_id));
  return count == 1 ? absl::OkStatus()
                    : absl::NotFoundError(absl::StrCat("no signature ", signature_id));
}

absl::StatusOr<std::unique_ptr<StoreReader>> StoreReader::open(const std::string& path) {
  ASSIGN_OR_RETURN(std::unique_ptr<Database> database, open_for_reading(path));
  return std::make_unique<StoreReader>(std::move(database));
}

absl::StatusOr<std::unique_ptr<StoreReader>> StoreReader::open_as_it_is(const std::string& path) {
  ASSIGN_OR_RETURN(std::unique_ptr<Database> database, irsig::open_as_it_is(path));
  return std::make_unique<StoreReader>(std::move(database));
}

}  // namespace irsig
