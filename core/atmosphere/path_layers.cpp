#include "core/atmosphere/path_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/atmosphere/cloud_light.h"
#include "core/atmosphere/forward_scattering.h"
#include "core/atmosphere/haze_light.h"
#include "core/atmosphere/path_sums.h"
#include "core/base/check.h"
#include "core/base/constants.h"

namespace irsig {
namespace {

// Above the lowest height; the amounts of water and aerosol fall by a factor e within 2 km.
constexpr std::array kSunHeightsM = {0.0, 400.0, 1000.0, 2000.0, 3500.0, 6000.0, 10e3, 16e3, 30e3};

// Ends of layers by the share of the path's air in front of them. Near layers shine in bands that
// the air closes, far ones in the windows.
constexpr std::array kLayerEnds = {2e-4, 1e-3, 4e-3, 0.015, 0.05, 0.12,
                                   0.25, 0.42, 0.62, 0.82,  0.95};

// The nodes of a path at which its layers end.
std::vector<std::size_t> layer_ends(const Atmosphere& atmosphere, const LightPath& path) {
  const AirProfile& profile = atmosphere.profile();
  const std::size_t steps = path.step_m.size();
  std::vector<double> air(steps + 1, 0.0);
  for (std::size_t i = 0; i < steps; ++i) {
    const AirLevel a = air_at(profile, path.node[i].height_m);
    const AirLevel b = air_at(profile, path.node[i + 1].height_m);
    air[i + 1] = air[i] + path.step_m[i] * 0.5 *
                              (a.pressure_pa / a.temperature_k + b.pressure_pa / b.temperature_k);
  }
  std::vector<std::size_t> end;
  for (const double share : kLayerEnds) {
    const auto at = static_cast<std::size_t>(
        std::lower_bound(air.begin(), air.end(), share * air.back()) - air.begin());
    if (at > 0 && at < steps && (end.empty() || at > end.back())) end.push_back(at);
  }
  // Each step in cloud or fog is a layer: its light changes within a few of its depths.
  if (const std::vector<double>& level = atmosphere.turbid_levels_m(); !level.empty()) {
    constexpr double kMarginM = 1e-3;
    for (std::size_t i = 1; i < steps; ++i) {
      const double height_m = path.node[i].height_m;
      if (height_m > level.front() - kMarginM && height_m < level.back() + kMarginM)
        end.push_back(i);
    }
    std::sort(end.begin(), end.end());
    end.erase(std::unique(end.begin(), end.end()), end.end());
  }
  if (steps > 0) end.push_back(steps);
  return end;
}

double ratio_of(double whole, double near, double none) {
  return none > 0 ? whole * near / none : 0;
}

// Calls each(spectrum) for those of a layer, in the order in which they are packed.
template <typename Layer, typename Each>
void for_spectra(Layer& layer, const Each& each) {
  each(layer.scattering.aerosol_depth);
  each(layer.scattering.molecular_depth);
  each(layer.scattering.asymmetry);
  each(layer.scattering.grey_depth);
  each(layer.emission.thermal_w_m2_sr_um);
  each(layer.emission.surroundings_fraction);
  if (!layer.haze.empty()) each(layer.haze);
  if (layer.scattering.cloud_depth.empty()) return;
  each(layer.scattering.cloud_depth);
  each(layer.scattering.cloud_asymmetry);
}

// Beyond, no band lets pass so much as to matter.
constexpr double kOpaque = 1e-8;

// Where in a stretch, as a fraction of its depth from the near end, light comes from on average: of
// light that decays exponentially from a to b.
double centroid(double a, double b) {
  if (!(b > 0)) return 0;
  const double depth = std::log(a / b);
  if (!(depth > 1e-3)) return 0.5 - depth / 12;
  return 1 / depth - 1 / std::expm1(depth);
}

bool opaque(const AirSpectrum& transmittance) {
  return std::all_of(transmittance.begin(), transmittance.end(),
                     [](double t) { return t < kOpaque; });
}

}  // namespace

SunAmounts::SunAmounts(const Atmosphere& atmosphere, double height_m, double zenith_deg,
                       const BandChoice& bands)
    : bands_(bands) {
  const double top_m = atmosphere.profile().level.back().height_m;
  std::vector<double> at;
  for (const double above_m : kSunHeightsM) at.push_back(height_m + above_m);
  const std::vector<double>& turbid = atmosphere.turbid_levels_m();
  at.insert(at.end(), turbid.begin(), turbid.end());
  std::sort(at.begin(), at.end());
  if (!turbid.empty()) {
    turbid_base_m_ = turbid.front();
    turbid_top_m_ = turbid.back();
  }
  for (const double at_m : at) {
    if (at_m >= top_m && at_m > height_m) break;
    std::optional<AbsorberAmounts> amounts = atmosphere.sun_amounts(at_m, zenith_deg, bands_);
    const bool lit = amounts.has_value();
    if (at_m == height_m) lit_ = lit;
    if (lit && !point_.empty() && !point_.back().lit)
      point_.push_back(edge_of_shadow(atmosphere, point_.back().height_m, at_m, zenith_deg));
    point_.push_back({at_m, lit, lit ? *std::move(amounts) : AbsorberAmounts()});
  }
}

SunAmounts::Point SunAmounts::edge_of_shadow(const Atmosphere& atmosphere, double dark_m,
                                             double lit_m, double zenith_deg) const {
  constexpr double kEdgeM = 1;
  while (lit_m - dark_m > kEdgeM) {
    const double middle_m = 0.5 * (dark_m + lit_m);
    const bool lit =
        look(atmosphere.profile(), middle_m, zenith_deg, std::numeric_limits<double>::infinity())
            .end != PathEnd::kSurface;
    (lit ? lit_m : dark_m) = middle_m;
  }
  std::optional<AbsorberAmounts> amounts = atmosphere.sun_amounts(lit_m, zenith_deg, bands_);
  IRSIG_CHECK(amounts.has_value());
  return {lit_m, true, *std::move(amounts)};
}

bool SunAmounts::add_to(AbsorberAmounts& sum, double height_m) const {
  std::size_t above = 1;
  while (above + 1 < point_.size() && point_[above].height_m < height_m) ++above;
  const Point& a = point_[std::min(above, point_.size()) - 1];
  const Point& b = point_[std::min(above, point_.size() - 1)];
  // The lowest point that is lit is the edge of the Earth's shadow.
  if (!b.lit || (!a.lit && height_m < b.height_m)) return false;
  if (!a.lit || b.height_m <= a.height_m) {
    set_sum(sum, sum, b.amounts, bands_);
    return true;
  }
  // The step assumes that all thins out over 3 km: water does over 2, dry air over 8, and over the
  // short way between the heights the difference does not matter.
  constexpr double kScaleM = 3000;
  const bool turbid = a.height_m >= turbid_base_m_ && b.height_m <= turbid_top_m_;
  const double f = turbid
                       ? std::clamp((height_m - a.height_m) / (b.height_m - a.height_m), 0.0, 1.0)
                       : std::clamp(std::expm1((a.height_m - height_m) / kScaleM) /
                                        std::expm1((a.height_m - b.height_m) / kScaleM),
                                    0.0, 1.05);
  add_between(sum, a.amounts, b.amounts, f, bands_);
  return true;
}

PathLayers::PathLayers(const Atmosphere& atmosphere, const LightPath& path, const BandChoice& bands,
                       const CloudLight* cloud, const HazeLight* haze)
    : bands_(bands),
      cloudy_(!atmosphere.turbid_levels_m().empty()),
      hazy_(haze != nullptr),
      keeps_peak_(atmosphere.only_fog() &&
                  atmosphere.spec().forward_peak == ForwardPeak::kDiffuse) {
  IRSIG_CHECK((!cloudy_ || cloud != nullptr));
  const AirProfile& profile = atmosphere.profile();
  thermal_w_m2_sr_um = surroundings_fraction = AirSpectrum(kAirBandCount, 0.0);
  AbsorberAmounts sum;
  transmittance = irsig::transmittance(sum, bands_);
  const auto add_node = [&](double height_m, double zenith_deg) {
    const double cosine = std::cos(zenith_deg * kRadPerDeg);
    node_.push_back({height_m, cosine, PackedAmounts(sum, bands_), {}});
    pack(node_.back().transmittance, transmittance, bands_);
  };
  if (path.node.empty()) {
    add_node(0, 0);
    return;
  }
  const auto temperature_at = [&](std::size_t node) {
    const double t = air_at(profile, path.node[node].height_m).temperature_k;
    if (path.node[node].height_m < kThermosphereM) warmest_k_ = std::max(warmest_k_, t);
    return t;
  };
  const AirSpectrum dark(kAirBandCount, 0.0);
  const std::vector<std::size_t> ends = layer_ends(atmosphere, path);
  AirSpectrum planck_near = dark, planck_far = dark;
  planck_spectrum(planck_near, temperature_at(0), bands_);
  add_node(path.node[0].height_m, path.node[0].zenith_deg);
  StepScattering step;
  const Layer nothing = empty_layer();
  Layer merged = nothing;
  AirSpectrum source_near = dark, source_far = dark, haze_near, haze_far;
  const auto scattered_by_haze = [&](const LightPath::Node& node) {
    return haze->thermal(node.height_m, -std::cos(node.zenith_deg * kRadPerDeg));
  };
  if (haze) haze_near = scattered_by_haze(path.node[0]);
  peak_ = atmosphere.spec().forward_peak;
  for (std::size_t i = 0, next = 0; i < path.step_m.size(); ++i) {
    add_step(sum, &step, atmosphere, path, i, bands_);
    AirSpectrum t_far = irsig::transmittance(sum, bands_);
    planck_spectrum(planck_far, temperature_at(i + 1), bands_);
    if (cloudy_) {
      source_near = planck_near;
      source_far = planck_far;
      const auto scattered = [&](const LightPath::Node& node) {
        return cloud->thermal(node.height_m)
            .towards(-std::cos(node.zenith_deg * kRadPerDeg), peak_);
      };
      add_cloud_source(source_near, source_far, step, transmittance, t_far, scattered(path.node[i]),
                       scattered(path.node[i + 1]), bands_);
    }
    add_emission(merged.emission.thermal_w_m2_sr_um, step, transmittance, t_far,
                 cloudy_ ? source_near : planck_near, cloudy_ ? source_far : planck_far, bands_);
    add_surroundings(merged.emission.surroundings_fraction, step, transmittance, t_far, bands_);
    if (haze) {
      haze_far = scattered_by_haze(path.node[i + 1]);
      add_haze(merged, *haze, step, transmittance, t_far, haze_near, haze_far);
      std::swap(haze_near, haze_far);
    }
    merge(merged.scattering, step, bands_);
    transmittance = std::move(t_far);
    std::swap(planck_near, planck_far);
    const bool last = cloudy_ && opaque(transmittance);
    if (i + 1 != ends[next] && !last) continue;
    ++next;
    add_node(path.node[i + 1].height_m, path.node[i + 1].zenith_deg);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      thermal_w_m2_sr_um[b] += merged.emission.thermal_w_m2_sr_um[b];
      if (haze) thermal_w_m2_sr_um[b] += merged.haze[b];
      surroundings_fraction[b] += merged.emission.surroundings_fraction[b];
    }
    std::vector<double>& kept = layer_.emplace_back();
    kept.reserve(6 * node_.back().transmittance.size());
    for_spectra(merged, [&](const AirSpectrum& of) { pack(kept, of, bands_); });
    merged = nothing;
    if (last) break;
  }
}

