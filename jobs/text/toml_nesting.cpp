#include "jobs/text/toml_nesting.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/problems.h"

namespace irsig {
namespace {

constexpr int kMostLevels = 32;

// Walks over the text as the parser does: what it takes for a string or a comment is one there too,
// up to the first mistake in the text, where the parser stops.
class Walker {
 public:
  explicit Walker(std::string_view text) : text_(text) {}

  // Why the text is refused, empty if it is not; `at` is the place.
  std::string_view walk() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '"' || c == '\'') {
        skip_string(c);
        continue;
      }
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size());
        continue;
      }
      if (c == '.' && ++dots_ >= kMostLevels) return "a key of more than 32 parts";
      if ((c == '[' || c == '{') && ++brackets_ > kMostLevels)
        return "more than 32 tables or arrays in each other";
      if (c == ']' || c == '}') brackets_ = std::max(brackets_ - 1, 0);
      // A dot belongs to the key (or the number) around it: blanks may stand there, nothing else.
      if (std::string_view("\n=,[]{}").find(c) != std::string_view::npos) dots_ = 0;
      ++at_;
    }
    return {};
  }

  [[nodiscard]] std::size_t at() const { return at_; }

 private:
  // Behind a string. One of one line ends with its line, where the parser reports it.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool of_lines = text_.substr(at_, 3) == three;
    at_ += of_lines ? 3 : 1;
    while (at_ < text_.size()) {
      if (quote == '"' && text_[at_] == '\\') {
        at_ = std::min(at_ + 2, text_.size());
      } else if (of_lines && text_.substr(at_, 3) == three) {
        at_ += 3;
        // Up to two quotes before the three that end it are its own.
        for (int i = 0; i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
        return;
      } else if (!of_lines && (text_[at_] == quote || text_[at_] == '\n')) {
        if (text_[at_] == quote) ++at_;
        return;
      } else {
        ++at_;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int dots_ = 0, brackets_ = 0;
};

}  // namespace

absl::Status check_toml_nesting(std::string_view text, std::string_view file_name) {
  Walker walker(text);
  const std::string_view wrong = walker.walk();
  if (wrong.empty()) return absl::OkStatus();
  const std::string_view before = text.substr(0, walker.at());
  const std::size_t line_start = before.find_last_of('\n') + 1;  // npos + 1 is 0
  // Columns count characters, as the parser's do: not the bytes that continue one in UTF-8.
  const auto column = std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_start),
                                    before.end(), [](char c) { return (c & 0xc0) != 0x80; });
  return placed_problem(
      absl::StrCat(std::string(file_name), ":", std::count(before.begin(), before.end(), '\n') + 1,
                   ":", column + 1),
      absl::StrCat(std::string(wrong), ", expected the keys of a sweep file"));
}

}  // namespace irsig
