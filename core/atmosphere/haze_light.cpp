#include "core/atmosphere/haze_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/atmosphere/path_sums.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/table.h"

namespace irsig {
namespace {

// Above the ground. Particles thin out within 3 km.
constexpr std::array<double, kHazeLevels> kHazeHeightsM = {0.0,    100.0,  250.0,  500.0,  750.0,
                                                           1000.0, 1250.0, 1500.0, 2000.0, 2500.0,
                                                           3000.0, 4000.0, 6000.0, 10e3};

// Where haze's fraction is decided: in the clearest window with sunlight.
constexpr double kHazeUm = 3.84;

// A sun at the horizon lights the column at a grazing angle: rounded Earth, flat layers.
constexpr double kLeastSunCosine = 0.02;

struct HazeLevel {
  AirSpectrum depth, scattering, asymmetry;  // of the layer below
};

// Returns the layers between neighbouring heights, from the lowest up.
std::vector<HazeLevel> layers_between(const Atmosphere& atmosphere,
                                      const std::vector<double>& height_m,
                                      const BandChoice& bands) {
  const AirSpectrum dark(kAirBandCount, 0.0);
  std::vector<HazeLevel> out;
  AbsorberAmounts sum;
  AirSpectrum before = dark;
  for (std::size_t l = 1; l < height_m.size(); ++l) {
    const LightPath up =
        look(atmosphere.profile(), height_m[l - 1], 0, height_m[l] - height_m[l - 1], false);
    StepScattering step, layer;
    for (std::size_t i = 0; i < up.step_m.size(); ++i) {
      add_step(sum, &step, atmosphere, up, i, bands);
      merge(layer, step, bands);
    }
    const AirSpectrum t = transmittance(sum, bands);
    HazeLevel level{dark, std::move(layer.aerosol_depth), std::move(layer.asymmetry)};
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (!chosen(bands, b)) continue;
      // A band that underflows is opaque by its grey absorbers alone, too.
      const double whole = t[b] > 0 ? -std::log(t[b]) : before[b] + layer.grey_depth[b];
      level.depth[b] = std::max(layer.grey_depth[b], whole - before[b]);
      before[b] = std::max(before[b], whole);
    }
    out.push_back(std::move(level));
  }
  return out;
}

// Returns the thermal light of the air above a height along each stream.
std::array<AirSpectrum, kHazeCosines.size()> light_above(const Atmosphere& atmosphere,
                                                         double height_m, bool refraction,
                                                         const BandChoice& bands) {
  std::array<AirSpectrum, kHazeCosines.size()> out;
  for (std::size_t j = 0; j < out.size(); ++j) {
    const double zenith_deg = std::acos(kHazeCosines[j]) / kRadPerDeg;
    out[j] = PathLayers(atmosphere,
                        look(atmosphere.profile(), height_m, zenith_deg,
                             std::numeric_limits<double>::infinity(), refraction),
                        bands)
                 .thermal_w_m2_sr_um;
  }
  return out;
}

double smooth_step(double x) { return x * x * (3 - 2 * x); }

double mixed(double low, double high, double fraction) { return low + fraction * (high - low); }

}  // namespace

double haze_fraction(const Atmosphere& atmosphere) {
  if (!atmosphere.turbid_levels_m().empty() || atmosphere.spec().aerosol.kind == AerosolKind::kNone)
    return 0;
  static const std::size_t band = air_band(kHazeUm).value();
  static const BandChoice alone = [] {
    std::vector<unsigned char> wanted(kAirBandCount, 0);
    wanted[band] = 1;
    return BandChoice(wanted);
  }();
  const AirProfile& profile = atmosphere.profile();
  const double depth = atmosphere
                           .amounts(look(profile, profile.level.front().height_m, 0,
                                         std::numeric_limits<double>::infinity(), false),
                                    alone)
                           .grey(GreyAbsorber::kAerosolScattering)[band];
  return smooth_step(
      std::clamp((depth - kHazeFromDepth) / (kHazeFullDepth - kHazeFromDepth), 0.0, 1.0));
}

