#pragma once

#include <string>

#include "absl/status/status.h"
#include "core/signature/profile.h"
#include "core/signature/simulator.h"

namespace irsig {

// Checks that a view's numbers may be stored. INTERNAL, with every reason found:
//   - the core dropped path weights that were not finite or negative; the rest would be silently
//     too small
//   - a number is not finite (an apparent temperature is NaN where no blackbody has the radiance,
//     such as a negative one)
//   - a transmittance lies outside 0 to 1
//   - an intensity, area or picture is negative by more than its own error; contrast may have any
//     sign
// Two findings are no errors: facets met from behind, which the result counts, and paths cut off
// after the last reflection, which the result bounds.
[[nodiscard]] absl::Status check_numbers(const ViewResult& view);

// Like check_numbers(view), for a profile; each reason begins with the profile's name.
[[nodiscard]] absl::Status check_numbers(const std::string& name, const ProfileResult& profile);

}  // namespace irsig
