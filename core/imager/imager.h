#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/image/image.h"
#include "core/spectral/band.h"

namespace irsig {

// Gain stated by the temperatures of a blackbody that fills the field: 0 and full scale.
struct CountsOfTemperatures {
  double black_k, white_k;
};
// Gain stated as it is: counts = counts_per_w_m2_sr x radiance + offset_counts.
struct CountsOfRadiance {
  double counts_per_w_m2_sr, offset_counts;
};

// A camera: optics with a circular aperture, square pixels in a square grid.
struct Imager {
  double aperture_m = 0, f_number = 0;
  double jitter_rad = 0;  // rms of the line of sight about each axis
  double pitch_m = 0;
  double fill_factor = 1;  // active fraction of a pixel's area, a centred square
  double netd_k = 0, scene_temperature_k = 300;
  double fixed_pattern_k = 0;   // rms over pixels
  std::uint32_t margin_px = 4;  // pixels added on each side of the stored image
  std::uint64_t seed = 1;
  std::uint32_t bits = 14;
  std::variant<CountsOfTemperatures, CountsOfRadiance> gain;

  // Returns the angle between the centres of two pixels.
  [[nodiscard]] double ifov_rad() const { return pitch_m / (f_number * aperture_m); }
  [[nodiscard]] double full_scale_counts() const;
};

// Figures of an imager in one band.
struct ImagerInBand {
  // Mean wavelength, weighted with the band's response and the blackbody at the scene's
  // temperature.
  double wavelength_um;
  // Standard deviations of the noise and of the fixed pattern: NETD and fixed_pattern_k times the
  // in-band dL/dT at the scene's temperature.
  double noise_w_m2_sr, fixed_pattern_w_m2_sr;
  double counts_per_w_m2_sr, offset_counts;
};
// Computes the imager's response in a band. INVALID_ARGUMENT: the band is invalid
// (core/spectral/band.h), or its radiance at black_k and white_k gives no finite gain.
[[nodiscard]] absl::StatusOr<ImagerInBand> imager_in_band(const Imager& imager, const Band& band);

// Returns the transfer function of the optics, aperture x jitter, at a spatial frequency f in
// cycles/rad.    [1]
//
//   2/pi (acos n - n sqrt(1 - n^2)), n = lambda f / D, 0 beyond 1     [goodman2005, 6.3]
//   exp(-2 (pi sigma f)^2)                                            a Gaussian of rms sigma
//
// Aberrations, crosstalk and motion are left out.
[[nodiscard]] double optics_mtf(const Imager& imager, double wavelength_um, double f);
// Returns the transfer function of a pixel's active square along one of its sides, sinc(a f) =
// sin(pi a f) / (pi a f). That of the imager is optics_mtf(hypot(fx, fy)) pixel_mtf(fx)
// pixel_mtf(fy).    [1]
[[nodiscard]] double pixel_mtf(const Imager& imager, double f);

// The detector's pixels that cover a stored image: both grids have one centre. A pixel is `ratio`
// stored pixels wide; the left edge of the first one is `left` stored pixels right of the image's.
struct DetectorGrid {
  std::uint32_t width_px, height_px;
  double ratio, left, top;
};
// Returns the grid of the detector for a stored image. INVALID_ARGUMENT: the stored pixels are
// wider than half a pixel of the detector, or the detector needs more than 4096 pixels along a
// side.
[[nodiscard]] absl::StatusOr<DetectorGrid> detector_grid(const Imager& imager,
                                                         std::uint32_t width_px,
                                                         std::uint32_t height_px, double pixel_rad);

// Returns the radiance that each pixel of the grid receives, without noise. Stored pixels are means
// over their areas; that mean is divided out of the transfer function, which multiplies the image's
// Fourier transform. Beyond the border lies `outside_w_m2_sr`.
//
// Accuracy: the transfer function of a slanted edge is the product above within 0.3 % up to the
// detector's Nyquist frequency (tests/unit/imager_test.cpp). Details finer than two stored pixels
// or a sixteenth of a pixel of the detector are left out.
[[nodiscard]] RadianceImage detector_image(const Imager& imager, double wavelength_um,
                                           const RadianceImage& stored, double pixel_rad,
                                           double outside_w_m2_sr, const DetectorGrid& grid);

// Like detector_image(), for an image whose surroundings continue beyond its border: repeats the
// border's pixels as far as the point spread reaches.
[[nodiscard]] RadianceImage detector_image_going_on(const Imager& imager, double wavelength_um,
                                                    const RadianceImage& stored, double pixel_rad,
                                                    double outside_w_m2_sr,
                                                    const DetectorGrid& grid);

struct CountsImage {
  std::uint32_t width_px = 0, height_px = 0;
  std::vector<std::uint16_t> counts;  // row by row from the top left
  std::uint64_t saturated_px = 0;     // pixels that would lie below 0 or above full scale
};
// Returns gain x (radiance + fixed pattern + noise) + offset, rounded and limited to the imager's
// bits. The noise of a pixel depends on the imager's seed, on `frame` and on the pixel's place; the
// fixed pattern does not depend on `frame`.
[[nodiscard]] CountsImage counts_image(const Imager& imager, const ImagerInBand& figures,
                                       const RadianceImage& radiance, std::uint64_t frame);

}  // namespace irsig
