#include "core/environment/view_light.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/environment/fit/interpolation_error.h"

namespace irsig {
namespace {

// Direct sunlight at the ground against LOWTRAN7: within 10 % in the windows, in the mean 5 %.
constexpr double kSunRelativeError = 0.05;

// The ratio behind near air, linear between three rings: its largest error as a share of the change
// from one of these to the next. Found, over weathers, ranges and rings: above the horizon 0.1 to
// 0.2, in fog 0.34; below, where most change is next to the horizon, up to 0.6, in fog 1.1
// (tests/physics/environment_bounds_test.cpp).
constexpr double kSkyJoinedShare = 0.5, kLowerJoinedShare = 2;

}  // namespace

struct ViewLight::Solar {
  const SunLight& sun;
  const SensorPath& leg;
  AirSpectrum near_end;  // transmittance from the sun to the target and on to the sensor
  RingRatios sky;
  std::vector<std::optional<SunLight::LowerRatio>> lower_exact;
  std::array<std::optional<AirSpectrum>, kLimb.size()> limb;
  RingRatios lower_air, lower_surface;

  Solar(const SunLight& light, const SensorPath& near, std::size_t sky_rings,
        std::size_t lower_rings)
      : sun(light),
        leg(near),
        near_end(near.imported ? near.transmittance : light.joined(near.layers.amounts())),
        sky(sky_rings, [this](std::size_t r) { return sun.sky_ratio(r, leg.layers.amounts()); }),
        lower_exact(lower_rings),
        lower_air(lower_rings, [this](std::size_t r) { return lower(r).air; }),
        lower_surface(lower_rings, [this](std::size_t r) { return lower(r).surface; }) {}

  [[nodiscard]] AirSpectrum irradiance() const {
    AirSpectrum out = leg.imported ? sun.irradiance : sun.outside;
    // The irradiance is that of the whole disk.
    const double share = leg.imported ? 1 : sun.visible;
    for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] *= near_end[b] / share;
    return out;
  }
  [[nodiscard]] AirSpectrum sky_ratio(std::size_t ring, bool joined_lines) {
    if (leg.imported) return leg.transmittance;
    return joined_lines ? sky.at(ring) : sky.coarse(ring);
  }
  [[nodiscard]] const AirSpectrum& limb_ratio(std::size_t ring) {
    if (!limb[ring]) {
      limb[ring] = leg.imported ? leg.transmittance : sun.limb_ratio(ring, leg.layers.amounts());
    }
    return *limb[ring];
  }
  [[nodiscard]] const SunLight::LowerRatio& lower(std::size_t ring) {
    if (!lower_exact[ring]) {
      lower_exact[ring] = leg.imported ? SunLight::LowerRatio{leg.transmittance, leg.transmittance}
                                       : sun.lower_ratio(ring, leg.layers.amounts(), near_end);
    }
    return *lower_exact[ring];
  }
  [[nodiscard]] SunLight::LowerRatio lower_ratio(std::size_t ring, bool joined_lines) {
    if (joined_lines || leg.imported) return lower(ring);
    return {lower_air.coarse(ring), lower_surface.coarse(ring)};
  }
};

