// Candidates compared by drawing their errors: BandSearch::compare.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <thread>

#include "view/bands/bands.h"
#include "view/base/on_all_cores.h"

namespace irsig {
namespace {

constexpr int kDraws = 400;
constexpr std::uint32_t kSeed = 20240229;
// Candidates share their draws: at most so many candidates, with at most so many numbers held.
constexpr std::size_t kTogether = 16, kHeld = 8'000'000;
// A signal counts as none if it is at most so many times the merit of errors alone.
constexpr double kKnown = 3;

double square_of(double x) { return x * x; }

}  // namespace

struct BandSearch::Draws {
  enum Kind { kSamples, kNumerical, kAll, kKinds };
  std::array<std::vector<double>, kKinds> merit;  // [kind][draw]
  // Mean change of the merit by errors of both signs.
  std::array<double, kKinds> added{};
  double alone = 0, no_more_than_alone = 0;
};

std::size_t BandSearch::most_modes() const {
  std::size_t out = 0;
  for (const Cumulated* c : {&target_, &against_})
    for (const auto& modes : c->mode) out = std::max(out, modes.size());
  return out;
}

// Draws the errors of the candidates. Every candidate gets the same random numbers, here and in
// other calls.
std::vector<BandSearch::Draws> BandSearch::draw_errors(
    const MeritOf& merit, std::span<const Candidate> candidates) const {
  const std::size_t rows = population_.row.size(), modes = most_modes();
  const bool two = population_.row.front().against.has_value();
  const bool of_angles = pairing_ == Pairing::kRatio;  // which have no direction without signals
  std::size_t views = 0;
  for (const BandCase& row : population_.row) views = std::max(views, row.view + 1);
  const bool clutter = !clutter_mode_.empty();
  const std::size_t numbers = modes + 2 + (clutter ? 1 : 0);  // that are drawn for a view
  std::mt19937_64 random(kSeed);
  // Random distributions of a standard library give numbers of its own; these give equal numbers
  // everywhere.
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));  // the first of two numbers
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  // Random numbers of one target.
  struct Drawn {
    std::vector<double> z;
    double bound_level, bound_slope, model_level, model_slope;
  };
  const auto draw_target = [&] {
    Drawn d;
    d.z.reserve(views * numbers);
    for (std::size_t k = 0; k < views * numbers; ++k) d.z.push_back(normal());
    d.bound_level = 2 * uniform() - 1;
    d.bound_slope = std::sqrt(3.0) * (2 * uniform() - 1);
    d.model_level = normal();
    d.model_slope = std::sqrt(3.0) * normal();
    return d;
  };
  // A target's errors in one passband, by row.
  struct PartErrors {
    std::vector<double> mode;                        // [row][mode]
    std::vector<double> rest, unseen, bound, model;  // [row]
    std::vector<double> bound_slope, model_slope;    // [row]
  };
  const auto errors_in = [&](const Cumulated& of_target, auto&& target_of, Passband p) {
    PartErrors out;
    const double half = std::sqrt(0.5);
    for (std::size_t i = 0; i < rows; ++i) {
      const TargetContrast& t = target_of(population_.row[i]);
      for (std::size_t k = 0; k < modes; ++k)
        out.mode.push_back(k < of_target.mode[i].size()
                               ? of_target.mode[i][k][p.last] - of_target.mode[i][k][p.first]
                               : 0);
      const double shape = of(of_target.shape, p, i), slope = of(of_target.slope, p, i);
      const double whole = of_target.whole_shape[i] * square_of(population_.row[i].range_m);
      const double per_w_sr = whole > 0 ? ratio_ / whole : 0;
      out.rest.push_back(of(of_target.rest, p, i));
      out.unseen.push_back(per_w_sr * t.undersampling_stderr_w_sr * shape);
      out.bound.push_back(per_w_sr * t.bias_bound_w_sr * half * shape);
      out.bound_slope.push_back(per_w_sr * t.bias_bound_w_sr * half * slope);
      out.model.push_back(per_w_sr * t.model_error_w_sr * half * shape);
      out.model_slope.push_back(per_w_sr * t.model_error_w_sr * half * slope);
    }
    return out;
  };
  struct OfCandidate {
    std::size_t parts = 1;
    std::array<PartErrors, 2> target, against;
  };
  std::vector<OfCandidate> errors;
  for (const Candidate& c : candidates) {
    OfCandidate& own = errors.emplace_back();
    own.parts = c.other ? 2 : 1;
    for (std::size_t k = 0; k < own.parts; ++k) {
      const Passband p = k == 0 ? c.one : *c.other;
      own.target[k] = errors_in(
          target_, [](const BandCase& r) -> const TargetContrast& { return r.target; }, p);
      if (two)
        own.against[k] = errors_in(
            against_, [](const BandCase& r) -> const TargetContrast& { return *r.against; }, p);
    }
  }
  // Returns the errors by kind; each kind includes the previous ones.
  const auto error_of = [&](const Drawn& d, const PartErrors& e, std::size_t i) {
    const double* z = d.z.data() + population_.row[i].view * numbers;
    const double* mode = e.mode.data() + i * modes;
    double samples = z[modes] * e.rest[i];
    for (std::size_t k = 0; k < modes; ++k) samples += z[k] * mode[k];
    const double numerical = samples + d.bound_level * e.bound[i] +
                             d.bound_slope * e.bound_slope[i] + z[modes + 1] * e.unseen[i];
    return std::array{samples, numerical,
                      numerical + d.model_level * e.model[i] + d.model_slope * e.model_slope[i]};
  };
  std::vector<Draws> out(candidates.size());
  std::array<std::vector<double>, Draws::kKinds> of_rows, opposite;
  for (auto* values : {&of_rows, &opposite}) values->fill(std::vector<double>(rows));
  std::vector<double> nothing(rows);
  const auto add_draw = [&](const Drawn& of_target, const Drawn& of_against, std::size_t w) {
    const Candidate& c = candidates[w];
    for (std::size_t i = 0; i < rows; ++i) {
      std::array<Errors, Draws::kKinds> error;
      for (std::size_t k = 0; k < errors[w].parts; ++k) {
        const auto own = error_of(of_target, errors[w].target[k], i);
        const auto other = two ? error_of(of_against, errors[w].against[k], i) : decltype(own){};
        for (std::size_t kind = 0; kind < Draws::kKinds; ++kind) {
          error[kind].target[k] = own[kind];
          error[kind].against[k] = other[kind];
        }
      }
      // Errors of samples alone leave the clutter as it is.
      if (clutter)
        for (const auto kind : {Draws::kNumerical, Draws::kAll})
          error[kind].log_clutter = of_target.z[(population_.row[i].view + 1) * numbers - 1] *
                                    population_.row[i].clutter->relative_stderr;
      for (std::size_t kind = 0; kind < Draws::kKinds; ++kind) {
        of_rows[kind][i] = of_row(c, i, error[kind]);
        opposite[kind][i] = of_row(c, i, error[kind] * -1.0);
      }
      if (!of_angles) nothing[i] = of_row(c, i, error[Draws::kAll], 0);
    }
    for (std::size_t kind = 0; kind < Draws::kKinds; ++kind) {
      out[w].merit[kind].push_back(merit_of_rows(merit, of_rows[kind]));
      out[w].added[kind] +=
          (0.5 * (out[w].merit[kind].back() + merit_of_rows(merit, opposite[kind])) - c.merit) /
          kDraws;
    }
    out[w].alone += merit_of_rows(merit, nothing) / kDraws;
    // A range is not proportional to what is seen.
    if (merit.merit == Merit::kRange)
      for (double& snr : nothing) snr *= kKnown;
    out[w].no_more_than_alone +=
        (merit.merit == Merit::kRange ? 1 : kKnown) * merit_of_rows(merit, nothing) / kDraws;
  };
  for (int draw = 0; draw < kDraws; ++draw) {
    const Drawn of_target = draw_target();
    Drawn of_against;
    if (two) {
      of_against = draw_target();
      of_against.bound_level = -of_target.bound_level;
      of_against.bound_slope = -of_target.bound_slope;
    }
    for (std::size_t w = 0; w < candidates.size(); ++w) add_draw(of_target, of_against, w);
  }
  return out;
}

