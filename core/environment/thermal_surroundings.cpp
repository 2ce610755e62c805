#include "core/environment/thermal_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/base/constants.h"
#include "core/environment/fit/interpolation_error.h"
#include "core/environment/fit/ring_ratios.h"
#include "core/environment/sea/sea_surface.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

// Sines of the elevation at which the mean reflectance of a rough sea is tabulated, for light that
// meets the sea twice.
constexpr std::array kGrazing = {0.002, 0.03, 0.07, 0.13, 0.22, 0.35, 0.55, 1.0};

double zenith_deg_of(double sine_up) {
  return std::acos(std::clamp(sine_up, -1.0, 1.0)) / kRadPerDeg;
}

std::vector<SeaFacet> facets_of(const SurfaceBoundary& spec, Vec<Body> to_observer) {
  return spec.kind == SurfaceBoundary::Kind::kFlatSea
             ? flat_sea(to_observer)
             : sea_facets(to_observer, spec.wind_speed_m_s);
}

// One sigma of an overcast sky by two streams, as a temperature of its radiance
// (docs/evidence/validation.md, "Clouds").  [K]
constexpr double kCloudErrorK = 0.5;

// Light from a hemisphere's cell: where on average it meets the facets.
struct Gathered {
  double share = 0, cosine = 0;
  void add(double s, double c) {
    share += s;
    cosine += s * c;
  }
  [[nodiscard]] double mean_cosine() const { return cosine / share; }
};

// Returns the relative change of a rough sea's emission if the line of slopes against wind went on
// above kMostSlopeWindMS, for each m/s: by the integral over slopes 0.6 % at 1 deg of elevation,
// 0.3 % at 10 deg, 0.1 % at 20 deg, from 22 to 40 m/s at 10 um.
double held_slopes_relative(double wind_m_s, double sine) {
  constexpr double kPerMS = 0.007, kGoneAtSine = 0.423;
  return kPerMS * std::max(0.0, wind_m_s - kMostSlopeWindMS) *
         std::max(0.0, 1 - sine / kGoneAtSine);
}

}  // namespace

// Emissivities measured at sea agree with facet models to about 1 % above 20 deg of elevation and
// 5 % at the horizon, where waves hide each other [masuda1988]: of the whole hemisphere, 2 %. A
// mirror misses what waves do there (0.45 instead of 0.68 at 5 deg). A grey surface is as good as
// its number.
double surface_model_relative(const SurfaceBoundary& spec, double sine) {
  switch (spec.kind) {
    case SurfaceBoundary::Kind::kRoughSea:
      return 0.01 + 0.04 * std::max(0.0, 1 - sine / 0.342) +
             held_slopes_relative(spec.wind_speed_m_s, sine);
    case SurfaceBoundary::Kind::kFlatSea:
      return 0.15;
    case SurfaceBoundary::Kind::kGreySea:
    case SurfaceBoundary::Kind::kGround:
      return 0.05;
  }
  return 0;
}

std::vector<double> ring_weights(const std::vector<double>& sine) {
  std::vector<double> w(sine.size(), 0.0);
  if (sine.size() == 1) return {1.0};
  w.front() += sine.front();
  w.back() += 1 - sine.back();
  for (std::size_t i = 0; i + 1 < sine.size(); ++i) {
    const double half = 0.5 * (sine[i + 1] - sine[i]);
    w[i] += half;
    w[i + 1] += half;
  }
  return w;
}

std::vector<double> level_weights(const std::vector<SkyRing>& sky) {
  std::vector<double> sine;
  for (const SkyRing& ring : sky) sine.push_back(ring.sin_elevation);
  std::vector<double> out = ring_weights(sine);
  double sum = 0;
  for (std::size_t r = 0; r < out.size(); ++r) sum += out[r] *= sine[r];
  for (double& w : out) w /= sum;
  return out;
}

