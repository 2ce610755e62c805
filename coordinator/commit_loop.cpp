#include "coordinator/commit_loop.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

// SQLite gains little beyond 100 results in a commit, and the first of them would wait for the
// last.
constexpr std::size_t kRequestsInACommit = 100;
constexpr auto kTick = std::chrono::milliseconds(250);  // how often silence is looked for

// A refusal concerns one request; anything else means that the store cannot be trusted to go on.
bool is_refusal(const absl::Status& status) {
  return absl::IsFailedPrecondition(status) || absl::IsInvalidArgument(status) ||
         absl::IsNotFound(status) || absl::IsAlreadyExists(status);
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
  const bool writes =
      lost || std::any_of(requests.begin(), requests.end(),
                          [](const Request& request) { return request.kind == Kind::kWrites; });
  if (writes) {
    if (auto status = store.begin(); !status.ok()) return status;
  }
  absl::Status broken;
  // What has arrived is heard before anybody is called silent.
  for (auto& request : requests) {
    request.status = request.work(farm);
    if (!request.status.ok() && !is_refusal(request.status)) {
      broken = request.status;
      break;
    }
  }
  if (broken.ok() && lost) broken = farm.drop_silent_workers();
  if (!broken.ok()) {
    if (writes) store.rollback();
    return broken;
  }
  return writes ? store.commit() : absl::OkStatus();
}

}  // namespace irsig
