#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "view/query.h"

namespace irsig {

// Of a target's vertices in the body frame, whose origin is the reference point.
[[nodiscard]] TargetExtent target_extent(std::span<const Vec<Body>> vertex);

// The largest relative change of what a target subtends when its sensor moves from one range to
// another on the same line: of a point that lies z towards the sensor, range^2 x solid angle goes
// as (1 - z / range)^-2, with |z| <= reach.                            [1]
[[nodiscard]] double perspective_bound(double from_range_m, double to_range_m, double reach_m);

// Rows as they would be seen from another range on the same aspect, without tracing. The source
// intensity by cause stays; what of each cause arrives, the radiance of the air and the background
// come from the environment of the stored sweep, evaluated anew at both ranges:
//
//   I(R) = s I(R0) + sum over causes c of I_c (a_c(R) - s a_c(R0)) + A (P(R) - s P(R0))
//
// with a_c the share of a cause that arrives, P the path's radiance, A the projected area and
// s = transmittance(R) / transmittance(R0); so a row at its own range stays what it was.
// Contrast and background alike, with the background along the line of sight in place of P.
//
// Standard errors are upper bounds: the causes' errors are taken as fully correlated. To the
// numerical error are added: the perspective bound; for reflected sky and sea, how far the
// directions differ in what of them arrives, and by how much that may be off between elevations
// (arriving_reflected.h); what the formula without s misses at the stored range,
// as far as the transmittance changes. Not covered: parts of the target that come into view or go
// out of it, and lobes narrower than the target is seen from either range.
//
// INVALID_ARGUMENT: a range that is not positive, below 20 target lengths (asked for or stored) or
// beyond 1e9 m, a line of sight that the environment does not have (environment.h);
// FAILED_PRECONDITION: a row that an older irsig or an earlier version of the sweep left, whose air
// is not known.
//
// The air of a sweep's band is made once, for all rows: what many rows are moved with, some at a
// time.
class RangeChanger {
 public:
  // extent_of: needed as soon as a row is moved.
  RangeChanger(StoreReader& reader, std::vector<double> ranges_m, ExtentOf extent_of);
  ~RangeChanger();
  RangeChanger(const RangeChanger&) = delete;
  RangeChanger& operator=(const RangeChanger&) = delete;

  // Each row at each of the ranges, in the order of rows, then of ranges.
  [[nodiscard]] absl::StatusOr<std::vector<QueryRow>> moved(const std::vector<QueryRow>& rows);

 private:
  struct Air;
  absl::StatusOr<Air*> air_of(const StoredSignature& any);
  StoreReader& reader_;
  std::vector<double> ranges_m_;
  ExtentOf extent_of_;
  std::map<std::pair<std::string, std::string>, std::unique_ptr<Air>> air_;  // sweep, band
};

}  // namespace irsig
