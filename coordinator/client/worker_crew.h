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
  // Starts again what died. jobs_settled: so far; workers that keep dying without any job being
  // settled in between are not started for ever: an error, with their last words.
  virtual absl::Status keep_alive(std::uint64_t jobs_settled) = 0;
  // Ends the workers, at once or soon: their further messages are not waited for.
  virtual void stop() = 0;
};

// Decides if workers may be started once more.
class DeathsWithoutProgress {
 public:
  // Counts one more death. Returns true if too many workers died since a job was last settled.
  [[nodiscard]] bool too_many(std::uint64_t jobs_settled) {
    if (jobs_settled > settled_at_last_) count_ = 0;
    settled_at_last_ = jobs_settled;
    return ++count_ > kMost;
  }

 private:
  // A worker that dies this often while no job gets settled will die again.
  static constexpr int kMost = 10;
  std::uint64_t settled_at_last_ = 0;
  int count_ = 0;
};

}  // namespace irsig
