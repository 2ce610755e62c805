#include "schema/store/sweep_table.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "google/protobuf/io/coded_stream.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/util/json_util.h"
#include "schema/shard.h"
#include "schema/store/check/check_sweep.h"
#include "schema/store/check/ingest_inputs.h"
#include "schema/store/ingest_heat.h"
#include "schema/store/queue.h"
#include "schema/store/tables/heat_time.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"

namespace irsig {
namespace {

using Ids = std::vector<std::int64_t>;

std::string serialized(const google::protobuf::Message& message) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  message.SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

// -0.0 and 0.0 are the same direction and must find each other in an index.
double without_sign_of_zero(double value) { return value + 0.0; }

template <typename Message, typename Value>
std::optional<Value> if_key_stated(bool stated, Value (Message::*field)() const,
                                   const Message& message) {
  return stated ? std::optional<Value>((message.*field)()) : std::nullopt;
}

// Returns the definition that distinguishes a condition from others: all of it except its place in
// the lists and the way it was written.
std::string condition_definition(const schema::Condition& condition,
                                 const schema::ResolvedSweep& sweep) {
  schema::Condition definition = condition;
  definition.clear_season_index();
  definition.clear_time_index();
  definition.clear_sun_irradiance_from_distance();
  definition.clear_warning();
  Sha256 hash;
  // A heat run counts by its content, not by its place in the list.
  const auto add_run = [&](std::uint32_t index) {
    schema::HeatRun run = sweep.heat(static_cast<int>(index));
    run.clear_season();
    run.clear_time_utc();
    hash.add(serialized(run));
  };
  if (definition.has_temperature_field()) {
    schema::ConditionField& from = *definition.mutable_temperature_field();
    from.clear_file_name();
    if (from.has_heat()) {
      add_run(from.heat());
      from.set_heat(0);
    }
  }
  if (definition.has_land_heat()) {
    add_run(definition.land_heat());
    definition.set_land_heat(0);
  }
  hash.add(serialized(definition));
  for (const schema::Part& part : sweep.sweep().part())
    hash.add(absl::StrCat(part.name(), "\n", part.material(), "\n"));
  return hash.hex();
}

// Where a condition's computed temperatures stand among the runs; nothing: none are.
struct HeatPlace {
  std::optional<int> heat_index, time_index;
};
HeatPlace heat_place(const schema::Condition& condition, const schema::ResolvedSweep& sweep) {
  if (!condition.temperature_field().has_heat()) return {};
  const int heat_index = static_cast<int>(condition.temperature_field().heat());
  return {heat_index, time_index_of(sweep.heat(heat_index), condition.time_utc())};
}

std::string warnings(const schema::Condition& condition) {
  return absl::StrJoin(condition.warning(), "\n");
}

// For people and for the digest; the files' texts are kept with the sweep.
absl::StatusOr<std::optional<std::string>> weather_text(const schema::Condition& condition) {
  if (!condition.has_weather()) return std::nullopt;
  schema::Weather weather = condition.weather();
  if (!weather.profile_csv().empty()) weather.set_profile_csv(sha256_of(weather.profile_csv()));
  if (!weather.modtran_text().empty()) weather.set_modtran_text(sha256_of(weather.modtran_text()));
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(weather, &json, options);
  if (!status.ok()) return absl::InternalError(absl::StrCat("weather: ", status.ToString()));
  return json;
}

// For people and for the digest: which file, and how it is read; or that a job computes them.
std::optional<std::string> field_text(const schema::Condition& condition) {
  if (!condition.has_temperature_field()) return std::nullopt;
  const schema::ConditionField& from = condition.temperature_field();
  if (from.has_heat()) return "computed";
  const schema::TemperatureField& field = from.field();
  return absl::StrCat(field.name(), ": ", from.sha256(), ", ", field.unit(), ", by ", field.match(),
                      field.has_max_distance_m()
                          ? absl::StrCat(" within ", field.max_distance_m(), " m")
                          : std::string(),
                      field.has_error_k() ? absl::StrCat(", +- ", field.error_k(), " K") : "");
}

// Adds or updates one sweep, step by step in the order of its methods.
class SweepUpdate {
 public:
  SweepUpdate(Database& database, const schema::ResolvedSweep& sweep)
      : database_(database), sweep_(sweep) {}

