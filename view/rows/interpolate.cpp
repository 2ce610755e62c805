#include "view/rows/interpolate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "core/base/status_macros.h"
#include "view/rows/kriging.h"

namespace irsig {
namespace {

constexpr std::size_t kFewestSamples = 6;
// More neighbours change nothing (weights beyond the third ring are < 1e-3) and cost n^3.
constexpr std::size_t kNeighbours = 48;
constexpr std::size_t kKernelSamples = 150;
constexpr std::size_t kResiduals = 12;
// Residuals around a direction: a kink near it shows in some of them only.
constexpr std::size_t kNearResiduals = 6;
// Weight of the scatter for facets, beside the bounds. Calibrated: 0.3 to 0.5 keep every family of
// convex bodies in docs/evidence/stability.md between 0.5 and 1.3 errors rms.
constexpr double kRoughOfFacets = 0.4, kRoughOfSignedFacets = 0.5;
// The bounds of what facets can hide count as three standard errors from their middle: the rms of a
// uniform distribution between them is 1 / sqrt(3) of half their distance, and this factor is a
// third of it.
constexpr double kHiddenOfBounds = 1 / std::numbers::sqrt3;
// Largest distance of the edge of a set from the nearest viewpoint: the lowest zone of a Fibonacci
// hemisphere has directions at 1.16 spacings.
constexpr double kEdgeSpacings = 1.25;
// Largest distance beyond the elevations of the viewpoints: the lowest zone of a Fibonacci set is
// less than this above its limit.
constexpr double kBeyondSpacings = 0.1;
constexpr double kRoundingDeg = 1e-3;
// The covering radius of 24 viewpoints on a hemisphere is 26 deg; fewer viewpoints tell nothing
// about the directions between them.
constexpr double kFurthestDeg = 30;
constexpr double kSamePlace = 1e-7;  // 0.5 mm at 5 km

double to_deg(double rad) { return rad * 180 / std::numbers::pi; }

double angle_deg(Vec<Body> a, Vec<Body> b) {
  return to_deg(2 * std::asin(std::min(1.0, 0.5 * chord(a, b))));
}

// 0 for directions above the horizon's plane is the body frame's z down: elevation = asin(-z).
double elevation_deg(Vec<Body> a) { return to_deg(std::asin(std::clamp(-a.z, -1.0, 1.0))); }

SphereSamples subset(const SphereSamples& s, const std::vector<std::size_t>& index) {
  SphereSamples out;
  for (std::size_t i : index) {
    out.direction.push_back(s.direction[i]);
    out.value.push_back(s.value[i]);
    out.value_stderr.push_back(s.value_stderr[i]);
  }
  return out;
}

SphereSamples evenly(const SphereSamples& s, std::size_t at_most) {
  const std::size_t stride = (s.direction.size() + at_most - 1) / at_most;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < s.direction.size(); i += stride) index.push_back(i);
  return subset(s, index);
}

std::vector<std::size_t> nearest(const SphereSamples& s, Vec<Body> where, std::size_t count) {
  std::vector<std::size_t> index(s.direction.size());
  std::iota(index.begin(), index.end(), std::size_t{0});
  std::vector<double> distance;
  for (const auto& d : s.direction) distance.push_back(chord(d, where));
  const std::size_t n = std::min(count, index.size());
  std::partial_sort(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(n), index.end(),
                    [&](std::size_t a, std::size_t b) {
                      return distance[a] != distance[b] ? distance[a] < distance[b] : a < b;
                    });
  index.resize(n);
  return index;
}

// Median over the samples of the chord to the nearest other one.
double spacing(const std::vector<Vec<Body>>& direction) {
  std::vector<double> gap;
  for (std::size_t i = 0; i < direction.size(); ++i) {
    double least = 2;
    for (std::size_t j = 0; j < direction.size(); ++j) {
      if (i != j) least = std::min(least, chord(direction[i], direction[j]));
    }
    gap.push_back(least);
  }
  const auto middle = gap.begin() + static_cast<std::ptrdiff_t>(gap.size() / 2);
  std::nth_element(gap.begin(), middle, gap.end());
  return *middle;
}

// The widest gap between the bearings, as seen from `where`, of the samples in `index`.
double widest_bearing_gap_deg(const SphereSamples& s, Vec<Body> where,
                              const std::vector<std::size_t>& index) {
  const Vec<Body> aside = std::abs(where.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
  const Vec<Body> e1 = normalized(cross(where, aside));
  const Vec<Body> e2 = cross(where, e1);
  std::vector<double> bearing;
  for (std::size_t i : index) {
    bearing.push_back(to_deg(std::atan2(dot(s.direction[i], e2), dot(s.direction[i], e1))));
  }
  std::sort(bearing.begin(), bearing.end());
  double widest = bearing.front() + 360 - bearing.back();
  for (std::size_t i = 1; i < bearing.size(); ++i) {
    widest = std::max(widest, bearing[i] - bearing[i - 1]);
  }
  return widest;
}

}  // namespace

std::string uncovered(const SphereSamples& samples, Vec<Body> where) {
  const std::vector<std::size_t> around = nearest(samples, where, kNeighbours);
  if (around.size() < kFewestSamples) {
    return fmt::format("interpolation needs at least {} viewpoints of one range, there are {}",
                       kFewestSamples, around.size());
  }
  const double closest_deg = angle_deg(samples.direction[around.front()], where);
  if (closest_deg > kFurthestDeg) {
    return fmt::format("the nearest viewpoint is {:.1f} deg away (at most {:.0f} deg)", closest_deg,
                       kFurthestDeg);
  }
  const double spacing_deg = to_deg(spacing(subset(samples, around).direction));
  // Local: a far ring of viewpoints around the zenith surrounds nothing.
  const double reach_deg = std::max(3.5 * closest_deg, 2 * spacing_deg);
  std::vector<std::size_t> ring;
  for (std::size_t i : around) {
    if (angle_deg(samples.direction[i], where) <= reach_deg) ring.push_back(i);
  }
  if (closest_deg < 1e-6 * spacing_deg) return "";
  if (widest_bearing_gap_deg(samples, where, ring) < 180) return "";
  const auto [low, high] = std::minmax_element(
      samples.direction.begin(), samples.direction.end(),
      [](Vec<Body> a, Vec<Body> b) { return elevation_deg(a) < elevation_deg(b); });
  const double elevation = elevation_deg(where);
  const double low_deg = elevation_deg(*low), high_deg = elevation_deg(*high);
  // Beyond its viewpoints' elevations a set shows how the field changes only as far as the set is
  // wide: a raft is dark at elevation 0 and bright beside it. Viewpoints that see no light show
  // nothing.
  const bool is_dark = std::all_of(around.begin(), around.end(),
                                   [&](std::size_t i) { return samples.value[i] == 0; });
  const double beyond_deg =
      is_dark ? 0 : kBeyondSpacings * std::min(spacing_deg, high_deg - low_deg);
  if (elevation < low_deg - std::max(beyond_deg, kRoundingDeg) ||
      elevation > high_deg + std::max(beyond_deg, kRoundingDeg)) {
    if (high_deg - low_deg < kRoundingDeg) {
      return fmt::format(
          "elevation {:.2f} deg is beside a single ring of viewpoints (elevation {:.2f} deg), "
          "which "
          "shows nothing of other elevations; add viewpoints above and below",
          elevation, low_deg);
    }
    return fmt::format(
        "elevation {:.2f} deg is outside the viewpoints' elevations ({:.2f} to {:.2f} deg){}",
        elevation, low_deg, high_deg, is_dark ? ", and the viewpoints near it are all 0" : "");
  }
  if (closest_deg > kEdgeSpacings * spacing_deg) {
    return fmt::format(
        "no viewpoints around it: the nearest one is {:.1f} deg away on one side, their spacing "
        "is {:.1f} deg",
        closest_deg, spacing_deg);
  }
  return "";
}

absl::StatusOr<SphereKernel> SphereFit::choose_kernel(const SphereSamples& samples) {
  const std::size_t n = samples.direction.size();
  if (n < kFewestSamples) {
    return absl::OutOfRangeError(
        fmt::format("interpolation needs at least {} viewpoints of one range, there are {}",
                    kFewestSamples, n));
  }
  const SphereSamples taken = evenly(samples, kKernelSamples);
  const double unit = spacing(taken.direction);
  std::optional<SphereKernel> best;
  double least = 0;
  for (bool twice : {false, true}) {
    // Shorter than 0.7 spacings: the samples know nothing of each other; longer than 20: no change
    // of the weights.
    for (double lengths : {0.7, 1.0, 1.5, 2.2, 3.3, 5.0, 7.5, 11.0, 20.0}) {
      const SphereKernel kernel{twice, lengths * unit};
      const auto factored = factor_covariance(taken, kernel);
      if (!factored) continue;
      if (!best || factored->negative_log_likelihood < least) {
        best = kernel;
        least = factored->negative_log_likelihood;
      }
    }
  }
  if (!best) return absl::InternalError("interpolation: two viewpoints coincide");
  return *best;
}

absl::StatusOr<SphereFit> SphereFit::at(const SphereSamples& samples, Vec<Body> where,
                                        std::optional<SphereKernel> kernel) {
  if (const std::string why = uncovered(samples, where); !why.empty()) {
    return absl::OutOfRangeError(why);
  }
  SphereFit fit;
  fit.used_ = nearest(samples, where, kNeighbours);
  const SphereSamples local = subset(samples, fit.used_);
  if (!kernel) {
    ASSIGN_OR_RETURN(kernel, choose_kernel(local));
  }
  fit.kernel_ = *kernel;
  const auto factored = factor_covariance(local, *kernel);
  if (!factored) return absl::InternalError("interpolation: two viewpoints coincide");

  const std::size_t n = fit.used_.size();
  std::vector<double> k(n);
  for (std::size_t i = 0; i < n; ++i) k[i] = covariance(*kernel, chord(local.direction[i], where));
  const std::vector<double> c_inv_k = factored->c.solve(k);
  const double shortfall = 1 - std::accumulate(c_inv_k.begin(), c_inv_k.end(), 0.0);
  const double one = factored->one_c_inv_one;
  fit.weight_ = c_inv_k;
  for (std::size_t i = 0; i < n; ++i) fit.weight_[i] += shortfall / one * factored->c_inv_one[i];
  // The samples' own errors are propagated by estimate(): what remains is the field between them.
  fit.variance_factor_ = 1 - inner(k, c_inv_k) + shortfall * shortfall / one;
  for (std::size_t i = 0; i < n; ++i) {
    fit.variance_factor_ -= fit.weight_[i] * fit.weight_[i] * factored->noise[i];
  }
  fit.variance_factor_ = std::max(0.0, fit.variance_factor_);

  // A sample is not between samples.
  if (chord(local.direction.front(), where) > kSamePlace) {
    std::vector<std::size_t> all(n);
    std::iota(all.begin(), all.end(), std::size_t{0});
    fit.bounds_.emplace(local.direction, all, where);
  }

  fit.projector_ = factored->c.inverse();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      fit.projector_[i * n + j] -= factored->c_inv_one[i] * factored->c_inv_one[j] / one;
  return fit;
}

SphereEstimate SphereFit::estimate(const std::vector<double>& value,
                                   const std::vector<double>& value_stderr, FieldKind kind) const {
  SphereEstimate out{};
  double noise = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    out.value += weight_[i] * value[i];
    noise += weight_[i] * weight_[i] * value_stderr[i] * value_stderr[i];
  }
  out.value_stderr = std::sqrt(noise);
  out.rough_error = rough_error(value);
  if (kind != FieldKind::kSmooth && bounds_) {
    const Hidden hidden = hidden_at(out.value, value, value_stderr, kind);
    out.hidden_error = kHiddenOfBounds * hidden.distance;
    if (hidden.is_bounded)
      out.rough_error *= kind == FieldKind::kFacets ? kRoughOfFacets : kRoughOfSignedFacets;
  }
  out.interpolation_error = std::hypot(out.rough_error, out.hidden_error);
  return out;
}

