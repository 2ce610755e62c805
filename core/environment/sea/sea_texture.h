#pragma once

#include <cstddef>
#include <vector>

#include "core/environment/sea/wave_spectrum.h"

namespace irsig {

// How much of the structure of a rough sea is left in means over a rectangle of it.
//
// A radiance that depends on the slopes (x, y) of the waves alone is a sum of terms
// c_ab he_a(x) he_b(y), slopes in standard deviations, he_n the normalised Hermite polynomials.
// Between two places with correlations rx and ry the covariance of a term is rx^a ry^b, and
// different terms do not vary together [mehler1866]: variances of means are sums over terms.

// Terms with 1 <= a + b <= kSlopeOrder, by a + b.
struct SlopeTerm {
  int a, b;
};
inline constexpr int kSlopeOrder = 8;
[[nodiscard]] const std::vector<SlopeTerm>& slope_terms();

// Returns he_0(x) .. he_kSlopeOrder(x).
[[nodiscard]] std::vector<double> hermite_functions(double x);

// Slopes in standard deviations, with weights that add up to 1: means of polynomials up to the 23rd
// degree are exact.
struct SlopeNode {
  double x, weight;
};
[[nodiscard]] const std::vector<SlopeNode>& slope_nodes();

class SlopeAverages {
 public:
  // Rectangle of the sides along x and y, at least 1 cm each. [m]
  SlopeAverages(const SlopeCorrelation& sea, double side_x_m, double side_y_m);

  // [term] Variance of the mean of a term with c_ab = 1. Within 2 % (tests/physics).
  [[nodiscard]] const std::vector<double>& term() const { return term_; }
  // Returns the variance of the mean of light from the facets of one slope alone, over its mean
  // squared.
  //   blur  variance of that slope, such as the sun's disk makes it, in variances of a slope; > 0
  [[nodiscard]] double of_one_slope(double x, double y, double blur) const;

 private:
  struct Lag {
    double weight;
    SlopeCorrelation::Pair correlation;
  };
  std::vector<Lag> lag_;  // quadrature over pairs of places in the rectangle; weights add up to 1
  std::vector<double> term_;
};

}  // namespace irsig
