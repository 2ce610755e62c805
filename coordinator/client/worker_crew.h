#pragma once

#include <cstdint>

#include "absl/status/status.h"

namespace irsig {

// The workers of a farm whose coordinator is a child of this process. Use it from the main thread
// only (see ChildProcess).
class WorkerCrew {
 public:
  virtual ~WorkerCrew() = default;
  virtual absl::Status start() = 0;
  // Restarts dead workers. jobs_settled: jobs settled so far. If workers keep dying and no job is
  // settled meanwhile, an error with their last output is returned.
  virtual absl::Status keep_alive(std::uint64_t jobs_settled) = 0;
  // Ends the workers, at once or soon, without waiting for their further messages.
  virtual void stop() = 0;
};

// Decides whether workers may be started again.
class DeathsWithoutProgress {
 public:
  // Counts one more death. Returns true if too many workers died since a job was last settled.
  [[nodiscard]] bool too_many(std::uint64_t jobs_settled) {
    if (jobs_settled > settled_at_last_) count_ = 0;
    settled_at_last_ = jobs_settled;
    return ++count_ > kMost;
  }

 private:
  // Limit of deaths without a settled job; a worker that dies this often will die again.
  static constexpr int kMost = 10;
  std::uint64_t settled_at_last_ = 0;
  int count_ = 0;
};

}  // namespace irsig