double SphereFit::rough_error(const std::vector<double>& value) const {
  const std::size_t n = used_.size();
  std::vector<double> projected(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) projected[i] += projector_[i * n + j] * value[j];
  }
  const double variance = std::max(0.0, inner(projected, value)) / static_cast<double>(n - 1);
  if (variance == 0) return 0;
  // Leave-one-out residual of sample j: projected_j / Q_jj, with standard deviation s / sqrt(Q_jj).
  double mean_square = 0, worst_near = 0;
  const std::size_t residuals = std::min(n, kResiduals);
  for (std::size_t j = 0; j < residuals; ++j) {
    const double square = projected[j] * projected[j] / (projector_[j * n + j] * variance);
    mean_square += square / static_cast<double>(residuals);
    if (j < kNearResiduals) worst_near = std::max(worst_near, square);
  }
  return std::sqrt(variance * variance_factor_ * std::max({1.0, mean_square, worst_near}));
}

// A field that is everywhere as bright as the brightest sample around here hides so much.
double SphereFit::distance_of_even_field(const std::vector<double>& value) const {
  const std::vector<double> ones(value.size(), 1.0), exact(value.size(), 0.0);
  const std::size_t near = std::min(value.size(), kResiduals);
  double brightest = 0;
  for (std::size_t i = 0; i < near; ++i) brightest = std::max(brightest, std::abs(value[i]));
  return brightest * rms_distance(1, bounds_->of(ones, exact)).value_or(1);
}

