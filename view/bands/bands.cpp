#include "view/bands/bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>

namespace irsig {
namespace {

// The most signal-to-noise ratios of pairs that are computed (some seconds) before window edges are
// taken at a stride.
constexpr double kMostRatios = 4e8;

// Returns the part of a table between two wavelengths, cut off there.
ResponseTable between(const ResponseTable& table, double low, double high) {
  ResponseTable out;
  for (std::size_t i = 0; i + 1 < table.size(); ++i) {
    const SpectralPoint &a = table[i], &b = table[i + 1];
    const double from = std::max(a.lambda_um, low), to = std::min(b.lambda_um, high);
    if (!(from < to)) continue;
    const auto value = [&](double um) {
      return a.value + (b.value - a.value) * (um - a.lambda_um) / (b.lambda_um - a.lambda_um);
    };
    if (out.empty() || out.back().lambda_um < from) out.push_back({from, value(from)});
    out.push_back({to, value(to)});
  }
  return out;
}

double product_sum(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

double squared(double x) { return x * x; }

// sqrt(s^T M^-1 s) of a symmetric 2 x 2 matrix. Of one without an inverse, such as clutter without
// noise whose passbands vary as one, what its larger element alone gives.
double matched_snr(double s1, double s2, double v1, double v2, double w) {
  const double determinant = v1 * v2 - w * w;
  if (determinant > 1e-12 * v1 * v2)
    return std::sqrt(std::max(0.0, (s1 * s1 * v2 - 2 * s1 * s2 * w + s2 * s2 * v1) / determinant));
  if (!(v1 > 0) && !(v2 > 0)) return 0;
  return v1 >= v2 ? std::abs(s1) / std::sqrt(v1) : std::abs(s2) / std::sqrt(v2);
}

double ratio_snr(double a1, double a2, double b1, double b2) {
  const double a = std::hypot(a1, a2), b = std::hypot(b1, b2);
  if (!(a > 0 && b > 0)) return 0;
  return std::abs(std::atan2(a1 * b2 - a2 * b1, a1 * b1 + a2 * b2)) * a * b / std::hypot(a, b);
}

// How much dearer than a mean: a selection of rows, an arc.
double cost_of(const MeritOf& merit, Pairing pairing) {
  return (merit.merit == Merit::kPercentile || merit.merit == Merit::kRange ? 20.0 : 1.0) *
         (pairing == Pairing::kRatio     ? 20.0
          : pairing == Pairing::kMatched ? 5.0
                                         : 1.0);
}

}  // namespace

absl::StatusOr<BandSearch> BandSearch::make(BandPopulation population, const Detector& detector,
                                            Pairing pairing, std::span<const NamedFilter> filters) {
  BandSearch out;
  out.population_ = std::move(population);
  out.pairing_ = pairing;
  out.filter_.assign(filters.begin(), filters.end());
  const std::vector<BandCase>& row = out.population_.row;
  for (std::size_t i = 0; i < row.size(); ++i) {
    out.weight_.push_back(row[i].weight);
    if (row[i].place >= out.place_.size()) out.place_.resize(row[i].place + 1, {i, 0, {}});
    Place& place = out.place_[row[i].place];
    place.weight += row[i].weight;
    place.row.emplace_back(row[i].range_m, i);
  }
  for (Place& place : out.place_) std::sort(place.row.begin(), place.row.end());
  if (pairing == Pairing::kRatio && !row.front().against)
    return absl::InvalidArgumentError(
        "a ratio of two windows tells two targets apart: give the other one");
  const std::vector<double>& lambda_um = out.population_.lambda_um;
  const double first = lambda_um.front(), last = lambda_um.back();
  out.step_um_ = (last - first) / static_cast<double>(lambda_um.size() - 1);
  Detector& whole = out.whole_;
  whole = detector;
  // Alike to the whole band as it is stored, with the response that it was stored with.
  if (whole.response.empty())
    whole.response =
        out.population_.own_response.empty() ? window(first, last) : out.population_.own_response;
  if (const auto fits = band_weights(lambda_um, whole.response); !fits.ok())
    return absl::InvalidArgumentError(
        fmt::format("the detector's response: {}; give a response within the band, or ask for a "
                    "wider [[band]] in the sweep",
                    std::string(fits.status().message())));
  out.detector_ = integrals_of(whole);
  if (out.detector_.photons.empty() && !(out.detector_.constant > 0))
    return absl::InvalidArgumentError(
        "the detector's noise is too small a number to be squared: a scene temperature or an NEI "
        "that no detector has");
  out.ratio_ = largest_ratio(out.detector_.signal, out.population_.own_response);
  if (std::isinf(out.ratio_))
    return absl::InvalidArgumentError(
        "the stored band's own response is 0 where the detector's is not: nothing is known of "
        "errors there");
  // Edges where the detector sees anything.
  const double low = std::max(first, whole.response.front().lambda_um),
               high = std::min(last, whole.response.back().lambda_um);
  out.limit_um_ = {low};
  for (std::size_t k = 0; k + 1 < lambda_um.size(); ++k)
    if (const double edge = lambda_um[k] + 0.5 * out.step_um_;
        edge > low + 1e-9 && edge < high - 1e-9)
      out.limit_um_.push_back(edge);
  out.limit_um_.push_back(high);
  out.edges_ = out.limit_um_.size();

  // Integrals up to each limit, as weights of bins: the same for all rows.
  const std::size_t bins = lambda_um.size();
  std::vector<std::vector<double>> signal, photons, slope;
  const auto add = [&](const DetectorIntegrals& d, double to) {
    const auto weights = [&](const ResponseTable& table) -> std::vector<double> {
      const auto found = band_weights(lambda_um, between(table, low, to));
      return found.ok() ? found->weight : std::vector<double>(bins, 0.0);  // 0 so far
    };
    signal.push_back(weights(d.signal));
    photons.push_back(d.photons.empty() ? std::vector<double>(bins, 0.0) : weights(d.photons));
    slope.push_back(signal.back());
    for (std::size_t k = 0; k < bins; ++k)
      slope.back()[k] *= 2 * (lambda_um[k] - first) / (last - first) - 1;
  };
  for (const double edge : out.limit_um_) add(out.detector_, edge);
  for (const NamedFilter& f : out.filter_) {
    Detector through = whole;
    through.response = product(whole.response, f.transmittance);
    if (through.response.empty())
      return absl::InvalidArgumentError(
          fmt::format("filter {}: nothing of what the detector responds to gets through", f.name));
    add(integrals_of(through), high);
  }

  const std::size_t limits = signal.size();
  const auto cumulate = [&](auto&& target_of, Cumulated& c) {
    for (ByLimit* m : {&c.signal, &c.rest, &c.shape, &c.slope}) m->resize(limits);
    c.mode.resize(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      const TargetContrast& t = target_of(row[i]);
      const double per_m2 = 1 / squared(row[i].range_m);
      std::vector<double> magnitude;
      for (const double value : t.value) magnitude.push_back(std::abs(value));
      for (std::size_t e = 0; e < limits; ++e) {
        c.signal[e].push_back(per_m2 * product_sum(signal[e], t.value));
        c.rest[e].push_back(per_m2 * product_sum(signal[e], t.rest));
        c.shape[e].push_back(per_m2 * product_sum(signal[e], magnitude));
        c.slope[e].push_back(per_m2 * product_sum(slope[e], magnitude));
      }
      for (const auto& mode : t.modes) {
        auto& by_limit = c.mode[i].emplace_back();
        for (std::size_t e = 0; e < limits; ++e)
          by_limit.push_back(per_m2 * product_sum(signal[e], mode));
      }
    }
    c.whole_shape = c.shape[out.edges_ - 1];
  };
  cumulate([](const BandCase& r) -> const TargetContrast& { return r.target; }, out.target_);
  if (row.front().against)
    cumulate([](const BandCase& r) -> const TargetContrast& { return *r.against; }, out.against_);
  out.photons_.resize(limits);
  out.background_.resize(limits);
  bool lit = false;
  for (std::size_t e = 0; e < limits; ++e)
    for (const BandCase& r : row) {
      const bool known = !r.background_w_m2_sr_um.empty();
      out.photons_[e].push_back(known ? product_sum(photons[e], r.background_w_m2_sr_um) : 0);
      out.background_[e].push_back(known ? product_sum(signal[e], r.background_w_m2_sr_um) : 0);
      lit |= out.background_[e].back() > 0;
    }
  if (row.front().clutter) {
    out.clutter_mode_.resize(row.size());
    out.clutter_rest_.resize(limits);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double per_m2 = 1 / squared(row[i].range_m);
      for (const auto& mode : row[i].clutter->modes) {
        auto& by_limit = out.clutter_mode_[i].emplace_back();
        for (std::size_t e = 0; e < limits; ++e)
          by_limit.push_back(per_m2 * product_sum(signal[e], mode));
      }
      for (std::size_t e = 0; e < limits; ++e)
        out.clutter_rest_[e].push_back(per_m2 * product_sum(signal[e], row[i].clutter->rest));
    }
  }
  if (pairing != Pairing::kDifference) return out;
  if (!lit)
    return absl::InvalidArgumentError(
        "a difference of two windows takes the background away, and these rows have none");
  out.gram_.assign(limits, std::vector<double>(limits, 0.0));
  for (std::size_t e = 0; e < limits; ++e)
    for (std::size_t f = 0; f < limits; ++f)
      for (std::size_t i = 0; i < row.size(); ++i)
        out.gram_[e][f] += out.weight_[i] * out.background_[e][i] * out.background_[f][i];
  return out;
}

double BandSearch::lambda_min_um(Passband p) const {
  if (p.last < edges_) return limit_um_[p.first];
  return std::max(limit_um_.front(), filter_[p.last - edges_].transmittance.front().lambda_um);
}

double BandSearch::lambda_max_um(Passband p) const {
  if (p.last < edges_) return limit_um_[p.last];
  return std::min(limit_um_[edges_ - 1], filter_[p.last - edges_].transmittance.back().lambda_um);
}

std::string_view BandSearch::name(Passband p) const {
  return p.last < edges_ ? std::string_view() : filter_[p.last - edges_].name;
}

ResponseTable BandSearch::response(Passband p) const {
  const ResponseTable& whole =
      p.last < edges_ ? whole_.response
                      : product(whole_.response, filter_[p.last - edges_].transmittance);
  return between(whole, lambda_min_um(p), lambda_max_um(p));
}

double BandSearch::gain(Passband one, Passband other) const {
  const auto mean_square = [&](Passband p) {
    return gram_[p.last][p.last] - 2 * gram_[p.first][p.last] + gram_[p.first][p.first];
  };
  const double own = mean_square(other);
  return own > 0 ? std::sqrt(std::max(0.0, mean_square(one)) / own) : 0;
}

double BandSearch::background_left(const Candidate& c) const {
  double left = 0, all = 0;
  for (std::size_t i = 0; i < population_.row.size(); ++i) {
    const double one = of(background_, c.one, i);
    left += weight_[i] * squared(one - c.gain * of(background_, *c.other, i));
    all += weight_[i] * squared(one);
  }
  return all > 0 ? std::sqrt(left / all) : 0;
}

BandSearch::Variances BandSearch::clutter_of(const Candidate& c, std::size_t row) const {
  Variances out;
  if (clutter_mode_.empty()) return out;
  const auto in = [](const std::vector<double>& by_limit, Passband p) {
    return by_limit[p.last] - by_limit[p.first];
  };
  out.one = squared(of(clutter_rest_, c.one, row));
  if (c.other) out.other = squared(of(clutter_rest_, *c.other, row));
  for (const auto& mode : clutter_mode_[row]) {
    const double one = in(mode, c.one), other = c.other ? in(mode, *c.other) : 0;
    out.one += one * one;
    out.other += other * other;
    out.both += one * other;
  }
  return out;
}

BandSearch::Variances BandSearch::variances(const Candidate& c, std::size_t row,
                                            double larger) const {
  const double noise = detector_.variance(of(photons_, c.one, row)),
               other_noise = c.other ? detector_.variance(of(photons_, *c.other, row)) : 0;
  if (clutter_mode_.empty()) return {noise, other_noise, 0};
  const Variances clutter = clutter_of(c, row);
  const double factor = larger * larger;
  return {noise + factor * clutter.one, other_noise + factor * clutter.other,
          factor * clutter.both};
}

double BandSearch::clutter_fraction(const Candidate& c) const {
  if (clutter_mode_.empty()) return 0;
  double sum = 0;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const Variances clutter = clutter_of(c, i), all = variances(c, i);
    double a = 1, b = 0;  // the weights of both passbands
    if (c.other && pairing_ == Pairing::kDifference) b = -c.gain;
    if (c.other && pairing_ != Pairing::kDifference) {
      const bool two = population_.row[i].against.has_value();
      const auto signal = [&](Passband p) {
        return of(target_.signal, p, i) - (two ? of(against_.signal, p, i) : 0);
      };
      const double s1 = signal(c.one), s2 = signal(*c.other);
      a = all.other * s1 - all.both * s2;
      b = all.one * s2 - all.both * s1;
    }
    const auto seen = [&](const Variances& v) {
      return a * a * v.one + b * b * v.other + 2 * a * b * v.both;
    };
    if (seen(all) > 0) sum += weight_[i] * std::clamp(seen(clutter) / seen(all), 0.0, 1.0);
  }
  return sum;
}

