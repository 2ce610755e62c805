#include "core/study/work_precision.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"

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
  sum[static_cast<int>(StudiedQuantity::kIntensity)] +=
      square(value.intensity_w_sr, reference.intensity_w_sr);
  sum[static_cast<int>(StudiedQuantity::kEmitted)] +=
      square(value.emitted_w_sr, reference.emitted_w_sr);
  sum[static_cast<int>(StudiedQuantity::kArea)] +=
      square(value.projected_area_m2, reference.projected_area_m2);
  const std::size_t bins = reference.spectral_w_sr_um.size();
  for (std::size_t k = 0; k < bins; ++k)
    sum[static_cast<int>(StudiedQuantity::kSpectrum)] +=
        square(value.spectral_w_sr_um[k], reference.spectral_w_sr_um[k]) /
        static_cast<double>(bins);
}

double relative(double error, double value) { return value != 0 ? std::abs(error / value) : 0; }

void set_stderr(StudiedQuantity what, const Estimate& e, EstimateRun& run) {
  run.relative_stderr[static_cast<std::size_t>(what)] = relative(e.stderr_, e.value);
}

void set_spectral_stderr(const std::vector<double>& stderr_w_sr_um, EstimateRun& run) {
  const std::vector<double>& spectrum = run.value.spectral_w_sr_um;
  double square = 0;
  for (std::size_t k = 0; k < spectrum.size(); ++k)
    square += std::pow(relative(stderr_w_sr_um[k], spectrum[k]), 2);
  run.relative_stderr[static_cast<std::size_t>(StudiedQuantity::kSpectrum)] =
      std::sqrt(square / static_cast<double>(std::max<std::size_t>(spectrum.size(), 1)));
}

// Runs of the same kind with several seeds, one after the other.
class SeedMean {
 public:
  explicit SeedMean(const ReferenceValue& reference) : reference_(reference) {}
  void add(const EstimateRun& run) {
    ++point_.seeds;
    point_.samples += run.samples;
    samples_per_replicate_ += static_cast<double>(run.samples_per_replicate);
    numerical_ += run.relative_numerical_error * run.relative_numerical_error;
    add_squares(run.value, reference_.value, sum_);
    for (std::size_t q = 0; q < kStudiedQuantities; ++q)
      random_[q] += run.relative_stderr[q] * run.relative_stderr[q];
  }
  [[nodiscard]] std::uint32_t seeds() const { return point_.seeds; }
  // cpu_s: of all runs together.
  [[nodiscard]] WorkPoint point(double cpu_s) const {
    WorkPoint out = point_;
    const double seeds = point_.seeds;
    out.cpu_s = cpu_s / seeds;
    out.samples /= seeds;
    out.samples_per_replicate =
        static_cast<std::uint64_t>(std::llround(samples_per_replicate_ / seeds));
    out.relative_numerical_error = std::sqrt(numerical_ / seeds);
    for (std::size_t q = 0; q < kStudiedQuantities; ++q) {
      out.relative_error[q] = std::sqrt(sum_[q] / seeds);
      out.relative_stderr[q] = std::sqrt(random_[q] / seeds);
    }
    return out;
  }

 private:
  const ReferenceValue& reference_;
  WorkPoint point_;
  double samples_per_replicate_ = 0, numerical_ = 0;
  double sum_[kStudiedQuantities]{}, random_[kStudiedQuantities]{};
};

// Counts the spent part of a budget, in the budget's unit.
class Purse {
 public:
  Purse(const WorkBudget& budget, const CpuClock& cpu_s)
      : budget_(budget), cpu_s_(cpu_s), start_s_(cpu_s()) {}
  void pay(const EstimateRun& run) { rays_ += run.samples; }
  [[nodiscard]] double spent() const { return in_rays() ? rays_ : cpu_s_() - start_s_; }
  [[nodiscard]] double left() const {
    return (in_rays() ? budget_.primary_rays : budget_.cpu_s) - spent();
  }
  // Returns the price of one run.
  [[nodiscard]] double price(const WorkPoint& point) const {
    return in_rays() ? point.samples : point.cpu_s;
  }

