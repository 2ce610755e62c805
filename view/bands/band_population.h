#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/spectral_modes.h"
#include "view/query/band_sum.h"
#include "view/query/row_weights.h"

namespace irsig {

// Population of a search for the best band: rows of one band, weighted. (docs/reference/bands.md)

// Contrast of one target at a sensor, on the band's stored wavelengths, and its errors.
struct TargetContrast {
  std::vector<double> value;  // at the aperture: the target less its background. [W/(sr um)]
  SpectralSet modes;          // modes of its errors, and the remainder
  std::vector<double> rest;
  double bias_bound_w_sr, undersampling_stderr_w_sr;  // of the whole band
  double model_error_w_sr;                            // one sigma, with that of uncertain inputs
};

// Background around a target as a detector compares it with the target's contrast: means over
// squares of the target's projected area, times this area.
struct TargetClutter {
  SpectralSet modes;           // of their covariance [W/(sr um)]
  std::vector<double> rest;    // standard deviation that the modes leave over, by bin
  double relative_stderr = 0;  // of the in-band standard deviation
};

// One row of the population.
struct BandCase {
  double weight;      // of all rows together: 1; above 0
  std::size_t view;   // rows of one view share their paths
  std::size_t place;  // the same row at another range has the same
  std::string season, time_utc;
  double aspect_azimuth_deg, aspect_elevation_deg, range_m;
  TargetContrast target;
  std::optional<TargetContrast> against;  // of another target in the same place; independent paths
  std::vector<double> background_w_m2_sr_um;
  std::optional<TargetClutter> clutter = {};  // nullopt: not requested
};
struct BandPopulation {
  std::vector<double> lambda_um;
  ResponseTable own_response;  // of the stored band; empty: 1
  std::vector<BandCase> row;
  std::size_t without_modes = 0;
  std::size_t without_clutter = 0;  // rows left out because clutter was asked for
};

// Weighting of rows: equal, or each aspect by the solid angle of the directions nearest to it
// (between the lowest and the highest viewpoint).
enum class AspectWeight { kRows, kSolidAngle };

// Makes a population from rows of one band, as run_query returns them.
//   against  rows of another target at the same places; empty: none
//   clutter  adds the background around the target of each row, and leaves rows without one out; at
//            another range, the part that the air between transmits
// User weights replace those of `weight` for aspects; for conditions they are fractions of their
// aspect (kRows: of all). Rows of weight 0 are left out. INVALID_ARGUMENT: no rows, several bands,
// interpolated rows, rows without a partner or weight, other wavelengths, or, with `clutter`, no
// row with clutter.
[[nodiscard]] absl::StatusOr<BandPopulation> band_population(
    StoreReader& reader, std::span<const QueryRow> rows, StoreReader* other,
    std::span<const QueryRow> against, AspectWeight weight,
    std::span<const RowWeights> own_weights = {}, bool clutter = false);

}  // namespace irsig
