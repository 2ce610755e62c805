#include "core/materials/optical/library_spectrum.h"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"

namespace irsig {
namespace {

constexpr double kNoise = 0.01;
constexpr double kDeleted = -1e30;  // USGS: -1.23e34

struct LibraryLine {
  std::string value;
  int line = 0;
};

struct LibraryForm {
  double unit_um = 1;
  bool wave_number = false;  // in 1/cm
  double scale = 1;          // of the values
  std::string quantity;      // reflectance | emissivity
  bool hemispherical = false;
  std::size_t columns = 2;
  std::size_t first_row = 0;  // index of a line
};

std::string stripped(std::string_view text) {
  std::string out(text);
  absl::StripAsciiWhitespace(&out);
  return out;
}

bool is_numbers(std::string_view line) {
  const std::vector<std::string> words =
      absl::StrSplit(std::string(line), absl::ByAnyChar(" \t,\r"), absl::SkipEmpty());
  double value = 0;
  return !words.empty() && std::ranges::all_of(words, [&](const std::string& word) {
    return absl::SimpleAtod(word, &value);
  });
}

// "Key: value" lines up to the first row of numbers.
std::map<std::string, LibraryLine> header_of(const std::vector<std::string_view>& lines,
                                             std::size_t& first_row) {
  std::map<std::string, LibraryLine> header;
  for (first_row = 0; first_row < lines.size() && !is_numbers(lines[first_row]); ++first_row) {
    const std::size_t colon = lines[first_row].find(':');
    if (colon == std::string_view::npos) continue;
    std::string key = absl::AsciiStrToLower(stripped(lines[first_row].substr(0, colon)));
    header.try_emplace(
        std::move(key),
        LibraryLine{absl::AsciiStrToLower(stripped(lines[first_row].substr(colon + 1))),
                    static_cast<int>(first_row) + 1});
  }
  return header;
}

std::optional<LibraryForm> ecostress_form(const std::vector<std::string_view>& lines,
                                          TableErrors& errors) {
  LibraryForm form;
  std::map<std::string, LibraryLine> header = header_of(lines, form.first_row);
  if (!header.contains("x units") || !header.contains("y units")) return std::nullopt;
  const LibraryLine &x = header["x units"], &y = header["y units"];
  const auto has = [](const LibraryLine& in, std::string_view word) {
    return in.value.find(word) != std::string::npos;
  };
  if (has(x, "wave number") || has(x, "wavenumber") || has(x, "(cm")) {
    form.wave_number = true;
  } else if (has(x, "nano") || has(x, "(nm)")) {
    form.unit_um = 1e-3;
  } else if (has(x, "micro") || has(x, "(um)") || has(x, "\u00b5m")) {
    form.unit_um = 1;
  } else {
    errors.add(x.line, 1,
               absl::StrCat("X Units: ", x.value,
                            ", expected wavelength (micrometers) or (nanometers), or "
                            "wave number (cm-1)"));
  }
  form.quantity = has(y, "reflectance") ? "reflectance" : has(y, "emissivity") ? "emissivity" : "";
  if (form.quantity.empty())
    errors.add(y.line, 1,
               absl::StrCat("Y Units: ", y.value, ", expected reflectance or emissivity"));
  if (has(y, "percent") || has(y, "%")) form.scale = 0.01;
  form.hemispherical = has(header["measurement"], "hemispherical") || has(y, "hemispherical");
  return form;
}

std::optional<LibraryForm> usgs_form(const std::vector<std::string_view>& lines) {
  if (lines.empty() ||
      absl::AsciiStrToLower(std::string(lines[0])).find("usgs digital spectral library") ==
          std::string::npos)
    return std::nullopt;
  LibraryForm form;
  form.quantity = "reflectance";
  form.columns = 3;
  // The title and the history of the sample may be numbers: rows begin behind the last line of
  // text.
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (!is_numbers(lines[i]) && !stripped(lines[i]).empty()) form.first_row = i + 1;
  return form;
}

}  // namespace

std::optional<Spectrum> read_library_spectrum(std::string_view text, std::string_view quantity,
                                              TableErrors& errors) {
  const std::vector<std::string_view> lines = lines_of(text);
  std::optional<LibraryForm> form = usgs_form(lines);
  if (!form) form = ecostress_form(lines, errors);
  if (!form) return std::nullopt;
  Spectrum spectrum;
  if (!errors.empty()) return spectrum;
  const bool turned = quantity == "emissivity" && form->quantity == "reflectance";
  if (form->quantity != quantity && !(turned && form->hemispherical)) {
    errors.add(1, 1,
               absl::StrCat("this file has the ", form->quantity, " of a sample",
                            turned ? ", and does not say that it is hemispherical" : "",
                            ", expected its ", std::string(quantity)));
    return spectrum;
  }
  struct Row {
    double lambda_um, value;
    int line;
  };
  std::vector<Row> rows;
  for (std::size_t i = form->first_row; i < lines.size(); ++i) {
    const std::string line = absl::StrReplaceAll(std::string(lines[i]), {{",", " "}});
    if (stripped(line).empty()) continue;
    const auto numbers = number_row(line, static_cast<int>(i) + 1, ' ', form->columns, errors);
    if (numbers.empty()) continue;
    if (numbers[1].value < kDeleted || numbers[0].value < kDeleted) continue;
    if (!(numbers[0].value > 0)) {
      errors.add(numbers[0], absl::StrCat(numbers[0].value, ", expected a number above 0"));
      continue;
    }
    const double value = numbers[1].value * form->scale;
    if (!(value >= -kNoise && value <= 1 + kNoise)) {
      errors.add(numbers[1],
                 absl::StrCat(numbers[1].value, ", expected a number from 0 to ", 1 / form->scale));
      continue;
    }
    const double kept = std::clamp(value, 0.0, 1.0);
    rows.push_back({form->wave_number ? 1e4 / numbers[0].value : numbers[0].value * form->unit_um,
                    turned ? 1 - kept : kept, numbers[0].line});
  }
  if (rows.empty() && errors.empty())
    errors.add(static_cast<int>(lines.size()), 1, "no rows of numbers below the header");
  if (rows.size() > 1 && rows.front().lambda_um > rows.back().lambda_um) std::ranges::reverse(rows);
  double count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].lambda_um < rows[i - 1].lambda_um) {
      errors.add(
          rows[i].line, 1,
          absl::StrCat("wavelength ", rows[i].lambda_um, " um comes beside ", rows[i - 1].lambda_um,
                       " um, expected wavelengths that rise or fall "
                       "through the whole file"));
      continue;
    }
    count = i > 0 && rows[i].lambda_um == rows[i - 1].lambda_um ? count + 1 : 1;
    if (count == 1)
      spectrum.push_back({rows[i].lambda_um, rows[i].value});
    else
      spectrum.back().value += (rows[i].value - spectrum.back().value) / count;
  }
  return spectrum;
}

}  // namespace irsig
