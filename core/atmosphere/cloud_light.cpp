#include "core/atmosphere/cloud_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/refine_streams.h"
#include "core/atmosphere/two_stream.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/table.h"

namespace irsig {
namespace {

// A ray for diffuse light: its cosine is 0.6, the inverse of the diffusivity factor 1.66.
constexpr double kDiffuseZenithDeg = 53.13010235415598;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double square(double x) { return x * x; }

ScatteredRadiance between(const std::vector<double>& height_m,
                          const std::vector<const ScatteredRadiance*>& of, double at_m) {
  const TablePosition at = locate(height_m, std::clamp(at_m, height_m.front(), height_m.back()));
  const ScatteredRadiance &low = *of[at.index], &high = *of[at.index + 1];
  ScatteredRadiance out = low;
  for (AirSpectrum ScatteredRadiance::*part :
       {&ScatteredRadiance::mean, &ScatteredRadiance::slope, &ScatteredRadiance::asymmetry,
        &ScatteredRadiance::second}) {
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      (out.*part)[b] = std::lerp((low.*part)[b], (high.*part)[b], at.fraction);
  }
  return out;
}

// Two streams' light at a level, from the lowest up, scattered there.
void set_scattered(ScatteredRadiance& out, const AirSpectrum& asymmetry, std::size_t band,
                   const StreamLight& light) {
  out.mean[band] = light.mean;
  out.slope[band] = asymmetry[band] * light.slope;
  out.asymmetry[band] = asymmetry[band];
  out.second[band] = light.second;
}

// Returns the light in a column: fog's levels lie close enough to refine it, a cloud's do not.
std::vector<StreamLight> light_in(const std::vector<StreamLayer>& layers,
                                  const StreamBoundaries& boundaries, bool refined) {
  std::vector<StreamLight> light = diffuse_light(layers, boundaries);
  return refined ? refined_light(std::move(light), layers, boundaries) : light;
}

ScatteredRadiance no_light() {
  const AirSpectrum dark(kAirBandCount, 0.0);
  return {dark, dark, dark, dark};
}

// The layers of one band from the top down.
std::vector<StreamLayer> column(const CloudLight& cloud, const std::vector<AirSpectrum>& planck,
                                std::size_t band) {
  const std::vector<CloudLight::Level>& level = cloud.level();
  std::vector<StreamLayer> out;
  for (std::size_t l = level.size() - 1; l-- > 0;) {
    const double depth = level[l + 1].depth[band] - level[l].depth[band];
    const double scattering = level[l + 1].scattering[band] - level[l].scattering[band];
    out.push_back({depth, depth > 0 ? std::min(1.0, scattering / depth) : 0,
                   level[l + 1].asymmetry[band], planck.empty() ? 0 : planck[l + 1][band],
                   planck.empty() ? 0 : planck[l][band]});
  }
  return out;
}

}  // namespace

void CloudLight::set_levels(const Atmosphere& atmosphere) {
  const std::vector<double>& height_m = atmosphere.turbid_levels_m();
  IRSIG_CHECK(height_m.size() >= 2);
  const AirSpectrum dark(kAirBandCount, 0.0);
  AbsorberAmounts sum;
  AirSpectrum grey = dark;
  level_.push_back({height_m.front(), dark, dark, dark, no_light()});
  for (std::size_t l = 1; l < height_m.size(); ++l) {
    const double low_m = height_m[l - 1];
    const LightPath up = look(atmosphere.profile(), low_m, 0, height_m[l] - low_m, false);
    StepScattering step, layer;
    layer.cloud_depth = layer.cloud_asymmetry = dark;
    for (std::size_t i = 0; i < up.step_m.size(); ++i) {
      add_step(sum, &step, atmosphere, up, i, bands_);
      merge(layer, step, bands_);
    }
    const AirSpectrum t = transmittance(sum, bands_);
    Level level{height_m[l], dark, dark, layer.cloud_asymmetry, no_light()};
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      if (!chosen(bands_, b)) continue;
      grey[b] += layer.grey_depth[b];
      // A band that underflows is opaque by its grey absorbers alone, too.
      const double depth = t[b] > 0 ? -std::log(t[b]) : 0;
      level.depth[b] = std::max({grey[b], depth, level_.back().depth[b]});
      level.scattering[b] = level_.back().scattering[b] + layer.cloud_depth[b];
    }
    level_.push_back(std::move(level));
  }
  level_.front().asymmetry = level_[1].asymmetry;
}

AirSpectrum ScatteredRadiance::towards(double cosine, ForwardPeak peak) const {
  AirSpectrum out = mean;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    // g' = g / (1 + g): the whole phase function has the moments of g.
    const double whole = peak == ForwardPeak::kBeam ? 1 / (1 - asymmetry[b]) : 1;
    out[b] += whole * slope[b] * cosine;
    if (peak == ForwardPeak::kBeam)
      out[b] += 2.5 * square(whole * asymmetry[b]) * (3 * cosine * cosine - 1) * second[b];
    out[b] = std::max(0.0, out[b]);
  }
  return out;
}

