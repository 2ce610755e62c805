#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace irsig {

struct SpectralPoint {
  double lambda_um;
  double value;
};

// A detector band as the user states it. An empty response means 1 inside the limits; a tabulated
// response is linear between its points and 0 outside them.
struct Band {
  std::string name;
  double lambda_min_um;
  double lambda_max_um;
  double step_um;
  std::vector<SpectralPoint> response;
};

// The wavelengths at which a band is computed, and the weights that turn values there into stored
// bin means and into the in-band integral.
//
// Stored wavelengths: lambda_min + k step, k = 0 .. n (n = round((max - min) / step), step adjusted
// so that it divides the band exactly). Bin k is [lambda_k - step/2, lambda_k + step/2] (the outer
// half of the first and last bin lies outside the band). Bins are cut into panels of two
// Gauss-Legendre points, so the bins and the in-band integral share their nodes: at the middle, or,
// where the spectrum jumps at stated wavelengths, at those and at the limits of the band; at its
// corners; and at the response's points where it would leave one of the two nothing.
struct BandGrid {
  double step_um;                      // as adjusted
  std::vector<double> lambda_um;       // n+1 stored wavelengths
  std::vector<double> node_um;         // quadrature nodes, increasing: 4 (n+1) without jumps
  std::vector<std::size_t> bin_first;  // nodes bin_first[k] .. bin_first[k+1] - 1 belong to bin k
  std::vector<double> bin_weight;      // mean over bin k = sum of bin_weight[i] L(node_i) over them
  std::vector<double>
      band_weight;  // in-band integral = sum of band_weight[i] L(node_i) [um, response included]
};

// Makes a grid. band_weight is never negative; it integrates response x L exactly for every L that
// is linear over a panel, wherever the response has its corners.
// INVALID_ARGUMENT: limits that are reversed or not positive, a step that is not positive, wider
// than the band, or more than a million of them, a response that does not increase, is negative, or
// 0 everywhere in the band.
//   breaks_um   where spectra jump (the edges of the air's bands), increasing; others are ignored
//   corners_um  where they have corners (the points of materials' tables), likewise
[[nodiscard]] absl::StatusOr<BandGrid> make_band_grid(const Band& band,
                                                      std::span<const double> breaks_um = {},
                                                      std::span<const double> corners_um = {});

// Returns the response of the band at a wavelength (0 outside).
[[nodiscard]] double band_response(const Band& band, double lambda_um);

// Returns the temperature of the blackbody with the given in-band radiance through the band's
// response (relative response: the integral of response x L_b). Closed form for an empty response,
// quadrature otherwise. 0 for radiance 0. NaN for a radiance that no blackbody has: negative, not
// finite, or above that at kPlanckTemperatureMaxK. Callers that store the temperature must check it
// (runner/check_numbers.h).
[[nodiscard]] double radiance_temperature_k(const Band& band, const BandGrid& grid,
                                            double radiance_w_m2_sr);

// Returns the spectral quadrature bound: the largest difference, over [t_min_k, t_max_k], between
// the exact in-band integral of L_b and the grid's, relative to the grid's, found at 9
// temperatures. Measured for 240-800 K at 0.05 um steps: 1.1e-10 (3-5 um), 1.2e-12 (8-12 um).
[[nodiscard]] double quadrature_relative_bound(const Band& band, const BandGrid& grid,
                                               double t_min_k, double t_max_k);

// Returns the largest of such errors of L_b times the spectrum of a material, linear over each
// panel of the grid. The errors of all panels are added without their signs: the steeper a
// spectrum, the more of them. Found at 5 temperatures.
//   spectra  [spectrum][node] at least 0 [1]
[[nodiscard]] double quadrature_relative_bound(const Band& band, const BandGrid& grid,
                                               double t_min_k, double t_max_k,
                                               std::span<const std::vector<double>> spectra);

}  // namespace irsig
