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

double DetectorIntegrals::snr(double signal_sum, double photons_sum) const {
  const double kept = well > 0 && photons_sum > well ? well / photons_sum : 1;
  const double variance = constant + kept * photons_sum;
  return variance > 0 ? kept * signal_sum / std::sqrt(variance) : 0;
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
