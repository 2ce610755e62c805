// Candidates compared by drawing their errors: BandSearch::compare.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "view/bands.h"

namespace irsig {
namespace {

constexpr int kDraws = 400;
constexpr std::uint32_t kSeed = 20240229;

double squared(double x) { return x * x; }

}  // namespace

WindowChoice BandSearch::compare(const MeritOf& merit, std::span<const Candidate> asked) const {
  std::vector<Candidate> candidate(asked.begin(), asked.end());
  std::stable_sort(candidate.begin(), candidate.end(), better);
  WindowChoice out;
  if (candidate.empty()) return out;

  enum Kind { kSamples, kNumerical, kAll, kKinds };
  const std::size_t count = candidate.size(), rows = population_.row.size();
  // [kind][candidate][draw]
  std::vector<std::vector<std::vector<double>>> drawn(kKinds,
                                                      std::vector<std::vector<double>>(count));
  const bool two = population_.row.front().against.has_value();
  const bool of_angles = pairing_ == Pairing::kRatio;  // which have no direction without signals
  std::size_t views = 0, modes = 0;
  for (std::size_t i = 0; i < rows; ++i) {
    views = std::max(views, population_.row[i].view + 1);
    modes = std::max(modes, target_.mode[i].size());
    if (two) modes = std::max(modes, against_.mode[i].size());
  }
  std::mt19937_64 random(kSeed);
  // Of a library's distributions the numbers are its own; these are the same everywhere.
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));  // the first of two numbers
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  // What is drawn of one target.
  struct Drawn {
    std::vector<double> z;
    double bound_level, bound_slope, model_level, model_slope;
  };
  const auto draw_target = [&] {
    Drawn d;
    for (std::size_t k = 0; k < views * (modes + 2); ++k) d.z.push_back(normal());
    d.bound_level = 2 * uniform() - 1;
    d.bound_slope = std::sqrt(3.0) * (2 * uniform() - 1);
    d.model_level = normal();
    d.model_slope = std::sqrt(3.0) * normal();
    return d;
  };
  const auto error_of = [&](const Drawn& d, const Cumulated& c, const TargetContrast& t,
                            std::size_t i, Passband p, Kind kind) {
    const BandCase& row = population_.row[i];
    const double* z = d.z.data() + row.view * (modes + 2);
    double error = z[modes] * of(c.rest, p, i);
    for (std::size_t k = 0; k < c.mode[i].size(); ++k)
      error += z[k] * (c.mode[i][k][p.last] - c.mode[i][k][p.first]);
    if (kind == kSamples) return error;
    const double half = std::sqrt(0.5), shape = of(c.shape, p, i), slope = of(c.slope, p, i);
    const double per_w_sr =
        c.whole_shape[i] > 0 ? ratio_ / squared(row.range_m) / c.whole_shape[i] : 0;
    error +=
        per_w_sr * (t.bias_bound_w_sr * half * (d.bound_level * shape + d.bound_slope * slope) +
                    t.unseen_stderr_w_sr * z[modes + 1] * shape);
    if (kind == kNumerical) return error;
    return error +
           per_w_sr * t.model_error_w_sr * half * (d.model_level * shape + d.model_slope * slope);
  };
  // What errors of both signs add to the merit, of the numerical ones and of all; what all of them
  // make by themselves.
  std::vector<std::array<double, kKinds>> added(count, std::array<double, kKinds>{});
  std::vector<double> alone(count, 0.0);
  std::vector<double> of_rows(rows), opposite(rows), nothing(rows);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Drawn of_target = draw_target();
    Drawn of_against;
    if (two) {
      of_against = draw_target();
      of_against.bound_level = -of_target.bound_level;
      of_against.bound_slope = -of_target.bound_slope;
    }
    for (std::size_t w = 0; w < count; ++w) {
      const Candidate& c = candidate[w];
      for (const Kind kind : {kSamples, kNumerical, kAll}) {
        for (std::size_t i = 0; i < rows; ++i) {
          const BandCase& row = population_.row[i];
          Errors error;
          for (std::size_t k = 0; k < (c.other ? 2U : 1U); ++k) {
            const Passband p = k == 0 ? c.one : *c.other;
            error.target[k] = error_of(of_target, target_, row.target, i, p, kind);
            if (two) error.against[k] = error_of(of_against, against_, *row.against, i, p, kind);
          }
          of_rows[i] = of_row(c, i, error);
          opposite[i] = of_row(c, i, error * -1.0);
          if (kind == kAll && !of_angles) nothing[i] = of_row(c, i, error, 0);
        }
        drawn[kind][w].push_back(merit_of_rows(merit, of_rows));
        added[w][kind] +=
            (0.5 * (drawn[kind][w].back() + merit_of_rows(merit, opposite)) - c.merit) / kDraws;
        if (kind == kAll) alone[w] += merit_of_rows(merit, nothing) / kDraws;
      }
    }
  }
  const auto scatter = [&](const std::vector<double>& values) {
    double mean = 0, sum = 0;
    // Of equal values exactly that: a mean of differences.
    for (const double v : values) mean += (v - values.front()) / kDraws;
    mean += values.front();
    for (const double v : values) sum += squared(v - mean) / (kDraws - 1);
    return std::sqrt(sum);
  };
  const auto one_sigma = [&](std::size_t w, Kind kind) {
    return std::hypot(scatter(drawn[kind][w]), added[w][kind]);
  };
  for (std::size_t w = 0; w < count; ++w) {
    CandidateMerit& m = out.candidate.emplace_back(
        CandidateMerit{candidate[w], one_sigma(w, kSamples), one_sigma(w, kNumerical),
                       one_sigma(w, kAll), 0, 0, 0, 0, alone[w]});
    const auto as_good = [&](Kind kind) {
      int count_as_good = 0;
      for (std::size_t d = 0; d < kDraws; ++d)
        if (drawn[kind][w][d] >= drawn[kind][0][d]) ++count_as_good;
      return static_cast<double>(count_as_good) / kDraws;
    };
    m.as_good_numerical = as_good(kNumerical);
    m.as_good = as_good(kAll);
  }
  for (std::size_t d = 0; d < kDraws; ++d)
    for (const Kind kind : {kNumerical, kAll}) {
      double most = drawn[kind][0][d];
      for (std::size_t w = 1; w < count; ++w) most = std::max(most, drawn[kind][w][d]);
      // Those that are equally good share it.
      const auto is_best = [&](std::size_t w) { return drawn[kind][w][d] >= most; };
      int equal = 0;
      for (std::size_t w = 0; w < count; ++w) equal += is_best(w) ? 1 : 0;
      for (std::size_t w = 0; w < count; ++w)
        if (is_best(w))
          (kind == kAll ? out.candidate[w].best : out.candidate[w].best_numerical) += 1.0 / equal;
    }
  for (CandidateMerit& w : out.candidate) {
    w.best /= kDraws;
    w.best_numerical /= kDraws;
  }
  if (count < 2) return out;
  const auto difference_of = [&](Kind kind) {
    std::vector<double> difference;
    for (std::size_t d = 0; d < kDraws; ++d)
      difference.push_back(drawn[kind][0][d] - drawn[kind][1][d]);
    return scatter(difference);
  };
  const double apart = 0.5 * (candidate[0].merit - candidate[1].merit);
  const double samples = squared(difference_of(kSamples)), all = squared(difference_of(kAll));
  if (all <= squared(apart)) return out;
  const double left = squared(apart) - std::max(0.0, all - samples);
  out.samples_to_tell = left > 0 ? samples / left : std::numeric_limits<double>::infinity();
  return out;
}

}  // namespace irsig
