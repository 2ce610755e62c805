#include "coordinator/farm.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/printable.h"
#include "jobs/check_resolved.h"
#include "jobs/expand.h"
#include "jobs/size_bounds.h"
#include "spdlog/spdlog.h"

namespace irsig {
namespace {

// An idle worker asks again after this long: short against any job, long against a database query.
constexpr double kIdleWait_s = 0.2;
// As the store counts: failures on so many distinct workers quarantine a job.
constexpr std::size_t kFailuresToQuarantine = 3;

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

std::string short_key(const std::string& key) { return key.substr(0, 12); }

// Of a worker's own words, as much as anybody reads.
std::string short_message(const std::string& message) {
  constexpr std::size_t kMost = 4000;
  if (message.size() <= kMost) return message;
  return absl::StrCat(message.substr(0, kMost), " ... (", message.size(), " bytes)");
}

constexpr std::size_t kMostSessions = 10000;
constexpr std::size_t kMostSweepsInMind = 100;
constexpr std::size_t kMostHeldBytes = 256 << 20;  // of assets, between their calls

}  // namespace

absl::StatusOr<Submission> make_submission(schema::ResolvedSweep sweep,
                                           std::uint32_t physics_version,
                                           std::vector<Asset> assets) {
  if (physics_version == 0) {
    return absl::InvalidArgumentError("a sweep is submitted with its physics_version");
  }
  if (auto status = check_resolved(sweep); !status.ok()) return status;
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

Farm::Farm(StoreWriter& store, const FarmRules& rules, Clock clock, Clock unix_clock,
           std::string coordinator_id)
    : store_(store),
      rules_(rules),
      clock_(std::move(clock)),
      unix_clock_(std::move(unix_clock)),
      coordinator_id_(std::move(coordinator_id)),
      checked_at_s_(clock_()) {}

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
        {"build_id", request.build_id()}}) {
    if (text.size() > kLongestName || !is_one_line(text))
      return absl::InvalidArgumentError(
          absl::StrCat(what, " has ", text.size(),
                       " bytes or control characters, expected a line of at most ", kLongestName));
  }
  if (sessions_.size() >= kMostSessions)
    return absl::FailedPreconditionError(
        absl::StrCat("there are ", kMostSessions, " workers already"));
  Session session{request.worker_name(),
                  request.determinism_class(),
                  request.physics_version(),
                  SessionState::kIdle,
                  "",
                  "",
                  0,
                  clock_()};
  if (auto status = check_class(session); !status.ok()) return status;
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    if (it->second.worker_name != request.worker_name()) {
      ++it;
      continue;
    }
    const auto step = next(it->second.state, SessionEvent::kSuccessor);
    if (step.action == SessionAction::kRelease) {
      if (auto status = end_lease(it->second, "its worker was started again"); !status.ok()) {
        return status;
      }
    }
    leases_.drop(it->first);
    it = sessions_.erase(it);
  }
  schema::RegisterReply reply;
  reply.set_worker_id(absl::StrCat(coordinator_id_, "-", ++registrations_));
  reply.set_heartbeat_s(rules_.heartbeat_s);
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
  const auto heard = hear(request.worker_id());
  if (!heard.ok()) return heard.status();
  Session& session = **heard;
  const auto step = next(session.state, SessionEvent::kAskForJob);
  session.state = step.next;
  if (step.action == SessionAction::kReleaseThenLease) {
    if (auto status = store_.release(session.fencing_token, "its worker asked for another job");
        !status.ok() && !absl::IsFailedPrecondition(status)) {
      return status;
    }
    leases_.drop(request.worker_id());
    all_settled_.reset();
  }
  schema::LeaseReply reply;
  if (all_settled_ && *all_settled_) {
    reply.set_state(schema::LeaseReply::STATE_FINISHED);
    reply.set_wait_s(kIdleWait_s);
    return reply;
  }
  if (auto status = check_class(session); !status.ok()) return status;
  auto job = next_to_compute(request.worker_id(), session);
  if (!job.ok()) return job.status();
  if (!job->has_value()) {
    const auto finished = all_settled();
    if (!finished.ok()) return finished.status();
    reply.set_state(*finished ? schema::LeaseReply::STATE_FINISHED
                              : schema::LeaseReply::STATE_WAIT);
    reply.set_wait_s(kIdleWait_s);
    return reply;
  }
  session.state = SessionState::kComputing;
  session.fencing_token = (*job)->fencing_token;
  session.job_key = (*job)->spec.job_key();
  session.sweep_sha256 = (*job)->spec.sweep_sha256();
  leases_.hold(request.worker_id(), session.fencing_token);
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

