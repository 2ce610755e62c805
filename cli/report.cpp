#include <cstdio>
#include <string>

#include "cli/commands.h"
#include "core/base/problems.h"
#include "view/base/print.h"

namespace irsig {

int report(const absl::Status& status) {
  if (status.ok()) return 0;
  std::fflush(stdout);
  // "sweep.toml:12:3: ...", as editors look for it.
  print_note("{}{}\n", begins_with_place(status) ? "" : "irsig: ", std::string(status.message()));
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
      return 2;
    default:
      return 1;
  }
}

}  // namespace irsig
