#include "core/signature/view/row_tally.h"

namespace irsig {

RowEstimate estimates_of(std::span<const RowTally> tally) {
  std::vector<double> flat;
  const auto flatten = [&](const RowTally& of_replicate) {
    flat.clear();
    of_replicate.for_each([&](double x) { flat.push_back(x); });
  };
  flatten(tally.front());
  ReplicateStatistics statistics(flat.size());
  for (const RowTally& of_replicate : tally) {
    flatten(of_replicate);
    statistics.add(flat);
  }
  RowEstimate out;
  out.reset(tally.front().part.size(), tally.front().total_spectrum.size());
  std::size_t next = 0;
  out.for_each([&](Estimate& e) { e = statistics.estimate(next++); });
  return out;
}

}  // namespace irsig
