#include "coordinator/client/local_farm.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "coordinator/client/authority.h"
#include "coordinator/client/farm_client.h"
#include "coordinator/client/local_crew.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr int kCoordinatorDeaths = 5;
constexpr double kCoordinatorStart_s = 600;  // a large journal is recovered before
constexpr std::size_t kLongestFolder = 80;   // the path of a Unix socket has at most 107 letters
constexpr double kCoordinatorStop_s = 60;    // the checkpoint of a large journal
constexpr double kCertificates_s = 366 * 86400.0;

namespace fs = std::filesystem;

constexpr const char* kWarning = "warning: ";

// Our executables end with 2 when what they were given is wrong.
absl::Status end_of(ChildProcess& coordinator) {
  const std::string ending = coordinator.ended().value_or("still running"),
                    words = coordinator.last_words();
  const std::string message =
      words.empty() ? "the coordinator ended: " + ending : last_message(words, "irsig-coordinator");
  return coordinator.exit_code() == 2 ? absl::InvalidArgumentError(message)
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
  // Nodes see the database's folder, or they could not see any.
  ASSIGN_OR_RETURN(farm->folder_,
                   plan.slurm
                       ? ScratchFolder::make_in(fs::absolute(plan.db_path).parent_path().string())
                       : ScratchFolder::make(kLongestFolder));
  if (plan.slurm) {
    RETURN_IF_ERROR(farm->make_certificates());
  } else {
    ASSIGN_OR_RETURN(farm->address_, parse_address("unix:" + farm->folder_->file("farm")));
  }
  RETURN_IF_ERROR(farm->start_coordinator());
  RETURN_IF_ERROR(farm->make_crew());
  return farm;
}

LocalFarm::~LocalFarm() {
  if (coordinator_ && !coordinator_->ended()) (void)stop();
}

// For this run alone: they go with its folder.
absl::Status LocalFarm::make_certificates() {
  if (plan_.slurm->host.empty()) {
    char name[256] = "localhost";
    gethostname(name, sizeof(name) - 1);
    plan_.slurm->host = name;
  }
  const std::string tls = folder_->file("tls");
  const double now =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  RETURN_IF_ERROR(make_authority(tls, "irsig run", now, kCertificates_s + 86400));
  for (const CertificateWish& wish : {CertificateWish{"coordinator", {plan_.slurm->host}, {}},
                                      CertificateWish{"worker", {}, {Role::kWork}},
                                      CertificateWish{"user", {}, {Role::kSubmit, Role::kRead}}})
    RETURN_IF_ERROR(issue_certificate(tls, wish, tls, now, kCertificates_s));
  ASSIGN_OR_RETURN(address_, parse_address(plan_.slurm->host + ":0", {tls_files("user")}));
  return absl::OkStatus();
}

TlsFiles LocalFarm::tls_files(const std::string& name) const {
  const std::string tls = folder_->file("tls");
  return {absl::StrCat(tls, "/", name, ".pem"), absl::StrCat(tls, "/", name, ".key"),
          tls + "/ca.pem"};
}

absl::Status LocalFarm::make_crew() {
  std::vector<std::string> command = {
      plan_.worker_executable, "--coordinator", address_.text,
      "--exit-when-finished",  "--spool",       folder_->file("spool")};
  if (plan_.slurm) {
    const TlsFiles tls = tls_files("worker");
    command.insert(command.end(),
                   {"--tls-cert", tls.certificate, "--tls-key", tls.key, "--tls-ca", tls.ca});
  }
  command.insert(command.end(), plan_.worker_arguments.begin(), plan_.worker_arguments.end());
  if (!plan_.slurm) {
    crew_ = std::make_unique<LocalCrew>(plan_.workers, std::move(command), folder_->path());
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(
      crew_, SlurmCrew::make(*plan_.slurm, plan_.workers, std::move(command), folder_->path()));
  return absl::OkStatus();
}

absl::StatusOr<bool> LocalFarm::answers(const std::string& log) {
  if (!plan_.slurm)
    return ::access(address_.unix_path.c_str(), F_OK) == 0 && farm_status(address_, 5).ok();
  // The port, once the first one has chosen it, stays: workers come back to it.
  std::ifstream file(log);
  std::string line;
  constexpr std::string_view kListening = "irsig-coordinator: listening on ";
  while (std::getline(file, line)) {
    if (!line.starts_with(kListening) || file.eof()) continue;
    ASSIGN_OR_RETURN(address_, parse_address(line.substr(kListening.size()), {tls_files("user")}));
    return farm_status(address_, 5).ok();
  }
  return false;
}

absl::Status LocalFarm::start_coordinator() {
  const std::string log = folder_->file(absl::StrCat("coordinator-", coordinator_deaths_, ".log"));
  std::vector<std::string> command = {plan_.coordinator_executable,
                                      "--db",
                                      plan_.db_path,
                                      "--listen",
                                      address_.text,
                                      "--remove-unused"};
  if (plan_.slurm) {
    const TlsFiles tls = tls_files("coordinator");
    command.insert(command.end(),
                   {"--tls-cert", tls.certificate, "--tls-key", tls.key, "--tls-ca", tls.ca});
  }
  ASSIGN_OR_RETURN(auto child, ChildProcess::start(command, log, SIGTERM));
  coordinator_ = std::make_unique<ChildProcess>(std::move(child));
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(kCoordinatorStart_s);
  while (std::chrono::steady_clock::now() < deadline) {
    if (coordinator_->ended()) return end_of(*coordinator_);
    ASSIGN_OR_RETURN(const auto there, answers(log));
    if (there) return absl::OkStatus();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return absl::UnavailableError(absl::StrCat("the coordinator did not answer within ",
                                             kCoordinatorStart_s,
                                             " s: ", coordinator_->last_words()));
}

absl::Status LocalFarm::start_workers() { return crew_->start(); }

absl::Status LocalFarm::keep_alive(std::uint64_t jobs_settled) {
  if (coordinator_->ended()) {
    // It ends by itself only when it cannot go on (a full disk): then another one could not either.
    if (coordinator_->exit_code() || ++coordinator_deaths_ > kCoordinatorDeaths)
      return end_of(*coordinator_);
    RETURN_IF_ERROR(start_coordinator());
  }
  return crew_->keep_alive(jobs_settled);
}

absl::Status LocalFarm::stop() {
  if (crew_) crew_->stop();  // what they were computing is computed again by whoever resumes
  coordinator_->signal(SIGTERM);
  if (!coordinator_->wait(kCoordinatorStop_s)) {
    return absl::AbortedError(
        "the coordinator did not end; the database is complete, but its journal "
        "was not folded in");
  }
  if (!coordinator_->succeeded()) {
    return end_of(*coordinator_);
  }
  const std::string words = last_message(coordinator_->last_words(), "irsig-coordinator");
  if (words.starts_with(kWarning)) warning_ = words.substr(std::strlen(kWarning));
  return absl::OkStatus();
}

}  // namespace irsig