double BandSearch::of_row(const Candidate& c, std::size_t row, const Errors& error,
                          double signals) const {
  const bool two = population_.row[row].against.has_value();
  const auto target = [&](std::size_t k, Passband p) {
    return signals * of(target_.signal, p, row) + error.target[k];
  };
  const auto against = [&](std::size_t k, Passband p) {
    return two ? signals * of(against_.signal, p, row) + error.against[k] : 0.0;
  };
  const auto [v1, v2, w] =
      variances(c, row, error.log_clutter != 0 ? std::exp(error.log_clutter) : 1);
  if (!c.other) {
    const double s = target(0, c.one) - against(0, c.one);
    return v1 > 0 ? std::abs(s) / std::sqrt(v1) : 0;
  }
  if (pairing_ == Pairing::kMatched)
    return matched_snr(target(0, c.one) - against(0, c.one),
                       target(1, *c.other) - against(1, *c.other), v1, v2, w);
  if (pairing_ == Pairing::kDifference) {
    const double variance = v1 + squared(c.gain) * v2 - 2 * c.gain * w;
    const double s = target(0, c.one) - against(0, c.one) -
                     c.gain * (target(1, *c.other) - against(1, *c.other));
    return variance > 0 ? std::abs(s) / std::sqrt(variance) : 0;
  }
  if (!(v1 > 0 && v2 > 0)) return 0;
  // Axes of unit variance: the first passband, and what of the second does not go with it.
  const double n1 = 1 / std::sqrt(v1), rest = v2 - w * w / v1;
  if (!(rest > 0)) return 0;
  const double n2 = 1 / std::sqrt(rest), goes = w / v1;
  const double t1 = target(0, c.one), a1 = against(0, c.one);
  return ratio_snr(n1 * t1, n2 * (target(1, *c.other) - goes * t1), n1 * a1,
                   n2 * (against(1, *c.other) - goes * a1));
}

