#include <chrono>
#include <cmath>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "bridge/job_runner.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_farm.h"
#include "coordinator/client/scratch_folder.h"
#include "planning/interruption.h"
#include "planning/pilot_farm.h"
#include "view/heat_effects.h"
#include "view/progress.h"

namespace irsig {
namespace {

using Steady = std::chrono::steady_clock;

class LocalPilotFarm final : public PilotFarm {
 public:
  static absl::StatusOr<std::unique_ptr<LocalPilotFarm>> start(const Assets& assets) {
    auto folder = ScratchFolder::make();
    if (!folder.ok()) return folder.status();
    auto pilot = std::unique_ptr<LocalPilotFarm>(new LocalPilotFarm(*std::move(folder), assets));
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
      const auto sent =
          submit(farm_->address(), sweep, assets_, static_cast<std::uint32_t>(physics_version()));
      if (!sent.ok()) return sent.status();
    }
    const auto start = Steady::now();
    if (auto status = farm_->start_workers(); !status.ok()) return status;
    if (auto status = wait(); !status.ok()) return status;
    wall_s_ = std::chrono::duration<double>(Steady::now() - start).count();
    auto reader = StoreReader::open(database());
    if (!reader.ok()) return reader.status();
    std::vector<PilotStage> stages;
    for (const schema::ResolvedSweep& sweep : sweeps) {
      PilotStage& stage = stages.emplace_back();
      SignatureFilter filter;
      filter.sweep = sweep.sweep().name();
      auto rows = (*reader)->find(filter);
      if (!rows.ok()) return rows.status();
      stage.rows = *std::move(rows);
      const auto stored = (*reader)->sweep(filter.sweep, SweepFiles::kTemperatures);
      if (!stored.ok()) return stored.status();
      const auto heat = HeatEffects::make(*stored);
      if (!heat.ok()) return heat.status();
      for (const StoredSignature& row : stage.rows) {
        auto ledger = (*reader)->ledger(row.signature_id);
        if (!ledger.ok()) return ledger.status();
        for (StoredEffect& effect : heat->of(row)) ledger->effect.push_back(std::move(effect));
        stage.ledgers.push_back(*std::move(ledger));
      }
      auto jobs = (*reader)->job_costs(filter.sweep);
      if (!jobs.ok()) return jobs.status();
      stage.jobs = *std::move(jobs);
      auto profile =
          (*reader)->profiles({.sweep = filter.sweep, .season = "", .band = "", .profile = ""});
      if (!profile.ok()) return profile.status();
      stage.profile = *std::move(profile);
      for (const StoredJobCost& job : stage.jobs) cpu_s_ += job.cpu_s;
    }
    return stages;
  }

  [[nodiscard]] absl::StatusOr<double> bytes() const override {
    auto reader = StoreReader::open(database());
    if (!reader.ok()) return reader.status();
    const auto bytes = (*reader)->bytes();
    if (!bytes.ok()) return bytes.status();
    return static_cast<double>(*bytes);
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
      const auto status = farm_status(farm_->address(), 30);
      if (!status.ok()) return status.status();
      std::uint64_t settled = 0, jobs = 0;
      for (const auto& sweep : status->sweep()) {
        if (sweep.quarantined() > 0)
          return absl::AbortedError("a job of the pilot failed: " +
                                    absl::StrJoin(sweep.failure(), "\n  "));
        settled += sweep.done();
        jobs += sweep.jobs();
      }
      if (settled == jobs) return absl::OkStatus();
      show(settled, jobs);
      if (auto alive = farm_->keep_alive(settled); !alive.ok()) return alive;
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
