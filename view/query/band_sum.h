#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/measured.h"
#include "core/spectral/band.h"
#include "view/query/query.h"

namespace irsig {

// A spectral response: linear between its points, 0 outside them. A window is 1 between two.
using ResponseTable = std::vector<SpectralPoint>;
[[nodiscard]] ResponseTable window(double lambda_min_um, double lambda_max_um);

// A response as weights on a band's stored wavelengths:
// integral of response x spectrum = sum of weight x bin mean.                              [um]
//
// Inside a bin the spectrum is a straight line through its mean, with the slope that the bins
// beside it have: exact for whole bins under a constant response.
struct BandWeights {
  std::vector<double> weight;  // [bin], slopes included
  // [bin] Largest deviation of the response inside a bin from its mean there, times the bin's width
  // [um]
  std::vector<double> swing;

  // Returns the bound of the sum's change by the shape of spectra inside bins. In each bin, the
  // deviation of its mean from straight lines between the neighbouring means may lie anywhere in
  // the bin.
  [[nodiscard]] double shape_bound(std::span<const double> bin_mean) const;
};

// Computes the weights of a band's wavelengths. lambda_um: the stored wavelengths, two or more.
// INVALID_ARGUMENT: the response is not 0 outside these wavelengths (from the first to the last),
// or is 0 everywhere.
[[nodiscard]] absl::StatusOr<BandWeights> band_weights(std::span<const double> lambda_um,
                                                       const ResponseTable& response);

// A stored row under another response.
struct InBand {
  // Source, apparent and contrast intensity [W/sr]. The standard error follows from the stored
  // modes; for a row without modes it is the largest possible one, for fully correlated errors.
  // Bounds are those of the whole band, which no part of it exceeds, times the largest ratio of the
  // response to the band's own. The variation of spectra inside bins is added to the error of the
  // quadrature.
  Measured source, apparent, contrast;
  bool modes = false;  // all three have modes
};

// Computes rows as run_query returns them. stored: the response of the band with which the row was
// computed (empty: 1). INVALID_ARGUMENT: as band_weights(); a response narrower than the stored
// step, for which a bin's mean has no information; or a response where the band's own is 0, because
// errors are unknown there. FAILED_PRECONDITION: a row without apparent and contrast spectra
// (format version 2 or older).
[[nodiscard]] absl::StatusOr<InBand> in_band(StoreReader& reader, const QueryRow& row,
                                             const ResponseTable& response,
                                             const ResponseTable& stored);

// Like in_band() of one row, for many rows, which may be of several sweeps. [row]
[[nodiscard]] absl::StatusOr<std::vector<InBand>> in_band(StoreReader& reader,
                                                          std::span<const QueryRow> rows,
                                                          const ResponseTable& response);

// Returns the largest ratio response / own over all wavelengths; infinite where own is 0 and the
// response is not.
[[nodiscard]] double largest_ratio(const ResponseTable& response, const ResponseTable& own);

// Returns the response of a stored band; empty if the response is 1.
[[nodiscard]] absl::StatusOr<ResponseTable> response_of(const StoredSweep& sweep,
                                                        const std::string& band);

}  // namespace irsig