std::vector<double> BandSearch::snr(const Candidate& c) const {
  std::vector<double> out(population_.row.size());
  for (std::size_t row = 0; row < out.size(); ++row) out[row] = of_row(c, row, {});
  return out;
}

Candidate BandSearch::candidate(const MeritOf& merit, Passband one,
                                std::optional<Passband> other) const {
  Candidate out{one, other};
  if (other && pairing_ == Pairing::kDifference) out.gain = gain(one, *other);
  out.merit = merit_of_rows(merit, snr(out));
  return out;
}

double BandSearch::merit_at(const MeritOf& merit, const Candidate& c, double range_m) const {
  std::vector<double> weight, of_rows;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    if (population_.row[i].range_m != range_m) continue;
    weight.push_back(weight_[i]);
    of_rows.push_back(of_row(c, i, {}));
  }
  const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (double& w : weight) w /= sum;
  return merit_of(merit, weight, of_rows);
}

bool precedes(const Candidate& a, const Candidate& b) {
  const auto limits = [](const Candidate& c) {
    const Passband other = c.other.value_or(Passband{});
    return std::array{c.one.first, c.one.last, other.first, other.last};
  };
  if (a.merit != b.merit) return better(a, b);
  return limits(a) < limits(b);
}

bool BandSearch::share(Passband a, Passband b) const {
  const double both_um = std::min(limit_um_[a.last], limit_um_[b.last]) -
                         std::max(limit_um_[a.first], limit_um_[b.first]);
  const double all_um =
      limit_um_[a.last] - limit_um_[a.first] + limit_um_[b.last] - limit_um_[b.first] - both_um;
  return both_um > kSharedByAlike * all_um + 1e-9;
}

