#pragma once

#include <variant>
#include <vector>

#include "core/spectral/band.h"

namespace irsig {

// Noise that does not depend on the light: of irradiance at the aperture, weighted with the
// response.
struct ConstantNoise {
  double nei_w_m2;
};

// Noise of the background's photons and of reading them out, one pixel: the response is a quantum
// efficiency.
struct PhotonNoise {
  double aperture_m;  // diameter
  double transmittance, f_number, pixel_m, integration_s;
  double well_electrons;  // the background fills it at most: the integration ends before
  double read_electrons;
};

// response: linear between its points, 0 outside them.
struct Detector {
  std::vector<SpectralPoint> response;
  std::variant<ConstantNoise, PhotonNoise> noise;
};

// A detector as integrals over wavelength:
//
//   signal      s = integral of signal(lambda) E(lambda)          E: irradiance [W/(m2 um)]
//   variance    v = constant + integral of photons(lambda) L(lambda)
//                                                L: radiance around the target [W/(m2 sr um)]
//
// For constant noise signal is the response, constant = NEI^2, photons is empty. For photons
//
//   s = A tau t integral of eta E lambda / (h c)       electrons; A = pi D^2 / 4
//   v = N + read^2,  N = A tau t (p / (F D))^2 integral of eta L lambda / (h c)     [dereniak1996,
//   5]
//
// and where N is more than the well w, the integration ends early: s and N become w / N of it.
// Tables are linear between points that lie densely enough for 1e-7 of any integral.
struct DetectorIntegrals {
  std::vector<SpectralPoint> signal, photons;
  double constant = 0, well = 0;  // well: 0, none

  // Returns the variance of the noise beside a signal. Argument and result refer to the full
  // integration time. If the well is full earlier, the detector integrates k = N / w times as
  // often, and v = k^2 constant + k N.
  [[nodiscard]] double variance(double photons_sum) const {
    const double k = well > 0 && photons_sum > well ? photons_sum / well : 1;
    return k * (k * constant + photons_sum);
  }
};
[[nodiscard]] DetectorIntegrals integrals_of(const Detector& detector);

// Returns the product of two responses where both are stated; empty without a common range. Its
// points lie densely enough for 1e-7 of any integral.
[[nodiscard]] std::vector<SpectralPoint> product(const std::vector<SpectralPoint>& a,
                                                 const std::vector<SpectralPoint>& b);

// Computes a noise-equivalent irradiance from other figures of detectors.
//
// NETD of an extended scene at temperature_k, at stated_f_number; noise-equivalent radiance goes as
// F^2:  NEI = NETD (F / F_stated)^2 Omega integral of r dL/dT,  Omega the solid angle of a pixel.
[[nodiscard]] double nei_of_netd_w_m2(const std::vector<SpectralPoint>& response, double netd_k,
                                      double temperature_k, double stated_f_number, double f_number,
                                      double pixel_sr);
// Computes it from the specific detectivity at its peak, an area and a bandwidth:
//   NEI = sqrt(A_d B) / (D* A tau),  A = pi D^2 / 4
//   d_star_m_hz05_w  1 cm sqrt(Hz) / W = 0.01 m sqrt(Hz) / W
[[nodiscard]] double nei_of_d_star_w_m2(double d_star_m_hz05_w, double detector_m2,
                                        double bandwidth_hz, double aperture_m,
                                        double transmittance);

}  // namespace irsig
