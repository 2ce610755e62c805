#include "coordinator/client/local_crew.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>

#include "absl/strings/str_cat.h"

namespace irsig {

absl::Status LocalCrew::start_worker(std::size_t slot) {
  // The name stays with the slot: a worker that registers under the name of a dead one takes its
  // place, and the dead one's job is free at once.
  std::vector<std::string> arguments = command_;
  arguments.insert(arguments.end(), {"--name", absl::StrCat("local-", getpid(), "-", slot + 1)});
  auto child =
      ChildProcess::start(arguments, absl::StrCat(folder_, "/worker-", slot + 1, ".log"), SIGKILL);
  if (!child.ok()) return child.status();
  workers_[slot] = std::make_unique<ChildProcess>(*std::move(child));
  return absl::OkStatus();
}

absl::Status LocalCrew::start() {
  for (std::size_t slot = 0; slot < workers_.size(); ++slot) {
    if (auto status = start_worker(slot); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status LocalCrew::keep_alive(std::uint64_t jobs_settled) {
  for (std::size_t slot = 0; slot < workers_.size(); ++slot) {
    const auto ending = workers_[slot]->ended();
    if (!ending || workers_[slot]->succeeded()) continue;
    const std::string words = last_message(workers_[slot]->last_words(), "irsig-worker");
    if (workers_[slot]->exit_code() == 3) {  // set aside; the others go on
      const bool all = std::all_of(workers_.begin(), workers_.end(), [](const auto& worker) {
        return worker->ended() && worker->exit_code() == 3;
      });
      if (all) return absl::AbortedError(words);
      continue;
    }
    // Refused by the coordinator, as the next one would be.
    if (workers_[slot]->exit_code() == 2) return absl::FailedPreconditionError(words);
    if (deaths_.too_many(jobs_settled))
      return absl::AbortedError(absl::StrCat("workers keep dying (", *ending, "): ", words));
    if (auto status = start_worker(slot); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace irsig
