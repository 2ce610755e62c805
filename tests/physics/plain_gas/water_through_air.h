#pragma once

#include <cstddef>
#include <vector>

#include "core/atmosphere/gas_terms.h"

namespace irsig::plain {

// Returns w, the weight of independence in the light of hot water vapour that cold air lets
// through. Hot and cold lines lie partly in the same places: the hot gas's own strong lines are the
// cold gas's at 400 K and hardly any at 2000 K.
// Between the two limits,
//   (1 - w) ranked + w product,   w = 0, 0.03, 0.14, 0.35, 0.60 at 300, 500, 700, 1000, 1500 K,
// ranked: both gases strongest at the same wavenumbers; product: without regard to each other. w is
// measured against HITRAN2016 at 2000-2100 cm-1, columns of 1-10 cm atm, 0.1-20 km of air.
// Limit: one window; w grows with amount and range.
[[nodiscard]] double water_independence(double temperature_k);

// One sigma of w: its own spread, and what the air's terms miss where the air is thin and only the
// strongest wavenumbers matter (0.44 T^3, from the same comparison).
//   air_transmittance  T, of the air's water alone
[[nodiscard]] double water_independence_spread(double temperature_k, double air_transmittance);

// One band. The hot gas's absorption is distributed as Malkmus' model has it (inverse Gaussian).
class WaterThroughAir {
 public:
  explicit WaterThroughAir(const GasTerms& cold);

  // Mean transmittance of the air for what a segment of hot water takes and sends.
  //   weak_depth  S/d u of the segment, > 0
  //   lorentz     half width times 1/d
  struct Share {
    double ranked, product;
  };
  Share add(double weak_depth, double lorentz);

 private:
  struct Point {
    double weight, begin, end, air;  // air: transmittance; begin, end: of the cumulative weight
    double depth = 0;
  };
  std::vector<Point> point_;
  double product_;
};

// Share of the absorption that the weakest g of the wavenumbers hold: Lorenz curve of an inverse
// Gaussian distribution of mean 1.                               g in [0, 1], shape > 0
[[nodiscard]] double inverse_gaussian_lorenz(double g, double shape);

}  // namespace irsig::plain
