#include "core/environment/sun_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/atmosphere/scattered_again.h"
#include "core/base/constants.h"
#include "core/environment/fit/interpolation_error.h"
#include "core/environment/fit/linear_basis_fit.h"
#include "core/environment/sea/sea_surface.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Directions within half the hat of a node, in sine and in azimuth, over which the aureole is
// averaged.
constexpr int kHatSines = 4, kHatAzimuths = 6;

// Errors found in a cell, at a band of each quarter of a micrometre, are by so much less than those
// that may be found between.
constexpr double kBetweenLooks = 1.5;
constexpr double kSomeSunlight = 0.1;

constexpr double kTurn = 2 * std::numbers::pi;

// sin_up < 0: below the horizon.
Vec<Body> direction_of(double sin_up, double azimuth) {
  const double c = std::sqrt(std::max(0.0, 1 - sin_up * sin_up));
  return {c * std::cos(azimuth), c * std::sin(azimuth), -sin_up};
}

double ratio_of(double part, double whole) { return whole > 0 ? part / whole : 0; }

AirSpectrum quotient(const AirSpectrum& part, const AirSpectrum& whole) {
  AirSpectrum q(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) q[b] = ratio_of(part[b], whole[b]);
  return q;
}

void multiply(AirSpectrum& a, const AirSpectrum& b) {
  for (std::size_t i = 0; i < kAirBandCount; ++i) a[i] *= b[i];
}

// All that is scattered, over all directions.
double scattered_in_all(const ScatteredSun& light, std::size_t band) {
  double sum = light.aerosol[band] + light.molecular[band];
  if (!light.haze.empty())
    sum += 4 * std::numbers::pi * std::max(0.0, light.haze_mean_per_sr[band]) + light.haze[band];
  if (!light.cloud.empty()) {
    sum += light.cloud[band] + 4 * std::numbers::pi * light.diffuse_per_sr[band] + light.peak[band];
  }
  return sum;
}

AirSpectrum ratio_of_scattered(const ScatteredSun& part, const ScatteredSun& whole) {
  AirSpectrum q(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b)
    q[b] = ratio_of(scattered_in_all(part, b), scattered_in_all(whole, b));
  return q;
}

template <typename Ring>
std::vector<double> sines_of(const std::vector<Ring>& rings) {
  std::vector<double> sine;
  for (const Ring& r : rings) sine.push_back(r.sin_elevation);
  return sine;
}

// Calls at(weight, sine, azimuth) all over a node's hat function.
template <typename At>
void over_hat(const std::vector<double>& sine, std::size_t ring, std::uint32_t turn,
              std::uint32_t azimuths, const At& at) {
  const double middle = sine[ring];
  const double below = ring > 0 ? sine[ring - 1] : middle;
  const double above = ring + 1 < sine.size() ? sine[ring + 1] : middle;
  for (int i = 0; i < 2 * kHatSines; ++i) {
    const double x = (i + 0.5) / kHatSines - 1;  // -1 .. 1
    const double edge = x < 0 ? middle - below : above - middle;
    if (edge <= 0) continue;
    for (int j = 0; j < 2 * kHatAzimuths; ++j) {
      const double y = (j + 0.5) / kHatAzimuths - 1;
      at(edge * (1 - std::abs(x)) * (1 - std::abs(y)), middle + edge * x,
         (turn + y) * kTurn / azimuths);
    }
  }
}

// Returns the sky's sunlight that a ring's surface reflects towards an azimuth, [wanted band].
//   sky  [node][wanted band]
std::vector<double> reflected_sky(const LowerRing& ring, const BandRows<double>& sky,
                                  std::uint32_t azimuths, std::uint32_t azimuth) {
  std::vector<double> sum(sky.bands, 0.0);
  for (std::uint32_t node = 0; node < ring.diffuse.size() * azimuths; ++node) {
    const double weight = ring.diffuse[node / azimuths], *from = sky.row(node);
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += weight * from[b];
  }
  for (const LowerRing::Cell& cell : ring.cell) {
    const double *from = sky.row(cell.ring * azimuths + (azimuth + cell.turn) % azimuths),
                 *weight = cell.weight.data();
    for (std::size_t b = 0; b < sum.size(); ++b) sum[b] += weight[b] * from[b];
  }
  return sum;
}

}  // namespace