SphereFit::Hidden SphereFit::hidden_at(double estimate, const std::vector<double>& value,
                                       const std::vector<double>& value_stderr,
                                       FieldKind kind) const {
  ConvexBounds::Interval in = bounds_->of(value, value_stderr);
  if (kind == FieldKind::kFacets) {
    if (std::all_of(value.begin(), value.end(), [](double v) { return v >= 0; }))
      in.low = std::max(0.0, in.low.value_or(0));
    const auto distance = rms_distance(estimate, in);
    return {distance ? *distance : distance_of_even_field(value), distance.has_value()};
  }
  // Facets of either sign may cancel at the samples. A target that is darker than its background
  // everywhere has the bounds of its negative.
  Hidden out{distance_of_even_field(value), false};
  std::vector<double> negative = value;
  for (double& v : negative) v = -v;
  for (const auto& distance :
       {rms_distance(estimate, in), rms_distance(-estimate, bounds_->of(negative, value_stderr))}) {
    if (!distance) continue;
    out = {std::max(out.distance, *distance), true};
  }
  return out;
}

absl::StatusOr<SphereSurface> SphereSurface::create(SphereSamples samples) {
  ASSIGN_OR_RETURN(auto kernel, SphereFit::choose_kernel(samples));
  // The cost is cubic: 1500 samples take about 1 s, and no picture shows more.
  constexpr std::size_t kMost = 1500;
  if (samples.direction.size() > kMost) samples = evenly(samples, kMost);
  const auto factored = factor_covariance(samples, kernel);
  if (!factored) return absl::InternalError("interpolation: two viewpoints coincide");
  SphereSurface out;
  std::vector<double> residual = samples.value;
  for (double& r : residual) r -= factored->trend;
  out.coefficient_ = factored->c.solve(std::move(residual));
  out.trend_ = factored->trend;
  out.kernel_ = kernel;
  out.samples_ = std::move(samples);
  return out;
}

double SphereSurface::value(Vec<Body> where) const {
  double sum = trend_;
  for (std::size_t i = 0; i < coefficient_.size(); ++i) {
    sum += coefficient_[i] * covariance(kernel_, chord(samples_.direction[i], where));
  }
  return sum;
}

}  // namespace irsig
