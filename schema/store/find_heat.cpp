#include "schema/store/find_heat.h"

#include <utility>

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"

namespace irsig {

absl::StatusOr<HeatOutputs> find_heat_outputs(Database& database, const std::string& sweep) {
  HeatOutputs out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::heat_outputs_of_sweep, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    ASSIGN_OR_RETURN(std::string output, read_asset(database, row.text()));
    out.push_back(std::move(output));
  }
}

absl::StatusOr<std::vector<StoredTemperature>> find_computed_temperatures(
    Database& database, const TemperatureFilter& filter) {
  std::vector<StoredTemperature> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::find_computed_temperatures, filter.sweep,
                                            filter.season.json(), filter.time_utc));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredTemperature& t = out.emplace_back();
    for (std::string* text : {&t.sweep, &t.season, &t.time_utc, &t.part}) *text = row.text();
    for (double* number : {&t.mean_k, &t.coldest_k, &t.hottest_k, &t.error_k}) *number = row.real();
    t.superseded = row.integer() != 0;
    t.job_key = row.text();
  }
}

absl::StatusOr<std::vector<StoredHeatJob>> find_heat_jobs(Database& database,
                                                          const std::string& sweep) {
  std::vector<StoredHeatJob> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::heat_jobs_of_sweep, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredHeatJob& job = out.emplace_back();
    job.season = row.text();
    job.done = row.integer() != 0;
    job.cpu_s = row.real();
    job.warning = row.text();
  }
}

}  // namespace irsig
