// Libraries that damaged files crash run in a process of their own (docs/decisions/0021).
#include "core/base/run_subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace irsig {
namespace {

absl::Status cannot(const std::string& what, int error) {
  return absl::InternalError(absl::StrCat("cannot ", what, ": ", std::strerror(error)));
}

// Ends of a two-way connection. No other process that is started meanwhile inherits them.
class Connection {
 public:
  Connection() {
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, end_) != 0) error_ = errno;
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    close_end(0);
    close_end(1);
  }
  [[nodiscard]] int error() const { return error_; }
  [[nodiscard]] int ours() const { return end_[0]; }
  [[nodiscard]] int theirs() const { return end_[1]; }
  void close_theirs() { close_end(1); }

 private:
  void close_end(int i) {
    if (end_[i] >= 0) ::close(end_[i]);
    end_[i] = -1;
  }
  int end_[2] = {-1, -1};
  int error_ = 0;
};

// posix_spawn and not fork: gRPC's threads may hold any lock at this moment. The connection becomes
// standard input and output; what a dying library prints is nobody's.
absl::StatusOr<pid_t> start(const std::string& program, const std::vector<std::string>& arguments,
                            int connection) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, connection, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, connection, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // The signals that the limits end it with must neither be blocked nor ignored.
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_t pid = -1;
  const int error = posix_spawn(&pid, program.c_str(), &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    return absl::InternalError(absl::StrCat("cannot start ", program, ": ", std::strerror(error),
                                            " (it belongs beside the irsig executable)"));
  return pid;
}

// Sends the file and takes what comes, up to the end or to more bytes than a process of that memory
// can mean. Both at once: the other process may do anything, as to answer before it has read. An
// end before all is sent is no error here: how it ended says more. MSG_NOSIGNAL: or its death would
// be ours, by SIGPIPE.
std::string exchange(int with, std::string_view bytes, std::uint64_t most_bytes) {
  std::string out;
  std::string step(1 << 16, '\0');
  bool sending = true;
  while (out.size() <= most_bytes) {
    if (sending && bytes.empty()) {
      ::shutdown(with, SHUT_WR);
      sending = false;
    }
    pollfd ready{with, static_cast<short>(sending ? POLLIN | POLLOUT : POLLIN), 0};
    if (::poll(&ready, 1, -1) < 0) {
      if (errno == EINTR) continue;
      break;
    }
    if ((ready.revents & POLLOUT) != 0 && sending) {
      const ssize_t sent = ::send(with, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
      if (sent < 0 && errno != EINTR && errno != EAGAIN) sending = false;
    }
    if ((ready.revents & ~POLLOUT) != 0) {
      const ssize_t got = ::recv(with, step.data(), step.size(), MSG_DONTWAIT);
      if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (got <= 0) break;
      out.append(step, 0, static_cast<std::size_t>(got));
    }
  }
  return out;
}

// Returns the status by waitpid; -1 if it cannot be known.
int end_of(pid_t pid) {
  int status = 0;
  pid_t ended = -1;
  do ended = ::waitpid(pid, &status, 0);
  while (ended < 0 && errno == EINTR);
  return ended == pid ? status : -1;
}

absl::Status why_it_ended(int status, const ApartLimits& limits) {
  const std::string damaged = "the file is damaged, or made to do harm";
  if (status < 0) return absl::InternalError("the importer's end is unknown");
  if (!WIFSIGNALED(status)) {
    if (WEXITSTATUS(status) == 0) return absl::InternalError("the importer said nothing");
    return absl::InvalidArgumentError(
        absl::StrCat("importing it failed (exit code ", WEXITSTATUS(status), "): ", damaged));
  }
  switch (const int signal = WTERMSIG(status); signal) {
    case SIGXCPU:
      return absl::InvalidArgumentError(absl::StrCat("importing it takes more than ", limits.cpu_s,
                                                     " s of the processor: ", damaged));
    case SIGALRM:
      return absl::InvalidArgumentError(
          absl::StrCat("importing it takes longer than ", limits.wall_s, " s: ", damaged));
    case SIGABRT:
    case SIGBUS:
    case SIGFPE:
    case SIGILL:
    case SIGSEGV:
    case SIGSYS:
    case SIGTRAP:
      return absl::InvalidArgumentError(
          absl::StrCat("the program that reads it crashed on it (signal ", signal, "): ", damaged));
    default:  // from outside
      return absl::InternalError(absl::StrCat("the importer was killed by signal ", signal));
  }
}

}  // namespace

ApartLimits apart_limits(std::uint64_t file_bytes) {
  const std::uint64_t megabytes = file_bytes / 1'000'000;
  return {(std::uint64_t{1} << 30) + 64 * file_bytes, 30 + 10 * megabytes, 300 + 100 * megabytes};
}

std::string program_beside(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? name : (self.parent_path() / name).string();
}

absl::StatusOr<std::string> run_subprocess(const std::string& program,
                                           const std::vector<std::string>& arguments,
                                           std::string_view bytes, const ApartLimits& limits) {
  Connection connection;
  if (connection.error() != 0) return cannot("connect to the importer", connection.error());
  ASSIGN_OR_RETURN(const pid_t pid, start(program, arguments, connection.theirs()));
  connection.close_theirs();
  std::string reply = exchange(connection.ours(), bytes, limits.memory_bytes);
  if (reply.size() > limits.memory_bytes) ::kill(pid, SIGABRT);
  const int end = end_of(pid);
  if (end != 0 || reply.empty()) return why_it_ended(end, limits);
  return reply;
}

}  // namespace irsig
