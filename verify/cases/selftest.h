#pragma once

#include <string>
#include <vector>

#include "verify/cases/hard_case.h"

namespace irsig {

// A case that has been run. It has passed only if it could be made, has checked something, and its
// worst error is a number within the bound.
struct CaseResult {
  HardCase hard_case;
  absl::StatusOr<Finding> finding;
  double seconds = 0;  // measured by the caller: core uses no clock

  [[nodiscard]] bool passed() const { return finding.ok() && finding->holds(); }
};

// Returns the cases whose "group/name" matches a pattern with * and ?; the pattern may also name
// the whole group or the case alone.
[[nodiscard]] std::vector<HardCase> matching(std::vector<HardCase> cases, const std::string& glob);

// Returns one line each, without a line feed. The table is for people: a failed case, and a case
// that could not be made, has the reason on a second line.
[[nodiscard]] std::string table_header();
[[nodiscard]] std::string table_row(const CaseResult& result);
[[nodiscard]] std::string csv_header();
[[nodiscard]] std::string csv_row(const CaseResult& result);

}  // namespace irsig
