#include "core/accuracy/cost_model.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>

#include "core/accuracy/replicates.h"

namespace irsig {
namespace {

double goal_w_sr(const RowPilot& row, double relative_error) {
  return std::max(relative_error * row.value_w_sr, row.floor_w_sr);
}

// The undersampling error falls as 1 / n.
double unseen_at(const ViewPilot& pilot, const RowPilot& row, std::uint64_t n) {
  return row.unseen_w_sr * static_cast<double>(pilot.samples.back()) / static_cast<double>(n);
}

// Over all rows, from pilots of n1 and n2 samples, or of n2 alone (n1 = 0).
std::uint64_t needed_by_rows(const ViewPilot& pilot, double relative_error, std::uint64_t n1,
                             std::uint64_t n2) {
  std::uint64_t needed = 16;
  for (const RowPilot& row : pilot.row) {
    const double e1 = n1 > 0 ? stderr_at(pilot.samples, row.stderr_w_sr, n1) : 0;
    const double e2 = stderr_at(pilot.samples, row.stderr_w_sr, n2);
    needed = std::max(needed, samples_needed_with_unseen(
                                  n1, e1, n2, e2, unseen_at(pilot, row, n2),
                                  stderr_wanted(goal_w_sr(row, relative_error), row.bias_w_sr),
                                  std::uint64_t{1} << 40));
  }
  return needed;
}

// The row with these errors. Its bounds count as one, the largest.
Measured predicted(const RowPilot& row, double error_w_sr, double unseen_w_sr) {
  Measured out{row.value_w_sr, error_w_sr, {}, unseen_w_sr};
  out.of(row.largest_bound) = row.bias_w_sr;
  return out;
}

struct Count {
  std::uint64_t stored = 0;
  std::uint64_t further_pilots = 0;  // beyond those that every job of the pilot has traced as well
};

Count count_for(const ViewPilot& pilot, const CountRule& rule, double target_paths_per_sample) {
  const std::uint64_t most = rule.max_samples_per_replicate;
  if (rule.samples_per_replicate > 0) return {rule.samples_per_replicate, 0};
  if (rule.target_paths > 0) {
    const double wanted = std::ceil(rule.target_paths / target_paths_per_sample / 16) * 16;
    return {static_cast<std::uint64_t>(std::min(wanted, static_cast<double>(most))),
            kSecondPilotSamples};
  }
  std::uint64_t n = needed_by_rows(pilot, rule.relative_error, 0, kFirstPilotSamples);
  if (n <= kSecondPilotSamples) return {std::min(n, most), 0};
  n = std::min(needed_by_rows(pilot, rule.relative_error, kFirstPilotSamples, kSecondPilotSamples),
               most + 1);
  std::uint64_t third = 0;
  if (n >= 32 * kSecondPilotSamples) {
    third = n / 16;
    n = needed_by_rows(pilot, rule.relative_error, kSecondPilotSamples, third);
  }
  return {std::min(n, most), third};
}

double work(const ViewPilot& pilot, std::uint64_t samples) {
  return std::pow(static_cast<double>(samples), pilot.time_exponent);
}

// b of a + b n^p through the smallest and the largest stage.
double slope_of(const ViewPilot& pilot) {
  if (pilot.samples.back() <= pilot.samples.front()) return 0;
  return std::max(0.0, pilot.cpu_s.back() - pilot.cpu_s.front()) /
         (work(pilot, pilot.samples.back()) - work(pilot, pilot.samples.front()));
}

// The costs are measured at the stages, linear between them, and follow the power law beyond them.
double cpu_s_at(const ViewPilot& pilot, std::uint64_t n) {
  const std::vector<std::uint64_t>& samples = pilot.samples;
  if (n >= samples.back())
    return pilot.cpu_s.back() + slope_of(pilot) * (work(pilot, n) - work(pilot, samples.back()));
  std::size_t right = 1;
  while (right < samples.size() && samples[right] < n) ++right;
  if (right == samples.size()) return pilot.cpu_s.front();
  const double along = (static_cast<double>(n) - static_cast<double>(samples[right - 1])) /
                       static_cast<double>(samples[right] - samples[right - 1]);
  return pilot.cpu_s[right - 1] +
         std::max(along, 0.0) * (pilot.cpu_s[right] - pilot.cpu_s[right - 1]);
}

}  // namespace

double stderr_at(std::span<const std::uint64_t> samples, std::span<const double> stderr_w_sr,
                 std::uint64_t n) {
  std::size_t last = samples.size() - 1;
  if (samples.size() == 1 || n <= samples.front()) {
    const std::size_t at = samples.size() == 1 ? last : 0;
    return stderr_w_sr[at] * std::sqrt(static_cast<double>(samples[at]) / static_cast<double>(n));
  }
  std::size_t right = 1;
  while (right < last && samples[right] < n) ++right;
  const double e1 = stderr_w_sr[right - 1], e2 = stderr_w_sr[right];
  if (samples[right] == n || e2 <= 0) return e2;
  const double ratio =
      static_cast<double>(samples[right]) / static_cast<double>(samples[right - 1]);
  double slope = e1 > 0 && ratio > 1 ? std::log(e1 / e2) / std::log(ratio) : 0.5;
  if (n > samples[right]) slope = std::clamp(slope, 0.5, 0.7);
  return e2 * std::pow(static_cast<double>(samples[right]) / static_cast<double>(n), slope);
}

std::uint64_t profile_samples(const ProfilePointPilot& point,
                              std::uint64_t max_samples_per_replicate) {
  if (point.fixed_samples > 0) return point.fixed_samples;
  std::uint64_t needed = 16;
  for (const auto& [e1, e2] : point.stderr_k)
    if (e2 > 0)
      needed = std::max(needed, samples_needed(kFirstProfileSamples, e1, kSecondProfileSamples, e2,
                                               point.stderr_wanted_k, max_samples_per_replicate));
  return std::min(needed, max_samples_per_replicate);
}

double time_exponent(std::span<const ViewPilot> views) {
  if (views.empty() || views.front().samples.size() < 3) return 1;
  const std::vector<std::uint64_t>& n = views.front().samples;
  double few = 0, more = 0, most = 0;
  for (const ViewPilot& view : views) {
    few += view.cpu_s[0];
    more += view.cpu_s[1];
    most += view.cpu_s.back();
  }
  if (!(more > few && n[1] > n[0] && n.back() > n[1])) return 1;
  const double measured = (most - more) / (more - few);
  const auto of = [&](double p) {
    const double n1 = std::pow(static_cast<double>(n[0]), p),
                 n2 = std::pow(static_cast<double>(n[1]), p),
                 n3 = std::pow(static_cast<double>(n.back()), p);
    return (n3 - n2) / (n2 - n1);
  };
  double low = 0.5, high = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    (of(middle) < measured ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

ViewCost view_cost(const ViewPilot& pilot, const CountRule& rule, double target_paths_per_sample) {
  const Count count = count_for(pilot, rule, target_paths_per_sample);
  ViewCost cost;
  cost.samples = count.stored;
  cost.cpu_s = cpu_s_at(pilot, count.stored) +
               (count.further_pilots > 0 ? slope_of(pilot) * work(pilot, count.further_pilots) : 0);
  if (!pilot.point.empty()) {
    double samples = 0;
    for (const ProfilePointPilot& point : pilot.point) {
      samples += static_cast<double>(profile_samples(point, rule.max_samples_per_replicate));
      if (point.fixed_samples == 0)
        samples += static_cast<double>(kFirstProfileSamples + kSecondProfileSamples);
    }
    cost.cpu_s += pilot.profile_cpu_s + pilot.profile_cpu_s_per_sample * samples;
  }
  const bool at_limit = count.stored >= rule.max_samples_per_replicate;
  for (const RowPilot& row : pilot.row) {
    ++cost.rows;
    if (rule.relative_error <= 0) continue;
    const double error = stderr_at(pilot.samples, row.stderr_w_sr, count.stored);
    const double unseen = unseen_at(pilot, row, cost.samples);
    const double goal = goal_w_sr(row, rule.relative_error);
    const double whole = numerical_error(error, unseen, row.bias_w_sr);
    if (whole <= rule.relative_error * row.value_w_sr) {
      ++cost.reached;
      continue;
    }
    if (whole <= goal) {
      ++cost.at_floor;
      continue;
    }
    if (numerical_error(0, 0, row.bias_w_sr) > 0.8 * goal)
      ++cost.kept_by_bias;
    else if (at_limit)
      ++cost.kept_by_limit;
    ++cost.limited[limiting_part(predicted(row, error, unseen))];
  }
  return cost;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - static_cast<double>(below)) * (values[above] - values[below]);
}

SweepCost sweep_cost(std::span<const ViewCost> piloted, std::uint64_t views,
                     std::uint64_t jobs_per_view, std::uint64_t workers, double start_s) {
  const auto pieces = static_cast<double>(jobs_per_view);
  std::vector<double> job_cpu_s, samples;
  double rows = 0, reached = 0, floor = 0, bias = 0, limit = 0;
  for (const ViewCost& view : piloted) {
    job_cpu_s.push_back(view.cpu_s / pieces);
    samples.push_back(static_cast<double>(view.samples));
    rows += view.rows;
    reached += view.reached;
    floor += view.at_floor;
    bias += view.kept_by_bias;
    limit += view.kept_by_limit;
  }
  SweepCost cost;
  for (const ViewCost& view : piloted)
    for (const auto& [part, count] : view.limited) cost.limited_fraction[part] += count / rows;
  cost.job_cpu_quartile1_s = quantile(job_cpu_s, 0.25);
  cost.job_cpu_median_s = quantile(job_cpu_s, 0.5);
  cost.job_cpu_quartile3_s = quantile(job_cpu_s, 0.75);
  cost.median_samples = quantile(samples, 0.5);
  const double mean = std::accumulate(job_cpu_s.begin(), job_cpu_s.end(), 0.0) /
                      static_cast<double>(job_cpu_s.size());
  cost.cpu_s = mean * pieces * static_cast<double>(views);
  if (rows > 0) {
    cost.reached_fraction = reached / rows;
    cost.at_floor_fraction = floor / rows;
    cost.kept_by_bias_fraction = bias / rows;
    cost.kept_by_limit_fraction = limit / rows;
  }
  // A free worker takes the next job.
  std::priority_queue<double, std::vector<double>, std::greater<>> free_at;
  for (std::uint64_t w = 0; w < workers; ++w) free_at.push(start_s);
  for (std::uint64_t job = 0; job < views * jobs_per_view; ++job) {
    const double until = free_at.top() + job_cpu_s[(job / jobs_per_view) % job_cpu_s.size()];
    free_at.pop();
    free_at.push(until);
    cost.wall_s = std::max(cost.wall_s, until);
  }
  return cost;
}

double relative_scatter(std::span<const ViewCost> piloted, std::uint64_t views) {
  const auto n = static_cast<double>(piloted.size());
  if (piloted.size() >= views || piloted.size() < 2) return 0;
  double mean = 0, squares = 0;
  for (const ViewCost& view : piloted) mean += view.cpu_s / n;
  for (const ViewCost& view : piloted) squares += (view.cpu_s - mean) * (view.cpu_s - mean);
  return mean > 0 ? std::sqrt(squares / (n * (n - 1))) / mean : 0;
}

std::vector<std::uint64_t> spread_views(std::uint64_t views, std::uint64_t count) {
  std::vector<std::uint64_t> out;
  count = std::min(count, views);
  // Van der Corput's sequence: 1/2, 1/4, 3/4, 1/8, ...
  for (std::uint64_t i = 1; out.size() < count; ++i) {
    double at = 0, digit = 0.5;
    for (std::uint64_t rest = i; rest > 0; rest /= 2, digit /= 2)
      at += digit * static_cast<double>(rest % 2);
    const auto view = static_cast<std::uint64_t>(at * static_cast<double>(views));
    if (std::find(out.begin(), out.end(), view) == out.end()) out.push_back(view);
  }
  return out;
}

}  // namespace irsig
