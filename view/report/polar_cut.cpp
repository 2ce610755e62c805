#include "view/report/polar_cut.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/base/status_macros.h"
#include "core/geo/viewpoint.h"
#include "view/query/interpolate_rows.h"

namespace irsig {
namespace {

constexpr std::size_t kFewestOnRing = 8;
constexpr double kOnRingDeg = 0.01;
constexpr int kAzimuthStepDeg = 2;
// Directions closer than this are one viewpoint: 1e-7 rad is 0.5 mm at 5 km.
constexpr double kSameCutDirection = 1e-7;
// The 48 nearest of evenly spread samples lie within 4 spacings; those outside of so many are not
// looked at, unless one of the 48 turns out to be as far away.
constexpr double kBeltSpacings = 5;
constexpr std::size_t kWorthABelt = 1000;

SphereSamples samples_of(std::span<const StoredValue> values) {
  SphereSamples out;
  for (const StoredValue& v : values) {
    out.direction.push_back(body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg));
    out.value.push_back(v.value);
    out.value_stderr.push_back(v.value_stderr);
  }
  return out;
}

// Without those that share their direction with an earlier one.
std::vector<StoredValue> distinct(std::span<const StoredValue> values) {
  std::vector<Vec<Body>> direction;
  for (const StoredValue& v : values)
    direction.push_back(body_from_aspect(v.aspect_azimuth_deg, v.aspect_elevation_deg));
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return direction[a].x < direction[b].x; });
  std::vector<bool> again(values.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const std::size_t a = order[i], b = order[j];
      if (direction[b].x - direction[a].x >= kSameCutDirection) break;
      if (length(direction[b] - direction[a]) < kSameCutDirection) again[std::max(a, b)] = true;
    }
  std::vector<StoredValue> out;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!again[i]) out.push_back(values[i]);
  return out;
}

bool on_ring(const StoredValue& v, double elevation_deg, double tolerance_deg) {
  return std::abs(v.aspect_elevation_deg - elevation_deg) <= tolerance_deg;
}

std::size_t count_on_ring(std::span<const StoredValue> values, double elevation_deg) {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [&](const auto& v) {
    return on_ring(v, elevation_deg, kOnRingDeg);
  }));
}

bool covered_all_around(const SphereSamples& samples, double elevation_deg) {
  for (int azimuth = 0; azimuth < 360; azimuth += 10)
    if (!uncovered(samples, body_from_aspect(azimuth, elevation_deg)).empty()) return false;
  return true;
}

absl::StatusOr<double> lowest_elevation_deg(std::span<const StoredValue> values,
                                            const SphereSamples& samples) {
  double low = 90;
  for (const StoredValue& v : values) low = std::min(low, v.aspect_elevation_deg);
  if (count_on_ring(values, low) >= kFewestOnRing) return low;
  for (double at = std::ceil(low); at <= 60; ++at)
    if (covered_all_around(samples, at)) return at;
  return absl::OutOfRangeError("no elevation is covered by viewpoints all around the target");
}

// The samples of a belt around the ring, which hold the neighbours of all of its points; all of
// them where there are few.
class Belt {
 public:
  Belt(std::span<const StoredValue> values, const SphereSamples& all, double elevation_deg)
      : all_(all) {
    if (values.size() < kWorthABelt) return;
    half_width_deg_ = kBeltSpacings *
                      std::sqrt(2 * std::numbers::pi / static_cast<double>(values.size())) * 180 /
                      std::numbers::pi;
    std::vector<StoredValue> inside;
    for (const StoredValue& v : values)
      if (on_ring(v, elevation_deg, half_width_deg_)) inside.push_back(v);
    belt_ = samples_of(inside);
  }

  // Returns the estimate at a point of the ring.
  [[nodiscard]] absl::StatusOr<SphereEstimate> estimate(const QuantityColumns& quantity,
                                                        Vec<Body> where,
                                                        const SphereKernel& kernel) const {
    if (!belt_.direction.empty()) {
      const auto fit = SphereFit::at(belt_, where, kernel);
      // Samples outside of the belt are farther away than its width.
      const double reach = 2 * std::sin(half_width_deg_ * std::numbers::pi / 360);
      if (fit.ok() && fit->used().size() >= 2 &&
          length(belt_.direction[fit->used().back()] - where) < reach)
        return value_of(quantity, *fit, belt_);
    }
    ASSIGN_OR_RETURN(const auto fit, SphereFit::at(all_, where, kernel));
    return value_of(quantity, fit, all_);
  }

 private:
  static SphereEstimate value_of(const QuantityColumns& quantity, const SphereFit& fit,
                                 const SphereSamples& samples) {
    std::vector<double> value, value_stderr;
    for (const std::size_t i : fit.used()) {
      value.push_back(samples.value[i]);
      value_stderr.push_back(samples.value_stderr[i]);
    }
    return estimate_of(kind_of(quantity.quantity), fit, value, value_stderr);
  }

  const SphereSamples& all_;
  SphereSamples belt_;
  double half_width_deg_ = 0;
};

}  // namespace

std::vector<StoredValue> values_of(std::span<const StoredSignature> signatures,
                                   const QuantityColumns& quantity) {
  std::vector<StoredValue> out;
  for (const StoredSignature& s : signatures)
    out.push_back({s.row, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.*quantity.value,
                   s.*quantity.value_stderr, s.*quantity.numerical_error,
                   input_uncertainty_of(quantity, s)});
  return out;
}

absl::StatusOr<PolarCut> polar_cut(std::span<const StoredValue> all,
                                   const QuantityColumns& quantity,
                                   std::optional<double> elevation_deg) {
  if (elevation_deg && !(std::abs(*elevation_deg) < 90))
    return absl::InvalidArgumentError(
        fmt::format("elevation {:g} deg: expected between -90 and 90", *elevation_deg));
  RETURN_IF_ERROR(check_computed(all, quantity.quantity));
  const std::vector<StoredValue> values = distinct(all);
  const SphereSamples samples = samples_of(values);
  if (!elevation_deg) {
    ASSIGN_OR_RETURN(elevation_deg, lowest_elevation_deg(values, samples));
  }
  PolarCut out;
  out.elevation_deg = *elevation_deg;
  out.interpolated = count_on_ring(values, *elevation_deg) < kFewestOnRing;
  for (const StoredValue& v : values)
    if (on_ring(v, *elevation_deg, out.interpolated ? kNearRingDeg : kOnRingDeg))
      out.mark.push_back({v.aspect_azimuth_deg, v.value, v.numerical_error,
                          std::isnan(v.input_uncertainty) ? 0 : v.input_uncertainty});
  std::sort(out.mark.begin(), out.mark.end(),
            [](const auto& a, const auto& b) { return a.azimuth_deg < b.azimuth_deg; });
  if (!out.interpolated) {
    out.point = out.mark;
    return out;
  }
  ASSIGN_OR_RETURN(const auto kernel, SphereFit::choose_kernel(samples));
  const Belt belt(values, samples, *elevation_deg);
  for (int azimuth = 0; azimuth < 360; azimuth += kAzimuthStepDeg) {
    const auto e = belt.estimate(quantity, body_from_aspect(azimuth, *elevation_deg), kernel);
    if (!e.ok())
      return absl::Status(e.status().code(),
                          fmt::format("cannot draw elevation {:g} deg at azimuth {} deg: {}",
                                      *elevation_deg, azimuth, std::string(e.status().message())));
    out.point.push_back({static_cast<double>(azimuth), e->value,
                         std::hypot(e->value_stderr, e->interpolation_error)});
  }
  return out;
}

}  // namespace irsig
