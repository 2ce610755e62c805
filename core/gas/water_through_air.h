#pragma once

#include <array>
#include <cstddef>

namespace irsig {

// Returns w, by which the transmittance of cold air for the emission of hot water vapour lies
// between two limits. Hot and cold lines lie partly in the same places: the hot gas's strong lines
// are those of the cold gas at 400 K, and hardly any at 2000 K:
//   (1 - w) ranked + w product,   w = 0, 0.065, 0.185, 0.38, 0.57 at 300, 500, 700, 1000, 1500 K,
// ranked: both gases strongest at the same wavenumbers; product: without regard to each other. w is
// measured against HITRAN2016 at 2000-2100 cm-1, columns of 1-10 cm atm, 0.1-20 km of air. Limit:
// one window; w grows with amount and range.
[[nodiscard]] double water_independence(double temperature_k);

// Returns one sigma of w: the root of the sum of the squares of its own spread, and of the error of
// the air's terms where the air is thin and only the strongest wavenumbers matter (0.44 T^3, from
// the same comparison).
[[nodiscard]] double water_independence_spread(double temperature_k);
[[nodiscard]] double water_thin_air_spread(double air_transmittance);

// Lorenz curves of the distribution of the hot gas's absorption, as Malkmus' model has it (inverse
// Gaussian of mean 1): share of the absorption that the weakest g of the wavenumbers hold.
struct LorenzCurves {
  static constexpr std::size_t kShapes = 72, kShares = 161;
  using Curve = std::array<double, kShares>;

  // Returns the position of a shape > 0 between two neighbouring curves, which stand at whole
  // numbers.
  [[nodiscard]] static double place_of_shape(double shape);
  // Position of g in [0, 1] between two neighbouring points of a curve.
  struct Place {
    std::size_t low;
    double on;
  };
  [[nodiscard]] static Place place_of_share(double g);
  [[nodiscard]] static const std::array<Curve, kShapes>& curves();
};

// Returns the fraction of the absorption that the weakest g of the wavenumbers hold: Lorenz curve
// of an inverse Gaussian distribution of mean 1. g in [0, 1], shape > 0.
[[nodiscard]] double inverse_gaussian_lorenz(double g, double shape);

}  // namespace irsig
