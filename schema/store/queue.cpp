#include "schema/store/queue.h"

#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/statements.h"

namespace irsig {
namespace {

constexpr std::int64_t kFailedWorkersToQuarantine = 3;
// Longest stored message of a failed job.
constexpr std::size_t kMostMessage = 500;

std::string shortened(const std::string& message) {
  return message.size() <= kMostMessage ? message : message.substr(0, kMostMessage) + " ...";
}

// A job that can only fail is quarantined after so many failures, even with fewer workers than
// kFailedWorkersToQuarantine.
constexpr std::int64_t kFailuresToQuarantine = 6;

absl::StatusOr<QueuedJob> queued_job(Database& database, std::int64_t job_id,
                                     std::uint64_t fencing_token) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::queued_job, job_id));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::InternalError(absl::StrCat("no job ", job_id));
  QueuedJob job{};
  job.spec.set_sweep_sha256(row.text());
  job.spec.set_job_key(row.text());
  ASSIGN_OR_RETURN(const JobKind kind, job_kind(row.integer()));
  const auto heat_index = static_cast<std::uint32_t>(row.integer());
  switch (kind) {
    case JobKind::kHeat:
      job.spec.mutable_heat()->set_heat(heat_index);
      for (int of_views = 0; of_views < 3; ++of_views) row.integer();  // NULL
      break;
    case JobKind::kView: {
      schema::ViewJob& view = *job.spec.mutable_view();
      view.set_viewpoint_index(static_cast<std::uint32_t>(row.integer()));
      for (auto* list : {view.mutable_condition_index(), view.mutable_band_index()}) {
        ASSIGN_OR_RETURN(const std::vector<std::uint32_t> values, index_list(row.text()));
        list->Add(values.begin(), values.end());
      }
      break;
    }
  }
  job.state = static_cast<JobState>(row.integer());
  job.failures = static_cast<std::uint32_t>(row.integer());
  job.fencing_token = fencing_token;
  ASSIGN_OR_RETURN(Rows need, database.query(sql::needs_of_job, job_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool more, need.next());
    if (!more) return job;
    job.spec.add_needs(need.text());
    job.output.push_back(need.text());
  }
}

}  // namespace

absl::StatusOr<JobKind> job_kind(std::int64_t stored) {
  for (const JobKind kind : {JobKind::kView, JobKind::kHeat})
    if (stored == static_cast<std::int64_t>(kind)) return kind;
  return absl::DataLossError(absl::StrCat("a stored job is of kind ", stored));
}

std::string index_list_text(const google::protobuf::RepeatedField<std::uint32_t>& list) {
  return absl::StrCat("[", absl::StrJoin(list, ","), "]");
}

absl::StatusOr<std::vector<std::uint32_t>> index_list(const std::string& text) {
  absl::string_view items = text;
  std::vector<std::uint32_t> values;
  const bool framed = absl::ConsumePrefix(&items, "[") && absl::ConsumeSuffix(&items, "]");
  for (const absl::string_view item : absl::StrSplit(items, ',')) {
    if (!framed || !absl::SimpleAtoi(item, &values.emplace_back())) {
      return absl::DataLossError(absl::StrCat("a stored job has the index list \"", text, "\""));
    }
  }
  return values;
}

absl::StatusOr<std::optional<QueuedJob>> lease_next_job(Database& database,
                                                        const std::string& worker_id,
                                                        double now_s) {
  const absl::StatusOr<std::int64_t> job_id = database.integer(sql::next_waiting_job);
  if (absl::IsNotFound(job_id.status())) return std::nullopt;
  if (!job_id.ok()) return job_id.status();
  ASSIGN_OR_RETURN(const std::int64_t token,
                   database.integer(sql::insert_attempt, *job_id, worker_id, now_s));
  IRSIG_STORE_TRY(database.run(sql::set_job_state, *job_id, static_cast<int>(JobState::kLeased)));
  ASSIGN_OR_RETURN(QueuedJob job, queued_job(database, *job_id, static_cast<std::uint64_t>(token)));
  return job;
}

