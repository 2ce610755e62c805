#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "schema/store/tables/rows.h"
#include "view/query/query.h"
#include "view/rows/signature_quantity.h"

namespace irsig {

// One aspect under two conditions: b - a. The error takes the samples of both as independent and
// adds their bounds. If both come from the same paths (conditions of one view), it is too large
// rather than too small.
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

// Key of an aspect for sorting; values that compare() treats as one aspect share a key.
using AspectKey = std::pair<std::int64_t, std::int64_t>;
[[nodiscard]] std::vector<AspectKey> aspect_keys(std::span<const StoredValue> values);

// Compares values by aspect; aspects within 1e-6 deg are equal. Values that were not computed are
// left out.
[[nodiscard]] Comparison compare(std::span<const StoredValue> a, std::span<const StoredValue> b);

// Writes one line per aspect, in a format of table.h.
[[nodiscard]] absl::Status write_comparison(const Comparison& comparison,
                                            const QuantityColumns& quantity,
                                            std::string_view format, std::ostream& out);

// Checks that two bands have the same limits and the same response; their steps change no value of
// the band. FAILED_PRECONDITION: the bands differ, so that the difference of their values is not
// one of the same quantity.
[[nodiscard]] absl::Status check_same_band(const schema::Band& a, const schema::Band& b);

// Names in which two rows may differ and still be compared. With a free season, times are times of
// day.
struct FreeNames {
  bool season = false, time = false, band = false;
};
struct ComparedRow {
  StoredSignature a, b;
  ComparedAspect value;
};
struct RowComparison {
  std::vector<ComparedRow> row;  // in the order of a
  std::size_t only_in_a = 0, only_in_b = 0;
};
// Pairs rows of the same season, time, band, aspect and range. INVALID_ARGUMENT: several rows of
// one side have the same ones. NOT_FOUND: no row has a partner.
[[nodiscard]] absl::StatusOr<RowComparison> compare_rows(const std::vector<QueryRow>& a,
                                                         const std::vector<QueryRow>& b,
                                                         const FreeNames& free,
                                                         SignatureQuantity quantity);

// Writes one line per row, in a format of table.h. Column `exceeds_error`: the difference is larger
// than its error.
[[nodiscard]] absl::Status write_compared_rows(const RowComparison& comparison,
                                               const QuantityColumns& quantity,
                                               std::string_view format, std::ostream& out);

}  // namespace irsig
