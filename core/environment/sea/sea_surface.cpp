#include "core/environment/sea/sea_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "core/base/check.h"
#include "core/base/clones.h"
#include "core/materials/fresnel.h"
#include "core/materials/optical/material_library.h"
#include "core/materials/spectra.h"

namespace irsig {
namespace {

// Rings of equal probability, each with its mean square slope, times directions of the slope.
// Against four times as many of both: emissivities within 5e-4 down to 1 deg of elevation
// (tests/physics/environment_sea_test.cpp).
constexpr int kSlopeRings = 16, kSlopeDirections = 32;

const OpticalConstants& water() {
  static const OpticalConstants constants = [] {
    const absl::StatusOr<LibraryEntry> entry = library_entry("sea_water");
    IRSIG_CHECK(entry.ok());
    return std::get<CookTorrance>(entry->spec.model).constants;
  }();
  return constants;
}

Vec<Body> mirror(Vec<Body> v, Vec<Body> normal) { return 2 * dot(v, normal) * normal - v; }

constexpr double kSlopePerMS = 0.00512;  // [cox1954]

// -x ln x + x: the integral of -ln from 0.
double integral_of_minus_ln(double x) { return x > 0 ? x - x * std::log(x) : 0; }

}  // namespace

double sea_slope_variance(double wind_speed_m_s) {
  return 0.003 + kSlopePerMS * std::min(wind_speed_m_s, kMostSlopeWindMS);
}

std::complex<double> sea_water_index(double lambda_um) {
  const OpticalConstant c = constants_at(water(), lambda_um);
  return {c.n, c.k};
}

double water_reflectance(std::complex<double> index, double cos_incidence) {
  return fresnel_exact(std::clamp(cos_incidence, 0.0, 1.0), index.real(), index.imag());
}

WaterSpectrum sea_water_spectrum(const std::vector<double>& lambda_um) {
  WaterSpectrum out;
  for (const double um : lambda_um) {
    const std::complex<double> squared = sea_water_index(um) * sea_water_index(um);
    out.real.push_back(squared.real());
    out.imaginary.push_back(squared.imag());
  }
  return out;
}

IRSIG_CLONES void water_reflectance(const WaterSpectrum& water, double cos_incidence,
                                    std::size_t first, std::span<double> out) {
  const double c = std::clamp(cos_incidence, 0.0, 1.0), sin2 = 1 - c * c;
  const double *real = water.real.data() + first, *imaginary = water.imaginary.data() + first;
  const std::size_t n = out.size();
  double* rho = out.data();
#pragma GCC ivdep
  for (std::size_t i = 0; i < n; ++i) {
    // a + ib: the root of index^2 - sin^2, whose real part is positive for water.
    const double e = real[i], f = imaginary[i], x = e - sin2;
    const double a = std::sqrt(0.5 * (std::sqrt(x * x + f * f) + x)), b = 0.5 * f / a;
    const auto norm = [](double re, double im) { return re * re + im * im; };
    rho[i] = 0.5 * (norm(c - a, b) / norm(c + a, b) +
                    norm(e * c - a, f * c - b) / norm(e * c + a, f * c + b));
  }
}

std::vector<SeaFacet> flat_sea(Vec<Body> to_observer) {
  return {{1, -to_observer.z, {-to_observer.x, -to_observer.y, to_observer.z}}};
}

std::vector<SeaFacet> sea_facets(Vec<Body> to_observer, double wind_speed_m_s) {
  IRSIG_CHECK(to_observer.z < 0);
  const double variance = sea_slope_variance(wind_speed_m_s);
  const double azimuth = std::atan2(to_observer.y, to_observer.x);
  std::vector<SeaFacet> facet;
  double sum = 0;
  for (int i = 0; i < kSlopeRings; ++i) {
    // tan^2 is distributed exponentially with mean `variance`.
    const double a = static_cast<double>(i) / kSlopeRings;
    const double b = static_cast<double>(i + 1) / kSlopeRings;
    const double slope =
        std::sqrt(variance * kSlopeRings * (integral_of_minus_ln(b) - integral_of_minus_ln(a)));
    const double up = 1 / std::sqrt(1 + slope * slope);
    for (int j = 0; j < kSlopeDirections; ++j) {
      const double turn = azimuth + 2 * std::numbers::pi * (j + 0.5) / kSlopeDirections;
      const Vec<Body> normal = {up * slope * std::cos(turn), up * slope * std::sin(turn), -up};
      const double cosine = dot(normal, to_observer);
      if (cosine <= 0) continue;
      sum += cosine / up;
      facet.push_back({cosine / up, cosine, mirror(to_observer, normal)});
    }
  }
  for (SeaFacet& f : facet) f.share /= sum;
  return facet;
}

double glint_per_sr(Vec<Body> to_observer, Vec<Body> to_sun, double wind_speed_m_s) {
  const Vec<Body> normal = normalized(to_observer + to_sun);
  const double up = -normal.z;
  if (up <= 0 || to_sun.z >= 0 || dot(normal, to_observer) <= 0) return 0;
  const double variance = sea_slope_variance(wind_speed_m_s);
  const double tan2 = 1 / (up * up) - 1;
  const double density = std::exp(-tan2 / variance) / (std::numbers::pi * variance);
  return density / (4 * up * up * up * up * sea_projected_area(-to_observer.z, wind_speed_m_s));
}

double glint_model_relative(Vec<Body> to_observer, Vec<Body> to_sun, double wind_speed_m_s) {
  const double variance_error =
      0.004 + kSlopePerMS * std::max(0.0, wind_speed_m_s - kMostSlopeWindMS);
  const double variance = sea_slope_variance(wind_speed_m_s);
  const Vec<Body> normal = normalized(to_observer + to_sun);
  const double tan2 = 1 / std::max(normal.z * normal.z, 1e-12) - 1;
  // A slope along one axis has half of the variance.
  const auto hidden = [&](Vec<Body> towards) {
    const double up = std::max(-towards.z, 1e-6);
    const double v = up / std::sqrt(std::max(1e-12, 1 - up * up) * variance);
    return std::max(0.0, 0.5 * (std::numbers::inv_sqrtpi * std::exp(-v * v) / v - std::erfc(v)));
  };
  const double of_sun = hidden(to_sun);
  return std::hypot(variance_error / variance * std::abs(tan2 / variance - 1),
                    of_sun / (1 + hidden(to_observer) + of_sun));
}

// Facets towards the observer: cos (1 + erf(q)) / 2 + sin sqrt(variance) exp(-q^2) / (2 sqrt(pi)),
// q = cot / sqrt(variance): the mean of max(0, cos + sin slope) over a Gaussian slope.
double sea_projected_area(double cos_zenith, double wind_speed_m_s) {
  const double variance = sea_slope_variance(wind_speed_m_s);
  const double sine = std::sqrt(std::max(0.0, 1 - cos_zenith * cos_zenith));
  const double width = sine * std::sqrt(variance);
  if (width <= 0) return cos_zenith;
  const double q = cos_zenith / width;
  return 0.5 * cos_zenith * (1 + std::erf(q)) +
         0.5 * std::numbers::inv_sqrtpi * width * std::exp(-q * q);
}

}  // namespace irsig
