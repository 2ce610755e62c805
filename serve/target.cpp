#include "serve/target.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace irsig {
namespace {

std::optional<std::string> decoded(std::string_view text, bool plus_is_space = true) {
  std::string out;
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] != '%') {
      out += plus_is_space && text[k] == '+' ? ' ' : text[k];
      continue;
    }
    const std::string_view digits = text.substr(k + 1, 2);
    unsigned char byte = 0;
    const char* const end = digits.data() + digits.size();
    if (digits.size() != 2 || std::from_chars(digits.data(), end, byte, 16).ptr != end)
      return std::nullopt;
    out += static_cast<char>(byte);
    k += 2;
  }
  return out;
}

}  // namespace

absl::StatusOr<RequestTarget> parse_target(std::string_view target) {
  const absl::Status damaged =
      absl::InvalidArgumentError("the address has a % that no two hexadecimal digits follow");
  const std::size_t question = target.find('?');
  const auto path = decoded(target.substr(0, question), false);
  if (!path) return damaged;
  RequestTarget out{*path, {}};
  if (question == std::string_view::npos) return out;
  for (std::string_view left = target.substr(question + 1); !left.empty();) {
    const std::string_view one = left.substr(0, left.find('&'));
    left.remove_prefix(std::min(one.size() + 1, left.size()));
    if (one.empty()) continue;
    const std::size_t equals = one.find('=');
    const auto name = decoded(one.substr(0, equals));
    const auto value =
        decoded(equals == std::string_view::npos ? std::string_view() : one.substr(equals + 1));
    if (!name || !value) return damaged;
    out.parameters.emplace(*name, *value);
  }
  return out;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned char different = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    different = static_cast<unsigned char>(different | (a[k] ^ b[k]));
  return different == 0;
}

}  // namespace irsig