// Temperatures that another sweep of the database has are not computed again: the sweeps of a pilot
// differ in nothing that they depend on.
absl::StatusOr<std::optional<QueuedJob>> Farm::next_to_compute(const std::string& worker_id,
                                                               const Session& session) {
  while (true) {
    auto job = next_job_for(worker_id, session);
    if (!job.ok() || !job->has_value()) return job;
    const auto known = store_.take_over((*job)->fencing_token, session.determinism_class);
    if (!known.ok()) return known.status();
    if (!*known) return job;
    all_settled_.reset();
  }
}

// The next waiting job, apart from those that already failed on this worker while others could try.
absl::StatusOr<std::optional<QueuedJob>> Farm::next_job_for(const std::string& worker_id,
                                                            const Session& session) {
  std::vector<std::uint64_t> held;
  std::optional<QueuedJob> chosen;
  while (true) {
    auto job = store_.lease_next(worker_id, unix_clock_());
    if (!job.ok()) return job.status();
    if (!job->has_value()) break;
    if (should_go_to_another(session, (*job)->spec.job_key())) {
      held.push_back((*job)->fencing_token);
      continue;
    }
    chosen = *std::move(job);
    break;
  }
  for (const auto token : held) {
    if (auto status = store_.release(token, "left to another worker"); !status.ok()) return status;
  }
  if (!chosen) return chosen;
  auto status = check_physics(session, *chosen);
  if (status.ok()) {
    const auto bound = store_.determinism_class();
    if (!bound.ok()) return bound.status();
    if (bound->empty()) status = store_.bind_determinism_class(session.determinism_class);
  }
  if (status.ok()) return chosen;
  if (auto released = store_.release(chosen->fencing_token, "not for this worker");
      !released.ok()) {
    return released;
  }
  return status;
}

bool Farm::should_go_to_another(const Session& session, const std::string& job_key) const {
  const auto failed = failed_on_.find(job_key);
  if (failed == failed_on_.end() || !failed->second.contains(session.worker_name)) return false;
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& other) {
    return !failed->second.contains(other.second.worker_name);
  });
}

absl::Status Farm::check_class(const Session& session) {
  const auto bound = store_.determinism_class();
  if (!bound.ok()) return bound.status();
  if (bound->empty() || *bound == session.determinism_class) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("this database was begun by workers of the determinism class \"", *bound,
                   "\"; a worker of the class \"", session.determinism_class,
                   "\" would compute other last bits: run it on machines of the first class, or "
                   "start a new database"));
}

