#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/query/interpolate_rows.h"

namespace irsig {

// Finds the directions in which interpolation between viewpoints is too uncertain, and the
// viewpoints that would correct it.

// Errors are fractions of the value beside them; for a quantity that may be negative, of the rms of
// its field.

// A viewpoint, and its value interpolated from the other viewpoints of its field.
struct LeftOutViewpoint {
  std::size_t sample;         // of the field
  double value;               // left out
  double interpolated;        // from the others
  double error;               // one sigma that this states, with the standard errors of both
  double relative_deviation;  // |interpolated - value|, as a share
};
// Viewpoints that others surround; the outermost ones are excluded.
[[nodiscard]] absl::StatusOr<std::vector<LeftOutViewpoint>> leave_one_out(
    const SignatureField& field, FieldKind kind);

struct ProposedViewpoint {
  double azimuth_deg, elevation_deg;  // to 0.01 deg
  double relative_error;              // that interpolation states there, the largest of all fields
  std::size_t field;                  // which one's
};
struct Refinement {
  std::vector<ProposedViewpoint> add;
  double largest_before, largest_after;  // relative error of interpolation, over all directions
  std::size_t above_before, above_after, directions;  // above: the requested error
};

// Finds viewpoints to add until interpolation states at most `relative_error` everywhere between
// the viewpoints (not beyond them) in all fields, or `most` are found. The worst directions come
// first; directions far apart are added together, and the next search treats them as known. fields:
// of one quantity, with the same viewpoints. The viewpoints' own standard errors are excluded,
// because more viewpoints do not reduce them. Directions are examined in a golden-angle order, so
// that viewpoints proposed for a ring do not share the ring's phase. FAILED_PRECONDITION: too few
// viewpoints to interpolate.
[[nodiscard]] absl::StatusOr<Refinement> refine(std::span<const SignatureField> fields,
                                                FieldKind kind, double relative_error,
                                                std::size_t most);

}  // namespace irsig
