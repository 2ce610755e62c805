#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/gas/narrow_band.h"

namespace irsig {

// S/d by wavenumber and temperature, linear in both (as the original reads it); temperatures beyond
// the table's ends are its ends. Private to core/gas.
class StrengthTable {
 public:
  explicit StrengthTable(std::string_view csv);
  // Interpolates the table; 0 outside its wavenumbers. [1/(cm atm)]
  [[nodiscard]] double at(double wavenumber_cm1, double temperature_k) const;

 private:
  std::vector<double> temperature_k_;
  double first_cm1_ = 0, step_cm1_ = 0;
  std::vector<std::vector<double>> row_;  // [wavenumber][temperature]
};

[[nodiscard]] const StrengthTable& h2o_strengths();
[[nodiscard]] const StrengthTable& co2_15um_strengths();

// hc/k and the reference temperature of the formulas, as they were fitted.
inline constexpr double kRadcalC2CmK = 1.4388, kRadcalT0K = 300;

// Rotation of carbon dioxide, and its change with v3.                                 [cm-1]
inline constexpr double kCo2RotationCm1 = 0.391635, kCo2RotationChangeCm1 = 0.0030875;

// Compute the narrow bands of one gas each.
void h2o_bands(std::span<const double> wavenumber_cm1, double temperature_k,
               std::span<NarrowBand> out);
void co2_bands(std::span<const double> wavenumber_cm1, double temperature_k,
               std::span<NarrowBand> out);
[[nodiscard]] NarrowBand co_band(double wavenumber_cm1, double temperature_k);

}  // namespace irsig
