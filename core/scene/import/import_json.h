#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

struct JsonMember;

// A JSON value (RFC 8259) and where its text stands.
struct JsonValue {
  enum class Kind : std::uint8_t { kNull, kBool, kNumber, kString, kArray, kObject };
  Kind kind = Kind::kNull;
  bool boolean = false;
  double number = 0;
  std::string text;                // of a string, without its escapes
  std::vector<JsonValue> item;     // of an array
  std::vector<JsonMember> member;  // of an object, in the file's order
  std::size_t begin = 0, end = 0;  // bytes of the text, quotes included

  // Returns the member of an object; null where there is none, or the value is no object. A member
  // whose value is null counts as absent.
  [[nodiscard]] const JsonValue* find(std::string_view name) const;
};

// A member of an object. (No pair: Clang wants its types complete.)
struct JsonMember {
  std::string name;
  JsonValue value;
};

// Parses a whole text. INVALID_ARGUMENT with file:line:column: no JSON, or nested deeper than 100
// values. A byte order mark in front is skipped.
[[nodiscard]] absl::StatusOr<JsonValue> parse_json(std::string_view text,
                                                   const std::string& file_name);

}  // namespace irsig
