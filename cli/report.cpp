#include <cstdio>
#include <string>

#include "cli/commands.h"
#include "view/print.h"

namespace irsig {

int report(const absl::Status& status) {
  if (status.ok()) return 0;
  std::fflush(stdout);
  print_note("irsig: {}\n", std::string(status.message()));
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kOutOfRange:
      return 2;
    default:
      return 1;
  }
}

}  // namespace irsig
