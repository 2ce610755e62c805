#include "coordinator/client/local_farm.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "coordinator/client/farm_client.h"

namespace irsig {
namespace {

// A worker that dies this often while no job gets settled will die again.
constexpr int kDeathsWithoutProgress = 10;
constexpr int kCoordinatorDeaths = 5;
constexpr double kCoordinatorStart_s = 600;  // migrations of a large database included
constexpr std::size_t kLongestFolder = 80;   // the path of a Unix socket has at most 107 letters
constexpr double kCoordinatorStop_s = 60;    // the checkpoint of a large journal

constexpr const char* kWarning = "warning: ";

// What a program of ours said last under its own name: the message, without the lines of its log.
std::string last_message(const std::string& words, const std::string& program) {
  const std::string mark = program + ": ";
  const auto at = words.rfind("\n" + mark);
  if (at != std::string::npos) return words.substr(at + 1 + mark.size());
  return words.starts_with(mark) ? words.substr(mark.size()) : words;
}

// Our executables end with 2 when what they were given is wrong.
absl::Status as_status(const std::string& ending, const std::string& words) {
  const std::string message =
      words.empty() ? "the coordinator ended: " + ending : last_message(words, "irsig-coordinator");
  return ending == "exit code 2" ? absl::InvalidArgumentError(message)
                                 : absl::AbortedError(message);
}

}  // namespace

std::string beside_this_executable(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? name : (self.parent_path() / name).string();
}

absl::StatusOr<std::unique_ptr<LocalFarm>> LocalFarm::start(const LocalFarmPlan& plan) {
  std::unique_ptr<LocalFarm> farm(new LocalFarm(plan));
  auto folder = ScratchFolder::make(kLongestFolder);
  if (!folder.ok()) return folder.status();
  farm->folder_ = *std::move(folder);
  auto address = parse_address("unix:" + farm->folder_->file("farm"));
  if (!address.ok()) return address.status();
  farm->address_ = *std::move(address);
  if (auto status = farm->start_coordinator(); !status.ok()) return status;
  return farm;
}

LocalFarm::~LocalFarm() {
  if (coordinator_ && !coordinator_->ended()) (void)stop();
}

absl::Status LocalFarm::start_coordinator() {
  const std::string log = folder_->file(absl::StrCat("coordinator-", coordinator_deaths_, ".log"));
  auto child = ChildProcess::start({plan_.coordinator_executable, "--db", plan_.db_path, "--listen",
                                    address_.text, "--remove-unused"},
                                   log, SIGTERM);
  if (!child.ok()) return child.status();
  coordinator_ = std::make_unique<ChildProcess>(*std::move(child));
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(kCoordinatorStart_s);
  while (std::chrono::steady_clock::now() < deadline) {
    if (const auto ending = coordinator_->ended()) {
      return as_status(*ending, coordinator_->last_words());
    }
    if (std::filesystem::exists(address_.unix_path) && farm_status(address_, 5).ok()) {
      return absl::OkStatus();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return absl::UnavailableError(absl::StrCat("the coordinator did not answer within ",
                                             kCoordinatorStart_s,
                                             " s: ", coordinator_->last_words()));
}

absl::Status LocalFarm::start_worker(std::size_t slot) {
  // The name stays with the slot: a worker that registers under the name of a dead one takes its
  // place, and the dead one's job is free at once.
  const std::string name = absl::StrCat("local-", getpid(), "-", slot + 1);
  std::vector<std::string> arguments = {
      plan_.worker_executable, "--coordinator", address_.text,         "--name", name,
      "--exit-when-finished",  "--spool",       folder_->file("spool")};
  arguments.insert(arguments.end(), plan_.worker_arguments.begin(), plan_.worker_arguments.end());
  auto child = ChildProcess::start(
      arguments, folder_->file(absl::StrCat("worker-", slot + 1, ".log")), SIGKILL);
  if (!child.ok()) return child.status();
  workers_[slot] = std::make_unique<ChildProcess>(*std::move(child));
  return absl::OkStatus();
}

absl::Status LocalFarm::start_workers() {
  workers_.resize(plan_.workers);
  for (std::size_t slot = 0; slot < workers_.size(); ++slot) {
    if (auto status = start_worker(slot); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status LocalFarm::keep_alive(std::uint64_t jobs_settled) {
  if (const auto ending = coordinator_->ended()) {
    // It ends by itself only when it cannot go on (a full disk): then another one could not either.
    if (!absl::StartsWith(*ending, "killed") || ++coordinator_deaths_ > kCoordinatorDeaths) {
      return as_status(*ending, coordinator_->last_words());
    }
    if (auto status = start_coordinator(); !status.ok()) return status;
  }
  for (std::size_t slot = 0; slot < workers_.size(); ++slot) {
    const auto ending = workers_[slot]->ended();
    if (!ending || workers_[slot]->succeeded()) continue;
    if (*ending == "exit code 3") {  // set aside; the others go on
      const bool all = std::all_of(workers_.begin(), workers_.end(), [](const auto& worker) {
        return worker->ended() == "exit code 3";
      });
      if (!all) continue;
      return absl::AbortedError(last_message(workers_[slot]->last_words(), "irsig-worker"));
    }
    if (*ending == "exit code 2") {  // refused by the coordinator, as the next one would be
      return absl::FailedPreconditionError(
          last_message(workers_[slot]->last_words(), "irsig-worker"));
    }
    if (jobs_settled > settled_at_last_death_) deaths_without_progress_ = 0;
    settled_at_last_death_ = jobs_settled;
    if (++deaths_without_progress_ > kDeathsWithoutProgress) {
      return absl::AbortedError(
          absl::StrCat("workers keep dying (", *ending,
                       "): ", last_message(workers_[slot]->last_words(), "irsig-worker")));
    }
    if (auto status = start_worker(slot); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status LocalFarm::stop() {
  workers_.clear();  // killed: what they were computing is computed again by whoever resumes
  coordinator_->signal(SIGTERM);
  if (!coordinator_->wait(kCoordinatorStop_s)) {
    return absl::AbortedError(
        "the coordinator did not end; the database is complete, but its journal "
        "was not folded in");
  }
  if (!coordinator_->succeeded()) {
    return as_status(coordinator_->ended().value_or(""), coordinator_->last_words());
  }
  const std::string words = last_message(coordinator_->last_words(), "irsig-coordinator");
  if (words.starts_with(kWarning)) warning_ = words.substr(std::strlen(kWarning));
  return absl::OkStatus();
}

}  // namespace irsig
