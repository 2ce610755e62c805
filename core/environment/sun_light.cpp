#include "core/environment/sun_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/environment/interpolation_error.h"
#include "core/spectral/solar.h"

namespace irsig {
namespace {

// Directions within half the hat of a node, in sine and in azimuth, over which the aureole is
// averaged.
constexpr int kHatSines = 4, kHatAzimuths = 6;

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

// Solves a symmetric tridiagonal system, periodic if the last corner is given: rows of a dense
// inverse, for systems of some ten unknowns with hundreds of right-hand sides.
std::vector<std::vector<double>> inverse(std::vector<std::vector<double>> m) {
  const std::size_t n = m.size();
  std::vector<std::vector<double>> out(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) out[i][i] = 1;
  for (std::size_t i = 0; i < n; ++i) {  // diagonally dominant: no pivoting
    const double pivot = m[i][i];
    for (std::size_t k = 0; k < n; ++k) {
      m[i][k] /= pivot;
      out[i][k] /= pivot;
    }
    for (std::size_t j = 0; j < n; ++j) {
      const double f = m[j][i];
      if (j == i || f == 0) continue;
      for (std::size_t k = 0; k < n; ++k) {
        m[j][k] -= f * m[i][k];
        out[j][k] -= f * out[i][k];
      }
    }
  }
  return out;
}

// From means over hats to the values at the nodes whose linear interpolation has those means: the
// best fit, which keeps energy and hardly blurs what lobes wider than a hat see of it.
void fit_to_hats(std::vector<AirSpectrum>& node, const std::vector<double>& sine,
                 std::uint32_t azimuths) {
  const std::size_t rings = sine.size();
  std::vector<std::vector<double>> up(rings, std::vector<double>(rings, 0.0));
  for (std::size_t r = 0; r < rings; ++r) {
    const double below = r > 0 ? sine[r] - sine[r - 1] : 0;
    const double above = r + 1 < rings ? sine[r + 1] - sine[r] : 0;
    up[r][r] = 2.0 / 3;
    if (r > 0) up[r][r - 1] = below / (below + above) / 3;
    if (r + 1 < rings) up[r][r + 1] = above / (below + above) / 3;
  }
  up = inverse(std::move(up));
  std::vector<std::vector<double>> around(azimuths, std::vector<double>(azimuths, 0.0));
  for (std::uint32_t a = 0; a < azimuths; ++a) {
    around[a][a] += 2.0 / 3;
    around[a][(a + 1) % azimuths] += 1.0 / 6;
    around[a][(a + azimuths - 1) % azimuths] += 1.0 / 6;
  }
  around = inverse(std::move(around));
  std::vector<AirSpectrum> half(node.size(), AirSpectrum(kAirBandCount, 0.0)), whole = half;
  const auto add = [](AirSpectrum& to, double f, const AirSpectrum& from) {
    if (std::abs(f) < 1e-9) return;
    for (std::size_t b = 0; b < kAirBandCount; ++b) to[b] += f * from[b];
  };
  for (std::size_t r = 0; r < rings; ++r) {
    for (std::uint32_t a = 0; a < azimuths; ++a) {
      for (std::uint32_t k = 0; k < azimuths; ++k) {
        add(half[r * azimuths + a], around[a][k], node[r * azimuths + k]);
      }
    }
  }
  for (std::size_t r = 0; r < rings; ++r) {
    for (std::size_t k = 0; k < rings; ++k) {
      for (std::uint32_t a = 0; a < azimuths; ++a) {
        add(whole[r * azimuths + a], up[r][k], half[k * azimuths + a]);
      }
    }
  }
  node = std::move(whole);
}

}  // namespace

SunLight::SunLight(const ConditionEnvironment& condition, const WeatherLight& weather,
                   const LowerSpec& surface, const Atmosphere& atmosphere, double height_m,
                   const DirectionNodes& nodes, const BandChoice& bands)
    : direction_(condition.sun_direction), height_m_(height_m), surface_(surface), bands_(bands) {
  outside = irradiance = AirSpectrum(kAirBandCount, 0.0);
  sky_model_relative = mean_relative(weather.sky_model_error, weather.sky_mean);
  if (!condition.sun || direction_.z >= 0) return;
  sun_.emplace(atmosphere, height_m, std::acos(std::clamp(-direction_.z, -1.0, 1.0)) / kRadPerDeg);
  if (!sun_->lit()) {
    sun_.reset();
    return;
  }
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    outside[b] = solar_irradiance_w_m2_um(air_band_lambda_um(b)) /
                 (condition.sun_distance_au * condition.sun_distance_au);
  }
  near_ = irradiance = joined(AbsorberAmounts());
  multiply(irradiance, outside);