Farm::SweepRules Farm::rules_for(const schema::ResolvedSweep& sweep) {
  SweepRules rules{std::nullopt, {}, sweep.sweep().output().thumbnail_px()};
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
absl::Status Farm::check_physics(const Session& session, const QueuedJob& job) {
  const std::string& sha256 = job.spec.sweep_sha256();
  auto known = sweeps_.find(sha256);
  if (known == sweeps_.end() || !known->second.physics_version) {
    const auto bytes = store_.asset(sha256);
    if (!bytes.ok()) return bytes.status();
    schema::ResolvedSweep sweep;
    if (!sweep.ParseFromString(*bytes)) {
      return absl::DataLossError(absl::StrCat("the stored sweep ", sha256, " is damaged"));
    }
    if (auto status = check_resolved(sweep); !status.ok())
      return absl::FailedPreconditionError(
          absl::StrCat("the stored sweep ", sha256, " cannot be computed: ", status.message()));
    // All keys of a sweep were made with one version: of a coordinator that was started again it is
    // known when one key is found again.
    for (const auto& spec : expand_jobs(sweep, static_cast<int>(session.physics_version))) {
      if (spec.job_key() != job.spec.job_key()) continue;
      remember(sha256, sweep).physics_version = session.physics_version;
      return absl::OkStatus();
    }
  } else if (*known->second.physics_version == session.physics_version) {
    return absl::OkStatus();
  }
  return absl::FailedPreconditionError(absl::StrCat(
      "this sweep was submitted for another physics version than the worker's (",
      session.physics_version, "): submit it again with the irsig of the worker's build"));
}

// What the store does not know: who computed it, and how long spectra and how large pictures of
// this sweep are.
absl::Status Farm::check_against_session(const Session& session, const schema::JobResult& result) {
  if (result.determinism_class() != session.determinism_class)
    return absl::InvalidArgumentError(
        absl::StrCat("the result is of the determinism class \"", result.determinism_class(),
                     "\", its worker registered as \"", session.determinism_class, "\""));
  if (result.physics_version() != session.physics_version)
    return absl::InvalidArgumentError(
        absl::StrCat("the result is of physics version ", result.physics_version(),
                     ", its worker registered with ", session.physics_version));
  const auto known = sweeps_.find(session.sweep_sha256);
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

absl::StatusOr<bool> Farm::all_settled() {
  if (!all_settled_) {
    const auto sweeps = store_.progress();
    if (!sweeps.ok()) return sweeps.status();
    all_settled_ = !sweeps->empty() &&
                   std::all_of(sweeps->begin(), sweeps->end(),
                               [](const auto& s) { return s.waiting == 0 && s.leased == 0; });
  }
  return *all_settled_;
}

absl::StatusOr<schema::HeartbeatReply> Farm::heartbeat(const schema::HeartbeatRequest& request) {
  const auto heard = hear(request.worker_id());
  if (!heard.ok()) return heard.status();
  const std::uint64_t own =
      (*heard)->state == SessionState::kComputing ? (*heard)->fencing_token : 0;
  const bool ours = request.fencing_token() == 0 || request.fencing_token() == own;
  const auto step =
      next((*heard)->state, ours ? SessionEvent::kHeartbeat : SessionEvent::kForeignHeartbeat);
  (*heard)->state = step.next;
  schema::HeartbeatReply reply;
  reply.set_lease_valid(step.action != SessionAction::kAnswerInvalid);
  return reply;
}

absl::Status Farm::complete(const std::string& worker_id, std::uint64_t fencing_token,
                            const schema::JobResult& result, const absl::Status& checked) {
  const auto heard = hear(worker_id);
  if (!heard.ok()) return heard.status();
  Session& session = **heard;
  const bool own = fencing_token != 0 && fencing_token == session.fencing_token;
  const auto step = next(session.state, own ? SessionEvent::kReturn : SessionEvent::kForeignReturn);
  session.state = step.next;
  if (step.action != SessionAction::kSettle) {
    return absl::FailedPreconditionError(
        "the lease of this result is not current: it was given to another worker");
  }
  all_settled_.reset();
  leases_.drop(worker_id);
  absl::Status stored = checked;
  if (stored.ok()) stored = check_against_session(session, result);
  if (stored.ok()) stored = store_.complete(fencing_token, result, session.worker_name);
  if (stored.ok()) {
    failed_on_.erase(session.job_key);
    losses_.erase(session.job_key);
  } else if (absl::IsInvalidArgument(stored)) {
    spdlog::warn("result of job {} refused: {}", short_key(session.job_key), stored.ToString());
    if (auto status = count_failure(session, std::string(stored.message())); !status.ok()) {
      return status;
    }
  }
  session.fencing_token = 0;
  return stored;
}

absl::Status Farm::fail(const schema::FailRequest& request) {
  const auto heard = hear(request.worker_id());
  if (!heard.ok()) return heard.status();
  Session& session = **heard;
  const bool own = request.fencing_token() != 0 && request.fencing_token() == session.fencing_token;
  const auto step = next(session.state, own ? SessionEvent::kReturn : SessionEvent::kForeignReturn);
  session.state = step.next;
  if (step.action != SessionAction::kSettle) {
    return absl::FailedPreconditionError("the lease of this failure is not current");
  }
  all_settled_.reset();
  leases_.drop(request.worker_id());
  const auto status = count_failure(session, short_message(request.message()));
  session.fencing_token = 0;
  return status;
}

// A job that fails again on the same worker, because there is no other one to try it, counts as
// failed on one more: with fewer than three workers it would never settle otherwise.
absl::Status Farm::count_failure(Session& session, const std::string& message) {
  auto& workers = failed_on_[session.job_key];
  std::string counted_as = session.worker_name;
  for (int attempt = 2; workers.contains(counted_as); ++attempt) {
    counted_as = absl::StrCat(session.worker_name, " (attempt ", attempt, ")");
  }
  workers.insert(counted_as);
  spdlog::warn("job {} failed on {}: {}", short_key(session.job_key), counted_as, message);
  const bool settled = workers.size() >= kFailuresToQuarantine;
  auto status = store_.fail(session.fencing_token, counted_as, message);
  if (absl::IsFailedPrecondition(status)) status = absl::OkStatus();  // cancelled meanwhile
  if (settled) failed_on_.erase(session.job_key);
  return status;
}

absl::Status Farm::end_lease(Session& session, const std::string& reason) {
  all_settled_.reset();
  spdlog::warn("worker {} lost its job {}: {}", session.worker_name, short_key(session.job_key),
               reason);
  if (++losses_[session.job_key] > rules_.tolerated_losses) {
    return count_failure(session, absl::StrCat("its worker was lost (", reason, ")"));
  }
  const auto status = store_.release(session.fencing_token, reason);
  return absl::IsFailedPrecondition(status) ? absl::OkStatus() : status;
}

bool Farm::somebody_is_silent() {
  const double now_s = clock_();
  // If this process itself was stopped or starved, the heartbeats of that time are still on their
  // way.
  if (now_s - checked_at_s_ > rules_.lost_after_s / 2) {
    for (auto& [id, session] : sessions_) session.heard_at_s = now_s;
  }
  checked_at_s_ = now_s;
  return std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& session) {
    return now_s - session.second.heard_at_s > rules_.lost_after_s;
  });
}

