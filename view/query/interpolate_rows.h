#pragma once

#include <vector>

#include "view/query/query.h"

namespace irsig {

// The signatures of the same sweep, season, time, band and range, seen from one aspect.
struct SignatureField {
  std::vector<StoredSignature> signature;  // one for each direction
  SphereSamples samples;                   // of one quantity, in the same order
};

// Returns signatures sorted into fields, in order of appearance. Of viewpoints that share a
// direction (the zenith of a grid) only the first is used.
[[nodiscard]] std::vector<SignatureField> fields_of(
    const std::vector<StoredSignature>& signatures,
    SignatureQuantity quantity = SignatureQuantity::kIntensity);

// Interpolates one row for each field at an aspect.
[[nodiscard]] absl::StatusOr<std::vector<QueryRow>> interpolate_rows(
    const std::vector<StoredSignature>& signatures, SignatureFilter::Direction aspect);

[[nodiscard]] FieldKind kind_of(SignatureQuantity quantity);

// Estimates a quantity by a fit. Unless the field is signed, a value below 0 becomes 0 if no sample
// is negative, and the difference is added to the error.
[[nodiscard]] SphereEstimate estimate_of(FieldKind kind, const SphereFit& fit,
                                         const std::vector<double>& value,
                                         const std::vector<double>& value_stderr);

}  // namespace irsig
