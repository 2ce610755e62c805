#include "worker/lease_loop.h"

#include <grpcpp/client_context.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/channel.h"
#include "coordinator/client/farm_log.h"
#include "coordinator/client/fetch_asset.h"
#include "coordinator/client/handshake.h"
#include "core/base/status_macros.h"
#include "worker/shared_runners.h"

namespace irsig {
namespace {

using Steady = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

// An answer comes after a commit: much later than this, the coordinator hangs.
constexpr double kAnswer_s = 30;
// Results and assets may be large and the disk slow.
constexpr double kStream_s = 300;
constexpr std::uint64_t kMostSpoolBytes = 4'000'000'000;
constexpr std::chrono::seconds kSpoolEvery(5);  // an idle worker looks for what others have left
constexpr int kTimesDamaged = 3;
constexpr double kFirstRetry_s = 0.1, kLastRetry_s = 2;

// Thread-safe: tells the coordinator at regular intervals that this worker lives.
class Heart {
 public:
  explicit Heart(schema::Farm::Stub& farm) : farm_(farm), thread_([this] { beat(); }) {}
  ~Heart() {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_one();
    thread_.join();
  }

  void registered(const schema::RegisterReply& reply) {
    const std::lock_guard lock(mutex_);
    worker_id_ = reply.worker_id();
    every_ = Seconds(reply.heartbeat_s());
    token_ = 0;
    changed_.notify_one();
  }
  void computing(std::uint64_t token) {
    const std::lock_guard lock(mutex_);
    token_ = token;
  }

 private:
  void beat() {
    std::unique_lock lock(mutex_);
    while (!ending_) {
      changed_.wait_for(lock, every_);
      if (ending_) return;
      if (worker_id_.empty()) continue;
      schema::HeartbeatRequest request;
      request.set_worker_id(worker_id_);
      request.set_fencing_token(token_);
      const double patience_s = std::max(1.0, every_.count());
      lock.unlock();
      grpc::ClientContext context;
      set_deadline(context, patience_s);
      schema::HeartbeatReply reply;
      // The result is ignored: the next call of the main loop finds out why a heartbeat failed.
      (void)farm_.Heartbeat(&context, request, &reply);
      lock.lock();
    }
  }

  schema::Farm::Stub& farm_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string worker_id_;
  std::uint64_t token_ = 0;
  Seconds every_{1};
  bool ending_ = false;
  std::thread thread_;
};

class LeaseLoop {
 public:
  // others_end: another loop of this process was refused, as this one would be.
  LeaseLoop(const WorkerPlan& plan, const RunnerFactory& make_runner, SharedRunners& runners,
            const std::atomic<bool>& stop, const std::atomic<bool>& others_end)
      : plan_(plan),
        make_runner_(make_runner),
        runners_(runners),
        stop_{stop, others_end},
        channel_(connect(plan.coordinator)),
        farm_(schema::Farm::NewStub(channel_)),
        heart_(*farm_) {}

  absl::Status run() {
    if (!plan_.spool_folder.empty()) {
      ASSIGN_OR_RETURN(spool_,
                       Spool::open(plan_.spool_folder, kMostSpoolBytes, plan_.at_spool_step));
    }
    while (!stop_ || next_) {  // a job that came with an answer is ours to compute
      if (worker_id_.empty()) {
        next_.reset();  // of another life
        const auto status = register_here();
        if (!status.ok()) return stopped_or(status);
        look_into_spool();
      }
      if (const auto status = deliver(); absl::IsNotFound(status)) {
        worker_id_.clear();
        continue;
      } else if (!status.ok()) {
        return stopped_or(status);
      }
      const auto lease =
          next_ ? absl::StatusOr<schema::LeaseReply>(*std::exchange(next_, {})) : ask_for_job();
      if (absl::IsNotFound(lease.status())) {  // the coordinator has restarted, or took us for lost
        worker_id_.clear();
        continue;
      }
      if (!lease.ok()) return stopped_or(lease.status());
      if (lease->state() == schema::LeaseReply::STATE_LEASED) {
        heart_.computing(lease->fencing_token());
        const auto status = compute(*lease);
        heart_.computing(0);
        if (absl::IsNotFound(status)) worker_id_.clear();
        if (ends_all(status)) return stopped_or(status);
      } else if (look_into_spool()) {
        continue;
      } else if (lease->state() == schema::LeaseReply::STATE_FINISHED && plan_.exit_when_finished) {
        return absl::OkStatus();
      } else {
        rest(lease->wait_s());
      }
    }
    // Asked to end with a result that the coordinator has not taken: that is worth a last attempt,
    // as a worker that it may not know any more.
    if (undelivered_.empty()) return absl::OkStatus();
    if (worker_id_.empty())
      if (auto status = register_here(true); !status.ok()) return absl::OkStatus();
    static_cast<void>(deliver());
    return absl::OkStatus();
  }

