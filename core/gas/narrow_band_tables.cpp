#include "core/gas/narrow_band_tables.h"

#include <algorithm>
#include <cmath>

#include "core/base/check.h"
#include "core/base/csv_rows.h"

namespace irsig {
namespace {
constexpr char kH2o[] =
#include "gas/radcal_h2o.csv.inc"
    ;
constexpr char kCo215um[] =
#include "gas/radcal_co2_15um.csv.inc"
    ;
}  // namespace

StrengthTable::StrengthTable(std::string_view csv) {
  CsvRows rows(csv);
  IRSIG_CHECK(rows.next());
  for (const CsvCell& head : rows.cells()) {  // wavenumber_cm1, T300, ...
    if (head.column > 1) temperature_k_.push_back(finite_number(head.text.substr(1)).value());
  }
  std::vector<double> wavenumber;
  while (rows.next()) {
    IRSIG_CHECK(rows.cells().size() == temperature_k_.size() + 1);
    std::vector<double>& row = row_.emplace_back();
    for (const CsvCell& cell : rows.cells()) row.push_back(finite_number(cell.text).value());
    wavenumber.push_back(row.front());
    row.erase(row.begin());
  }
  first_cm1_ = wavenumber.at(0);
  step_cm1_ = wavenumber.at(1) - first_cm1_;
  IRSIG_CHECK(wavenumber.back() ==
              first_cm1_ + step_cm1_ * static_cast<double>(wavenumber.size() - 1));
}

double StrengthTable::at(double wavenumber_cm1, double temperature_k) const {
  const double place = (wavenumber_cm1 - first_cm1_) / step_cm1_;
  if (!(place >= 0 && place <= static_cast<double>(row_.size() - 1))) return 0;
  const std::size_t i = std::min(static_cast<std::size_t>(place), row_.size() - 2);
  const double w = place - static_cast<double>(i);
  const double t = std::clamp(temperature_k, temperature_k_.front(), temperature_k_.back());
  std::size_t j = 0;
  while (j + 2 < temperature_k_.size() && t >= temperature_k_[j + 1]) ++j;
  const double v = (t - temperature_k_[j]) / (temperature_k_[j + 1] - temperature_k_[j]);
  return (1 - w) * ((1 - v) * row_[i][j] + v * row_[i][j + 1]) +
         w * ((1 - v) * row_[i + 1][j] + v * row_[i + 1][j + 1]);
}

const StrengthTable& h2o_strengths() {
  static const StrengthTable table({kH2o, sizeof kH2o - 1});
  return table;
}

const StrengthTable& co2_15um_strengths() {
  static const StrengthTable table({kCo215um, sizeof kCo215um - 1});
  return table;
}

}  // namespace irsig
