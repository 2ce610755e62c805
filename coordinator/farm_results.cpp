// Handling of worker replies: results, which are accepted by their content, and failures.
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "coordinator/farm.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "schema/store/tables/content.h"

namespace irsig {
namespace {

// As the store counts: failures on so many distinct workers quarantine a job.
constexpr std::size_t kFailuresToQuarantine = 3;
// So many jobs that failed on one worker, and that others have done, are the worker's fault.
constexpr std::size_t kFailuresAloneToSetAside = 3;
constexpr std::size_t kMostDifferingTold = 20, kMostRecentFailures = 20, kMostRates = 1000;

std::string short_key(const std::string& key) { return key.substr(0, 12); }

// Returns the worker's message, cut off at a readable length.
std::string short_message(const std::string& message) {
  constexpr std::size_t kMost = 4000;
  if (message.size() <= kMost) return message;
  return absl::StrCat(message.substr(0, kMost), " ... (", message.size(), " bytes)");
}

std::string in_gb(std::uint64_t bytes) {
  return absl::StrCat(std::round(static_cast<double>(bytes) / 1e8) / 10, " GB");
}

schema::CompleteReply complete_reply(schema::CompleteReply::State state) {
  schema::CompleteReply reply;
  reply.set_state(state);
  return reply;
}

std::string content_of(const Returned& returned) {
  return returned.content_sha256.empty() ? content_sha256(returned.result)
                                         : returned.content_sha256;
}

}  // namespace

absl::StatusOr<schema::CompleteReply> Farm::complete(const Returned& returned) {
  ASSIGN_OR_RETURN(const auto heard, hear(returned.worker_id));
  Session& session = *heard;
  const bool own = session.state == SessionState::kComputing && returned.fencing_token != 0 &&
                   returned.fencing_token == session.fencing_token;
  const auto& step = next(session.state, own ? SessionEvent::kResult : SessionEvent::kOtherResult);
  session.state = step.next;
  if (step.action != SessionAction::kTake)
    return absl::AbortedError(
        absl::StrCat("this worker was set aside: ", aside_[session.worker_name]));
  all_settled_.reset();
  const JobName job = own ? session.job : JobName{returned.sweep_sha256, returned.result.job_key()};
  const std::uint64_t lease = own && !session.is_duplicate ? session.fencing_token : 0;
  absl::Status stored = returned.checked;
  if (stored.ok()) stored = check_against_session(session, job.sweep_sha256, returned.result);
  auto reply = complete_reply(schema::CompleteReply::STATE_STORED);
  if (stored.ok() && lease != 0) {
    stored = store_.complete(lease, returned.result, session.worker_name, content_of(returned));
    if (stored.ok()) {
      stragglers_.took(clock_() - session.leased_at_s);
      stored = was_stored(session, job);
    }
  }
  // The lease is no longer the job's, or there was none.
  if (stored.ok() ? lease == 0 : absl::IsFailedPrecondition(stored)) {
    auto taken = take(session, job, returned);
    stored = taken.status();
    if (taken.ok()) reply = *taken;
  }
  if (own) {
    leases_.release(returned.worker_id);
    if (absl::IsInvalidArgument(stored)) {
      RETURN_IF_ERROR(
          count_failure(session, std::string(stored.message()), schema::FailRequest::KIND_OTHER));
    }
    session.fencing_token = 0;
  }
  if (absl::IsInvalidArgument(stored))
    log_line(LogLevel::warn, {.job_key = job.job_key, .worker = session.worker_name},
             "result refused: {}", stored.ToString());
  if (!stored.ok()) return stored;
  return reply;
}

// Checks the facts about a result that the store does not know: the worker that computed it, the
// length of its spectra and the size of its pictures.
absl::Status Farm::check_against_session(const Session& session, const std::string& sweep_sha256,
                                         const schema::JobResult& result) {
  if (result.determinism_class() != session.determinism_class)
    return absl::InvalidArgumentError(
        absl::StrCat("the result is of the determinism class \"", result.determinism_class(),
                     "\", its worker registered as \"", session.determinism_class, "\""));
  if (result.physics_version() != session.physics_version)
    return absl::InvalidArgumentError(
        absl::StrCat("the result is of physics version ", result.physics_version(),
                     ", its worker registered with ", session.physics_version));
  const auto known = sweeps_.find(sweep_sha256);
  if (known == sweeps_.end()) return absl::OkStatus();
  const SweepRules& rules = known->second;
  for (const schema::SignatureRow& row : result.view().row()) {
    const auto wavelengths = static_cast<std::size_t>(row.spectrum().lambda_um_size());
    if (row.band_index() < rules.wavelengths.size() &&
        wavelengths != rules.wavelengths[row.band_index()])
      return absl::InvalidArgumentError(
          absl::StrCat("result: a spectrum of band ", row.band_index(), " has ", wavelengths,
                       " wavelengths, its sweep asks for ", rules.wavelengths[row.band_index()]));
    if (std::max(row.thumbnail().width_px(), row.thumbnail().height_px()) > rules.thumbnail_px)
      return absl::InvalidArgumentError(absl::StrCat(
          "result: a thumbnail is ", row.thumbnail().width_px(), " x ", row.thumbnail().height_px(),
          " pixels, its sweep asks for ", rules.thumbnail_px));
  }
  return absl::OkStatus();
}

// By what it is, whoever holds the lease.
absl::StatusOr<schema::CompleteReply> Farm::take(const Session& session, const JobName& job,
                                                 const Returned& returned) {
  const auto known = store_.find_job(job.sweep_sha256, job.job_key);
  if (absl::IsNotFound(known.status()))
    return complete_reply(schema::CompleteReply::STATE_UNKNOWN_SWEEP);
  if (!known.ok()) return known.status();
  if (!known->has_value()) return complete_reply(schema::CompleteReply::STATE_NOT_WANTED);
  switch (next((*known)->job.state, JobEvent::kResult).action) {
    case JobAction::kStore:
      return store_now(session, job, **known, returned);
    case JobAction::kCompare:
      return compare(session, job, **known, returned);
    case JobAction::kDrop:
    case JobAction::kNone:
    case JobAction::kRefuse:
      break;
  }
  return complete_reply(schema::CompleteReply::STATE_NOT_WANTED);
}

absl::StatusOr<schema::CompleteReply> Farm::store_now(const Session& session, const JobName& job,
                                                      const KnownJob& known,
                                                      const Returned& returned) {
  // Its sweep is known from here on, so that lengths and sizes can be looked at.
  auto status = admit(session, job);
  if (status.ok()) status = check_against_session(session, job.sweep_sha256, returned.result);
  if (status.ok() && known.job.fencing_token != 0)
    status = store_.release(known.job.fencing_token, "another worker's result came first");
  if (!status.ok()) return status;
  ASSIGN_OR_RETURN(const auto token, store_.lease_job(job.sweep_sha256, job.job_key,
                                                      returned.worker_id, unix_clock_()));
  status = store_.complete(token, returned.result, session.worker_name, content_of(returned));
  if (!status.ok()) {
    // It waits again, as if nothing had come.
    RETURN_IF_ERROR(store_.release(token, "a result that was refused"));
    return status;
  }
  if (status = was_stored(session, job); !status.ok()) return status;
  return complete_reply(schema::CompleteReply::STATE_STORED);
}

absl::StatusOr<schema::CompleteReply> Farm::compare(const Session& session, const JobName& job,
                                                    const KnownJob& known,
                                                    const Returned& returned) {
  const std::string content = content_of(returned);
  const std::string of_job = absl::StrCat("its result of job ", short_key(job.job_key));
  if (known.content_sha256.empty() || content == known.content_sha256) {
    // A result of an older version cannot be compared; a repeated result of the same worker proves
    // nothing.
    if (!known.content_sha256.empty() && known.worker_name != session.worker_name)
      if (const auto verdict = double_check_.agrees(job, content))
        RETURN_IF_ERROR(contradicted(
            verdict->wrong, absl::StrCat(of_job, " differs from that of two other workers")));
    return complete_reply(schema::CompleteReply::STATE_KNOWN);
  }
  ASSIGN_OR_RETURN(const auto kept,
                   store_.store_conflicting_result(job.sweep_sha256, returned.result, content,
                                                   session.worker_name, unix_clock_()));
  const std::string what =
      absl::StrCat("two results of job ", short_key(job.job_key), " differ: of ", known.worker_name,
                   ", which is stored, and of ", session.worker_name,
                   kept ? ", which is kept aside" : ", of which there is no more room aside");
  log_line(LogLevel::err, {.job_key = job.job_key}, what);
  if (differing_.size() < kMostDifferingTold) differing_.push_back(what);
  const auto verdict = double_check_.differs(job, known.content_sha256, known.worker_name, content,
                                             session.worker_name);
  if (verdict.kind == DoubleCheck::Verdict::Kind::kUndecided)
    return complete_reply(schema::CompleteReply::STATE_ASIDE);
  RETURN_IF_ERROR(
      contradicted(verdict.wrong, absl::StrCat(of_job, " differs from that of two other workers")));
  RETURN_IF_ERROR(store_.reopen(job.sweep_sha256, job.job_key));
  KnownJob waiting = known;
  waiting.job.fencing_token = 0;
  return store_now(session, job, waiting, returned);
}

absl::Status Farm::was_stored(const Session& session, const JobName& job) {
  log_line(LogLevel::debug, {.job_key = job.job_key, .worker = session.worker_name}, "stored");
  losses_.erase(job.job_key);
  out_of_memory_.erase(job.job_key);
  if (rates_.size() < kMostRates || rates_.contains(job.sweep_sha256))
    rates_[job.sweep_sha256].happened(clock_());
  if (double_check_.chosen(job) && somebody_besides({session.worker_name}))
    double_check_.ask_for(job, {session.worker_name});
  const auto failed = failed_on_.find(job.job_key);
  if (failed == failed_on_.end()) return absl::OkStatus();
  const std::set<std::string> workers = std::move(failed->second);
  failed_on_.erase(failed);
  if (workers.contains(session.worker_name)) return absl::OkStatus();  // luck, good or bad
  for (const std::string& worker : workers) {
    auto& jobs = failed_alone_[worker];
    jobs.insert(job.job_key);
    if (jobs.size() < kFailuresAloneToSetAside) continue;
    if (auto status = set_aside(
            worker, absl::StrCat(jobs.size(), " jobs failed on it and were done by others: ",
                                 absl::StrJoin(jobs, ", ",
                                               [](std::string* out, const std::string& key) {
                                                 absl::StrAppend(out, short_key(key));
                                               })));
        !status.ok())
      return status;
  }
  return absl::OkStatus();
}

bool Farm::somebody_besides(const std::set<std::string>& workers) const {
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return session.second.state != SessionState::kAside &&
           !workers.contains(session.second.worker_name);
  });
}