 private:
  // A result that no coordinator has acknowledged yet.
  struct Undelivered {
    schema::SpooledResult result;
    std::uint64_t fencing_token = 0;  // 0: its lease was an earlier worker's
    std::string file;                 // of the spool; empty: in memory alone
    int damaged = 0;
  };

  // The coordinator is gone, or wants nothing of this worker.
  static bool ends_all(const absl::Status& status) {
    return is_unreachable(status) || absl::IsAborted(status) || absl::IsPermissionDenied(status) ||
           absl::IsUnauthenticated(status);
  }
  absl::Status stopped_or(const absl::Status& status) const {
    return stop_ ? absl::OkStatus() : status;
  }

  void rest(double seconds) const {
    const auto until = Steady::now() + Seconds(seconds);
    while (!stop_ && Steady::now() < until) {
      std::this_thread::sleep_for(std::min(Seconds(until - Steady::now()), Seconds(0.05)));
    }
  }

  // Makes the call again while the coordinator is not there, until it has been away too long. When
  // we are to stop, a finished result is still worth one wait of a few seconds.
  template <class Call>
  absl::Status persist(Call call) {
    return persist(call, [] {});
  }
  // on_away: once, when it was not there for the first time.
  template <class Call, class OnAway>
  absl::Status persist(Call call, OnAway on_away) {
    const auto since = Steady::now();
    double pause_s = kFirstRetry_s;
    bool said = false;
    while (true) {
      const absl::Status status = call();
      if (!is_unreachable(status)) return status;
      if (!said) on_away();
      const double away_s = Seconds(Steady::now() - since).count();
      if (away_s > (stop_ ? std::min(5.0, plan_.give_up_after_s) : plan_.give_up_after_s)) {
        return absl::UnavailableError(absl::StrCat(
            "no coordinator answers at ", plan_.coordinator.text, " (", status.message(), ")"));
      }
      if (!said) {
        // A certificate that is refused is refused again.
        RETURN_IF_ERROR(check_handshake(plan_.coordinator));
        log_line(LogLevel::warn, {}, "no coordinator answers at {}: trying again",
                 plan_.coordinator.text);
        said = true;
      }
      // While nobody waits for a channel gRPC does not drive its attempts to connect: calls that
      // fail at once, with pauses between them, would never see a TLS handshake through.
      (void)channel_->WaitForConnected(deadline(pause_s));
      std::this_thread::sleep_for(Seconds(kFirstRetry_s));
      pause_s = std::min(kLastRetry_s, 2 * pause_s);
    }
  }

  absl::Status register_here(bool although_stopped = false) {
    schema::RegisterRequest request;
    request.set_worker_name(plan_.worker_name);
    request.set_determinism_class(plan_.determinism_class);
    request.set_build_id(plan_.build_id);
    request.set_physics_version(plan_.physics_version);
    request.set_memory_bytes(plan_.memory_bytes);
    request.set_host(plan_.host);
    schema::RegisterReply reply;
    const auto status = persist([&] {
      if (stop_ && !although_stopped) return absl::FailedPreconditionError("stopped");
      grpc::ClientContext context;
      set_deadline(context, kAnswer_s);
      return to_absl(farm_->Register(&context, request, &reply));
    });
    if (!status.ok()) return status;
    worker_id_ = reply.worker_id();
    heart_.registered(reply);
    foreign_sweeps_.clear();
    return absl::OkStatus();
  }