SunLight::SunLight(const ConditionEnvironment& condition, const SunSeen& seen,
                   const ThermalSurroundings& weather, const SurfaceBoundary& surface,
                   const Atmosphere& atmosphere, const Atmosphere& beam, double height_m,
                   const DirectionNodes& nodes, const NodeWavelengths& wavelengths)
    : visible(seen.visible),
      weather_(weather),
      direction_(seen.middle),
      height_m_(height_m),
      azimuths_(nodes.azimuths()),
      surface_(surface),
      wavelengths_(wavelengths),
      bands_(wavelengths.bands),
      only_fog_(atmosphere.only_fog()),
      sky_source_(weather.sky.size()),
      limb_source_(kLimb.size()),
      lower_source_(weather.lower.size()),
      far_(weather.lower.size()) {
  outside = irradiance = whole_ = near_ = AirSpectrum(kAirBandCount, 0.0);
  scattered_relative_.assign(kAirBandCount, kAerosolRelativeError);
  air_relative_ = scattered_relative_;
  if (!seen.lights_air) return;
  const double zenith_deg = this->zenith_deg();
  sun_.emplace(atmosphere, height_m, zenith_deg, bands_);
  if (!sun_->lights_any()) {
    sun_.reset();
    return;
  }
  if (!sun_->lit()) visible = 0;
  if (weather_.cloud()) {
    beam_.emplace(beam, height_m, zenith_deg, bands_);
    cloud_.emplace(*weather_.cloud(), *sun_, zenith_deg);
  }
  if (weather_.haze()) haze_.emplace(*weather_.haze(), atmosphere, zenith_deg);
  const AirSpectrum again = scattered_again_relative(atmosphere, height_m, zenith_deg, bands_);
  const double low = low_sun_relative(zenith_deg);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    air_relative_[b] = std::hypot(kAerosolRelativeError, again[b]);
    if (low > 0) air_relative_[b] = std::hypot(air_relative_[b], low);
  }
  scattered_relative_ = air_relative_;
  if (const UnknownCloud* unknown = weather_.unknown_cloud()) {
    const AirSpectrum by_cloud = unknown->diffuse_sun_relative(height_m_, zenith_deg);
    for (std::size_t b = 0; b < kAirBandCount; ++b)
      scattered_relative_[b] = std::hypot(scattered_relative_[b], by_cloud[b]);
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    whole_[b] = solar_irradiance_w_m2_um(air_band_lambda_um(b)) /
                (condition.sun_distance_au * condition.sun_distance_au);
  }
  if (!(visible > 0)) return;
  near_ = irradiance = joined(AbsorberAmounts());
  multiply(irradiance, whole_);
  outside = whole_;
  for (double& x : outside) x *= visible;
}

double SunLight::zenith_deg() const {
  return std::acos(std::clamp(-direction_.z, -1.0, 1.0)) / kRadPerDeg;
}
double SunLight::beam_cloud_relative() const {
  const UnknownCloud* unknown = weather_.unknown_cloud();
  return unknown ? unknown->beam_relative(irradiance, outside, height_m_, zenith_deg()) : 0;
}

