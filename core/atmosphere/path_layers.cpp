#include "core/atmosphere/path_layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

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
std::vector<std::size_t> layer_ends(const AirProfile& profile, const LightPath& path) {
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
}

}  // namespace

SunAmounts::SunAmounts(const Atmosphere& atmosphere, double height_m, double zenith_deg,
                       const BandChoice& bands)
    : bands_(bands) {
  const double top_m = atmosphere.profile().level.back().height_m;
  for (const double above_m : kSunHeightsM) {
    const double at_m = height_m + above_m;
    if (at_m >= top_m && above_m > 0) break;
    std::optional<AbsorberAmounts> amounts = atmosphere.sun_amounts(at_m, zenith_deg, bands_);
    const bool lit = amounts.has_value();
    point_.push_back({at_m, lit, lit ? *std::move(amounts) : AbsorberAmounts()});
  }
}

bool SunAmounts::add_to(AbsorberAmounts& sum, double height_m) const {
  std::size_t above = 1;
  while (above + 1 < point_.size() && point_[above].height_m < height_m) ++above;
  const Point& a = point_[std::min(above, point_.size()) - 1];
  const Point& b = point_[std::min(above, point_.size() - 1)];
  if (!a.lit && !b.lit) return false;
  if (!a.lit || !b.lit || b.height_m <= a.height_m) {
    set_sum(sum, sum, a.lit ? a.amounts : b.amounts, bands_);
    return true;
  }
  // As if all thinned out over 3 km: water does over 2, dry air over 8, and over the short way
  // between the heights the difference does not matter.
  constexpr double kScaleM = 3000;
  const double f = std::clamp(std::expm1((a.height_m - height_m) / kScaleM) /
                                  std::expm1((a.height_m - b.height_m) / kScaleM),
                              0.0, 1.05);
  add_between(sum, a.amounts, b.amounts, f, bands_);
  return true;
}

PathLayers::PathLayers(const Atmosphere& atmosphere, const LightPath& path, const BandChoice& bands)
    : bands_(bands) {
  const AirProfile& profile = atmosphere.profile();
  const double humidity_percent = relative_humidity_percent(profile.level.front());
  thermal_w_m2_sr_um = surroundings_fraction = AirSpectrum(kAirBandCount, 0.0);
  AbsorberAmounts sum;
  transmittance = irsig::transmittance(sum, bands_);
  const auto add_node = [&](double height_m) {
    node_.push_back({height_m, PackedAmounts(sum, bands_), {}});
    pack(node_.back().transmittance, transmittance, bands_);
  };
  if (path.node.empty()) {
    add_node(0);
    return;
  }
  const auto temperature_at = [&](std::size_t node) {
    const double t = air_at(profile, path.node[node].height_m).temperature_k;
    if (path.node[node].height_m < kThermosphereM) warmest_k_ = std::max(warmest_k_, t);
    return t;
  };
  const AirSpectrum dark(kAirBandCount, 0.0);
  const std::vector<std::size_t> ends = layer_ends(profile, path);
  AirSpectrum planck_near = dark, planck_far = dark;
  planck_spectrum(planck_near, temperature_at(0), bands_);
  add_node(path.node[0].height_m);
  StepScattering step;
  const Layer nothing{StepScattering(), {dark, dark}};
  Layer merged = nothing;
  for (std::size_t i = 0, next = 0; i < path.step_m.size(); ++i) {
    add_step(sum, &step, atmosphere.spec(), humidity_percent, path, i, bands_);
    AirSpectrum t_far = irsig::transmittance(sum, bands_);
    planck_spectrum(planck_far, temperature_at(i + 1), bands_);
    add_emission(merged.emission.thermal_w_m2_sr_um, step, transmittance, t_far, planck_near, planck_far,
                 bands_);
    add_surroundings(merged.emission.surroundings_fraction, step, transmittance, t_far, bands_);
    merge(merged.scattering, step, bands_);
    transmittance = std::move(t_far);
    std::swap(planck_near, planck_far);
    if (i + 1 != ends[next]) continue;
    ++next;
    add_node(path.node[i + 1].height_m);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      thermal_w_m2_sr_um[b] += merged.emission.thermal_w_m2_sr_um[b];
      surroundings_fraction[b] += merged.emission.surroundings_fraction[b];
    }
    std::vector<double>& kept = layer_.emplace_back();
    kept.reserve(6 * node_.back().transmittance.size());
    for_spectra(merged, [&](const AirSpectrum& of) { pack(kept, of, bands_); });
    merged = nothing;
  }
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
  Layer layer{StepScattering(), {dark, dark}};
  const auto& [scatters, emits] = layer;
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
        // What the layer absorbs, and with it emits: where near air has taken the lines out, most
        // of what is left is scattered.
        const double scattering = scatters.aerosol_depth[b] + scatters.molecular_depth[b];
        const double absorbed = t_near[b] - t_far[b] - scattering * mean[b];
        const double absorbed_seen = seen_near[b] - seen_far[b] - scattering * seen[b];
        out.thermal_w_m2_sr_um[b] +=
            ratio_of(emits.thermal_w_m2_sr_um[b], std::max(0.0, absorbed_seen), absorbed);
        out.surroundings_fraction[b] += ratio_of(emits.surroundings_fraction[b], seen[b], mean[b]);
      }
    }
    seen_near = std::move(seen_far);
    t_near = std::move(t_far);
  }
  return out;
}

ScatteredSun PathLayers::scattered(const SunAmounts& sun, const AbsorberAmounts* near) const {
  const AbsorberAmounts none;
  AbsorberAmounts amounts;
  const auto at_node = [&](const Node& node) {
    set_sum(amounts, node.amounts, near ? *near : none, bands_);
    return sun.add_to(amounts, node.height_m) ? irsig::transmittance(amounts, bands_)
                                              : AirSpectrum(kAirBandCount, 0.0);
  };
  ScatteredSun out;
  const AirSpectrum dark(kAirBandCount, 0.0);
  Layer layer{StepScattering(), {dark, dark}};
  AirSpectrum t_near = at_node(node_.front()), light(kAirBandCount);
  for (std::size_t l = 0; l < layer_.size(); ++l) {
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
    }
    t_near = std::move(t_far);
  }
  return out;
}

AirSpectrum ScatteredSun::per_sr(const PhaseMean& phase) const {
  AirSpectrum out(kAirBandCount, 0.0);
  const double rayleigh = phase.molecular_per_sr();
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out[b] = molecular[b] * rayleigh;
    if (aerosol[b] > 0) out[b] += aerosol[b] * phase.aerosol_per_sr(asymmetry[b]);
  }
  return out;
}

double ScatteredSun::per_sr(std::size_t band, double cosine) const {
  return aerosol[band] * henyey_greenstein_per_sr(asymmetry[band], cosine) +
         molecular[band] * rayleigh_per_sr(cosine);
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
}

double PhaseMean::aerosol_per_sr(double asymmetry) const {
  const double at = -std::log1p(-std::clamp(asymmetry, 0.0, 0.97)) / kStep;
  const auto i = std::min(static_cast<std::size_t>(at), kPoints - 2);
  const double f = at - static_cast<double>(i);
  return (aerosol_[i] + f * (aerosol_[i + 1] - aerosol_[i])) / weight_;
}

}  // namespace irsig
