#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace irsig {

// Shared parts of the readers of this folder: numbers in text, each with its place.

struct PlacedNumber {
  double value;
  int line, column;  // from 1
};

// The errors of one file, "file:line:column: what is wrong, what was expected", one a line, in
// the order of the file: the first ten and how many more there are.
class TableErrors {
 public:
  explicit TableErrors(std::string_view file_name) : file_name_(file_name) {}

  void add(int line, int column, const std::string& what);
  void add(const PlacedNumber& at, const std::string& what) { add(at.line, at.column, what); }
  [[nodiscard]] bool empty() const { return found_.empty(); }
  [[nodiscard]] absl::Status status() const;  // INVALID_ARGUMENT; OK if there are none

 private:
  struct Found {
    int line, column;
    std::string what;
  };
  std::string file_name_;
  std::vector<Found> found_;
};

// Returns true, and reports it with the remedy, if the bytes are UTF-16 or binary.
[[nodiscard]] bool is_no_text(std::string_view text, TableErrors& errors);

// Returns the lines of a text without their ends ("\n", "\r\n" or "\r") and without a byte order
// mark.
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

// Returns the finite numbers of one line, separated by `separator` (' ': any white space). Reports
// other words, and rows of another length than `columns`; then the row is empty.
[[nodiscard]] std::vector<PlacedNumber> number_row(std::string_view line, int line_number,
                                                   char separator, std::size_t columns,
                                                   TableErrors& errors);

// A CSV file of numbers: '#' starts a line of remarks, the first other line names the columns,
// empty lines are skipped. Between the numbers stand commas, or semicolons or tabs if these stand
// between the names; separators at the end of a line are read over. Names are in lower case, with
// "_" for whatever is no letter or digit, "um" for the micro sign and its metre, and "percent" for
// "%": "Wavelength (nm)" is wavelength_nm.
struct NumberTable {
  struct Name {
    std::string text;
    int line, column;
  };
  std::vector<Name> column;
  std::vector<std::vector<PlacedNumber>> row;  // each as long as `column`
};
// Reads a table of numbers. Reports a table without a column or row to `errors`.
[[nodiscard]] NumberTable read_number_table(std::string_view text, TableErrors& errors);

// Reports each wavelength of a column that is not above 0 or not above the one before it.
void check_wavelengths(const std::vector<std::vector<PlacedNumber>>& rows, TableErrors& errors);

}  // namespace irsig
