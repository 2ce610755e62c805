#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/rows/interpolate.h"

namespace irsig {

struct TargetShape;

// Extent of a target, and its triangles (silhouette.h).
struct TargetExtent {
  double length_m;  // longest side of its bounding box, along the axes of the body
  double reach_m;   // from the reference point to its farthest point
  // Null: unknown. Then rows at another range have the widest bounds that the reach allows.
  std::shared_ptr<const TargetShape> shape{};
};
using ExtentOf = std::function<absl::StatusOr<TargetExtent>(const StoredSweep&)>;

// Origin of an interpolated row.
struct Interpolation {
  SphereFit fit;
  std::vector<StoredSignature> from;  // in the order of fit.used()
  double interpolation_error_w_sr;    // part of numerical_error_w_sr
};

// Origin of a row that was moved to another range (range_change.h).
struct RangeChange {
  double stored_range_m;
  double range_bound_w_sr;  // part of apparent_numerical_error_w_sr
  std::shared_ptr<const schema::Spectrum> spectrum;
};

struct QueryRow {
  // Interpolated rows: row and signature_id are 0; fields that do not depend on the aspect are
  // those of the nearest viewpoint; numerical errors include the interpolation error.
  StoredSignature signature;
  std::optional<Interpolation> interpolation;
  std::optional<RangeChange> range_change{};
};

}  // namespace irsig
