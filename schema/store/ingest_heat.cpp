#include "schema/store/ingest_heat.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/status_macros.h"
#include "schema/store/check/check_heat_result.h"
#include "schema/store/tables/sha256.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"

namespace irsig {
namespace {

struct AskedRun {
  schema::HeatRun run;
  std::uint64_t seed;
};

absl::StatusOr<AskedRun> run_of(Database& database, const LeasedJob& job) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::resolved_sweep_by_id, job.sweep_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  schema::ResolvedSweep sweep;
  if (!found || !sweep.ParseFromString(row.text()) ||
      job.heat_index >= static_cast<std::uint32_t>(sweep.heat_size()))
    return absl::DataLossError(
        absl::StrCat("the stored sweep of job ", job.job_key, " has no such heat run"));
  return AskedRun{std::move(*sweep.mutable_heat(static_cast<int>(job.heat_index))),
                  sweep.sweep().seed()};
}

// Deletes the superseded jobs that this heat run has replaced.
absl::Status delete_superseded(Database& database, std::int64_t sweep_id,
                               const schema::HeatRun& run) {
  if (run.input_size() > 0)
    return database.run(sql::delete_superseded_changes_of_season, sweep_id, run.season());
  return database.run(sql::delete_superseded_heat_jobs_of_season, sweep_id, run.season());
}

}  // namespace

std::int64_t computed_temperatures_of(const schema::HeatRun& run) {
  if (run.input_size() > 0) return 0;  // by how much they change is no temperature
  return std::count(run.part_temperature_k().begin(), run.part_temperature_k().end(), 0.0) *
         run.time_utc_size();
}

absl::Status store_heat(Database& database, const LeasedJob& job, const schema::JobResult& result) {
  ASSIGN_OR_RETURN(const AskedRun asked, run_of(database, job));
  const schema::HeatRun& run = asked.run;
  IRSIG_STORE_TRY(check_heat_result(result, job.job_key, run, asked.seed));
  ASSIGN_OR_RETURN(const std::vector<std::int64_t> parts, part_ids(database, job.sweep_id));
  if (parts.size() != static_cast<std::size_t>(run.part_temperature_k_size()))
    return absl::DataLossError(absl::StrCat("the stored sweep of job ", job.job_key, " has ",
                                            parts.size(), " parts, its heat run ",
                                            run.part_temperature_k_size()));
  const std::string sha256 = sha256_of(result.heat().field());
  IRSIG_STORE_TRY(store_asset(database, sha256, result.heat().field()));
  IRSIG_STORE_TRY(database.run(sql::set_heat_output, job.job_id, sha256,
                               absl::StrJoin(result.heat().warning(), "\n")));
  IRSIG_STORE_TRY(database.run(sql::delete_computed_temperatures, job.job_id));
  for (const schema::PartTemperature& part : result.heat().part()) {
    IRSIG_STORE_TRY(database.run(sql::insert_computed_temperature, job.job_id, part.time_index(),
                                 run.time_utc(static_cast<int>(part.time_index())),
                                 parts[part.part_index()], part.mean_k(), part.coldest_k(),
                                 part.hottest_k(), part.error_k()));
  }
  return delete_superseded(database, job.sweep_id, run);
}

absl::StatusOr<bool> copy_twin(Database& database, const LeasedJob& job,
                               const std::string& determinism_class) {
  if (job.kind != JobKind::kHeat) return false;
  ASSIGN_OR_RETURN(const AskedRun asked, run_of(database, job));
  const schema::HeatRun& run = asked.run;
  std::int64_t twin = 0;
  std::string output;
  {
    ASSIGN_OR_RETURN(Rows row, database.query(sql::done_twin, job.job_id, job.job_key,
                                              determinism_class, computed_temperatures_of(run)));
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return false;
    twin = row.integer();
    output = row.text();
  }
  // Damaged output of the twin is computed again by this job, which repairs both.
  const absl::Status whole = check_asset(database, output);
  if (absl::IsDataLoss(whole) || absl::IsNotFound(whole)) return false;
  IRSIG_STORE_TRY(whole);
  IRSIG_STORE_TRY(database.run(sql::copy_heat_output, job.job_id, twin));
  IRSIG_STORE_TRY(database.run(sql::delete_computed_temperatures, job.job_id));
  IRSIG_STORE_TRY(database.run(sql::copy_computed_temperatures, job.job_id, twin, job.sweep_id));
  IRSIG_STORE_TRY(database.run(sql::copy_provenance, job.job_id, twin));
  IRSIG_STORE_TRY(delete_superseded(database, job.sweep_id, run));
  return true;
}

}  // namespace irsig