double sin_of_dip(const AirProfile& air, double height_m, bool refraction) {
  double above = 90, below = 180;  // zenith angles of rays that pass and that meet the surface
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (above + below);
    (look(air, height_m, middle, std::numeric_limits<double>::infinity(), refraction).end ==
             PathEnd::kSurface
         ? below
         : above) = middle;
  }
  return -std::cos(below * kRadPerDeg);
}

ThermalSurroundings::ThermalSurroundings(const WeatherSpec& spec, const Atmosphere& atmosphere,
                                         double height_m, const DirectionNodes& nodes,
                                         const BandChoice& bands, int suns,
                                         const ThermalSurroundings* clear)
    : spec_(spec.lower),
      atmosphere_(atmosphere),
      height_m_(height_m),
      nodes_(nodes),
      bands_(bands),
      refraction_(spec.refraction),
      in_the_air_(spec.above_surface_m > 0),
      suns_to_come_(suns) {
  surface_planck = AirSpectrum(kAirBandCount, 0.0);
  planck_of(spec_.temperature_k, surface_planck);
  std::vector<double> lambda_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) lambda_um.push_back(air_band_lambda_um(b));
  water_ = sea_water_spectrum(lambda_um);
  if (spec_.kind == SurfaceBoundary::Kind::kRoughSea) {
    AirSpectrum of_facet(kAirBandCount, 0.0);
    for (const double sine : kGrazing) {
      AirSpectrum reflectance(kAirBandCount, 0.0);
      for (const SeaFacet& f :
           sea_facets({-std::sqrt(1 - sine * sine), 0, -sine}, spec_.wind_speed_m_s)) {
        reflect(of_facet, f.cos_incidence);
        for (std::size_t b = 0; b < kAirBandCount; ++b) reflectance[b] += f.share * of_facet[b];
      }
      rough_reflectance_.push_back(std::move(reflectance));
    }
  }

  scatter_again();
  unknown_ = UnknownCloud::of(spec, atmosphere_, bands_);

  const auto sines = [&](std::uint32_t first, std::uint32_t last) {
    std::vector<double> s;
    for (std::uint32_t n = first; n < last; n += nodes.azimuths()) {
      s.push_back(std::abs(nodes.sin_elevation(n)));
    }
    return s;
  };
  const std::vector<double> up = sines(0, nodes.sky()), down = sines(nodes.sky(), nodes.count());
  // The cloud's levels begin so close below its base.
  constexpr double kEdgeM = 2;
  // Haze scatters other light below a cloud than below a clear sky.
  const bool below_cloud =
      clear && !clear->haze() && cloud_ && height_m_ + kEdgeM < cloud_->level().front().height_m;
  // Half way between the rings, for the error of interpolating.
  std::vector<SkyRing> sky_between;
  std::vector<LowerRing> lower_between;
  for (std::size_t i = 0; i < up.size(); ++i) {
    sky.push_back(make_sky(up[i]));
    if (i + 1 < up.size()) sky_between.push_back(make_sky(0.5 * (up[i] + up[i + 1])));
  }
  for (std::size_t i = 0; i < down.size(); ++i) {
    lower.push_back(make_lower(
        down[i], below_cloud && !clear->lower[i].limb ? clear->lower[i].layers : nullptr));
    if (i + 1 < down.size()) lower_between.push_back(make_lower(0.5 * (down[i] + down[i + 1])));
  }
  solve_surroundings();
  for (SkyRing& r : sky) finish(r);
  for (SkyRing& r : sky_between) finish(r);
  for (LowerRing& r : lower) finish(r);
  for (LowerRing& r : lower_between) finish(r);

  const auto interpolation = [&](const auto& ring, const auto& between,
                                 std::vector<double>& ring_error) {
    InterpolationError of(bands);
    ring_error.assign(ring.size(), 0.0);
    for (std::size_t i = 0; i < between.size(); ++i) {
      AirSpectrum linear = ring[i].total;
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        linear[b] = 0.5 * (linear[b] + ring[i + 1].total[b]);
      }
      of.add(ring[i + 1].sin_elevation - ring[i].sin_elevation, linear, between[i].total);
      InterpolationError here(bands);
      here.add(1, linear, between[i].total);
      for (const std::size_t k : {i, i + 1})
        ring_error[k] = std::max(ring_error[k], 2 * here.worst());
    }
    return of.worst();
  };
  sky_interpolation = interpolation(sky, sky_between, sky_ring_error);
  lower_interpolation = interpolation(lower, lower_between, lower_ring_error);

  sky_mean = sky_model_error = AirSpectrum(kAirBandCount, 0.0);
  const std::vector<double> weight = ring_weights(up);
  for (std::size_t i = 0; i < sky.size(); ++i) {
    sky[i].model_error = model_error_of(sky[i]);
    const AirSpectrum& error = sky[i].model_error;
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      sky_model_error[b] += weight[i] * error[b];
      sky_mean[b] += weight[i] * sky[i].total[b];
    }
  }
  lower_model_relative = spec_.kind == SurfaceBoundary::Kind::kRoughSea
                             ? 0.02 + held_slopes_relative(spec_.wind_speed_m_s, 0.2)
                             : surface_model_relative(spec_, 1);
  for (LowerRing& r : lower) r.from_ring = {};
  if (suns_to_come_ == 0) drop_layers();
}

