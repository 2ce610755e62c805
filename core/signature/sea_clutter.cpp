#include "core/signature/sea_clutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "core/base/status_macros.h"
#include "core/environment/sea/sea_surface.h"
#include "core/environment/sea/sea_texture.h"
#include "core/signature/background_window.h"
#include "core/signature/view/prepared_view.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

using NodeSpectrum = std::vector<double>;

// Numerical error of standard deviations and lengths, relative.
constexpr double kRelativeError = 0.03;

// A rough sea seen along one line: x lies towards the sensor, y to the right of it.
struct SeaSight {
  Vec<Body> to_sensor, x, y;
  double sine = 0;                     // of the sensor's elevation
  double wind_m_s = 0, deviation = 0;  // of one slope

  SeaSight(Vec<Body> towards, double wind)
      : to_sensor(towards),
        sine(-towards.z),
        wind_m_s(wind),
        deviation(std::sqrt(0.5 * sea_slope_variance(wind))) {
    const double level = std::hypot(towards.x, towards.y);
    x = level > 0 ? Vec<Body>{towards.x / level, towards.y / level, 0} : Vec<Body>{1, 0, 0};
    y = {-x.y, x.x, 0};
  }
  // Upward normal of a facet, times 1 / its z upwards; slopes in standard deviations.
  [[nodiscard]] Vec<Body> steep_normal(double slope_x, double slope_y) const {
    return Vec<Body>{0, 0, -1} - deviation * slope_x * x - deviation * slope_y * y;
  }
};

// The light of one condition at the sensor.
class SeaLight {
 public:
  SeaLight(const ViewEnvironments& all, std::uint32_t condition, const ConditionSpec& spec,
           double temperature_k, const NodeSpectrum& node_um)
      : nodes_(all.directions),
        light_(all.condition[condition]),
        spec_(spec),
        water_(sea_water_spectrum(node_um)),
        reflectance_(node_um.size()) {
    for (std::size_t i = 0; i < node_um.size(); ++i)
      emitted_.push_back(light_.transmittance[i] *
                         planck_radiance_w_m2_sr_um(node_um[i], temperature_k));
  }

  // Radiance of a facet: what it emits and what it mirrors, without the sun's disk.
  [[nodiscard]] NodeSpectrum of_facet(Vec<Body> normal, Vec<Body> to_sensor) {
    const double cosine = dot(normal, to_sensor);
    water_reflectance(water_, cosine, 0, reflectance_);
    const Vec<Body> mirrored = 2 * cosine * normal - to_sensor;
    std::array<DirectionNodes::Share, 4> share;
    const int shares = nodes_.shares(static_cast<float>(mirrored.x), static_cast<float>(mirrored.y),
                                     static_cast<float>(mirrored.z), share.data());
    NodeSpectrum out(emitted_.size(), 0.0);
    for (int s = 0; s < shares; ++s) {
      const NodeSpectrum& from = apparent(share[static_cast<std::size_t>(s)].node);
      const auto weight = static_cast<double>(share[static_cast<std::size_t>(s)].weight);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += weight * from[i];
    }
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = reflectance_[i] * out[i] + (1 - reflectance_[i]) * emitted_[i];
    return out;
  }

  // The mean of the mirrored sun over the sea; the slopes that mirror it, and their variance by the
  // size of the disk. nullopt: none.
  struct Glint {
    NodeSpectrum mean;
    double x, y, disk_variance;
  };
  [[nodiscard]] std::optional<Glint> glint(const SeaSight& sight) {
    if (!sun_shines(spec_)) return std::nullopt;
    const double per_sr = glint_per_sr(sight.to_sensor, spec_.sun_direction, sight.wind_m_s);
    const Vec<Body> normal = normalized(sight.to_sensor + spec_.sun_direction);
    const double up = -normal.z * sight.deviation;
    if (!(per_sr > 0) || !(up > 0)) return std::nullopt;
    const double radius =
        0.5 * spec_.sun_angular_radius_deg * std::numbers::pi / 180 / sight.deviation;
    Glint out{light_.sun_apparent, -dot(normal, sight.x) / up, -dot(normal, sight.y) / up,
              0.25 * radius * radius};
    // Hardly any facet is so steep.
    constexpr double kSteepest = 6;
    if (std::max(std::abs(out.x), std::abs(out.y)) > kSteepest) return std::nullopt;
    water_reflectance(water_, dot(normal, sight.to_sensor), 0, reflectance_);
    for (std::size_t i = 0; i < out.mean.size(); ++i) out.mean[i] *= per_sr * reflectance_[i];
    return out;
  }