const SunLight::Around& SunLight::around() const {
  return around_.get([this] { return make_around(); });
}
const ScatteredSun& SunLight::sky_source(std::size_t ring) const {
  return sky_source_[ring].get(
      [this, ring] { return scattered_in_sky(*weather_.sky[ring].layers); });
}
const ScatteredSun& SunLight::limb_source(std::size_t ring) const {
  return limb_source_[ring].get(
      [this, ring] { return scattered_in_sky(*weather_.limb()[ring].layers); });
}
ScatteredSun SunLight::scattered_in_sky(const PathLayers& path, const AbsorberAmounts* near) const {
  ScatteredSun out = path.scattered(*sun_, near, cloud(), haze());
  if (!cloud_ || only_fog_) return out;
  // The beam's loss to the forward peak.
  AbsorberAmounts amounts = near ? *near : AbsorberAmounts();
  const AirSpectrum beam = joined(amounts);
  if (!sun_->add_to(amounts, height_m_)) return out;
  const AirSpectrum both = transmittance(amounts, bands_);
  for (std::size_t b = 0; b < kAirBandCount; ++b) out.peak[b] = std::max(0.0, both[b] - beam[b]);
  return out;
}
ScatteredSun SunLight::scattered_below(std::size_t ring) const {
  const LowerRing& of = weather_.lower[ring];
  return of.layers->scattered(*sun_, nullptr, of.below_cloud ? nullptr : cloud(), haze());
}
const ScatteredSun& SunLight::lower_source(std::size_t ring) const {
  return lower_source_[ring].get([this, ring] { return scattered_below(ring); });
}
const AirSpectrum& SunLight::far(std::size_t ring) const {
  return far_[ring].get([this, ring] { return joined(weather_.lower[ring].layers->amounts()); });
}

AirSpectrum SunLight::passed(std::size_t ring) const {
  return visible > 0 ? quotient(far(ring), near_) : weather_.lower[ring].layers->transmittance;
}

SunLight::Around SunLight::make_around() const {
  const std::size_t n = wavelengths_.used.size();
  const auto write = [&](BandRows<float>& to, std::size_t row, const AirSpectrum& of) {
    for (std::size_t b = 0; b < n; ++b)
      to.row(row)[b] = static_cast<float>(of[wavelengths_.used[b]]);
  };
  const Sky sky = make_sky();
  BandRows<double> packed(sky.node.size(), 0);
  for (const AirSpectrum& node : sky.node) pack(packed.value, node, bands_);
  packed.bands = packed.value.size() / sky.node.size();
  std::vector<Lower> lower;
  for (std::size_t r = 0; r < weather_.lower.size(); ++r) lower.push_back(make_lower(r, packed));
  weather_.sun_is_made();
  auto light = std::make_shared<IncidentRadiance::Sunlight>();
  const std::size_t above = sky.node.size(), below = lower.size() * azimuths_;
  light->air = BandRows<float>(above + below, n);
  light->surface = BandRows<float>(below, n);
  for (std::size_t k = 0; k < above; ++k) write(light->air, k, sky.node[k]);
  for (std::size_t k = 0; k < below; ++k) {
    write(light->air, above + k, lower[k / azimuths_].air[k % azimuths_]);
    write(light->surface, k, lower[k / azimuths_].surface[k % azimuths_]);
  }
  light->error = sky.node_error;
  const std::vector<double> error = lower_node_error(lower);
  light->error.insert(light->error.end(), error.begin(), error.end());
  return {std::move(light), sky.interpolation, sky.mean, sky.model_error};
}

SunLight::Sky SunLight::make_sky() const {
  Sky out;
  const std::vector<double> sine = sines_of(weather_.sky);
  for (std::size_t r = 0; r < sine.size(); ++r) {
    for (std::uint32_t a = 0; a < azimuths_; ++a) {
      out.node.push_back(sky_source(r).per_sr(phase(sine, r, 1, a)));
      multiply(out.node.back(), whole_);
    }
  }
  // Beside a cloud's edge and the Earth's shadow a fit may fall below 0.
  const bool edges = cloud_ || low_sun_relative(zenith_deg()) > 0;
  std::vector<AirSpectrum> of_hat;
  if (edges) of_hat = out.node;
  fit_to_hats(out.node, sine, azimuths_);
  if (edges) keep_positive(out.node, of_hat);
  find_errors(out);

  out.mean = weather_.sky_mean;
  out.model_error = weather_.sky_model_error;
  const std::vector<double> weight = ring_weights(sine);
  for (std::size_t n = 0; n < out.node.size(); ++n) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const double part = weight[n / azimuths_] / azimuths_ * out.node[n][b];
      out.mean[b] += part;
      out.model_error[b] += scattered_relative_[b] * part;
    }
  }
  return out;
}

