#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace irsig {

struct Estimate {
  double value = 0;
  double stderr_ = 0;  // one sigma of the mean over replicates
};

// Mean and standard error of many quantities over independent replicates, added in a fixed order.
// [welford1962]
class ReplicateStatistics {
 public:
  explicit ReplicateStatistics(std::size_t quantities = 0)
      : mean_(quantities, 0.0), m2_(quantities, 0.0) {}
  // Adds one replicate's values of all quantities.
  void add(std::span<const double> values);
  [[nodiscard]] Estimate estimate(std::size_t quantity) const;
  [[nodiscard]] std::uint32_t replicates() const { return count_; }

 private:
  std::vector<double> mean_, m2_;
  std::uint32_t count_ = 0;
};

// Returns the numerical error of a value: sqrt(stderr^2 + undersampling_stderr^2 + (sum of |bias
// bounds|)^2 / 3). A bias known only to lie within a bound of 0 counts as uniformly distributed
// there.
[[nodiscard]] double numerical_error(double stderr_of_mean, double undersampling_stderr,
                                     double sum_of_bias_bounds);

// Returns the standard error, undersampling included, with which a value's numerical error reaches
// `goal`: the part that its bias bounds leave. If they take more than 0.8 of the goal, samples
// cannot mend it: the standard error is then brought to 0.6 of the goal, and the value misses it.
[[nodiscard]] double stderr_wanted(double goal, double sum_of_bias_bounds);

// Returns the most that reflections after the last allowed one could have added.
//
//   beyond       the throughput that goes on after N - 2 s, N - s and N reflections (N: the last
//                allowed; s: spacing >= 1)
//   last         contribution of the paths of exactly N reflections
//   at_most      throughput beyond N x the brightest radiance that it can meet: a rigorous bound
//
// Where the throughput falls geometrically - the logarithms of the two ratios agree to a quarter -
// and `last` is known to a tenth, the rest is the geometric series last x r / (1 - r), r^s the last
// ratio; half of it is added for the uncertainty that the test of the ratios leaves. Else, or if
// that is larger: at_most.
[[nodiscard]] double truncation_bound(const std::array<double, 3>& beyond, std::uint32_t spacing,
                                      const Estimate& last, double at_most);

// Returns the samples that a replicate needs for a standard error of `target`, from a pilot's
// standard errors e1, e2 at n1 < n2 samples: the error falls as n^-s with s from the pilot, held in
// [0.5, 0.7] (plain Monte Carlo .. Owen-scrambled Sobol on silhouettes). The pilot's own scatter
// (32 replicates: 13 %) is met by aiming at 0.8 of the target. At least n2, at most n_max.
[[nodiscard]] std::uint64_t samples_needed(std::uint64_t n1, double e1, std::uint64_t n2, double e2,
                                           double target, std::uint64_t n_max);

// Like samples_needed(), where an undersampling error, which falls as 1 / n from `unseen` at n2, is
// part of `wanted`: the smallest number over all divisions of `wanted` between the two errors.
[[nodiscard]] std::uint64_t samples_needed_with_unseen(std::uint64_t n1, double e1,
                                                       std::uint64_t n2, double e2, double unseen,
                                                       double wanted, std::uint64_t n_max);

// Returns the two-sided bound on |t| (replicates - 1 degrees of freedom) that all of `rows`
// independent correct rows keep with probability about 0.999: |t| < t(1 - 0.0005 / rows).
[[nodiscard]] double student_t_bound(std::uint32_t degrees_of_freedom, std::uint64_t rows);

}  // namespace irsig
