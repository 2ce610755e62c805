#pragma once

#include <google/protobuf/descriptor.h>

#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "jobs/text/section_check.h"

namespace irsig {

// The numbers that one key may have, limits included, whatever else the file says. What depends on
// other keys (the embedded atmosphere's weather, a wavelength inside its band) is checked where it
// is resolved.
struct NumberBounds {
  std::string_view key;  // "Viewpoints.range_m": message and field, in every table of that message
  double least, most;
  std::string_view reason;
};

// A row for each field of schema/sweep.proto, schema/goniometer.proto, schema/detector.proto,
// schema/imager.proto and (what a resolved sweep has of it) schema/job.proto that holds numbers,
// lists and maps of them included (tests/unit/number_bounds_test.cpp).
[[nodiscard]] std::span<const NumberBounds> number_bounds();

// Returns the bounds of a key such as "Viewpoints.range_m". The key must be in the table.
[[nodiscard]] const NumberBounds& bounds_of(std::string_view key);

// A limit as it is printed: six digits, or all of them where those are another number.
[[nodiscard]] std::string number_text(double value);

// "from 0.001 to 1e+09 (...)": how errors say it.
[[nodiscard]] std::string text_of(const NumberBounds& bounds);

// INVALID_ARGUMENT "<name> = <value>, expected a number from ..." for a number that stands
// elsewhere than in a file: on the command line.
[[nodiscard]] absl::Status check_number(std::string_view key, std::string_view name, double value);

// Every number in `message`, which stands at `path` ("" for the file itself), against its row.
void check_numbers(const google::protobuf::Message& message, const std::string& path,
                   Findings& findings);

}  // namespace irsig