  const std::uint32_t azimuths = nodes.azimuths();
  const std::vector<PhaseMean> phase = phases(sines_of(weather.sky), 1, azimuths);
  for (std::size_t r = 0; r < weather.sky.size(); ++r) {
    sky_source_.push_back(weather.sky[r].layers.scattered(*sun_));
    for (std::uint32_t a = 0; a < azimuths; ++a) {
      sky.push_back(sky_source_[r].per_sr(phase[r * azimuths + a]));
      multiply(sky.back(), outside);
    }
  }
  fit_to_hats(sky, sines_of(weather.sky), azimuths);
  sky_interpolation = weather.sky_interpolation + sky_error(weather, azimuths);

  AirSpectrum mean = weather.sky_mean, error = weather.sky_model_error;
  const std::vector<double> weight = ring_weights(sines_of(weather.sky));
  for (std::size_t n = 0; n < sky.size(); ++n) {
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      const double part = weight[n / azimuths] / azimuths * sky[n][b];
      mean[b] += part;
      error[b] += kAerosolRelativeError * part;
    }
  }
  sky_model_relative = mean_relative(error, mean);

  const std::vector<PhaseMean> below = phases(sines_of(weather.lower), -1, azimuths);
  for (std::size_t r = 0; r < weather.lower.size(); ++r) {
    const LowerRing& ring = weather.lower[r];
    far_.push_back(joined(ring.layers.amounts()));
    const ScatteredSun air = ring.layers.scattered(*sun_);
    for (std::uint32_t a = 0; a < azimuths; ++a) {
      lower_air.push_back(air.per_sr(below[r * azimuths + a]));
      multiply(lower_air.back(), outside);
      AirSpectrum mirrored(kAirBandCount, 0.0);
      for (const LowerRing::Cell& cell : ring.cell) {
        const AirSpectrum& from = sky[cell.ring * azimuths + (a + cell.turn) % azimuths];
        for (std::size_t b = 0; b < kAirBandCount; ++b) mirrored[b] += cell.weight[b] * from[b];
      }
      // Let through as sunlight is, whose lines it carries.
      multiply(mirrored, quotient(far_[r], near_));
      const double diffuse = diffuse_per_sr();
      for (std::size_t b = 0; b < kAirBandCount; ++b) {
        mirrored[b] += diffuse * outside[b] * far_[r][b];
      }
      lower_surface.push_back(std::move(mirrored));
    }
  }
  lower_interpolation = weather.lower_interpolation;
}

// Transmittance from the sun to the target's height and through further air.
AirSpectrum SunLight::joined(const AbsorberAmounts& amounts) const {
  AbsorberAmounts sum = amounts;
  return sun_->add_to(sum, height_m_) ? transmittance(sum, bands_)
                                      : AirSpectrum(kAirBandCount, 0.0);
}

// up: 1 above the horizon, -1 below.
std::vector<PhaseMean> SunLight::phases(const std::vector<double>& sine, double up,
                                        std::uint32_t azimuths) const {
  std::vector<PhaseMean> phase(sine.size() * azimuths);
  for (std::size_t r = 0; r < sine.size(); ++r) {
    for (std::uint32_t a = 0; a < azimuths; ++a) {
      over_hat(sine, r, a, azimuths, [&](double weight, double s, double azimuth) {
        phase[r * azimuths + a].add(weight, dot(direction_of(up * s, azimuth), direction_));
      });
    }
  }
  return phase;
}

AirSpectrum SunLight::sky_towards(Vec<Body> direction, std::size_t ring, double f) const {
  const double cosine = dot(direction, direction_);
  AirSpectrum out(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    out[b] = (1 - f) * sky_source_[ring].per_sr(b, cosine);
    if (f > 0) out[b] += f * sky_source_[ring + 1].per_sr(b, cosine);
    out[b] *= outside[b];
  }
  return out;
}

AirSpectrum SunLight::glint_towards(Vec<Body> direction, std::size_t ring, double f) const {
  AirSpectrum out(kAirBandCount, 0.0);
  if (surface_.kind != LowerSpec::Kind::kRoughSea || !(surface_.wind_speed_m_s > 0)) return out;
  const Vec<Body> to_observer = -1.0 * direction;
  const double per_sr = glint_per_sr(to_observer, direction_, surface_.wind_speed_m_s);
  const double cosine = dot(normalized(to_observer + direction_), direction_);
  for (std::size_t b = 0; per_sr > 0 && b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    const double through = f > 0 ? (1 - f) * far_[ring][b] + f * far_[ring + 1][b] : far_[ring][b];
    out[b] = per_sr * outside[b] * through *
             water_reflectance(sea_water_index(air_band_lambda_um(b)), cosine);
  }
  return out;
}

