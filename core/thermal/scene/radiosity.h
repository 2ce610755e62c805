#pragma once

#include <span>
#include <vector>

#include "core/thermal/scene/exchange_factors.h"

namespace irsig {

// What arrives at faces that send to each other and reflect diffusely what arrives:
//
//   total_i = own_i + sum of F_ij (emitted_j + (1 - kept_j) total_j)                    [W m^-2]
//
// but for those that stand apart, at which their own arrives and nothing else.
class Radiosity {
 public:
  //   factors  kept by the caller
  //   kept     [face] share of what arrives that is absorbed: [0, 1]
  //   apart    [face]
  Radiosity(const ExchangeFactors& factors, std::vector<double> kept, std::vector<bool> apart)
      : factors_(factors), kept_(std::move(kept)), apart_(std::move(apart)), sent_(kept_.size()) {}

  // By Gauss and Seidel from what `total` has, until nothing changes by more than the tolerance.
  // What is absorbed somewhere is a part of what others send: it converges. All [face].
  void solve(std::span<const double> own, std::span<const double> emitted, double tolerance_w_m2,
             std::span<double> total);

 private:
  const ExchangeFactors& factors_;
  std::vector<double> kept_;
  std::vector<bool> apart_;
  std::vector<double> sent_;  // [face], scratch
};

}  // namespace irsig
