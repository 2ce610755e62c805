#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/accuracy/image_layers.h"
#include "core/accuracy/quantities.h"
#include "core/accuracy/replicates.h"
#include "core/accuracy/spectral_modes.h"
#include "core/clutter/clutter.h"
#include "core/clutter/clutter_modes.h"
#include "core/effects/effects.h"
#include "core/sources/source_layout.h"
#include "core/transport/traced_pictures.h"

namespace irsig {

// Version of the numbers that the core makes: raised whenever a result changes in any bit for the
// same request.
// 31: the model error of a reflected sky is that of its light in the row's band; a cloud below a
// target takes nothing from the sky above; backgrounds keep the cloud where it is left out; skies
// of a low sun stay positive between rings. Dense haze scatters light as often as it is scattered.
// 30: air scatters sunlight until the sun is 6 deg below the horizon; errors of a low sun; clouds
// that hardly matter are left out by a bound.
// 21: a pixel is the mean radiance in its own solid angle, which is smaller far from the axis.
// 20: pictures have errors, and state the parts that each pixel shows; the quadrature bound allows
// for emissivities that are linear between the points of tables.
// 19: no light from beyond a band whose limit a material's table meets by rounding.
// 18: pictures have paths of their own, the same number in each pixel.
// 17: the bound of the target's depth takes light to leave the target where it is seen to, in mean.
// 16: rays at hot gas also go where it is seen past what is in front; steps beside jumps; what so
// few columns and rays may have missed; sunlight thrown onto other facets is allowed for by how
// much of it is how bright. 15: computed temperatures: skies that jump at a record, exact shares of
// the sky, errors of rays; facets inside other bodies are as warm as the rest of their part;
// targets in the air; model errors of hot gas and of clouds that the sky does not show; effects
// that an uncertain input moves are never left out; profiles allow for what no sample met; 0 W/sr
// is an answer. 11: what the target reflects of hot gas, and what gas takes of light behind it;
// aerosol between 2 and 3 km, and that of the Navy's model above the surface; the air's stated
// model error; its carbon dioxide at 2140-2430 cm-1 in warmer and colder air. 10: computed
// temperatures, whose exchange and repeated day are settled together; the air's carbon dioxide at
// 2140-2430 cm-1, which has the terms of the project's own lines; sky, sea and the sun in them,
// added up in the bands of the air, scattered sunlight rounded to float; what of the sun was not
// met, bounded for facets that face one way together.
inline constexpr int kPhysicsVersion = 31;

// Spectra on the band's stored wavelengths; [W/(sr um)].
struct SpectralEstimate {
  std::vector<double> value, stderr_;
  // Correlation of the errors; empty where it is not kept (all but the whole source, apparent and
  // contrast spectra).
  SpectralSet modes = {};
};

// kFloorReached: the error is above the relative one that was asked for, and not above what
// AccuracySpec::absolute_error_k is worth.
enum class StopReason { kTargetReached, kTargetMissed, kSampleLimit, kFixedSamples, kFloorReached };

// Destinations of light that the sensor would send out, in-band mean: by reciprocity the fractions
// of the light that it sees. balance: their sum, 1 within its error. cut_off: after the last
// reflection; for spectral materials at least that.
struct EnergyLedger {
  Estimate absorbed, escaped_to_sky, escaped_to_surface, cut_off, balance;
};

// A further image of a row. Standard errors: of the layer at_sensor alone.
struct LayerImage {
  ImageLayer layer = ImageLayer::kEmitted;
  std::vector<float> value, stderr_;
};

// Structure of the background around the target in a row's band.
struct BackgroundClutter {
#define IRSIG_VALUE_MEMBER(name, stderr_name, unit, what) Estimate name;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, what) double name = 0;
  IRSIG_CLUTTER_QUANTITIES(IRSIG_VALUE_MEMBER, IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBER
#undef IRSIG_NUMBER_MEMBER
  // Standard deviation of means over squares of the target's size, on the stored wavelengths
  // [W/(m2 sr um)], and the modes of their covariance.
  std::vector<double> patch_sigma;
  SpectralSet modes;
  // Fractions of the window by the land's materials, in the order of the sweep; the rest is no
  // land.
  std::vector<double> material_fraction;
};

// Returns the numbers of core/clutter under the catalogue's names. band: index in `modes`;
// visible_fraction: of the target's silhouette, in [0, 1].
[[nodiscard]] BackgroundClutter background_clutter(const ClutterField& field,
                                                   const ClutterStatistics& statistics,
                                                   const ClutterModes& modes, std::size_t band,
                                                   double visible_fraction,
                                                   std::vector<double> material_fraction);

struct SignatureResult {
  std::uint32_t condition = 0, band = 0;
  // The catalogue's quantities by their names (core/accuracy/quantities.h says what each is); the
  // causes below.
#define IRSIG_VALUE_MEMBER(name, stderr_name, unit, what) Estimate name;
#define IRSIG_NUMBER_MEMBER(name, kind, unit, what) double name = 0;
  IRSIG_SOURCE_QUANTITIES(IRSIG_VALUE_MEMBER, IRSIG_NUMBER_MEMBER)
  IRSIG_SENSOR_QUANTITIES(IRSIG_VALUE_MEMBER, IRSIG_NUMBER_MEMBER)
  IRSIG_BOUND_QUANTITIES(IRSIG_NUMBER_MEMBER)
  // Hot gas, if the condition has any: else 0.
  bool has_plume = false;
  IRSIG_PLUME_QUANTITIES(IRSIG_VALUE_MEMBER, IRSIG_NUMBER_MEMBER)
#undef IRSIG_VALUE_MEMBER
#undef IRSIG_NUMBER_MEMBER
  Estimate cause_w_sr[kCauses];
  std::vector<Estimate> part_w_sr;  // by the part that the sensor sees
  SpectralEstimate spectral, spectral_cause[kCauses], apparent_spectral, contrast_spectral,
      background_spectral;  // the last: radiance
  SpectralEstimate plume_spectral, apparent_plume_spectral, contrast_plume_spectral;  // has_plume
  // Between target and sensor, on the stored wavelengths: no sampling error.
  std::vector<double> path_transmittance_spectral, path_radiance_spectral;
  // Row by row from the top; empty: none. The target's radiance x the fraction of the pixel that it
  // fills, and its standard error.
  std::vector<float> image_w_m2_sr, image_stderr_w_m2_sr;
  // The typical standard error of a pixel that the target fills: root mean square, relative to its
  // radiance, and in kelvin at the mean of their radiances; of a target that fills none, that of
  // all pixels together.
  double image_error_relative = 0, image_error_k = 0;
  std::vector<LayerImage> layer;  // as ImageSpec::layer has them
  StopReason stop_reason = StopReason::kFixedSamples;
  std::uint32_t reflections = 0;  // the most that paths were given
  EnergyLedger energy;
  std::optional<BackgroundClutter> clutter;  // nullopt: the background was not measured
  std::vector<LedgerEntry> effect;           // [kEffects], in the table's order
  // Values of each replicate: for differences between runs that share their paths. [W/sr]
  std::vector<double> replicate_w_sr, replicate_apparent_w_sr, replicate_contrast_w_sr;
};

// An emitter whose temperature is not known (EmitterTemperatures) and that a view sees.
struct UnknownSeen {
  std::uint32_t condition, emitter;
};

struct ViewResult {
  std::vector<SignatureResult> row;  // selected conditions x selected bands
  std::uint32_t image_width_px = 0, image_height_px = 0;
  double pixel_rad = 0;
  // The parts that are seen in the images, which are the same for all rows: of pixel_samples rays
  // of each pixel, how many met a part first. By pixel, then by part.
  std::uint32_t pixel_samples = 0;
  std::vector<TracedPictures::Met> seen;
  // If whole parts were asked for: the rays that meet exactly these parts, one behind the other, in
  // the order of the parts. What lies outside the frame of a camera has a standard error of about
  // 0.5 %.
  struct PartSet {
    std::vector<std::uint32_t> part;
    std::vector<TracedPictures::Met> pixel;  // in the order of pixels; its parts mean nothing
    double outside_px = 0;                   // what they cover outside [areas of a pixel]
  };
  std::vector<PartSet> part_set;
  std::uint64_t samples = 0, target_paths = 0, rays = 0;
  std::uint32_t replicates = 0;
  std::uint64_t samples_per_replicate = 0;
  // Guarded events: numbers that should not occur, left out of the result. Not so
  // truncated_paths, whose name is that of the stored column: ordinary paths that were still
  // alive after the last reflection.
  std::uint64_t guarded_backface_hits = 0, guarded_nonfinite = 0, guarded_negative = 0;
  std::uint64_t truncated_paths = 0;
  std::optional<UnknownSeen> unknown_seen;     // then the rows say nothing
  std::uint64_t silhouette_backface_hits = 0;  // of guarded_backface_hits: by primary rays
  std::uint64_t seed =
      0;  // of the job, as derived from geometry, materials, viewpoint and the user's seed
};

}  // namespace irsig
