#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/signature/view/row.h"
#include "core/signature/view/seen_places.h"
#include "core/signature/view/view_setup.h"

namespace irsig {

// The bounds on the error of a row that no scatter of samples shows, one file each. A new bound is
// a file beside these, its name in IRSIG_BOUNDS (core/accuracy/measured.h), and a line in
// IRSIG_BOUNDS_OF_WEIGHTS below or in measured().

// Inputs of a row's bounds, from the paths of one run.
struct BoundInput {
  const ViewSetup& setup;
  const Row& row;  // with its estimate
  const LitWeights& lit;
  const SummedWeights& mean;                           // over replicates
  std::span<const double> largest;                     // [source] on any node; empty: not wanted
  std::span<const SummedWeights> temperature_changes;  // [replicate] empty: temperatures are exact
  const SeenPlaces* places = nullptr;                  // null: not wanted
  double front_area_m2 = 0;                            // of the silhouette that emits
};

// The bounds that follow from the weights of paths:
//
//   BOUND(enumerator, function, stored runs only)
//
//   spectral_basis_bound           weights between the wavelengths that paths carry, and
//                                  temperatures between blackbodies
//   direction_interpolation_bound  light of sky and sea between the directions in which it is known
//   temperature_bound              temperatures of emitters that are computed or measured
//   background_bound               interpolation of the background, and the errors of computed
//                                  temperatures of land in it
//   target_depth_bound             the air in front of one place of the target, taken for that in
//                                  front of all
#define IRSIG_BOUNDS_OF_WEIGHTS(BOUND)              \
  BOUND(kBasis, spectral_basis_bound, false)        \
  BOUND(kSky, direction_interpolation_bound, false) \
  BOUND(kTemperature, temperature_bound, false)     \
  BOUND(kBackground, background_bound, true)        \
  BOUND(kDepth, target_depth_bound, true)

#define IRSIG_DECLARE_BOUND(enumerator, function, stored_only) \
  [[nodiscard]] ThreeBounds function(const BoundInput& in);
IRSIG_BOUNDS_OF_WEIGHTS(IRSIG_DECLARE_BOUND)
#undef IRSIG_DECLARE_BOUND

// Returns one sigma of the models of the background, in the contrast. [W/sr]
[[nodiscard]] double background_model_w_sr(const BoundInput& in);

// Returns one sigma of which of both skies a target under broken cloud has: the row of the same
// paths under one of them less that under the mean, times ViewEnvironment::one_sky_sigma. Signs of
// what changes together (reflected sky, sun, background) are kept. 0 under one sky.
[[nodiscard]] ThreeBounds choice_of_sky(const BoundInput& in);

// Sets all bounds above, and both model errors.
void set_bounds_of_weights(const BoundInput& in, bool stored, Row& row);

// Bounds the quadrature over the band, of outlines, of materials' tables and of the sun's spectrum.
// [W/sr]
[[nodiscard]] double quadrature_bound_w_sr(const ViewSetup& setup, const Row& row);

// Undersampling error: the scatter of samples does not show it, whether or not a sample has met a
// bright source. (docs/explanation/methods.md)
struct Undersampling {                                       // [W/sr]
  double bound = 0, source = 0, apparent = 0, contrast = 0;  // standard errors but for `bound`
};
[[nodiscard]] Undersampling undersampling(const ViewSetup& setup, const Row& row,
                                          std::uint64_t samples);
// Returns the undersampling error of the source's intensity, for so many samples a replicate: of a
// view, or of one stratum of a view that aims at bright facets. [W/sr]
[[nodiscard]] double undersampling_error_w_sr(const ViewSetup& setup, const Row& row,
                                              std::uint64_t samples);
[[nodiscard]] double undersampling_error_w_sr(const ViewSetup& setup, const Row& row,
                                              std::uint32_t stratum, std::uint64_t samples);

}  // namespace irsig
