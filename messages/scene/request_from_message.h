#pragma once

#include "absl/status/statusor.h"
#include "core/signature/view/request.h"
#include "schema/sweep.pb.h"

namespace irsig {

// The effects that a sweep chooses. INVALID_ARGUMENT "effects...": a name that is none of them.
[[nodiscard]] absl::StatusOr<EffectChoice> effects_from_message(const schema::Effects& effects);

// INVALID_ARGUMENT: nothing but a time budget, which pilots turn into samples before jobs are run.
[[nodiscard]] absl::StatusOr<AccuracySpec> accuracy_from_message(const schema::Accuracy& accuracy);

// INVALID_ARGUMENT "image...": a kind or a layer that there is not, pixels or points that are no
// numbers of them.
[[nodiscard]] absl::StatusOr<ImageSpec> image_from_message(const schema::Image& image);

}  // namespace irsig
