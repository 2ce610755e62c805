#pragma once

#include "absl/status/statusor.h"
#include "core/materials/brdf_model.h"

namespace irsig {

// Prepares a measured or simulated BRDF on a grid, made reciprocal. [1/sr]
//
//   f_r(i, o, phi) = (t(i, o, phi) + t(o, i, phi)) / 2
//
// on the union of both zenith grids, 0 and 90 deg, and the azimuths, 0 and 180 deg; linear in the
// angles [deg] and in wavelength between its points. t is the stated table, linear between its
// points and constant beyond its first and last ones. At zenith 0, where there is no azimuth, the
// mean over azimuth stands.
//
// Directions: cells of that grid, chosen in proportion to their solid angle x cosine x largest
// corner over all wavelengths. Largest weight: the DHR of that staircase, at most a few times the
// DHR unless the table falls steeply between its points.
//
// Accuracy: DHR is exact for the interpolated table. Limits: nothing beyond the last zenith angle
// was measured, and lobes narrower than the grid are not there: examine() says how much.
[[nodiscard]] BrdfModelOr prepare_tabulated_brdf(const TabulatedBrdf& spec, const PreparedFor& at);

struct TabulatedBrdfFindings {
  double
      reciprocity_residual;  // largest |t(i, o) - t(o, i)| / largest t, where both are in the grid
  double last_zenith_deg;    // beyond it, in or out, the table is continued as a constant
  double clamped_fraction;   // how much of the cosine-weighted hemisphere lies beyond it
};
// Examines a table. Errors: wrong sizes, order or ranges, negative values.
[[nodiscard]] absl::StatusOr<TabulatedBrdfFindings> examine(const TabulatedBrdf& spec);

}  // namespace irsig
