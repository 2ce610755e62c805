#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// A process that ends with its parent, even if the parent is killed. Its output goes to a file.
// Start it from the main thread: the kernel ties it to the thread, not to the process. One object
// belongs to one thread.
class ChildProcess {
 public:
  // Starts a process. death_signal: the signal that the process receives when its parent dies.
  static absl::StatusOr<ChildProcess> start(const std::vector<std::string>& arguments,
                                            const std::string& log_path, int death_signal);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ~ChildProcess();  // kills what still runs

  // Returns how the process ended ("killed by signal 9", "exit code 1"); nullopt while it runs.
  [[nodiscard]] std::optional<std::string> ended();
  [[nodiscard]] bool succeeded() const { return exit_code_ == 0; }
  // Returns the exit code of a process that ended by itself; nullopt while the process runs, or if
  // a signal killed it.
  [[nodiscard]] std::optional<int> exit_code() const { return exit_code_; }
  void signal(int number) const;
  // Waits at most `seconds` for the process to end, then kills it. Returns true if it ended by
  // itself.
  bool wait(double seconds);

  [[nodiscard]] pid_t pid() const { return pid_; }
  // Returns the last lines of the process's output.
  [[nodiscard]] std::string last_words() const;

 private:
  ChildProcess() = default;
  ChildProcess(pid_t pid, std::string log_path) : pid_(pid), log_path_(std::move(log_path)) {}
  pid_t pid_ = -1;  // -1: moved from
  std::string log_path_;
  bool running_ = true;
  std::optional<int> exit_code_;
  std::string end_;
};

// Returns the last message that a program of ours printed under its own name, without the lines of
// its log.
[[nodiscard]] std::string last_message(const std::string& words, const std::string& program);

}  // namespace irsig
