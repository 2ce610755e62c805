#pragma once

#include "absl/status/statusor.h"
#include "core/signature/view/request.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Converts the effects that a sweep selects. INVALID_ARGUMENT "effects...": an unknown name.
[[nodiscard]] absl::StatusOr<EffectChoice> effects_from_message(const schema::Effects& effects);

// Converts the accuracy. INVALID_ARGUMENT: only a time budget is given, which pilots convert to
// samples before jobs run.
[[nodiscard]] absl::StatusOr<AccuracySpec> accuracy_from_message(const schema::Accuracy& accuracy);

// Converts the request for an image. INVALID_ARGUMENT "image...": an unknown kind or layer, or
// invalid numbers of pixels or points.
[[nodiscard]] absl::StatusOr<ImageSpec> image_from_message(const schema::Image& image);

}  // namespace irsig