double PathLayers::lowest_m() const {
  double out = std::numeric_limits<double>::infinity();
  for (const Node& node : node_) out = std::min(out, node.height_m);
  return out;
}

std::optional<PathLayers::Crossing> PathLayers::crossing(double base_m, double top_m) const {
  constexpr double kMarginM = 1e-2;
  std::size_t enters = 0;
  while (enters < node_.size() && node_[enters].height_m < base_m - kMarginM) ++enters;
  if (enters >= layer_.size() || node_[enters].height_m >= top_m || node_[enters].cos_zenith <= 0)
    return std::nullopt;
  const AirSpectrum dark(kAirBandCount, 0.0);
  Crossing out{transmittance_to(enters), dark, dark, node_[enters].cos_zenith,
               node_[enters].height_m};
  Layer layer = empty_layer();
  for (std::size_t l = enters; l < layer_.size(); ++l) {
    get(l, layer);
    AirSpectrum& to = node_[l + 1].height_m <= top_m + kMarginM ? out.inside : out.beyond;
    for (std::size_t b = 0; b < kAirBandCount; ++b) to[b] += layer.emission.thermal_w_m2_sr_um[b];
  }
  return out;
}

PathLayers::Layer PathLayers::empty_layer() const {
  const AirSpectrum dark(kAirBandCount, 0.0);
  Layer out{StepScattering(), {dark, dark}, {}};
  if (hazy_) out.haze = dark;
  if (cloudy_) out.scattering.cloud_depth = out.scattering.cloud_asymmetry = dark;
  return out;
}

