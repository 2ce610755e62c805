#pragma once

#include <vector>

namespace irsig {

// Nodes and weights on [0, 1].
struct QuadratureRule {
  std::vector<double> x, w;
};

// Returns Gauss-Legendre points. [dlmf, 3.5.v]
[[nodiscard]] QuadratureRule gauss_legendre(int points);

// Returns Gauss-Legendre points after x = (1 - cos(pi t)) / 2, which turns a square root at either
// end of the interval into an analytic function.
[[nodiscard]] QuadratureRule gauss_legendre_between_roots(int points);

}  // namespace irsig