SunLight::Lower SunLight::make_lower(std::size_t r, const BandRows<double>& sky) const {
  Lower out;
  const std::vector<double> sine = sines_of(weather_.lower);
  const LowerRing& ring = weather_.lower[r];
  const ScatteredSun air = scattered_below(r);
  const AirSpectrum through = passed(r);
  const double diffuse = ring.limb ? 0 : diffuse_per_sr();
  std::vector<double> sum;
  for (std::uint32_t a = 0; a < azimuths_; ++a) {
    out.air.push_back(air.per_sr(phase(sine, r, -1, a)));
    multiply(out.air.back(), whole_);
    // A diffuse surface reflects the same in all directions.
    if (a == 0 || ring.diffuse.empty()) sum = reflected_sky(ring, sky, azimuths_, a);
    AirSpectrum mirrored(kAirBandCount, 0.0);
    unpack(mirrored, sum.data(), bands_);
    // Let through as sunlight is, whose lines it carries.
    multiply(mirrored, through);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      mirrored[b] += diffuse * outside[b] * far(r)[b];
    }
    out.surface.push_back(std::move(mirrored));
  }
  return out;
}

// Linear interpolation errs by h^2 / 8 f'', a quarter of what the node itself differs by from the
// line between those beside it: taken twice.
std::vector<double> SunLight::lower_node_error(const std::vector<Lower>& lower) const {
  std::vector<double> out;
  for (std::size_t r = 0; r < lower.size(); ++r) {
    const bool ends = r == 0 || r + 1 == lower.size();
    const Lower &here = lower[r], &below = lower[ends ? r : r - 1],
                &above = lower[ends ? r : r + 1];
    const double f =
        ends ? 0
             : (weather_.lower[r].sin_elevation - weather_.lower[r - 1].sin_elevation) /
                   (weather_.lower[r + 1].sin_elevation - weather_.lower[r - 1].sin_elevation);
    for (std::uint32_t a = 0; a < azimuths_; ++a) {
      const std::uint32_t before = (a + azimuths_ - 1) % azimuths_, after = (a + 1) % azimuths_;
      InterpolationError around(bands_), up(bands_);
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        if (!chosen(bands_, b)) continue;
        const auto value = [&](const Lower& ring, std::uint32_t at) {
          return ring.air[at][b] + ring.surface[at][b];
        };
        const double node = value(here, a);
        around.add(b, 0.5 * std::abs(node - 0.5 * (value(here, before) + value(here, after))),
                   node);
        up.add(b, 0.5 * std::abs(node - std::lerp(value(below, a), value(above, a), f)), node);
      }
      out.push_back(around.worst() + up.worst());
    }
  }
  return out;
}

AirSpectrum SunLight::joined(const AbsorberAmounts& amounts) const {
  AbsorberAmounts sum = amounts;
  const SunAmounts& sun = beam_ ? *beam_ : *sun_;
  return sun.add_to(sum, height_m_) ? transmittance(sum, bands_) : AirSpectrum(kAirBandCount, 0.0);
}

PhaseMean SunLight::phase(const std::vector<double>& sine, std::size_t ring, double up,
                          std::uint32_t azimuth) const {
  PhaseMean mean;
  over_hat(sine, ring, azimuth, azimuths_, [&](double weight, double s, double turned) {
    mean.add(weight, dot(direction_of(up * s, turned), direction_));
  });
  return mean;
}

AirSpectrum SunLight::sky_towards(Vec<Body> direction, std::size_t ring, double f) const {
  const double cosine = dot(direction, direction_);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out[b] = (1 - f) * sky_source(ring).per_sr(b, cosine);
    if (f > 0) out[b] += f * sky_source(ring + 1).per_sr(b, cosine);
    out[b] *= whole_[b];
  }
  return out;
}

AirSpectrum SunLight::lower_air_towards(Vec<Body> direction, std::size_t ring) const {
  const double cosine = dot(direction, direction_);
  const ScatteredSun& source = lower_source(ring);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] = source.per_sr(b, cosine) * whole_[b];
  return out;
}