ViewLight::ViewLight(const SensorPath& leg, const ThermalSurroundings& light,
                     const SensorLine& line, const LineHorizon& horizon,
                     const NodeWavelengths& wavelengths, const FurtherPaths& further)
    : leg_(leg),
      light_(light),
      line_(line),
      horizon_(horizon),
      wavelengths_(wavelengths),
      further_(further),
      path_radiance_(leg.radiance(&light.surroundings)),
      sky_ratio_(light.sky.size(),
                 [this](std::size_t r) {
                   return light_.sky_ratio(static_cast<std::uint32_t>(r), leg_.layers.amounts(),
                                           leg_.layers.transmittance);
                 }),
      mirrored_ratio_(light.lower.size(),
                      [this](std::size_t r) {
                        const LowerRing& ring = light_.lower[r];
                        AirSpectrum both = light_.sky_ratio(
                            ring.mirrored_ring, ring.layers->amounts() + leg_.layers.amounts(),
                            behind(r).transmittance);
                        for (std::size_t b = 0; b < kAirBandCount; ++b) {
                          const double alone = ring.reflected_ratio[b];
                          both[b] = alone > 0 ? both[b] / alone : 0;
                        }
                        return both;
                      }),
      lower_ratio_(light.lower.size(),
                   [this](std::size_t r) {
                     AirSpectrum ratio = lower(r);
                     for (std::size_t b = 0; b < kAirBandCount; ++b) {
                       const double whole = light_.lower[r].total[b];
                       ratio[b] = whole > 0 ? ratio[b] / whole : 0;
                     }
                     return ratio;
                   }),
      sky_(light.sky.size()),
      lower_(light.lower.size()),
      limb_(kLimb.size()),
      sky_error_(kLimb.size() + light.sky.size()),
      behind_(light.lower.size()),
      shapes_(std::make_shared<IncidentRadiance::Shapes>(leg.shapes())) {
  AirSpectrum scattered = leg.layers.surroundings_fraction;
  for (std::size_t b = 0; b < kAirBandCount; ++b) scattered[b] *= light.surroundings[b];
  error_ = model_error(leg.layers.amounts(), leg.layers.transmittance, scattered,
                       leg.layers.warmest_k(), wavelengths.bands, &light.surroundings,
                       light.haze() ? light.haze()->fraction() : 0);
  if (const UnknownCloud* unknown = light.unknown_cloud())
    unknown->add_to(error_, leg.layers.transmittance, leg.lowest_m, leg.highest_m, line.range_m);
}

const AirSpectrum& ViewLight::sky(std::size_t ring) {
  if (!sky_[ring]) {
    AirSpectrum seen = light_.sky[ring].total;
    const AirSpectrum ratio = leg_.imported ? leg_.transmittance : sky_ratio_.at(ring);
    for (std::size_t b = 0; b < kAirBandCount; ++b) seen[b] *= ratio[b];
    sky_[ring] = std::move(seen);
  }
  return *sky_[ring];
}

const AirSpectrum& ViewLight::lower(std::size_t ring) {
  if (!lower_[ring]) lower_[ring] = seen_lower(ring);
  return *lower_[ring];
}

const PathLayers::Behind& ViewLight::behind(std::size_t ring) {
  if (!behind_[ring]) {
    behind_[ring] =
        light_.lower[ring].layers->behind(leg_.layers.amounts(), leg_.layers.transmittance);
  }
  return *behind_[ring];
}

AirSpectrum ViewLight::seen_lower(std::size_t r) {
  const LowerRing& ring = light_.lower[r];
  if (leg_.imported) {
    AirSpectrum seen = ring.total;
    for (std::size_t b = 0; b < kAirBandCount; ++b) seen[b] *= leg_.transmittance[b];
    return seen;
  }
  // Reflected sky through both legs; its lines are those of the ring that most of it comes from.
  const AirSpectrum ratio = mirrored_ratio_.at(r);
  const PathLayers::Behind& air = behind(r);
  AirSpectrum seen = air.thermal_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    seen[b] += air.surroundings_fraction[b] * light_.surroundings[b] +
               air.transmittance[b] * ring.emission[b] +
               ratio[b] * ring.reflected_ratio[b] * ring.reflected[b];
  }
  return seen;
}

const std::shared_ptr<const IncidentRadiance::Thermal>& ViewLight::rings() {
  if (rings_) return rings_;
  auto made = std::make_shared<IncidentRadiance::Thermal>();
  made->ring = BandRows<double>(light_.sky.size() + light_.lower.size(), shapes_->bands);
  std::size_t row = 0;
  const auto add = [&](const AirSpectrum& total) {
    const std::vector<double> used = wavelengths_.of_used(total);
    std::copy(used.begin(), used.end(), made->ring.row(row++));
  };
  for (const SkyRing& r : light_.sky) add(r.total);
  for (const LowerRing& r : light_.lower) add(r.total);
  made->error = light_.sky_ring_error;
  made->error.insert(made->error.end(), light_.lower_ring_error.begin(),
                     light_.lower_ring_error.end());
  return rings_ = std::move(made);
}

