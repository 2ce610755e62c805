#include "core/atmosphere/cloud_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/atmosphere/path_sums.h"
#include "core/atmosphere/two_stream.h"
#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/base/table.h"

namespace irsig {
namespace {

// A ray for diffuse light: its cosine is 0.6, the inverse of the diffusivity factor 1.66.
constexpr double kDiffuseZenithDeg = 53.13010235415598;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

AirSpectrum between(const std::vector<double>& height_m, const std::vector<const AirSpectrum*>& of,
                    double at_m) {
  const TablePosition at = locate(height_m, std::clamp(at_m, height_m.front(), height_m.back()));
  AirSpectrum out(kAirBandCount);
  const AirSpectrum &low = *of[at.index], &high = *of[at.index + 1];
  for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] = std::lerp(low[b], high[b], at.fraction);
  return out;
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
                   cloud.asymmetry()[band], planck.empty() ? 0 : planck[l + 1][band],
                   planck.empty() ? 0 : planck[l][band]});
  }
  return out;
}

}  // namespace

CloudLight::CloudLight(const Atmosphere& atmosphere, const GroundBelow& ground, bool refraction,
                       const BandChoice& bands)
    : bands_(bands), asymmetry_(atmosphere.cloud().asymmetry) {
  const std::vector<double>& height_m = atmosphere.cloud_levels_m();
  IRSIG_CHECK(height_m.size() >= 2);
  const AirProfile& profile = atmosphere.profile();
  const AirSpectrum dark(kAirBandCount, 0.0);

  // From the base up: depth and Planck's function.
  std::vector<AirSpectrum> planck;
  const double base_m = height_m.front(), thick_m = height_m.back() - base_m;
  for (const double at_m : height_m) {
    const double inside = (at_m - base_m) / thick_m;
    Level level{at_m, dark, dark, dark};
    if (at_m > base_m) {
      const AirSpectrum t = transmittance(
          atmosphere.amounts(look(profile, base_m, 0, at_m - base_m, false), bands), bands);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        if (!chosen(bands, b)) continue;
        const double cloud =
            inside * (atmosphere.cloud().scattering[b] + atmosphere.cloud().absorption[b]);
        // What underflows is opaque by the cloud alone, too.
        const double depth = t[b] > 0 ? -std::log(t[b]) : 0;
        level.depth[b] = std::max({cloud, depth, level_.back().depth[b]});
        level.scattering[b] = inside * atmosphere.cloud().scattering[b];
      }
    }
    level_.push_back(std::move(level));
    planck.push_back(dark);
    planck_spectrum(planck.back(), air_at(profile, at_m).temperature_k, bands);
  }

  // Boundaries: the light of clear air, along a ray that stands for all directions.
  AtmosphereSpec without = atmosphere.spec();
  without.cloud.reset();
  const absl::StatusOr<Atmosphere> clear = Atmosphere::make(std::move(without));
  IRSIG_CHECK(clear.ok());
  const AirSpectrum above =
      PathLayers(*clear, look(profile, height_m.back(), kDiffuseZenithDeg, kInfinity, refraction),
                 bands)
          .thermal_w_m2_sr_um;
  AirSpectrum rising = ground.planck;
  albedo_below_ = ground.reflectance;
  if (base_m > profile.level.front().height_m) {
    const PathLayers down(
        *clear, look(profile, base_m, 180 - kDiffuseZenithDeg, kInfinity, refraction), bands);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      // What the air below scatters comes from ground and cloud, about as warm as the ground. The
      // air also sends light down, which the ground reflects.
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
    const std::vector<double> mean = mean_diffuse_radiance(
        column(*this, planck, b),
        {.down_radiance = above[b], .up_radiance = rising[b], .surface_albedo = albedo_below_[b]});
    for (std::size_t l = 0; l < level_.size(); ++l)
      level_[l].thermal[b] = mean[level_.size() - 1 - l];
  }
}

AirSpectrum CloudLight::thermal(double height_m) const {
  std::vector<double> at;
  std::vector<const AirSpectrum*> of;
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
    mean_per_sr_.emplace_back(kAirBandCount, 0.0);
  }
  for (std::size_t b = 0; lit && b < kAirBandCount; ++b) {
    if (!chosen(cloud.bands(), b)) continue;
    const std::vector<double> mean =
        mean_diffuse_radiance(column(cloud, {}, b), {.surface_albedo = cloud.albedo_below()[b],
                                                     .sun_irradiance = beam[b],
                                                     .sun_cosine = cosine});
    for (std::size_t l = 0; l < level.size(); ++l) mean_per_sr_[l][b] = mean[level.size() - 1 - l];
  }
}

AirSpectrum CloudSunlight::mean_per_sr(double height_m) const {
  std::vector<const AirSpectrum*> of;
  for (const AirSpectrum& s : mean_per_sr_) of.push_back(&s);
  return between(height_m_, of, height_m);
}

}  // namespace irsig