// The error is the distance of the cubic from the straight line, which errs more, and an eighth of
// the third difference, which stays where both meet.
SunLight::OnSurface SunLight::surface_towards(Vec<Body> direction, std::size_t ring) const {
  const BandRows<float>& nodes = around().light->surface;
  const double angle = std::atan2(direction.y, direction.x) / (2 * std::numbers::pi);
  const double turn = (angle < 0 ? angle + 1 : angle) * azimuths_;
  const std::uint32_t at = std::min(static_cast<std::uint32_t>(turn), azimuths_ - 1);
  const double g = std::min(1.0, turn - at);
  const auto node = [&](std::uint32_t beside) {
    return nodes.row(ring * azimuths_ + (at + azimuths_ + beside - 1) % azimuths_);
  };
  const float *before = node(0), *here = node(1), *next = node(2), *after = node(3);
  OnSurface out;
  out.radiance.reserve(nodes.bands);
  out.error.reserve(nodes.bands);
  for (std::size_t j = 0; j < nodes.bands; ++j) {
    const auto a = static_cast<double>(before[j]), b = static_cast<double>(here[j]),
               c = static_cast<double>(next[j]), d = static_cast<double>(after[j]);
    const double line = b + g * (c - b), third = d - 3 * c + 3 * b - a;
    const double second = (2 - g) * (a - 2 * b + c) + (1 + g) * (b - 2 * c + d);
    const double cubic = std::max(0.0, line - g * (1 - g) / 6 * second);
    out.radiance.push_back(cubic);
    out.error.push_back(std::abs(cubic - line) + std::abs(third) / 8);
  }
  return out;
}

AirSpectrum SunLight::glint_towards(Vec<Body> direction, std::size_t ring, double f) const {
  AirSpectrum out(kAirBandCount, 0.0);
  if (surface_.kind != SurfaceBoundary::Kind::kRoughSea || !(surface_.wind_speed_m_s > 0))
    return out;
  const Vec<Body> to_observer = -1.0 * direction;
  const double per_sr = glint_per_sr(to_observer, direction_, surface_.wind_speed_m_s);
  const double cosine = dot(normalized(to_observer + direction_), direction_);
  for (std::size_t b = 0; per_sr > 0 && b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    const double through = f > 0 ? (1 - f) * far(ring)[b] + f * far(ring + 1)[b] : far(ring)[b];
    out[b] = per_sr * outside[b] * through *
             water_reflectance(sea_water_index(air_band_lambda_um(b)), cosine);
  }
  return out;
}

double SunLight::glint_model_relative(Vec<Body> direction) const {
  return irsig::glint_model_relative(-1.0 * direction, direction_, surface_.wind_speed_m_s);
}

double SunLight::diffuse_per_sr() const {
  const bool diffuse = surface_.kind == SurfaceBoundary::Kind::kGreySea ||
                       surface_.kind == SurfaceBoundary::Kind::kGround;
  return diffuse ? (1 - surface_.emissivity) * std::max(0.0, -direction_.z) * std::numbers::inv_pi
                 : 0;
}

// Finds the errors in some bands.
void SunLight::find_node_errors(Sky& out, std::span<const std::size_t> bands) const {
  constexpr int kSteps = 4;
  const std::vector<AirSpectrum>& sky = out.node;
  for (std::size_t r = 0; r + 1 < weather_.sky.size(); ++r)
    for (std::uint32_t a = 0; a < azimuths_; ++a) {
      const std::uint32_t next = (a + 1) % azimuths_;
      double most = 0;
      for (int i = 0; i <= kSteps; ++i)
        for (int j = 0; j <= kSteps; ++j) {
          const double f = static_cast<double>(i) / kSteps, g = static_cast<double>(j) / kSteps;
          const Vec<Body> d = direction_of(
              std::lerp(weather_.sky[r].sin_elevation, weather_.sky[r + 1].sin_elevation, f),
              (a + g) * kTurn / azimuths_);
          const double cosine = dot(d, direction_);
          for (const std::size_t b : bands) {
            const double direct = whole_[b] * std::lerp(sky_source(r).per_sr(b, cosine),
                                                        sky_source(r + 1).per_sr(b, cosine), f);
            const auto of_ring = [&](std::size_t ring) {
              return std::lerp(sky[ring * azimuths_ + a][b], sky[ring * azimuths_ + next][b], g);
            };
            const double linear = std::lerp(of_ring(r), of_ring(r + 1), f);
            if (linear > 0) most = std::max(most, std::abs(linear - direct) / linear);
          }
        }
      for (const std::size_t ring : {r, r + 1})
        for (const std::uint32_t turn : {a, next}) {
          double& of_node = out.node_error[ring * azimuths_ + turn];
          of_node = std::max(of_node, kBetweenLooks * most);
        }
    }
}