const ViewLight::Apparent& ViewLight::rings_apparent(bool joined_lines) {
  Apparent& of = rings_apparent_[joined_lines ? 1 : 0];
  if (of) return of;
  const bool exact = joined_lines || leg_.imported;
  const auto coarse = [](AirSpectrum total, const AirSpectrum& ratio) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) total[b] *= ratio[b];
    return total;
  };
  auto made = std::make_shared<BandRows<double>>(sky_.size() + lower_.size(), shapes_->bands);
  const auto put = [&](std::size_t row, const AirSpectrum& seen) {
    const std::vector<double> used = wavelengths_.of_used(seen);
    std::copy(used.begin(), used.end(), made->row(row));
  };
  for (std::size_t r = 0; r < sky_.size(); ++r)
    put(r, exact ? sky(r) : coarse(light_.sky[r].total, sky_ratio_.coarse(r)));
  for (std::size_t r = 0; r < lower_.size(); ++r)
    put(sky_.size() + r, exact ? lower(r) : coarse(light_.lower[r].total, lower_ratio_.coarse(r)));
  return of = std::move(made);
}

double ViewLight::joined_lines_bound(RingRatios& ratio, double share,
                                     const std::vector<const AirSpectrum*>& light) const {
  const std::array<std::size_t, 3> ring = ratio.coarse_rings();
  double largest = 0;
  for (std::size_t j = 0; j + 1 < ring.size(); ++j) {
    const AirSpectrum a = ratio.coarse(ring[j]), b = ratio.coarse(ring[j + 1]);
    for (const std::size_t end : {j, j + 1}) {
      const AirSpectrum& all = *light[ring[end]];
      InterpolationError change(wavelengths_.bands);
      for (std::size_t k = 0; k < kAirBandCount; ++k) {
        if (all[k] > 0) change.add(k, std::abs(a[k] - b[k]) * all[k], all[k]);
      }
      largest = std::max(largest, change.worst());
    }
  }
  return share * largest;
}

double ViewLight::joined_lines_bound(Solar* solar) {
  if (leg_.imported) return 0;
  std::vector<const AirSpectrum*> sky, lower;
  for (const SkyRing& r : light_.sky) sky.push_back(&r.total);
  for (const LowerRing& r : light_.lower) lower.push_back(&r.total);
  double bound = std::max(joined_lines_bound(sky_ratio_, kSkyJoinedShare, sky),
                          joined_lines_bound(lower_ratio_, kLowerJoinedShare, lower));
  if (solar) {
    sky.assign(sky.size(), &solar->sun.shape());
    lower.assign(lower.size(), &solar->sun.shape());
    bound = std::max({bound, joined_lines_bound(solar->sky, kSkyJoinedShare, sky),
                      joined_lines_bound(solar->lower_air, kLowerJoinedShare, lower),
                      joined_lines_bound(solar->lower_surface, kLowerJoinedShare, lower)});
  }
  return bound;
}

