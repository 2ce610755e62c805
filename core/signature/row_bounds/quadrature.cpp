#include <algorithm>
#include <cmath>

#include "core/signature/row_bounds/row_bounds.h"

namespace irsig {
namespace {

double sun_quadrature_w_sr(const ViewSetup& setup, const Row& row) {
  const SolarQuadrature& error = setup.scene.sun_quadrature[row.band];
  constexpr auto kSun = static_cast<std::size_t>(Cause::kSunReflected);
  const std::vector<Estimate>& spectrum = row.estimate.cause_spectrum[kSun];
  // Pilots have no spectra.
  if (spectrum.empty()) return error.of_white * std::abs(row.estimate.cause[kSun].value);
  const BandGrid& grid = row.on_axis.grid;
  double sum = 0;
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    double width_um = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i)
      width_um += grid.band_weight[i];
    sum += error.of_bin[k] * width_um * std::abs(spectrum[k].value);
  }
  return sum;
}

}  // namespace

double quadrature_bound_w_sr(const ViewSetup& setup, const Row& row) {
  const RowEstimate& e = row.estimate;
  const double apparent_w_sr = e.apparent.value, background_w_sr = apparent_w_sr - e.contrast.value;
  double sum =
      row.quadrature_relative *
      std::max(std::abs(e.total.value), std::abs(apparent_w_sr) + std::abs(background_w_sr));
  // Rounding of coordinates moves outlines, and uncovers what is behind them.
  double outline_m2 = 0;
  for (std::size_t part = 0; part < setup.turned.size(); ++part) {
    const auto [m2, rounding_m2] = setup.turned[part];
    outline_m2 += rounding_m2;
    if (m2 > 0) sum += rounding_m2 / m2 * std::abs(e.part[part].value);
  }
  if (const double seen_m2 = e.projected_area_m2.value; seen_m2 > 0)
    sum += outline_m2 / seen_m2 * std::abs(background_w_sr);
  // Between the corners that cut the quadrature, emission and reflection of materials' tables may
  // change by twice what is left out, reflectances of optical constants by four times.
  sum += 4 * setup.scene.corners_left_out[row.band] * e.projected_area_m2.value *
             row.light->brightest_w_m2_sr(row.on_axis, row.brightest_thermal_w_m2_sr) +
         sun_quadrature_w_sr(setup, row);
  return sum;
}

}  // namespace irsig
