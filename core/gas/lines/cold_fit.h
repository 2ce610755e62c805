#pragma once

#include <array>
#include <vector>

namespace irsig {

// Change of a part of the absorption from 1 atm and a reference temperature T0:
//   p^a (1 + b x + c x^2),   x = T / T0 - 1
struct AirScaling {
  double a = 0, b = 0, c = 0;
  [[nodiscard]] double at(double pressure_atm, double x) const;
};

// The air's form of a band (core/atmosphere/data/README.md):
//   depth of term i = k_i (share_i first + (1 - share_i) second) u
struct ColdFit {
  std::vector<double> share;
  AirScaling first, second;
};

// Gases whose light the band is fitted to let through as line by line: of 400 and 700 K.
inline constexpr std::size_t kThroughColdAir = 2;

// A band in one state of the air, line by line.
struct ColdState {
  double pressure_atm, temperature_k, importance;
  std::vector<double> ratio;                  // per term: absorption over k
  std::vector<double> amount, transmittance;  // amounts in the unit of 1 / k
  // Transmitted fraction of the emission of thin hot gas; per amount.
  std::array<std::vector<double>, kThroughColdAir> hot_through;
};

// Fits the terms to the states by least squares of
//   (ratio_fit / ratio - 1) / 7,  (T_fit - T) / (T + 0.1),
//   (through_fit - through) / (through + 0.02)
// with both scalings positive from 170 to 330 K. Terms keep their absorption at their own
// wavenumbers: k is the reference's, and the weights follow from the ratios. With one scaling of
// temperature for all terms 0.8 of the light of gas of 400 K would pass near the band's head, where
// weak terms change with temperature otherwise than strong ones.
//   hot_fraction  of each term, of what thin hot gas sends in the band
[[nodiscard]] ColdFit fit_cold_band(
    const std::vector<double>& k, const std::vector<double>& weight, double reference_k,
    const std::array<std::vector<double>, kThroughColdAir>& hot_fraction,
    const std::vector<ColdState>& states);

}  // namespace irsig
