#include "core/spectral/band.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/status_macros.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

constexpr double kGauss2 = 0.57735026918962576451;  // 1 / sqrt(3)

// Gauss-Legendre, 6 points: the positive half.
constexpr std::array<std::array<double, 2>, 3> kGauss6 = {
    {{0.23861918608319690863, 0.46791393457269104739},
     {0.66120938646626451366, 0.36076157304813860757},
     {0.93246951420315202781, 0.17132449237917034504}}};

// A million stored wavelengths are 32 MB of nodes for every quantity at every condition.
constexpr double kMostSteps = 1e6;

absl::Status refuse(const Band& band, const std::string& why) {
  return absl::InvalidArgumentError(absl::StrCat("band \"", band.name, "\": ", why));
}

absl::Status check_response(const Band& band) {
  const std::vector<SpectralPoint>& response = band.response;
  if (response.empty()) return absl::OkStatus();
  if (response.size() < 2) return refuse(band, "a response needs at least two points");
  bool covers_any = false;
  for (std::size_t i = 0; i < response.size(); ++i) {
    const auto [lambda_um, value] = response[i];
    if (!std::isfinite(lambda_um) || !std::isfinite(value) || value < 0.0) {
      return refuse(band, absl::StrCat("response point ", i + 1, " (", lambda_um, " um, ", value,
                                       "): expected finite numbers and a value of at least 0"));
    }
    if (i == 0) continue;
    if (!(response[i - 1].lambda_um < lambda_um)) {
      return refuse(band, absl::StrCat("response wavelengths must increase: ",
                                       response[i - 1].lambda_um, " um, then ", lambda_um, " um"));
    }
    covers_any |= (value > 0.0 || response[i - 1].value > 0.0) && lambda_um > band.lambda_min_um &&
                  response[i - 1].lambda_um < band.lambda_max_um;
  }
  if (!covers_any) return refuse(band, "its response is 0 everywhere between its limits");
  return absl::OkStatus();
}

// The ascending points that cut [from_um, to_um] into intervals in which the response is linear.
std::vector<double> linear_intervals(const Band& band, double from_um, double to_um) {
  std::vector<double> cuts;
  cuts.reserve(2);
  cuts.push_back(from_um);
  for (const SpectralPoint& point : band.response) {
    if (point.lambda_um > from_um && point.lambda_um < to_um) cuts.push_back(point.lambda_um);
  }
  cuts.push_back(to_um);
  return cuts;
}

// Response at `at_um`, which lies in a linear interval around `inside_um`: the one-sided value at
// its ends.
double response_from(const Band& band, double inside_um, double at_um) {
  const auto& r = band.response;
  if (r.empty()) return 1.0;
  const auto above =
      std::upper_bound(r.begin(), r.end(), inside_um,
                       [](double x, const SpectralPoint& p) { return x < p.lambda_um; });
  if (above == r.begin() || above == r.end()) return 0.0;
  const SpectralPoint& a = *(above - 1);
  return std::lerp(a.value, above->value, (at_um - a.lambda_um) / (above->lambda_um - a.lambda_um));
}

struct PanelWeights {
  double lower, upper;
  // Both ends have one sign: in-band radiances are positive and increase with temperature.
  [[nodiscard]] bool sound() const { return lower >= 0 && upper >= 0; }
};

// Weights of the panel's two nodes that integrate response x L exactly for every L linear over the
// panel, wherever the response has its corners and jumps (for a constant response: Gauss-Legendre).
PanelWeights panel_weights(const Band& band, double from_um, double to_um) {
  const double middle = 0.5 * (from_um + to_um);
  const double half = 0.5 * (to_um - from_um);
  double mass = 0.0;
  double moment = 0.0;  // about the middle, in units of half
  const std::vector<double> cuts = linear_intervals(band, from_um, to_um);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double centre = 0.5 * (cuts[i] + cuts[i + 1]);
    const double reach = 0.5 * (cuts[i + 1] - cuts[i]);
    for (const double side : {-kGauss2, kGauss2}) {  // exact: linear response x linear function
      const double at = centre + side * reach;
      const double weight = reach * response_from(band, centre, at);
      mass += weight;
      moment += weight * (at - middle) / half;
    }
  }
  const double shift = moment / kGauss2;
  return {0.5 * (mass - shift), 0.5 * (mass + shift)};
}

