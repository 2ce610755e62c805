#pragma once

#include <vector>

#include "tests/physics/plain_gas/step.h"

namespace irsig::plain {

// Transmittance of one band along a path whose absorption is a sum of exponentials over points of a
// common order: sum of w_i exp(-d_i).
class LinePath {
 public:
  // depth: of what lies before the path, per point; weights add up to 1.
  LinePath(std::vector<double> weight, std::vector<double> depth)
      : weight_(std::move(weight)), depth_(std::move(depth)) {}

  // Returns the absorption of a segment; k: absorption per point times amount.
  Step add(const std::vector<double>& k, double amount) {
    Step out{0, 0};
    for (std::size_t i = 0; i < weight_.size(); ++i) {
      const double before = weight_[i] * std::exp(-depth_[i]);
      out.from += before;
      out.by += before * std::expm1(-k[i] * amount);
      depth_[i] += k[i] * amount;
    }
    return out;
  }

  [[nodiscard]] double transmittance() const {
    double sum = 0;
    for (std::size_t i = 0; i < weight_.size(); ++i) sum += weight_[i] * std::exp(-depth_[i]);
    return sum;
  }

 private:
  std::vector<double> weight_, depth_;
};

}  // namespace irsig::plain