 private:
  [[nodiscard]] bool in_rays() const { return budget_.primary_rays > 0; }

  const WorkBudget& budget_;
  const CpuClock& cpu_s_;
  double start_s_, rays_ = 0;
};

struct FittedLine {
  double slope, mean_x, mean_y;
};

FittedLine fit(const std::vector<WorkError>& curve) {
  FittedLine line{0, 0, 0};
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

std::vector<WorkError> against(const std::vector<WorkPoint>& points, StudiedQuantity what,
                               double WorkPoint::*work) {
  std::vector<WorkError> out;
  for (const WorkPoint& p : points)
    out.push_back({p.*work, p.relative_error[static_cast<std::size_t>(what)]});
  return out;
}

}  // namespace

EstimateRun run_of(const ViewValue& view, std::size_t row) {
  EstimateRun out{view.row[row], static_cast<double>(view.samples), {}, 0, 0};
  set_stderr(StudiedQuantity::kIntensity, view.intensity_w_sr[row], out);
  set_stderr(StudiedQuantity::kEmitted, view.emitted_w_sr[row], out);
  set_stderr(StudiedQuantity::kArea, view.projected_area_m2[row], out);
  set_spectral_stderr(view.spectral_stderr_w_sr_um[row], out);
  return out;
}

EstimateRun run_of(const ViewResult& view, std::size_t row) {
  const SignatureResult& r = view.row[row];
  const Estimate& emitted = r.cause_w_sr[static_cast<std::size_t>(Cause::kEmitted)];
  EstimateRun out;
  out.value = {r.intensity_w_sr.value, emitted.value, r.projected_area_m2.value, r.spectral.value};
  out.samples = static_cast<double>(view.samples);
  set_stderr(StudiedQuantity::kIntensity, r.intensity_w_sr, out);
  set_stderr(StudiedQuantity::kEmitted, emitted, out);
  set_stderr(StudiedQuantity::kArea, r.projected_area_m2, out);
  set_spectral_stderr(r.spectral.stderr_, out);
  out.samples_per_replicate = view.samples_per_replicate;
  out.relative_numerical_error = relative(r.numerical_error_w_sr, r.intensity_w_sr.value);
  return out;
}

std::vector<WorkPoint> work_curve(const WorkMethod& method, const ReferenceValue& reference,
                                  const WorkBudget& budget, const CpuClock& cpu_s) {
  std::vector<WorkPoint> out;
  Purse purse(budget, cpu_s);
  // Caches and clock ticks: the first run of a method is not counted.
  purse.pay(method.estimate(method.first_samples, 0));
  std::uint64_t seed = 1;
  for (std::uint64_t n = method.first_samples; n <= budget.most_samples_per_replicate; n *= 4) {
    const double left = purse.left();
    if (out.size() >= 2 && 3 * purse.price(out.back()) * budget.least_seeds > left) break;
    SeedMean mean(reference);
    const double begin = purse.spent(), begin_s = cpu_s();
    // Many seeds while they are cheap; most of the budget is for the last steps.
    while (mean.seeds() < budget.least_seeds ||
           (mean.seeds() < budget.most_seeds && purse.spent() - begin < left / 16)) {
      const EstimateRun run = method.estimate(n, seed++);
      purse.pay(run);
      mean.add(run);
    }
    out.push_back(mean.point(cpu_s() - begin_s));
    out.back().samples_per_replicate = n;
  }
  return out;
}