ViewEnvironment ViewLight::seen_under(const SunLight* sun, const EffectSet& effects,
                                      std::uint32_t condition, const DirectionNodes& nodes) {
  ViewEnvironment out;
  if (sun && !sun->shines()) sun = nullptr;
  const std::vector<double> dark(wavelengths_.um.size(), 0.0);
  const EffectSet::Sun& use = effects.sun[condition];
  const bool direct_sun = effects.follows_sun(condition);
  const bool diffuse_sun = sun && effects.scattered_sun(condition);
  std::optional<Solar> solar;
  if (sun && (direct_sun || diffuse_sun || use.background)) {
    solar.emplace(*sun, leg_, light_.sky.size(), light_.lower.size());
  }
  AirSpectrum scattered(kAirBandCount, 0.0);
  if (sun && use.path && !leg_.imported_radiance) {
    scattered = sun->scattered_by(leg_.layers, line_.direction);
  }
  AirSpectrum error = error_.radiance_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    error[b] += (sun ? sun->air_model_relative()[b] : kAerosolRelativeError) * scattered[b];
  }
  out.transmittance = leg_.per_wavelength(leg_.transmittance);
  out.model_error_transmittance = leg_.per_wavelength(error_.transmittance);
  out.model_error_path_radiance = leg_.per_wavelength(error);
  if (!leg_.imported) {
    if (air_ == nullptr) air_ = std::make_shared<const AbsorberAmounts>(leg_.layers.amounts());
    out.air = air_;
  }
  out.path_radiance = leg_.plus_solar(leg_.spread_thermal(path_radiance_), scattered);
  add_ends(out, scattered, sun && use.path && !leg_.imported_radiance ? sun : nullptr);
  out.sun = out.sun_apparent = dark;
  if (sun && direct_sun && sun->visible > 0) {
    out.sun = leg_.plus_solar(dark, sun->irradiance);
    out.sun_apparent = leg_.plus_solar(dark, solar->irradiance());
  }
  if (effects.surroundings()) {
    add_around(out, diffuse_sun ? sun : nullptr, diffuse_sun ? &*solar : nullptr,
               effects.joined_lines, nodes);
  } else {
    out.around = IncidentRadiance::dark(shapes_);
  }
  const bool background_sun = sun && use.background;
  add_behind(out, background_sun ? sun : nullptr, background_sun ? &*solar : nullptr);
  if (line_.land)
    add_land(out, diffuse_sun ? sun : nullptr, background_sun ? sun : nullptr, scattered);
  // Products of band means err by up to 40 % for the sky's and 11 % for the sun's lines over 5 km.
  out.sky_mean = leg_.per_wavelength(diffuse_sun ? sun->around().sky_mean : light_.sky_mean);
  out.sky_model_error =
      leg_.per_wavelength(diffuse_sun ? sun->around().sky_model_error : light_.sky_model_error);
  if (leg_.imported)
    for (std::size_t i = 0; i < out.sky_mean.size(); ++i)
      out.sky_model_error[i] = std::hypot(out.sky_model_error[i], 0.2 * out.sky_mean[i]);
  out.lower_model_relative = std::hypot(light_.lower_model_relative, leg_.imported ? 0.05 : 0.0);
  out.sun_model_relative = std::hypot(kSunRelativeError, leg_.imported ? 0.1 : 0.0);
  if (sun && direct_sun && sun->visible > 0)
    out.sun_model_relative = std::hypot(out.sun_model_relative, sun->beam_cloud_relative());
  return out;
}

