#pragma once

#include "tests/physics/plain_gas/step.h"

namespace irsig::plain {

// Optical depth of a band along a path of gas, whose lines have one Goody distribution, Lorentz and
// Doppler widths joined, its mean widths by Curtis and Godson.       [ludwig1973, 5-25 to 5-27]
//
//   X = sum of S/d u;  a_c = sum of (S/d u gamma_c / d) / X, a_d likewise
//   X_c = X / sqrt(1 + X / (4 a_c)),  X_d = 1.7 a_d sqrt(ln(1 + (X / (1.7 a_d))^2))
//   depth = X sqrt(1 - Y^(-1/2)),  Y = (1 - (X_c/X)^2)^-2 + (1 - (X_d/X)^2)^-2 - 1
//
// One formula from 1e-280 (less is nothing) to 1e280: depth is X where it is thin, and what a
// segment adds to it has a relative error of 1e-13 times (1 + ln of the depths' ratio) whatever
// lies before it.
class CurveOfGrowth {
 public:
  //   weak_depth   S/d u of the segment, >= 0
  //   lorentz, doppler  half widths times 1/d, > 0
  Step add(double weak_depth, double lorentz, double doppler);

  [[nodiscard]] double depth() const { return depth_; }

 private:
  double weak_ = 0, lorentz_ = 0, doppler_ = 0;  // sums of X, a_c X, a_d X
  double depth_ = 0;
};

}  // namespace irsig::plain
