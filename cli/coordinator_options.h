#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "coordinator/client/address.h"

namespace irsig {

// --coordinator and the options of the connection; shared by every command that asks a coordinator.
class CoordinatorOptions {
 public:
  explicit CoordinatorOptions(CLI::App& command) {
    command.add_option("--coordinator", text_, "unix:PATH or HOST:PORT")->required();
    add_network_options(command, network_);
  }
  // CLI11 keeps pointers into it.
  CoordinatorOptions(const CoordinatorOptions&) = delete;
  CoordinatorOptions& operator=(const CoordinatorOptions&) = delete;

  [[nodiscard]] absl::StatusOr<Address> address() const { return parse_address(text_, network_); }

 private:
  std::string text_;
  NetworkOptions network_;
};

}  // namespace irsig