// Finds the errors in the three quarters of a micrometre where scattered sunlight has the largest
// part, each by one band.
void SunLight::find_errors(Sky& out) const {
  const std::vector<AirSpectrum>& sky = out.node;
  out.interpolation = weather_.sky_interpolation;
  out.node_error.assign(sky.size(), 0.0);
  const std::uint32_t azimuths = azimuths_;
  std::vector<double> part;
  std::vector<std::size_t> band;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    const auto quarter = static_cast<std::size_t>(4 * air_band_lambda_um(b));
    if (quarter >= part.size()) {
      part.resize(quarter + 1, 0.0);
      band.resize(quarter + 1, 0);
    }
    const double solar = scattered_in_all(sky_source(weather_.sky.size() - 1), b) * whole_[b];
    const double share =
        ratio_of(solar, solar + 4 * std::numbers::pi * weather_.sky.back().total[b]);
    if (share > part[quarter]) {
      part[quarter] = share;
      band[quarter] = b;
    }
  }
  std::vector<std::size_t> quarters;
  for (std::size_t q = 0; q < part.size(); ++q) {
    if (part[q] > 0) quarters.push_back(q);
  }
  std::sort(quarters.begin(), quarters.end(), [&](std::size_t a, std::size_t b) {
    return part[a] > part[b] || (part[a] == part[b] && a < b);
  });
  // In a single direction also where less of the light is the sun's.
  std::vector<std::size_t> looked_at;
  for (const std::size_t q : quarters)
    if (looked_at.size() < 3 || part[q] > kSomeSunlight) looked_at.push_back(band[q]);
  find_node_errors(out, looked_at);
  if (quarters.size() > 3) quarters.resize(3);
  if (quarters.empty()) return;

  // Lobes about directions spread evenly over the hemisphere.
  constexpr std::uint32_t kLobes = 40, kPerInterval = 2, kPerTurn = 5;
  std::vector<Vec<Body>> lobe;
  for (std::uint32_t i = 0; i < kLobes; ++i) {
    lobe.push_back(direction_of((i + 0.5) / kLobes, i * 2.399963229728653));
  }
  std::vector<double> error(quarters.size() * kLobes, 0.0), radiance = error;
  for (std::size_t r = 0; r + 1 < weather_.sky.size(); ++r) {
    const double low = weather_.sky[r].sin_elevation, high = weather_.sky[r + 1].sin_elevation;
    for (std::uint32_t i = 0; i < kPerInterval * azimuths * kPerTurn; ++i) {
      const double f = (i % kPerInterval + 0.5) / kPerInterval;
      const double turn = (i / kPerInterval + 0.5) / kPerTurn;
      const auto a = static_cast<std::uint32_t>(turn);
      const double g = turn - a;
      const Vec<Body> d = direction_of(low + f * (high - low), turn * kTurn / azimuths);
      const double cosine = dot(d, direction_);
      for (std::size_t q = 0; q < quarters.size(); ++q) {
        const std::size_t b = band[quarters[q]];
        const double direct = whole_[b] * ((1 - f) * sky_source(r).per_sr(b, cosine) +
                                           f * sky_source(r + 1).per_sr(b, cosine));
        const auto node = [&](std::size_t ring) {
          return (1 - g) * sky[ring * azimuths + a][b] +
                 g * sky[ring * azimuths + (a + 1) % azimuths][b];
        };
        const double linear = (1 - f) * node(r) + f * node(r + 1);
        const double thermal =
            (1 - f) * weather_.sky[r].total[b] + f * weather_.sky[r + 1].total[b];
        for (std::uint32_t l = 0; l < kLobes; ++l) {
          const double c = dot(d, lobe[l]);
          if (c <= 0) continue;
          const double c2 = c * c, c4 = c2 * c2, c8 = c4 * c4, w = (high - low) * c8 * c8 * c4;
          error[q * kLobes + l] += w * (linear - direct);
          radiance[q * kLobes + l] += w * (direct + thermal);
        }
      }
    }
  }
  double worst = 0;
  for (std::size_t q = 0; q < quarters.size(); ++q) {
    double e = 0, l = 0;
    for (std::uint32_t k = 0; k < kLobes; ++k) {
      e += std::abs(error[q * kLobes + k]);
      l += radiance[q * kLobes + k];
    }
    worst = std::max(worst, ratio_of(e, l));
  }
  out.interpolation += worst;
}

