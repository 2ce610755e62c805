#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace irsig {

// Response of a day's end to its begin, for a typical element of a wall: the matrix A of dEnd = A
// dBegin. From a day that does not return to its begin it extrapolates the begin of the day that
// does: (1 - A)^-1 (end - begin) further. The responses of other elements differ a little, so that
// each day reduces their errors by that factor.
class DayResponse {
 public:
  // One element more than nodes: the first one's day began somewhere, each other's kProbeK warmer
  // at one node, in their order.
  static constexpr double kProbeK = 1;
  //   end_k  [element x nodes + node]
  DayResponse(std::span<const double> end_k, std::size_t nodes);

  // Turns the change of a day (end less begin, [node]) into the distance of the begin from that of
  // the day that repeats.
  void go_on(std::span<double> change_k) const;

 private:
  std::size_t nodes_;
  std::vector<double> inverse_;  // of 1 - A, [row x nodes + column]
};

}  // namespace irsig