void ThermalSurroundings::scatter_again() {
  if (!atmosphere_.turbid_levels_m().empty()) {
    cloud_ = std::make_unique<const CloudLight>(atmosphere_, ground(), refraction_, bands_);
    return;
  }
  const double fraction = haze_fraction(atmosphere_);
  if (fraction > 0)
    haze_ = std::make_unique<const HazeLight>(atmosphere_, ground(), fraction, refraction_, bands_);
}

void ThermalSurroundings::drop_layers() const {
  std::vector<bool> kept(sky.size(), false);
  for (const std::size_t r : RingRatios::exact_rings(sky.size())) kept[r] = true;
  for (const std::size_t r : RingRatios::exact_rings(lower.size()))
    kept[lower[r].mirrored_ring] = true;
  for (std::size_t r = 0; r < sky.size(); ++r)
    if (!kept[r]) sky[r].layers = nullptr;
}

void ThermalSurroundings::sun_is_made() const {
  if (--suns_to_come_ != 0) return;
  for (const LowerRing& ring : lower) ring.cell = {};
  drop_layers();
}

double ThermalSurroundings::surface_relative(double sine) const {
  return surface_model_relative(spec_, sine);
}

AirSpectrum ThermalSurroundings::model_error_of(const SkyRing& ring) const {
  const PathLayers& path = *ring.layers;
  AirSpectrum scattered = path.surroundings_fraction;
  for (std::size_t b = 0; b < kAirBandCount; ++b) scattered[b] *= surroundings[b];
  if (!cloud_) {
    return model_error(path.amounts(), path.transmittance, scattered, path.warmest_k(), bands_,
                       &surroundings, haze_ ? haze_->fraction() : 0)
        .radiance_w_m2_sr_um;
  }
  // The cloud's particles are no aerosol of unknown amount: their light has errors of its own.
  AbsorberAmounts air = path.amounts();
  for (const GreyAbsorber particles :
       {GreyAbsorber::kAerosolAbsorption, GreyAbsorber::kAerosolScattering})
    if (!is_fog(atmosphere_.spec().aerosol.kind))
      air.optical_depth[static_cast<std::size_t>(particles)].assign(kAirBandCount, 0.0);
  AirSpectrum out =
      model_error(air, path.transmittance, scattered, path.warmest_k(), bands_, &surroundings)
          .radiance_w_m2_sr_um;
  if (path.lowest_m() >= atmosphere_.turbid_levels_m().back()) return out;
  const AirSpectrum unknown =
      unknown_ ? unknown_->sky_error(path) : AirSpectrum(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    const double per_k = kC2UmK / (air_band_lambda_um(b) * path.warmest_k() * path.warmest_k());
    out[b] = std::hypot(out[b], kCloudErrorK * per_k * ring.total[b], unknown[b]);
  }
  return out;
}