  absl::Status put_sweep(const std::string& sha256) {
    const std::string& name = sweep_.sweep().name();
    const std::string bytes = serialized(sweep_);
    const schema::Output& output = sweep_.sweep().output();
    const auto thumbnail_px =
        if_key_stated(output.has_thumbnail_px(), &schema::Output::thumbnail_px, output);
    const schema::Place& place = sweep_.sweep().place();
    const auto longitude_deg =
        if_key_stated(place.has_longitude_deg(), &schema::Place::longitude_deg, place);
    const absl::StatusOr<std::int64_t> known = database_.integer(sql::sweep_id_by_name, name);
    if (!known.ok() && !absl::IsNotFound(known.status())) return known.status();
    if (known.ok()) {
      sweep_id_ = *known;
      if (sweep_.has_shard()) IRSIG_STORE_TRY(check_shard());
      return database_.run(sql::update_sweep, sweep_id_, sha256, sweep_.viewpoint_size(),
                           sweep_.condition_size(), sweep_.sweep().band_size(),
                           sweep_.model_sha256(), thumbnail_px, Blob{bytes}, longitude_deg);
    }
    IRSIG_STORE_TRY(database_.run(sql::insert_sweep, name, sha256, sweep_.viewpoint_size(),
                                  sweep_.condition_size(), sweep_.sweep().band_size(),
                                  sweep_.model_sha256(), thumbnail_px, Blob{bytes}, longitude_deg));
    sweep_id_ = database_.last_insert_rowid();
    return absl::OkStatus();
  }

  absl::Status put_assets(const std::vector<Asset>& assets, const std::string& sweep_sha256) {
    std::set<std::string> known;
    for (const Asset& asset : assets) {
      // The sweep's own hash is that of its canonical encoding, not of its bytes; it is kept with
      // the sweep.
      if (asset.sha256 == sweep_sha256) continue;
      if ((asset.file ? asset.file->sha256() : sha256_of(asset.bytes)) != asset.sha256) {
        return absl::InvalidArgumentError(
            absl::StrCat("the asset ", asset.sha256, " has other bytes than its name says"));
      }
      IRSIG_STORE_TRY(store_asset(database_, asset));
      known.insert(asset.sha256);
    }
    for (const std::string& sha256 : needed_assets(sweep_)) {
      if (!known.insert(sha256).second) continue;
      const absl::Status there = check_asset(database_, sha256);
      if (absl::IsNotFound(there)) {
        return absl::InvalidArgumentError(
            absl::StrCat(sha256 == sweep_.model_sha256() ? "the model file " : "the file ", sha256,
                         " is not among the assets"));
      }
      IRSIG_STORE_TRY(there);
    }
    IRSIG_STORE_TRY(database_.run(sql::clear_sweep_assets, sweep_id_));
    for (const std::string& sha256 : known)
      IRSIG_STORE_TRY(database_.run(sql::insert_sweep_asset, sweep_id_, sha256));
    return absl::OkStatus();
  }