double SunLight::diffuse_per_sr() const {
  const bool diffuse =
      surface_.kind == LowerSpec::Kind::kGreySea || surface_.kind == LowerSpec::Kind::kGround;
  return diffuse ? (1 - surface_.emissivity) * -direction_.z * std::numbers::inv_pi : 0;
}

// In the three quarters of a micrometre where scattered sunlight has the largest part, each by one
// band.
double SunLight::sky_error(const WeatherLight& weather, std::uint32_t azimuths) const {
  std::vector<double> part;
  std::vector<std::size_t> band;
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    if (!chosen(bands_, b)) continue;
    const auto quarter = static_cast<std::size_t>(4 * air_band_lambda_um(b));
    if (quarter >= part.size()) {
      part.resize(quarter + 1, 0.0);
      band.resize(quarter + 1, 0);
    }
    const double solar =
        (sky_source_.back().aerosol[b] + sky_source_.back().molecular[b]) * outside[b];
    const double share =
        ratio_of(solar, solar + 4 * std::numbers::pi * weather.sky.back().total[b]);
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
  if (quarters.size() > 3) quarters.resize(3);
  if (quarters.empty()) return 0;

  // Lobes about directions spread evenly over the hemisphere.
  constexpr std::uint32_t kLobes = 40, kPerInterval = 2, kPerTurn = 5;
  std::vector<Vec<Body>> lobe;
  for (std::uint32_t i = 0; i < kLobes; ++i) {
    lobe.push_back(direction_of((i + 0.5) / kLobes, i * 2.399963229728653));
  }
  std::vector<double> error(quarters.size() * kLobes, 0.0), radiance = error;
  for (std::size_t r = 0; r + 1 < weather.sky.size(); ++r) {
    const double low = weather.sky[r].sin_elevation, high = weather.sky[r + 1].sin_elevation;
    for (std::uint32_t i = 0; i < kPerInterval * azimuths * kPerTurn; ++i) {
      const double f = (i % kPerInterval + 0.5) / kPerInterval;
      const double turn = (i / kPerInterval + 0.5) / kPerTurn;
      const auto a = static_cast<std::uint32_t>(turn);
      const double g = turn - a;
      const Vec<Body> d = direction_of(low + f * (high - low), turn * kTurn / azimuths);
      const double cosine = dot(d, direction_);
      for (std::size_t q = 0; q < quarters.size(); ++q) {
        const std::size_t b = band[quarters[q]];
        const double direct = outside[b] * ((1 - f) * sky_source_[r].per_sr(b, cosine) +
                                            f * sky_source_[r + 1].per_sr(b, cosine));
        const auto node = [&](std::size_t ring) {
          return (1 - g) * sky[ring * azimuths + a][b] +
                 g * sky[ring * azimuths + (a + 1) % azimuths][b];
        };
        const double linear = (1 - f) * node(r) + f * node(r + 1);
        const double thermal = (1 - f) * weather.sky[r].total[b] + f * weather.sky[r + 1].total[b];
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
  return worst;
}

SunLight::Near SunLight::behind(const AbsorberAmounts& near, const WeatherLight& weather) const {
  Near out;
  const AirSpectrum near_end = joined(near);
  out.irradiance = near_end;
  multiply(out.irradiance, outside);
  for (std::size_t r = 0; r < weather.lower.size(); ++r) {
    const AirSpectrum far_end = joined(weather.lower[r].layers.amounts() + near);
    AirSpectrum air(kAirBandCount, 0.0);
    for (std::size_t b = 0; b < kAirBandCount; ++b) {
      air[b] = ratio_of(mean_of_sunlight(near_end[b], far_end[b], 0),
                        mean_of_sunlight(near_[b], far_[r][b], 0));
    }
    out.lower_air.push_back(std::move(air));
    out.lower_surface.push_back(quotient(far_end, far_[r]));
  }
  return out;
}

AirSpectrum SunLight::sky_ratio(std::size_t ring, const AbsorberAmounts& near,
                                const WeatherLight& weather) const {
  const ScatteredSun seen = weather.sky[ring].layers.scattered(*sun_, &near);
  AirSpectrum ratio(kAirBandCount, 0.0);
  for (std::size_t b = 0; b < kAirBandCount; ++b) {
    ratio[b] = ratio_of(seen.aerosol[b] + seen.molecular[b],
                        sky_source_[ring].aerosol[b] + sky_source_[ring].molecular[b]);
  }
  return ratio;
}

AirSpectrum SunLight::scattered_by(const PathLayers& path, Vec<Body> towards) const {
  const ScatteredSun source = path.scattered(*sun_);
  const double cosine = -dot(direction_, towards);
  AirSpectrum s = outside;
  for (std::size_t b = 0; b < kAirBandCount; ++b) s[b] *= source.per_sr(b, cosine);
  return s;
}

}  // namespace irsig
