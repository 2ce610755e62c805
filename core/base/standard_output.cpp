#include "core/base/standard_output.h"

#include <cstdio>
#include <iostream>

namespace irsig {

absl::Status end_standard_output() {
  const bool streamed = static_cast<bool>(std::cout.flush());
  const bool printed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (streamed && printed) return absl::OkStatus();
  return absl::UnavailableError("cannot write to standard output (disk full or closed pipe?)");
}

}  // namespace irsig