absl::StatusOr<LeasedJob> leased_job(Database& database, std::uint64_t fencing_token) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::leased_job, fencing_token));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) {
    return absl::FailedPreconditionError(
        absl::StrCat("fencing token ", fencing_token, " is not that of a current lease"));
  }
  LeasedJob job;
  job.job_id = row.integer();
  job.sweep_id = row.integer();
  job.job_key = row.text();
  ASSIGN_OR_RETURN(const JobKind kind, job_kind(row.integer()));
  job.kind = kind;
  job.heat_index = static_cast<std::uint32_t>(row.integer());
  switch (job.kind) {
    case JobKind::kHeat:
      break;
    case JobKind::kView:
      job.view.viewpoint_id = row.integer();
      for (auto* list : {&job.view.condition_index, &job.view.band_index}) {
        ASSIGN_OR_RETURN(*list, index_list(row.text()));
      }
      break;
  }
  return job;
}

absl::Status end_lease(Database& database, std::uint64_t fencing_token, std::int64_t job_id,
                       AttemptOutcome outcome, JobState state, const std::string& message,
                       const std::string& worker_name) {
  IRSIG_STORE_TRY(database.run(sql::end_attempt, fencing_token, static_cast<int>(outcome), message,
                               worker_name));
  return database.run(sql::set_job_state, job_id, static_cast<int>(state));
}

absl::Status end_lease_done(Database& database, std::uint64_t fencing_token, std::int64_t job_id,
                            const std::string& worker_name) {
  IRSIG_STORE_TRY(end_lease(database, fencing_token, job_id, AttemptOutcome::kDone, JobState::kDone,
                            "", worker_name));
  return database.run(sql::recount_needs_of_dependents, job_id);
}

absl::StatusOr<std::uint64_t> fail_lease(Database& database, std::uint64_t fencing_token,
                                         const LeasedJob& job, const std::string& worker_name,
                                         const std::string& message, bool for_good) {
  IRSIG_STORE_TRY(end_lease(database, fencing_token, job.job_id, AttemptOutcome::kFailed,
                            JobState::kWaiting, message, worker_name));
  ASSIGN_OR_RETURN(const std::int64_t failures, database.integer(sql::count_failure, job.job_id));
  ASSIGN_OR_RETURN(const std::int64_t workers,
                   database.integer(sql::count_failed_workers, job.job_id));
  if (!for_good && workers < kFailedWorkersToQuarantine && failures < kFailuresToQuarantine)
    return 0;
  IRSIG_STORE_TRY(
      database.run(sql::set_job_state, job.job_id, static_cast<int>(JobState::kQuarantined)));
  IRSIG_STORE_TRY(database.run(sql::quarantine_dependents, job.job_id));
  return 1 + database.changes();
}

absl::StatusOr<std::optional<KnownJob>> known_job(Database& database,
                                                  const std::string& sweep_sha256,
                                                  const std::string& job_key) {
  ASSIGN_OR_RETURN(const std::int64_t sweep_id, sweep_id_of(database, sweep_sha256));
  ASSIGN_OR_RETURN(Rows row, database.query(sql::known_job, sweep_id, job_key));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return std::nullopt;
  const std::int64_t job_id = row.integer();
  const std::uint64_t token = row.count();
  KnownJob known{{}, row.text(), row.text()};
  ASSIGN_OR_RETURN(QueuedJob job, queued_job(database, job_id, token));
  known.job = std::move(job);
  return known;
}

absl::StatusOr<std::uint64_t> lease_this_job(Database& database, const std::string& sweep_sha256,
                                             const std::string& job_key,
                                             const std::string& worker_id, double now_s) {
  ASSIGN_OR_RETURN(const std::int64_t sweep_id, sweep_id_of(database, sweep_sha256));
  const absl::StatusOr<std::int64_t> job_id =
      database.integer(sql::job_open_to_a_result, sweep_id, job_key);
  if (absl::IsNotFound(job_id.status()))
    return absl::FailedPreconditionError(
        absl::StrCat("the job ", job_key, " is neither waiting nor quarantined"));
  if (!job_id.ok()) return job_id.status();
  ASSIGN_OR_RETURN(const std::int64_t token,
                   database.integer(sql::insert_attempt, *job_id, worker_id, now_s));
  IRSIG_STORE_TRY(database.run(sql::set_job_state, *job_id, static_cast<int>(JobState::kLeased)));
  IRSIG_STORE_TRY(database.run(sql::revive_dependents, *job_id));
  return static_cast<std::uint64_t>(token);
}

absl::StatusOr<std::vector<std::uint64_t>> running_lease_tokens(Database& database) {
  std::vector<std::uint64_t> tokens;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::running_tokens));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return tokens;
    tokens.push_back(row.count());
  }
}

