#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "schema/store/reader.h"
#include "view/query/query.h"

namespace irsig {

// Each plot draws query.quantity of the selected rows as a complete SVG document. NOT_FOUND:
// nothing matches. FAILED_PRECONDITION: an older irsig stored some rows without the quantity.
// extent_of: needed for query.range_m; each of several ranges has its own curve.

// Plots in-band values against aspect azimuth at one elevation, one panel per band, one curve per
// season and time. If viewpoints lie on that elevation, they form the curve, with error bars (2
// sigma). Otherwise the curve is interpolated, with its 2 sigma range, and the viewpoints within
// half a spacing of the ring are marked. Without elevation_deg: the lowest elevation that the
// viewpoints cover all around.
[[nodiscard]] absl::StatusOr<std::string> plot_polar(StoreReader& reader, const Query& query,
                                                     std::optional<double> elevation_deg,
                                                     const ExtentOf& extent_of = {});

// Writes the numbers of that plot in a format of table.h. There is one line for each point of a
// curve (kind: stored or interpolated) and for each viewpoint near an interpolated curve (kind:
// near).
[[nodiscard]] absl::Status write_polar(StoreReader& reader, const Query& query,
                                       std::optional<double> elevation_deg, std::string_view format,
                                       std::ostream& out, const ExtentOf& extent_of = {});

// Plots the spectrum against wavelength from one viewpoint (row, nearest 1 or interpolate). There
// is one curve per season and time, with its 2 sigma range; all bands share one axis.
[[nodiscard]] absl::StatusOr<std::string> plot_spectrum(StoreReader& reader, const Query& query,
                                                        const ExtentOf& extent_of = {});

// Plots the air's transmittance between target and sensor, which has no sampling error.
[[nodiscard]] absl::StatusOr<std::string> plot_transmittance(StoreReader& reader,
                                                             const Query& query,
                                                             const ExtentOf& extent_of = {});

// Plots in-band values over all aspects: one Lambert azimuthal equal-area map per season and time
// (columns) and band (rows), seen from above the target, bow up; one colour bar per band.
// Interpolated between viewpoints, which are dots. For one range.
[[nodiscard]] absl::StatusOr<std::string> plot_map(StoreReader& reader, const Query& query,
                                                   const ExtentOf& extent_of = {});

}  // namespace irsig
