#pragma once

#include <memory>
#include <string>
#include <vector>

#include "coordinator/client/child_process.h"
#include "coordinator/client/worker_crew.h"

namespace irsig {

// Workers that are children of this process and end with it. They are threads of one process, which
// share a scene and its air. After a death each worker becomes a separate process, so that a job
// that kills its worker ends no other worker.
class LocalCrew : public WorkerCrew {
 public:
  // command: the worker's command without its name. folder: of its logs.
  LocalCrew(std::uint32_t workers, std::vector<std::string> command, std::string folder)
      : workers_(workers), command_(std::move(command)), folder_(std::move(folder)) {}

  absl::Status start() override;
  absl::Status keep_alive(std::uint64_t jobs_settled) override;
  void stop() override {  // killed
    together_.reset();
    apart_.clear();
  }

 private:
  absl::Status start_apart();
  absl::Status start_worker(std::size_t slot);
  // Returns true if the worker must be started again. FAILED_PRECONDITION: the coordinator refuses
  // it, as it would refuse the next one. ABORTED: workers keep dying.
  absl::StatusOr<bool> has_died(ChildProcess& worker, std::uint64_t jobs_settled);

  std::uint32_t workers_;
  std::unique_ptr<ChildProcess> together_;
  std::vector<std::unique_ptr<ChildProcess>> apart_;  // [slot]
  std::vector<std::string> command_;
  std::string folder_;
  DeathsWithoutProgress deaths_;
};

}  // namespace irsig
