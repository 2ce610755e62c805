#include "core/signature/sea_clutter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/environment/sea/sea_surface.h"
#include "core/signature/background_window.h"
#include "core/signature/sea_expansion.h"
#include "core/signature/view/prepared_view.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

using NodeSpectrum = std::vector<double>;
using Numbers = SlopeExpansion::Numbers;

// Numerical error of standard deviations and lengths, relative.
constexpr double kRelativeError = 0.03;

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

// Skewness of means that vary by `sigma`: that of single facets divided by the root of how many of
// them a mean has, as if they were independent. An estimate of its size.
double skewness(const SlopeExpansion& light, const WantedNumbers& wanted, std::size_t band,
                double sigma) {
  double variance = 0, third = 0;
  for (const SlopeExpansion::Facet& f : light.facets()) {
    const double excess = wanted.in_band(f.excess, band);
    variance += f.frequency * excess * excess;
    third += f.frequency * excess * excess * excess;
  }
  if (light.glint()) {
    const SlopeExpansion::Glint& g = *light.glint();
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
  // dark: the target needs no such light, or not this sky's.
  std::vector<std::uint32_t> wanted, dark;
  for (const std::uint32_t c : request.selected_condition) {
    const SurfaceBoundary& surface = request.environment->surface(c);
    if (surface.kind != SurfaceBoundary::Kind::kRoughSea || !(surface.wind_speed_m_s > 0) ||
        request.condition[c].above_surface_m > 0)
      continue;
    wanted.push_back(c);
    const bool sun = sun_shines(request.condition[c]);
    if (!effects.surroundings() || (sun && !effects.follows_sun(c)) || !effects.has_cloud(c))
      dark.push_back(c);
  }
  std::optional<ViewEnvironments> everything;
  if (!dark.empty()) {
    ASSIGN_OR_RETURN(everything, view_environments(request, scene.target, request.viewpoint.range_m,
                                                   dark, scene.axis.node_um()));
  }

  const double seen_m2 = view.totals.front_area_m2, whole_m2 = seen_m2 + view.totals.hidden_area_m2,
               visible = whole_m2 > 0 ? seen_m2 / whole_m2 : 0;
  const double window_m = kClutterDiameters * 2 * scene.target.radius_m;
  const ClutterField window{kClutterPixels, kClutterPixels, window_m / kClutterPixels, 0, {}};
  const double patch_m = patch_px(window, seen_m2) * window.pixel_m;

  const std::vector<std::uint32_t>& bands = request.selected_band;
  const WantedNumbers numbers(scene.axis, bands);
  std::map<double, std::vector<SlopeAverages>> seas;  // by wind: pixel, patch, window
  for (std::size_t w = 0; w < request.selected_condition.size(); ++w) {
    const std::uint32_t c = request.selected_condition[w];
    if (std::find(wanted.begin(), wanted.end(), c) == wanted.end()) continue;
    const bool own = std::find(dark.begin(), dark.end(), c) == dark.end();
    const SurfaceBoundary& surface = request.environment->surface(c);
    const double wind = surface.wind_speed_m_s;
    const SeaSight sight(to_sensor, wind);
    SeaLight light(own ? prepared.environments : *everything, c, request.condition[c],
                   surface.temperature_k, scene.axis.node_um());
    std::optional<SlopeExpansion::Glint> glint;
    if (const auto of_sun = light.glint(sight))
      glint = {numbers.of(of_sun->mean), of_sun->x, of_sun->y, of_sun->disk_variance};
    const SlopeExpansion expansion(
        sight, [&](Vec<Body> normal) { return numbers.of(light.of_facet(normal, to_sensor)); },
        std::move(glint));
    const auto [at, fresh] = seas.try_emplace(wind);
    if (fresh) {
      const SlopeCorrelation correlation(wind);
      for (const double side_m : {window.pixel_m, patch_m, window_m})
        at->second.push_back(sight.averages(correlation, side_m));
    }
    const std::vector<SlopeAverages>& sea = at->second;
    const std::vector<double> of_pixel = expansion.variances(sea[0]),
                              of_patch = expansion.variances(sea[1]),
                              of_window = expansion.variances(sea[2]);
    const std::vector<Numbers> source = expansion.sources();

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
      statistics.mean = {numbers.in_band(expansion.mean(), b) + row.path_radiance_w_m2_sr, large};
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
