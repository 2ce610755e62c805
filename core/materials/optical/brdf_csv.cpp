#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/materials/optical/csv_columns.h"
#include "core/materials/optical/optical_files.h"

namespace irsig {
namespace {

enum Column { kLambda, kIn, kOut, kAzimuth, kBrdf, kColumns };
constexpr std::array<const char*, kColumns> kNames{"lambda_um", "theta_i_deg", "theta_r_deg",
                                                   "phi_deg", "brdf_per_sr"};

// Returns the place of each column in a row; reports one that is missing or there twice.
std::array<std::size_t, kColumns> find_columns(const NumberTable& table, double& unit_um,
                                               TableErrors& errors) {
  std::array<std::size_t, kColumns> at{};
  at.fill(table.column.size());
  for (std::size_t i = 0; i < table.column.size(); ++i) {
    const NumberTable::Name& name = table.column[i];
    std::size_t which = kColumns;
    if (const auto unit = micrometres_in(name.text)) {
      which = kLambda;
      unit_um = *unit;
    } else {
      which = static_cast<std::size_t>(std::find(kNames.begin(), kNames.end(), name.text) -
                                       kNames.begin());
    }
    if (which == kColumns) continue;
    if (at[which] != table.column.size())
      errors.add(name.line, name.column,
                 absl::StrCat("a second column \"", name.text, "\", expected one"));
    at[which] = i;
  }
  for (std::size_t c = 0; c < kColumns; ++c)
    if (at[c] == table.column.size())
      errors.add(table.column[0].line, 1, absl::StrCat("no column \"", kNames[c], "\""));
  return at;
}

// The points of one axis: increasing, each once.
std::vector<double> axis(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}
std::size_t index_on(const std::vector<double>& axis, double value) {
  return static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), value) - axis.begin());
}

// 350 -> 10: the side does not matter. Angles on a grid of hundredths meet exactly.
double folded(double phi_deg) {
  return phi_deg <= 180 ? phi_deg : std::round((360 - phi_deg) * 1e6) / 1e6;
}

void check_row(const std::vector<PlacedNumber>& row, const std::array<std::size_t, kColumns>& at,
               TableErrors& errors) {
  if (!(row[at[kLambda]].value > 0)) errors.add(row[at[kLambda]], "expected a wavelength above 0");
  for (const Column c : {kIn, kOut})
    if (!(row[at[c]].value >= 0 && row[at[c]].value < 90))
      errors.add(row[at[c]], absl::StrCat(kNames[c], " = ", row[at[c]].value,
                                          ", expected 0 or more and below 90"));
  if (!(row[at[kAzimuth]].value >= 0 && row[at[kAzimuth]].value <= 360))
    errors.add(row[at[kAzimuth]], absl::StrCat("phi_deg = ", row[at[kAzimuth]].value,
                                               ", expected a number from 0 to 360"));
  if (!(row[at[kBrdf]].value >= 0))
    errors.add(row[at[kBrdf]],
               absl::StrCat("brdf_per_sr = ", row[at[kBrdf]].value, ", expected 0 or more"));
}

}  // namespace

absl::StatusOr<TabulatedBrdf> read_brdf(std::string_view text, std::string_view file_name) {
  TableErrors errors(file_name);
  const NumberTable table = read_number_table(text, errors);
  if (!errors.empty()) return errors.status();
  double unit_um = 1;
  const auto at = find_columns(table, unit_um, errors);
  if (!errors.empty()) return errors.status();
  std::array<std::vector<double>, kBrdf> values;
  for (const auto& row : table.row) {
    check_row(row, at, errors);
    values[kLambda].push_back(row[at[kLambda]].value * unit_um);
    values[kIn].push_back(row[at[kIn]].value);
    values[kOut].push_back(row[at[kOut]].value);
    values[kAzimuth].push_back(row[at[kAzimuth]].value);
  }
  if (!errors.empty()) return errors.status();

  // The grid as it stands in the file, both sides of the plane of incidence: each point once.
  std::array<std::vector<double>, kBrdf> grid;
  std::size_t points = 1;
  for (std::size_t c = 0; c < kBrdf; ++c) {
    grid[c] = axis(values[c]);
    points *= grid[c].size();
    if (points > 4 * table.row.size()) break;
  }
  TabulatedBrdf out{grid[kLambda], grid[kIn], grid[kOut], {}, {}};
  std::vector<double> fold;
  for (const double azimuth : grid[kAzimuth]) fold.push_back(folded(azimuth));
  out.phi_deg = axis(fold);
  std::vector<int> seen_at_line(points <= 4 * table.row.size() ? points : 0, 0);
  if (points != table.row.size()) {
    errors.add(
        table.column[0].line, 1,
        absl::StrCat(table.row.size(), " rows, expected a full grid: one row for each of ",
                     grid[kLambda].size(), " wavelengths x ", grid[kIn].size(), " theta_i_deg x ",
                     grid[kOut].size(), " theta_r_deg x ", grid[kAzimuth].size(), " phi_deg"));
  }
  const std::size_t cells =
      grid[kLambda].size() * grid[kIn].size() * grid[kOut].size() * out.phi_deg.size();
  std::vector<double> sum(seen_at_line.empty() ? 0 : cells, 0.0);
  std::vector<int> count(sum.size(), 0);
  for (std::size_t r = 0; r < table.row.size() && !sum.empty(); ++r) {
    const PlacedNumber& brdf = table.row[r][at[kBrdf]];
    const std::size_t direction = (index_on(grid[kLambda], values[kLambda][r]) * grid[kIn].size() +
                                   index_on(grid[kIn], values[kIn][r])) *
                                      grid[kOut].size() +
                                  index_on(grid[kOut], values[kOut][r]);
    int& line = seen_at_line[direction * grid[kAzimuth].size() +
                             index_on(grid[kAzimuth], values[kAzimuth][r])];
    if (line != 0)
      errors.add(brdf.line, 1,
                 absl::StrCat("the same directions and wavelength as in line ", line));
    line = brdf.line;
    const std::size_t cell =
        direction * out.phi_deg.size() + index_on(out.phi_deg, folded(values[kAzimuth][r]));
    sum[cell] += brdf.value;
    ++count[cell];
  }
  if (!errors.empty()) return errors.status();
  for (std::size_t i = 0; i < sum.size(); ++i)
    out.brdf_per_sr.push_back(static_cast<float>(sum[i] / count[i]));
  return out;
}

}  // namespace irsig
