#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/materials/optical/csv_columns.h"
#include "core/materials/optical/library_spectrum.h"
#include "core/materials/optical/optical_files.h"

namespace irsig {

std::optional<double> micrometres_in(std::string_view column) {
  if (column == "lambda_um" || column == "wavelength_um") return 1.0;
  if (column == "lambda_nm" || column == "wavelength_nm") return 1e-3;
  return std::nullopt;
}

std::optional<double> wavelength_unit(const NumberTable::Name& column, TableErrors& errors) {
  const auto unit = micrometres_in(column.text);
  if (!unit)
    errors.add(
        column.line, column.column,
        absl::StrCat("column \"", column.text, "\", expected \"lambda_um\" or \"lambda_nm\""));
  return unit;
}

namespace {

// Returns the message for a file whose first line is neither names of columns nor a known header.
std::string not_two_columns(std::string_view text, const std::string& quantity) {
  for (const std::string_view line : lines_of(text)) {
    std::string words(line);
    absl::StripAsciiWhitespace(&words);
    if (words.empty() || words.front() == '#') continue;
    if (absl::StartsWith(words, "ENVI"))
      return absl::StrCat(
          "this is the header of an ENVI file, and ENVI spectral libraries are not read: export the "
          "spectrum as CSV with the columns lambda_um,",
          quantity);
    const bool names = absl::ascii_isalpha(static_cast<unsigned char>(words.front())) ||
                       words.front() == '"';
    if (words.find(',') != std::string::npos || (names && words.find_first_of(";\t") != words.npos))
      return {};
    return absl::StrCat(
        "the first line names no columns, expected \"lambda_um,", quantity, "\" or \"lambda_nm,",
        quantity, "_percent\" and rows of two numbers with a comma between them, or a spectrum of "
        "the ECOSTRESS or the USGS library (to splib06) with its header",
        absl::StrContains(words, "splib07")
            ? "; splib07 has the wavelengths in a file of their own: put both beside each other"
            : "");
  }
  return {};
}

}  // namespace

absl::StatusOr<Spectrum> read_spectrum(std::string_view text, std::string_view file_name,
                                       std::string_view quantity_asked) {
  const std::string quantity(quantity_asked);
  TableErrors errors(file_name);
  if (is_no_text(text, errors)) return errors.status();
  if (const auto library = read_library_spectrum(text, quantity, errors); library) {
    if (!errors.empty()) return errors.status();
    return *library;
  }
  if (const std::string wanted = not_two_columns(text, quantity); !wanted.empty()) {
    errors.add(1, 1, wanted);
    return errors.status();
  }
  const NumberTable table = read_number_table(text, errors);
  if (!errors.empty()) return errors.status();
  if (table.column.size() != 2) {
    errors.add(table.column[0].line, 1,
               absl::StrCat(table.column.size(), " columns, expected \"lambda_um\" and \"",
                            quantity, "\""));
    return errors.status();
  }
  const auto unit_um = wavelength_unit(table.column[0], errors);
  std::string name = table.column[1].text;
  const bool percent = absl::EndsWith(name, "_percent");
  if (percent) name.resize(name.size() - std::string_view("_percent").size());
  if (name != quantity && name != "value")
    errors.add(table.column[1].line, table.column[1].column,
               absl::StrCat("column \"", table.column[1].text, "\", expected \"", quantity,
                            "\" or \"", quantity, "_percent\""));
  check_wavelengths(table.row, errors);
  const double most = percent ? 100 : 1;
  const bool maybe_percent =
      !percent && std::ranges::all_of(table.row, [](const std::vector<PlacedNumber>& row) {
        return row[1].value >= 0 && row[1].value <= 100;
      });
  Spectrum spectrum;
  for (const auto& row : table.row) {
    if (!(row[1].value >= 0 && row[1].value <= most))
      errors.add(row[1],
                 absl::StrCat(row[1].value, ", expected a number from 0 to ", most,
                              percent ? " (percent)" : "",
                              maybe_percent ? absl::StrCat(": if it is in percent, name the column ",
                                                           quantity, "_percent")
                                            : ""));
    spectrum.push_back({row[0].value * unit_um.value_or(0), row[1].value / most});
  }
  if (!errors.empty()) return errors.status();
  return spectrum;
}

}  // namespace irsig