// A response may leave so little of a panel, near one of its edges, that a weight would be
// negative. The panel is then cut at the response's points, between which it is linear and all
// weights are sound.
void cut_where_unsound(const Band& band, std::vector<double>& cuts) {
  std::vector<double> out{cuts.front()};
  for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
    if (panel_weights(band, cuts[c], cuts[c + 1]).sound()) {
      out.push_back(cuts[c + 1]);
      continue;
    }
    const std::vector<double> linear = linear_intervals(band, cuts[c], cuts[c + 1]);
    out.insert(out.end(), linear.begin() + 1, linear.end());
  }
  cuts = std::move(out);
}

// Calls visit(wavelength, weight) for the points of a quadrature of response x ..., to about 1e-12
// for what is smooth over pieces of `step_um`.
template <typename Visit>
void visit_points(const Band& band, double from_um, double to_um, double step_um, Visit&& visit) {
  const std::vector<double> cuts = linear_intervals(band, from_um, to_um);
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const double length = cuts[i + 1] - cuts[i];
    const double pieces = std::max(1.0, std::ceil(length / step_um));
    const double half = 0.5 * length / pieces;
    for (double piece = 0.0; piece < pieces; piece += 1.0) {
      const double middle = cuts[i] + (2.0 * piece + 1.0) * half;
      for (const auto& [abscissa, weight] : kGauss6)
        for (const double side : {-abscissa, abscissa}) {
          const double at = middle + side * half;
          visit(at, half * weight * response_from(band, middle, at));
        }
    }
  }
}

// The in-band radiance of a blackbody through a tabulated response, to about 1e-12.
double exact_in_band_w_m2_sr(const Band& band, double step_um, double temperature_k) {
  if (band.response.empty()) {
    return planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, temperature_k);
  }
  double sum = 0.0;
  visit_points(band, band.lambda_min_um, band.lambda_max_um, step_um,
               [&](double at, double weight) {
                 sum += weight * planck_radiance_w_m2_sr_um(at, temperature_k);
               });
  return sum;
}

double grid_in_band_w_m2_sr(const BandGrid& grid, double temperature_k) {
  double sum = 0.0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    if (grid.band_weight[i] > 0.0) {
      sum += grid.band_weight[i] * planck_radiance_w_m2_sr_um(grid.node_um[i], temperature_k);
    }
  }
  return sum;
}

}  // namespace

double band_response(const Band& band, double lambda_um) {
  if (!(lambda_um >= band.lambda_min_um && lambda_um <= band.lambda_max_um)) return 0.0;
  if (band.response.empty()) return 1.0;
  if (lambda_um == band.response.back().lambda_um) return band.response.back().value;
  return response_from(band, lambda_um, lambda_um);
}

