#include "core/detector/detector.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/constants.h"
#include "core/spectral/planck.h"

namespace irsig {
namespace {

// Photons per joule go as the wavelength: times a response that is linear, a parabola, of which
// chords of this share of the wavelength miss 1e-7 even where a narrow window begins at 0.
constexpr double kChord = 1e-4;

double area_m2(double diameter_m) { return std::numbers::pi * diameter_m * diameter_m / 4; }

}  // namespace

std::vector<SpectralPoint> product(const std::vector<SpectralPoint>& a,
                                   const std::vector<SpectralPoint>& b) {
  // A product of two straight lines is a parabola: so many chords that they miss 1e-7 of its
  // largest value.
  constexpr double kMiss = 1e-7;
  const double low = std::max(a.front().lambda_um, b.front().lambda_um),
               high = std::min(a.back().lambda_um, b.back().lambda_um);
  if (!(low < high)) return {};
  std::vector<double> um = {low, high};
  for (const auto* table : {&a, &b})
    for (const SpectralPoint& p : *table)
      if (p.lambda_um > low && p.lambda_um < high) um.push_back(p.lambda_um);
  std::sort(um.begin(), um.end());
  um.erase(std::unique(um.begin(), um.end()), um.end());
  const auto value = [](const std::vector<SpectralPoint>& table, double at) {
    const auto above =
        std::upper_bound(table.begin() + 1, table.end() - 1, at,
                         [](double x, const SpectralPoint& p) { return x < p.lambda_um; });
    const SpectralPoint &p = *(above - 1), &q = *above;
    return p.value + (q.value - p.value) * (at - p.lambda_um) / (q.lambda_um - p.lambda_um);
  };
  std::vector<SpectralPoint> out;
  double most = 0;
  for (const double at : um) {
    out.push_back({at, value(a, at) * value(b, at)});
    most = std::max(most, out.back().value);
  }
  std::vector<SpectralPoint> fine;
  bool any = false;
  for (std::size_t i = 0; i + 1 < um.size(); ++i) {
    const double from_a = value(a, um[i]), by_a = value(a, um[i + 1]) - from_a,
                 from_b = value(b, um[i]), by_b = value(b, um[i + 1]) - from_b;
    const double scale = std::max(most, std::abs(by_a * by_b) / 4);
    const int pieces = scale > 0 ? std::max(1, static_cast<int>(std::ceil(std::sqrt(
                                                   std::abs(by_a * by_b) / (4 * kMiss * scale)))))
                                 : 1;
    for (int k = 0; k < pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      fine.push_back(
          {um[i] + share * (um[i + 1] - um[i]), (from_a + share * by_a) * (from_b + share * by_b)});
      any |= fine.back().value > 0;
    }
  }
  fine.push_back(out.back());
  any |= fine.back().value > 0;
  return any ? fine : std::vector<SpectralPoint>();
}

DetectorIntegrals integrals_of(const Detector& detector) {
  if (const auto* noise = std::get_if<ConstantNoise>(&detector.noise))
    return {detector.response, {}, noise->nei_w_m2 * noise->nei_w_m2, 0};
  const auto& noise = std::get<PhotonNoise>(detector.noise);
  const double electrons = area_m2(noise.aperture_m) * noise.transmittance * noise.integration_s *
                           1e-6 / (kPlanckJS * kLightSpeedMS);  // per joule / m2 and um
  const double pixel_rad = noise.pixel_m / (noise.f_number * noise.aperture_m);
  DetectorIntegrals out;
  out.constant = noise.read_electrons * noise.read_electrons;
  out.well = noise.well_electrons;
  const auto& table = detector.response;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto add = [&](double um, double efficiency) {
      const double value = electrons * efficiency * um;
      out.signal.push_back({um, value});
      out.photons.push_back({um, value * pixel_rad * pixel_rad});
    };
    add(table[i].lambda_um, table[i].value);
    if (i + 1 == table.size()) break;
    const SpectralPoint &a = table[i], &b = table[i + 1];
    const double width = b.lambda_um - a.lambda_um;
    const auto pieces = static_cast<int>(std::ceil(width / (kChord * a.lambda_um)));
    for (int k = 1; k < pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      add(a.lambda_um + share * width, a.value + share * (b.value - a.value));
    }
  }
  return out;
}

double nei_of_netd_w_m2(const std::vector<SpectralPoint>& response, double netd_k,
                        double temperature_k, double stated_f_number, double f_number,
                        double pixel_sr) {
  // Simpson's rule on pieces over which dL/dT is smooth.
  double per_k = 0;
  for (std::size_t i = 0; i + 1 < response.size(); ++i) {
    const SpectralPoint &a = response[i], &b = response[i + 1];
    const double width = b.lambda_um - a.lambda_um;
    const int pieces = std::max(1, static_cast<int>(std::ceil(width / (0.005 * a.lambda_um))));
    const auto value = [&](double share) {
      const double um = a.lambda_um + share * width;
      return (a.value + share * (b.value - a.value)) *
             planck_radiance_derivative_w_m2_sr_um_k(um, temperature_k);
    };
    for (int k = 0; k < pieces; ++k)
      per_k += width / (6 * pieces) *
               (value(static_cast<double>(k) / pieces) + 4 * value((k + 0.5) / pieces) +
                value((k + 1.0) / pieces));
  }
  return netd_k * std::pow(f_number / stated_f_number, 2) * pixel_sr * per_k;
}

double nei_of_d_star_w_m2(double d_star_m_hz05_w, double detector_m2, double bandwidth_hz,
                          double aperture_m, double transmittance) {
  return std::sqrt(detector_m2 * bandwidth_hz) /
         (d_star_m_hz05_w * area_m2(aperture_m) * transmittance);
}

}  // namespace irsig