// Sets the worker aside and reopens all jobs that it computed: their results are as doubtful, so
// that other workers compute them again.
absl::Status Farm::contradicted(const std::string& worker_name, const std::string& reason) {
  if (aside_.contains(worker_name)) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto again, store_.reopen_all_of(worker_name));
  all_settled_.reset();
  return set_aside(worker_name,
                   again == 0 ? reason
                              : absl::StrCat(reason, "; what it had computed (", again,
                                             again == 1 ? " job" : " jobs", ") is computed again"));
}

absl::Status Farm::set_aside(const std::string& worker_name, const std::string& reason) {
  failed_alone_.erase(worker_name);
  if (!aside_.emplace(worker_name, reason).second) return absl::OkStatus();
  log_line(LogLevel::err, {.worker = worker_name}, "set aside: {}", reason);
  for (auto& [id, session] : sessions_) {
    if (session.worker_name != worker_name) continue;
    const auto& step = next(session.state, SessionEvent::kDistrust);
    if (step.action == SessionAction::kRelease)
      RETURN_IF_ERROR(end_lease(session, "its worker was set aside", false));
    session.state = step.next;
    leases_.release(id);
  }
  return absl::OkStatus();
}

absl::Status Farm::fail(const schema::FailRequest& request) {
  ASSIGN_OR_RETURN(const auto heard, hear(request.worker_id()));
  Session& session = *heard;
  const bool own = session.state == SessionState::kComputing && request.fencing_token() != 0 &&
                   request.fencing_token() == session.fencing_token;
  const auto& step =
      next(session.state, own ? SessionEvent::kFailure : SessionEvent::kForeignFailure);
  session.state = step.next;
  if (step.action != SessionAction::kCountFailure) {
    return absl::FailedPreconditionError("the lease of this failure is not current");
  }
  all_settled_.reset();
  leases_.release(request.worker_id());
  const auto status = count_failure(session, short_message(request.message()), request.kind());
  session.fencing_token = 0;
  return status;
}

