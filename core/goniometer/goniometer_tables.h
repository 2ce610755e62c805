#pragma once

#include <string>
#include <vector>

#include "core/goniometer/goniometer.h"

namespace irsig {

// The results as text. `provenance`: lines that say where they come from, written as comments.

// Writes one line for each channel, source and view: brdf_per_sr and reflectance_factor = pi x brdf
// (1 for a white diffuse plate), each with its standard error.
[[nodiscard]] std::string brdf_csv(const GoniometerResult& result,
                                   const std::vector<std::string>& provenance);

// Writes one line for each channel and view.
[[nodiscard]] std::string emissivity_csv(const GoniometerResult& result,
                                         const std::vector<std::string>& provenance);

// Writes the BRDF as a tabulated material (kind = "tabulated"): a full grid of lambda_um,
// theta_i_deg, theta_r_deg and azimuth_deg (0 to 180; 180: the mirror's side). The two views at
// +-azimuth are averaged, and so are f(in, out) and f(out, in) where both were measured: a material
// is reciprocal, but the few thousand grains in a field of view are so only on the average. In-band
// channels stand at their mean wavelength; spectral ones of overlapping bands are refused.
[[nodiscard]] absl::StatusOr<std::string> material_csv(const GoniometerResult& result,
                                                       const std::vector<std::string>& provenance);

// Returns the main results as text, and their deviations from theory.
[[nodiscard]] std::string summary_text(const GoniometerResult& result);

// Bounds that theory gives, found in a result.
struct GoniometerChecks {
  double largest_closure_t = 0;  // |emissivity + DHR - 1| in standard errors ...
  double largest_closure = 0;    // ... and by itself
  // Symmetry of brdf at azimuth phi against -phi, and of f(in, out) against f(out, in): rms of the
  // relative difference, and the part of it that the standard errors alone would make. A larger
  // value is the difference between one set of grains and another.
  double mirror_rms = 0, mirror_noise = 0;
  double reciprocity_rms = 0, reciprocity_noise = 0;
  std::size_t mirror_pairs = 0, reciprocity_pairs = 0;
};
[[nodiscard]] GoniometerChecks check_result(const GoniometerResult& result);

}  // namespace irsig