  absl::Status put_profiles() {
    const schema::Sweep& sweep = sweep_.sweep();
    std::uint64_t rows = 0;
    for (const schema::Profile& profile : sweep.profile()) {
      const std::uint64_t points = profile.at_m_size() > 0 ? 1 : profile.points();
      rows += points * static_cast<std::uint64_t>(profile.reflections_size());
    }
    IRSIG_STORE_TRY(database_.run(sql::set_profile_rows, sweep_id_, rows));
    IRSIG_STORE_TRY(database_.run(sql::set_image_layers, sweep_id_,
                                  absl::StrJoin(sweep.image().layers(), ",")));
    IRSIG_STORE_TRY(database_.run(sql::set_uncertain_inputs, sweep_id_,
                                  absl::StrJoin(input_names(sweep_), ",")));
    IRSIG_STORE_TRY(database_.run(sql::clear_published, sweep_id_));
    for (int i = 0; i < sweep.published_size(); ++i) {
      const schema::Published& p = sweep.published(i);
      IRSIG_STORE_TRY(database_.run(
          sql::insert_published, sweep_id_, i, p.profile(), p.point_index(), p.reflections(),
          p.source_radiance_temperature_k(), p.relation(), p.source(), p.remark()));
    }
    return absl::OkStatus();
  }

  absl::Status put_parts() {
    IRSIG_STORE_TRY(database_.run(sql::supersede_parts, sweep_id_));
    for (int i = 0; i < sweep_.sweep().part_size(); ++i) {
      const schema::Part& part = sweep_.sweep().part(i);
      absl::StatusOr<std::int64_t> id =
          database_.integer(sql::revive_part, sweep_id_, part.name(), part.material(), i);
      if (absl::IsNotFound(id.status())) {
        id = database_.integer(sql::insert_part, sweep_id_, part.name(), part.material(), i);
      }
      if (!id.ok()) return id.status();
      part_ids_.push_back(*id);
    }
    return absl::OkStatus();
  }

  absl::Status put_conditions() {
    IRSIG_STORE_TRY(database_.run(sql::supersede_conditions, sweep_id_));
    for (int i = 0; i < sweep_.condition_size(); ++i) {
      const std::string definition = condition_definition(sweep_.condition(i), sweep_);
      const HeatPlace place = heat_place(sweep_.condition(i), sweep_);
      const absl::StatusOr<std::int64_t> id =
          database_.integer(sql::revive_condition, sweep_id_, definition, i,
                            warnings(sweep_.condition(i)), place.heat_index, place.time_index);
      if (id.ok()) continue;
      if (!absl::IsNotFound(id.status())) return id.status();
      IRSIG_STORE_TRY(insert_condition(i, definition));
    }
    return absl::OkStatus();
  }

  absl::Status put_bands() {
    IRSIG_STORE_TRY(database_.run(sql::supersede_bands, sweep_id_));
    for (int i = 0; i < sweep_.sweep().band_size(); ++i) {
      const schema::Band& band = sweep_.sweep().band(i);
      const std::string definition = sha256_of(serialized(band));
      absl::StatusOr<std::int64_t> id =
          database_.integer(sql::revive_band, sweep_id_, definition, i);
      if (id.ok()) continue;
      if (!absl::IsNotFound(id.status())) return id.status();
      id = database_.integer(sql::insert_band, sweep_id_, definition, i, band.name(),
                             band.lambda_min_um(), band.lambda_max_um());
      if (!id.ok()) return id.status();
      for (const schema::SpectralPoint& point : band.response()) {
        IRSIG_STORE_TRY(
            database_.run(sql::insert_band_response, *id, point.lambda_um(), point.value()));
      }
    }
    return absl::OkStatus();
  }

  absl::Status put_viewpoints() {
    IRSIG_STORE_TRY(database_.run(sql::shift_viewpoints, sweep_id_));
    for (int i = 0; i < sweep_.viewpoint_size(); ++i) {
      const schema::Viewpoint& viewpoint = sweep_.viewpoint(i);
      const double azimuth_deg = without_sign_of_zero(viewpoint.aspect_azimuth_deg());
      const double elevation_deg = without_sign_of_zero(viewpoint.aspect_elevation_deg());
      absl::StatusOr<std::int64_t> id = database_.integer(
          sql::revive_viewpoint, sweep_id_, azimuth_deg, elevation_deg, viewpoint.range_m(), i);
      if (absl::IsNotFound(id.status())) {
        id = database_.integer(sql::insert_viewpoint, sweep_id_, azimuth_deg, elevation_deg,
                               viewpoint.range_m(), i);
      }
      if (!id.ok()) return id.status();
      viewpoint_ids_.push_back(*id);
    }
    IRSIG_STORE_TRY(database_.run(sql::delete_signatures_of_gone_viewpoints, sweep_id_));
    if (sweep_.has_shard())
      IRSIG_STORE_TRY(database_.run(sql::delete_signatures_of_other_shards, sweep_id_,
                                    sweep_.shard().number() - 1, sweep_.shard().of()));
    IRSIG_STORE_TRY(database_.run(sql::delete_jobs_of_gone_viewpoints, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_directions_of_gone_viewpoints, sweep_id_));
    return database_.run(sql::delete_gone_viewpoints, sweep_id_);
  }

