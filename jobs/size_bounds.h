#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "jobs/section_check.h"

namespace irsig {

// Largest length of one list, map or text of a sweep, in elements or bytes: of the file and of the
// resolved sweep, wherever the message stands.
struct SizeBound {
  std::string_view key;  // "Sweep.part": message and field
  std::size_t most;
};

// A row for each list and map of schema/sweep.proto and schema/job.proto that a sweep has, and for
// each text that may be longer than a name (tests/unit/size_bounds_test.cpp).
[[nodiscard]] std::span<const SizeBound> size_bounds();

// Every other text.
inline constexpr std::size_t kLongestName = 1000;

// Limits of one sweep in all: rows = viewpoints x conditions x bands, jobs, and rows of profiles
// under each signature.
inline constexpr double kMostRows = 1e8;
inline constexpr double kMostJobs = 2e6;
inline constexpr double kMostProfileRows = 1e6;

// Every list, map and text in `message`, which stands at `path` ("" for the file itself).
void check_sizes(const google::protobuf::Message& message, const std::string& path,
                 Findings& findings);

// Viewpoints x conditions x bands, and rows of profiles. Lists are within their bounds.
void check_row_count(const schema::ResolvedSweep& sweep, Findings& findings);

}  // namespace irsig
