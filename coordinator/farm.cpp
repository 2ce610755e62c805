#include "coordinator/farm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/printable.h"
#include "core/base/status_macros.h"
#include "jobs/keys/expand.h"
#include "jobs/keys/size_limits.h"

namespace irsig {
namespace {

// An idle worker asks again after this long: short against any job, long against a database query.
constexpr double kIdleWait_s = 0.2;
// Workers that a job may be lost with, one after the other, before it is given up.
constexpr std::size_t kLossesToQuarantine = 3;
// A fencing token that is no lease of the queue: of a job that is computed for the second time.
constexpr std::uint64_t kDuplicate = std::uint64_t{1} << 63;
constexpr std::size_t kMostOfOtherClassTold = 20;
constexpr std::size_t kMostSessions = 10000;
constexpr std::size_t kMostSweepsInMind = 100;
constexpr std::size_t kMostVersionsInMind = 20;

bool has_key(const std::vector<schema::JobSpec>& jobs, const std::string& job_key) {
  return std::any_of(jobs.begin(), jobs.end(),
                     [&](const schema::JobSpec& spec) { return spec.job_key() == job_key; });
}

}  // namespace

Farm::Farm(StoreWriter& store, const FarmRules& rules, Clock clock, Clock unix_clock,
           std::string coordinator_id, SweepCheck check_sweep)
    : store_(store),
      rules_(rules),
      clock_(std::move(clock)),
      unix_clock_(std::move(unix_clock)),
      coordinator_id_(std::move(coordinator_id)),
      check_sweep_(std::move(check_sweep)),
      checked_at_s_(clock_()),
      double_check_(rules.audit_fraction, coordinator_id_) {}

absl::StatusOr<schema::RegisterReply> Farm::register_worker(
    const schema::RegisterRequest& request) {
  if (request.worker_name().empty() || request.determinism_class().empty() ||
      request.physics_version() == 0) {
    return absl::InvalidArgumentError(
        "a worker registers with its name, its determinism class and its physics version");
  }
  for (const auto& [what, text] :
       {std::pair<const char*, const std::string&>{"worker_name", request.worker_name()},
        {"determinism_class", request.determinism_class()},
        {"build_id", request.build_id()},
        {"host", request.host()}}) {
    if (text.size() > kLongestName || !is_one_line(text))
      return absl::InvalidArgumentError(
          absl::StrCat(what, " has ", text.size(),
                       " bytes or control characters, expected a line of at most ", kLongestName));
  }
  if (sessions_.size() >= kMostSessions)
    return absl::FailedPreconditionError(
        absl::StrCat("there are ", kMostSessions, " workers already"));
  if (const auto aside = aside_.find(request.worker_name()); aside != aside_.end())
    return absl::AbortedError(absl::StrCat("this worker was set aside: ", aside->second));
  Session session{.worker_name = request.worker_name(),
                  .host = request.host(),
                  .determinism_class = request.determinism_class(),
                  .physics_version = request.physics_version(),
                  .memory_bytes = request.memory_bytes(),
                  .heard_at_s = clock_()};
  RETURN_IF_ERROR(check_class(session));
  of_other_class_.erase(session.worker_name);
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    if (it->second.worker_name != request.worker_name()) {
      ++it;
      continue;
    }
    const auto& step = next(it->second.state, SessionEvent::kSuccessor);
    if (step.action == SessionAction::kRelease) {
      RETURN_IF_ERROR(end_lease(it->second, "its worker was started again", true));
    }
    leases_.forget(it->first);
    it = sessions_.erase(it);
  }
  schema::RegisterReply reply;
  reply.set_worker_id(absl::StrCat(coordinator_id_, "-", ++registrations_));
  reply.set_heartbeat_s(rules_.heartbeat_s);
  leases_.registered(reply.worker_id());
  log_line(LogLevel::debug, {.worker = session.worker_name}, "registered: {}, {} bytes of memory",
           session.determinism_class, session.memory_bytes);
  sessions_.emplace(reply.worker_id(), std::move(session));
  return reply;
}

absl::StatusOr<Farm::Session*> Farm::hear(const std::string& worker_id) {
  const auto found = sessions_.find(worker_id);
  if (found == sessions_.end()) {
    return absl::NotFoundError(absl::StrCat("unknown worker \"", worker_id, "\": register again"));
  }
  found->second.heard_at_s = clock_();
  return &found->second;
}

