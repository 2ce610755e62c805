#include "planning/prediction.h"

#include <chrono>

#include "core/base/status_macros.h"
#include "fmt/format.h"
#include "jobs/keys/expand.h"
#include "planning/amount_text.h"
#include "schema/store/writer.h"

namespace irsig {

StoredPrediction prediction_of(const SweepPilot& pilot, const schema::ResolvedSweep& sweep,
                               std::uint32_t workers) {
  const SweepCost cost = sweep_cost(view_costs(pilot, pilot.rule), pilot.views, pilot.jobs_per_view,
                                    workers, pilot.start_s);
  StoredPrediction p;
  p.sweep_sha256 = sha256_hex(canonical_encoding(sweep));
  p.made_unix_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  p.determinism_class = determinism_class();
  p.workers = workers;
  p.pilot_viewpoints = pilot.view.size();
  p.pilot_cpu_s = pilot.cpu_s;
  p.jobs = pilot.views * pilot.jobs_per_view;
  p.cpu_s = cost.cpu_s;
  p.wall_s = cost.wall_s;
  p.job_cpu_quartile1_s = cost.job_cpu_quartile1_s;
  p.job_cpu_median_s = cost.job_cpu_median_s;
  p.job_cpu_quartile3_s = cost.job_cpu_quartile3_s;
  p.database_bytes =
      static_cast<std::uint64_t>(pilot.database_fixed_bytes +
                                 pilot.database_bytes_per_view * static_cast<double>(pilot.views));
  return p;
}

std::string prediction_line(const StoredPrediction& p) {
  return fmt::format(
      "predicted: {} jobs, median {}, {} of CPU time, {} on {} worker{}, {} (pilot: {} of CPU "
      "time)",
      p.jobs, seconds_text(p.job_cpu_median_s), seconds_text(p.cpu_s), seconds_text(p.wall_s),
      p.workers, p.workers == 1 ? "" : "s", bytes_text(static_cast<double>(p.database_bytes)),
      seconds_text(p.pilot_cpu_s));
}

absl::StatusOr<std::string> store_in(const std::string& db_path,
                                     const StoredPrediction& prediction) {
  ASSIGN_OR_RETURN(auto writer, StoreWriter::open(db_path));
  RETURN_IF_ERROR(writer->begin());
  RETURN_IF_ERROR(writer->store_prediction(prediction));
  RETURN_IF_ERROR(writer->commit());
  const absl::Status finished = writer->finish();
  if (absl::IsUnavailable(finished)) return std::string(finished.message());
  if (!finished.ok()) return finished;
  return std::string();
}

schema::Prediction as_message(const StoredPrediction& p) {
  schema::Prediction message;
  message.set_made_unix_s(p.made_unix_s);
  message.set_determinism_class(p.determinism_class);
  message.set_workers(p.workers);
  message.set_pilot_viewpoints(p.pilot_viewpoints);
  message.set_pilot_cpu_s(p.pilot_cpu_s);
  message.set_jobs(p.jobs);
  message.set_cpu_s(p.cpu_s);
  message.set_wall_s(p.wall_s);
  message.set_job_cpu_quartile1_s(p.job_cpu_quartile1_s);
  message.set_job_cpu_median_s(p.job_cpu_median_s);
  message.set_job_cpu_quartile3_s(p.job_cpu_quartile3_s);
  message.set_database_bytes(p.database_bytes);
  return message;
}

}  // namespace irsig
