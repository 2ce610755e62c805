#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/problems.h"
#include "schema/job.pb.h"
#include "schema/sweep.pb.h"

namespace irsig {

// A parsed sweep file. `where` gives file:line:column of each key by its path: "part[1].material",
// "season[0].part_temperature_k.hull", and of each table: "part[1]", "season[0].surroundings".
struct SweepFile {
  schema::Sweep sweep;
  std::map<std::string, std::string> where;
  std::string file_name;
  // Names in messages of seasons that are made from other tables: "condition[3]"
  // (condition_table.h).
  std::map<std::string, std::string> written_as;
  // Text of the files that [air] and [[season]] name, by the path of the key (read_weather_files).
  std::map<std::string, std::string> content;

  // Returns "file:line:column" of a path, or of its nearest enclosing table; line 1 if there is
  // none.
  [[nodiscard]] std::string location(std::string_view path) const;
  [[nodiscard]] std::string as_written(const std::string& message) const;
};

// Returns the same problems, each with the place of its key in the file. Other codes than
// INVALID_ARGUMENT are returned as they are.
[[nodiscard]] absl::Status located(const SweepFile& file, const absl::Status& status);

// Reads a sweep from TOML, by protobuf reflection. INVALID_ARGUMENT, one error a line, each
// file:line:column with the problem and the expected value. A syntax error is reported alone; a key
// given twice and more than 32 levels of tables are syntax errors. Otherwise every unknown key,
// wrong type, nan and inf is reported.
[[nodiscard]] absl::StatusOr<SweepFile> parse_sweep(std::string_view text,
                                                    std::string_view file_name);

// Like parse_sweep(), for a message of another grammar: fills it, and `file.where` (file.file_name
// must be set).
[[nodiscard]] absl::Status fill_from_toml(std::string_view text, SweepFile& file,
                                          google::protobuf::Message& message);

}  // namespace irsig