bool BandSearch::alike(const Candidate& a, const Candidate& b) const {
  if (!a.other || !b.other) return share(a.one, b.one);
  const auto by_wavelength = [](const Candidate& c) {
    return c.one.first < c.other->first ? std::pair{c.one, *c.other} : std::pair{*c.other, c.one};
  };
  const auto [a_low, a_high] = by_wavelength(a);
  const auto [b_low, b_high] = by_wavelength(b);
  return share(a_low, b_low) && share(a_high, b_high);
}

bool BandSearch::differs(const Candidate& c, std::span<const Candidate> from) const {
  return std::none_of(from.begin(), from.end(),
                      [&](const Candidate& other) { return alike(c, other); });
}

void BandSearch::append_different(std::span<const Candidate> list, std::size_t most,
                                  std::vector<Candidate>& out) const {
  for (const Candidate& c : list) {
    if (out.size() >= most) return;
    if (differs(c, out)) out.push_back(c);
  }
}

std::vector<Candidate> BandSearch::first_of(std::vector<Candidate> all, std::size_t most,
                                            Listed listed) const {
  std::sort(all.begin(), all.end(), precedes);
  if (listed == Listed::kDifferent) {
    std::vector<Candidate> out;
    append_different(all, most, out);
    return out;
  }
  all.resize(std::min(all.size(), most));
  return all;
}

