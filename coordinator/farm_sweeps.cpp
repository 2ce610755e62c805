// The part of the farm that users talk to: what is submitted, how far it is, what becomes of it.
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/farm.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "jobs/keys/expand.h"
#include "jobs/keys/size_limits.h"

namespace irsig {
namespace {

constexpr int kMostWorkersTold = 1000;
constexpr std::size_t kMostHeldBytes = 256 << 20;  // of assets, between their calls

StoredPrediction as_stored(const schema::Prediction& message, const std::string& sweep_sha256) {
  return {.sweep_sha256 = sweep_sha256,
          .made_unix_s = message.made_unix_s(),
          .determinism_class = message.determinism_class(),
          .workers = message.workers(),
          .pilot_viewpoints = message.pilot_viewpoints(),
          .pilot_cpu_s = message.pilot_cpu_s(),
          .jobs = message.jobs(),
          .cpu_s = message.cpu_s(),
          .wall_s = message.wall_s(),
          .job_cpu_quartile1_s = message.job_cpu_quartile1_s(),
          .job_cpu_median_s = message.job_cpu_median_s(),
          .job_cpu_quartile3_s = message.job_cpu_quartile3_s(),
          .database_bytes = message.database_bytes()};
}

// Returns an error if the prediction has values that no pilot can produce.
absl::Status check_prediction(const schema::Prediction& p) {
  const auto wrong = [](const char* field, const char* expected) {
    return absl::InvalidArgumentError(
        absl::StrCat("the prediction's ", field, ", expected ", expected));
  };
  if (p.determinism_class().size() > kLongestName || !is_one_line(p.determinism_class()))
    return wrong("determinism_class", "a line of text");
  constexpr std::uint64_t kMostOfAnything = 1'000'000'000'000'000;
  for (const auto& [field, count] : {std::pair<const char*, std::uint64_t>{"workers", p.workers()},
                                     {"pilot_viewpoints", p.pilot_viewpoints()},
                                     {"jobs", p.jobs()},
                                     {"database_bytes", p.database_bytes()}})
    if (count == 0 || count > kMostOfAnything) return wrong(field, "1 to 1e15");
  for (const auto& [field, time_s] :
       {std::pair<const char*, double>{"made_unix_s", p.made_unix_s()},
        {"pilot_cpu_s", p.pilot_cpu_s()},
        {"cpu_s", p.cpu_s()},
        {"wall_s", p.wall_s()},
        {"job_cpu_quartile1_s", p.job_cpu_quartile1_s()},
        {"job_cpu_median_s", p.job_cpu_median_s()},
        {"job_cpu_quartile3_s", p.job_cpu_quartile3_s()}})
    if (!(time_s >= 0 && time_s < 1e15)) return wrong(field, "0 to 1e15");
  if (p.job_cpu_quartile1_s() > p.job_cpu_median_s() ||
      p.job_cpu_median_s() > p.job_cpu_quartile3_s())
    return wrong("quartiles", "them in their order");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Submission> make_submission(const SweepCheck& check_sweep,
                                           schema::ResolvedSweep sweep,
                                           std::uint32_t physics_version,
                                           std::vector<Asset> assets) {
  if (physics_version == 0) {
    return absl::InvalidArgumentError("a sweep is submitted with its physics_version");
  }
  RETURN_IF_ERROR(check_sweep(sweep));
  for (const auto& asset : assets) {
    if ((asset.file ? asset.file->sha256() : sha256_hex(asset.bytes)) != asset.sha256) {
      return absl::InvalidArgumentError(
          absl::StrCat("the asset ", asset.sha256, " arrived damaged: its hash is another one"));
    }
  }
  Submission out;
  out.sweep_sha256 = sha256_hex(canonical_encoding(sweep));
  out.physics_version = physics_version;
  out.jobs = expand_jobs(sweep, static_cast<int>(physics_version));
  out.assets = std::move(assets);
  out.sweep = std::move(sweep);
  return out;
}

absl::StatusOr<std::shared_ptr<const std::string>> Farm::asset(const std::string& sha256) {
  if (const auto found = assets_.find(sha256); found != assets_.end()) return found->second;
  ASSIGN_OR_RETURN(auto bytes, store_.asset(sha256));
  std::size_t held = bytes.size();
  for (const auto& [other, there] : assets_) held += there->size();
  if (held > kMostHeldBytes) assets_.clear();  // those under way are held by their calls
  auto kept = std::make_shared<const std::string>(std::move(bytes));
  assets_.emplace(sha256, kept);
  return kept;
}

absl::StatusOr<schema::SubmitReply> Farm::submit(const Submission& submission) {
  // Before anything is written: what a refused request has written stays.
  if (submission.priority) RETURN_IF_ERROR(check_priority(*submission.priority));
  if (submission.prediction) RETURN_IF_ERROR(check_prediction(*submission.prediction));
  ASSIGN_OR_RETURN(const auto added, store_.add_sweep(submission.sweep, submission.sweep_sha256,
                                                      submission.jobs, submission.assets));
  if (submission.prediction) {
    RETURN_IF_ERROR(
        store_.store_prediction(as_stored(*submission.prediction, submission.sweep_sha256)));
  }
  RETURN_IF_ERROR(store_.set_physics_version(submission.sweep_sha256, submission.physics_version));
  if (submission.priority)
    RETURN_IF_ERROR(store_.set_priority(submission.sweep_sha256, *submission.priority));
  all_settled_.reset();
  sweeps_.erase(submission.sweep_sha256);
  remember(submission.sweep_sha256, submission.sweep).physics_version = submission.physics_version;
  schema::SubmitReply reply;
  reply.set_sweep_sha256(submission.sweep_sha256);
  reply.set_jobs(added.jobs);
  reply.set_jobs_to_compute(added.to_compute);
  log_line(LogLevel::info, {.sweep = submission.sweep.sweep().name()},
           "{} jobs, {} to compute (sha256 {})", added.jobs, added.to_compute,
           submission.sweep_sha256);
  return reply;
}

absl::StatusOr<schema::StatusReply> Farm::status() {
  ASSIGN_OR_RETURN(const auto sweeps, store_.progress());
  schema::StatusReply reply;
  for (const auto& sweep : sweeps) {
    auto* out = reply.add_sweep();
    out->set_name(sweep.name);
    out->set_sweep_sha256(sweep.sweep_sha256);
    out->set_jobs(sweep.jobs);
    out->set_done(sweep.done);
    out->set_leased(sweep.leased);
    out->set_quarantined(sweep.quarantined);
    out->set_cancelled(sweep.cancelled);
    out->set_rays(sweep.rays);
    out->set_worst_relative_error(sweep.worst_relative_error);
    for (const auto& failure : sweep.failures) out->add_failure(failure);
    out->set_heat_jobs(sweep.heat_jobs);
    out->set_heat_done(sweep.heat_done);
    out->set_priority(sweep.priority);
    if (const auto rate = rates_.find(sweep.sweep_sha256); rate != rates_.end())
      out->set_done_per_s(rate->second.per_s(clock_()));
  }
  reply.set_workers(static_cast<std::uint32_t>(sessions_.size()));
  for (const auto& [name, reason] : aside_) {
    if (reply.worker_size() >= kMostWorkersTold) break;
    auto* out = reply.add_worker();
    out->set_name(name);
    out->set_state(schema::WorkerStatus::STATE_SET_ASIDE);
    out->set_reason(reason);
  }
  for (const auto& [id, session] : sessions_) {
    if (session.state == SessionState::kAside || reply.worker_size() >= kMostWorkersTold) continue;
    auto* out = reply.add_worker();
    out->set_name(session.worker_name);
    out->set_host(session.host);
    out->set_determinism_class(session.determinism_class);
    out->set_memory_bytes(session.memory_bytes);
    out->set_state(schema::WorkerStatus::STATE_IDLE);
    if (session.state != SessionState::kComputing) continue;
    out->set_state(schema::WorkerStatus::STATE_COMPUTING);
    out->set_job_key(session.job.job_key);
    out->set_job_s(clock_() - session.leased_at_s);
  }
  for (const std::string& line : differing_) reply.add_warning(line);
  for (const std::string& line : recent_failures_) reply.add_recent_failure(line);
  for (const auto& [name, its_class] : of_other_class_)
    reply.add_warning(absl::StrCat("worker ", name, " computes nothing: it is of the determinism ",
                                   "class \"", its_class, "\", the database of another one"));
  reply.set_audited(double_check_.audited());
  ASSIGN_OR_RETURN(const auto aside, store_.results_aside());
  reply.set_differing(aside);
  return reply;
}

absl::StatusOr<schema::CancelReply> Farm::cancel(const std::string& sweep_sha256) {
  ASSIGN_OR_RETURN(const auto cancelled, store_.cancel(sweep_sha256));
  all_settled_.reset();
  schema::CancelReply reply;
  reply.set_cancelled(cancelled);
  return reply;
}

absl::StatusOr<schema::PrioritizeReply> Farm::prioritize(const schema::PrioritizeRequest& request) {
  RETURN_IF_ERROR(store_.set_priority(request.sweep_sha256(), request.priority()));
  log_line(LogLevel::info, {}, "priority {} (sha256 {})", request.priority(),
           request.sweep_sha256());
  return schema::PrioritizeReply();
}

}  // namespace irsig