 private:
  const NodeSpectrum& apparent(std::uint32_t node) {
    const auto [at, fresh] = apparent_.try_emplace(node);
    if (fresh) at->second = light_.around.apparent(node);
    return at->second;
  }

  const DirectionNodes& nodes_;
  const ViewEnvironment& light_;
  const ConditionSpec& spec_;
  WaterSpectrum water_;
  NodeSpectrum emitted_, reflectance_;
  std::map<std::uint32_t, NodeSpectrum> apparent_;
};

// Numbers of a spectrum that rows want: of each band its means over bins, then its integral.
class WantedNumbers {
 public:
  WantedNumbers(const SpectralAxis& axis, const std::vector<std::uint32_t>& bands) : axis_(axis) {
    std::size_t first = 0;
    for (const std::uint32_t b : bands) {
      place_.push_back({b, first, axis.band(b).grid.lambda_um.size()});
      first += place_.back().bins + 1;
    }
  }
  using Numbers = std::vector<double>;
  [[nodiscard]] Numbers of(const NodeSpectrum& spectrum) const {
    Numbers out;
    for (const Place& p : place_) {
      const NodeSpectrum bins = on_bins(spectrum, axis_.band(p.band));
      out.insert(out.end(), bins.begin(), bins.end());
      out.push_back(irsig::in_band(spectrum, axis_.band(p.band)));
    }
    return out;
  }
  // k: place in the list of bands
  [[nodiscard]] double in_band(const Numbers& of, std::size_t k) const {
    return of[place_[k].first + place_[k].bins];
  }
  [[nodiscard]] NodeSpectrum bins(const Numbers& of, std::size_t k) const {
    const auto first = of.begin() + static_cast<std::ptrdiff_t>(place_[k].first);
    return {first, first + static_cast<std::ptrdiff_t>(place_[k].bins)};
  }

 private:
  struct Place {
    std::uint32_t band;
    std::size_t first, bins;
  };
  const SpectralAxis& axis_;
  std::vector<Place> place_;
};
using Numbers = WantedNumbers::Numbers;

void add(Numbers& to, double weight, const Numbers& of) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += weight * of[i];
}

// [term] he_a(x) he_b(y)
std::vector<double> term_values(double x, double y) {
  const std::vector<double> of_x = hermite_functions(x), of_y = hermite_functions(y);
  std::vector<double> out;
  for (const SlopeTerm& t : slope_terms())
    out.push_back(of_x[static_cast<std::size_t>(t.a)] * of_y[static_cast<std::size_t>(t.b)]);
  return out;
}

// The mean of the mirrored sun over the sea, and the slopes that mirror it.
struct Glint {
  Numbers mean;
  double x, y, disk_variance;
};

// The radiance of the sea as a sum of terms of its slopes.
struct SlopeExpansion {
  Numbers mean;
  std::vector<Numbers> term;  // slope_terms()
  // Facets without the sun's disk: what each of them adds to the mean, and how often it occurs.
  struct Facet {
    double frequency;
    Numbers excess;
  };
  std::vector<Facet> facet;
  std::optional<Glint> glint;  // with its part in the terms
};