  absl::Status put_jobs(const std::vector<schema::JobSpec>& jobs) {
    IRSIG_STORE_TRY(database_.run(sql::supersede_jobs, sweep_id_));
    for (std::size_t i = 0; i < jobs.size(); ++i) IRSIG_STORE_TRY(put_job(jobs[i], i));
    IRSIG_STORE_TRY(database_.run(sql::clear_needs, sweep_id_));
    for (const schema::JobSpec& job : jobs) {
      for (const std::string& needed : job.needs())
        IRSIG_STORE_TRY(database_.run(sql::insert_need, sweep_id_, job.job_key(), needed));
    }
    return database_.run(sql::count_needs, sweep_id_);
  }

  absl::Status remove_what_is_gone() {
    IRSIG_STORE_TRY(database_.run(sql::delete_signatures_of_gone_conditions, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_signatures_of_gone_bands, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::place_superseded_conditions, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::place_superseded_bands, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::revoke_superseded_leases, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::settle_superseded_jobs, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_temperatures_of_gone_runs, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_temperatures_of_gone_times, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_superseded_jobs, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_superseded_conditions, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_superseded_bands, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_superseded_parts, sweep_id_));
    IRSIG_STORE_TRY(database_.run(sql::delete_unused_assets));
    return database_.run(sql::unbind_sweep_without_results, sweep_id_);
  }

  absl::StatusOr<std::uint64_t> count_jobs_to_compute() {
    ASSIGN_OR_RETURN(const std::int64_t count,
                     database_.integer(sql::count_jobs_to_compute, sweep_id_));
    return static_cast<std::uint64_t>(count);
  }

 private:
  absl::Status check_shard() {
    ASSIGN_OR_RETURN(Rows row, database_.query(sql::resolved_sweep_by_id, sweep_id_));
    RETURN_IF_ERROR(row.next().status());
    schema::ResolvedSweep stored;
    if (!stored.ParseFromString(row.text()))
      return absl::DataLossError(
          absl::StrCat("the sweep \"", sweep_.sweep().name(), "\" cannot be read"));
    return check_may_replace(stored, sweep_);
  }

  absl::Status insert_condition(int index, const std::string& definition) {
    const schema::Condition& condition = sweep_.condition(index);
    const schema::Surroundings& around = condition.surroundings();
    using S = schema::Surroundings;
    ASSIGN_OR_RETURN(const std::optional<std::string> weather, weather_text(condition));
    const HeatPlace place = heat_place(condition, sweep_);
    ASSIGN_OR_RETURN(
        const std::int64_t id,
        database_.integer(
            sql::insert_condition, sweep_id_, definition, index, condition.season(),
            condition.time_utc(), condition.sun_irradiance_w_m2(), condition.air_temperature_k(),
            around.kind(),
            if_key_stated(around.has_sky_temperature_k(), &S::sky_temperature_k, around),
            if_key_stated(around.has_sky_radiance_w_m2_sr_um(), &S::sky_radiance_w_m2_sr_um,
                          around),
            if_key_stated(around.has_sea_temperature_k(), &S::sea_temperature_k, around),
            if_key_stated(around.has_sea_emissivity(), &S::sea_emissivity, around),
            if_key_stated(around.has_lower_radiance_w_m2_sr_um(), &S::lower_radiance_w_m2_sr_um,
                          around),
            around.has_sea_model() ? std::optional<std::string>(around.sea_model()) : std::nullopt,
            if_key_stated(around.has_ground_temperature_k(), &S::ground_temperature_k, around),
            if_key_stated(around.has_ground_emissivity(), &S::ground_emissivity, around), weather,
            warnings(condition), field_text(condition), place.heat_index, place.time_index));
    const auto& by_field = condition.temperature_field().part();
    for (std::size_t part = 0; part < part_ids_.size(); ++part) {
      if (std::find(by_field.begin(), by_field.end(), part) != by_field.end()) continue;
      IRSIG_STORE_TRY(database_.run(sql::insert_part_temperature, id, part_ids_[part],
                                    condition.part_temperature_k(static_cast<int>(part))));
    }
    return absl::OkStatus();
  }

