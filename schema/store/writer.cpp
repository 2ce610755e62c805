#include "schema/store/writer.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "schema/store/ingest.h"
#include "schema/store/ingest_heat.h"
#include "schema/store/open_database.h"
#include "schema/store/progress_counters.h"
#include "schema/store/queue.h"
#include "schema/store/sweep_table.h"
#include "schema/store/tables/content.h"
#include "schema/store/tables/cost.h"
#include "schema/store/tables/statements.h"
#include "schema/store/tables/stored_asset.h"

namespace irsig {
namespace {

constexpr int kPatienceAtTheEnd_ms = 1000;

absl::StatusOr<std::string> resolved_sweep(Database& database, const std::string& sha256) {
  ASSIGN_OR_RETURN(Rows row, database.query(sql::resolved_sweep_by_sha256, sha256));
  ASSIGN_OR_RETURN(const bool found, row.next());
  if (!found) return absl::NotFoundError(absl::StrCat("no asset ", sha256));
  return row.text();
}

}  // namespace

StoreWriter::StoreWriter(WritableDatabase opened)
    : opened_(std::make_unique<WritableDatabase>(std::move(opened))),
      database_(*opened_->database),
      counters_(std::make_unique<ProgressCounters>()) {}

StoreWriter::~StoreWriter() {
  if (!opened_->database) return;
  rollback();
  leave_journal(*opened_);
}

absl::Status StoreWriter::begin() { return begin(true); }

absl::Status StoreWriter::begin_unsynced() { return begin(false); }

absl::Status StoreWriter::commit() { return database_.run("COMMIT"); }

void StoreWriter::rollback() {
  counters_->forget();
  if (database_.in_transaction()) static_cast<void>(database_.run("ROLLBACK"));
}

absl::Status StoreWriter::begin_request() { return database_.run("SAVEPOINT request"); }

absl::Status StoreWriter::keep_request() { return database_.run("RELEASE request"); }

absl::Status StoreWriter::undo_request() {
  IRSIG_STORE_TRY(require_transaction());
  counters_->forget();
  IRSIG_STORE_TRY(database_.run("ROLLBACK TO request"));
  return database_.run("RELEASE request");
}

absl::StatusOr<AddedJobs> StoreWriter::add_sweep(const schema::ResolvedSweep& sweep,
                                                 const std::string& sweep_sha256,
                                                 const std::vector<schema::JobSpec>& jobs,
                                                 const std::vector<Asset>& assets) {
  IRSIG_STORE_TRY(require_transaction());
  // Its keys are hashes: the index grows everywhere at once, and pages that do not fit are
  // written and read again, and again.
  const bool large = jobs.size() > 10000;
  if (large) IRSIG_STORE_TRY(database_.script("PRAGMA cache_size = -262144"));
  const absl::StatusOr<AddedJobs> added = store_sweep(database_, sweep, sweep_sha256, jobs, assets);
  if (large) IRSIG_STORE_TRY(database_.script("PRAGMA cache_size = -16384; PRAGMA shrink_memory"));
  if (added.ok()) IRSIG_STORE_TRY(counters_->recount(database_, sweep_sha256));
  return added;
}

absl::StatusOr<std::string> StoreWriter::asset(const std::string& sha256) {
  absl::StatusOr<std::string> bytes = read_asset(database_, sha256);
  if (!absl::IsNotFound(bytes.status())) return bytes;
  return resolved_sweep(database_, sha256);
}

absl::Status StoreWriter::store_prediction(const StoredPrediction& prediction) {
  IRSIG_STORE_TRY(require_transaction());
  return irsig::store_prediction(database_, prediction);
}

absl::StatusOr<std::optional<QueuedJob>> StoreWriter::lease_next(const std::string& worker_id,
                                                                 double now_s) {
  IRSIG_STORE_TRY(require_transaction());
  absl::StatusOr<std::optional<QueuedJob>> job = lease_next_job(database_, worker_id, now_s);
  if (job.ok() && job->has_value()) counters_->leased((*job)->spec.sweep_sha256());
  return job;
}

absl::Status StoreWriter::release(std::uint64_t fencing_token, const std::string& reason) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const LeasedJob job, leased_job(database_, fencing_token));
  IRSIG_STORE_TRY(end_lease(database_, fencing_token, job.job_id, AttemptOutcome::kReleased,
                            JobState::kWaiting, reason, ""));
  counters_->released(job.sweep_id);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::uint64_t>> StoreWriter::running_tokens() {
  return running_lease_tokens(database_);
}

