#include "view/query/refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/status_macros.h"
#include "view/rows/kriging.h"

namespace irsig {
namespace {

// So many directions for each viewpoint are looked at.
constexpr std::size_t kDirectionsPerViewpoint = 4;
constexpr int kRounds = 40;

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// Directions between the viewpoints of a set, as evenly as they come.
std::vector<Vec<Body>> directions_between(const SphereSamples& samples) {
  double lowest = 1, highest = -1;  // as z, which is down
  for (const Vec<Body>& d : samples.direction) {
    lowest = std::min(lowest, d.z);
    highest = std::max(highest, d.z);
  }
  const std::size_t count = kDirectionsPerViewpoint * samples.direction.size();
  // As many as that in the zone that is covered.
  const double zone = std::max(highest - lowest, 1e-3);
  std::vector<Vec<Body>> out;
  for (std::size_t n = 0; n < count; ++n) {
    const double z = lowest + zone * (static_cast<double>(n) + 0.5) / static_cast<double>(count);
    const double c = std::sqrt(std::max(0.0, 1 - z * z)),
                 azimuth = static_cast<double>(n) * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec<Body> where{c * std::cos(azimuth), c * std::sin(azimuth), z};
    if (uncovered(samples, where).empty()) out.push_back(where);
  }
  return out;
}

struct Aspect {
  double azimuth_deg, elevation_deg;
};
Aspect rounded(Vec<Body> d) {
  const double to_deg = 180 / std::numbers::pi;
  const auto hundredths = [](double deg) { return std::round(100 * deg) / 100; };
  const double azimuth = hundredths(std::atan2(d.y, d.x) * to_deg);
  return {azimuth < 0 ? azimuth + 360 : azimuth + 0.0,
          hundredths(std::asin(std::clamp(-d.z, -1.0, 1.0)) * to_deg) + 0.0};
}

std::pair<std::vector<double>, std::vector<double>> values_of(const SphereFit& fit,
                                                              const SphereSamples& samples) {
  std::pair<std::vector<double>, std::vector<double>> out;
  for (const std::size_t i : fit.used()) {
    out.first.push_back(samples.value[i]);
    out.second.push_back(samples.value_stderr[i]);
  }
  return out;
}

SphereEstimate estimate(const SphereFit& fit, const SphereSamples& samples, FieldKind kind) {
  const auto [value, value_stderr] = values_of(fit, samples);
  return estimate_of(kind, fit, value, value_stderr);
}

// Interpolation at one direction and field before viewpoints are added. More viewpoints change the
// geometry; the roughness of the field stays that of the real viewpoints. The bound of what facets
// hide is computed again, as if the added viewpoints had the interpolated values.
struct Before {
  double value, scale;  // errors are relative to the scale
  double error, rough_error, hidden_error;
  double variance_factor;
  SphereKernel kernel;
};

// A viewpoint at most so far away is taken as this direction's own.
constexpr double kOfItsOwn = 1e-3;

double relative_to(FieldKind kind, double value, double scale) {
  return kind == FieldKind::kSignedFacets ? scale : std::max(std::abs(value), 1e-6 * scale);
}

double nearest_chord(const SphereSamples& samples, Vec<Body> where) {
  double out = 2;
  for (const Vec<Body>& d : samples.direction) out = std::min(out, chord(d, where));
  return out;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

absl::StatusOr<std::vector<LeftOutViewpoint>> leave_one_out(const SignatureField& field,
                                                            FieldKind kind) {
  const SphereSamples& all = field.samples;
  const double scale = rms(all.value);
  std::vector<LeftOutViewpoint> out;
  for (std::size_t i = 0; i < all.direction.size(); ++i) {
    SphereSamples others = all;
    const auto at = static_cast<std::ptrdiff_t>(i);
    others.direction.erase(others.direction.begin() + at);
    others.value.erase(others.value.begin() + at);
    others.value_stderr.erase(others.value_stderr.begin() + at);
    const auto fit = SphereFit::at(others, all.direction[i]);
    if (absl::IsOutOfRange(fit.status())) continue;
    if (!fit.ok()) return fit.status();
    const SphereEstimate e = estimate(*fit, others, kind);
    const double of = relative_to(kind, all.value[i], scale);
    out.push_back({i, all.value[i], e.value,
                   std::hypot(e.interpolation_error, e.value_stderr, all.value_stderr[i]),
                   of > 0 ? std::abs(e.value - all.value[i]) / of : 0});
  }
  return out;
}

absl::StatusOr<Refinement> refine(std::span<const SignatureField> fields, FieldKind kind,
                                  double relative_error, std::size_t most) {
  std::vector<SphereSamples> samples;
  for (const SignatureField& f : fields) samples.push_back(f.samples);
  const std::vector<Vec<Body>> where = directions_between(samples.front());
  if (where.empty())
    return absl::FailedPreconditionError(
        "the viewpoints are too few, or do not surround any direction: there is nothing between "
        "them");
  std::vector<std::vector<Before>> before(where.size());  // [direction][field]
  for (std::size_t f = 0; f < samples.size(); ++f) {
    const double scale = rms(samples[f].value);
    for (std::size_t d = 0; d < where.size(); ++d) {
      const auto fit = SphereFit::at(samples[f], where[d]);
      if (!fit.ok()) return absl::FailedPreconditionError(fit.status().message());
      const SphereEstimate e = estimate(*fit, samples[f], kind);
      before[d].push_back({e.value, relative_to(kind, e.value, scale), e.interpolation_error,
                           e.rough_error, e.hidden_error, fit->variance_factor(), fit->kernel()});
    }
  }
  struct Worst {
    double relative_error;
    std::size_t field, direction;
  };
  Refinement out{};
  out.directions = where.size();
  for (int round = 0;; ++round) {
    std::vector<Worst> worst;
    for (std::size_t d = 0; d < where.size(); ++d) {
      Worst w{0, 0, d};
      // At the edge of closer viewpoints it is no longer between them: it needs one of its own.
      const bool lost = round > 0 && !uncovered(samples.front(), where[d]).empty() &&
                        nearest_chord(samples.front(), where[d]) > kOfItsOwn;
      for (std::size_t f = 0; f < samples.size(); ++f) {
        const Before& b = before[d][f];
        double now = b.scale > 0 ? b.error / b.scale : 0;
        if (round > 0 && !lost && now > 0) {
          ASSIGN_OR_RETURN(const auto fit, SphereFit::at(samples[f], where[d], b.kernel));
          const double rough =
              b.variance_factor > 0 ? std::min(1.0, fit.variance_factor() / b.variance_factor) : 0;
          const double hidden = estimate(fit, samples[f], kind).hidden_error;
          now = std::min(
              now, std::hypot(b.rough_error * std::sqrt(rough), std::min(hidden, b.hidden_error)) /
                       b.scale);
        }
        if (now > w.relative_error) w = {now, f, d};
      }
      if (lost) w.relative_error = std::max(w.relative_error, 2 * relative_error);
      worst.push_back(w);
    }
    std::stable_sort(worst.begin(), worst.end(), [](const Worst& a, const Worst& b) {
      return a.relative_error > b.relative_error;
    });
    const auto above =
        static_cast<std::size_t>(std::count_if(worst.begin(), worst.end(), [&](const Worst& w) {
          return w.relative_error > relative_error;
        }));
    if (round == 0) {
      out.largest_before = worst.front().relative_error;
      out.above_before = above;
    }
    out.largest_after = worst.front().relative_error;
    out.above_after = above;
    if (above == 0 || out.add.size() >= most || round == kRounds) break;
    // One viewpoint answers for what lies around it; the rest is seen in the next round.
    std::vector<Vec<Body>> taken;
    const SphereSamples known = samples.front();
    for (std::size_t k = 0; k < above && out.add.size() < most; ++k) {
      const Vec<Body> at = where[worst[k].direction];
      const double nearest = nearest_chord(known, at);
      if (nearest <= kOfItsOwn)
        continue;  // what is left is noise: another one beside it is no help
      if (std::any_of(taken.begin(), taken.end(),
                      [&](Vec<Body> other) { return chord(other, at) < 1.5 * nearest; }))
        continue;
      taken.push_back(at);
      const Aspect a = rounded(at);
      out.add.push_back({a.azimuth_deg, a.elevation_deg, worst[k].relative_error, worst[k].field});
      for (std::size_t f = 0; f < samples.size(); ++f) {
        const double usual = median(samples[f].value_stderr);
        samples[f].direction.push_back(at);
        samples[f].value.push_back(before[worst[k].direction][f].value);
        samples[f].value_stderr.push_back(usual);
      }
    }
    if (taken.empty()) break;
  }
  return out;
}

}  // namespace irsig
