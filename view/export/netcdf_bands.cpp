#include "view/export/netcdf_bands.h"

#include <algorithm>
#include <limits>
#include <optional>

#include "core/base/status_macros.h"
#include "core/spectral/band.h"
#include "messages/environment/sweep_environment.h"

namespace irsig {
namespace {

constexpr double kFill = std::numeric_limits<double>::quiet_NaN();

// Returns the weight of each bin of a band in the in-band integral of a spectrum of bin means,
// response included. The weights are exact where the spectrum is a straight line. Only half of the
// first and of the last bin lies inside the band; the mean of such a bin is not that of its half.
std::vector<double> bin_weights(const BandGrid& grid) {
  const std::size_t bins = grid.lambda_um.size();
  std::vector<double> weight(bins, 0.0);
  for (std::size_t k = 0; k < bins; ++k) {
    double moment = 0;
    for (std::size_t i = grid.bin_first[k]; i < grid.bin_first[k + 1]; ++i) {
      weight[k] += grid.band_weight[i];
      moment += grid.band_weight[i] * (grid.node_um[i] - grid.lambda_um[k]);
    }
    // Times the slope, from the bins beside it.
    const std::size_t below = k == 0 ? 0 : k - 1, above = std::min(k + 1, bins - 1);
    if (above == below) continue;
    const double per_mean = moment / (grid.lambda_um[above] - grid.lambda_um[below]);
    weight[above] += per_mean;
    weight[below] -= per_mean;
  }
  return weight;
}

constexpr const char* kWeightComment =
    "Sums of these times a spectrum are in-band if it is a straight line from bin to bin. Half of "
    "the first and of the last bin lies outside the band, and what the air does within these two "
    "is not stored: sums of apparent and contrast spectra miss by that, in 3 to 5 um by 0.3 and "
    "0.7 % as a rule and several % of a contrast near 0. The in-band values that were computed on "
    "a finer grid are intensity_w_sr, apparent_intensity_w_sr and contrast_intensity_w_sr.";

std::optional<Band> stated_band(const schema::ResolvedSweep& sweep, const std::string& name) {
  for (const schema::Band& band : sweep.sweep().band()) {
    if (band.name() != name) continue;
    Band out{band.name(), band.lambda_min_um(), band.lambda_max_um(), band.step_um(), {}};
    for (const schema::SpectralPoint& p : band.response())
      out.response.push_back({p.lambda_um(), p.value()});
    return out;
  }
  return std::nullopt;  // of an earlier version of the sweep
}

// The bands' responses as they are stated: points, with straight lines between them.
void write_responses(NetcdfFile& file, const std::vector<std::optional<Band>>& bands,
                     NetcdfFile::Dimension band) {
  std::vector<std::vector<SpectralPoint>> points;
  std::size_t most = 0;
  for (const std::optional<Band>& b : bands) {
    points.emplace_back();
    if (b) points.back() = b->response;
    if (b && b->response.empty()) points.back() = {{b->lambda_min_um, 1}, {b->lambda_max_um, 1}};
    most = std::max(most, points.back().size());
  }
  if (most == 0) return;
  std::vector<double> um(bands.size() * most, kFill), value = um;
  for (std::size_t b = 0; b < bands.size(); ++b)
    for (std::size_t p = 0; p < points[b].size(); ++p) {
      um[b * most + p] = points[b][p].lambda_um;
      value[b * most + p] = points[b][p].value;
    }
  const std::vector<NetcdfFile::Dimension> plane{band, file.dimension("response_point", most)};
  file.doubles({"response_lambda_um", "wavelength in vacuum, of the points of the response", ""},
               plane, um);
  file.doubles({"response_at_point",
                "relative response of the band: linear between its points, 0 outside them", "",
                "response_lambda_um"},
               plane, value);
}

}  // namespace

absl::Status write_bins(NetcdfFile& file, const schema::ResolvedSweep& sweep,
                        const std::vector<std::string>& bands,
                        const std::vector<std::vector<double>>& lambda_um,
                        NetcdfFile::Dimension band, NetcdfFile::Dimension bin, std::size_t bins) {
  std::vector<double> axis(bands.size() * bins, kFill), weight = axis, response = axis,
                                                        bounds(2 * axis.size(), kFill);
  std::vector<std::optional<Band>> stated;
  for (std::size_t b = 0; b < bands.size(); ++b) {
    for (std::size_t k = 0; k < lambda_um[b].size(); ++k) axis[b * bins + k] = lambda_um[b][k];
    const auto& of = stated.emplace_back(stated_band(sweep, bands[b]));
    if (!of) continue;
    ASSIGN_OR_RETURN(const auto grid, make_band_grid(*of, spectral_breaks_um(sweep)));
    if (grid.lambda_um.size() != lambda_um[b].size()) continue;  // of an earlier version
    const std::vector<double> of_bin = bin_weights(grid);
    for (std::size_t k = 0; k < of_bin.size(); ++k) {
      const double um = grid.lambda_um[k];
      bounds[2 * (b * bins + k)] = um - grid.step_um / 2;
      bounds[2 * (b * bins + k) + 1] = um + grid.step_um / 2;
      weight[b * bins + k] = of_bin[k];
      response[b * bins + k] =
          band_response(*of, std::clamp(um, of->lambda_min_um, of->lambda_max_um));
    }
  }
  file.doubles({"lambda_um", "wavelength in vacuum, middle of the bin", "", "", "lambda_bounds_um"},
               {band, bin}, axis);
  file.doubles({"lambda_bounds_um", "limits of the bin, over which spectra are means", ""},
               {band, bin, file.dimension("edge", 2)}, bounds);
  file.doubles(
      {"response", "relative response of the band at the middle of the bin", "", "lambda_um"},
      {band, bin}, response);
  file.doubles({"in_band_weight_um", "response x width inside the band", "", "lambda_um", "",
                kWeightComment},
               {band, bin}, weight);
  write_responses(file, stated, band);
  return absl::OkStatus();
}

}  // namespace irsig