BandSearch::Found BandSearch::search(const MeritOf& merit, double least_width_um, std::size_t most,
                                     Listed listed, std::size_t held_pairs) const {
  Found out;
  if (pairing_ != Pairing::kNone) {
    search_pairs(merit, least_width_um, most, listed, held_pairs, out);
    return out;
  }
  for (std::size_t first = 0; first < edges_; ++first)
    for (std::size_t last = first + 1; last < edges_; ++last) {
      if (limit_um_[last] - limit_um_[first] < least_width_um - 1e-9) continue;
      out.map.push_back(candidate(merit, {first, last}));
    }
  out.judged = out.map.size();
  out.best = first_of(out.map, most, listed);
  return out;
}

void BandSearch::each_pair(
    const MeritOf& merit, std::span<const Passband> window,
    const std::function<bool(const Candidate&)>& wanted,
    const std::function<void(const Candidate&, std::size_t, std::size_t)>& take) const {
  const std::size_t rows = population_.row.size();
  std::vector<double> s1(rows), v1(rows), s(rows);
  const bool fast = pairing_ == Pairing::kDifference;
  const bool two = population_.row.front().against.has_value();
  const auto signal = [&](Passband p, std::size_t i) {
    return of(target_.signal, p, i) - (two ? of(against_.signal, p, i) : 0);
  };
  for (std::size_t w = 0; w < window.size(); ++w) {
    for (std::size_t i = 0; i < rows; ++i) {
      s1[i] = signal(window[w], i);
      v1[i] = detector_.variance(of(photons_, window[w], i));
    }
    for (std::size_t u = 0; u < window.size(); ++u) {
      const Passband p = window[u];
      if (p.first < window[w].last) continue;
      Candidate c{window[w], p};
      if (!wanted(c)) continue;
      if (fast) {
        c.gain = gain(window[w], p);
        for (std::size_t i = 0; i < rows; ++i) {
          const Variances clutter = clutter_of(c, i);
          const double v2 = detector_.variance(of(photons_, p, i)) + clutter.other;
          const double variance =
              v1[i] + clutter.one + c.gain * c.gain * v2 - 2 * c.gain * clutter.both;
          s[i] = variance > 0 ? std::abs(s1[i] - c.gain * signal(p, i)) / std::sqrt(variance) : 0;
        }
      } else {
        for (std::size_t i = 0; i < rows; ++i) s[i] = of_row(c, i, {});
      }
      c.merit = merit_of_rows(merit, s);
      take(c, w, u);
    }
  }
}

namespace {

// The best candidates of any number, the worst of them in front of a heap.
class BestOf {
 public:
  explicit BestOf(std::size_t most) : most_(most) {}
  void take(const Candidate& c) {
    if (heap_.size() == most_ && !precedes(c, heap_.front())) {
      ++dropped_;
      return;
    }
    heap_.push_back(c);
    std::push_heap(heap_.begin(), heap_.end(), precedes);
    if (heap_.size() <= most_) return;
    std::pop_heap(heap_.begin(), heap_.end(), precedes);
    heap_.pop_back();
    ++dropped_;
  }
  // Returns the candidates in the order of a list.
  [[nodiscard]] std::vector<Candidate> sorted() {
    std::sort_heap(heap_.begin(), heap_.end(), precedes);
    return std::move(heap_);
  }
  [[nodiscard]] bool dropped() const { return dropped_ > 0; }

