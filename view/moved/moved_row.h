#pragma once

#include "absl/status/statusor.h"
#include "schema/result.pb.h"
#include "schema/store/tables/rows.h"
#include "view/moved/arriving_reflected.h"
#include "view/moved/shape_change.h"
#include "view/moved/sight_line.h"

namespace irsig {

struct MovedRow {
  StoredSignature signature;
  schema::Spectrum spectrum;
  double range_bound_w_sr;  // part of apparent_numerical_error_w_sr: all that moving added to it
};

// Returns a stored row as seen from another range, by the formula and the errors of range_change.h.
//   from, to  lines of sight of the row at both ranges
//   spread    of these lines (arriving_reflected.h)
//   shape     changes by perspective
[[nodiscard]] absl::StatusOr<MovedRow> moved_row(const StoredSignature& row,
                                                 const schema::Spectrum& spectrum,
                                                 const SightLine& from, const SightLine& to,
                                                 const ReflectedSpread& spread,
                                                 const ShapeChange& shape);

}  // namespace irsig
