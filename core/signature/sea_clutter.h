#pragma once

#include "absl/status/status.h"
#include "core/signature/measured_view.h"
#include "core/signature/view/request.h"
#include "core/signature/view/result.h"

namespace irsig {

// Sensors must stand so far above the target's horizontal, as a sine, for the sea behind the target
// to be one place with one angle.
inline constexpr double kLeastSineAboveSea = 0.01;

// Adds SignatureResult::clutter to the rows of a view over a rough sea: the statistics of what its
// waves emit and mirror next to the target, from their slopes' spectrum
// (core/environment/sea/sea_texture.h). Rows without such a sea, of targets in the air, or
// whose sensor stands lower, keep none. Numerical errors 3 %; the sea's own spectrum and form
// (foam, swell, shadows of waves) are not in them. INVALID_ARGUMENT as Environment::view() has it.
[[nodiscard]] absl::Status add_sea_clutter(const MeasuredView& view, const ViewRequest& request,
                                           ViewResult& result);

}  // namespace irsig