AirSpectrum PathLayers::transmittance_to(std::size_t node) const {
  AirSpectrum out(kAirBandCount, 0.0);
  unpack(out, node_[node].transmittance.data(), bands_);
  return out;
}

void PathLayers::get(std::size_t layer, Layer& out) const {
  const double* next = layer_[layer].data();
  for_spectra(out, [&](AirSpectrum& of) { next = unpack(of, next, bands_); });
}

PathLayers::Behind PathLayers::behind(const AbsorberAmounts& near,
                                      const AirSpectrum& through_near) const {
  const AirSpectrum dark(kAirBandCount, 0.0);
  Behind out{{dark, dark}, through_near};
  AirSpectrum &seen_near = out.transmittance, mean = dark, seen = dark;
  AbsorberAmounts sum;
  Layer layer = empty_layer();
  const auto& [scatters, emits, haze] = layer;
  AirSpectrum t_near = transmittance_to(0);
  for (std::size_t l = 0; l < layer_.size(); ++l) {
    AirSpectrum t_far = transmittance_to(l + 1);
    get(l, layer);
    set_sum(sum, node_[l + 1].amounts, near, bands_);
    AirSpectrum seen_far = irsig::transmittance(sum, bands_);
    mean_of_decay(mean, t_near, t_far, scatters.grey_depth, bands_);
    mean_of_decay(seen, seen_near, seen_far, scatters.grey_depth, bands_);
    for (const BandChoice::Range& r : bands_.ranges()) {
      for (std::size_t b = r.first; b < r.last; ++b) {
        // The layer emits what it absorbs: where near air has taken the lines out, most of the rest
        // is scattered.
        const double scattering = scatters.aerosol_depth[b] + scatters.molecular_depth[b];
        const double absorbed = t_near[b] - t_far[b] - scattering * mean[b];
        const double absorbed_seen = seen_near[b] - seen_far[b] - scattering * seen[b];
        out.thermal_w_m2_sr_um[b] +=
            ratio_of(emits.thermal_w_m2_sr_um[b], std::max(0.0, absorbed_seen), absorbed);
        out.surroundings_fraction[b] += ratio_of(emits.surroundings_fraction[b], seen[b], mean[b]);
        if (hazy_) out.thermal_w_m2_sr_um[b] += ratio_of(haze[b], seen[b], mean[b]);
      }
    }
    seen_near = std::move(seen_far);
    t_near = std::move(t_far);
  }
  return out;
}

