#include "coordinator/client/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {
constexpr std::streamoff kLastWordsBytes = 2000;
}

absl::StatusOr<ChildProcess> ChildProcess::start(const std::vector<std::string>& arguments,
                                                 const std::string& log_path, int death_signal) {
  // Everything that allocates comes before fork(): between fork and exec a process with threads may
  // only make system calls.
  std::vector<char*> argv;
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const int log = open(log_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (log < 0) {
    return absl::InternalError(absl::StrCat("cannot write ", log_path, ": ", std::strerror(errno)));
  }
  if (access(argv[0], X_OK) != 0) {
    close(log);
    return absl::InternalError(absl::StrCat("cannot start ", arguments[0], ": ",
                                            std::strerror(errno),
                                            " (it belongs beside the irsig executable)"));
  }
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) {
    close(log);
    return absl::InternalError(absl::StrCat("cannot start a process: ", std::strerror(errno)));
  }
  if (pid == 0) {
    prctl(PR_SET_PDEATHSIG, death_signal);
    if (getppid() != parent) _exit(1);  // it died before prctl
    setpgid(0, 0);                      // Ctrl-C at the terminal reaches the parent alone
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    execv(argv[0], argv.data());
    _exit(127);
  }
  close(log);
  return ChildProcess(pid, log_path);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept { *this = std::move(other); }

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  std::swap(pid_, other.pid_);
  std::swap(log_path_, other.log_path_);
  std::swap(running_, other.running_);
  std::swap(exit_code_, other.exit_code_);
  std::swap(end_, other.end_);
  return *this;
}

ChildProcess::~ChildProcess() {
  if (pid_ > 0 && running_) wait(0);
}

std::optional<std::string> ChildProcess::ended() {
  if (pid_ <= 0) return "never started";
  if (!running_) return end_;
  int status = 0;
  const pid_t got = waitpid(pid_, &status, WNOHANG);
  if (got == 0 || (got < 0 && errno == EINTR)) return std::nullopt;
  running_ = false;
  if (got == pid_ && WIFEXITED(status)) exit_code_ = WEXITSTATUS(status);
  end_ = WIFSIGNALED(status) ? absl::StrCat("killed by signal ", WTERMSIG(status))
                             : absl::StrCat("exit code ", WEXITSTATUS(status));
  return end_;
}

void ChildProcess::signal(int number) const {
  if (pid_ > 0 && running_) kill(pid_, number);
}

bool ChildProcess::wait(double seconds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!ended()) {
    if (std::chrono::steady_clock::now() >= deadline) {
      signal(SIGKILL);
      while (!ended()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

std::string ChildProcess::last_words() const {
  std::ifstream log(log_path_, std::ios::binary | std::ios::ate);
  if (!log) return "";
  const auto size = static_cast<std::streamoff>(log.tellg());
  const auto length = std::min(size, kLastWordsBytes);
  log.seekg(size - length);
  std::string text(static_cast<std::size_t>(length), '\0');
  log.read(text.data(), length);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string last_message(const std::string& words, const std::string& program) {
  const std::string mark = program + ": ";
  const auto at = words.rfind("\n" + mark);
  if (at != std::string::npos) return words.substr(at + 1 + mark.size());
  return words.starts_with(mark) ? words.substr(mark.size()) : words;
}

}  // namespace irsig
