#pragma once

#include <span>
#include <vector>

#include "core/thermal/scene/exchange_factors.h"

namespace irsig {

// Irradiance of faces that send to each other and reflect diffusely:
//
//   total_i = own_i + sum of F_ij (emitted_j + (1 - kept_j) total_j)                    [W m^-2]
//
// except faces that stand apart, which receive their own irradiance alone.
class Radiosity {
 public:
  //   factors  kept by the caller
  //   kept     [face] share of what arrives that is absorbed: [0, 1]
  //   apart    [face]
  Radiosity(const ExchangeFactors& factors, std::vector<double> kept, std::vector<bool> apart)
      : factors_(factors), kept_(std::move(kept)), apart_(std::move(apart)), sent_(kept_.size()) {}

  // Solves by Gauss and Seidel from the values in `total`, until nothing changes by more than the
  // tolerance. Converges, since the radiation absorbed anywhere is a part of the emission. All
  // [face].
  void solve(std::span<const double> own, std::span<const double> emitted, double tolerance_w_m2,
             std::span<double> total);

 private:
  const ExchangeFactors& factors_;
  std::vector<double> kept_;
  std::vector<bool> apart_;
  std::vector<double> sent_;  // [face], scratch
};

}  // namespace irsig