ScatteredSun PathLayers::scattered(const SunAmounts& sun, const AbsorberAmounts* near,
                                   const CloudSunlight* cloud, const HazeSunlight* haze) const {
  const AbsorberAmounts none;
  AbsorberAmounts amounts;
  AirSpectrum both_ways;  // scattering depth of the sun's way and the observer's, of fog alone
  const auto at_node = [&](const Node& node) {
    set_sum(amounts, node.amounts, near ? *near : none, bands_);
    const bool lit = sun.add_to(amounts, node.height_m);
    if (keeps_peak_) both_ways = amounts.grey(GreyAbsorber::kAerosolScattering);
    return lit ? irsig::transmittance(amounts, bands_) : AirSpectrum(kAirBandCount, 0.0);
  };
  ScatteredSun out;
  Layer layer = empty_layer();
  if (cloudy_) {
    out.cloud = out.cloud_asymmetry = out.diffuse_per_sr = out.peak =
        AirSpectrum(kAirBandCount, 0.0);
  }
  if (haze) {
    out.haze = out.haze_asymmetry = out.haze_mean_per_sr = AirSpectrum(kAirBandCount, 0.0);
    out.haze_per_sr.fill(out.haze);
  }
  AirSpectrum t_near = at_node(node_.front()), light(kAirBandCount);
  // Transmittances of the observer's own air.
  const auto seen_at = [&](const Node& node) {
    set_sum(amounts, node.amounts, near ? *near : none, bands_);
    return irsig::transmittance(amounts, bands_);
  };
  AirSpectrum seen_near, seen_far, seen(cloud ? kAirBandCount : 0);
  if (cloud || haze) seen_near = seen_at(node_.front());
  HazeSunSource haze_near;
  if (haze) haze_near = haze->at(node_.front().height_m, -node_.front().cos_zenith);
  for (std::size_t l = 0; l < layer_.size(); ++l) {
    const AirSpectrum near_ways = both_ways;
    AirSpectrum t_far = at_node(node_[l + 1]);
    get(l, layer);
    const StepScattering& step = layer.scattering;
    mean_of_sunlight(light, t_near, t_far, step.grey_depth, bands_);
    for (const BandChoice::Range& r : bands_.ranges()) {
      for (std::size_t b = r.first; b < r.last; ++b) {
        out.molecular[b] += light[b] * step.molecular_depth[b];
        const double aerosol = light[b] * step.aerosol_depth[b];
        if (aerosol <= 0) continue;
        out.aerosol[b] += aerosol;
        out.asymmetry[b] += (step.asymmetry[b] - out.asymmetry[b]) * aerosol / out.aerosol[b];
      }
      for (std::size_t b = r.first; cloudy_ && b < r.last; ++b) {
        const double depth = step.cloud_depth[b], asymmetry = step.cloud_asymmetry[b];
        if (depth <= 0) continue;
        TurnedOnce turned{1, asymmetry};
        if (keeps_peak_) {
          turned =
              turned_once(asymmetry, 0.5 * (near_ways[b] + both_ways[b]) * peak_ratio(asymmetry),
                          kPeakAsymmetry);
        }
        add_scattering(out.cloud[b], out.cloud_asymmetry[b], light[b] * depth * turned.fraction,
                       turned.asymmetry);
      }
    }
    if (cloud) {
      seen_far = seen_at(node_[l + 1]);
      mean_of_decay(seen, seen_near, seen_far, step.grey_depth, bands_);
      const AirSpectrum mean =
          cloud->scattered(0.5 * (node_[l].height_m + node_[l + 1].height_m))
              .towards(-0.5 * (node_[l].cos_zenith + node_[l + 1].cos_zenith), peak_);
      for (std::size_t b = 0; b < kAirBandCount; ++b)
        out.diffuse_per_sr[b] += seen[b] * step.cloud_depth[b] * mean[b];
      seen_near = std::move(seen_far);
    }
    if (haze) {
      seen_far = seen_at(node_[l + 1]);
      HazeSunSource haze_far = haze->at(node_[l + 1].height_m, -node_[l + 1].cos_zenith);
      add_haze(out, *haze, step, seen_near, seen_far, haze_near, haze_far);
      haze_near = std::move(haze_far);
      seen_near = std::move(seen_far);
    }
    t_near = std::move(t_far);
  }
  return out;
}

