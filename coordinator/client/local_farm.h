#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "coordinator/client/address.h"
#include "coordinator/client/child_process.h"
#include "coordinator/client/scratch_folder.h"
#include "coordinator/client/slurm_crew.h"
#include "coordinator/client/worker_crew.h"

namespace irsig {

struct LocalFarmPlan {
  std::string db_path;
  std::uint32_t workers = 1;
  std::string coordinator_executable;
  std::string worker_executable;
  std::vector<std::string> worker_arguments;  // besides the address and the name
  // Workers on the nodes of a cluster, which reach the coordinator over mutual TLS. The files of
  // both sides are in a private folder beside the database.
  std::optional<SlurmPlan> slurm{};
};

// A coordinator and its workers. On this machine all are children of this process, communicate over
// a Unix socket in a private directory, and end with it; with Slurm this holds for the coordinator
// alone. Use it from the main thread only (see ChildProcess).
class LocalFarm {
 public:
  // Starts a coordinator and returns when it answers. If the coordinator cannot run (another writer
  // holds the database, the database is of a newer version, ...), its message is returned as the
  // error, with its own code.
  static absl::StatusOr<std::unique_ptr<LocalFarm>> start(const LocalFarmPlan& plan);
  ~LocalFarm();

  [[nodiscard]] const Address& address() const { return address_; }
  absl::Status start_workers();
  // Restarts dead workers, as WorkerCrew does, and the coordinator a few times.
  absl::Status keep_alive(std::uint64_t jobs_settled);
  // Stops the workers at once. The coordinator stops when it has made the database one plain file,
  // or after a second or two if a reader prevents that; warning() then reports it, and everything
  // is stored.
  absl::Status stop();
  // The coordinator's warning at its end; empty: none.
  [[nodiscard]] const std::string& warning() const { return warning_; }

 private:
  explicit LocalFarm(LocalFarmPlan plan) : plan_(std::move(plan)) {}
  absl::Status make_certificates();
  [[nodiscard]] TlsFiles tls_files(const std::string& name) const;
  absl::Status make_crew();
  absl::Status start_coordinator();
  // Returns true if the coordinator answers; its port is known once it listens there.
  absl::StatusOr<bool> answers(const std::string& log);

  LocalFarmPlan plan_;
  std::unique_ptr<ScratchFolder> folder_;  // destroyed after its writers
  Address address_;
  std::unique_ptr<ChildProcess> coordinator_;
  std::unique_ptr<WorkerCrew> crew_;
  int coordinator_deaths_ = 0;
  std::string warning_;
};

// Returns the path of the executable of this name in the folder of the running executable.
[[nodiscard]] std::string beside_this_executable(const std::string& name);

}  // namespace irsig
