#pragma once

#include <google/protobuf/descriptor.h>

#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "jobs/text/section_check.h"

namespace irsig {

// The range of numbers that one key may have, limits included, whatever the other keys are. Limits
// that depend on other keys (the embedded atmosphere's weather, a wavelength inside its band) are
// checked where these are resolved.
struct NumberBounds {
  std::string_view key;  // "Viewpoints.range_m": message and field, in every table of that message
  double least, most;
  std::string_view reason;
};

// Returns a row for each numeric field of schema/sweep.proto, schema/goniometer.proto,
// schema/detector.proto, schema/imager.proto and (as far as a resolved sweep has its fields)
// schema/job.proto, including lists and maps of numbers (tests/unit/number_bounds_test.cpp).
[[nodiscard]] std::span<const NumberBounds> number_bounds();

// Returns the bounds of a key such as "Viewpoints.range_m". The key must be in the table.
[[nodiscard]] const NumberBounds& bounds_of(std::string_view key);

// Formats a limit with six digits, or with all digits where six would give another number.
[[nodiscard]] std::string number_text(double value);

// Returns the bounds as error messages state them: "from 0.001 to 1e+09 (...)".
[[nodiscard]] std::string text_of(const NumberBounds& bounds);

// Checks a number that is not in a file but on the command line. INVALID_ARGUMENT: "<name> =
// <value>, expected a number from ...".
[[nodiscard]] absl::Status check_number(std::string_view key, std::string_view name, double value);

// Checks every number in `message` against its row. path: place of the message in the file; "" for
// the file itself.
void check_numbers(const google::protobuf::Message& message, const std::string& path,
                   Findings& findings);

}  // namespace irsig
