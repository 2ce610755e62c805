#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "schema/store/rows.h"
#include "view/signature_quantity.h"

namespace irsig {

// One aspect under two conditions: b - a. The error takes the samples of both as independent and
// lets their bounds add up: where both come from the same paths (conditions of one view) it is too
// large rather than too small.
struct ComparedAspect {
  double aspect_azimuth_deg, aspect_elevation_deg;
  StoredValue a, b;
  double difference, difference_error;
  double sigmas;  // difference / difference_error; 0 if both are 0, infinite if only the error is
};

struct Comparison {
  std::vector<ComparedAspect> value;         // in the order of a
  std::size_t only_in_a = 0, only_in_b = 0;  // aspects that the other one does not have
};

// The aspects of values, sorted: what is one aspect to compare() has one key.
using AspectKey = std::pair<std::int64_t, std::int64_t>;
[[nodiscard]] std::vector<AspectKey> aspect_keys(std::span<const StoredValue> values);

// Aspects within 1e-6 deg are one. Values that were not computed are left out as if they were not
// there.
[[nodiscard]] Comparison compare(std::span<const StoredValue> a, std::span<const StoredValue> b);

// One line an aspect, in a format of table.h.
[[nodiscard]] absl::Status write_comparison(const Comparison& comparison,
                                            const QuantityColumns& quantity,
                                            std::string_view format, std::ostream& out);

}  // namespace irsig
