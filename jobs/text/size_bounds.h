#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "jobs/keys/size_limits.h"
#include "jobs/text/section_check.h"

namespace irsig {

// Largest length of one list, map or text of a sweep, in elements or bytes; it applies to the file
// and to the resolved sweep, wherever the message occurs.
struct SizeBound {
  std::string_view key;  // "Sweep.part": message and field
  std::size_t most;
};

// Returns a row for each list and map of schema/sweep.proto and schema/job.proto that a sweep has,
// and for each text that may be longer than a name (tests/unit/size_bounds_test.cpp).
[[nodiscard]] std::span<const SizeBound> size_bounds();

// Checks every list, map and text in `message` against its row. path: place of the message in the
// file; "" for the file itself.
void check_sizes(const google::protobuf::Message& message, const std::string& path,
                 Findings& findings);

// Checks the numbers of viewpoints x conditions x bands, and of rows of profiles. Lists must be
// within their bounds.
void check_row_count(const schema::ResolvedSweep& sweep, Findings& findings);

}  // namespace irsig