  absl::StatusOr<schema::LeaseReply> ask_for_job() {
    schema::LeaseRequest request;
    request.set_worker_id(worker_id_);
    schema::LeaseReply reply;
    const auto status = persist([&] {
      if (stop_) return absl::FailedPreconditionError("stopped");
      grpc::ClientContext context;
      set_deadline(context, kAnswer_s);
      return to_absl(farm_->Lease(&context, request, &reply));
    });
    if (!status.ok()) return status;
    return reply;
  }

  // Computes and returns one job. UNAVAILABLE: the coordinator is gone. Everything else that goes
  // wrong with the job itself is reported to the coordinator.
  absl::Status compute(const schema::LeaseReply& lease) {
    schema::FailRequest request;
    const auto begun = Steady::now();
    auto result = attempt(lease, request);
    if (result.ok()) {
      log_line(LogLevel::debug, {.job_key = lease.job().job_key()}, "computed in {:.3f} s",
               Seconds(Steady::now() - begun).count());
      Undelivered& made = undelivered_.emplace_back();
      made.fencing_token = lease.fencing_token();
      made.result.set_sweep_sha256(lease.job().sweep_sha256());
      made.result.set_job_key(lease.job().job_key());
      made.result.set_determinism_class(plan_.determinism_class);
      made.result.set_physics_version(plan_.physics_version);
      made.result.set_result(result->SerializeAsString());
      return deliver();
    }
    if (ends_all(result.status()) || absl::IsNotFound(result.status())) {
      return result.status();
    }
    log_line(LogLevel::warn, {.job_key = lease.job().job_key()}, "failed: {}",
             result.status().ToString());
    forget_runner();  // the next attempt starts from nothing
    request.set_worker_id(worker_id_);
    request.set_fencing_token(lease.fencing_token());
    request.set_message(std::string(result.status().message()));
    return persist([&] {
      grpc::ClientContext context;
      set_deadline(context, kAnswer_s);
      schema::FailReply reply;
      return to_absl(farm_->Fail(&context, request, &reply));
    });
  }

  // Computes the leased job. After an error, request.kind holds the kind of failure.
  absl::StatusOr<schema::JobResult> attempt(const schema::LeaseReply& lease,
                                            schema::FailRequest& request) {
    request.set_kind(schema::FailRequest::KIND_OTHER);
    try {
      RETURN_IF_ERROR(have_runner(lease, request));
      auto result = runner_->run(lease.job());
      if (result.ok()) return result;
      if (absl::IsInvalidArgument(result.status()))
        request.set_kind(schema::FailRequest::KIND_BAD_INPUT);
      if (absl::IsInternal(result.status())) request.set_kind(schema::FailRequest::KIND_GUARD);
      // An unavailable or missing thing of the computation must not be taken for a lost connection.
      return absl::InternalError(result.status().message());
    } catch (const std::bad_alloc&) {
      request.set_kind(schema::FailRequest::KIND_OUT_OF_MEMORY);
      return absl::InternalError("out of memory");
    } catch (const std::exception& error) {
      return absl::InternalError(absl::StrCat("exception: ", error.what()));
    }
  }

  void forget_runner() {
    runners_.forget(runner_);
    runner_.reset();
  }

  absl::Status fetch(const std::string& sha256, std::string& bytes) {
    absl::StatusOr<std::string> fetched;
    const auto status = persist([&] {
      fetched = fetch_file(*farm_, sha256, kStream_s);
      return fetched.status();
    });
    if (status.ok()) bytes = *std::move(fetched);
    return status;
  }

