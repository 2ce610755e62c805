#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace irsig {

// A cell of a line, without the white space around it, and where it stands (from 1).
struct CsvCell {
  std::string_view text;
  std::size_t line, column;
};

// Walks over the lines of a CSV file ("\n", "\r\n" or "\r", cells between commas, with or without
// double quotes around a cell; no quote within one). The text must outlive it.
class CsvRows {
 public:
  explicit CsvRows(std::string_view text) : text_(text) {}

  // Moves to the next line that is neither empty nor a remark ('#'). Returns false at the end of
  // the text.
  bool next();
  // Moves to the next line that is not empty, remarks included.
  bool next_with_remarks();
  [[nodiscard]] std::string_view whole() const { return whole_; }
  [[nodiscard]] std::size_t line() const { return line_; }
  // The cells of the current line, valid until the next call of cells(), next() or
  // next_with_remarks().
  [[nodiscard]] const std::vector<CsvCell>& cells();

 private:
  std::string_view text_, whole_;
  std::size_t line_ = 0;
  std::vector<CsvCell> cell_;
};

// Returns the whole text as a finite number, or nothing if it is none.
[[nodiscard]] std::optional<double> finite_number(std::string_view text);

}  // namespace irsig
