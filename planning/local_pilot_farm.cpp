#include <chrono>
#include <cmath>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/scratch_folder.h"
#include "core/base/status_macros.h"
#include "planning/interruption.h"
#include "planning/pilot_farm.h"
#include "runner/job_runner.h"
#include "schema/store/reader.h"
#include "view/base/progress.h"
#include "view/report/heat_effects.h"

namespace irsig {
namespace {

using Steady = std::chrono::steady_clock;

class LocalPilotFarm final : public PilotFarm {
 public:
  static absl::StatusOr<std::unique_ptr<LocalPilotFarm>> start(const Assets& assets) {
    ASSIGN_OR_RETURN(auto folder, ScratchFolder::make());
    auto pilot = std::unique_ptr<LocalPilotFarm>(new LocalPilotFarm(std::move(folder), assets));
    hear_interruptions();
    auto farm =
        LocalFarm::start({.db_path = pilot->database(),
                          .workers = 1,
                          .coordinator_executable = beside_this_executable("irsig-coordinator"),
                          .worker_executable = beside_this_executable("irsig-worker"),
                          .worker_arguments = {}});
    if (!farm.ok()) return farm.status();
    pilot->farm_ = *std::move(farm);
    return pilot;
  }

  absl::StatusOr<std::vector<PilotStage>> run(std::vector<schema::ResolvedSweep> sweeps) override {
    for (schema::ResolvedSweep& sweep : sweeps) {
      sweep.mutable_sweep()->set_name(absl::StrCat("pilot ", ++sweeps_));
      ASSIGN_OR_RETURN(const auto sent, submit(farm_->address(), sweep, assets_,
                                               static_cast<std::uint32_t>(physics_version())));
    }
    const auto start = Steady::now();
    RETURN_IF_ERROR(farm_->start_workers());
    RETURN_IF_ERROR(wait());
    wall_s_ = std::chrono::duration<double>(Steady::now() - start).count();
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(database()));
    std::vector<PilotStage> stages;
    for (const schema::ResolvedSweep& sweep : sweeps) {
      PilotStage& stage = stages.emplace_back();
      SignatureFilter filter;
      filter.sweep = sweep.sweep().name();
      ASSIGN_OR_RETURN(auto rows, reader->find(filter));
      stage.rows = std::move(rows);
      ASSIGN_OR_RETURN(const auto stored, reader->sweep(filter.sweep, SweepFiles::kTemperatures));
      ASSIGN_OR_RETURN(const auto heat, HeatEffects::make(stored));
      for (const StoredSignature& row : stage.rows) {
        ASSIGN_OR_RETURN(auto ledger, reader->ledger(row.signature_id));
        for (StoredEffect& effect : heat.of(row)) ledger.effect.push_back(std::move(effect));
        stage.ledgers.push_back(std::move(ledger));
      }
      ASSIGN_OR_RETURN(auto jobs, reader->job_costs(filter.sweep));
      stage.jobs = std::move(jobs);
      ASSIGN_OR_RETURN(
          auto profile,
          reader->profiles({.sweep = filter.sweep, .season = "", .band = "", .profile = ""}));
      stage.profile = std::move(profile);
      for (const StoredJobCost& job : stage.jobs) cpu_s_ += job.cpu_s;
    }
    return stages;
  }

  [[nodiscard]] absl::StatusOr<double> bytes() const override {
    ASSIGN_OR_RETURN(auto reader, StoreReader::open(database()));
    ASSIGN_OR_RETURN(const auto bytes, reader->bytes());
    return static_cast<double>(bytes);
  }
  [[nodiscard]] double cpu_s() const override { return cpu_s_; }
  [[nodiscard]] double wall_s() const override { return wall_s_; }

 private:
  LocalPilotFarm(std::unique_ptr<ScratchFolder> folder, const Assets& assets)
      : folder_(std::move(folder)), assets_(assets) {}

  [[nodiscard]] std::string database() const { return folder_->file("pilot.sigdb"); }

  // All of the pilot's jobs so far: more may follow.
  void show(std::uint64_t settled, std::uint64_t jobs) {
    const double seconds = std::chrono::duration<double>(Steady::now() - begun_).count();
    if (seconds > 1.8)
      progress_.show(absl::StrCat("pilot: ", settled, " of ", jobs, " jobs computed, ",
                                  std::lround(seconds), " s"));
  }

  absl::Status wait() {
    while (true) {
      if (interrupted()) return absl::AbortedError("interrupted");
      ASSIGN_OR_RETURN(const auto status, farm_status(farm_->address(), 30));
      std::uint64_t settled = 0, jobs = 0;
      for (const auto& sweep : status.sweep()) {
        if (sweep.quarantined() > 0)
          return absl::AbortedError("a job of the pilot failed: " +
                                    absl::StrJoin(sweep.failure(), "\n  "));
        settled += sweep.done();
        jobs += sweep.jobs();
      }
      if (settled == jobs) return absl::OkStatus();
      show(settled, jobs);
      RETURN_IF_ERROR(farm_->keep_alive(settled));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  std::unique_ptr<ScratchFolder> folder_;
  const Assets& assets_;
  std::unique_ptr<LocalFarm> farm_;  // ends before its folder goes
  int sweeps_ = 0;
  double cpu_s_ = 0, wall_s_ = 0;
  const Steady::time_point begun_ = Steady::now();
  ProgressLine progress_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<PilotFarm>> start_pilot_farm(const Assets& assets) {
  return LocalPilotFarm::start(assets);
}

}  // namespace irsig
