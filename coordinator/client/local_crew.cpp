#include "coordinator/client/local_crew.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

// A worker that the coordinator has set aside ends with this code; the others go on.
constexpr int kSetAside = 3;

// Threads of one process add their own numbers to its name.
std::string name_of_all() { return absl::StrCat("local-", getpid()); }

}  // namespace

absl::Status LocalCrew::start() {
  std::vector<std::string> arguments = command_;
  arguments.insert(arguments.end(), {"--name", name_of_all()});
  if (workers_ > 1) arguments.insert(arguments.end(), {"--threads", absl::StrCat(workers_)});
  ASSIGN_OR_RETURN(auto child, ChildProcess::start(arguments, folder_ + "/worker.log", SIGKILL));
  together_ = std::make_unique<ChildProcess>(std::move(child));
  return absl::OkStatus();
}

absl::Status LocalCrew::start_apart() {
  apart_.resize(workers_);
  for (std::size_t slot = 0; slot < apart_.size(); ++slot) RETURN_IF_ERROR(start_worker(slot));
  return absl::OkStatus();
}

absl::Status LocalCrew::start_worker(std::size_t slot) {
  // The name stays with the slot, and is that of a thread before: a worker that registers under the
  // name of a dead one takes its place, and the dead one's job is free at once.
  std::vector<std::string> arguments = command_;
  arguments.insert(
      arguments.end(),
      {"--name", workers_ > 1 ? absl::StrCat(name_of_all(), "-", slot + 1) : name_of_all()});
  ASSIGN_OR_RETURN(
      auto child,
      ChildProcess::start(arguments, absl::StrCat(folder_, "/worker-", slot + 1, ".log"), SIGKILL));
  apart_[slot] = std::make_unique<ChildProcess>(std::move(child));
  return absl::OkStatus();
}

absl::StatusOr<bool> LocalCrew::has_died(ChildProcess& worker, std::uint64_t jobs_settled) {
  const auto ending = worker.ended();
  if (!ending || worker.succeeded() || worker.exit_code() == kSetAside) return false;
  const std::string words = last_message(worker.last_words(), "irsig-worker");
  // Refused by the coordinator, as the next one would be.
  if (worker.exit_code() == 2) return absl::FailedPreconditionError(words);
  if (deaths_.too_many(jobs_settled))
    return absl::AbortedError(absl::StrCat("workers keep dying (", *ending, "): ", words));
  return true;
}

absl::Status LocalCrew::keep_alive(std::uint64_t jobs_settled) {
  if (together_) {
    ASSIGN_OR_RETURN(const auto died, has_died(*together_, jobs_settled));
    if (died) {
      together_.reset();
      return start_apart();
    }
    return together_->ended() && together_->exit_code() == kSetAside
               ? absl::AbortedError(last_message(together_->last_words(), "irsig-worker"))
               : absl::OkStatus();
  }
  for (std::size_t slot = 0; slot < apart_.size(); ++slot) {
    ASSIGN_OR_RETURN(const auto died, has_died(*apart_[slot], jobs_settled));
    if (!died) continue;
    RETURN_IF_ERROR(start_worker(slot));
  }
  const bool all_aside = std::all_of(apart_.begin(), apart_.end(), [](const auto& worker) {
    return worker->ended() && worker->exit_code() == kSetAside;
  });
  return all_aside && !apart_.empty()
             ? absl::AbortedError(last_message(apart_.back()->last_words(), "irsig-worker"))
             : absl::OkStatus();
}

}  // namespace irsig
