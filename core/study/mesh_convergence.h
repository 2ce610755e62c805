#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace irsig {

// Dependence of the values of the same views on the number of facets of the target.

// A value with its error, one sigma, in the value's unit. An exact value has the error 0.
struct MeshValue {
  double value = 0, error = 0;
};

// A relative difference between two meshes, and the error of both together.   [1]
struct MeshDeviation {
  double value = 0, error = 0;
  // Returns |value| / error. If the error is 0: 0 without a difference, else infinite.
  [[nodiscard]] double significance() const;
};

// Returns of / from - 1, with independent errors. `from` is not 0; if both are 0, no deviation.
[[nodiscard]] MeshDeviation deviation(const MeshValue& of, const MeshValue& from);

// Deviations of one mesh over views. rms_error: what rms would be if there were nothing but errors.
struct DeviationSummary {
  double rms = 0, rms_error = 0;
  double rms_significance = 0;  // rms of |deviation| / error; 1 where there is nothing but errors
  std::size_t largest = 0;      // index of the largest |deviation|
  bool significant = false;     // beyond_errors() of them all
};
// Summarises at least one deviation.
[[nodiscard]] DeviationSummary summary_of(std::span<const MeshDeviation> deviations);

// Returns true if chi-square exceeds its expectation by 5 of its standard deviations. Of values
// with nothing but errors 1 in 400 does with 2 degrees of freedom, and fewer with more.
[[nodiscard]] bool beyond_errors(double chi_square, std::size_t degrees_of_freedom);

// Returns true if the values depend on the mesh beyond their errors.   value: [view][mesh], none of
// them 0
[[nodiscard]] bool varies(std::span<const std::vector<MeshValue>> value);

// Values in the limit of ever more facets N, by Richardson's extrapolation: each view's values are
// its limit + a factor of its own x N^-order, with one order for all views, by weighted least
// squares. Flat facets on a smooth surface have the order 1: facets of length h stand off it by
// h^2 / 8R.
//
// Ranges and errors are one sigma (chi-square may grow by 1), widened by sqrt(chi-square / degrees
// of freedom) where values scatter more than their errors: meshes need not follow a power.
struct MeshLimit {
  double order = 0, order_low = 0, order_high = 0;
  bool order_high_open = false;  // kMostOrder or more: the coarsest mesh alone is off
  double chi_square = 0;
  std::size_t degrees_of_freedom = 0;
  std::vector<MeshValue> limit;       // [view]
  std::vector<double> off_at_finest;  // [view] finest mesh - limit, as fitted; unit of the value
  double most_facets = 0;             // of the finest mesh

  // Returns the root mean square over the views of the fitted values at so many facets, over the
  // limit, - 1. [1]
  [[nodiscard]] double rms_off(double facets) const;
};

inline constexpr double kLeastOrder = 0.2, kMostOrder = 4;

// Fits the limit of values over the number of facets. Returns none for fewer than 3 different
// numbers of facets, and for an order that may be less than kLeastOrder, with which the limit may
// be anywhere.
//   facets  [mesh]
//   value   [view][mesh], none of them 0, with independent errors that vary
[[nodiscard]] std::optional<MeshLimit> mesh_limit(std::span<const double> facets,
                                                  std::span<const std::vector<MeshValue>> value);

}  // namespace irsig