absl::StatusOr<BandGrid> make_band_grid(const Band& band, std::span<const double> breaks_um,
                                        std::span<const double> corners_um) {
  const double low = band.lambda_min_um;
  const double high = band.lambda_max_um;
  if (!(low >= kPlanckLambdaMinUm && high <= kPlanckLambdaMaxUm && low < high)) {
    return refuse(band, absl::StrCat("limits ", low, " and ", high,
                                     " um: expected 0 < lambda_min_um < lambda_max_um"));
  }
  if (!(band.step_um > 0.0 && band.step_um <= (high - low) * (1.0 + 1e-9))) {
    return refuse(band,
                  absl::StrCat("step ", band.step_um, " um: expected more than 0 and at most ",
                               high - low, " um, the width of the band"));
  }
  const double steps = std::round((high - low) / band.step_um);
  if (steps > kMostSteps) {
    return refuse(band, absl::StrCat("step ", band.step_um, " um gives ", steps,
                                     " wavelengths: expected at most ", kMostSteps));
  }
  BandGrid grid;
  grid.step_um = (high - low) / steps;
  if (!(low - 0.5 * grid.step_um >= kPlanckLambdaMinUm)) {
    return refuse(
        band, absl::StrCat("step ", band.step_um, " um is too wide for a band that begins at ", low,
                           " um: the first bin would reach 0"));
  }
  RETURN_IF_ERROR(check_response(band));

  const auto n = static_cast<std::size_t>(steps);
  const double half = 0.5 * grid.step_um;
  std::vector<double> cuts;
  for (std::size_t k = 0; k <= n; ++k) {
    const double lambda = low + (high - low) * (static_cast<double>(k) / steps);
    grid.lambda_um.push_back(lambda);
    grid.bin_first.push_back(grid.node_um.size());
    // The middle of the first and last bin is a limit of the band.
    cuts = {lambda - half};
    if (breaks_um.empty() || k == 0 || k == n) cuts.push_back(lambda);
    for (const std::span<const double> list : {breaks_um, corners_um})
      for (auto at = std::upper_bound(list.begin(), list.end(), lambda - half);
           at != list.end() && *at < lambda + half; ++at)
        cuts.push_back(*at);
    cuts.push_back(lambda + half);
    std::sort(cuts.begin(), cuts.end());
    // Cuts that differ by rounding are one.
    const double least = 1e-9 * grid.step_um;
    cuts.erase(std::unique(cuts.begin(), cuts.end(),
                           [least](double a, double b) { return b - a < least; }),
               cuts.end());
    cuts.back() = std::max(cuts.back(), lambda + half);
    cut_where_unsound(band, cuts);
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
      const double from = cuts[c], to = cuts[c + 1], reach = 0.5 * (to - from);
      for (const double side : {-kGauss2, kGauss2}) {
        grid.node_um.push_back(0.5 * (from + to) + side * reach);
        grid.bin_weight.push_back(reach / grid.step_um);
      }
      // A cut at a limit of the band may be off by rounding: a panel is where its middle is.
      const double middle = 0.5 * (from + to);
      const bool outside = (k == 0 && middle < lambda) || (k == n && middle > lambda);
      const PanelWeights weights = outside ? PanelWeights{0.0, 0.0} : panel_weights(band, from, to);
      grid.band_weight.push_back(std::max(0.0, weights.lower));  // rounding
      grid.band_weight.push_back(std::max(0.0, weights.upper));
    }
  }
  grid.bin_first.push_back(grid.node_um.size());
  return grid;
}

// Like the plain band (planck_inverse.cpp), this is a positive sum of exponentials of 1/T, hence
// Newton's iteration from above. It starts where some node has at most the weighted mean of the
// spectral radiance.
double radiance_temperature_k(const Band& band, const BandGrid& grid, double radiance_w_m2_sr) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!(radiance_w_m2_sr >= 0.0)) return kNone;
  if (radiance_w_m2_sr == 0.0) return 0.0;
  if (band.response.empty()) {
    return radiance_temperature_k(band.lambda_min_um, band.lambda_max_um, radiance_w_m2_sr);
  }
  if (radiance_w_m2_sr > grid_in_band_w_m2_sr(grid, kPlanckTemperatureMaxK)) return kNone;
  double width_um = 0.0;
  double longest_um = 0.0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    width_um += grid.band_weight[i];
    if (grid.band_weight[i] > 0.0) longest_um = grid.node_um[i];
  }
  // Never 0, which is no starting point: the quotient may underflow.
  const double mean =
      std::max(radiance_w_m2_sr / width_um, std::numeric_limits<double>::denorm_min());
  double temperature_k = 0.0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
    if (grid.band_weight[i] > 0.0) {
      // Near the highest temperature a node's may lie above it, and is NaN.
      const double at_node_k = monochromatic_temperature_k(grid.node_um[i], mean);
      temperature_k =
          std::max(temperature_k, std::isnan(at_node_k) ? kPlanckTemperatureMaxK : at_node_k);
    }
  }
  constexpr int kMostIterations = 200;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    // exp(-shift), the largest of the exponentials, is taken out so that nothing underflows.
    const double shift = kC2UmK / (longest_um * temperature_k);
    double value = 0.0;
    double slope = 0.0;  // temperature x derivative
    for (std::size_t i = 0; i < grid.node_um.size(); ++i) {
      if (!(grid.band_weight[i] > 0.0)) continue;
      const double lambda = grid.node_um[i];
      const double x = kC2UmK / (lambda * temperature_k);
      const double one_minus_exp = -std::expm1(-x);
      const double term = grid.band_weight[i] * kC1LWUm4M2Sr / std::pow(lambda, 5) *
                          std::exp(shift - x) / one_minus_exp;
      value += term;
      slope += term * x / one_minus_exp;
    }
    const double relative_step =
        (std::log(value) - shift - std::log(radiance_w_m2_sr)) * value / slope;
    temperature_k /= 1.0 + relative_step;
    if (std::abs(relative_step) < 1e-9) return temperature_k;
  }
  return kNone;
}

