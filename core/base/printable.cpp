#include "core/base/printable.h"

#include <cstdint>

#include "absl/strings/str_cat.h"

namespace irsig {
namespace {

std::string replaced(std::string_view text, std::string_view kept) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Utf8Character character = first_utf8(text);
    const std::size_t length = character.length == 0 ? 1 : character.length;
    const bool harmless = character.length > 0 && (!is_control(character.code) ||
                                                   kept.find(text[0]) != std::string_view::npos);
    if (harmless)
      out += text.substr(0, length);
    else
      out += '?';
    text.remove_prefix(length);
  }
  return out;
}

}  // namespace

Utf8Character first_utf8(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  };
  const std::uint8_t lead = byte(0);
  if (text.empty()) return {0, 0};
  if (lead < 0x80) return {1, lead};
  const std::size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4) return {0, 0};
  char32_t code = lead & (0xffU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return {0, 0};
    code = code << 6U | (byte(i) & 0x3fU);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < kLeast[length] || code > 0x10ffff || surrogate) return {0, 0};
  return {length, code};
}

std::string one_line(std::string_view text) { return replaced(text, {}); }

std::string printable(std::string_view text) { return replaced(text, "\n\t"); }

bool is_one_line(std::string_view text) {
  while (!text.empty()) {
    const Utf8Character character = first_utf8(text);
    if (character.length == 0 || is_control(character.code)) return false;
    text.remove_prefix(character.length);
  }
  return true;
}

std::string json_string(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const Utf8Character character = first_utf8(text);
    const std::size_t length = character.length == 0 ? 1 : character.length;
    if (character.length == 0) {
      out += "\\ufffd";
    } else if (is_control(character.code)) {
      out += absl::StrCat("\\u",
                          absl::Hex(static_cast<std::uint32_t>(character.code), absl::kZeroPad4));
    } else {
      if (text[0] == '"' || text[0] == '\\') out += '\\';
      out += text.substr(0, length);
    }
    text.remove_prefix(length);
  }
  return out + "\"";
}

}  // namespace irsig
