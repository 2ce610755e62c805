#pragma once

#include <span>
#include <vector>

namespace irsig {

// Finds the start of a day that repeats, for one element, by Anderson's method [walker2011]: the
// next guess is the mean of the last ends of days whose weights make the change over a day least.
// Private to core/thermal.
class PeriodicDay {
 public:
  struct Next {
    std::vector<double> begin_k;  // [node]
    double left_k;                // largest distance from the last begin to this one
  };
  // Takes a day's begin and end, and returns the next begin. [node]
  [[nodiscard]] Next next(std::span<const double> begin_k, std::span<const double> end_k);

 private:
  struct Day {
    std::vector<double> end_k, change_k;
  };
  std::vector<Day> days_;
};

}  // namespace irsig
