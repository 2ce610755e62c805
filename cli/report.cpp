#include <cstdio>
#include <regex>
#include <string>

#include "cli/commands.h"
#include "view/print.h"

namespace irsig {
namespace {

// "sweep.toml:12:3: ...", as editors look for it.
bool begins_with_place(const std::string& text) {
  static const std::regex kPlace("[^:\n]+:[0-9]+:[0-9]+: ");
  return std::regex_search(text, kPlace, std::regex_constants::match_continuous);
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