void ThermalSurroundings::planck_of(double kelvin, AirSpectrum& out) const {
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    if (chosen(bands_, b)) out[b] = planck_radiance_w_m2_sr_um(air_band_lambda_um(b), kelvin);
}

GroundBelow ThermalSurroundings::ground() const {
  GroundBelow out{surface_planck, AirSpectrum(kAirBandCount, 1 - spec_.emissivity)};
  if (spec_.kind == SurfaceBoundary::Kind::kRoughSea ||
      spec_.kind == SurfaceBoundary::Kind::kFlatSea) {
    // Diffuse light has about the reflectance of a ray 53 deg from the vertical.
    constexpr double kDiffuseCosine = 0.6;
    out.reflectance.assign(kAirBandCount, 0.0);
    reflect(out.reflectance, kDiffuseCosine);
  }
  return out;
}

const std::vector<SkyRing>& ThermalSurroundings::limb() const {
  return limb_.get([this] {
    const double dip = std::asin(sin_of_dip(atmosphere_.profile(), height_m_, refraction_));
    std::vector<SkyRing> rings;
    for (const double share : kLimb) {
      // The bisected dip may lie on either side of the ray that touches.
      double fall = share * dip;
      while (look(atmosphere_.profile(), height_m_, zenith_deg_of(-std::sin(fall)),
                  std::numeric_limits<double>::infinity(), refraction_)
                 .end == PathEnd::kSurface) {
        fall -= 1e-7;
      }
      rings.push_back(make_sky(-std::sin(fall)));
      rings.back().sin_elevation = -std::sin(share * dip);
      finish(rings.back());
      rings.back().model_error = model_error_of(rings.back());
    }
    return rings;
  });
}

const std::vector<PathLayers>& ThermalSurroundings::land_air() const {
  return land_air_.get([&] {
    std::vector<PathLayers> out;
    for (const double range_m : kLandRangeM)
      out.emplace_back(atmosphere_, level_path(height_m_, range_m), bands_, cloud_.get(),
                       haze_.get());
    return out;
  });
}

AirSpectrum ThermalSurroundings::sky_on_level() const {
  const std::vector<double> weight = level_weights(sky);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t r = 0; r < sky.size(); ++r)
    for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] += weight[r] * sky[r].total[b];
  return out;
}

SkyRing ThermalSurroundings::make_sky(double sin_elevation) const {
  const LightPath path = look(atmosphere_.profile(), height_m_, zenith_deg_of(sin_elevation),
                              std::numeric_limits<double>::infinity(), refraction_);
  return {sin_elevation,
          std::make_shared<const PathLayers>(atmosphere_, path, bands_, cloud_.get(), haze_.get()),
          {}};
}

LowerRing ThermalSurroundings::make_lower(double sin_elevation,
                                          std::shared_ptr<const PathLayers> air) const {
  LightPath path = look(atmosphere_.profile(), height_m_, zenith_deg_of(-sin_elevation),
                        std::numeric_limits<double>::infinity(), refraction_);
  if (in_the_air_ && path.end != PathEnd::kSurface) {
    const AirSpectrum dark(kAirBandCount, 0.0);
    return {
        sin_elevation,
        std::make_shared<const PathLayers>(atmosphere_, path, bands_, cloud_.get(), haze_.get()),
        {},
        {},
        std::vector<AirSpectrum>(nodes_.sky() / nodes_.azimuths(), dark),
        dark,
        0,
        dark,
        dark,
        dark,
        true};
  }
  // Air that bends rays back up lets some pass below the lowest that pass elsewhere.
  for (double steeper = sin_elevation; path.end != PathEnd::kSurface;) {
    IRSIG_CHECK(steeper < 1);
    steeper = std::min(1.0, steeper + 2e-4);
    path = look(atmosphere_.profile(), height_m_, zenith_deg_of(-steeper),
                std::numeric_limits<double>::infinity(), refraction_);
  }
  const double cos_zenith =
      path.node.empty()
          ? sin_elevation
          : std::clamp(-std::cos(path.node.back().zenith_deg * kRadPerDeg), 1e-6, 1.0);
  const bool shared = air != nullptr;
  if (!shared)
    air = std::make_shared<const PathLayers>(atmosphere_, path, bands_, cloud_.get(), haze_.get());
  LowerRing ring{sin_elevation, std::move(air), {}, {}, {}, {}, 0, {}, {}, {}, false, shared};
  ring.emission = AirSpectrum(kAirBandCount, 0.0);
  ring.from_ring.assign(nodes_.sky() / nodes_.azimuths(), AirSpectrum(kAirBandCount, 0.0));
  if (spec_.kind == SurfaceBoundary::Kind::kGreySea ||
      spec_.kind == SurfaceBoundary::Kind::kGround) {
    reflect_diffusely(ring);
  } else {
    reflect_from_facets(ring, cos_zenith);
  }
  return ring;
}

