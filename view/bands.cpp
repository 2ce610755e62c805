#include "view/bands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <tuple>

#include "view/measured_row.h"

namespace irsig {
namespace {

constexpr int kDraws = 400;
constexpr std::uint32_t kSeed = 20240229;

// What of a table lies between two wavelengths, cut off there.
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

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

// Of aspects, each as often as the nearest of evenly spread directions is it.
std::vector<double> solid_angles(const std::vector<std::pair<double, double>>& aspect_deg) {
  constexpr int kDirections = 20000;
  const double rad = std::numbers::pi / 180;
  struct Unit {
    double x, y, z;
  };
  std::vector<Unit> unit;
  double lowest = 1, highest = -1;
  for (const auto& [azimuth, elevation] : aspect_deg) {
    const double c = std::cos(elevation * rad);
    unit.push_back(
        {c * std::cos(azimuth * rad), c * std::sin(azimuth * rad), std::sin(elevation * rad)});
    lowest = std::min(lowest, unit.back().z);
    highest = std::max(highest, unit.back().z);
  }
  const bool zone = highest - lowest > 1e-6;
  std::vector<double> out(unit.size(), 0.0);
  for (int n = 0; n < kDirections; ++n) {
    const double share = (n + 0.5) / kDirections;
    const double z = zone ? lowest + (highest - lowest) * share : 2 * share - 1;
    const double c = std::sqrt(std::max(0.0, 1 - z * z)),
                 azimuth = n * std::numbers::pi * (3 - std::sqrt(5.0));
    std::size_t nearest = 0;
    double most = -2;
    for (std::size_t i = 0; i < unit.size(); ++i)
      if (const double d =
              c * std::cos(azimuth) * unit[i].x + c * std::sin(azimuth) * unit[i].y + z * unit[i].z;
          d > most) {
        most = d;
        nearest = i;
      }
    out[nearest] += 1.0 / kDirections;
  }
  return out;
}

using Place = std::tuple<std::string, std::string, double, double, double>;
Place place_of(const StoredSignature& s) {
  return {s.season, s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m};
}

double squared(double x) { return x * x; }

absl::StatusOr<BandCase> case_of(StoreReader& reader, const QueryRow& row,
                                 std::vector<double>& lambda_um) {
  if (row.interpolation)
    return absl::InvalidArgumentError("interpolated rows have no spectra whose errors are known");
  const auto got = spectrum_of(reader, row);
  if (!got.ok()) return got.status();
  const schema::Spectrum& s = got->spectrum;
  if (s.contrast_spectral_intensity_w_sr_um().empty())
    return absl::FailedPreconditionError(fmt::format(
        "row {} was stored by an older irsig, without a contrast spectrum: run the sweep again",
        row.signature.row));
  const std::vector<double> axis(s.lambda_um().begin(), s.lambda_um().end());
  if (lambda_um.empty()) lambda_um = axis;
  if (lambda_um != axis)
    return absl::InvalidArgumentError("the rows have not all the same wavelengths");
  const auto& stderrs = s.contrast_spectral_intensity_stderr_w_sr_um();
  auto errors = SumErrors::make({stderrs.data(), static_cast<std::size_t>(stderrs.size())},
                                s.contrast_spectral_intensity_modes());
  if (!errors.ok()) return errors.status();
  const Measured contrast = contrast_of(row.signature);
  const auto known = [](double value) { return std::isnan(value) ? 0 : value; };
  const auto& values = s.contrast_spectral_intensity_w_sr_um();
  const auto& behind = s.background_radiance_w_m2_sr_um();
  return BandCase{0,
                  0,
                  row.signature.range_m,
                  0,
                  {values.begin(), values.end()},
                  {behind.begin(), behind.end()},
                  errors->modes(),
                  errors->rest(),
                  contrast.bias_bound(),
                  contrast.unseen_stderr,
                  std::hypot(known(row.signature.contrast_model_error_w_sr),
                             known(row.signature.contrast_input_uncertainty_w_sr))};
}

}  // namespace

absl::StatusOr<BandPopulation> band_population(StoreReader& reader, std::span<const QueryRow> rows,
                                               StoreReader* other,
                                               std::span<const QueryRow> against,
                                               AspectWeight weight) {
  if (rows.empty()) return absl::InvalidArgumentError("no signature matches");
  BandPopulation out;
  std::map<Place, const QueryRow*> partner;
  for (const QueryRow& row : against) partner[place_of(row.signature)] = &row;
  std::map<std::tuple<std::string, double, double, double>, std::size_t> views;
  std::map<std::tuple<std::string, std::string, std::string, double, double>, std::size_t> places;
  std::map<std::pair<double, double>, std::size_t> aspects;
  std::vector<std::size_t> aspect_of;
  const StoredSignature& any = rows.front().signature;
  for (const QueryRow& row : rows) {
    const StoredSignature& s = row.signature;
    if (s.band != any.band || s.sweep != any.sweep)
      return absl::InvalidArgumentError(fmt::format(
          "rows of several {}s match, \"{}\" and \"{}\": expected one of them",
          s.band != any.band ? "band" : "sweep", s.band != any.band ? any.band : any.sweep,
          s.band != any.band ? s.band : s.sweep));
    auto made = case_of(reader, row, out.lambda_um);
    if (!made.ok()) return made.status();
    if (other != nullptr) {
      const auto found = partner.find(place_of(s));
      if (found == partner.end())
        return absl::InvalidArgumentError(fmt::format(
            "the other target has no row for {} {}, aspect {:g},{:g} at {:g} m", s.season,
            s.time_utc, s.aspect_azimuth_deg, s.aspect_elevation_deg, s.range_m));
      auto theirs = case_of(*other, *found->second, out.lambda_um);
      if (!theirs.ok()) return theirs.status();
      for (std::size_t k = 0; k < made->contrast.size(); ++k)
        made->contrast[k] -= theirs->contrast[k];
      // Independent samples; the sign of a mode says nothing. What is left over may be one.
      made->modes.insert(made->modes.end(), theirs->modes.begin(), theirs->modes.end());
      for (std::size_t k = 0; k < made->rest.size(); ++k) made->rest[k] += theirs->rest[k];
      made->bias_bound_w_sr += theirs->bias_bound_w_sr;
      made->unseen_stderr_w_sr += theirs->unseen_stderr_w_sr;
      made->model_error_w_sr = std::hypot(made->model_error_w_sr, theirs->model_error_w_sr);
    }
    if (made->modes.empty()) ++out.without_modes;
    made->view = views
                     .try_emplace({s.sweep, s.aspect_azimuth_deg, s.aspect_elevation_deg,
                                   row.range_change ? row.range_change->stored_range_m : s.range_m},
                                  views.size())
                     .first->second;
    made->place = places
                      .try_emplace({s.sweep, s.season, s.time_utc, s.aspect_azimuth_deg,
                                    s.aspect_elevation_deg},
                                   places.size())
                      .first->second;
    aspect_of.push_back(
        aspects.try_emplace({s.aspect_azimuth_deg, s.aspect_elevation_deg}, aspects.size())
            .first->second);
    out.row.push_back(*std::move(made));
  }
  if (out.lambda_um.size() < 2) return absl::InvalidArgumentError("the band has one wavelength");
  std::vector<double> of_aspect(aspects.size(), 1);
  if (weight == AspectWeight::kSolidAngle) {
    std::vector<std::pair<double, double>> aspect(aspects.size());
    for (const auto& [angles, at] : aspects) aspect[at] = angles;
    of_aspect = solid_angles(aspect);
  }
  // Rows of one aspect share its weight.
  std::vector<double> rows_of(aspects.size(), 0);
  for (const std::size_t a : aspect_of) ++rows_of[a];
  double sum = 0;
  for (std::size_t i = 0; i < out.row.size(); ++i) {
    const double share = weight == AspectWeight::kSolidAngle ? 1 / rows_of[aspect_of[i]] : 1;
    out.row[i].weight = of_aspect[aspect_of[i]] * share;
    sum += out.row[i].weight;
  }
  for (BandCase& row : out.row) row.weight /= sum;
  const auto sweep = reader.sweep(any.sweep);
  if (!sweep.ok()) return sweep.status();
  auto own = response_of(*sweep, any.band);
  if (!own.ok()) return own.status();
  out.own_response = *std::move(own);
  return out;
}

absl::StatusOr<BandSearch> BandSearch::make(BandPopulation population, const Detector& detector) {
  BandSearch out;
  out.population_ = std::move(population);
  const std::vector<double>& lambda_um = out.population_.lambda_um;
  const double first = lambda_um.front(), last = lambda_um.back();
  out.step_um_ = (last - first) / static_cast<double>(lambda_um.size() - 1);
  Detector whole = detector;
  if (whole.response.empty()) whole.response = window(first, last);
  const auto fits = band_weights(lambda_um, whole.response);
  if (!fits.ok())
    return absl::InvalidArgumentError(
        fmt::format("the detector's response: {}; give --window or a response within the band, or "
                    "ask for a wider [[band]] in the sweep",
                    std::string(fits.status().message())));
  out.detector_ = integrals_of(whole);
  out.ratio_ = largest_ratio(out.detector_.signal, out.population_.own_response);
  if (std::isinf(out.ratio_))
    return absl::InvalidArgumentError(
        "the stored band's own response is 0 where the detector's is not: nothing is known of "
        "errors there");
  // Edges where the detector sees anything.
  const double low = std::max(first, whole.response.front().lambda_um),
               high = std::min(last, whole.response.back().lambda_um);
  out.edges_um_ = {low};
  for (std::size_t k = 0; k + 1 < lambda_um.size(); ++k)
    if (const double edge = lambda_um[k] + 0.5 * out.step_um_;
        edge > low + 1e-9 && edge < high - 1e-9)
      out.edges_um_.push_back(edge);
  out.edges_um_.push_back(high);

  // Integrals up to each edge, as weights of bins: the same for all rows.
  const std::size_t edges = out.edges_um_.size(), bins = lambda_um.size();
  std::vector<std::vector<double>> signal(edges, std::vector<double>(bins, 0.0)), photons = signal,
                                                                                  slope = signal;
  const auto weights = [&](const ResponseTable& table, std::size_t e) -> std::vector<double> {
    const auto found = band_weights(lambda_um, between(table, low, out.edges_um_[e]));
    return found.ok() ? found->weight : std::vector<double>(bins, 0.0);  // 0 so far
  };
  for (std::size_t e = 1; e < edges; ++e) {
    signal[e] = weights(out.detector_.signal, e);
    if (!out.detector_.photons.empty()) photons[e] = weights(out.detector_.photons, e);
    for (std::size_t k = 0; k < bins; ++k)
      slope[e][k] = signal[e][k] * (2 * (lambda_um[k] - first) / (last - first) - 1);
  }
  for (const BandCase& row : out.population_.row) {
    Cumulated& c = out.cumulated_.emplace_back();
    std::vector<double> magnitude;
    for (const double value : row.contrast) magnitude.push_back(std::abs(value));
    const double per_m2 = 1 / squared(row.range_m);
    c.mode.resize(row.modes.size());
    for (std::size_t e = 0; e < edges; ++e) {
      c.signal.push_back(per_m2 * dot(signal[e], row.contrast));
      c.photons.push_back(
          row.background_w_m2_sr_um.empty() ? 0 : dot(photons[e], row.background_w_m2_sr_um));
      c.rest.push_back(per_m2 * dot(signal[e], row.rest));
      c.shape.push_back(per_m2 * dot(signal[e], magnitude));
      c.slope.push_back(per_m2 * dot(slope[e], magnitude));
      for (std::size_t k = 0; k < c.mode.size(); ++k)
        c.mode[k].push_back(per_m2 * dot(signal[e], row.modes[k]));
    }
  }
  return out;
}

double BandSearch::of_row(std::size_t row, double error, std::size_t first,
                          std::size_t last) const {
  const Cumulated& c = cumulated_[row];
  return std::abs(
      detector_.snr(c.signal[last] - c.signal[first] + error, c.photons[last] - c.photons[first]));
}

std::vector<double> BandSearch::snr(std::size_t first, std::size_t last) const {
  std::vector<double> out;
  for (std::size_t row = 0; row < cumulated_.size(); ++row)
    out.push_back(of_row(row, 0, first, last));
  return out;
}

double BandSearch::merit_of(const MeritOf& merit, std::vector<double>& snr) const {
  const auto& row = population_.row;
  switch (merit.merit) {
    case Merit::kMean: {
      double sum = 0;
      for (std::size_t i = 0; i < snr.size(); ++i) sum += row[i].weight * snr[i];
      return sum;
    }
    case Merit::kWorst:
      return *std::min_element(snr.begin(), snr.end());
    case Merit::kAbove: {
      double sum = 0;
      for (std::size_t i = 0; i < snr.size(); ++i)
        if (snr[i] >= merit.threshold) sum += row[i].weight;
      return sum;
    }
    case Merit::kPercentile: {
      std::vector<std::size_t> order(snr.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::sort(order.begin(), order.end(),
                [&](std::size_t a, std::size_t b) { return snr[a] < snr[b]; });
      double sum = 0;
      for (const std::size_t i : order) {
        sum += row[i].weight;
        if (sum >= 0.01 * merit.percentile * (1 - 1e-12)) return snr[i];
      }
      return snr[order.back()];
    }
  }
  return 0;
}

double BandSearch::merit(const MeritOf& merit, std::size_t first, std::size_t last) const {
  std::vector<double> of_rows = snr(first, last);
  return merit_of(merit, of_rows);
}

BandSearch::Map BandSearch::map(const MeritOf& merit, double least_width_um) const {
  Map out;
  for (std::size_t first = 0; first < edges_um_.size(); ++first)
    for (std::size_t last = first + 1; last < edges_um_.size(); ++last) {
      if (edges_um_[last] - edges_um_[first] < least_width_um - 1e-9) continue;
      out.first.push_back(first);
      out.last.push_back(last);
      out.merit.push_back(this->merit(merit, first, last));
    }
  return out;
}

double BandSearch::mean_stderr(std::size_t first, std::size_t last) const {
  // [view][mode], the rest as one more.
  std::map<std::pair<std::size_t, std::size_t>, double> sum;
  for (std::size_t i = 0; i < cumulated_.size(); ++i) {
    const Cumulated& c = cumulated_[i];
    const double signal = c.signal[last] - c.signal[first],
                 photons = c.photons[last] - c.photons[first];
    const double per = population_.row[i].weight * detector_.snr(signal < 0 ? -1 : 1, photons);
    for (std::size_t k = 0; k < c.mode.size(); ++k)
      sum[{population_.row[i].view, k + 1}] += per * (c.mode[k][last] - c.mode[k][first]);
    sum[{population_.row[i].view, 0}] += std::abs(per) * (c.rest[last] - c.rest[first]);
  }
  double variance = 0;
  for (const auto& [key, value] : sum) variance += squared(value);
  return std::sqrt(variance);
}

BandChoice BandSearch::compare(const MeritOf& merit, const Map& map, std::size_t most) const {
  std::vector<std::size_t> order(map.merit.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return map.merit[a] > map.merit[b]; });
  order.resize(std::min(order.size(), most));
  BandChoice out;
  if (order.empty()) return out;

  enum Kind { kSamples, kNumerical, kAll, kKinds };
  const std::size_t windows = order.size();
  // [kind][window][draw]
  std::vector<std::vector<std::vector<double>>> drawn(kKinds,
                                                      std::vector<std::vector<double>>(windows));
  std::size_t views = 0, modes = 0;
  for (std::size_t i = 0; i < cumulated_.size(); ++i) {
    views = std::max(views, population_.row[i].view + 1);
    modes = std::max(modes, cumulated_[i].mode.size());
  }
  std::mt19937_64 random(kSeed);
  // Of a library's distributions the numbers are its own; these are the same everywhere.
  const auto uniform = [&] { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; };
  const auto normal = [&] {
    const double radius = std::sqrt(-2 * std::log(uniform()));  // the first of two numbers
    return radius * std::cos(2 * std::numbers::pi * uniform());
  };
  const std::size_t end = edges_um_.size() - 1;
  std::vector<double> z(views * (modes + 2));
  std::vector<std::vector<double>> of_rows(kKinds, std::vector<double>(cumulated_.size()));
  for (int draw = 0; draw < kDraws; ++draw) {
    for (double& value : z) value = normal();
    const double bound_level = 2 * uniform() - 1,
                 bound_slope = std::sqrt(3.0) * (2 * uniform() - 1), model_level = normal(),
                 model_slope = std::sqrt(3.0) * normal();
    for (std::size_t w = 0; w < windows; ++w) {
      const std::size_t first = map.first[order[w]], last = map.last[order[w]];
      for (std::size_t i = 0; i < cumulated_.size(); ++i) {
        const BandCase& row = population_.row[i];
        const Cumulated& c = cumulated_[i];
        const double* of_view = z.data() + row.view * (modes + 2);
        double error = of_view[modes] * (c.rest[last] - c.rest[first]);
        for (std::size_t k = 0; k < c.mode.size(); ++k)
          error += of_view[k] * (c.mode[k][last] - c.mode[k][first]);
        of_rows[kSamples][i] = of_row(i, error, first, last);
        const double half = std::sqrt(0.5), shape = c.shape[last] - c.shape[first],
                     slope = c.slope[last] - c.slope[first];
        const double per_w_sr = c.shape[end] > 0 ? ratio_ / squared(row.range_m) / c.shape[end] : 0;
        error +=
            per_w_sr * (row.bias_bound_w_sr * half * (bound_level * shape + bound_slope * slope) +
                        row.unseen_stderr_w_sr * of_view[modes + 1] * shape);
        of_rows[kNumerical][i] = of_row(i, error, first, last);
        error +=
            per_w_sr * row.model_error_w_sr * half * (model_level * shape + model_slope * slope);
        of_rows[kAll][i] = of_row(i, error, first, last);
      }
      for (const Kind kind : {kSamples, kNumerical, kAll})
        drawn[kind][w].push_back(merit_of(merit, of_rows[kind]));
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
  for (std::size_t w = 0; w < windows; ++w) {
    const std::size_t at = order[w];
    WindowMerit& m = out.window.emplace_back(
        WindowMerit{edges_um_[map.first[at]], edges_um_[map.last[at]], map.merit[at],
                    scatter(drawn[kSamples][w]), scatter(drawn[kNumerical][w]),
                    scatter(drawn[kAll][w]), 0, 0, 0});
    for (int d = 0; d < kDraws; ++d)
      if (drawn[kAll][w][static_cast<std::size_t>(d)] >=
          drawn[kAll][0][static_cast<std::size_t>(d)])
        ++m.as_good;
    m.as_good /= kDraws;
  }
  for (std::size_t d = 0; d < kDraws; ++d)
    for (const Kind kind : {kNumerical, kAll}) {
      std::size_t best = 0;
      for (std::size_t w = 1; w < windows; ++w)
        if (drawn[kind][w][d] > drawn[kind][best][d]) best = w;
      ++(kind == kAll ? out.window[best].best : out.window[best].best_numerical);
    }
  for (WindowMerit& w : out.window) {
    w.best /= kDraws;
    w.best_numerical /= kDraws;
  }
  if (windows < 2) return out;
  const auto difference_of = [&](Kind kind) {
    std::vector<double> difference;
    for (std::size_t d = 0; d < kDraws; ++d)
      difference.push_back(drawn[kind][0][d] - drawn[kind][1][d]);
    return scatter(difference);
  };
  const double apart = 0.5 * (out.window[0].merit - out.window[1].merit);
  const double samples = squared(difference_of(kSamples)), all = squared(difference_of(kAll));
  if (all <= squared(apart)) return out;
  const double left = squared(apart) - std::max(0.0, all - samples);
  out.samples_to_tell = left > 0 ? samples / left : std::numeric_limits<double>::infinity();
  return out;
}

std::vector<double> BandSearch::detection_range_m(std::size_t first, std::size_t last,
                                                  double threshold) const {
  std::map<std::size_t, std::map<double, double>> of_place;  // s by range
  for (std::size_t i = 0; i < cumulated_.size(); ++i)
    of_place[population_.row[i].place][population_.row[i].range_m] = of_row(i, 0, first, last);
  std::vector<double> out;
  for (const auto& [place, by_range] : of_place) {
    double range = 0;
    for (auto at = by_range.rbegin(); at != by_range.rend(); ++at) {
      if (!(at->second >= threshold)) continue;
      if (at == by_range.rbegin()) {
        range = std::numeric_limits<double>::infinity();
        break;
      }
      const auto beyond = std::prev(at);
      const double below = std::max(beyond->second, 1e-300);
      const double share = std::log(at->second / threshold) / std::log(at->second / below);
      range = at->first * std::pow(beyond->first / at->first, share);
      break;
    }
    out.push_back(range);
  }
  return out;
}

}  // namespace irsig
