#include "core/study/work_precision.h"

#include <algorithm>
#include <cmath>

namespace irsig {
namespace {

// Seeds of references and of curves never meet.
constexpr std::uint64_t kReferenceSeeds = std::uint64_t{1} << 40;

// Squared relative errors.
void add_squares(const RowValue& value, const RowValue& reference, double* sum) {
  const auto square = [](double a, double b) {
    const double relative = b != 0 ? a / b - 1 : a;
    return relative * relative;
  };
  sum[static_cast<int>(Measured::kIntensity)] +=
      square(value.intensity_w_sr, reference.intensity_w_sr);
  sum[static_cast<int>(Measured::kEmitted)] += square(value.emitted_w_sr, reference.emitted_w_sr);
  sum[static_cast<int>(Measured::kArea)] +=
      square(value.projected_area_m2, reference.projected_area_m2);
  const std::size_t bins = reference.spectral_w_sr_um.size();
  for (std::size_t k = 0; k < bins; ++k)
    sum[static_cast<int>(Measured::kSpectrum)] +=
        square(value.spectral_w_sr_um[k], reference.spectral_w_sr_um[k]) /
        static_cast<double>(bins);
}

struct Line {
  double slope, mean_x, mean_y;
};

Line fit(const std::vector<WorkError>& curve) {
  Line line{0, 0, 0};
  const double n = static_cast<double>(curve.size());
  for (const WorkError& p : curve) {
    line.mean_x += std::log(p.work) / n;
    line.mean_y += std::log(p.error) / n;
  }
  double xx = 0, xy = 0;
  for (const WorkError& p : curve) {
    const double dx = std::log(p.work) - line.mean_x;
    xx += dx * dx;
    xy += dx * (std::log(p.error) - line.mean_y);
  }
  line.slope = xx > 0 ? xy / xx : 0;
  return line;
}

std::vector<WorkError> above(const std::vector<WorkError>& curve, double floor) {
  std::vector<WorkError> out;
  for (const WorkError& p : curve)
    if (p.error > 0 && p.error >= floor) out.push_back(p);
  return out;
}

double between(double x, double x0, double y0, double x1, double y1) {
  if (x1 == x0) return y0;
  return std::exp(std::log(y0) +
                  (std::log(y1) - std::log(y0)) * std::log(x / x0) / std::log(x1 / x0));
}

std::vector<WorkError> against(const std::vector<WorkPoint>& points, Measured what,
                               double WorkPoint::*work) {
  std::vector<WorkError> out;
  for (const WorkPoint& p : points)
    out.push_back({p.*work, p.relative_error[static_cast<std::size_t>(what)]});
  return out;
}

}  // namespace

EstimateRun run_of(const ViewValue& view, std::size_t row) {
  EstimateRun out{view.row[row], static_cast<double>(view.samples), {}};
  const auto relative = [](double stderr_, double value) {
    return value != 0 ? std::abs(stderr_ / value) : 0;
  };
  const auto set = [&](Measured what, const Estimate& e) {
    out.relative_stderr[static_cast<std::size_t>(what)] = relative(e.stderr_, e.value);
  };
  set(Measured::kIntensity, view.intensity_w_sr[row]);
  set(Measured::kEmitted, view.emitted_w_sr[row]);
  set(Measured::kArea, view.projected_area_m2[row]);
  const std::vector<double>& spectrum = out.value.spectral_w_sr_um;
  double square = 0;
  for (std::size_t k = 0; k < spectrum.size(); ++k)
    square += std::pow(relative(view.spectral_stderr_w_sr_um[row][k], spectrum[k]), 2);
  out.relative_stderr[static_cast<std::size_t>(Measured::kSpectrum)] =
      std::sqrt(square / static_cast<double>(std::max<std::size_t>(spectrum.size(), 1)));
  return out;
}

std::vector<WorkPoint> work_curve(const WorkMethod& method, const ReferenceValue& reference,
                                  const WorkBudget& budget, const CpuClock& cpu_s) {
  std::vector<WorkPoint> out;
  const double start_s = cpu_s();
  // Caches and clock ticks: the first run of a method is not counted.
  (void)method.estimate(method.first_samples, 0);
  std::uint64_t seed = 1;
  for (std::uint64_t n = method.first_samples; n <= budget.most_samples_per_replicate; n *= 4) {
    const double left_s = budget.cpu_s - (cpu_s() - start_s);
    if (out.size() >= 2 && 3 * out.back().cpu_s * budget.least_seeds > left_s) break;
    WorkPoint point;
    point.samples_per_replicate = n;
    double sum[kMeasured]{}, random[kMeasured]{};
    const double begin_s = cpu_s();
    double spent_s = 0;
    // Many seeds while they are cheap; most of the budget is for the last steps.
    while (point.seeds < budget.least_seeds ||
           (point.seeds < budget.most_seeds && spent_s < left_s / 16)) {
      const EstimateRun run = method.estimate(n, seed++);
      ++point.seeds;
      point.samples += run.samples;
      spent_s = cpu_s() - begin_s;
      add_squares(run.value, reference.value, sum);
      for (std::size_t q = 0; q < kMeasured; ++q)
        random[q] += run.relative_stderr[q] * run.relative_stderr[q];
    }
    const double seeds = point.seeds;
    point.cpu_s = spent_s / seeds;
    point.samples /= seeds;
    for (std::size_t q = 0; q < kMeasured; ++q) {
      point.relative_error[q] = std::sqrt(sum[q] / seeds);
      point.relative_stderr[q] = std::sqrt(random[q] / seeds);
    }
    out.push_back(point);
  }
  return out;
}

ReferenceValue reference_value(const ViewEstimator& estimator, const EstimatorKnobs& knobs,
                               ViewRow row, std::uint64_t samples_per_replicate, double budget_s,
                               const CpuClock& cpu_s) {
  const double start_s = cpu_s();
  ReferenceValue out;
  double square[kMeasured]{};
  double n = 0;
  for (; n < 2 || cpu_s() - start_s < budget_s; ++n) {
    const ViewValue v = estimator.estimate(knobs, {&row, 1}, samples_per_replicate,
                                           kReferenceSeeds + static_cast<std::uint64_t>(n));
    const EstimateRun run = run_of(v, 0);
    const RowValue& r = run.value;
    out.value.intensity_w_sr += r.intensity_w_sr;
    out.value.emitted_w_sr += r.emitted_w_sr;
    out.apparent_intensity_w_sr += v.apparent_intensity_w_sr.front().value;
    out.value.projected_area_m2 += r.projected_area_m2;
    out.value.spectral_w_sr_um.resize(r.spectral_w_sr_um.size());
    for (std::size_t k = 0; k < r.spectral_w_sr_um.size(); ++k)
      out.value.spectral_w_sr_um[k] += r.spectral_w_sr_um[k];
    for (std::size_t q = 0; q < kMeasured; ++q)
      square[q] += run.relative_stderr[q] * run.relative_stderr[q];
  }
  out.value.intensity_w_sr /= n;
  out.value.emitted_w_sr /= n;
  out.apparent_intensity_w_sr /= n;
  out.value.projected_area_m2 /= n;
  for (double& value : out.value.spectral_w_sr_um) value /= n;
  for (std::size_t q = 0; q < kMeasured; ++q) out.relative_stderr[q] = std::sqrt(square[q]) / n;
  return out;
}

std::vector<WorkError> against_time(const std::vector<WorkPoint>& points, Measured what) {
  return against(points, what, &WorkPoint::cpu_s);
}

std::vector<WorkError> against_samples(const std::vector<WorkPoint>& points, Measured what) {
  return against(points, what, &WorkPoint::samples);
}

std::vector<WorkError> against_main_samples(const std::vector<WorkPoint>& points, Measured what) {
  std::vector<WorkError> out;
  for (const WorkPoint& p : points) {
    const auto q = static_cast<std::size_t>(what);
    out.push_back({static_cast<double>(p.samples_per_replicate),
                   p.relative_stderr[q] > 0 ? p.relative_stderr[q] : p.relative_error[q]});
  }
  return out;
}

std::optional<double> error_slope(const std::vector<WorkError>& curve, double floor) {
  const std::vector<WorkError> used = above(curve, floor);
  if (used.size() < 3) return std::nullopt;
  return fit(used).slope;
}

std::optional<WorkToTarget> work_to_target(const std::vector<WorkError>& curve, double target,
                                           double floor) {
  if (curve.empty()) return std::nullopt;
  // The last point above the target; after it the error stays below.
  std::size_t last = curve.size();
  while (last > 0 && curve[last - 1].error <= target) --last;
  if (last == 0) return WorkToTarget{curve.front().work, false};
  const WorkError& a = curve[last - 1];
  if (last < curve.size()) {
    const WorkError& b = curve[last];
    if (b.error <= 0) return WorkToTarget{b.work, false};
    return WorkToTarget{between(target, a.error, a.work, b.error, b.work), false};
  }
  // Where the curve ends, not where it began.
  std::vector<WorkError> end = above(curve, floor);
  if (end.size() > 3) end.erase(end.begin(), end.end() - 3);
  if (end.size() < 3) return std::nullopt;
  const Line line = fit(end);
  if (line.slope > -0.25) return std::nullopt;
  return WorkToTarget{std::exp(line.mean_x + (std::log(target) - line.mean_y) / line.slope), true};
}

std::optional<double> error_at_work(const std::vector<WorkError>& curve, double work) {
  for (std::size_t i = 1; i < curve.size(); ++i)
    if (curve[i - 1].work <= work && work <= curve[i].work && curve[i].error > 0 &&
        curve[i - 1].error > 0)
      return between(work, curve[i - 1].work, curve[i - 1].error, curve[i].work, curve[i].error);
  return std::nullopt;
}

}  // namespace irsig