// What a pixel shows is a mean over the facets in it by their projected areas w, so that facets
// count with (L - mean) w / mean w.
SlopeExpansion expansion_of(SeaLight& light, const SeaSight& sight, const WantedNumbers& wanted) {
  SlopeExpansion out;
  std::vector<double> seen;                     // [facet]
  std::vector<std::vector<double>> term_value;  // [facet]
  double area = 0;
  for (const SlopeNode& x : slope_nodes())
    for (const SlopeNode& y : slope_nodes()) {
      const Vec<Body> normal = sight.steep_normal(x.x, y.x);
      const double cosine = dot(normal, sight.to_sensor), weight = x.weight * y.weight;
      if (cosine <= 0) continue;
      out.facet.push_back({weight, wanted.of(light.of_facet(normalized(normal), sight.to_sensor))});
      seen.push_back(cosine);
      term_value.push_back(term_values(x.x, y.x));
      area += weight * cosine;
    }
  out.mean.assign(out.facet.front().excess.size(), 0.0);
  for (std::size_t f = 0; f < seen.size(); ++f)
    add(out.mean, out.facet[f].frequency * seen[f] / area, out.facet[f].excess);
  if (const auto glint = light.glint(sight)) {
    out.glint = {wanted.of(glint->mean), glint->x, glint->y, glint->disk_variance};
    add(out.mean, 1, out.glint->mean);
  }
  out.term.assign(slope_terms().size(), Numbers(out.mean.size(), 0.0));
  for (std::size_t f = 0; f < seen.size(); ++f) {
    Numbers& excess = out.facet[f].excess;
    add(excess, -1, out.mean);
    for (double& e : excess) e *= seen[f] / area;
    for (std::size_t t = 0; t < out.term.size(); ++t)
      add(out.term[t], out.facet[f].frequency * term_value[f][t], excess);
  }
  if (out.glint) {
    const std::vector<double> value = term_values(out.glint->x, out.glint->y);
    for (std::size_t t = 0; t < out.term.size(); ++t) add(out.term[t], value[t], out.glint->mean);
  }
  return out;
}

// What of the terms is left in means over a square of the picture; the last is the glint's that no
// term holds.
std::vector<double> variances(const SlopeAverages& averages, const std::optional<Glint>& glint) {
  std::vector<double> out = averages.term();
  double rest = 0;
  if (glint) {
    rest = averages.of_one_slope(glint->x, glint->y, glint->disk_variance);
    const std::vector<double> value = term_values(glint->x, glint->y);
    for (std::size_t t = 0; t < out.size(); ++t) rest -= out[t] * value[t] * value[t];
  }
  out.push_back(std::max(0.0, rest));
  return out;
}

// Skewness of means that vary by `sigma`: that of single facets divided by the root of how many of
// them a mean has, as if they were independent. An estimate of its size.
double skewness(const SlopeExpansion& light, const WantedNumbers& wanted, std::size_t band,
                double sigma) {
  double variance = 0, third = 0;
  for (const SlopeExpansion::Facet& f : light.facet) {
    const double excess = wanted.in_band(f.excess, band);
    variance += f.frequency * excess * excess;
    third += f.frequency * excess * excess * excess;
  }
  if (light.glint) {
    const Glint& g = *light.glint;
    const double mean = wanted.in_band(g.mean, band);
    const double lit = 2 * g.disk_variance * std::exp(-0.5 * (g.x * g.x + g.y * g.y));
    variance += mean * mean / lit;
    third += mean * mean * mean / (lit * lit);
  }
  return variance > 0 ? third / (variance * variance) * sigma : 0;
}

double sigma(const std::vector<double>& variance, const std::vector<double>& radiance) {
  double sum = 0;
  for (std::size_t t = 0; t < variance.size(); ++t) sum += variance[t] * radiance[t] * radiance[t];
  return std::sqrt(sum);
}

// The squares of the picture over which a sea is averaged: a pixel, the target's area, the window.
struct SeaSquares {
  std::array<SlopeAverages, 3> of;
  SeaSquares(double wind_m_s, const std::array<double, 3>& side_m, double sine)
      : SeaSquares(SlopeCorrelation(wind_m_s), side_m, sine) {}

 private:
  SeaSquares(const SlopeCorrelation& sea, const std::array<double, 3>& side_m, double sine)
      : of{SlopeAverages(sea, side_m[0] / sine, side_m[0]),
           SlopeAverages(sea, side_m[1] / sine, side_m[1]),
           SlopeAverages(sea, side_m[2] / sine, side_m[2])} {}
};

}  // namespace

