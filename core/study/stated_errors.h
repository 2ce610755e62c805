#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/signature/simulator.h"

namespace irsig {

// Are the errors true that a row states of itself? Its values against a much longer run of the same
// view: the same effects, reflections, directions of the sky and wavelengths, other random numbers.
// What all these have in common (bias bounds) is not tested by that, but for rare bright paths.

enum class Stated : std::uint8_t { kIntensity, kApparent, kContrast, kArea, kSpectrum };
inline constexpr std::size_t kStated = 5;

// One value with its errors, and the longer run's.
struct StatedValue {
  double value = 0, stderr_ = 0;
  double numerical_error = std::numeric_limits<double>::quiet_NaN();  // NaN: none is stated
  double rounding = 0;  // by which the value may differ because of how it is stored or summed
  double reference = 0, reference_stderr = 0;

  // Returns |value - reference| beyond rounding, in stated standard errors; the second function in
  // numerical errors. If the error is 0: 0 without such a difference, else infinite.
  [[nodiscard]] double of_stderr() const;
  [[nodiscard]] double of_numerical_error() const;
};

struct StatedRow {
  std::uint32_t condition = 0, band = 0;  // of the request
  std::uint32_t reflections = 0;          // the most that its paths were given
  StatedValue in_band[kStated];           // kSpectrum: not used
  std::vector<StatedValue> spectrum;      // on the stored wavelengths
};

struct LongerRun {
  double times = 100;                     // as many samples as the rows' own run
  std::uint64_t row_samples = 0;          // of a replicate, of that run; 0: as the view's plan says
  std::uint64_t seed_offset = 1;          // > 0
  std::uint64_t most_samples = 1u << 23;  // of a replicate
};

struct CheckedErrors {
  std::vector<StatedRow> row;  // with their references
  double times = 0;  // as many samples as the rows' own run; less where most_samples limits
  std::uint64_t samples = 0;  // primary rays of the longer run
};

// Compares the rows of one view with a longer run. The request is the one that they were computed
// for, of any selection. FAILED_PRECONDITION: its plan differs from theirs (another version of the
// program made them).
[[nodiscard]] absl::StatusOr<CheckedErrors> check_stated_errors(const Simulator& simulator,
                                                                ViewRequest request,
                                                                std::vector<StatedRow> rows,
                                                                const LongerRun& longer);

struct StatedErrorSummary {
  std::size_t values = 0;
  // |value - reference| / standard error. Of a true error about 0.67, 2.0 and, of 1000 independent
  // values, 3.5 (Student's t of 31 degrees of freedom).
  double median = 0, percentile_95 = 0, largest = 0;
  std::size_t with_numerical_error = 0, beyond_2 = 0, beyond_5 = 0;  // numerical errors
  double largest_of_numerical_error = 0;
};
[[nodiscard]] StatedErrorSummary summary_of(std::span<const StatedRow> rows, Stated what);

}  // namespace irsig
