#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/geo/frames.h"
#include "view/rows/convex_bounds.h"

namespace irsig {

// A scalar known at scattered directions on the sphere (all at the same range).
struct SphereSamples {
  std::vector<Vec<Body>> direction;  // unit vectors target -> sensor, no two alike
  std::vector<double> value;
  std::vector<double> value_stderr;  // one sigma, same unit as value
};

// Covariance of the field as a function of the chord between two directions: Matern with smoothness
// 3/2 or 5/2.
struct SphereKernel {
  bool twice_differentiable;
  double length;  // chord on the unit sphere
};

// Possible variation of a field between its samples.
enum class FieldKind {
  kFacets,        // facets of a body add to it, none takes away: intensity, area, a part, a cause
  kSignedFacets,  // some facets take away: contrast
  kSmooth,        // no facets: radiance of the background, transmittance
};

struct SphereEstimate {
  double value;
  double value_stderr;         // of the samples, propagated through the weights
  double interpolation_error;  // one sigma, of both below; 0 at a sample
  double rough_error;          // from the samples' own scatter
  double hidden_error;         // possible effect of facets between samples, whatever the scatter
};

// Interpolation at one direction, by ordinary kriging on the nearest samples. The weights depend on
// directions, standard errors and kernel only, so that they can be applied to any quantity known at
// the same directions (spectra, parts).
//
//   value = m + k' C^-1 (v - m 1)                                 [rasmussen2006, eq. 2.25, 2.42]
//   error = s sqrt(1 - k' C^-1 k + (1 - 1' C^-1 k)^2 / 1' C^-1 1 - w' diag(stderr^2) w / s^2)
//
// with C = K + diag(stderr^2) / s^2 and s from the samples' own scatter. The error is multiplied by
// the rms of the standardized leave-one-out residuals of the 12 nearest samples, or by the largest
// of the 6 nearest, where that exceeds 1. For a field made by facets, the stated error combines 0.4
// of this error with the bounds of convex_bounds.h, which count as three standard errors. Where the
// samples contradict a convex body, it combines all of this error with the bounds of an even field.
// Samples at equal steps can meet all facets of a regular body equally, and their scatter is then
// 0.
//
// Accuracy: calibrated on closed forms of convex bodies, on rings, grids, Fibonacci and clustered
// sets (tests/honesty/between_viewpoints_test.cpp; table in docs/evidence/stability.md).
// Limits: features narrower than the spacing that are not facets of a convex body (glints, gaps)
// affect neither the value nor its error.
class SphereFit {
 public:
  // Returns the kernel of greatest restricted likelihood, for at most 150 evenly chosen samples. At
  // least 6 samples are needed.
  static absl::StatusOr<SphereKernel> choose_kernel(const SphereSamples& samples);

  // Interpolates at a direction; without a kernel, with the best one for the samples around
  // `where`. OUT_OF_RANGE, with the reason: `where` lies outside the directions that the samples
  // cover; see `uncovered`.
  static absl::StatusOr<SphereFit> at(const SphereSamples& samples, Vec<Body> where,
                                      std::optional<SphereKernel> kernel = std::nullopt);

  // Returns the samples used, as indices into SphereSamples, nearest first; weight() returns their
  // weights (sum 1).
  [[nodiscard]] const std::vector<std::size_t>& used() const { return used_; }
  [[nodiscard]] const std::vector<double>& weight() const { return weight_; }

  // Returns a number proportional to rough_error^2; it depends only on directions, kernel and
  // standard errors.
  [[nodiscard]] double variance_factor() const { return variance_factor_; }
  [[nodiscard]] const SphereKernel& kernel() const { return kernel_; }

  // Estimates the value and error of a quantity; both vectors are in the order of used().
  [[nodiscard]] SphereEstimate estimate(const std::vector<double>& value,
                                        const std::vector<double>& value_stderr,
                                        FieldKind kind) const;

 private:
  // Rms distance of an estimate from the values that facets allow, and whether bounds give these.
  struct Hidden {
    double distance;
    bool is_bounded;
  };
  [[nodiscard]] double rough_error(const std::vector<double>& value) const;
  [[nodiscard]] double distance_of_even_field(const std::vector<double>& value) const;
  [[nodiscard]] Hidden hidden_at(double estimate, const std::vector<double>& value,
                                 const std::vector<double>& value_stderr, FieldKind kind) const;

  std::vector<std::size_t> used_;
  std::vector<double> weight_;
  std::vector<double> projector_;  // Q = C^-1 - C^-1 1 1' C^-1 / (1' C^-1 1), row-major
  double variance_factor_ = 0;
  SphereKernel kernel_{};
  std::optional<ConvexBounds> bounds_;  // indices into used_
};

// The value alone, at many directions of one set of samples: one solve for all of them (pictures).
class SphereSurface {
 public:
  static absl::StatusOr<SphereSurface> create(SphereSamples samples);
  [[nodiscard]] double value(Vec<Body> where) const;

 private:
  SphereSamples samples_;
  SphereKernel kernel_{};
  double trend_ = 0;
  std::vector<double> coefficient_;
};

// Returns the reason for which `where` cannot be interpolated from the samples; empty if it can.
// Interpolation needs samples around `where`, or an edge: `where` lies within 1.25 spacings of a
// sample and within the covered elevations. These are extended by a tenth of the spacing or, if
// smaller, of the range of elevations; by nothing where all nearby samples are 0. The nearest
// sample must be within 30 deg.
[[nodiscard]] std::string uncovered(const SphereSamples& samples, Vec<Body> where);

}  // namespace irsig