 private:
  std::size_t most_, dropped_ = 0;
  std::vector<Candidate> heap_;
};

}  // namespace

void BandSearch::search_pairs(const MeritOf& merit, double least_width_um, std::size_t most,
                              Listed listed, std::size_t held_pairs, Found& out) const {
  const std::size_t rows = population_.row.size();
  std::vector<std::size_t> edge;
  for (out.stride = 1;; ++out.stride) {
    edge.clear();
    for (std::size_t e = 0; e < edges_; e += out.stride) edge.push_back(e);
    if (edge.back() != edges_ - 1) edge.push_back(edges_ - 1);
    const double n = static_cast<double>(edge.size() + 1);
    const double pairs = n * (n - 1) * (n - 2) * (n - 3) / 24;
    if (edge.size() < 4 ||
        pairs * static_cast<double>(rows) * cost_of(merit, pairing_) < kMostRatios)
      break;
  }
  std::vector<Passband> window;
  for (std::size_t a = 0; a < edge.size(); ++a)
    for (std::size_t b = a + 1; b < edge.size(); ++b)
      if (limit_um_[edge[b]] - limit_um_[edge[a]] >= least_width_um - 1e-9)
        window.push_back({edge[a], edge[b]});
  std::vector<Candidate> of_window(window.size());
  const bool different = listed == Listed::kDifferent;
  BestOf first(different ? held_pairs : most);
  each_pair(
      merit, window, [](const Candidate&) { return true; },
      [&](const Candidate& c, std::size_t w, std::size_t u) {
        ++out.judged;
        for (const std::size_t part : {w, u})
          if (!of_window[part].other || better(c, of_window[part])) of_window[part] = c;
        first.take(c);
      });
  for (std::size_t w = 0; w < window.size(); ++w) {
    if (!of_window[w].other) continue;
    // The window of the map first.
    if (of_window[w].one != window[w]) std::swap(of_window[w].one, *of_window[w].other);
    out.map.push_back(of_window[w]);
  }
  bool more = first.dropped();
  if (different)
    append_different(first.sorted(), most, out.best);
  else
    out.best = first.sorted();
  // Those that were not held and differ.
  while (different && more && out.best.size() < most) {
    BestOf next(held_pairs);
    each_pair(
        merit, window, [&](const Candidate& c) { return differs(c, out.best); },
        [&](const Candidate& c, std::size_t, std::size_t) { next.take(c); });
    more = next.dropped();
    append_different(next.sorted(), most, out.best);
  }
  if (out.stride > 1) climb(merit, least_width_um, most, listed, out);
}

void BandSearch::climb(const MeritOf& merit, double least_width_um, std::size_t most, Listed listed,
                       Found& out) const {
  const auto wide = [&](Passband p) {
    return p.first < p.last && limit_um_[p.last] - limit_um_[p.first] >= least_width_um - 1e-9;
  };
  using Limits = std::array<std::size_t, 4>;
  std::map<Limits, Candidate> seen;
  for (Candidate c : out.best)
    for (bool moved = true; moved;) {
      moved = false;
      for (std::size_t limit = 0; limit < 4; ++limit)
        for (const int by : {-1, 1}) {
          Limits at = {c.one.first, c.one.last, c.other->first, c.other->last};
          if (by < 0 ? at[limit] == 0 : at[limit] + 1 == edges_) continue;
          at[limit] = by < 0 ? at[limit] - 1 : at[limit] + 1;
          const Passband one{at[0], at[1]}, other{at[2], at[3]};
          if (!wide(one) || !wide(other) || (one.last > other.first && other.last > one.first))
            continue;
          const auto [found, added] = seen.try_emplace(at);
          if (added) found->second = candidate(merit, one, other);
          if (!better(found->second, c)) continue;
          c = found->second;
          moved = true;
        }
    }
  out.judged += seen.size();
  for (const Candidate& c : out.best)
    seen.try_emplace({c.one.first, c.one.last, c.other->first, c.other->last}, c);
  std::vector<Candidate> all;
  for (const auto& [limits, c] : seen) all.push_back(c);
  out.best = first_of(std::move(all), most, listed);
}

