#include "core/spectral/solar.h"

#include <cmath>

#include "core/base/table.h"

namespace irsig {
namespace {
#include "astm_e490_00a.inc"
}

double solar_irradiance_w_m2_um(double lambda_um) {
  return interpolate_or(kAbscissa, kOrdinate, lambda_um, 0.0);
}

double solar_quadrature_relative_bound(const Band& band, const BandGrid& grid) {
  double on_grid = 0, whole = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    on_grid += grid.band_weight[i] * solar_irradiance_w_m2_um(grid.node_um[i]);
  constexpr int kPieces = 16384;
  const double piece_um = (band.lambda_max_um - band.lambda_min_um) / kPieces;
  for (int i = 0; i < kPieces; ++i) {
    const double um = band.lambda_min_um + (i + 0.5) * piece_um;
    whole += piece_um * band_response(band, um) * solar_irradiance_w_m2_um(um);
  }
  return whole > 0 ? std::abs(on_grid / whole - 1) : 0;
}

}  // namespace irsig
