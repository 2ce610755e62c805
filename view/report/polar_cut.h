#pragma once

#include <optional>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/tables/rows.h"
#include "view/rows/signature_quantity.h"

namespace irsig {

struct PolarPoint {
  double azimuth_deg, value, error;  // of the quantity; one sigma, interpolation included
  double input = 0;                  // one sigma of uncertain inputs; 0: none is known
};

// Values of one quantity all around a target at one elevation.
struct PolarCut {
  double elevation_deg = 0;
  bool interpolated = false;
  std::vector<PolarPoint> point;  // increasing azimuth: the curve
  std::vector<PolarPoint> mark;   // stored viewpoints on the elevation, or near it
};

// Largest distance of a marked viewpoint from an interpolated ring.
inline constexpr double kNearRingDeg = 2.5;

// Returns the values around a target at one elevation. values: of one condition, band and range; of
// several values from one direction, the first is used. If eight values lie on the elevation, they
// form the curve; otherwise the curve is interpolated every two degrees. Without elevation_deg: the
// lowest elevation that the viewpoints cover all around. OUT_OF_RANGE: there is no such elevation,
// or the requested one is not covered. INVALID_ARGUMENT: the elevation is not between -90 and 90
// deg. FAILED_PRECONDITION: an older irsig stored a value without the quantity.
[[nodiscard]] absl::StatusOr<PolarCut> polar_cut(std::span<const StoredValue> values,
                                                 const QuantityColumns& quantity,
                                                 std::optional<double> elevation_deg);

// Returns the values of signatures of one condition, band and range.
[[nodiscard]] std::vector<StoredValue> values_of(std::span<const StoredSignature> signatures,
                                                 const QuantityColumns& quantity);

}  // namespace irsig
