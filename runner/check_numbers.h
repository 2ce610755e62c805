#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/signature/profile.h"
#include "core/signature/simulator.h"

namespace irsig {

// OK if a view's numbers may be stored. INTERNAL, naming each reason, if the core had to drop path
// weights that were not finite or negative (the rest would be silently too small), if a number is
// not finite (an apparent temperature is NaN where no blackbody has the radiance, a negative one
// among them), if a transmittance lies outside 0 to 1, or if an intensity, area or picture is
// negative by more than its own error; contrast has any sign. Facets met from behind and paths cut
// off after the last reflection are no reason: the first are counted in the result, the second
// bounded by it.
[[nodiscard]] absl::Status check_numbers(const ViewResult& view);

// Like check_numbers(view), for a profile; each reason begins with the profile's name.
[[nodiscard]] absl::Status check_numbers(const std::string& name, const ProfileResult& profile);

}  // namespace irsig