CloudLight::CloudLight(const Atmosphere& atmosphere, const GroundBelow& ground, bool refraction,
                       const BandChoice& bands)
    : bands_(bands), refined_(atmosphere.only_fog()) {
  IRSIG_CHECK(atmosphere.spec().forward_peak == ForwardPeak::kDiffuse);
  set_levels(atmosphere);
  const AirProfile& profile = atmosphere.profile();
  const double base_m = level_.front().height_m, top_m = level_.back().height_m;
  std::vector<AirSpectrum> planck;
  for (const Level& level : level_) {
    planck.emplace_back(kAirBandCount, 0.0);
    planck_spectrum(planck.back(), air_at(profile, level.height_m).temperature_k, bands);
  }

  // Boundaries: the light of clear air, along a ray that stands for all directions.
  AtmosphereSpec without = atmosphere.spec();
  without.cloud.reset();
  // Above fog all aerosol is the same.
  if (is_fog(without.aerosol.kind)) without.aerosol.kind = AerosolKind::kRural;
  const absl::StatusOr<Atmosphere> clear = Atmosphere::make(std::move(without));
  IRSIG_CHECK(clear.ok());
  const AirSpectrum above =
      PathLayers(*clear, look(profile, top_m, kDiffuseZenithDeg, kInfinity, refraction), bands)
          .thermal_w_m2_sr_um;
  AirSpectrum rising = ground.planck;
  albedo_below_ = ground.reflectance;
  if (base_m > profile.level.front().height_m) {
    const PathLayers down(
        *clear, look(profile, base_m, 180 - kDiffuseZenithDeg, kInfinity, refraction), bands);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      // Light that the air below scatters comes from ground and cloud, about as warm as the ground.
      // The air also sends light down, which the ground reflects.
      const double t = down.transmittance[b];
      const double air =
          down.thermal_w_m2_sr_um[b] + down.surroundings_fraction[b] * ground.planck[b];
      rising[b] =
          air + t * ((1 - ground.reflectance[b]) * ground.planck[b] + ground.reflectance[b] * air);
      albedo_below_[b] *= t * t;
    }
  } else {
    for (std::size_t b = 0; b < kAirBandCount; ++b) rising[b] *= 1 - ground.reflectance[b];
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands, b)) continue;
    const std::vector<StreamLight> light = light_in(
        column(*this, planck, b),
        {.down_radiance = above[b], .up_radiance = rising[b], .surface_albedo = albedo_below_[b]},
        refined_);
    for (std::size_t l = 0; l < level_.size(); ++l)
      set_scattered(level_[l].thermal, level_[l].asymmetry, b, light[level_.size() - 1 - l]);
  }
}

ScatteredRadiance CloudLight::thermal(double height_m) const {
  std::vector<double> at;
  std::vector<const ScatteredRadiance*> of;
  for (const Level& l : level_) {
    at.push_back(l.height_m);
    of.push_back(&l.thermal);
  }
  return between(at, of, height_m);
}

CloudSunlight::CloudSunlight(const CloudLight& cloud, const SunAmounts& sun, double zenith_deg) {
  const std::vector<CloudLight::Level>& level = cloud.level();
  AbsorberAmounts to_top;
  const bool lit = sun.add_to(to_top, level.back().height_m);
  const AirSpectrum beam = transmittance(to_top, cloud.bands());
  // A sun at the horizon lights the top at a grazing angle: rounded Earth, thick streams.
  constexpr double kLeastCosine = 0.02;
  const double cosine = std::max(kLeastCosine, std::cos(zenith_deg * kRadPerDeg));
  for (const CloudLight::Level& l : level) {
    height_m_.push_back(l.height_m);
    scattered_.push_back(no_light());
  }
  for (std::size_t b = 0; lit && b < kAirBandCount; ++b) {
    if (!chosen(cloud.bands(), b)) continue;
    const std::vector<StreamLight> light = light_in(column(cloud, {}, b),
                                                    {.surface_albedo = cloud.albedo_below()[b],
                                                     .sun_irradiance = beam[b],
                                                     .sun_cosine = cosine},
                                                    cloud.refined());
    for (std::size_t l = 0; l < level.size(); ++l)
      set_scattered(scattered_[l], level[l].asymmetry, b, light[level.size() - 1 - l]);
  }
}

ScatteredRadiance CloudSunlight::scattered(double height_m) const {
  std::vector<const ScatteredRadiance*> of;
  for (const ScatteredRadiance& s : scattered_) of.push_back(&s);
  return between(height_m_, of, height_m);
}

}  // namespace irsig
