#pragma once

// Light of air in which it is scattered many times, for the tests of fog and haze.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/atmosphere/light_path.h"
#include "core/environment/weather_air.h"
#include "core/geo/frames.h"
#include "core/spectral/planck.h"

namespace irsig::air_photons {

inline constexpr double kObserverM = 2;
inline constexpr int kPhotons = 40000;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Temperature of a black body with this radiance in the middle of a band. [K]
inline double kelvin(std::size_t band, double radiance) {
  const double um = air_band_lambda_um(band);
  double low = 100, high = 400;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (planck_radiance_w_m2_sr_um(um, middle) < radiance ? low : high) = middle;
  }
  return low;
}

// Photons followed backwards from an observer near the ground, in one band: through particles with
// Henyey and Greenstein's full phase function, as often as they are scattered, and the air's lines
// grey in the band. Molecules do not scatter. Above the column is the air without its particles.
class AirPhotons {
 public:
  // Default azimuth of the direction of sight. [rad]
  static constexpr double kAzimuth = 1.5;
  //   top_m, step_m  of the column; layers of step_m
  AirPhotons(const WeatherSpec& weather, std::size_t band, double top_m = kFogTopM,
             double step_m = 25, AerosolKind above = AerosolKind::kRural)
      : band_(band),
        top_m_(top_m),
        step_m_(step_m),
        ground_k_(weather.lower.temperature_k),
        ground_albedo_(1 - weather.lower.emissivity) {
    const Atmosphere air = Atmosphere::make(weather.air).value();
    AtmosphereSpec without = weather.air;
    without.aerosol.kind = above;
    const Atmosphere clear = Atmosphere::make(std::move(without)).value();
    double depth = 0, particles = 0;
    for (double z = 0; z < top_m_; z += step_m_) {
      const AbsorberAmounts to_here = air.amounts(look(air.profile(), 0, 0, z + step_m_, false));
      const double scattering = to_here.grey(GreyAbsorber::kAerosolScattering)[band];
      const double here = -std::log(transmittance(to_here)[band]);
      const AerosolOptics optics =
          aerosol_optics(weather.air.aerosol, z + 0.5 * step_m_,
                         relative_humidity_percent(air_at(air.profile(), z + 0.5 * step_m_)),
                         air.surface_humidity_percent());
      layer_.push_back({here - depth, (scattering - particles) / (here - depth),
                        optics.asymmetry[band],
                        planck(air_at(air.profile(), z + 0.5 * step_m_).temperature_k)});
      depth = here;
      particles = scattering;
    }
    for (int i = 0; i < kSkies; ++i) {
      const double zenith_deg = std::acos((i + 0.5) / kSkies) * 180 / M_PI;
      above_.push_back(clear.sky_radiance(top_m_, zenith_deg).total_w_m2_sr_um[band]);
    }
  }