void ViewLight::add_land(ViewEnvironment& out, const SunLight* sun, const SunLight* behind,
                         const AirSpectrum& path) const {
  const AirSpectrum dark(kAirBandCount, 0.0);
  const AbsorberAmounts none, near = leg_.layers.amounts();
  // The lines of the reflected sky are those of the ring from which most of it comes.
  const std::uint32_t ring = light_.lower.back().mirrored_ring;
  const AirSpectrum sky = light_.sky_on_level();
  struct Sunlight {
    const SunLight* light = nullptr;
    AirSpectrum sky, at_target;
  };
  const auto sunlight = [&](const SunLight* of) {
    return of ? Sunlight{of, of->sky_on_level(), of->joined(none)} : Sunlight{};
  };
  const Sunlight around = sunlight(sun), beyond = sunlight(behind);
  const auto land = [&](const AbsorberAmounts& amounts, const AirSpectrum& transmittance,
                        const AirSpectrum& thermal, const AirSpectrum& scattered,
                        const Sunlight& lit) {
    AirSpectrum from_sky = light_.sky_ratio(ring, amounts, transmittance), sunlit = dark,
                irradiance = dark;
    for (std::size_t b = 0; b < kAirBandCount; ++b) from_sky[b] *= sky[b];
    if (lit.light != nullptr && !(lit.light->visible > 0)) {
      sunlit = lit.sky;
      for (std::size_t b = 0; b < kAirBandCount; ++b) sunlit[b] *= transmittance[b];
    } else if (lit.light != nullptr) {
      irradiance = sunlit = lit.light->joined(amounts);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        sunlit[b] *= lit.at_target[b] > 0 ? lit.sky[b] / lit.at_target[b] : 0;
        irradiance[b] *= lit.light->outside[b];
      }
    }
    const std::vector<double> no_light(wavelengths_.um.size(), 0.0);
    return LandAir{leg_.per_wavelength(transmittance),
                   leg_.plus_solar(leg_.spread_thermal(thermal), scattered),
                   leg_.plus_solar(leg_.spread_thermal(from_sky), sunlit),
                   leg_.plus_solar(no_light, irradiance)};
  };
  const auto thermal_of = [&](const AirSpectrum& own, const AirSpectrum& fraction) {
    AirSpectrum sum = own;
    for (std::size_t b = 0; b < kAirBandCount; ++b) sum[b] += fraction[b] * light_.surroundings[b];
    return sum;
  };
  for (const PathLayers& air : light_.land_air()) {
    out.land.at_target.push_back(land(air.amounts(), air.transmittance,
                                      thermal_of(air.thermal_w_m2_sr_um, air.surroundings_fraction),
                                      sun ? sun->scattered_around(air) : dark, around));
    const PathLayers::Behind seen = air.behind(near, leg_.transmittance);
    out.land.apparent.push_back(
        land(air.amounts() + near, seen.transmittance,
             thermal_of(seen.thermal_w_m2_sr_um, seen.surroundings_fraction),
             sun ? sun->scattered_around(air, &near) : dark, around));
  }
  for (const SensorPath& air : further_.land) {
    AirSpectrum thermal = air.radiance(&light_.surroundings),
                scattered = behind ? behind->scattered_by(air.layers, line_.direction) : dark;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      thermal[b] -= path_radiance_[b];
      if (behind) scattered[b] -= path[b];
    }
    out.land.behind.push_back(
        land(air.layers.amounts(), air.transmittance, thermal, scattered, beyond));
  }
}

// An imported path holds for one place: the others differ from it as in the embedded model.
void ViewLight::add_ends(ViewEnvironment& out, const AirSpectrum& scattered, const SunLight* sun) {
  if (further_.end.empty()) return;
  const auto emitted = [&](const SensorPath& leg, std::size_t b) {
    return leg.layers.thermal_w_m2_sr_um[b] +
           leg.layers.surroundings_fraction[b] * light_.surroundings[b];
  };
  const AirSpectrum dark(kAirBandCount, 0.0);
  const AirSpectrum sun_here = sun ? sun->scattered_by(leg_.layers, line_.direction) : dark;
  for (const SensorPath& end : further_.end) {
    const AirSpectrum sun_there = sun ? sun->scattered_by(end.layers, line_.direction) : dark;
    AirSpectrum transmittance = leg_.transmittance, thermal = path_radiance_, solar = scattered;
    for (const std::uint32_t b : wavelengths_.used) {
      const double own = leg_.layers.transmittance[b];
      transmittance[b] =
          std::min(1.0, transmittance[b] * (own > 0 ? end.layers.transmittance[b] / own : 1));
      thermal[b] = std::max(0.0, thermal[b] + emitted(end, b) - emitted(leg_, b));
      solar[b] = std::max(0.0, solar[b] + sun_there[b] - sun_here[b]);
    }
    out.end.push_back(
        {leg_.per_wavelength(transmittance), leg_.plus_solar(leg_.spread_thermal(thermal), solar)});
    for (const std::uint32_t b : wavelengths_.used) {
      transmittance[b] -= leg_.transmittance[b];
      thermal[b] -= path_radiance_[b];
      solar[b] -= scattered[b];
    }
    out.end_change.push_back({wavelengths_.of_used(transmittance), wavelengths_.of_used(thermal),
                              wavelengths_.of_used(solar)});
  }
}