double quadrature_relative_bound(const Band& band, const BandGrid& grid, double t_min_k,
                                 double t_max_k) {
  IRSIG_CHECK(t_min_k > 0.0);
  IRSIG_CHECK(t_min_k <= t_max_k);
  // The error grows with |d2 ln L / d lambda2|, smoothly in 1/T: 9 points find its maximum to a few
  // per cent of it.
  constexpr int kPoints = 9;
  double bound = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double temperature_k = 1.0 / std::lerp(1.0 / t_min_k, 1.0 / t_max_k, i / (kPoints - 1.0));
    const double found = grid_in_band_w_m2_sr(grid, temperature_k);
    if (found == 0.0) continue;  // underflow: no radiance, no error
    const double exact = exact_in_band_w_m2_sr(band, grid.step_um, temperature_k);
    bound = std::max(bound, std::abs(exact / found - 1.0));
  }
  return bound;
}

double quadrature_relative_bound(const Band& band, const BandGrid& grid, double t_min_k,
                                 double t_max_k, std::span<const std::vector<double>> spectra) {
  IRSIG_CHECK(t_min_k > 0.0);
  IRSIG_CHECK(t_min_k <= t_max_k);
  if (spectra.empty()) return 0.0;
  // A panel's error may vanish at some temperature.
  constexpr std::size_t kPoints = 5;
  struct Sums {
    std::array<double, kPoints> found{}, error{};
  };
  struct Point {
    double weight, along;  // along: from the first node to the second
    std::array<double, kPoints> radiance;
  };
  const auto radiance = [&](double lambda_um) {
    std::array<double, kPoints> out{};
    for (std::size_t t = 0; t < kPoints; ++t)
      out[t] = planck_radiance_w_m2_sr_um(
          lambda_um,
          1.0 / std::lerp(1.0 / t_min_k, 1.0 / t_max_k, static_cast<double>(t) / (kPoints - 1.0)));
    return out;
  };
  std::vector<Sums> sums(spectra.size());
  std::vector<Point> points;
  for (std::size_t i = 0; i < grid.node_um.size(); i += 2) {
    if (!(grid.band_weight[i] > 0.0 || grid.band_weight[i + 1] > 0.0)) continue;
    const double reach = 0.5 * (grid.node_um[i + 1] - grid.node_um[i]);
    const double middle = grid.node_um[i] + reach, half = reach / kGauss2;
    points.clear();
    visit_points(band, middle - half, middle + half, 2.0 * half, [&](double at, double weight) {
      points.push_back({weight, 0.5 * (1.0 + (at - middle) / reach), radiance(at)});
    });
    const std::array nodes = {radiance(grid.node_um[i]), radiance(grid.node_um[i + 1])};
    for (std::size_t s = 0; s < spectra.size(); ++s) {
      const double first = spectra[s][i], second = spectra[s][i + 1];
      for (std::size_t t = 0; t < kPoints; ++t) {
        const double of_grid = grid.band_weight[i] * first * nodes[0][t] +
                               grid.band_weight[i + 1] * second * nodes[1][t];
        double exact = 0.0;
        for (const Point& p : points)
          exact += p.weight * p.radiance[t] * std::lerp(first, second, p.along);
        sums[s].found[t] += of_grid;
        sums[s].error[t] += std::abs(exact - of_grid);
      }
    }
  }
  double bound = 0.0;
  for (const Sums& of : sums)
    for (std::size_t t = 0; t < kPoints; ++t)
      if (of.found[t] > 0.0) bound = std::max(bound, of.error[t] / of.found[t]);
  return bound;
}

}  // namespace irsig
