#pragma once

#include <span>

#include "absl/status/statusor.h"
#include "core/spectral/band.h"
#include "schema/sweep.pb.h"
#include "view/draw/false_color.h"

namespace irsig {

// A band of a stored sweep with its quadrature, and the blackbodies that have its in-band radiance.
struct BandQuadrature {
  Band band;
  BandGrid grid;

  [[nodiscard]] double temperature_k(double radiance_w_m2_sr) const;
  [[nodiscard]] double radiance_w_m2_sr(double temperature_k) const;
};

// Makes the quadrature of a band. breaks_um: as for make_band_grid.
[[nodiscard]] absl::StatusOr<BandQuadrature> band_quadrature(
    const schema::Band& band, std::span<const double> breaks_um = {});

// Returns round temperatures, at the in-band radiance of a blackbody that has them.
[[nodiscard]] BarAxis temperature_axis(const BandQuadrature& band, const ColorRange& range);

}  // namespace irsig