void PathLayers::add_haze(Layer& layer, const HazeLight& haze, const StepScattering& step,
                          const AirSpectrum& t_near, const AirSpectrum& t_far,
                          const AirSpectrum& source_near, const AirSpectrum& source_far) const {
  AirSpectrum mean(kAirBandCount);
  mean_of_decay(mean, t_near, t_far, step.grey_depth, bands_);
  for (const BandChoice::Range& r : bands_.ranges()) {
    for (std::size_t b = r.first; b < r.last; ++b) {
      const double scattered = haze.fraction() * step.aerosol_depth[b] * mean[b];
      if (scattered <= 0) continue;
      layer.haze[b] +=
          scattered * std::lerp(source_near[b], source_far[b], centroid(t_near[b], t_far[b]));
      double& around = layer.emission.surroundings_fraction[b];
      around = std::max(0.0, around - scattered);
    }
  }
}

namespace {

// Returns the powers of the scattering angle's cosine x that a sum over azimuths has,
//   x = product + sines x cos(azimuth),
// with the product of both zenith angles' cosines and that of their sines.
std::array<double, 4> powers_of(const std::array<double, kHazeModes>& mode, double product,
                                double sines) {
  constexpr double kLeastSines = 1e-3;
  if (sines < kLeastSines) return {mode[0], 0, 0, 0};
  // Chebyshev's polynomials give the powers of the azimuth's cosine.
  const std::array<double, 4> of = {mode[0] - mode[2], (mode[1] - 3 * mode[3]) / sines,
                                    2 * mode[2] / (sines * sines),
                                    4 * mode[3] / (sines * sines * sines)};
  const double p = -product;
  return {of[0] + p * (of[1] + p * (of[2] + p * of[3])), of[1] + p * (2 * of[2] + 3 * p * of[3]),
          of[2] + 3 * p * of[3], of[3]};
}

}  // namespace