void ThermalSurroundings::reflect(AirSpectrum& out, double cos_incidence) const {
  for (const BandChoice::Range& r : bands_.ranges()) {
    water_reflectance(water_, cos_incidence, r.first, {&out[r.first], r.size()});
  }
}

// Light that a facet mirrors from below the horizon has met the sea before: there it is emitted, or
// reflected from the sky as high above the horizon, by the mean reflectance in that direction.
void ThermalSurroundings::reflect_from_facets(LowerRing& ring, double cos_zenith) const {
  const Vec<Body> to_observer = {-std::sqrt(1 - cos_zenith * cos_zenith), 0, -cos_zenith};
  std::vector<Gathered> once(nodes_.sky()), twice(nodes_.sky());
  double mean_sine = 0;
  for (const SeaFacet& f : facets_of(spec_, to_observer)) {
    const double up = std::max(std::abs(f.mirrored.z), 1e-12);
    DirectionNodes::Share share[4];
    const int n = nodes_.shares(static_cast<float>(f.mirrored.x), static_cast<float>(f.mirrored.y),
                                static_cast<float>(-up), share);
    for (int i = 0; i < n; ++i) {
      std::vector<Gathered>& to = f.mirrored.z < 0 ? once : twice;
      to[share[i].node].add(f.share * static_cast<double>(share[i].weight), f.cos_incidence);
    }
    mean_sine += f.share * up;
  }
  const std::uint32_t azimuths = nodes_.azimuths();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint32_t r = 0; r < ring.from_ring.size(); ++r) {
    const double away = std::abs(nodes_.sin_elevation(r * azimuths) - mean_sine);
    if (away < nearest) ring.mirrored_ring = r;
    nearest = std::min(nearest, away);
  }
  AirSpectrum reflected(kAirBandCount, 0.0), mirrored = reflected, weight = reflected;
  for (std::uint32_t node = 0; node < nodes_.sky(); ++node) {
    if (once[node].share <= 0 && twice[node].share <= 0) continue;
    const double sine = nodes_.sin_elevation(node);
    std::size_t k = 0;
    while (k + 2 < kGrazing.size() && kGrazing[k + 1] < sine) ++k;
    const double f = std::clamp((sine - kGrazing[k]) / (kGrazing[k + 1] - kGrazing[k]), 0.0, 1.0);
    std::fill(weight.begin(), weight.end(), 0.0);
    if (once[node].share > 0) {
      reflect(mirrored, once[node].mean_cosine());
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        weight[b] += once[node].share * mirrored[b];
      }
    }
    if (twice[node].share > 0) {
      const AirSpectrum &low = rough_reflectance_[k], &high = rough_reflectance_[k + 1];
      reflect(mirrored, twice[node].mean_cosine());
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        weight[b] += twice[node].share * mirrored[b] * ((1 - f) * low[b] + f * high[b]);
      }
    }
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      ring.from_ring[node / azimuths][b] += weight[b];
      reflected[b] += weight[b];
    }
    if (suns_to_come_ > 0)
      pack(ring.cell.emplace_back(node / azimuths, node % azimuths).weight, weight, bands_);
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    ring.emission[b] = (1 - reflected[b]) * surface_planck[b];
  }
}

