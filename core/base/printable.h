#pragma once

#include <string>
#include <string_view>

namespace irsig {

// Text of others - names in a database, messages of a client, bytes of a file - may hold characters
// that a terminal obeys: C0 (escape sequences), DEL, C1. What is printed goes through one of these
// first, and what is kept as a name is asked.

// Returns the text as one line, with "?" for each control character and each byte that is not
// UTF-8.
[[nodiscard]] std::string one_line(std::string_view text);

// Like one_line(), for text of several lines: "\n" and "\t" stay.
[[nodiscard]] std::string printable(std::string_view text);

// Returns true if one_line() would leave the text unchanged.
[[nodiscard]] bool is_one_line(std::string_view text);

// Returns the text as a JSON string with its quotes: plain ASCII for every control character,
// U+FFFD for each byte that is not UTF-8.
[[nodiscard]] std::string json_string(std::string_view text);

// The length of the UTF-8 character at the beginning of `text`, 0 if there is none (overlong forms
// and surrogates are none), and its code point.
struct Utf8Character {
  std::size_t length;
  char32_t code;
};
[[nodiscard]] Utf8Character first_utf8(std::string_view text);

// Returns true for a control character: C0, DEL or C1.
[[nodiscard]] constexpr bool is_control(char32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

}  // namespace irsig