void PathLayers::add_haze(ScatteredSun& out, const HazeSunlight& haze, const StepScattering& step,
                          const AirSpectrum& seen_near, const AirSpectrum& seen_far,
                          const HazeSunSource& near, const HazeSunSource& far) const {
  AirSpectrum seen(kAirBandCount);
  mean_of_decay(seen, seen_near, seen_far, step.grey_depth, bands_);
  const double eye = node_.front().cos_zenith, product = eye * haze.sun_cosine();
  const double sines = std::sqrt(std::max(0.0, 1 - eye * eye) *
                                 std::max(0.0, 1 - haze.sun_cosine() * haze.sun_cosine()));
  for (const BandChoice::Range& r : bands_.ranges()) {
    for (std::size_t b = r.first; b < r.last; ++b) {
      const double scattered = haze.fraction() * step.aerosol_depth[b] * seen[b];
      if (scattered <= 0) continue;
      const double f = centroid(seen_near[b], seen_far[b]);
      std::array<double, kHazeModes> mode{};
      for (std::size_t m = 0; m < kHazeModes; ++m)
        mode[m] = scattered * std::lerp(near.mode[m][b], far.mode[m][b], f);
      const std::array<double, 4> power = powers_of(mode, product, sines);
      for (std::size_t k = 0; k < power.size(); ++k) out.haze_per_sr[k][b] += power[k];
      out.haze_mean_per_sr[b] += mode[0];
      for (const auto& [source, weight] : {std::pair(&near, 1 - f), std::pair(&far, f)})
        add_scattering(out.haze[b], out.haze_asymmetry[b], weight * scattered * source->peak[b],
                       source->peak_asymmetry[b]);
    }
  }
}

AirSpectrum ScatteredSun::per_sr(const PhaseMean& phase) const {
  AirSpectrum out(kAirBandCount, 0.0);
  const double rayleigh = phase.molecular_per_sr();
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out[b] = molecular[b] * rayleigh;
    if (aerosol[b] > 0) out[b] += aerosol[b] * phase.aerosol_per_sr(asymmetry[b]);
    if (!haze.empty()) {
      double again = haze[b] * phase.aerosol_per_sr(haze_asymmetry[b]);
      for (std::size_t k = 0; k < haze_per_sr.size(); ++k)
        again += haze_per_sr[k][b] * phase.cosine_power(k);
      out[b] += std::max(0.0, again);
    }
    if (cloud.empty()) continue;
    out[b] += cloud[b] * phase.aerosol_per_sr(cloud_asymmetry[b]) + diffuse_per_sr[b] +
              peak[b] * phase.aerosol_per_sr(kPeakAsymmetry);
  }
  return out;
}

double ScatteredSun::per_sr(std::size_t band, double cosine) const {
  double out = aerosol[band] * henyey_greenstein_per_sr(asymmetry[band], cosine) +
               molecular[band] * rayleigh_per_sr(cosine);
  if (!cloud.empty()) {
    out += cloud[band] * henyey_greenstein_per_sr(cloud_asymmetry[band], cosine) +
           diffuse_per_sr[band] + peak[band] * henyey_greenstein_per_sr(kPeakAsymmetry, cosine);
  }
  if (!haze.empty()) {
    const double again = haze_per_sr[0][band] +
                         cosine * (haze_per_sr[1][band] +
                                   cosine * (haze_per_sr[2][band] + cosine * haze_per_sr[3][band]));
    out +=
        std::max(0.0, again + haze[band] * henyey_greenstein_per_sr(haze_asymmetry[band], cosine));
  }
  return out;
}

void PhaseMean::add(double weight, double cosine) {
  static const std::array<double, kPoints> asymmetry = [] {
    std::array<double, kPoints> g{};
    for (std::size_t i = 0; i < kPoints; ++i) g[i] = -std::expm1(-kStep * static_cast<double>(i));
    return g;
  }();
  for (std::size_t i = 0; i < kPoints; ++i) {
    aerosol_[i] += weight * henyey_greenstein_per_sr(asymmetry[i], cosine);
  }
  molecular_ += weight * rayleigh_per_sr(cosine);
  weight_ += weight;
  double power = weight;
  for (double& sum : cosine_power_) {
    sum += power;
    power *= cosine;
  }
}

double PhaseMean::aerosol_per_sr(double asymmetry) const {
  const double at = -std::log1p(-std::clamp(asymmetry, 0.0, 0.97)) / kStep;
  const auto i = std::min(static_cast<std::size_t>(at), kPoints - 2);
  const double f = at - static_cast<double>(i);
  return (aerosol_[i] + f * (aerosol_[i + 1] - aerosol_[i])) / weight_;
}

}  // namespace irsig
