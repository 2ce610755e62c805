#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// Format and destination of a command's answer: --format and --out, the same in every command. Each
// format has a short form of its own: --csv is --format csv.
class OutputOptions {
 public:
  // Adds the options. formats: formats of the command, the default one first. "text" is for people
  // and may also be called "table".
  OutputOptions(CLI::App& command, std::vector<std::string> formats);

  // Returns the option --out, for commands that need a file; "-" is not a file.
  [[nodiscard]] CLI::Option* out_option() const { return out_option_; }
  [[nodiscard]] const std::string& out() const { return out_; }

  // Returns the requested format, or the format that the file's name implies. INVALID_ARGUMENT:
  // both contradict each other, or the name's ending is not a format of this command.
  [[nodiscard]] absl::StatusOr<std::string> format() const;

  // Lets `write` fill the file, replaced when complete, or standard output: no --out, or "-".
  [[nodiscard]] absl::Status write(
      const std::function<absl::Status(std::string_view format, std::ostream&)>& write) const;
  [[nodiscard]] absl::Status write(std::string_view bytes) const;

 private:
  std::vector<std::string> formats_;
  std::string asked_, out_;
  CLI::Option* out_option_;
};

}  // namespace irsig
