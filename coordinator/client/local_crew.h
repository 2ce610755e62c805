#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/client/child_process.h"
#include "coordinator/client/worker_crew.h"

namespace irsig {

// Workers that are children of this process and die with it.
class LocalCrew : public WorkerCrew {
 public:
  // command: of a worker, but for its name. folder: of its logs.
  LocalCrew(std::uint32_t workers, std::vector<std::string> command, std::string folder)
      : workers_(workers), command_(std::move(command)), folder_(std::move(folder)) {}

  absl::Status start() override;
  absl::Status keep_alive(std::uint64_t jobs_settled) override;
  void stop() override { workers_.clear(); }  // killed

 private:
  absl::Status start_worker(std::size_t slot);

  std::vector<std::unique_ptr<ChildProcess>> workers_;
  std::vector<std::string> command_;
  std::string folder_;
  DeathsWithoutProgress deaths_;
};

}  // namespace irsig
