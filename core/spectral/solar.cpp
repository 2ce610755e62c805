#include "core/spectral/solar.h"

#include <algorithm>
#include <cmath>

#include "core/base/table.h"

namespace irsig {
namespace {
#include "astm_e490_00a.inc"
constexpr double kFinestUm = 1e-4;  // finer than the table
}  // namespace

double solar_irradiance_w_m2_um(double lambda_um) {
  return interpolate_or(kAbscissa, kOrdinate, lambda_um, 0.0);
}

SolarQuadrature solar_quadrature(const Band& band, const BandGrid& grid) {
  constexpr double kGauss2 = 0.57735026918962576451;  // of a panel's nodes, 1 / sqrt(3)
  constexpr int kLeastPieces = 64;
  SolarQuadrature out;
  double all = 0, all_on_grid = 0;
  for (std::size_t k = 0; k < grid.lambda_um.size(); ++k) {
    double error = 0, on_grid = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; i += 2) {
      const double middle = 0.5 * (grid.node_um[i] + grid.node_um[i + 1]),
                   reach = 0.5 * (grid.node_um[i + 1] - grid.node_um[i]) / kGauss2;
      // Integral and first moment of response x sun, on the grid less the table's.
      double mass = 0, moment = 0;
      for (const std::size_t node : {i, i + 1}) {
        const double part = grid.band_weight[node] * solar_irradiance_w_m2_um(grid.node_um[node]);
        mass += part;
        moment += part * (node == i ? -kGauss2 : kGauss2);
      }
      on_grid += mass;
      const int pieces = std::max(kLeastPieces, static_cast<int>(2 * reach / kFinestUm));
      for (int n = 0; n < pieces; ++n) {
        const double at = (2 * n + 1.0) / pieces - 1, um = middle + at * reach;
        const double part =
            2 * reach / pieces * band_response(band, um) * solar_irradiance_w_m2_um(um);
        mass -= part;
        moment -= part * at;
      }
      error += std::abs(mass) + std::abs(moment);
    }
    out.of_bin.push_back(on_grid > 0 ? error / on_grid : 0);
    all += error;
    all_on_grid += on_grid;
  }
  out.of_white = all_on_grid > 0 ? all / all_on_grid : 0;
  return out;
}

}  // namespace irsig
