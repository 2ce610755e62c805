#pragma once

#include <vector>

namespace irsig {

// What a band of a gas lets through in one state of the air, line by line.
struct BandSample {
  double pressure_atm, temperature_k, importance;
  std::vector<double> amount, transmittance;  // amounts in the unit of 1 / k
};

// The air's form of a band (core/atmosphere/data/README.md) about 1 atm and a temperature:
//   depth of a term = k (alpha p^a + 1 - alpha) (1 + b x + c x^2) u,   x = T / T0 - 1
struct ColdFit {
  std::vector<double> alpha;
  double a = 1, b = 0, c = 0;
};

// The absorption of each term at another pressure, over that at 1 atm.
struct TermSample {
  double pressure_atm, importance;
  std::vector<double> ratio;
};

// alpha by least squares from what the terms' own wavenumbers do with pressure, a, b and c from the
// samples' transmittances T: least squares of (T - T_fit) / (T + 0.1), the parabola positive from
// 170 to 330 K. k and alpha stay what they are at the wavenumbers of the term: freed, they fit
// transmittances better and what comes through of hot lines worse (8 % instead of 1 % at 400 K).
[[nodiscard]] ColdFit fit_cold_band(const std::vector<double>& k, const std::vector<double>& weight,
                                    double reference_k, const std::vector<TermSample>& by_pressure,
                                    const std::vector<BandSample>& samples);

}  // namespace irsig