absl::Status StoreWriter::release_all() {
  IRSIG_STORE_TRY(require_transaction());
  counters_->forget();
  return release_all_leases(database_);
}

absl::StatusOr<std::optional<KnownJob>> StoreWriter::find_job(const std::string& sweep_sha256,
                                                              const std::string& job_key) {
  return known_job(database_, sweep_sha256, job_key);
}

absl::StatusOr<std::uint64_t> StoreWriter::lease_job(const std::string& sweep_sha256,
                                                     const std::string& job_key,
                                                     const std::string& worker_id, double now_s) {
  IRSIG_STORE_TRY(require_transaction());
  // After a restart every worker returns what it had leased before: nothing is counted anew.
  ASSIGN_OR_RETURN(const auto known, known_job(database_, sweep_sha256, job_key));
  const bool waits = known.has_value() && known->job.state == JobState::kWaiting;
  const auto token = lease_this_job(database_, sweep_sha256, job_key, worker_id, now_s);
  if (waits && token.ok()) {
    counters_->leased(sweep_sha256);
  } else {
    counters_->forget();
  }
  return token;
}

absl::StatusOr<bool> StoreWriter::store_conflicting_result(const std::string& sweep_sha256,
                                                           const schema::JobResult& result,
                                                           const std::string& content,
                                                           const std::string& worker_name,
                                                           double now_s) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const std::uint64_t there, results_aside());
  if (there >= static_cast<std::uint64_t>(kMostAside)) return false;
  IRSIG_STORE_TRY(database_.run(sql::insert_result_aside, sweep_sha256, result.job_key(),
                                worker_name, now_s, content, Blob{result.SerializeAsString()}));
  return true;
}

absl::StatusOr<std::uint64_t> StoreWriter::results_aside() {
  ASSIGN_OR_RETURN(const std::int64_t count, database_.integer(sql::count_results_aside));
  return static_cast<std::uint64_t>(count);
}

absl::Status StoreWriter::reopen(const std::string& sweep_sha256, const std::string& job_key) {
  IRSIG_STORE_TRY(require_transaction());
  counters_->forget();
  return database_.run(sql::reopen_job, sweep_sha256, job_key);
}

absl::StatusOr<std::uint64_t> StoreWriter::reopen_all_of(const std::string& worker_name) {
  IRSIG_STORE_TRY(require_transaction());
  counters_->forget();
  IRSIG_STORE_TRY(database_.run(sql::reopen_jobs_of_worker, worker_name));
  const std::uint64_t jobs = database_.changes();
  IRSIG_STORE_TRY(database_.run(sql::recount_all_needs));
  return jobs;
}

absl::Status StoreWriter::fail(std::uint64_t fencing_token, const std::string& worker_name,
                               const std::string& message, bool for_good) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const LeasedJob job, leased_job(database_, fencing_token));
  ASSIGN_OR_RETURN(const std::uint64_t quarantined,
                   fail_lease(database_, fencing_token, job, worker_name, message, for_good));
  counters_->failed(job.sweep_id, quarantined);
  return absl::OkStatus();
}

absl::Status StoreWriter::complete(std::uint64_t fencing_token, const schema::JobResult& result,
                                   const std::string& worker_name, const std::string& content) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const LeasedJob job, leased_job(database_, fencing_token));
  IRSIG_STORE_TRY(store_result(database_, job, result, worker_name,
                               content.empty() ? content_sha256(result) : content));
  IRSIG_STORE_TRY(end_lease_done(database_, fencing_token, job.job_id, worker_name));
  counters_->done(job, result.rays(), worst_relative_error(result));
  return absl::OkStatus();
}

absl::StatusOr<std::uint64_t> StoreWriter::reopen_damaged() {
  IRSIG_STORE_TRY(require_transaction());
  counters_->forget();
  return reopen_damaged_heat_jobs(database_);
}

absl::StatusOr<bool> StoreWriter::take_over(std::uint64_t fencing_token,
                                            const std::string& determinism_class) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const LeasedJob job, leased_job(database_, fencing_token));
  const absl::StatusOr<bool> copied = copy_twin(database_, job, determinism_class);
  if (!copied.ok() || !*copied) return copied;
  IRSIG_STORE_TRY(end_lease_done(database_, fencing_token, job.job_id, "another sweep's"));
  counters_->done(job, 0, 0);  // of a heat job, at no cost
  return true;
}

