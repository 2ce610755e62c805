#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "view/query/interpolate_rows.h"

namespace irsig {

// Finds the directions in which interpolation between viewpoints is too uncertain, and the
// viewpoints that would mend it.

// Errors are shares of the value beside them; of a quantity that may be below zero, of the rms of
// its field.

// A viewpoint as the others of its field have it.
struct LeftOutViewpoint {
  std::size_t sample;         // of the field
  double value;               // left out
  double interpolated;        // from the others
  double error;               // one sigma that this states, with the standard errors of both
  double relative_deviation;  // |interpolated - value|, as a share
};
// Viewpoints that the others surround; the outermost are left out of it.
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
  std::size_t above_before, above_after, directions;  // of these, how many exceed what is asked
};

// Viewpoints to add until interpolation states at most `relative_error` everywhere between the
// viewpoints (not beyond them), in all fields, or `most` are found: the worst directions first,
// those that lie apart at once, and then anew as if they were known. fields: of one quantity, with
// the same viewpoints. Standard errors of the viewpoints' own are no part of it: more viewpoints
// are not for them. Directions are looked at in a golden-angle order, so that what is proposed for
// a ring does not share the ring's phase. FAILED_PRECONDITION: too few viewpoints to interpolate at
// all.
[[nodiscard]] absl::StatusOr<Refinement> refine(std::span<const SignatureField> fields,
                                                FieldKind kind, double relative_error,
                                                std::size_t most);

}  // namespace irsig