absl::Status release_all_leases(Database& database) {
  IRSIG_STORE_TRY(database.run(sql::release_all_attempts));
  return database.run(sql::release_all_jobs);
}

absl::StatusOr<std::int64_t> sweep_id_of(Database& database, const std::string& sweep_sha256) {
  return database.integer(sql::sweep_id_by_sha256, sweep_sha256);
}

absl::StatusOr<std::vector<std::int64_t>> part_ids(Database& database, std::int64_t sweep_id) {
  std::vector<std::int64_t> ids;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::part_ids, sweep_id));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return ids;
    ids.push_back(row.integer());
  }
}

absl::StatusOr<std::uint64_t> cancel_sweep(Database& database, const std::string& sweep_sha256) {
  const absl::StatusOr<std::int64_t> sweep_id = sweep_id_of(database, sweep_sha256);
  if (absl::IsNotFound(sweep_id.status())) {
    return absl::NotFoundError(absl::StrCat("no sweep ", sweep_sha256, " in this database"));
  }
  if (!sweep_id.ok()) return sweep_id.status();
  IRSIG_STORE_TRY(database.run(sql::revoke_leases, *sweep_id));
  IRSIG_STORE_TRY(database.run(sql::cancel_jobs, *sweep_id));
  return database.changes();
}

absl::StatusOr<std::vector<std::string>> failures_of_sweep(Database& database,
                                                           std::int64_t sweep_id,
                                                           std::uint64_t quarantined) {
  std::vector<std::string> failures;
  std::uint64_t told = 0;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::failures_of_sweep, sweep_id, kMostFailures + 1));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return failures;
    if (failures.size() == kMostFailures) {
      failures.push_back(absl::StrCat("and ", quarantined - told, " more"));
      return failures;
    }
    const std::int64_t first = row.integer(), last = row.integer(), jobs = row.integer();
    told += static_cast<std::uint64_t>(jobs);
    const std::string season = row.text(), worker_name = row.text();
    const std::string message = shortened(row.text());
    const std::string which =
        absl::StrCat(jobs == 1 ? absl::StrCat("job ", first)
                               : absl::StrCat(jobs, " jobs (", first, " to ", last, ")"),
                     season.empty() ? "" : absl::StrCat(" (temperatures of \"", season, "\")"));
    failures.push_back(row.is_null()
                           ? absl::StrCat(which, " on ", worker_name, ": ", message)
                           : absl::StrCat(which, ": ", jobs == 1 ? "needs" : "need", " job ",
                                          row.integer(), ", which was given up"));
  }
}

absl::StatusOr<std::vector<CountedSweep>> count_sweeps(Database& database,
                                                       std::optional<std::int64_t> only) {
  std::vector<CountedSweep> sweeps;
  ASSIGN_OR_RETURN(Rows row, database.query(sql::progress, only));
  for (;;) {
    ASSIGN_OR_RETURN(const bool found, row.next());
    if (!found) return sweeps;
    CountedSweep& sweep = sweeps.emplace_back();
    sweep.progress.name = row.text();
    sweep.progress.sweep_sha256 = row.text();
    sweep.progress.jobs = row.count();
    sweep.progress.waiting = row.count();
    sweep.progress.leased = row.count();
    sweep.progress.done = row.count();
    sweep.progress.quarantined = row.count();
    sweep.progress.cancelled = row.count();
    sweep.progress.rays = row.count();
    sweep.progress.worst_relative_error = row.real();
    sweep.sweep_id = row.integer();
    sweep.progress.heat_jobs = row.count();
    sweep.progress.heat_done = row.count();
    sweep.determinism_class = row.text();
    sweep.progress.priority = static_cast<int>(row.integer());
  }
}

absl::StatusOr<std::vector<SweepProgress>> sweep_progress(Database& database) {
  ASSIGN_OR_RETURN(std::vector<CountedSweep> counted, count_sweeps(database, std::nullopt));
  std::vector<SweepProgress> sweeps;
  for (CountedSweep& sweep : counted) {
    if (sweep.progress.quarantined > 0) {
      ASSIGN_OR_RETURN(std::vector<std::string> failures,
                       failures_of_sweep(database, sweep.sweep_id, sweep.progress.quarantined));
      sweep.progress.failures = std::move(failures);
    }
    sweeps.push_back(std::move(sweep.progress));
  }
  return sweeps;
}

}  // namespace irsig
