#include "core/scene/import/import_json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "fmt/format.h"

namespace irsig {
namespace {

constexpr int kDeepest = 100;

void append_utf8(std::uint32_t code, std::string& out) {
  const auto add = [&](std::uint32_t byte) { out += static_cast<char>(byte); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xc0 | code >> 6);
    add(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    add(0xe0 | code >> 12);
    add(0x80 | (code >> 6 & 0x3f));
    add(0x80 | (code & 0x3f));
  } else {
    add(0xf0 | code >> 18);
    add(0x80 | (code >> 12 & 0x3f));
    add(0x80 | (code >> 6 & 0x3f));
    add(0x80 | (code & 0x3f));
  }
}

class JsonParser {
 public:
  JsonParser(std::string_view text, const std::string& file_name)
      : text_(text), file_name_(file_name) {
    if (text_.starts_with("\xef\xbb\xbf")) at_ = 3;
  }

  absl::StatusOr<JsonValue> parse() {
    JsonValue value = read(0);
    skip_blanks();
    // Some writers fill the end of a chunk with zeros in place of blanks.
    while (at_ < text_.size() && text_[at_] == '\0') ++at_;
    if (problem_.empty() && at_ < text_.size()) fail("the end of the file");
    if (problem_.empty()) return value;
    const std::string_view before = text_.substr(0, std::min(problem_at_, text_.size()));
    const std::size_t line = 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
    const std::size_t newline = before.rfind('\n');
    const std::size_t column = newline == before.npos ? before.size() + 1 : before.size() - newline;
    return absl::InvalidArgumentError(
        fmt::format("{}:{}:{}: {}", file_name_, line, column, problem_));
  }

 private:
  void fail(std::string_view expected) {
    if (!problem_.empty()) return;
    problem_at_ = at_;
    problem_ = at_ < text_.size() ? fmt::format("this is no JSON, expected {}", expected)
                                  : fmt::format("the JSON text ends here, expected {}", expected);
  }

  void skip_blanks() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r'))
      ++at_;
  }

  bool take(char c) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  bool take_word(std::string_view word) {
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  JsonValue read(int depth) {
    JsonValue out;
    skip_blanks();
    out.begin = at_;
    const char c = at_ < text_.size() ? text_[at_] : '\0';
    if (depth > kDeepest) {
      fail(fmt::format("values that are nested at most {} deep", kDeepest));
    } else if (c == '{') {
      read_object(depth, out);
    } else if (c == '[') {
      read_array(depth, out);
    } else if (c == '"') {
      out.kind = JsonValue::Kind::kString;
      out.text = read_string();
    } else if (take_word("true")) {
      out.kind = JsonValue::Kind::kBool;
      out.boolean = true;
    } else if (take_word("false")) {
      out.kind = JsonValue::Kind::kBool;
    } else if (!take_word("null")) {
      read_number(out);
    }
    out.end = at_;
    return out;
  }

  void read_object(int depth, JsonValue& out) {
    out.kind = JsonValue::Kind::kObject;
    ++at_;
    if (take('}')) return;
    do {
      skip_blanks();
      if (at_ >= text_.size() || text_[at_] != '"') return fail("a name in quotes");
      std::string name = read_string();
      if (problem_.empty() && !take(':')) fail("\":\"");
      if (!problem_.empty()) return;
      out.member.push_back({std::move(name), read(depth + 1)});
    } while (problem_.empty() && take(','));
    if (problem_.empty() && !take('}')) fail("\",\" or \"}\"");
  }

  void read_array(int depth, JsonValue& out) {
    out.kind = JsonValue::Kind::kArray;
    ++at_;
    if (take(']')) return;
    do out.item.push_back(read(depth + 1));
    while (problem_.empty() && take(','));
    if (problem_.empty() && !take(']')) fail("\",\" or \"]\"");
  }

  void read_number(JsonValue& out) {
    out.kind = JsonValue::Kind::kNumber;
    const char c = at_ < text_.size() ? text_[at_] : '\0';
    if (c != '-' && (c < '0' || c > '9')) return fail("a value");
    const std::size_t digit = at_ + (c == '-' ? 1 : 0);
    if (digit + 1 < text_.size() && text_[digit] == '0' && text_[digit + 1] >= '0' &&
        text_[digit + 1] <= '9')
      return fail("a number without zeros in front");
    const auto [stop, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), out.number);
    // A number below the least of a double is 0 to it, one above the largest is none.
    if (error == std::errc::result_out_of_range)
      out.number = std::strtod(std::string(text_.data() + at_, stop).c_str(), nullptr);
    if (error == std::errc::invalid_argument || !std::isfinite(out.number))
      return fail("a number that a double can hold");
    at_ = static_cast<std::size_t>(stop - text_.data());
  }

  std::uint32_t read_hex() {
    std::uint32_t code = 0;
    const std::string_view digits = text_.substr(std::min(at_, text_.size()), 4);
    const auto [stop, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (digits.size() < 4 || error != std::errc() || stop != digits.data() + 4) {
      fail("four hexadecimal digits");
      return 0;
    }
    at_ += 4;
    return code;
  }

  std::string read_string() {
    std::string out;
    ++at_;
    while (problem_.empty()) {
      const char c = at_ < text_.size() ? text_[at_] : '\0';
      if (at_ >= text_.size() || static_cast<unsigned char>(c) < 0x20) {
        fail("the rest of a text, in quotes on one line");
        break;
      }
      ++at_;
      if (c == '"') break;
      if (c != '\\') {
        out += c;
        continue;
      }
      const char escape = at_ < text_.size() ? text_[at_++] : '\0';
      constexpr std::string_view kNames = "\"\\/bfnrt", kMeant = "\"\\/\b\f\n\r\t";
      if (const std::size_t which = kNames.find(escape); escape != '\0' && which != kNames.npos) {
        out += kMeant[which];
      } else if (escape == 'u') {
        std::uint32_t code = read_hex();
        if (code >= 0xd800 && code < 0xdc00 && take_word("\\u")) {
          const std::uint32_t low = read_hex();
          if (low < 0xdc00 || low > 0xdfff) fail("the second half of a character");
          code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        }
        if (code >= 0xd800 && code < 0xe000) code = 0xfffd;
        append_utf8(code, out);
      } else {
        fail("an escaped character");
      }
    }
    return out;
  }

  std::string_view text_;
  const std::string& file_name_;
  std::size_t at_ = 0, problem_at_ = 0;
  std::string problem_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view name) const {
  for (const auto& [key, value] : member)
    if (key == name) return value.kind == Kind::kNull ? nullptr : &value;
  return nullptr;
}

absl::StatusOr<JsonValue> parse_json(std::string_view text, const std::string& file_name) {
  return JsonParser(text, file_name).parse();
}

}  // namespace irsig