  // The scene stays from job to job; a loop computes one sweep at a time.
  absl::Status have_runner(const schema::LeaseReply& lease, schema::FailRequest& request) {
    const std::string& sweep_sha256 = lease.job().sweep_sha256();
    std::vector<std::string> outputs;
    for (const schema::JobOutput& output : lease.output())
      if (!output.sha256().empty()) outputs.push_back(output.sha256());
    const SharedRunners::Key key{sweep_sha256, std::move(outputs)};
    if (runner_ && runner_of_.sweep_sha256 == key.sweep_sha256 &&
        (key.outputs.empty() || key.outputs == runner_of_.outputs))
      return absl::OkStatus();
    runner_.reset();
    auto runner =
        runners_.get(key, [&](Assets& assets) { return new_runner(key, assets, request); });
    if (!runner.ok()) return runner.status();
    runner_ = *std::move(runner);
    runner_of_ = key;
    return absl::OkStatus();
  }

  absl::StatusOr<std::unique_ptr<const JobRunner>> new_runner(const SharedRunners::Key& key,
                                                              Assets& assets,
                                                              schema::FailRequest& request) {
    absl::StatusOr<schema::ResolvedSweep> sweep;
    auto status = persist([&] {
      sweep = fetch_sweep(*farm_, key.sweep_sha256, kStream_s);
      return sweep.status();
    });
    if (!status.ok()) return status;
    const std::set<std::string> needed = needed_assets(*sweep);
    std::erase_if(assets, [&](const auto& have) { return !needed.contains(have.first); });
    for (const std::string& sha256 : needed) {
      if (assets.contains(sha256)) continue;
      std::string bytes;
      if (status = fetch(sha256, bytes); !status.ok()) return status;
      assets[sha256] = std::move(bytes);
    }
    HeatOutputs heat(key.outputs.size());
    for (std::size_t i = 0; i < heat.size(); ++i)
      if (status = fetch(key.outputs[i], heat[i]); !status.ok()) return status;
    auto runner = make_runner_(*sweep, assets, heat);
    if (absl::IsInvalidArgument(runner.status()))
      request.set_kind(schema::FailRequest::KIND_BAD_INPUT);
    if (!runner.ok()) return absl::InternalError(runner.status().message());
    return runner;
  }

  // Results of workers that have died. True: there were some.
  bool look_into_spool() {
    if (!spool_ || Steady::now() < look_again_) return false;
    look_again_ = Steady::now() + kSpoolEvery;
    auto found = spool_->take_over([&](const schema::SpooledResult& result) {
      return result.determinism_class() == plan_.determinism_class &&
             result.physics_version() == plan_.physics_version &&
             !foreign_sweeps_.contains(result.sweep_sha256());
    });
    for (Spool::Found& one : found)
      undelivered_.push_back({std::move(one.record), 0, std::move(one.name)});
    return !found.empty();
  }

  // Everything that is not acknowledged yet. NOT_FOUND: the coordinator does not know us (any
  // more); other errors: it is gone, or wants nothing of this worker. What is left then is kept.
  absl::Status deliver() {
    for (auto at = undelivered_.begin(); at != undelivered_.end();) {
      schema::CompleteReply reply;
      // With the last of them comes the next job: one way to the coordinator and its disk, not two.
      const bool wants_job =
          !stop_ && at->fencing_token != 0 && std::next(at) == undelivered_.end();
      const absl::Status status =
          persist([&] { return send_once(*at, wants_job, reply); }, [&] { keep_on_disk(*at); });
      if (status.ok() && reply.next().state() == schema::LeaseReply::STATE_LEASED)
        next_ = std::move(*reply.mutable_next());
      const std::string& key = at->result.job_key();
      if (absl::IsNotFound(status)) {
        keep_on_disk(*at);
        for (Undelivered& one : undelivered_) one.fencing_token = 0;  // leases of another life
        return status;
      }
      if (absl::IsDataLoss(status) && ++at->damaged < kTimesDamaged) continue;
      if (ends_all(status) && !absl::IsAborted(status)) return status;
      const bool unknown_sweep =
          status.ok() && reply.state() == schema::CompleteReply::STATE_UNKNOWN_SWEEP;
      if (!status.ok()) {
        log_line(LogLevel::warn, {.job_key = key}, "result not taken: {}", status.ToString());
      } else if (unknown_sweep) {
        log_line(LogLevel::info, {.job_key = key},
                 "result of a sweep that this coordinator does not have");
      } else if (reply.state() == schema::CompleteReply::STATE_ASIDE) {
        log_line(LogLevel::warn, {.job_key = key},
                 "result differs from another worker's: kept aside");
      } else if (reply.state() == schema::CompleteReply::STATE_NOT_WANTED) {
        log_line(LogLevel::info, {.job_key = key}, "result is not wanted any more");
      }
      // Whatever is wrong with this coordinator, another one may take it.
      const bool settled =
          status.ok() ? !unknown_sweep : absl::IsInvalidArgument(status) || absl::IsAborted(status);
      if (!settled) foreign_sweeps_.insert(at->result.sweep_sha256());
      if (!at->file.empty()) settled ? spool_->remove(at->file) : spool_->leave(at->file);
      at = undelivered_.erase(at);
      if (absl::IsAborted(status)) return status;
    }
    return absl::OkStatus();
  }