absl::StatusOr<std::vector<WorkPoint>> whole_run_curve(const WholeRunMethod& method,
                                                       std::span<const double> relative_errors,
                                                       const ReferenceValue& reference,
                                                       const WorkBudget& budget,
                                                       const CpuClock& cpu_s) {
  std::vector<WorkPoint> out;
  Purse purse(budget, cpu_s);
  // The first view makes what all views of a sweep share; this is not counted.
  ASSIGN_OR_RETURN(const auto first, method.simulate(relative_errors.front(), 0));
  purse.pay(first);
  std::uint64_t seed = 1;
  for (const double asked : relative_errors) {
    const double left = purse.left();
    if (out.size() >= 2) {
      // Samples grow as where the error falls as n^-0.67; time that does not grow with them is
      // left.
      const WorkPoint& last = out.back();
      const double growth = std::pow(last.asked_relative_error / asked, 1.5);
      if (growth * purse.price(last) * budget.least_seeds > left) break;
    }
    SeedMean mean(reference);
    const double begin = purse.spent(), begin_s = cpu_s();
    while (mean.seeds() < budget.least_seeds ||
           (mean.seeds() < budget.most_seeds && purse.spent() - begin < left / 16)) {
      ASSIGN_OR_RETURN(const auto run, method.simulate(asked, seed++));
      purse.pay(run);
      mean.add(run);
    }
    out.push_back(mean.point(cpu_s() - begin_s));
    out.back().asked_relative_error = asked;
  }
  return out;
}

ReferenceValue reference_value(const ViewEstimator& estimator, const EstimatorOptions& knobs,
                               ViewRow row, std::uint64_t samples_per_replicate,
                               const WorkBudget& budget, const CpuClock& cpu_s) {
  Purse purse(budget, cpu_s);
  ReferenceValue out;
  double square[kStudiedQuantities]{};
  double n = 0;
  for (; n < 2 || purse.left() > 0; ++n) {
    const ViewValue v = estimator.estimate(knobs, {&row, 1}, samples_per_replicate,
                                           kReferenceSeeds + static_cast<std::uint64_t>(n));
    const EstimateRun run = run_of(v, 0);
    purse.pay(run);
    const RowValue& r = run.value;
    out.value.intensity_w_sr += r.intensity_w_sr;
    out.value.emitted_w_sr += r.emitted_w_sr;
    out.apparent_intensity_w_sr += v.apparent_intensity_w_sr.front().value;
    out.value.projected_area_m2 += r.projected_area_m2;
    out.value.spectral_w_sr_um.resize(r.spectral_w_sr_um.size());
    for (std::size_t k = 0; k < r.spectral_w_sr_um.size(); ++k)
      out.value.spectral_w_sr_um[k] += r.spectral_w_sr_um[k];
    for (std::size_t q = 0; q < kStudiedQuantities; ++q)
      square[q] += run.relative_stderr[q] * run.relative_stderr[q];
  }
  out.value.intensity_w_sr /= n;
  out.value.emitted_w_sr /= n;
  out.apparent_intensity_w_sr /= n;
  out.value.projected_area_m2 /= n;
  for (double& value : out.value.spectral_w_sr_um) value /= n;
  for (std::size_t q = 0; q < kStudiedQuantities; ++q)
    out.relative_stderr[q] = std::sqrt(square[q]) / n;
  return out;
}

std::vector<WorkError> against_time(const std::vector<WorkPoint>& points, StudiedQuantity what) {
  return against(points, what, &WorkPoint::cpu_s);
}

std::vector<WorkError> against_samples(const std::vector<WorkPoint>& points, StudiedQuantity what) {
  return against(points, what, &WorkPoint::samples);
}

std::vector<WorkError> against_main_samples(const std::vector<WorkPoint>& points,
                                            StudiedQuantity what) {
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
  // The fit is for the end of the curve, not for its begin.
  std::vector<WorkError> end = above(curve, floor);
  if (end.size() > 3) end.erase(end.begin(), end.end() - 3);
  if (end.size() < 3) return std::nullopt;
  const FittedLine line = fit(end);
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
