#include "core/materials/optical/text_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "core/base/printable.h"
#include "core/base/problems.h"

namespace irsig {
namespace {

constexpr std::size_t kMostReported = 10;

struct Field {
  std::string_view text;
  int column;
};

bool is_space(char c) { return c == ' ' || c == '\t'; }

// White space around a field is no part of it.
Field trimmed(std::string_view line, std::size_t begin, std::size_t end) {
  while (begin < end && is_space(line[begin])) ++begin;
  while (end > begin && is_space(line[end - 1])) --end;
  return {line.substr(begin, end - begin), static_cast<int>(begin) + 1};
}

std::vector<Field> fields_of(std::string_view line, char separator) {
  std::vector<Field> fields;
  if (separator != ' ') {
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= line.size(); ++i) {
      if (i < line.size() && line[i] != separator) continue;
      fields.push_back(trimmed(line, begin, i));
      begin = i + 1;
    }
    // Spreadsheets end each row with the separators of empty columns.
    while (fields.size() > 1 && fields.back().text.empty()) fields.pop_back();
    return fields;
  }
  for (std::size_t i = 0; i < line.size();) {
    if (is_space(line[i])) {
      ++i;
      continue;
    }
    const std::size_t begin = i;
    while (i < line.size() && !is_space(line[i])) ++i;
    fields.push_back({line.substr(begin, i - begin), static_cast<int>(begin) + 1});
  }
  return fields;
}

// Returns the separator of a line of names: a comma, or else a semicolon or a tab.
char separator_of(std::string_view line) {
  for (const char separator : {',', ';', '\t'})
    if (line.find(separator) != std::string_view::npos) return separator;
  return ',';
}

// Text of a file in a message: one line, and no longer than people read.
std::string quoted(std::string_view text) {
  return absl::StrCat("\"", one_line(text.substr(0, 40)), text.size() > 40 ? "..." : "", "\"");
}

std::string column_name(std::string_view text) {
  const std::string plain = absl::StrReplaceAll(
      std::string(text), {{"\u00b5m", "um"}, {"\u03bcm", "um"}, {"%", " percent "}, {"\"", ""}});
  std::string name;
  for (const char c : absl::AsciiStrToLower(plain)) {
    if (absl::ascii_isalnum(static_cast<unsigned char>(c)))
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name;
}

}  // namespace

void TableErrors::add(int line, int column, const std::string& what) {
  found_.push_back({line, column, one_line(what)});  // it may quote the file
}

absl::Status TableErrors::status() const {
  if (found_.empty()) return absl::OkStatus();
  std::vector<Found> in_order = found_;
  std::stable_sort(in_order.begin(), in_order.end(), [](const Found& a, const Found& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  std::vector<Problem> problems;
  const std::size_t shown = std::min(in_order.size(), kMostReported);
  for (std::size_t i = 0; i < shown; ++i)
    problems.push_back({absl::StrCat(file_name_, ":", in_order[i].line, ":", in_order[i].column),
                        "", in_order[i].what});
  if (in_order.size() > shown)
    problems.push_back(
        {"", "", absl::StrCat(file_name_, ": and ", in_order.size() - shown, " more errors")});
  return problem_status(problems);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, 3) == kByteOrderMark) text.remove_prefix(3);
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + (text.substr(end, 2) == "\r\n" ? 2 : 1));
  }
  return lines;
}

bool is_no_text(std::string_view text, TableErrors& errors) {
  const bool utf16 = text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff");
  const bool binary = text.substr(0, 4096).find('\0') != std::string_view::npos;
  if (utf16)
    errors.add(1, 1, "this is text in UTF-16, expected UTF-8: save it as UTF-8");
  else if (binary)
    errors.add(1, 1, "this is a binary file, expected text: export the spectrum as CSV");
  return utf16 || binary;
}

std::vector<PlacedNumber> number_row(std::string_view line, int line_number, char separator,
                                     std::size_t columns, TableErrors& errors) {
  const std::vector<Field> fields = fields_of(line, separator);
  if (fields.size() != columns) {
    errors.add(line_number, fields.empty() ? 1 : fields.front().column,
               absl::StrCat("a row of ", fields.size(), ", expected ", columns, " numbers"));
    return {};
  }
  std::vector<PlacedNumber> row;
  for (const Field& field : fields) {
    double value = 0;
    if (!absl::SimpleAtod(std::string(field.text), &value) || !std::isfinite(value))
      errors.add(
          line_number, field.column,
          absl::StrCat(
              quoted(field.text), ", expected a finite number",
              field.text.find(',') != std::string_view::npos ? " with a decimal point" : ""));
    else
      row.push_back({value, line_number, field.column});
  }
  if (row.size() != columns) row.clear();
  return row;
}

NumberTable read_number_table(std::string_view text, TableErrors& errors) {
  NumberTable table;
  if (is_no_text(text, errors)) return table;
  int number = 0;
  char separator = ',';
  for (const std::string_view line : lines_of(text)) {
    ++number;
    const Field whole = trimmed(line, 0, line.size());
    if (whole.text.empty() || whole.text.front() == '#') continue;
    if (table.column.empty()) {
      separator = separator_of(line);
      for (const Field& field : fields_of(line, separator))
        table.column.push_back({column_name(field.text), number, field.column});
      continue;
    }
    auto row = number_row(line, number, separator, table.column.size(), errors);
    if (!row.empty()) table.row.push_back(std::move(row));
  }
  if (table.column.empty())
    errors.add(1, 1, "an empty file, expected a line with the names of the columns and rows");
  else if (table.row.empty() && errors.empty())
    errors.add(table.column[0].line, 1, "no rows below the names of the columns");
  return table;
}

void check_wavelengths(const std::vector<std::vector<PlacedNumber>>& rows, TableErrors& errors) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const PlacedNumber& at = rows[i][0];
    if (!(at.value > 0))
      errors.add(at, absl::StrCat("wavelength ", at.value, ", expected a number above 0"));
    else if (i > 0 && !(at.value > rows[i - 1][0].value))
      errors.add(at, absl::StrCat("wavelength ", at.value, " is not above the one before it, ",
                                  rows[i - 1][0].value, ", expected increasing wavelengths"));
  }
}

}  // namespace irsig
