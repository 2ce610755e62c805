#pragma once

#include <span>

#include "core/accuracy/replicates.h"
#include "core/clutter/clutter_field.h"

namespace irsig {

// Statistics of the in-band radiance L of the background over a window.
//
//   sigma^2           variance of L over pixels
//   skewness          mean of ((L - mean) / sigma)^3
//   correlation area  integral of the autocorrelation of L over lags           [vanmarcke1983, 5.3]
//   correlation_m     sqrt(correlation area / pi): l of an autocorrelation exp(-r^2 / l^2)
//   cells             window area / correlation area: how many values are independent
//   patch_sigma       standard deviation of the mean of L over squares of the side patch_m. A
//                     target replaces the background in its silhouette, so that the background's
//                     scatter competes with the target's contrast after averaging over that area:
//                     signal to clutter = |contrast intensity| / (patch_sigma x projected area).
//
// The autocorrelation is integrated inside the ellipse whose half axes are its first zeros along
// rows and columns, at most half of the window. Removing the window's own mean takes sigma^2 /
// cells from every covariance; this is added again.
//
// Standard errors count independent cells: each statistic is the mean of its influence function
// over pixels [hampel1986, 2.1], whose own variance and correlation area give the error of that
// mean. They hold where the window has many cells: with 80 the stated error of
// correlation_m is too small by 1.4, the others by 1.1 at most (tests/physics/clutter_test.cpp).
//
// Limits: noise of the weights (few rays in a pixel) counts as clutter. A constant field, and a
// single pixel, have sigma 0, one cell, and errors of 0 that mean nothing. A target smaller than a
// pixel has patch_sigma = sigma, which is below the scatter that finer pixels would show.
struct ClutterStatistics {
  Estimate mean, sigma;  // [W m^-2 sr^-1]
  Estimate skewness;
  Estimate correlation_m;  // [m]
  double cells = 1;
  double patch_m = 0;    // [m]
  Estimate patch_sigma;  // [W m^-2 sr^-1]
};

// Computes the clutter of a field. A window of 128 x 128 pixels takes 20 ms beside the sum over
// sources.
//   radiance  of each source in a band, at the sensor's aperture [W m^-2 sr^-1]
[[nodiscard]] ClutterStatistics clutter_of(const ClutterField& field,
                                           std::span<const double> radiance, double target_area_m2);

}  // namespace irsig
