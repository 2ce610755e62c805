#include "core/scene/import/import_text.h"

#include <algorithm>
#include <charconv>

namespace irsig {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

template <typename Number>
std::optional<Number> whole(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number value{};
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end || word.empty()) return std::nullopt;
  return value;
}

}  // namespace

bool TextCursor::at_continuation() const {
  if (at_ >= text_.size() || text_[at_] != '\\') return false;
  std::size_t after = at_ + 1;
  if (after + 1 < text_.size() && text_[after] == '\r' && text_[after + 1] == '\n') ++after;
  return after < text_.size() && (text_[after] == '\n' || text_[after] == '\r');
}

void TextCursor::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_blank(text_[at_]) && !at_line_end()) {
      ++at_;
      continue;
    }
    if (!at_continuation()) return;
    at_ += text_[at_ + 1] == '\r' && text_.substr(at_ + 2, 1) == "\n" ? 2 : 1;
    next_line();
  }
}

Token TextCursor::word_on_line() {
  skip_blanks();
  Token out{{}, line_, at_ - line_start_ + 1};
  const std::size_t start = at_;
  while (!at_line_end() && !is_blank(text_[at_]) && !at_continuation()) ++at_;
  out.text = text_.substr(start, at_ - start);
  return out;
}

Token TextCursor::word() {
  for (;;) {
    const Token out = word_on_line();
    if (out || !next_line()) return out;
  }
}

Token TextCursor::rest_of_line() {
  while (!at_line_end() && is_blank(text_[at_])) ++at_;
  Token out{{}, line_, at_ - line_start_ + 1};
  const std::size_t start = at_;
  while (!at_line_end()) ++at_;
  std::size_t end = at_;
  while (end > start && is_blank(text_[end - 1])) --end;
  out.text = text_.substr(start, end - start);
  return out;
}

bool TextCursor::next_line() {
  while (!at_line_end()) ++at_;
  if (at_ >= text_.size()) return false;
  line_start_ = ++at_;
  ++line_;
  return true;
}

std::optional<double> number_of(std::string_view word) { return whole<double>(word); }
std::optional<std::int64_t> integer_of(std::string_view word) { return whole<std::int64_t>(word); }

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace irsig
