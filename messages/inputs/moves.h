#pragma once

#include <algorithm>
#include <cmath>

#include "schema/job.pb.h"

namespace irsig {

// Moves values within their possible range, and counts them.
class Mover {
 public:
  // The sigma times the move; relative: of the value itself.
  Mover(double by, bool relative) : by_(by), relative_(relative) {}

  [[nodiscard]] double moved(double value, double least, double most) {
    const double wanted = relative_ ? value * by_ : by_;
    if (wanted == 0) return value;
    const double out = std::clamp(value + wanted, std::min(value, least), std::max(value, most));
    ++values_;
    shares_ += std::abs(out - value) / std::abs(wanted);
    return out;
  }
  [[nodiscard]] double by() const { return by_; }
  [[nodiscard]] int values() const { return values_; }
  [[nodiscard]] double share() const { return values_ > 0 ? shares_ / values_ : 0; }

 private:
  double by_;
  bool relative_;
  int values_ = 0;
  double shares_ = 0;
};

// Moves the emissivity of a material by its stated numbers. Returns false if the emissivity follows
// from other quantities.
[[nodiscard]] bool move_emissivity(Mover& mover, schema::Material& material);

}  // namespace irsig