// The sky's irradiance over pi: every ring by twice its sine.
void ThermalSurroundings::reflect_diffusely(LowerRing& ring) const {
  const std::uint32_t azimuths = nodes_.azimuths();
  std::vector<double> sine;
  for (std::uint32_t n = 0; n < nodes_.sky(); n += azimuths)
    sine.push_back(nodes_.sin_elevation(n));
  std::vector<double> weight = ring_weights(sine);
  double sum = 0;
  for (std::size_t r = 0; r < sine.size(); ++r) sum += weight[r] *= sine[r];
  for (std::uint32_t r = 0; r < sine.size(); ++r) {
    const AirSpectrum of_ring(kAirBandCount, (1 - spec_.emissivity) * weight[r] / sum);
    ring.from_ring[r] = of_ring;
    ring.diffuse.push_back(of_ring[0] / static_cast<double>(azimuths));
    if (sine[r] <= 0.5) ring.mirrored_ring = r;
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    ring.emission[b] = spec_.emissivity * surface_planck[b];
  }
}

// x = mean over all directions of (thermal sky + its share of x) above and of (emission + mean
// reflected sky) below: linear in x, band by band.
void ThermalSurroundings::solve_surroundings() {
  std::vector<double> sine_up, sine_down;
  for (const SkyRing& r : sky) sine_up.push_back(r.sin_elevation);
  for (const LowerRing& r : lower) sine_down.push_back(r.sin_elevation);
  const std::vector<double> up = ring_weights(sine_up), down = ring_weights(sine_down);
  surroundings = AirSpectrum(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    double thermal = 0, share = 0, emitted = 0;
    for (std::size_t r = 0; r < sky.size(); ++r) {
      thermal += up[r] * sky[r].layers->thermal_w_m2_sr_um[b];
      share += up[r] * sky[r].layers->surroundings_fraction[b];
    }
    for (std::size_t r = 0; r < lower.size(); ++r) emitted += down[r] * lower[r].emission[b];
    const double sky_part =
        1 - 0.5 * (surface_planck[b] > 0 ? emitted / surface_planck[b] : 0);  // 1 - emissivity / 2
    surroundings[b] = (sky_part * thermal + 0.5 * emitted) / (1 - sky_part * share);
  }
}

void ThermalSurroundings::finish(SkyRing& ring) const {
  ring.total = ring.layers->thermal_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    ring.total[b] += ring.layers->surroundings_fraction[b] * surroundings[b];
  }
}

AirSpectrum ThermalSurroundings::ratio_behind(const SkyRing& ring, const AbsorberAmounts& near,
                                              const AirSpectrum& through_near) const {
  const PathLayers::Behind seen = ring.layers->behind(near, through_near);
  AirSpectrum ratio(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (ring.total[b] <= 0) continue;
    ratio[b] = (seen.thermal_w_m2_sr_um[b] + seen.surroundings_fraction[b] * surroundings[b]) /
               ring.total[b];
  }
  return ratio;
}

void ThermalSurroundings::finish(LowerRing& ring) const {
  ring.reflected = AirSpectrum(kAirBandCount, 0.0);
  for (std::size_t r = 0; r < ring.from_ring.size(); ++r) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      ring.reflected[b] += ring.from_ring[r][b] * sky[r].total[b];
    }
  }
  ring.reflected_ratio =
      sky_ratio(ring.mirrored_ring, ring.layers->amounts(), ring.layers->transmittance);
  ring.total = ring.layers->thermal_w_m2_sr_um;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    ring.total[b] += ring.layers->surroundings_fraction[b] * surroundings[b] +
                     ring.layers->transmittance[b] * ring.emission[b] +
                     ring.reflected_ratio[b] * ring.reflected[b];
  }
}

}  // namespace irsig