void ViewLight::add_around(ViewEnvironment& out, const SunLight* sun, Solar* solar,
                           bool joined_lines, const DirectionNodes& nodes) {
  out.around = IncidentRadiance(shapes_, rings(), rings_apparent(joined_lines),
                                static_cast<std::uint32_t>(light_.sky.size()), nodes.azimuths());
  if (sun) {
    const std::size_t above = light_.sky.size(), below = light_.lower.size();
    IncidentRadiance::Ratios ratios{BandRows<double>(above + below, shapes_->bands),
                                    BandRows<double>(below, shapes_->bands)};
    const auto put = [&](BandRows<double>& to, std::size_t row, const AirSpectrum& ratio) {
      const std::vector<double> used = wavelengths_.of_used(ratio);
      std::copy(used.begin(), used.end(), to.row(row));
    };
    for (std::size_t r = 0; r < above; ++r) put(ratios.air, r, solar->sky_ratio(r, joined_lines));
    for (std::size_t r = 0; r < below; ++r) {
      const SunLight::LowerRatio ratio = solar->lower_ratio(r, joined_lines);
      put(ratios.air, above + r, ratio.air);
      put(ratios.surface, r, ratio.surface);
    }
    out.around.add_sun(sun->around().light, std::move(ratios));
  }
  out.sky_interpolation = sun ? sun->around().interpolation : light_.sky_interpolation;
  out.lower_interpolation = light_.lower_interpolation;
  if (!joined_lines) out.joined_lines_bound = joined_lines_bound(solar);
}

const AirSpectrum& ViewLight::sky_from_horizon(std::size_t ring) {
  if (ring >= kLimb.size()) return sky(ring - kLimb.size());
  if (!limb_[ring]) {
    const SkyRing& of = light_.limb()[ring];
    AirSpectrum seen = of.total;
    const AirSpectrum ratio =
        leg_.imported ? leg_.transmittance
                      : light_.ratio_behind(of, leg_.layers.amounts(), leg_.layers.transmittance);
    for (std::size_t b = 0; b < kAirBandCount; ++b) seen[b] *= ratio[b];
    limb_[ring] = std::move(seen);
  }
  return *limb_[ring];
}

namespace {

// The interval of an increasing axis that x lies in, or the nearest, and how far x is in it.
struct Between {
  std::size_t first;
  double f;
};
Between interval(const std::vector<double>& axis, double x) {
  const auto next = std::upper_bound(axis.begin(), axis.end(), x);
  const std::size_t above = static_cast<std::size_t>(next - axis.begin());
  const std::size_t first = std::min(std::max<std::size_t>(above, 1) - 1, axis.size() - 2);
  return {first, (x - axis[first]) / (axis[first + 1] - axis[first])};
}

void add(AirSpectrum& to, double weight, const AirSpectrum& of) {
  for (std::size_t b = 0; b < kAirBandCount; ++b) to[b] += weight * of[b];
}

}  // namespace

// Thermal light is cubic in the sine of the elevation: where one sees the target before the sea,
// the difference of the two must not drown in the error of a linear interpolation. Aureole and
// glint are those of the very direction.
ViewLight::Behind ViewLight::behind_at(const BehindSight& sight, const SunLight* sun,
                                       Solar* solar) {
  return sight.sky ? sky_at(sight, sun, solar) : lower_at(sight, sun, solar);
}