absl::StatusOr<std::uint64_t> StoreWriter::cancel(const std::string& sweep_sha256) {
  IRSIG_STORE_TRY(require_transaction());
  const absl::StatusOr<std::uint64_t> jobs = cancel_sweep(database_, sweep_sha256);
  if (jobs.ok()) counters_->cancelled(sweep_sha256);
  return jobs;
}

absl::Status StoreWriter::set_physics_version(const std::string& sweep_sha256,
                                              std::uint32_t version) {
  IRSIG_STORE_TRY(require_transaction());
  return database_.run(sql::set_physics_version, sweep_sha256, version);
}

absl::StatusOr<std::uint32_t> StoreWriter::physics_version(const std::string& sweep_sha256) {
  ASSIGN_OR_RETURN(const auto version, database_.integer(sql::physics_version, sweep_sha256));
  return static_cast<std::uint32_t>(version);
}

absl::Status StoreWriter::set_priority(const std::string& sweep_sha256, int priority) {
  IRSIG_STORE_TRY(require_transaction());
  IRSIG_STORE_TRY(check_priority(priority));
  IRSIG_STORE_TRY(database_.run(sql::set_priority, sweep_sha256, priority));
  if (database_.changes() == 0)
    return absl::NotFoundError(absl::StrCat("no sweep ", sweep_sha256, " in this database"));
  counters_->prioritized(sweep_sha256, priority);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<SweepProgress>> StoreWriter::progress() {
  return counters_->all(database_);
}

absl::StatusOr<std::string> StoreWriter::determinism_class() {
  return counters_->bound_class(database_);
}

absl::Status StoreWriter::bind_determinism_class(const std::string& determinism_class) {
  IRSIG_STORE_TRY(require_transaction());
  ASSIGN_OR_RETURN(const std::string bound, counters_->bound_class(database_));
  if (!bound.empty() && bound != determinism_class) {
    return absl::FailedPreconditionError(
        absl::StrCat("the unfinished sweeps are bound to the determinism class \"", bound,
                     "\", not \"", determinism_class, "\""));
  }
  if (determinism_class.empty())
    return absl::InvalidArgumentError("a determinism class has a name");
  IRSIG_STORE_TRY(database_.run(sql::bind_determinism_class, determinism_class));
  counters_->bound(determinism_class);
  return absl::OkStatus();
}

absl::Status StoreWriter::finish() {
  if (database_.in_transaction())
    return absl::FailedPreconditionError("finish() inside a transaction");
  // A reader between two queries is waited for, one that stays is not.
  database_.wait_for_locks_ms(kPatienceAtTheEnd_ms);
  const absl::Status ended = end_write_ahead(*opened_);
  if (!absl::IsUnavailable(ended)) return ended;
  const std::string& path = opened_->path;
  return absl::UnavailableError(absl::StrCat(
      path, ": another program is reading it; everything is stored, but part of it may lie in ",
      path, "-wal, which belongs to the database until the next run folds it in"));
}

absl::StatusOr<bool> StoreWriter::remove_if_unused() {
  if (!opened_->created) return false;
  rollback();
  ASSIGN_OR_RETURN(const std::int64_t content, database_.integer(sql::content_count));
  if (content > 0 || !opened_->lock->holds()) return false;
  opened_->database.reset();
  remove_database(opened_->path);
  return true;
}

absl::Status StoreWriter::begin(bool synced) {
  if (synced != synced_)
    IRSIG_STORE_TRY(
        database_.script(synced ? "PRAGMA synchronous = FULL" : "PRAGMA synchronous = NORMAL"));
  synced_ = synced;
  return database_.run("BEGIN IMMEDIATE");
}

absl::Status StoreWriter::require_transaction() const {
  if (database_.in_transaction()) return absl::OkStatus();
  return absl::FailedPreconditionError("a change of the database outside begin() ... commit()");
}

absl::Status check_priority(int priority) {
  if (priority >= -kMostPriority && priority <= kMostPriority) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("a priority of ", priority, ", expected -",
                                                 kMostPriority, " to ", kMostPriority));
}

absl::StatusOr<std::unique_ptr<StoreWriter>> StoreWriter::open(const std::string& path) {
  ASSIGN_OR_RETURN(WritableDatabase opened, open_for_writing(path));
  return std::unique_ptr<StoreWriter>(new StoreWriter(std::move(opened)));
}

}  // namespace irsig