HazeLight::HazeLight(const Atmosphere& atmosphere, const GroundBelow& ground, double fraction,
                     bool refraction, const BandChoice& bands)
    : bands_(bands), fraction_(fraction), albedo_below_(ground.reflectance) {
  const AirProfile& profile = atmosphere.profile();
  const double ground_m = profile.level.front().height_m, top_m = profile.level.back().height_m;
  for (const double above_m : kHazeHeightsM)
    if (ground_m + above_m < top_m) height_m_.push_back(ground_m + above_m);
  IRSIG_CHECK(height_m_.size() >= 2);
  const std::vector<HazeLevel> level = layers_between(atmosphere, height_m_, bands);
  std::vector<AirSpectrum> planck;
  for (const double height_m : height_m_) {
    planck.emplace_back(kAirBandCount, 0.0);
    planck_spectrum(planck.back(), air_at(profile, height_m).temperature_k, bands);
  }
  const auto above = light_above(atmosphere, height_m_.back(), refraction, bands);

  const std::size_t levels = height_m_.size();
  column_.resize(kAirBandCount);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    rank_.push_back(columns_);
    if (chosen(bands_, b)) ++columns_;
  }
  thermal_.resize(levels * columns_);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    for (std::size_t l = levels - 1; l-- > 0;) {
      const double depth = level[l].depth[b];
      column_[b].push_back({depth, depth > 0 ? std::min(1.0, level[l].scattering[b] / depth) : 0,
                            level[l].asymmetry[b], planck[l + 1][b], planck[l][b]});
    }
    HazeBoundaries boundaries;
    for (std::size_t j = 0; j < above.size(); ++j) boundaries.down_radiance[j] = above[j][b];
    boundaries.up_radiance = (1 - ground.reflectance[b]) * ground.planck[b];
    boundaries.surface_albedo = ground.reflectance[b];
    const std::vector<HazeSource> source = haze_sources(column_[b], boundaries);
    for (std::size_t l = 0; l < levels; ++l)
      std::copy_n(source[levels - 1 - l].harmonic.begin(), kHazeMoments,
                  thermal_[place(l, b)].begin());
  }
}

AirSpectrum HazeLight::thermal(double height_m, double cosine) const {
  const TablePosition at =
      locate(height_m_, std::clamp(height_m, height_m_.front(), height_m_.back()));
  const HazeHarmonics harmonic(cosine);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    const auto &low = thermal_[place(at.index, b)], &high = thermal_[place(at.index + 1, b)];
    double sum = 0;
    for (std::size_t l = 0; l < kHazeMoments; ++l)
      sum += mixed(low[l], high[l], at.fraction) * harmonic[l];
    out[b] = std::max(0.0, sum);
  }
  return out;
}

HazeSunlight::HazeSunlight(const HazeLight& haze, const Atmosphere& atmosphere, double zenith_deg)
    : haze_(&haze), sun_cosine_(std::max(kLeastSunCosine, std::cos(zenith_deg * kRadPerDeg))) {
  const std::size_t levels = haze.height_m_.size();
  std::vector<AirSpectrum> beam;  // from the top down
  for (std::size_t l = levels; l-- > 0;) {
    const std::optional<AbsorberAmounts> amounts =
        atmosphere.sun_amounts(haze.height_m_[l], zenith_deg, haze.bands_);
    beam.push_back(amounts ? transmittance(*amounts, haze.bands_)
                           : AirSpectrum(kAirBandCount, 0.0));
  }
  source_.resize(levels * haze.columns_);
  std::vector<double> of_band(levels);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(haze.bands_, b)) continue;
    std::vector<StreamLayer> column = haze.column_[b];
    for (StreamLayer& layer : column) layer.planck_top = layer.planck_bottom = 0;
    for (std::size_t k = 0; k < levels; ++k) of_band[k] = beam[k][b];
    HazeBoundaries boundaries;
    boundaries.surface_albedo = haze.albedo_below_[b];
    boundaries.beam = of_band;
    boundaries.sun_cosine = sun_cosine_;
    const std::vector<HazeSource> source = haze_sources(column, boundaries);
    for (std::size_t l = 0; l < levels; ++l) source_[haze.place(l, b)] = source[levels - 1 - l];
  }
}

HazeSunSource HazeSunlight::at(double height_m, double cosine) const {
  const std::vector<double>& height = haze_->height_m_;
  const TablePosition at = locate(height, std::clamp(height_m, height.front(), height.back()));
  const HazeHarmonics harmonic(cosine);
  HazeSunSource out;
  for (AirSpectrum& mode : out.mode) mode.assign(kAirBandCount, 0.0);
  out.peak = out.peak_asymmetry = out.mode[0];
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(haze_->bands_, b)) continue;
    const HazeSource &low = source_[haze_->place(at.index, b)],
                     &high = source_[haze_->place(at.index + 1, b)];
    for (std::size_t m = 0; m < kHazeModes; ++m) {
      const std::size_t first = HazeHarmonics::first(m);
      double sum = 0;
      for (std::size_t i = first; i < first + kHazeMoments - m; ++i)
        sum += mixed(low.harmonic[i], high.harmonic[i], at.fraction) * harmonic[i];
      out.mode[m][b] = m == 0 ? sum : 2 * sum;
    }
    out.peak[b] = mixed(low.peak, high.peak, at.fraction);
    if (out.peak[b] > 0)
      out.peak_asymmetry[b] =
          mixed(low.peak * low.peak_asymmetry, high.peak * high.peak_asymmetry, at.fraction) /
          out.peak[b];
  }
  return out;
}

}  // namespace irsig
