#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace irsig {

// How a day's end answers to its begin, of a typical element of a wall: the matrix A of dEnd =
// A dBegin, by which a day that does not return to its begin says where the one does that will:
// (1 - A)^-1 (end - begin) further. The elements' own differ a little: their begins come nearer by
// that factor from day to day.
class DayResponse {
 public:
  // One element more than nodes: the first one's day began somewhere, each other's kProbeK warmer
  // at one node, in their order.
  static constexpr double kProbeK = 1;
  //   end_k  [element x nodes + node]
  DayResponse(std::span<const double> end_k, std::size_t nodes);

  // In: end less begin, [node]; out: how far the begin is from that of the day that repeats.
  void go_on(std::span<double> change_k) const;

 private:
  std::size_t nodes_;
  std::vector<double> inverse_;  // of 1 - A, [row x nodes + column]
};

}  // namespace irsig