absl::StatusOr<schema::LeaseReply> Farm::lease(const schema::LeaseRequest& request) {
  ASSIGN_OR_RETURN(const auto heard, hear(request.worker_id()));
  Session& session = *heard;
  const auto& step = next(session.state, SessionEvent::kAskForJob);
  session.state = step.next;
  if (step.action == SessionAction::kRefuse)
    return absl::AbortedError(
        absl::StrCat("this worker was set aside: ", aside_[session.worker_name]));
  if (step.action == SessionAction::kReleaseThenLease && !session.is_duplicate) {
    if (auto status = store_.release(session.fencing_token, "its worker asked for another job");
        !status.ok() && !absl::IsFailedPrecondition(status)) {
      return status;
    }
    all_settled_.reset();
  }
  leases_.release(request.worker_id());
  schema::LeaseReply reply;
  auto job = audit_for(session);
  if (!job.ok()) return job.status();
  bool is_duplicate = job->has_value();
  if (!is_duplicate && !(all_settled_ && *all_settled_)) {
    RETURN_IF_ERROR(check_class(session));
    job = next_to_compute(request.worker_id(), session);
    if (!job.ok()) return job.status();
    if (!job->has_value()) {
      job = straggling_job_for(session);
      if (!job.ok()) return job.status();
      is_duplicate = job->has_value();
    }
  }
  if (!job->has_value()) {
    ASSIGN_OR_RETURN(const auto finished, all_settled());
    reply.set_state(finished ? schema::LeaseReply::STATE_FINISHED : schema::LeaseReply::STATE_WAIT);
    reply.set_wait_s(kIdleWait_s);
    return reply;
  }
  session.state = SessionState::kComputing;
  session.fencing_token = (*job)->fencing_token;
  session.job = {(*job)->spec.sweep_sha256(), (*job)->spec.job_key()};
  session.is_duplicate = is_duplicate;
  session.leased_at_s = clock_();
  leases_.hold(request.worker_id(), session.fencing_token);
  log_line(LogLevel::debug, about(session), "leased");
  reply.set_state(schema::LeaseReply::STATE_LEASED);
  reply.set_fencing_token(session.fencing_token);
  for (std::size_t i = 0; i < (*job)->output.size(); ++i) {
    schema::JobOutput& output = *reply.add_output();
    output.set_job_key((*job)->spec.needs(static_cast<int>(i)));
    output.set_sha256((*job)->output[i]);
  }
  *reply.mutable_job() = std::move((*job)->spec);
  return reply;
}

absl::StatusOr<std::optional<QueuedJob>> Farm::duplicate(const JobName& job, JobState expected) {
  auto known = store_.find_job(job.sweep_sha256, job.job_key);
  if (absl::IsNotFound(known.status())) return std::nullopt;  // its sweep was changed
  if (!known.ok()) return known.status();
  if (!known->has_value() || (*known)->job.state != expected) return std::nullopt;
  (*known)->job.fencing_token = kDuplicate | ++duplicates_;
  return std::move((*known)->job);
}

absl::StatusOr<std::optional<QueuedJob>> Farm::audit_for(const Session& session) {
  while (const auto job = double_check_.next_for(session.worker_name)) {
    ASSIGN_OR_RETURN(auto found, duplicate(*job, JobState::kDone));
    if (found.has_value() && check_class(session).ok() && check_physics(session, *job).ok())
      return found;
  }
  return std::nullopt;
}

// Returns the longest-running slow job for a duplicate attempt. A job is duplicated once, and never
// on a worker on which it failed.
absl::StatusOr<std::optional<QueuedJob>> Farm::straggling_job_for(const Session& session) {
  std::vector<const Session*> slow;
  for (const auto& [id, other] : sessions_) {
    if (other.state != SessionState::kComputing || other.is_duplicate ||
        other.worker_name == session.worker_name ||
        !stragglers_.is_one(clock_() - other.leased_at_s) ||
        should_go_to_another(session, other.job.job_key))
      continue;
    const bool twice = std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& third) {
      return third.second.state == SessionState::kComputing && third.second.is_duplicate &&
             third.second.job == other.job;
    });
    if (!twice) slow.push_back(&other);
  }
  std::stable_sort(slow.begin(), slow.end(), [](const Session* a, const Session* b) {
    return a->leased_at_s < b->leased_at_s;
  });
  for (const Session* slowest : slow) {
    // Its job may be settled already: cancelled, or done by somebody else.
    auto found = duplicate(slowest->job, JobState::kLeased);
    if (!found.ok()) return found;
    if (!found->has_value() || !check_physics(session, slowest->job).ok()) continue;
    log_line(LogLevel::info, about(*slowest), "takes long: {} computes it, too",
             session.worker_name);
    return found;
  }
  return std::nullopt;
}

// Temperatures that another sweep of the database has are not computed again: the sweeps of a pilot
// differ in nothing that they depend on.
absl::StatusOr<std::optional<QueuedJob>> Farm::next_to_compute(const std::string& worker_id,
                                                               const Session& session) {
  while (true) {
    auto job = next_job_for(worker_id, session);
    if (!job.ok() || !job->has_value()) return job;
    ASSIGN_OR_RETURN(const auto known,
                     store_.take_over((*job)->fencing_token, session.determinism_class));
    if (!known) return job;
    all_settled_.reset();
  }
}

