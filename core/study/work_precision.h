#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/study/view_estimator.h"

namespace irsig {

// The error of one row as a function of the time spent on it, for several ways of estimating it.

// The quantity whose relative error is studied. For the spectrum: root mean square over the stored
// wavelengths, each relative to its own value.
enum class StudiedQuantity { kIntensity, kSpectrum, kEmitted, kArea };
inline constexpr std::size_t kStudiedQuantities = 4;

// The reference for errors, with its own relative standard error.
struct ReferenceValue {
  RowValue value;
  double apparent_intensity_w_sr = 0;
  double relative_stderr[kStudiedQuantities]{};
};

struct WorkPoint {
  std::uint64_t samples_per_replicate = 0;
  double samples = 0;  // primary rays, all replicates; mean over the seeds
  double cpu_s = 0;    // mean over the seeds
  std::uint32_t seeds = 0;
  double relative_error[kStudiedQuantities]{};  // root mean square over the seeds
  // Likewise of the standard errors that the runs' own replicates give: the random part of the
  // error, known much better than from a few seeds. 0: the method has no replicates.
  double relative_stderr[kStudiedQuantities]{};
  // Requested relative error of the in-band intensity. 0: a number of samples was requested, and no
  // such error is stated.
  double asked_relative_error = 0;
  double relative_numerical_error = 0;  // as the runs state it: rms over the seeds
};

// A way of estimating one row: value, primary rays and CPU time at a number of samples and a seed.
struct EstimateRun {
  RowValue value;
  double samples = 0;
  double relative_stderr[kStudiedQuantities]{};  // 0: no replicates
  // Results of whole runs, which choose their samples themselves.
  std::uint64_t samples_per_replicate = 0;
  double relative_numerical_error = 0;
};
struct WorkMethod {
  std::string name;
  std::function<EstimateRun(std::uint64_t samples_per_replicate, std::uint64_t seed)> estimate;
  std::uint64_t first_samples = 64;  // grows by factors of 4
};

// CPU time of the process [s].
using CpuClock = std::function<double()>;

struct WorkBudget {
  double cpu_s = 5;
  // > 0: so many primary rays instead, pilots not counted. What is run then depends on the seeds
  // alone, and on no clock.
  double primary_rays = 0;
  std::uint32_t least_seeds = 8, most_seeds = 16;
  std::uint64_t most_samples_per_replicate = 1u << 18;
};

// Runs a method at 4 times as many samples again and again, at each with several seeds, until the
// next step would not fit into the budget. At least two steps.
[[nodiscard]] std::vector<WorkPoint> work_curve(const WorkMethod& method,
                                                const ReferenceValue& reference,
                                                const WorkBudget& budget, const CpuClock& cpu_s);

// A way of computing one row from its request to its stored errors: pilots, air, sky and sea of the
// view included.
struct WholeRunMethod {
  std::string name;
  std::function<absl::StatusOr<EstimateRun>(double relative_error, std::uint64_t seed)> simulate;
};

// Runs it for each relative error asked, the largest first, each with several seeds, until the next
// would not fit into the budget. At least two.
[[nodiscard]] absl::StatusOr<std::vector<WorkPoint>> whole_run_curve(
    const WholeRunMethod& method, std::span<const double> relative_errors,
    const ReferenceValue& reference, const WorkBudget& budget, const CpuClock& cpu_s);

// Returns a row of a whole run.
[[nodiscard]] EstimateRun run_of(const ViewResult& view, std::size_t row);
// Returns the i-th row of a view as a run.
[[nodiscard]] EstimateRun run_of(const ViewValue& view, std::size_t row);

// Returns the mean over runs of `estimator` with seeds that no work_curve uses, of
// `samples_per_replicate` each, until the budget is spent (at least two runs).
[[nodiscard]] ReferenceValue reference_value(const ViewEstimator& estimator,
                                             const EstimatorOptions& knobs, ViewRow row,
                                             std::uint64_t samples_per_replicate,
                                             const WorkBudget& budget, const CpuClock& cpu_s);

// ---- arithmetic on curves of (work, error): the same for time and for samples

struct WorkError {
  double work, error;  // both > 0
};
// Returns the error of the quantity against CPU time, or against primary rays.
[[nodiscard]] std::vector<WorkError> against_time(const std::vector<WorkPoint>& points,
                                                  StudiedQuantity what);
[[nodiscard]] std::vector<WorkError> against_samples(const std::vector<WorkPoint>& points,
                                                     StudiedQuantity what);
// Returns the random part of the error (relative_stderr; relative_error without one) against the
// samples of the main stratum in each replicate. These alone set the rate of convergence, since
// strata of hot parts have a least number of samples.
[[nodiscard]] std::vector<WorkError> against_main_samples(const std::vector<WorkPoint>& points,
                                                          StudiedQuantity what);

// Fits the exponent of error ~ work^slope: least squares of the logarithms over the points whose
// error is at least `floor` (the reference's own error; 0: all points). Returns none for fewer than
// 3 points.
[[nodiscard]] std::optional<double> error_slope(const std::vector<WorkError>& curve, double floor);

// The work at which the error comes down to `target` and stays below it, linear in the logarithms
// between points. Beyond the last point: the curve's slope if it is below -0.25, and then
// `extrapolated`. None where a curve levels off above the target.
struct WorkToTarget {
  double work = 0;
  bool extrapolated = false;
};
[[nodiscard]] std::optional<WorkToTarget> work_to_target(const std::vector<WorkError>& curve,
                                                         double target, double floor);

// Interpolates the error at a given work; none outside the curve.
[[nodiscard]] std::optional<double> error_at_work(const std::vector<WorkError>& curve, double work);

}  // namespace irsig
