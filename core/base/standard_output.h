#pragma once

#include "absl/status/status.h"

namespace irsig {

// Hands what standard output still holds to the system. UNAVAILABLE: that, or something that was
// printed before, could not be written (a full disk, a closed pipe). The last thing that a program
// which prints does: a C++ program alone ends with exit code 0 then.
[[nodiscard]] absl::Status end_standard_output();

}  // namespace irsig
