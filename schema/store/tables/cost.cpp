#include "schema/store/tables/cost.h"

#include <array>

#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {

absl::Status store_prediction(Database& database, const StoredPrediction& p) {
  return database.run(sql::store_prediction, p.sweep_sha256, p.made_unix_s, p.determinism_class,
                      p.workers, p.pilot_viewpoints, p.pilot_cpu_s, p.jobs, p.cpu_s, p.wall_s,
                      p.job_cpu_quartile1_s, p.job_cpu_median_s, p.job_cpu_quartile3_s,
                      p.database_bytes);
}

absl::StatusOr<std::optional<StoredPrediction>> find_prediction(Database& database,
                                                                const std::string& sweep_sha256) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::prediction_of_sweep, sweep_sha256));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return std::nullopt;
  StoredPrediction p;
  p.sweep_sha256 = row.text();
  p.made_unix_s = row.real();
  p.determinism_class = row.text();
  p.workers = row.count();
  p.pilot_viewpoints = row.count();
  p.pilot_cpu_s = row.real();
  p.jobs = row.count();
  for (double* number :
       {&p.cpu_s, &p.wall_s, &p.job_cpu_quartile1_s, &p.job_cpu_median_s, &p.job_cpu_quartile3_s})
    *number = row.real();
  p.database_bytes = row.count();
  return p;
}

absl::StatusOr<std::vector<StoredJobCost>> find_job_costs(Database& database,
                                                          const std::string& sweep) {
  std::vector<StoredJobCost> out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::done_jobs, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    StoredJobCost& job = out.emplace_back();
    job.job_index = row.count();
    job.viewpoint_index = row.count();
    job.cpu_s = row.real();
    for (std::uint64_t* number :
         {&job.samples, &job.replicates, &job.target_paths, &job.rays, &job.guarded_backface_hits,
          &job.guarded_nonfinite, &job.truncated_paths})
      *number = row.count();
    const bool counted = !row.is_null();
    const std::uint64_t negative = row.count();
    if (counted) job.guarded_negative = negative;
    job.worker_name = row.text();
    job.leased_unix_s = row.real();
    job.determinism_class = row.text();
  }
}

absl::StatusOr<std::map<std::string, std::uint64_t>> find_rows_of_jobs(Database& database,
                                                                       const std::string& sweep) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::rows_of_jobs, sweep));
  std::map<std::string, std::uint64_t> out;
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return out;
    const std::string key = row.text();
    out[key] = row.count();
  }
}

absl::StatusOr<StoredOutcome> find_outcome(Database& database, const std::string& sweep) {
  StoredOutcome out;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::stops_of_sweep, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) break;
    std::string reason = row.text();
    out.stop.emplace_back(std::move(reason), row.count());
  }
  ASSIGN_OR_RETURN(Rows faces, database.query(sql::back_faces_of_sweep, sweep));
  if (const auto found = faces.next(); !found.ok()) return found.status();
  out.backface_views = faces.count();
  out.largest_backface_fraction = faces.real();
  ASSIGN_OR_RETURN(Rows images, database.query(sql::image_errors_of_sweep, sweep));
  if (const auto found = images.next(); !found.ok()) return found.status();
  out.image_error_relative = images.real();
  out.image_error_k = images.real();
  return out;
}

absl::Status visit_errors(Database& database, const std::string& sweep,
                          const std::function<void(const StoredSignature&)>& visit) {
  // In the order of the query's columns.
  constexpr auto kNumbers = std::to_array<double StoredSignature::*>(
      {&StoredSignature::intensity_w_sr, &StoredSignature::intensity_stderr_w_sr,
       &StoredSignature::numerical_error_w_sr, &StoredSignature::undersampling_stderr_w_sr,
       &StoredSignature::truncation_bound_w_sr, &StoredSignature::quadrature_bound_w_sr,
       &StoredSignature::spectral_basis_bound_w_sr, &StoredSignature::undersampling_bound_w_sr,
       &StoredSignature::direction_interpolation_bound_w_sr, &StoredSignature::omitted_bound_w_sr,
       &StoredSignature::temperature_bound_w_sr, &StoredSignature::plume_bound_w_sr});
  StoredSignature row{};
  for (const auto member : kQuantityMember) row.*member = kNotComputed;
  ASSIGN_OR_RETURN(Rows rows, database.query(sql::errors_of_sweep, sweep));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, rows.next());
    if (!found) return absl::OkStatus();
    row.stop_reason = rows.text();
    row.limiting_bound = rows.text();
    row.superseded = rows.integer() != 0;
    for (const auto member : kNumbers) {
      const bool known = !rows.is_null();
      const double number = rows.real();
      row.*member = known ? number : kNotComputed;
    }
    visit(row);
  }
}

absl::StatusOr<std::uint64_t> database_bytes(Database& database) {
  ASSIGN_OR_RETURN(const std::int64_t bytes, database.integer(sql::database_bytes));
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace irsig