absl::Status Farm::drop_silent_workers() {
  const double now_s = clock_();
  for (auto it = sessions_.begin(); it != sessions_.end();) {
    Session& session = it->second;
    if (now_s - session.heard_at_s <= rules_.lost_after_s) {
      ++it;
      continue;
    }
    const auto step = next(session.state, SessionEvent::kSilence);
    if (step.action == SessionAction::kRelease) {
      const auto status = end_lease(session, "no heartbeat");
      if (!status.ok()) return status;
    }
    leases_.drop(it->first);
    it = sessions_.erase(it);
  }
  return absl::OkStatus();
}

absl::Status Farm::release_what_nobody_holds() {
  const auto tokens = store_.running_tokens();
  if (!tokens.ok()) return tokens.status();
  all_settled_.reset();
  for (const std::uint64_t token : *tokens) {
    const bool held = std::any_of(sessions_.begin(), sessions_.end(), [&](const auto& session) {
      return session.second.state == SessionState::kComputing &&
             session.second.fencing_token == token;
    });
    if (held) continue;
    if (auto status = store_.release(token, "a request failed"); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const std::string>> Farm::asset(const std::string& sha256) {
  if (const auto found = assets_.find(sha256); found != assets_.end()) return found->second;
  auto bytes = store_.asset(sha256);
  if (!bytes.ok()) return bytes.status();
  std::size_t held = bytes->size();
  for (const auto& [other, there] : assets_) held += there->size();
  if (held > kMostHeldBytes) assets_.clear();  // those under way are held by their calls
  auto kept = std::make_shared<const std::string>(*std::move(bytes));
  assets_.emplace(sha256, kept);
  return kept;
}

absl::StatusOr<schema::SubmitReply> Farm::submit(const Submission& submission) {
  const auto added = store_.add_sweep(submission.sweep, submission.sweep_sha256, submission.jobs,
                                      submission.assets);
  if (!added.ok()) return added.status();
  if (submission.prediction) {
    if (auto status =
            store_.store_prediction(as_stored(*submission.prediction, submission.sweep_sha256));
        !status.ok())
      return status;
  }
  all_settled_.reset();
  sweeps_.erase(submission.sweep_sha256);
  remember(submission.sweep_sha256, submission.sweep).physics_version = submission.physics_version;
  schema::SubmitReply reply;
  reply.set_sweep_sha256(submission.sweep_sha256);
  reply.set_jobs(added->jobs);
  reply.set_jobs_to_compute(added->to_compute);
  spdlog::info("sweep {} ({}): {} jobs, {} to compute", submission.sweep.sweep().name(),
               short_key(submission.sweep_sha256), added->jobs, added->to_compute);
  return reply;
}

absl::StatusOr<schema::StatusReply> Farm::status() {
  const auto sweeps = store_.progress();
  if (!sweeps.ok()) return sweeps.status();
  schema::StatusReply reply;
  for (const auto& sweep : *sweeps) {
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
  }
  reply.set_workers(static_cast<std::uint32_t>(sessions_.size()));
  return reply;
}

absl::StatusOr<schema::CancelReply> Farm::cancel(const std::string& sweep_sha256) {
  const auto cancelled = store_.cancel(sweep_sha256);
  if (!cancelled.ok()) return cancelled.status();
  all_settled_.reset();
  schema::CancelReply reply;
  reply.set_cancelled(*cancelled);
  return reply;
}

}  // namespace irsig
