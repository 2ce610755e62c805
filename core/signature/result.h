#pragma once

#include <cstdint>
#include <vector>

#include "core/accuracy/replicates.h"
#include "core/effects/effects.h"
#include "core/sources/source_layout.h"

namespace irsig {

// Version of the numbers that the core makes: raised whenever a result changes in any bit for the
// same request.
inline constexpr int kPhysicsVersion = 4;

// Spectra on the band's stored wavelengths; [W/(sr um)].
struct SpectralEstimate {
  std::vector<double> value, stderr_;
};

enum class StopReason { kTargetReached, kTargetMissed, kSampleLimit, kFixedSamples };

// Where light that the sensor would send out ends, in-band mean: by reciprocity the shares of what
// it sees. balance: their sum, 1 within its error. cut_off: after the last reflection; of spectral
// materials at least that.
struct EnergyLedger {
  Estimate absorbed, escaped_to_sky, escaped_to_lower, cut_off, balance;
};

struct SignatureResult {
  std::uint32_t condition = 0, band = 0;
  Estimate intensity_w_sr;  // source: no air
  // Bias bounds; all are part of the numerical error. quadrature: over wavelength, basis_bound
  // included. unseen: rare bright events (sunlight on facets with narrow lobes, hot parts) that
  // were met too seldom to show in the standard error.
  double truncation_bound_w_sr = 0, quadrature_bound_w_sr = 0, unseen_bound_w_sr = 0;
  double basis_bound_w_sr = 0;  // of the nodes between those that paths carry
  double sky_bound_w_sr = 0;    // of sky and sea between the directions at which they are known
  // Of effects that were left out, reflections after fewer than the request allows included.
  double omitted_bound_w_sr = 0, apparent_omitted_bound_w_sr = 0, contrast_omitted_bound_w_sr = 0;
  double numerical_error_w_sr = 0;
  Estimate apparent_intensity_w_sr;
  double apparent_numerical_error_w_sr = 0;
  // At the aperture: the target less what would be seen in its place, ray by ray.
  Estimate contrast_intensity_w_sr;
  double contrast_numerical_error_w_sr = 0;
  // At the aperture, mean over the silhouette: what would be seen in the target's place.
  Estimate background_radiance_w_m2_sr;
  // One sigma of the models of air, sky and sea. Never part of the numerical error.
  double model_error_w_sr = 0, apparent_model_error_w_sr = 0;
  double path_transmittance = 1;     // in-band mean, of a grey source
  double path_radiance_w_m2_sr = 0;  // in-band
  Estimate projected_area_m2;
  // Of intensity / projected area; NaN if no blackbody has that radiance (core/spectral/band.h).
  double apparent_temperature_k = 0;
  Estimate cause_w_sr[kCauses];
  std::vector<Estimate> part_w_sr;  // by the part that the sensor sees
  SpectralEstimate spectral, spectral_cause[kCauses], apparent_spectral, contrast_spectral,
      background_spectral;  // the last: radiance
  // Between target and sensor, on the stored wavelengths: no sampling error.
  std::vector<double> path_transmittance_spectral, path_radiance_spectral;
  std::vector<float> image_w_m2_sr;  // row by row from the top; empty: none
  StopReason stop_reason = StopReason::kFixedSamples;
  double absolute_floor_w_sr = 0;  // what AccuracySpec::absolute_error_k is worth
  std::uint32_t reflections = 0;   // the most that paths were given
  EnergyLedger energy;
  std::vector<LedgerEntry> effect;  // [kEffects], in the table's order
  // Of each replicate: for differences between runs that share their paths. [W/sr]
  std::vector<double> replicate_w_sr, replicate_apparent_w_sr, replicate_contrast_w_sr;
};

struct ViewResult {
  std::vector<SignatureResult> row;  // selected conditions x selected bands
  std::uint32_t image_width_px = 0, image_height_px = 0;
  double pixel_rad = 0;
  std::uint64_t samples = 0, target_paths = 0, rays = 0;
  std::uint32_t replicates = 0;
  std::uint64_t samples_per_replicate = 0;
  // Guarded events: numbers that should not occur, left out of the result. Not so
  // guarded_path_limit, whose name is that of the stored column: ordinary paths that were still
  // alive after the last reflection.
  std::uint64_t guarded_backface_hits = 0, guarded_nonfinite = 0, guarded_negative = 0;
  std::uint64_t guarded_path_limit = 0;
  std::uint64_t seed =
      0;  // of the job, as derived from geometry, materials, viewpoint and the user's seed
};

}  // namespace irsig