  struct KnownJob {
    std::int64_t job_id;
    JobState state;
    JobKind kind;
    std::int64_t viewpoint_id;  // of a view
    std::string condition_index, band_index;
  };

  absl::StatusOr<std::optional<KnownJob>> known_job(const std::string& job_key) {
    ASSIGN_OR_RETURN(Rows row, database_.query(sql::job_by_key, sweep_id_, job_key));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return std::nullopt;
    KnownJob job;
    job.job_id = row.integer();
    job.state = static_cast<JobState>(row.integer());
    ASSIGN_OR_RETURN(const JobKind kind, job_kind(row.integer()));
    job.kind = kind;
    job.viewpoint_id = row.integer();
    job.condition_index = row.text();
    job.band_index = row.text();
    return job;
  }

  absl::Status put_job(const schema::JobSpec& spec, std::size_t index) {
    ASSIGN_OR_RETURN(const std::optional<KnownJob> known, known_job(spec.job_key()));
    switch (spec.kind_case()) {
      case schema::JobSpec::kView:
        return put_view_job(spec.job_key(), spec.view(), index, known);
      case schema::JobSpec::kHeat:
        return put_heat_job(spec.job_key(), spec.heat(), index, known);
      case schema::JobSpec::KIND_NOT_SET:
        break;
    }
    return absl::InternalError("a job of no known kind");  // check_sweep refuses it
  }

  absl::Status put_view_job(const std::string& job_key, const schema::ViewJob& spec,
                            std::size_t index, const std::optional<KnownJob>& known) {
    const std::int64_t viewpoint_id = viewpoint_ids_[spec.viewpoint_index()];
    const std::string condition_index = index_list_text(spec.condition_index());
    const std::string band_index = index_list_text(spec.band_index());
    if (!known) {
      return database_.run(sql::insert_view_job, sweep_id_, job_key, index, viewpoint_id,
                           condition_index, band_index);
    }
    const KnownJob& job = *known;
    if (job.kind != JobKind::kView)
      return absl::InvalidArgumentError(
          absl::StrCat("the job \"", job_key, "\" was of another kind"));
    JobState state = JobState::kWaiting;
    if (job.state == JobState::kDone) {
      // All its signatures must still be there (a version of the sweep in between may have replaced
      // some) and mean what they meant.
      ASSIGN_OR_RETURN(const std::int64_t signatures,
                       database_.integer(sql::count_current_signatures, job.job_id));
      const int expected = spec.condition_index_size() * spec.band_index_size();
      if (signatures == expected && job.viewpoint_id == viewpoint_id) state = JobState::kDone;
    } else if (job.state == JobState::kLeased) {
      // The worker's result will name conditions and bands by the indices that it was given.
      const bool same = job.condition_index == condition_index && job.band_index == band_index;
      if (same) {
        state = JobState::kLeased;
      } else {
        IRSIG_STORE_TRY(database_.run(sql::revoke_lease_of_job, job.job_id));
      }
    }
    return database_.run(sql::revive_view_job, job.job_id, index, viewpoint_id, condition_index,
                         band_index, static_cast<int>(state));
  }