ViewLight::Behind ViewLight::sky_at(const BehindSight& sight, const SunLight* sun, Solar* solar) {
  const AirSpectrum dark(kAirBandCount, 0.0);
  Behind out{dark, dark, dark, dark};
  // Rays that rise need no rings of those that fall.
  const bool falls = sight.limb > 0;
  const std::size_t skipped = falls ? 0 : kLimb.size();
  std::vector<double> sine;
  double s = sight.sine;
  if (falls) {
    for (const SkyRing& r : light_.limb()) sine.push_back(r.sin_elevation);
    s = -std::sin(sight.limb * std::asin(-sine.front()));
  }
  for (const SkyRing& r : light_.sky) sine.push_back(r.sin_elevation);
  s = std::clamp(s, sine.front(), sine.back());
  const Stencil stencil = cubic(sine, s);
  for (std::size_t i = 0; i < stencil.count; ++i) {
    if (stencil.weight[i] == 0) continue;
    add(out.thermal, stencil.weight[i], sky_from_horizon(skipped + stencil.first + i));
  }
  for (double& x : out.thermal) x = std::max(0.0, x);

  const Between at = interval(sine, s);
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
    const double w = k == 0 ? 1 - at.f : at.f;
    if (w == 0) continue;
    const std::size_t ring = skipped + at.first + k;
    const SkyRing& of = ring < kLimb.size() ? light_.limb()[ring] : light_.sky[ring - kLimb.size()];
    if (!sky_error_[ring]) {
      AirSpectrum error = of.model_error;
      const AirSpectrum& seen = sky_from_horizon(ring);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        error[b] *= of.total[b] > 0 ? seen[b] / of.total[b] : 0;
      }
      sky_error_[ring] = std::move(error);
    }
    add(out.model_error, w, *sky_error_[ring]);
  }
  if (!sun) return out;
  if (falls) {
    AirSpectrum ratio = dark;
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
      const double w = k == 0 ? 1 - at.f : at.f;
      const std::size_t ring = at.first + k;
      const bool limb = ring < kLimb.size();
      add(out.light, w,
          limb ? sun->limb_towards(sight.direction, ring)
               : sun->sky_towards(sight.direction, ring - kLimb.size(), 0));
      add(ratio, w, limb ? solar->limb_ratio(ring) : solar->sky_ratio(ring - kLimb.size(), true));
    }
    for (std::size_t b = 0; b < kAirBandCount; ++b) out.light[b] *= ratio[b];
  } else {
    out.light = sun->sky_towards(sight.direction, at.first, at.f);
    AirSpectrum ratio = solar->sky_ratio(at.first, true);
    if (at.f > 0) {
      const AirSpectrum next_ratio = solar->sky_ratio(at.first + 1, true);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        ratio[b] = (1 - at.f) * ratio[b] + at.f * next_ratio[b];
      }
    }
    for (std::size_t b = 0; b < kAirBandCount; ++b) out.light[b] *= ratio[b];
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    out.model_error[b] += sun->scattered_model_relative()[b] * out.light[b];
  return out;
}

