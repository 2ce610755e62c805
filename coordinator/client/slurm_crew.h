#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/worker_crew.h"

namespace irsig {

// A user's request to Slurm.
struct SlurmPlan {
  std::uint32_t nodes = 0;  // whole nodes, a worker on each CPU of theirs; 0: workers one by one
  std::string partition, time_limit;  // in the form of sbatch; empty: Slurm's defaults
  std::vector<std::string> options;   // of sbatch, besides
  std::string host;                   // under which nodes reach this machine; empty: its name
  // Callback: given the last words of workers that have vanished from Slurm's queue, which may be
  // empty.
  std::function<void(const std::string&)> say{};
};

// Workers as a Slurm job array. Slurm places the workers and restarts those whose node it loses or
// takes away. When a time limit has ended the workers, or all have died, they are submitted again
// as long as there is work.
class SlurmCrew : public WorkerCrew {
 public:
  // Creates a crew. command: the worker's command without its name. folder: the place of the script
  // and logs; all nodes can read and write there. INVALID_ARGUMENT: Slurm is not installed here.
  static absl::StatusOr<std::unique_ptr<SlurmCrew>> make(const SlurmPlan& plan,
                                                         std::uint32_t workers,
                                                         std::vector<std::string> command,
                                                         std::string folder);
  absl::Status start() override;
  absl::Status keep_alive(std::uint64_t jobs_settled) override;
  void stop() override;

 private:
  SlurmCrew() = default;
  [[nodiscard]] absl::Status write_script() const;
  absl::Status hand_in();
  // Returns the end of the first worker's output. Empty: there is no output.
  [[nodiscard]] std::string last_words() const;
  // Returns the output of a Slurm program. UNAVAILABLE: the program failed; the message has its
  // last output.
  absl::StatusOr<std::string> run(const std::vector<std::string>& arguments, const char* name);

  SlurmPlan plan_;
  std::uint32_t workers_ = 0;
  std::vector<std::string> command_;
  std::string folder_, sbatch_, squeue_, scancel_;
  std::string job_;  // the array's number
  int runs_ = 0;
  double next_look_s_ = 0;
  DeathsWithoutProgress deaths_;
};

}  // namespace irsig
