#include "coordinator/client/slurm_crew.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "coordinator/client/child_process.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

constexpr double kAnswer_s = 120;       // of a busy controller
constexpr double kBetweenLooks_s = 10;  // it is a service for many

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// In PATH; empty: there is none.
std::string program(const std::string& name) {
  const char* path = std::getenv("PATH");
  for (const absl::string_view folder : absl::StrSplit(path == nullptr ? "" : path, ':')) {
    const std::string file = absl::StrCat(folder, "/", name);
    if (!folder.empty() && access(file.c_str(), X_OK) == 0) return file;
  }
  return "";
}

std::string quoted(const std::string& word) {
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

}  // namespace

absl::StatusOr<std::unique_ptr<SlurmCrew>> SlurmCrew::make(const SlurmPlan& plan,
                                                           std::uint32_t workers,
                                                           std::vector<std::string> command,
                                                           std::string folder) {
  std::unique_ptr<SlurmCrew> out(new SlurmCrew);
  out->plan_ = plan;
  out->workers_ = workers;
  out->command_ = std::move(command);
  out->folder_ = std::move(folder);
  for (const auto& [file, name] : {std::pair{&out->sbatch_, "sbatch"},
                                   {&out->squeue_, "squeue"},
                                   {&out->scancel_, "scancel"}}) {
    *file = program(name);
    if (file->empty())
      return absl::InvalidArgumentError(
          absl::StrCat("--launcher slurm: there is no ", name, " here (in PATH)"));
  }
  return out;
}

absl::StatusOr<std::string> SlurmCrew::run(const std::vector<std::string>& arguments,
                                           const char* name) {
  const std::string log = absl::StrCat(folder_, "/", name, "-", ++runs_, ".log");
  ASSIGN_OR_RETURN(auto child, ChildProcess::start(arguments, log, SIGTERM));
  const bool ended = child.wait(kAnswer_s);
  std::ifstream file(log);
  std::stringstream text;
  text << file.rdbuf();
  std::error_code ignored;
  std::filesystem::remove(log, ignored);
  if (ended && child.succeeded()) return text.str();
  return absl::UnavailableError(absl::StrCat(
      name, ended ? " failed: " : " does not answer: ", absl::StripAsciiWhitespace(text.str())));
}

// A time limit and a preemption send TERM first, to the script: its worker finishes its jobs.
absl::Status SlurmCrew::write_script() const {
  std::ofstream file(folder_ + "/worker.sh");
  file << "#!/bin/sh\n"
          "asked=\n"
          "trap 'asked=yes; kill -TERM $worker 2> /dev/null' TERM\n"
          "worker=\n";
  for (const std::string& word : command_) file << quoted(word) << ' ';
  file << "--name \"slurm-$SLURM_ARRAY_JOB_ID-$SLURM_ARRAY_TASK_ID\" --threads \"${1:-1}\" &\n"
          "worker=$!\n"
          "code=0\n"
          "wait \"$worker\" || code=$?\n"
          "while kill -0 \"$worker\" 2> /dev/null; do wait \"$worker\" || code=$?; done\n"
          "[ -n \"$asked\" ] && exit 0\n"
          "exit \"$code\"\n";
  file.close();
  return file ? absl::OkStatus()
              : absl::UnavailableError(absl::StrCat("cannot write ", folder_, "/worker.sh"));
}

absl::Status SlurmCrew::hand_in() {
  std::vector<std::string> sbatch = {
      sbatch_, "--parsable", "--requeue", "--job-name=irsig", "--signal=B:TERM@60",
      "--open-mode=append", absl::StrCat("--array=1-", plan_.nodes > 0 ? plan_.nodes : workers_),
      // A percent sign of the folder's own is doubled.
      absl::StrCat("--output=", absl::StrReplaceAll(folder_, {{"%", "%%"}}), "/worker-%a.log")};
  if (plan_.nodes > 0)
    sbatch.insert(sbatch.end(), {"--nodes=1", "--exclusive"});
  else
    sbatch.insert(sbatch.end(), {"--ntasks=1", "--cpus-per-task=1"});
  if (!plan_.partition.empty()) sbatch.push_back("--partition=" + plan_.partition);
  if (!plan_.time_limit.empty()) sbatch.push_back("--time=" + plan_.time_limit);
  sbatch.insert(sbatch.end(), plan_.options.begin(), plan_.options.end());
  sbatch.push_back("--wrap");
  sbatch.push_back(absl::StrCat("exec sh ", quoted(folder_ + "/worker.sh"),
                                plan_.nodes > 0 ? " \"$SLURM_CPUS_ON_NODE\"" : ""));
  ASSIGN_OR_RETURN(const auto said, run(sbatch, "sbatch"));
  // "NUMBER" or "NUMBER;CLUSTER", after whatever the site's plugins have to say.
  const std::vector<std::string> lines = absl::StrSplit(absl::StripAsciiWhitespace(said), '\n');
  job_ = std::vector<std::string>(absl::StrSplit(lines.back(), ';')).front();
  if (job_.empty() || job_.find_first_not_of("0123456789") != std::string::npos)
    return absl::UnavailableError(absl::StrCat("sbatch printed no job number: ", said));
  next_look_s_ = now_s() + kBetweenLooks_s;
  return absl::OkStatus();
}

absl::Status SlurmCrew::start() {
  RETURN_IF_ERROR(write_script());
  return hand_in();
}

absl::Status SlurmCrew::keep_alive(std::uint64_t jobs_settled) {
  if (now_s() < next_look_s_) return absl::OkStatus();
  next_look_s_ = now_s() + kBetweenLooks_s;
  // All of this user's: asked for one that it has forgotten, squeue fails as it does without a
  // controller.
  const auto queue = run({squeue_, "--noheader", "--me", "--format=%F"}, "squeue");
  if (!queue.ok()) return absl::OkStatus();  // a controller that is away comes back
  for (const absl::string_view array : absl::StrSplit(*queue, '\n'))
    if (absl::StripAsciiWhitespace(array) == job_) return absl::OkStatus();
  std::string words = last_words();
  if (words.empty()) words = absl::StrCat("they wrote nothing; do the nodes see ", folder_, "?");
  if (deaths_.too_many(jobs_settled))
    return absl::AbortedError(
        absl::StrCat("Slurm's workers keep ending without a job done: ", words));
  if (plan_.say)
    plan_.say(
        absl::StrCat("Slurm's job ", job_,
                     " has left the queue with work still to do, it is handed in again: ", words));
  return hand_in();
}

std::string SlurmCrew::last_words() const {
  std::ifstream log(folder_ + "/worker-1.log");
  std::stringstream words;
  words << log.rdbuf();
  const std::string text = words.str();
  return text.substr(text.size() > 2000 ? text.size() - 2000 : 0);
}

void SlurmCrew::stop() {
  if (!job_.empty()) (void)run({scancel_, job_}, "scancel");
  job_.clear();
}

}  // namespace irsig