double BandSearch::mean_stderr(Passband p) const {
  // [view][mode], the rest as one more.
  std::map<std::pair<std::size_t, std::size_t>, double> sum;
  const auto add = [&](const Cumulated& c, std::size_t first_mode, std::size_t i, double per) {
    const std::size_t view = population_.row[i].view;
    for (std::size_t k = 0; k < c.mode[i].size(); ++k)
      sum[{view, first_mode + k + 1}] += per * (c.mode[i][k][p.last] - c.mode[i][k][p.first]);
    sum[{view, first_mode}] += std::abs(per) * of(c.rest, p, i);
  };
  constexpr std::size_t kOfAgainst = 1'000'000;
  for (std::size_t i = 0; i < population_.row.size(); ++i) {
    const bool two = population_.row[i].against.has_value();
    const double signal = of(target_.signal, p, i) - (two ? of(against_.signal, p, i) : 0);
    const double variance = variances({p}, i).one;
    if (!(variance > 0)) continue;
    const double per = weight_[i] * (signal < 0 ? -1 : 1) / std::sqrt(variance);
    add(target_, 0, i, per);
    if (two) add(against_, kOfAgainst, i, -per);
  }
  double variance = 0;
  for (const auto& [key, value] : sum) variance += squared(value);
  return std::sqrt(variance);
}

double BandSearch::range_reached(const Place& place, double threshold,
                                 std::span<const double> snr) {
  const auto& row = place.row;
  std::size_t seen = row.size();  // up to the farthest that is
  while (seen > 0 && !(snr[row[seen - 1].second] >= threshold)) --seen;
  double slope = -2;
  if (row.size() > 1) {
    const std::size_t far = std::clamp<std::size_t>(seen, 1, row.size() - 1);
    const auto log_snr = [&](std::size_t k) {
      return std::log(std::max(snr[row[k].second], 1e-300));
    };
    slope = (log_snr(far) - log_snr(far - 1)) / std::log(row[far].first / row[far - 1].first);
  }
  if (seen == 0 || seen == row.size()) slope = std::min(slope, -2.0);
  const auto& [range_m, from] = row[seen > 0 ? seen - 1 : 0];
  return range_m * std::pow(snr[from] / threshold, -1 / slope);
}

double BandSearch::merit_of_rows(const MeritOf& merit, std::span<const double> snr) const {
  if (merit.merit != Merit::kRange) return merit_of(merit, weight_, snr);
  std::vector<double> weight, range_m;
  for (const Place& place : place_) {
    weight.push_back(place.weight);
    range_m.push_back(range_reached(place, merit.threshold, snr));
  }
  return merit_of(merit, weight, range_m);
}

bool BandSearch::extrapolated(const MeritOf& merit, const Candidate& c) const {
  if (merit.merit != Merit::kRange) return false;
  std::vector<double> weight, range_m;
  for (const Detection& d : detection(c, merit.threshold)) {
    weight.push_back(d.weight);
    range_m.push_back(d.range_m);
  }
  const double reached = merit_of(merit, weight, range_m);
  return !(reached > 0 && std::isfinite(reached));
}

absl::Status BandSearch::check(const MeritOf& merit) const {
  if (merit.merit != Merit::kRange) return absl::OkStatus();
  for (const Place& place : place_)
    if (place.row.size() < 2)
      return absl::InvalidArgumentError(fmt::format(
          "the merit \"range\" is how far rows are seen, between two ranges or more, and these are "
          "at {:g} m alone: ask for several (--range-m)",
          place.row.front().first));
  return absl::OkStatus();
}

std::vector<BandSearch::Detection> BandSearch::detection(const Candidate& c,
                                                         double threshold) const {
  const std::vector<double> of_rows = snr(c);
  std::vector<Detection> out;
  for (const Place& place : place_) {
    const double range_m = range_reached(place, threshold, of_rows);
    out.push_back({place.first_row, place.weight,
                   range_m < place.row.front().first  ? 0
                   : range_m > place.row.back().first ? std::numeric_limits<double>::infinity()
                                                      : range_m});
  }
  return out;
}

}  // namespace irsig
