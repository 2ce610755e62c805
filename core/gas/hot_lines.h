#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/gas/narrow_band.h"

namespace irsig {

// Absorption of hot water vapour at 50-7000 cm-1, of carbon dioxide at 15, 10 and 4.3 um and of
// carbon monoxide, line by line: data/hot_lines.txt in memory. Per band of 10 cm-1 terms, in the
// order of the cold air's (core/atmosphere/data), each of a few bins by the hot gas's own
// absorption, so that where lines are bright and where the air takes them away stay the same
// wavenumbers. Layers of different temperature are added bin by bin. Water's points are sorted by
// what gas of 600 and of 1500 K absorbs, and stand for the same wavenumbers at all temperatures.
struct HotLineBand {
  bool joint;                        // the terms are the cold air's; otherwise there is one
  std::vector<double> term_weight;   // sum 1
  std::vector<double> weight;        // [point = term * bins + bin], sum 1
  std::vector<std::size_t> term_of;  // [point]
  // 1000 ln of absorption in m2/mol, [(pressure * temperatures + temperature) * points + point]
  std::vector<std::int32_t> thousandth_ln;
  std::vector<double> ln_mean;  // ln of the band's mean, [pressure * temperatures + temperature]
};
// Temperatures and pressures of the tables' entries.
struct HotLineKnots {
  std::vector<double> ln_temperature, ln_pressure_atm;
};

// Null where the gas is described by narrow_band alone: bands away from these.
[[nodiscard]] const HotLineBand* hot_line_band(HotGas gas, std::size_t band);

[[nodiscard]] const HotLineKnots& hot_line_knots();

// Eight rows of a band's table and their weights, whose sum is 1000 ln of the absorption: cubic in
// ln temperature, linear in ln pressure.
//   temperature_k, pressure_pa  as check_gas asks
struct HotLinePlace {
  std::array<std::size_t, 8> row{};  // pressure * temperatures + temperature
  std::array<double, 8> weight{};
};
[[nodiscard]] HotLinePlace hot_line_place(double temperature_k, double pressure_pa);

// Returns the mean absorption of a band.                                          [m2/mol]
[[nodiscard]] double mean_absorption_m2_mol(const HotLineBand& band, const HotLinePlace& at);

}  // namespace irsig
