#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/query/query.h"

namespace irsig {

// Adds --season to a command that chooses what is stored. It may be repeated: what belongs to any
// of the seasons is chosen.
CLI::Option* add_seasons(CLI::App& command, std::vector<std::string>& season);

// The options by which query, export and plot choose signatures: the same names and meaning
// everywhere.
class FilterOptions {
 public:
  // Adds DB and the options to a subcommand; the object must outlive the parse.
  explicit FilterOptions(CLI::App& command);

  // Adds --range-m, for commands that can show rows as seen from other ranges.
  void add_ranges(CLI::App& command);

  [[nodiscard]] const std::string& database() const { return database_; }
  [[nodiscard]] absl::StatusOr<Query> query() const;
  // Returns the options that select signatures as written on the command line; empty: none were
  // given.
  [[nodiscard]] std::string text() const;

 private:
  const CLI::App* command_;
  std::string database_;
  Query query_;
  std::vector<std::string> season_;
  std::string aspect_, quantity_ = "intensity";
  double within_deg_ = 0, max_relative_error_ = 0;
  std::uint64_t row_ = 0;
  CLI::Option *aspect_option_, *nearest_option_, *within_option_, *row_option_, *error_option_;
};

}  // namespace irsig