// The next waiting job, apart from those that already failed on this worker while others could try.
absl::StatusOr<std::optional<QueuedJob>> Farm::next_job_for(const std::string& worker_id,
                                                            const Session& session) {
  std::vector<std::uint64_t> held;
  std::optional<QueuedJob> chosen;
  while (true) {
    ASSIGN_OR_RETURN(auto job, store_.lease_next(worker_id, unix_clock_()));
    if (!job.has_value()) break;
    if (should_go_to_another(session, job->spec.job_key())) {
      held.push_back(job->fencing_token);
      continue;
    }
    chosen = std::move(job);
    break;
  }
  for (const auto token : held) {
    RETURN_IF_ERROR(store_.release(token, "left to another worker"));
  }
  if (!chosen) return chosen;
  const auto status = admit(session, {chosen->spec.sweep_sha256(), chosen->spec.job_key()});
  if (status.ok()) return chosen;
  RETURN_IF_ERROR(store_.release(chosen->fencing_token, "not for this worker"));
  return status;
}

absl::Status Farm::admit(const Session& session, const JobName& job) {
  RETURN_IF_ERROR(check_class(session));
  RETURN_IF_ERROR(check_physics(session, job));
  ASSIGN_OR_RETURN(const auto bound, store_.determinism_class());
  return bound.empty() ? store_.bind_determinism_class(session.determinism_class)
                       : absl::OkStatus();
}

bool Farm::should_go_to_another(const Session& session, const std::string& job_key) const {
  if (const auto tried = out_of_memory_.find(job_key); tried != out_of_memory_.end() &&
                                                       !has_more_memory(session, tried->second) &&
                                                       somebody_has_more_memory(tried->second))
    return true;
  const auto failed = failed_on_.find(job_key);
  if (failed == failed_on_.end() || !failed->second.contains(session.worker_name)) return false;
  return somebody_besides(failed->second);
}

absl::Status Farm::check_class(const Session& session) {
  ASSIGN_OR_RETURN(const auto bound, store_.determinism_class());
  if (bound.empty() || bound == session.determinism_class) return absl::OkStatus();
  if (of_other_class_.size() < kMostOfOtherClassTold)
    of_other_class_.try_emplace(session.worker_name, session.determinism_class);
  return absl::FailedPreconditionError(
      absl::StrCat("this database was begun by workers of the determinism class \"", bound,
                   "\"; a worker of the class \"", session.determinism_class,
                   "\" would compute other last bits: run it on machines of the first class, or "
                   "start a new database with --isa, an instruction set that all of them have"));
}

Farm::SweepRules Farm::rules_for(const schema::ResolvedSweep& sweep) {
  SweepRules rules{.physics_version = std::nullopt,
                   .wavelengths = {},
                   .thumbnail_px = sweep.sweep().output().thumbnail_px()};
  for (const schema::Band& band : sweep.sweep().band()) {
    const double steps = std::round((band.lambda_max_um() - band.lambda_min_um()) / band.step_um());
    rules.wavelengths.push_back(static_cast<std::size_t>(steps) + 1);
  }
  return rules;
}

Farm::SweepRules& Farm::remember(const std::string& sweep_sha256,
                                 const schema::ResolvedSweep& sweep) {
  if (sweeps_.size() >= kMostSweepsInMind) sweeps_.clear();
  return sweeps_.emplace(sweep_sha256, rules_for(sweep)).first->second;
}

// Job keys hold the physics version of whoever submitted the sweep; a worker with another one would
// store its numbers under a key that promises different ones.
absl::Status Farm::check_physics(const Session& session, const JobName& job) {
  const auto refused = [&] {
    return absl::FailedPreconditionError(absl::StrCat(
        "this sweep was submitted for another physics version than the worker's (",
        session.physics_version, "): submit it again with the irsig of the worker's build"));
  };
  const std::string& sha256 = job.sweep_sha256;
  auto known = sweeps_.find(sha256);
  if (known != sweeps_.end() && known->second.other_versions.contains(session.physics_version))
    return refused();
  if (known == sweeps_.end() || !known->second.physics_version) {
    ASSIGN_OR_RETURN(const auto bytes, store_.asset(sha256));
    schema::ResolvedSweep sweep;
    if (!sweep.ParseFromString(bytes)) {
      return absl::DataLossError(absl::StrCat("the stored sweep ", sha256, " is damaged"));
    }
    if (auto status = check_sweep_(sweep); !status.ok())
      return absl::FailedPreconditionError(
          absl::StrCat("the stored sweep ", sha256, " cannot be computed: ", status.message()));
    SweepRules& rules = remember(sha256, sweep);
    ASSIGN_OR_RETURN(const auto stored, store_.physics_version(sha256));
    if (stored > 0) {
      rules.physics_version = stored;
    } else if (has_key(expand_jobs(sweep, static_cast<int>(session.physics_version)),
                       job.job_key)) {
      // All keys of a sweep were made with one version.
      rules.physics_version = session.physics_version;
    } else {
      if (rules.other_versions.size() < kMostVersionsInMind)
        rules.other_versions.insert(session.physics_version);
      return refused();
    }
    known = sweeps_.find(sha256);
  }
  return *known->second.physics_version == session.physics_version ? absl::OkStatus() : refused();
}

