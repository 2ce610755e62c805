#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/file_errors.h"

namespace irsig {

// A word of a text file and where it stands; empty text = there is none.
struct Token {
  std::string_view text;
  std::size_t line = 1, column = 1;
  explicit operator bool() const { return !text.empty(); }
};

// Walks over a text file word by word. Belongs to one thread; the text must outlive it.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  // Returns the next word of this line. A backslash at the end of a line continues it, and ends a
  // word.
  Token word_on_line();
  // Returns the next word, on whatever line.
  Token word();
  // Returns the rest of this line, without surrounding blanks.
  Token rest_of_line();
  // Moves behind the end of this line; false at the end of the file.
  bool next_line();

 private:
  void skip_blanks();
  bool at_continuation() const;
  // Returns true at the end of a line: LF, CR LF or CR alone.
  bool at_line_end() const {
    return at_ >= text_.size() || text_[at_] == '\n' ||
           (text_[at_] == '\r' && (at_ + 1 >= text_.size() || text_[at_ + 1] != '\n'));
  }

  std::string_view text_;
  std::size_t at_ = 0, line_start_ = 0, line_ = 1;
};

// Adds an error at a word's place.
inline void add_at(FileErrors& errors, const Token& where, std::string_view what) {
  errors.add(where.line, where.column, what);
}

// Returns the whole word as a number, or nothing if it is none or not representable. "nan" and
// "inf" are numbers here: the readers of coordinates refuse them with a message of their own.
[[nodiscard]] std::optional<double> number_of(std::string_view word);
[[nodiscard]] std::optional<std::int64_t> integer_of(std::string_view word);

[[nodiscard]] bool equals_ignoring_case(std::string_view a, std::string_view b);

}  // namespace irsig
