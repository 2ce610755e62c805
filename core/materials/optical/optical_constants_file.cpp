#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/table.h"
#include "core/materials/optical/csv_columns.h"
#include "core/materials/optical/optical_files.h"
#include "core/materials/optical/yaml_block.h"

namespace irsig {
namespace {

using Rows = std::vector<std::vector<PlacedNumber>>;

void check_n(const PlacedNumber& n, TableErrors& errors) {
  if (!(n.value > 0)) errors.add(n, absl::StrCat("n = ", n.value, ", expected a number above 0"));
}
void check_k(const PlacedNumber& k, TableErrors& errors) {
  if (!(k.value >= 0)) errors.add(k, absl::StrCat("k = ", k.value, ", expected 0 or more"));
}

absl::StatusOr<OpticalConstants> from_rows(const Rows& rows, double unit_um, TableErrors& errors) {
  check_wavelengths(rows, errors);
  OpticalConstants out;
  for (const auto& row : rows) {
    check_n(row[1], errors);
    check_k(row[2], errors);
    out.push_back({row[0].value * unit_um, row[1].value, row[2].value});
  }
  if (!errors.empty()) return errors.status();
  return out;
}

absl::StatusOr<OpticalConstants> from_csv(std::string_view text, TableErrors& errors) {
  const NumberTable table = read_number_table(text, errors);
  if (!errors.empty()) return errors.status();
  if (table.column.size() != 3 || table.column[1].text != "n" || table.column[2].text != "k") {
    errors.add(table.column[0].line, 1,
               "expected the three columns lambda_um (or lambda_nm), n, k");
    return errors.status();
  }
  const auto unit_um = wavelength_unit(table.column[0], errors);
  return from_rows(table.row, unit_um.value_or(0), errors);
}

// n and k stand in tables of their own: joined at the points of both, where both are known.
absl::StatusOr<OpticalConstants> joined(const Rows& n, const Rows& k, TableErrors& errors) {
  check_wavelengths(n, errors);
  check_wavelengths(k, errors);
  for (const auto& row : n) check_n(row[1], errors);
  for (const auto& row : k) check_k(row[1], errors);
  for (const Rows* rows : {&n, &k})
    if (rows->size() < 2) errors.add(rows->front().front(), "one row, expected two or more");
  if (!errors.empty()) return errors.status();
  const auto column = [](const Rows& rows, std::size_t i) {
    std::vector<double> out;
    for (const auto& row : rows) out.push_back(row[i].value);
    return out;
  };
  const std::vector<double> n_um = column(n, 0), k_um = column(k, 0);
  const std::vector<double> n_at = column(n, 1), k_at = column(k, 1);
  std::vector<double> lambda_um = n_um;
  lambda_um.insert(lambda_um.end(), k_um.begin(), k_um.end());
  std::sort(lambda_um.begin(), lambda_um.end());
  lambda_um.erase(std::unique(lambda_um.begin(), lambda_um.end()), lambda_um.end());
  const double first = std::max(n_um.front(), k_um.front());
  const double last = std::min(n_um.back(), k_um.back());
  OpticalConstants out;
  for (const double at : lambda_um)
    if (at >= first && at <= last)
      out.push_back({at, interpolate_or(n_um, n_at, at, 0.0), interpolate_or(k_um, k_at, at, 0.0)});
  if (out.size() < 2) {
    errors.add(k.front().front(),
               absl::StrCat("k is known from ", k_um.front(), " to ", k_um.back(),
                            " um and n from ", n_um.front(), " to ", n_um.back(),
                            " um, expected two points or more where both are known"));
    return errors.status();
  }
  return out;
}

// The CSV files of refractiveindex.info: "wl,n,k", or a block "wl,n" and below it a block "wl,k";
// wavelengths in micrometres.
absl::StatusOr<OpticalConstants> from_site_csv(std::string_view text, TableErrors& errors) {
  std::optional<Rows> nk, n, k;
  std::optional<Rows>* block = nullptr;
  int number = 0;
  for (const std::string_view raw : lines_of(text)) {
    ++number;
    std::string line(raw);
    absl::StripAsciiWhitespace(&line);
    if (line.empty()) continue;
    const std::string lower = absl::AsciiStrToLower(line);
    if (absl::StartsWith(lower, "wl")) {
      block = lower == "wl,n,k" ? &nk : lower == "wl,n" ? &n : lower == "wl,k" ? &k : nullptr;
      if (block == nullptr || *block) {
        errors.add(number, 1,
                   "expected the columns wl,n,k, or one block wl,n and one block wl,k, as "
                   "refractiveindex.info writes them");
        return errors.status();
      }
      *block = Rows();
      continue;
    }
    auto row = number_row(raw, number, ',', block == &nk ? 3 : 2, errors);
    if (!row.empty()) (*block)->push_back(std::move(row));
  }
  if (errors.empty() && (nk ? n || k : !n || !k))
    errors.add(1, 1,
               "n and k are both needed, expected the columns wl,n,k, or a block wl,n and a block "
               "wl,k (k = 0 where it is known to be)");
  for (const auto* rows : {&nk, &n, &k})
    if (errors.empty() && *rows && (*rows)->empty())
      errors.add(1, 1, "a block has no rows below the names of its columns");
  if (!errors.empty()) return errors.status();
  return nk ? from_rows(*nk, 1, errors) : joined(*n, *k, errors);
}

absl::StatusOr<OpticalConstants> from_yaml(const YAML::Node& root, std::string_view text,
                                           TableErrors& errors) {
  const YAML::Node entries = root.IsMap() ? root["DATA"] : YAML::Node();
  if (!entries.IsDefined() || !entries.IsSequence() || entries.size() == 0) {
    errors.add(1, 1, "no list DATA, expected a file of the refractiveindex.info database");
    return errors.status();
  }
  std::optional<Rows> nk, n, k;
  for (const YAML::Node& entry : entries) {
    const YAML::Mark mark = entry.Mark();
    const YAML::Node type = entry.IsMap() ? entry["type"] : YAML::Node();
    if (!type.IsDefined() || !type.IsScalar()) {
      errors.add(mark.line + 1, mark.column + 1, "an entry of DATA without a type");
      continue;
    }
    const std::string& kind = type.Scalar();
    std::optional<Rows>* const place = kind == "tabulated nk"  ? &nk
                                       : kind == "tabulated n" ? &n
                                       : kind == "tabulated k" ? &k
                                                               : nullptr;
    const int line = type.Mark().line + 1, at_column = type.Mark().column + 1;
    if (place == nullptr) {
      errors.add(line, at_column,
                 absl::StrCat("type \"", kind,
                              "\" is not read, expected \"tabulated nk\", or \"tabulated n\" and "
                              "\"tabulated k\" (tabulate a formula yourself)"));
      continue;
    }
    if (*place) {
      errors.add(line, at_column,
                 absl::StrCat("a second \"", kind, "\", expected one of each type"));
      continue;
    }
    *place = block_rows(entry["data"], mark, text, place == &nk ? 3 : 2, errors);
  }
  if (!errors.empty()) return errors.status();
  if (nk && (n || k)) errors.add(1, 1, "\"tabulated nk\" beside n or k, expected only one form");
  if (!nk && !n) errors.add(1, 1, "no table of n, expected one beside the table of k");
  if (!nk && !k)
    errors.add(1, 1,
               "no table of k, expected one beside the table of n (0 where it is known to be)");
  if (!errors.empty()) return errors.status();
  return nk ? from_rows(*nk, 1, errors) : joined(*n, *k, errors);
}

}  // namespace

absl::StatusOr<OpticalConstants> read_optical_constants(std::string_view text,
                                                        std::string_view file_name) {
  TableErrors errors(file_name);
  const std::string lower = absl::AsciiStrToLower(std::string(file_name));
  if (is_no_text(text, errors)) return errors.status();
  if (absl::EndsWith(lower, ".csv")) {
    const std::vector<std::string_view> lines = lines_of(text);
    const bool of_site =
        !lines.empty() && absl::StartsWithIgnoreCase(std::string(lines.front()), "wl,");
    return of_site ? from_site_csv(text, errors) : from_csv(text, errors);
  }
  if (!absl::EndsWith(lower, ".yml") && !absl::EndsWith(lower, ".yaml")) {
    errors.add(1, 1, "a file with an unknown ending, expected .yml, .yaml or .csv");
    return errors.status();
  }
  const auto root = load_yaml(text, errors);
  if (!root) return errors.status();
  return from_yaml(*root, text, errors);
}

}  // namespace irsig