  void keep_on_disk(Undelivered& one) {
    if (!spool_ || !one.file.empty()) return;
    auto name = spool_->keep(one.result);
    if (name.ok()) {
      one.file = *std::move(name);
    } else {
      log_line(LogLevel::warn, {.job_key = one.result.job_key()},
               "result is kept in memory alone: {}", name.status().ToString());
    }
  }

  absl::Status send_once(const Undelivered& one, bool wants_job, schema::CompleteReply& reply) {
    const std::string& bytes = one.result.result();
    grpc::ClientContext context;
    set_deadline(context, kStream_s);
    const auto stream = farm_->Complete(&context, &reply);
    schema::CompleteChunk chunk;
    chunk.set_worker_id(worker_id_);
    chunk.set_fencing_token(one.fencing_token);
    chunk.set_result_bytes(bytes.size());
    chunk.set_sweep_sha256(one.result.sweep_sha256());
    chunk.set_wants_job(wants_job);
    bool open = true;
    for (std::size_t at = 0; open && at < bytes.size(); at += kPieceBytes) {
      chunk.set_piece(bytes.substr(at, kPieceBytes));
      open = stream->Write(chunk);
      chunk.clear_sweep_sha256();
      chunk.clear_wants_job();
    }
    stream->WritesDone();
    return to_absl(stream->Finish());
  }

  const WorkerPlan& plan_;
  const RunnerFactory& make_runner_;
  SharedRunners& runners_;
  struct Stop {
    const std::atomic<bool>&asked, &others_end;
    operator bool() const { return asked || others_end; }
  } stop_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<schema::Farm::Stub> farm_;
  std::string worker_id_;
  std::shared_ptr<const JobRunner> runner_;
  SharedRunners::Key runner_of_;  // where there is one
  std::unique_ptr<Spool> spool_;
  std::list<Undelivered> undelivered_;
  std::optional<schema::LeaseReply> next_;
  std::set<std::string> foreign_sweeps_;  // that this coordinator takes no results of
  Steady::time_point look_again_{};
  Heart heart_;
};

}  // namespace

absl::Status run_lease_loop(const WorkerPlan& plan, const RunnerFactory& make_runner,
                            const std::atomic<bool>& stop) {
  SharedRunners runners;
  std::atomic<bool> end_all = false;
  if (plan.threads <= 1) return LeaseLoop(plan, make_runner, runners, stop, end_all).run();
  std::vector<absl::Status> ended(plan.threads);
  std::vector<std::thread> loops;
  for (std::uint32_t i = 0; i < plan.threads; ++i)
    loops.emplace_back([&, i] {
      WorkerPlan own = plan;
      own.worker_name = absl::StrCat(plan.worker_name, "-", i + 1);
      ended[i] = LeaseLoop(own, make_runner, runners, stop, end_all).run();
      if (!ended[i].ok() && !absl::IsAborted(ended[i])) end_all = true;
    });
  for (std::thread& loop : loops) loop.join();
  bool all_aside = true;
  for (const absl::Status& status : ended) {
    if (!status.ok() && !absl::IsAborted(status)) return status;
    all_aside = all_aside && absl::IsAborted(status);
  }
  return all_aside ? ended.front() : absl::OkStatus();
}

}  // namespace irsig
