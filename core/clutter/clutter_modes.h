#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/accuracy/spectral_modes.h"
#include "core/clutter/clutter_field.h"

namespace irsig {

// Spectral covariance of the background: how the radiances of its pixels at two wavelengths, in one
// band or in two, vary together. A few spectra m_k, the modes, carry it:
//
//   cov(i, j) = sum_k m_k(i) m_k(j),   m_k = sqrt(eigenvalue) x eigenvector
//
// so that two filters f and g see backgrounds of the covariance sum_k (f . m_k) (g . m_k). The
// covariance is that of means over target-sized squares (patch_px of clutter_field.h), since these
// compete with a target; it is that of the window, without ClutterStatistics' correction for the
// window's own mean.

// Weights of a field's sources, averaged over squares, as deviations from their means over the
// window. Made once for a view: each condition takes the sources that shine under it.
class WeightDeviations {
 public:
  WeightDeviations(const ClutterField& field, double target_area_m2);

  // Returns a factor of the covariance of the weights of some sources: [factor][place in sources],
  // sum_k f_k f_k^T = the covariance. Its cost grows with the square of the sources.
  //   sources  of the field
  [[nodiscard]] SpectralSet factor(std::span<const std::size_t> sources) const;

 private:
  // [source]: in units of the length, which is sigma x the root of the squares' number; empty: the
  // weight is the same everywhere.
  std::vector<std::vector<double>> deviation_;
  std::vector<double> sigma_;
};

// Returns the factor of all sources.
[[nodiscard]] SpectralSet weight_factor(const ClutterField& field, double target_area_m2);

struct ClutterModes {
  std::vector<SpectralSet> band;  // [band][mode][bin], as many modes in each, the largest first
  SpectralSet sigma;              // [band][bin] standard deviation, of all factors
  std::vector<double> fraction;   // [band] of its variance, summed over bins, that the modes carry
};

// Modes of all bands of a view under one condition. radiance: [band][source][bin], spectral
// radiances of the sources at the aperture. Each band counts alike, whatever its radiance: before
// the eigenvectors are found, its bins are divided by the root of its summed variance. Modes are
// added until they carry kClutterFraction of every band's variance; at most kMostClutterModes.
inline constexpr double kClutterFraction = 0.999;
inline constexpr std::size_t kMostClutterModes = 8;
[[nodiscard]] ClutterModes clutter_modes(const SpectralSet& weight_factor,
                                         std::span<const SpectralSet> radiance);

}  // namespace irsig
