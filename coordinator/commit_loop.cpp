#include "coordinator/commit_loop.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_log.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// SQLite gains little beyond 100 results in a commit, and the first of them would wait for the
// last.
constexpr std::size_t kRequestsInACommit = 100;
constexpr auto kTick = std::chrono::milliseconds(250);  // how often silence is looked for

// The store itself cannot go on: a full or damaged disk, no memory, a lock that stays.
bool is_the_end(const absl::Status& status) {
  return absl::IsResourceExhausted(status) || absl::IsDataLoss(status) ||
         absl::IsUnavailable(status) || absl::IsPermissionDenied(status);
}

// Whatever a request holds, it ends with a status.
absl::Status run_safely(CommitLoop::Work& work, Farm& farm) {
  try {
    return work(farm);
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("exception: ", error.what()));
  }
}

// Runs one request in a transaction of several. A request that fails is undone, unless it fails by
// a refusal.
absl::Status run_subprocess(CommitLoop::Work& work, Farm& farm, StoreWriter& store,
                            absl::Status& broken) {
  if (broken = store.begin_request(); !broken.ok()) return broken;
  const absl::Status status = run_safely(work, farm);
  if (status.ok() || is_refusal(status)) {
    broken = store.keep_request();
    return broken.ok() ? status : broken;
  }
  if (is_the_end(status)) {
    broken = status;
    return status;
  }
  log_line(LogLevel::err, {}, "a request failed and was undone: {}", status.ToString());
  broken = store.undo_request();
  if (broken.ok()) broken = farm.release_orphaned_leases();
  return absl::InternalError(absl::StrCat("the request failed: ", status.message()));
}

}  // namespace

CommitLoop::~CommitLoop() { stop(); }

void CommitLoop::post(Kind kind, Work work, Acknowledge acknowledge) {
  absl::Status broken;
  {
    const std::lock_guard lock(mutex_);
    broken = broken_;
    if (broken.ok()) {
      waiting_.push_back({kind, std::move(work), std::move(acknowledge), absl::OkStatus()});
    }
  }
  if (broken.ok()) {
    arrived_.notify_one();
  } else {
    acknowledge(broken);
  }
}

void CommitLoop::start(Farm& farm, StoreWriter& store,
                       absl::AnyInvocable<void(absl::Status)> failed) {
  failed_ = std::move(failed);
  thread_ = std::thread([this, &farm, &store] { run(farm, store); });
}

void CommitLoop::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (!thread_.joinable() && broken_.ok()) broken_ = absl::UnavailableError("shutting down");
  }
  arrived_.notify_one();
  if (thread_.joinable()) thread_.join();
  std::vector<Request> rest;
  {
    const std::lock_guard lock(mutex_);
    if (broken_.ok()) broken_ = absl::UnavailableError("the coordinator is shutting down");
    rest.swap(waiting_);
  }
  for (auto& request : rest) request.acknowledge(broken_);
}

std::vector<CommitLoop::Request> CommitLoop::wait_for_requests() {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, kTick, [this] { return stopping_ || !waiting_.empty(); });
  std::vector<Request> taken;
  if (waiting_.size() <= kRequestsInACommit) {
    taken.swap(waiting_);
  } else {
    const auto end = waiting_.begin() + static_cast<std::ptrdiff_t>(kRequestsInACommit);
    taken.assign(std::make_move_iterator(waiting_.begin()), std::make_move_iterator(end));
    waiting_.erase(waiting_.begin(), end);
  }
  return taken;
}

void CommitLoop::run(Farm& farm, StoreWriter& store) {
  while (true) {
    auto requests = wait_for_requests();
    if (requests.empty()) {
      const std::lock_guard lock(mutex_);
      if (stopping_ && waiting_.empty()) return;
    }
    const auto status = serve(farm, store, requests);
    if (!status.ok()) {
      // In memory and on disk no longer agree about the leases of this transaction.
      const auto broken =
          absl::UnavailableError(absl::StrCat("the database failed: ", status.message()));
      {
        const std::lock_guard lock(mutex_);
        broken_ = broken;
        std::move(waiting_.begin(), waiting_.end(), std::back_inserter(requests));
        waiting_.clear();
      }
      for (auto& request : requests) request.acknowledge(broken);
      failed_(status);
      return;
    }
    for (auto& request : requests) request.acknowledge(request.status);
  }
}

absl::Status CommitLoop::serve(Farm& farm, StoreWriter& store, std::vector<Request>& requests) {
  const bool lost = farm.somebody_is_silent();
  Kind most = lost ? Kind::kLeases : Kind::kReads;
  for (const Request& request : requests) most = std::max(most, request.kind);
  const bool writes = most != Kind::kReads;
  if (writes) {
    RETURN_IF_ERROR(most == Kind::kLeases ? store.begin_unsynced() : store.begin());
  }
  absl::Status broken;
  // Requests that have arrived are handled before workers are declared silent.
  for (auto& request : requests) {
    request.status =
        writes ? run_subprocess(request.work, farm, store, broken) : run_safely(request.work, farm);
    if (!writes && is_the_end(request.status)) broken = request.status;
    if (!broken.ok()) break;
  }
  if (broken.ok() && lost) broken = farm.drop_silent_workers();
  if (!broken.ok()) {
    if (writes) store.rollback();
    return broken;
  }
  return writes ? store.commit() : absl::OkStatus();
}

}  // namespace irsig
