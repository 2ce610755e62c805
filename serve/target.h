#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "serve/question.h"

namespace irsig {

// The path and the parameters of a request's target, percent-decoded.
struct RequestTarget {
  std::string path;
  Parameters parameters;
};

// Parses "/path?name=value&name=value" (RFC 3986; "+" in values is a space). INVALID_ARGUMENT: a
// "%" that no two hexadecimal digits follow.
[[nodiscard]] absl::StatusOr<RequestTarget> parse_target(std::string_view target);

// Compares in a time that depends on the lengths alone.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

}  // namespace irsig
