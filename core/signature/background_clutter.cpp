#include <utility>

#include "core/signature/background_window.h"
#include "core/signature/view/result.h"

namespace irsig {

std::vector<double> on_bins(std::span<const double> spectrum, const BandOnAxis& band) {
  const BandGrid& grid = band.grid;
  std::vector<double> out(grid.lambda_um.size(), 0.0);
  for (std::size_t bin = 0; bin < out.size(); ++bin)
    for (std::size_t i = grid.bin_first[bin]; i < grid.bin_first[bin + 1]; ++i)
      out[bin] += grid.bin_weight[i] * spectrum[band.first_node + i];
  return out;
}

BackgroundClutter background_clutter(const ClutterField& field, const ClutterStatistics& statistics,
                                     const ClutterModes& modes, std::size_t band,
                                     double visible_fraction,
                                     std::vector<double> material_fraction) {
  BackgroundClutter out;
  out.clutter_window_m = static_cast<double>(field.columns) * field.pixel_m;
  out.clutter_pixel_m = field.pixel_m;
  out.clutter_mean_w_m2_sr = statistics.mean;
  out.clutter_sigma_w_m2_sr = statistics.sigma;
  out.clutter_skewness = statistics.skewness;
  out.clutter_correlation_m = statistics.correlation_m;
  out.clutter_cells = statistics.cells;
  out.clutter_patch_m = statistics.patch_m;
  out.clutter_patch_sigma_w_m2_sr = statistics.patch_sigma;
  out.clutter_modes_fraction = modes.fraction[band];
  out.visible_fraction = visible_fraction;
  out.patch_sigma = modes.sigma[band];
  out.modes = modes.band[band];
  out.material_fraction = std::move(material_fraction);
  return out;
}

}  // namespace irsig
