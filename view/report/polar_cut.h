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

// values: of one condition, band and range; none twice from one direction counts but the first.
// If eight of them stand on the elevation, they are the curve; otherwise it is interpolated every
// two degrees. Without elevation_deg: the lowest elevation that the viewpoints cover all around.
// OUT_OF_RANGE: no such elevation, or this one is not covered; INVALID_ARGUMENT: not between -90
// and 90; FAILED_PRECONDITION: an older irsig stored a value without the quantity.
[[nodiscard]] absl::StatusOr<PolarCut> polar_cut(std::span<const StoredValue> values,
                                                 const QuantityColumns& quantity,
                                                 std::optional<double> elevation_deg);

// Returns the values of signatures of one condition, band and range.
[[nodiscard]] std::vector<StoredValue> values_of(std::span<const StoredSignature> signatures,
                                                 const QuantityColumns& quantity);

}  // namespace irsig
