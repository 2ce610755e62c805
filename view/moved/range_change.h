#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "view/rows/query_row.h"

namespace irsig {

// Returns the extent of a target from its vertices in the body frame, whose origin is the reference
// point.
[[nodiscard]] TargetExtent target_extent(std::span<const Vec<Body>> vertex);

// Returns the largest relative change of a target's solid angle x range^2 when its sensor moves to
// another range on the same line. For a point at z towards the sensor, this product is proportional
// to (1 - z / range)^-2, with |z| <= reach.                            [1]
[[nodiscard]] double perspective_bound(double from_range_m, double to_range_m, double reach_m);

// Computes rows as seen from another range on the same aspect, without tracing. The environment of
// the stored sweep is evaluated at both ranges, and the mesh of the target is projected from both
// (silhouette.h):
//
//   I(R) = t [s I(R0) + sum over causes c of I_c (a_c(R) - s a_c(R0))] + A (g P(R) - t s P(R0))
//   C(R) = t [s C(R0) + the same sum] - A (g B(R) - t s B(R0))
//
// a_c is the arriving fraction of a cause, P the radiance of the path, A the stored projected area,
// s = transmittance(R) / transmittance(R0), and g, t the ratios of the silhouette's area and of the
// target's light (shape_change.h). B is the mean radiance behind the silhouette at each range: the
// fraction of the silhouette before each direction times the radiance that arrives from there. A
// farther sensor at the same aspect thus sees more sea behind a ship. A row at its own range keeps
// its values and errors.
//
// Standard errors are upper bounds: the errors of the causes are taken as fully correlated. The
// numerical error also includes:
//   - for unevenly bright parts, the relative change of their facets, and parts that become visible
//     (shape_change.h)
//   - fractions of the silhouette, by comparison with half as many rows
//   - the background between its directions
//   - for reflected sky and sea, the spread of the arriving fraction over directions, and its error
//     between elevations (arriving_reflected.h)
//   - the error of the formula without s at the stored range, scaled with the change of
//     transmittance
// Without the mesh (TargetExtent::shape is null) the perspective bound replaces g and t, and the
// whole silhouette may stand before sky or sea if the horizon is within the target's reach. Not
// covered: lobes narrower than the target as seen from either range.
//
// INVALID_ARGUMENT: a range (requested or stored) that is not positive, below 20 target lengths or
// beyond 1e9 m, or a line of sight that the environment does not have (environment.h).
// FAILED_PRECONDITION: a row of an older irsig or an earlier version of the sweep, whose air is not
// known. FAILED_PRECONDITION also: a target that the Earth partly hides (elevations below the
// horizontal), or that shows more than twice the area from one range than from the other.
//
// The air of a sweep's band is made once, for all rows.
class RangeChanger {
 public:
  // extent_of: needed as soon as a row is moved.
  RangeChanger(StoreReader& reader, std::vector<double> ranges_m, ExtentOf extent_of);
  ~RangeChanger();
  RangeChanger(const RangeChanger&) = delete;
  RangeChanger& operator=(const RangeChanger&) = delete;

  // Returns each row at each of the ranges, in the order of rows, then of ranges.
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