// Two workers of one machine differ by what is free at the moment.
bool Farm::has_more_memory(const Session& session, std::uint64_t bytes) {
  return session.state != SessionState::kAside && session.memory_bytes / 5 * 4 > bytes;
}

bool Farm::somebody_has_more_memory(std::uint64_t bytes) const {
  return std::any_of(sessions_.begin(), sessions_.end(),
                     [&](const auto& session) { return has_more_memory(session.second, bytes); });
}

// A job that fails again on the same worker, because there is no other one to try it, counts as
// failed on one more: with fewer than three workers it would never settle otherwise.
absl::Status Farm::count_failure(Session& session, const std::string& message,
                                 schema::FailRequest::Kind kind) {
  const std::string& key = session.job.job_key;
  log_line(LogLevel::warn, about(session), "failed: {}", message);
  if (session.is_duplicate) return absl::OkStatus();  // the first one goes on, or has done it
  std::string counted_as = session.worker_name, why = message;
  bool for_good = false;
  switch (kind) {
    case schema::FailRequest::KIND_BAD_INPUT:
    case schema::FailRequest::KIND_GUARD:
      for_good = true;
      break;
    case schema::FailRequest::KIND_OUT_OF_MEMORY: {
      const auto [tried, first] = out_of_memory_.emplace(key, session.memory_bytes);
      for_good = !first || !somebody_has_more_memory(session.memory_bytes);
      why = absl::StrCat(message, " (", in_gb(session.memory_bytes),
                         first && for_good ? "; no worker has more)" : ")");
      break;
    }
    default: {
      auto& workers = failed_on_[key];
      for (int attempt = 2; workers.contains(counted_as); ++attempt)
        counted_as = absl::StrCat(session.worker_name, " (attempt ", attempt, ")");
      workers.insert(counted_as);
      for_good = workers.size() >= kFailuresToQuarantine;
    }
  }
  auto status = store_.fail(session.fencing_token, counted_as, why, for_good);
  if (absl::IsFailedPrecondition(status)) status = absl::OkStatus();  // cancelled meanwhile
  if (!for_good) {
    recent_failures_.push_back(absl::StrCat("job ", short_key(key), " on ", session.worker_name,
                                            ": ", why.substr(0, 500)));
    if (recent_failures_.size() > kMostRecentFailures) recent_failures_.pop_front();
  }
  if (for_good) {
    failed_on_.erase(key);
    out_of_memory_.erase(key);
    losses_.erase(key);
  }
  return status;
}

}  // namespace irsig