WindowChoice BandSearch::compare(const MeritOf& merit, std::span<const Candidate> asked) const {
  std::vector<Candidate> candidate(asked.begin(), asked.end());
  std::stable_sort(candidate.begin(), candidate.end(), better);
  WindowChoice out;
  if (candidate.empty()) return out;
  constexpr auto kSamples = Draws::kSamples, kNumerical = Draws::kNumerical, kAll = Draws::kAll;
  using Kind = Draws::Kind;
  const std::size_t count = candidate.size();
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency()),
                    held = population_.row.size() * (most_modes() + 6);
  const std::size_t together =
      std::min(std::clamp<std::size_t>(kHeld / held, 1, kTogether), (count + cores - 1) / cores);
  std::vector<Draws> draws(count);
  on_all_cores((count + together - 1) / together, [&](std::size_t part) {
    const std::size_t first = part * together;
    auto drawn =
        draw_errors(merit, std::span(candidate).subspan(first, std::min(together, count - first)));
    std::move(drawn.begin(), drawn.end(), draws.begin() + static_cast<std::ptrdiff_t>(first));
    return absl::OkStatus();
  }).IgnoreError();
  const auto drawn = [&](Kind kind, std::size_t w) -> const std::vector<double>& {
    return draws[w].merit[kind];
  };
  const auto scatter = [&](const std::vector<double>& values) {
    double mean = 0, sum = 0;
    // Equal values must give exactly their value: the mean is one of differences.
    for (const double v : values) mean += (v - values.front()) / kDraws;
    mean += values.front();
    for (const double v : values) sum += square_of(v - mean) / (kDraws - 1);
    return std::sqrt(sum);
  };
  const auto one_sigma = [&](std::size_t w, Kind kind) {
    return std::hypot(scatter(drawn(kind, w)), draws[w].added[kind]);
  };
  for (std::size_t w = 0; w < count; ++w) {
    CandidateMerit& m = out.candidate.emplace_back(CandidateMerit{
        candidate[w], one_sigma(w, kSamples), one_sigma(w, kNumerical), one_sigma(w, kAll), 0, 0, 0,
        0, draws[w].alone, candidate[w].merit >= draws[w].no_more_than_alone});
    const auto as_good = [&](Kind kind) {
      int count_as_good = 0;
      for (std::size_t d = 0; d < kDraws; ++d)
        if (drawn(kind, w)[d] >= drawn(kind, 0)[d]) ++count_as_good;
      return static_cast<double>(count_as_good) / kDraws;
    };
    m.as_good_numerical = as_good(kNumerical);
    m.as_good = as_good(kAll);
  }
  for (std::size_t d = 0; d < kDraws; ++d)
    for (const Kind kind : {kNumerical, kAll}) {
      double most = drawn(kind, 0)[d];
      for (std::size_t w = 1; w < count; ++w) most = std::max(most, drawn(kind, w)[d]);
      // Those that are equally good share it.
      const auto is_best = [&](std::size_t w) { return drawn(kind, w)[d] >= most; };
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
  const auto variance_of_difference = [&](std::size_t w, Kind kind) {
    std::vector<double> difference;
    for (std::size_t d = 0; d < kDraws; ++d)
      difference.push_back(drawn(kind, 0)[d] - drawn(kind, w)[d]);
    return square_of(scatter(difference));
  };
  for (std::size_t w = 1; w < count; ++w) {
    const double apart = square_of(0.5 * (candidate[0].merit - candidate[w].merit));
    const double samples = variance_of_difference(w, kSamples),
                 all = variance_of_difference(w, kAll);
    if (all <= apart) continue;
    const double left = apart - std::max(0.0, all - samples);
    out.candidate[w].samples_to_tell =
        left > 0 ? samples / left : std::numeric_limits<double>::infinity();
  }
  for (CandidateMerit& w : out.candidate) {
    w.extrapolated = extrapolated(merit, w.of);
    if (w.extrapolated)
      w.samples_stderr = w.numerical_error = w.total_error =
          std::numeric_limits<double>::infinity();
    if (out.candidate.front().extrapolated)
      w.best_numerical = w.best = w.as_good_numerical = w.as_good = w.samples_to_tell =
          std::numeric_limits<double>::quiet_NaN();
  }
  return out;
}

}  // namespace irsig
