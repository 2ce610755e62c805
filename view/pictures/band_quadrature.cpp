#include "view/pictures/band_quadrature.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "core/spectral/planck.h"
#include "view/draw/axis.h"

namespace irsig {

double BandQuadrature::temperature_k(double radiance_w_m2_sr) const {
  return radiance_temperature_k(band, grid, radiance_w_m2_sr);
}

double BandQuadrature::radiance_w_m2_sr(double temperature_k) const {
  if (band.response.empty())
    return planck_band_radiance_w_m2_sr(band.lambda_min_um, band.lambda_max_um, temperature_k);
  double sum = 0;
  for (std::size_t i = 0; i < grid.node_um.size(); ++i)
    sum += grid.band_weight[i] * planck_radiance_w_m2_sr_um(grid.node_um[i], temperature_k);
  return sum;
}

absl::StatusOr<BandQuadrature> band_quadrature(const schema::Band& band,
                                               std::span<const double> breaks_um) {
  BandQuadrature out{{band.name(), band.lambda_min_um(), band.lambda_max_um(), band.step_um(), {}},
                     {}};
  for (const schema::SpectralPoint& p : band.response())
    out.band.response.push_back({p.lambda_um(), p.value()});
  ASSIGN_OR_RETURN(auto grid, make_band_grid(out.band, breaks_um));
  out.grid = std::move(grid);
  return out;
}

BarAxis temperature_axis(const BandQuadrature& band, const ColorRange& range) {
  const double low_k = band.temperature_k(std::max(range.low, 0.0));
  const double high_k = band.temperature_k(std::max(range.high, 0.0));
  BarAxis out{"Apparent temperature in K", {}, {}};
  const Axis round = tight_axis(low_k, high_k, 16);
  for (std::size_t i = 0; i < round.tick.size(); ++i) {
    if (!(round.tick[i] > 0)) continue;
    out.at.push_back(band.radiance_w_m2_sr(round.tick[i]));
    out.label.push_back(round.label[i]);
  }
  return out;
}

}  // namespace irsig