  struct Light {
    double thermal = 0, sun_per_sr = 0;
  };
  //   cosine   of the direction of sight's zenith angle
  //   range_m  behind which the path's own light ends
  //   per_m    extinction of the path up to the first collision, where it is level; 0: the layers'
  //   sun      cosine of its zenith angle; its irradiance normal to the beam at the top is 1
  //   azimuth  of the direction of sight, from the sun's  [rad]
  [[nodiscard]] Light seen(double cosine, double range_m, double sun, double per_m,
                           double azimuth = kAzimuth, int photons = kPhotons) const {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> u;
    Light sum;
    for (int i = 0; i < photons; ++i) {
      Vec<Body> d{std::sqrt(1 - cosine * cosine) * std::cos(azimuth),
                  std::sqrt(1 - cosine * cosine) * std::sin(azimuth), cosine};
      double z = kObserverM;
      for (bool first = true;; first = false) {
        const double depth = -std::log(1 - u(random));
        const bool level = first && per_m > 0;
        if (level ? depth > per_m * range_m : advance(z, d.z, depth) > range_m && first) break;
        if (z >= top_m_) {
          sum.thermal +=
              above_[std::min<std::size_t>(static_cast<std::size_t>(d.z * kSkies), kSkies - 1)];
          break;
        }
        if (z <= 0) {
          if (u(random) > ground_albedo_) {
            sum.thermal += planck(ground_k_);
            break;
          }
          sum.sun_per_sr += std::exp(-depth_above(0) / sun) * sun / M_PI;
          const double up = std::sqrt(u(random)), turn = 2 * M_PI * u(random);
          d = {std::sqrt(1 - up * up) * std::cos(turn), std::sqrt(1 - up * up) * std::sin(turn),
               up};
          z = 1e-9;
          continue;
        }
        const Layer& here = layer_[index(z)];
        const double albedo = level ? here.albedo * here.depth / (step_m_ * per_m) : here.albedo;
        if (u(random) > albedo) {
          sum.thermal += here.planck;
          break;
        }
        const double to_sun = d.x * std::sqrt(1 - sun * sun) + d.z * sun;
        const double g = here.asymmetry, e = 1 + g * g - 2 * g * to_sun;
        sum.sun_per_sr +=
            std::exp(-depth_above(z) / sun) * (1 - g * g) / (4 * M_PI * e * std::sqrt(e));
        d = turned(d, g, u(random), 2 * M_PI * u(random));
      }
    }
    return {sum.thermal / photons, sum.sun_per_sr / photons};
  }

 private:
  static constexpr int kSkies = 8;
  struct Layer {
    double depth, albedo, asymmetry, planck;
  };

  [[nodiscard]] double planck(double kelvin) const {
    return planck_radiance_w_m2_sr_um(air_band_lambda_um(band_), kelvin);
  }
  [[nodiscard]] std::size_t index(double z) const {
    return std::min(static_cast<std::size_t>(z / step_m_), layer_.size() - 1);
  }
  [[nodiscard]] double depth_above(double z) const {
    double sum = 0;
    for (std::size_t i = index(z); i < layer_.size(); ++i)
      sum += layer_[i].depth * (i == index(z) ? (static_cast<double>(i) + 1) - z / step_m_ : 1);
    return sum;
  }
  // Moves z along a direction by an optical depth, or to a boundary; returns the way. [m]
  [[nodiscard]] double advance(double& z, double rise, double depth) const {
    double way = 0;
    for (;;) {
      const std::size_t i = index(z);
      const double per_m = layer_[i].depth / step_m_;
      const double edge =
          rise > 0 ? (static_cast<double>(i) + 1) * step_m_ : static_cast<double>(i) * step_m_;
      const double to_edge = std::abs(rise) > 1e-12 ? (edge - z) / rise : kInfinity;
      if (per_m * to_edge >= depth) {
        z += rise * depth / per_m;
        return way + depth / per_m;
      }
      depth -= per_m * to_edge;
      way += to_edge;
      z = edge + (rise > 0 ? 1e-9 : -1e-9);
      if (z <= 0 || z >= top_m_) return way;
    }
  }
  static Vec<Body> turned(const Vec<Body>& d, double g, double u, double azimuth) {
    const double s = (1 - g * g) / (1 - g + 2 * g * u);
    const double cosine = (1 + g * g - s * s) / (2 * g);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const Vec<Body> axis = std::abs(d.z) < 0.9 ? Vec<Body>{0, 0, 1} : Vec<Body>{1, 0, 0};
    const Vec<Body> p = normalized(cross(d, axis)), q = cross(d, p);
    return normalized(cosine * d + sine * std::cos(azimuth) * p + sine * std::sin(azimuth) * q);
  }

  std::size_t band_;
  double top_m_, step_m_, ground_k_, ground_albedo_;
  std::vector<Layer> layer_;  // from the ground up
  std::vector<double> above_;
};

}  // namespace irsig::air_photons