  absl::Status put_heat_job(const std::string& job_key, const schema::HeatJob& spec,
                            std::size_t index, const std::optional<KnownJob>& known) {
    const schema::HeatRun& run = sweep_.heat(static_cast<int>(spec.heat()));
    if (!known) {
      ASSIGN_OR_RETURN(const std::int64_t id,
                       database_.integer(sql::insert_heat_job, sweep_id_, job_key, index));
      return database_.run(sql::insert_heat_run, id, spec.heat(), run.season());
    }
    if (known->kind != JobKind::kHeat)
      return absl::InvalidArgumentError(
          absl::StrCat("the job \"", job_key, "\" was of another kind"));
    JobState state = JobState::kWaiting;
    if (known->state == JobState::kLeased) {
      state = JobState::kLeased;  // its result names parts and times of the run, which are the same
    } else if (known->state == JobState::kDone) {
      // A version of the sweep in between may have had fewer times.
      ASSIGN_OR_RETURN(const std::int64_t stored,
                       database_.integer(sql::count_computed_temperatures, known->job_id));
      const absl::Status output = check_heat_output(database_, known->job_id);
      if (!output.ok() && !absl::IsNotFound(output) && !absl::IsDataLoss(output)) return output;
      if (stored == computed_temperatures_of(run) && output.ok()) state = JobState::kDone;
    }
    IRSIG_STORE_TRY(database_.run(sql::place_heat_run, known->job_id, spec.heat()));
    return database_.run(sql::revive_job, known->job_id, index, static_cast<int>(state));
  }

  Database& database_;
  const schema::ResolvedSweep& sweep_;
  std::int64_t sweep_id_ = 0;
  Ids part_ids_, viewpoint_ids_;
};

}  // namespace

absl::StatusOr<AddedJobs> store_sweep(Database& database, const schema::ResolvedSweep& sweep,
                                      const std::string& sweep_sha256,
                                      const std::vector<schema::JobSpec>& jobs,
                                      const std::vector<Asset>& assets) {
  IRSIG_STORE_TRY(check_sweep(sweep, sweep_sha256, jobs));
  ASSIGN_OR_RETURN(std::unique_ptr<Savepoint> savepoint, Savepoint::open(database));
  SweepUpdate update(database, sweep);
  IRSIG_STORE_TRY(update.put_sweep(sweep_sha256));
  IRSIG_STORE_TRY(update.put_assets(assets, sweep_sha256));
  IRSIG_STORE_TRY(update.put_profiles());
  IRSIG_STORE_TRY(update.put_parts());
  IRSIG_STORE_TRY(update.put_conditions());
  IRSIG_STORE_TRY(update.put_bands());
  IRSIG_STORE_TRY(update.put_viewpoints());
  IRSIG_STORE_TRY(update.put_jobs(jobs));
  IRSIG_STORE_TRY(update.remove_what_is_gone());
  ASSIGN_OR_RETURN(const std::uint64_t to_compute, update.count_jobs_to_compute());
  IRSIG_STORE_TRY(savepoint->keep());
  return AddedJobs{.jobs = jobs.size(), .to_compute = to_compute};
}

UnitVector unit_vector(double aspect_azimuth_deg, double aspect_elevation_deg) {
  // At the poles the azimuth is free: exactly one direction, not one for each azimuth's rounding.
  if (std::abs(aspect_elevation_deg) == 90) return {0, 0, aspect_elevation_deg > 0 ? -1.0 : 1.0};
  constexpr double kRadPerDeg = std::numbers::pi / 180;
  const double azimuth_rad = aspect_azimuth_deg * kRadPerDeg;
  const double elevation_rad = aspect_elevation_deg * kRadPerDeg;
  return {std::cos(elevation_rad) * std::cos(azimuth_rad),
          std::cos(elevation_rad) * std::sin(azimuth_rad), -std::sin(elevation_rad)};
}

}  // namespace irsig
