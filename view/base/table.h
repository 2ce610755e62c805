#pragma once

#include <cstdint>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

// monostate: there is no such value in this row (printed as nothing, "-" or null).
using Cell = std::variant<std::monostate, std::string, double, std::uint64_t, bool>;

struct Column {
  std::string name;   // an identifier of the glossary, its unit is its suffix
  bool brief = true;  // shown to people; formats for machines have every column
};

// Writes rows as they arrive. finish() must be called once, after the last row; it fails if the
// stream has failed.
class TableWriter {
 public:
  virtual ~TableWriter() = default;
  virtual void row(const std::vector<Cell>& cells) = 0;
  virtual absl::Status finish() = 0;
};

// Creates a writer of tables. format:
//   "csv"   RFC 4180; each double has enough digits to give the same double back
//   "json"  an array of objects, with the same digits
//   "text"  for people: aligned, 6 digits, units in the header, no control characters
// CSV keeps every byte of a text, because a text is data. An apostrophe is put before a text that a
// spreadsheet would execute (core/base/formula.h).
[[nodiscard]] absl::StatusOr<std::unique_ptr<TableWriter>> make_table_writer(
    std::string_view format, const std::vector<Column>& columns, std::ostream& out);

}  // namespace irsig