SunLight::LowerRatio SunLight::lower_ratio(std::size_t ring, const AbsorberAmounts& near,
                                           const AirSpectrum& near_end) const {
  if (!(visible > 0)) {
    const AirSpectrum passed_by_both =
        transmittance(weather_.lower[ring].layers->amounts() + near, bands_);
    return {transmittance(near, bands_), quotient(passed_by_both, passed(ring))};
  }
  const AirSpectrum far_end = joined(weather_.lower[ring].layers->amounts() + near);
  AirSpectrum air(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    air[b] = ratio_of(mean_of_sunlight(near_end[b], far_end[b], 0),
                      mean_of_sunlight(near_[b], far(ring)[b], 0));
  }
  return {std::move(air), quotient(far_end, far(ring))};
}

AirSpectrum SunLight::sky_ratio(std::size_t ring, const AbsorberAmounts& near) const {
  return ratio_of_scattered(scattered_in_sky(*weather_.sky[ring].layers, &near), sky_source(ring));
}

AirSpectrum SunLight::limb_towards(Vec<Body> direction, std::size_t ring) const {
  const double cosine = dot(direction, direction_);
  AirSpectrum out = whole_;
  for (std::size_t b = 0; b < kAirBandCount; ++b) out[b] *= limb_source(ring).per_sr(b, cosine);
  return out;
}

AirSpectrum SunLight::limb_ratio(std::size_t ring, const AbsorberAmounts& near) const {
  return ratio_of_scattered(scattered_in_sky(*weather_.limb()[ring].layers, &near),
                            limb_source(ring));
}

AirSpectrum SunLight::scattered_around(const PathLayers& path, const AbsorberAmounts* near) const {
  constexpr int kDirections = 8;
  PhaseMean phase;
  for (int i = 0; i < kDirections; ++i) {
    const double azimuth = 2 * std::numbers::pi * (i + 0.5) / kDirections;
    phase.add(1, dot(direction_, {std::cos(azimuth), std::sin(azimuth), 0}));
  }
  AirSpectrum out = path.scattered(*sun_, near, cloud(), haze()).per_sr(phase);
  multiply(out, whole_);
  return out;
}

AirSpectrum SunLight::sky_on_level() const {
  const IncidentRadiance::Sunlight& light = *around().light;
  const std::vector<double> weight = level_weights(weather_.sky);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t node = 0; node < weight.size() * azimuths_; ++node) {
    const double share = weight[node / azimuths_] / azimuths_;
    for (std::size_t j = 0; j < wavelengths_.used.size(); ++j)
      out[wavelengths_.used[j]] += share * static_cast<double>(light.air.row(node)[j]);
  }
  return out;
}

AirSpectrum SunLight::scattered_by(const PathLayers& path, Vec<Body> towards) const {
  const ScatteredSun source = path.scattered(*sun_, nullptr, cloud(), haze());
  const double cosine = -dot(direction_, towards);
  AirSpectrum s = whole_;
  for (std::size_t b = 0; b < kAirBandCount; ++b) s[b] *= source.per_sr(b, cosine);
  return s;
}

}  // namespace irsig