absl::StatusOr<bool> Farm::all_settled() {
  if (!all_settled_) {
    ASSIGN_OR_RETURN(const auto sweeps, store_.progress());
    all_settled_ = !sweeps.empty() && std::all_of(sweeps.begin(), sweeps.end(), [](const auto& s) {
      return s.waiting == 0 && s.leased == 0;
    });
  }
  return *all_settled_;
}

absl::StatusOr<schema::HeartbeatReply> Farm::heartbeat(const schema::HeartbeatRequest& request) {
  ASSIGN_OR_RETURN(const auto heard, hear(request.worker_id()));
  const std::uint64_t own = heard->state == SessionState::kComputing ? heard->fencing_token : 0;
  const bool ours = request.fencing_token() == 0 || request.fencing_token() == own;
  const auto& step =
      next(heard->state, ours ? SessionEvent::kHeartbeat : SessionEvent::kForeignHeartbeat);
  heard->state = step.next;
  schema::HeartbeatReply reply;
  reply.set_lease_valid(step.action != SessionAction::kAnswerInvalid);
  return reply;
}

absl::Status Farm::end_lease(Session& session, const std::string& reason, bool blame_the_job) {
  all_settled_.reset();
  const std::string& key = session.job.job_key;
  log_line(LogLevel::warn, about(session), "lost: {}", reason);
  if (session.is_duplicate) return absl::OkStatus();
  if (blame_the_job) {
    Losses& losses = losses_[key];
    ++losses.count;
    losses.workers.insert(session.worker_name);
    if (losses.workers.size() >= kLossesToQuarantine) {
      auto status =
          store_.fail(session.fencing_token, session.worker_name,
                      absl::StrCat(losses.workers.size(), " workers were lost with it: ",
                                   absl::StrJoin(losses.workers, ", "), " (", reason, ")"),
                      true);
      losses_.erase(key);
      return absl::IsFailedPrecondition(status) ? absl::OkStatus() : status;
    }
    if (losses.count > rules_.tolerated_losses)
      return count_failure(session, absl::StrCat("its worker was lost (", reason, ")"),
                           schema::FailRequest::KIND_OTHER);
  }
  const auto status = store_.release(session.fencing_token, reason);
  return absl::IsFailedPrecondition(status) ? absl::OkStatus() : status;
}

bool Farm::somebody_is_silent() {
  const double now_s = clock_();
  // If this process itself was stopped or starved, heartbeats of that time are still under way. If
  // the clock went back, earlier heartbeats say nothing either.
  if (std::abs(now_s - checked_at_s_) > rules_.lost_after_s / 2) {
    for (auto& [id, session] : sessions_) session.heard_at_s = now_s;
  }
  checked_at_s_ = now_s;
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return now_s - session.second.heard_at_s > rules_.lost_after_s;
  });
}

absl::Status Farm::drop_silent_workers() {
  const double now_s = clock_();
  // If several workers fall silent at once, the machine or the network is the cause, and none of
  // their jobs is blamed.
  const auto silent = std::count_if(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return now_s - session.second.heard_at_s > rules_.lost_after_s;
  });
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    Session& session = it->second;
    if (now_s - session.heard_at_s <= rules_.lost_after_s) {
      ++it;
      continue;
    }
    const auto& step = next(session.state, SessionEvent::kSilence);
    if (step.action == SessionAction::kRelease) {
      RETURN_IF_ERROR(end_lease(session, "no heartbeat", silent == 1));
    }
    leases_.forget(it->first);
    it = sessions_.erase(it);
  }
  return absl::OkStatus();
}

absl::Status Farm::release_orphaned_leases() {
  ASSIGN_OR_RETURN(const auto tokens, store_.running_tokens());
  all_settled_.reset();
  for (const std::uint64_t token : tokens) {
    const bool held = std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& session) {
      return session.second.state == SessionState::kComputing &&
             session.second.fencing_token == token;
    });
    if (held) continue;
    RETURN_IF_ERROR(store_.release(token, "a request failed"));
  }
  return absl::OkStatus();
}

}  // namespace irsig