ViewLight::Behind ViewLight::lower_at(const BehindSight& sight, const SunLight* sun, Solar* solar) {
  const AirSpectrum dark(kAirBandCount, 0.0);
  Behind out{dark, dark, dark, dark};
  std::vector<double> sine;
  // Take the rings that meet the surface.
  const std::size_t first = light_.limb_rings();
  for (std::size_t r = first; r < light_.lower.size(); ++r)
    sine.push_back(light_.lower[r].sin_elevation);
  const double s = std::clamp(sight.sine, sine.front(), sine.back());
  const Stencil stencil = cubic(sine, s);
  for (std::size_t i = 0; i < stencil.count; ++i) {
    if (stencil.weight[i] == 0) continue;
    add(out.thermal, stencil.weight[i], lower(first + stencil.first + i));
  }
  for (double& x : out.thermal) x = std::max(0.0, x);
  const double surface_relative = light_.surface_relative(sight.direction.z);
  add(out.model_error, surface_relative, out.thermal);
  if (!sun) return out;

  const auto [of_surface, f] = interval(sine, s);
  const std::size_t ring = first + of_surface;
  AirSpectrum& light = out.light;
  light = sun->glint_towards(sight.direction, ring, f);
  const std::size_t rings = f > 0 ? 2 : 1;
  AirSpectrum mirrored(kAirBandCount, 0.0);  // ratio
  for (std::size_t k = 0; k < rings; ++k) {
    const AirSpectrum& ratio = solar->lower(ring + k).surface;
    const double w = k == 0 ? 1 - f : f;
    for (std::size_t b = 0; b < kAirBandCount; ++b) mirrored[b] += w * ratio[b];
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) light[b] *= mirrored[b];
  AirSpectrum error = light;
  for (double& x : error) x *= sun->glint_model_relative(sight.direction);
  for (std::size_t k = 0; k < rings; ++k) {
    const SunLight::LowerRatio& ratio = solar->lower(ring + k);
    const double w = k == 0 ? 1 - f : f;
    const AirSpectrum air = sun->lower_air_towards(sight.direction, ring + k);
    for (const std::uint32_t b : wavelengths_.used) {
      light[b] += w * air[b] * ratio.air[b];
      error[b] += w * sun->air_model_relative()[b] * air[b] * ratio.air[b];
    }
    const SunLight::OnSurface surface = sun->surface_towards(sight.direction, ring + k);
    for (std::size_t j = 0; j < wavelengths_.used.size(); ++j) {
      const std::uint32_t b = wavelengths_.used[j];
      const double seen = w * ratio.surface[b];
      light[b] += seen * surface.radiance[j];
      error[b] += surface_relative * seen * surface.radiance[j];
      out.interpolation[b] += seen * surface.error[j];
    }
  }
  add(out.model_error, 1, error);
  return out;
}

void ViewLight::add_behind(ViewEnvironment& out, const SunLight* sun, Solar* solar) {
  const BackgroundDirections& nodes = line_.behind;
  const auto at = [&](double z, bool above) {
    return behind_at(horizon_.sight(nodes, z, above), sun, solar);
  };
  const auto spread = [&](const Behind& b) {
    return leg_.plus_solar(leg_.spread_thermal(b.thermal), b.light);
  };
  const std::vector<double> dark(wavelengths_.um.size(), 0.0);
  std::vector<std::vector<double>> between_azimuths;
  for (std::uint32_t n = 0; n < nodes.count(); ++n) {
    const Behind here = at(static_cast<double>(nodes.z(n)), nodes.above(n, horizon_.z()));
    out.background_apparent.push_back(spread(here));
    out.background_model_error.push_back(leg_.spread_thermal(here.model_error));
    out.background_interpolation.push_back(dark);
    between_azimuths.push_back(leg_.plus_solar(dark, here.interpolation));
    if (n == 0 || nodes.z(n - 1) == nodes.z(n)) continue;
    // Far from the horizon all is smooth: half way will do.
    constexpr double kNear = 0.02;
    const bool smooth = std::abs(static_cast<double>(nodes.z(n) - horizon_.z())) > kNear &&
                        std::abs(static_cast<double>(nodes.z(n - 1) - horizon_.z())) > kNear;
    for (const double f : {0.5, 0.25, 0.75}) {
      if (smooth && f != 0.5) break;
      const double z =
          (1 - f) * static_cast<double>(nodes.z(n - 1)) + f * static_cast<double>(nodes.z(n));
      const std::vector<double> direct = spread(at(z, z < static_cast<double>(horizon_.z())));
      for (std::size_t i = 0; i < direct.size(); ++i) {
        const double error = std::abs(direct[i] - (1 - f) * out.background_apparent[n - 1][i] -
                                      f * out.background_apparent[n][i]);
        for (const std::uint32_t k : {n - 1, n}) {
          out.background_interpolation[k][i] = std::max(out.background_interpolation[k][i], error);
        }
      }
    }
  }
  for (std::size_t n = 0; n < between_azimuths.size(); ++n)
    for (std::size_t i = 0; i < dark.size(); ++i)
      out.background_interpolation[n][i] += between_azimuths[n][i];
}

}  // namespace irsig