absl::Status add_sea_clutter(const MeasuredView& view, const ViewRequest& request,
                             ViewResult& result) {
  const PreparedScene& scene = view.setup.scene;
  const Vec<Body> sensor = view.setup.aimed().frame.sensor;
  const Vec<Body> to_sensor = normalized(sensor);
  if (!request.environment || request.land || -to_sensor.z < kLeastSineAboveSea)
    return absl::OkStatus();

  const PreparedView& prepared = *view.setup.view;
  const EffectSet& effects = prepared.effects;
  std::vector<std::uint32_t> wanted, dark;  // dark: the target needs no such light
  for (const std::uint32_t c : request.selected_condition) {
    const SurfaceBoundary& surface = request.environment->surface(c);
    if (surface.kind != SurfaceBoundary::Kind::kRoughSea || !(surface.wind_speed_m_s > 0)) continue;
    wanted.push_back(c);
    const bool sun = sun_shines(request.condition[c]);
    if (!effects.surroundings() || (sun && !effects.follows_sun(c))) dark.push_back(c);
  }
  std::optional<ViewEnvironments> everything;
  if (!dark.empty()) {
    ASSIGN_OR_RETURN(everything, view_environments(request, scene.target, length(sensor), dark,
                                                   scene.axis.node_um()));
  }

  const double seen_m2 = view.totals.front_area_m2, whole_m2 = seen_m2 + view.totals.hidden_area_m2,
               visible = whole_m2 > 0 ? seen_m2 / whole_m2 : 0;
  const double window_m = kClutterDiameters * 2 * scene.target.radius_m;
  const ClutterField window{kClutterPixels, kClutterPixels, window_m / kClutterPixels, 0, {}};
  const double patch_m = patch_px(window, seen_m2) * window.pixel_m;

  const std::vector<std::uint32_t>& bands = request.selected_band;
  const WantedNumbers numbers(scene.axis, bands);
  std::map<double, SeaSquares> seas;  // by wind
  for (std::size_t w = 0; w < request.selected_condition.size(); ++w) {
    const std::uint32_t c = request.selected_condition[w];
    if (std::find(wanted.begin(), wanted.end(), c) == wanted.end()) continue;
    const bool own = std::find(dark.begin(), dark.end(), c) == dark.end();
    const SurfaceBoundary& surface = request.environment->surface(c);
    const double wind = surface.wind_speed_m_s;
    const SeaSight sight(to_sensor, wind);
    SeaLight light(own ? prepared.environments : *everything, c, request.condition[c],
                   surface.temperature_k, scene.axis.node_um());
    const SlopeExpansion expansion = expansion_of(light, sight, numbers);
    const SeaSquares& sea =
        seas.try_emplace(wind, wind, std::array{window.pixel_m, patch_m, window_m}, sight.sine)
            .first->second;
    const std::vector<double> of_pixel = variances(sea.of[0], expansion.glint),
                              of_patch = variances(sea.of[1], expansion.glint),
                              of_window = variances(sea.of[2], expansion.glint);
    std::vector<Numbers> source = expansion.term;
    source.push_back(expansion.glint ? expansion.glint->mean : Numbers(expansion.mean.size(), 0.0));

    SpectralSet factor(source.size(), std::vector<double>(source.size(), 0.0));
    for (std::size_t t = 0; t < source.size(); ++t) factor[t][t] = std::sqrt(of_patch[t]);
    std::vector<SpectralSet> spectra(bands.size());
    for (std::size_t b = 0; b < bands.size(); ++b)
      for (const Numbers& s : source) spectra[b].push_back(numbers.bins(s, b));
    const ClutterModes modes = clutter_modes(factor, spectra);
    for (std::size_t b = 0; b < bands.size(); ++b) {
      std::vector<double> radiance;
      for (const Numbers& s : source) radiance.push_back(numbers.in_band(s, b));
      const double pixel = sigma(of_pixel, radiance), patch = sigma(of_patch, radiance),
                   large = sigma(of_window, radiance);
      ClutterStatistics statistics;
      // A mean over the window varies by 1 / cells of the pixels' variance.
      statistics.cells = large > 0 ? std::max(1.0, pixel * pixel / (large * large)) : 1;
      SignatureResult& row = result.row[w * bands.size() + b];
      statistics.mean = {numbers.in_band(expansion.mean, b) + row.path_radiance_w_m2_sr, large};
      statistics.sigma = {pixel, kRelativeError * pixel};
      statistics.correlation_m.value = window_m / std::sqrt(statistics.cells * std::numbers::pi);
      statistics.correlation_m.stderr_ = kRelativeError * statistics.correlation_m.value;
      statistics.skewness.value = skewness(expansion, numbers, b, pixel);
      statistics.skewness.stderr_ = std::abs(statistics.skewness.value);
      statistics.patch_m = patch_m;
      statistics.patch_sigma = {patch, kRelativeError * patch};
      row.clutter = background_clutter(window, statistics, modes, b, visible, {});
    }
  }
  return absl::OkStatus();
}

}  // namespace irsig
