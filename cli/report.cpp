#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

#include "cli/commands.h"
#include "view/print.h"

namespace irsig {
namespace {

// "sweep.toml:12:3: ...", as editors look for it.
bool begins_with_place(std::string_view text) {
  const std::size_t name = text.find_first_of(":\n");
  if (name == 0 || name == text.npos) return false;
  text.remove_prefix(name);
  for (int number = 0; number < 2; ++number) {
    if (!text.starts_with(':')) return false;
    const std::size_t end = std::min(text.find_first_not_of("0123456789", 1), text.size());
    if (end == 1) return false;
    text.remove_prefix(end);
  }
  return text.starts_with(": ");
}

}  // namespace

int report(const absl::Status& status) {
  if (status.ok()) return 0;
  std::fflush(stdout);
  const std::string text(status.message());
  print_note("{}{}\n", begins_with_place(text) ? "" : "irsig: ", text);
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
