#include "core/gas/gas_bands.h"

#include <algorithm>

#include "absl/strings/str_format.h"

namespace irsig {

double gas_band_centre_cm1(std::size_t band) {
  return kGasFirstCm1 + kGasBandWidthCm1 * (static_cast<double>(band) + 0.5);
}
double gas_band_lambda_um(std::size_t band) { return 1e4 / gas_band_centre_cm1(band); }

absl::StatusOr<std::size_t> gas_band(double lambda_um) {
  const double place = (1e4 / lambda_um - kGasFirstCm1) / kGasBandWidthCm1;
  if (!(place >= 0 && place <= static_cast<double>(kGasBandCount))) {
    return absl::OutOfRangeError(absl::StrFormat(
        "%.6g um: the hot gas's tables cover %.4g to %.4g um", lambda_um,
        1e4 / (kGasFirstCm1 + kGasBandWidthCm1 * static_cast<double>(kGasBandCount)),
        1e4 / kGasFirstCm1));
  }
  return std::min(static_cast<std::size_t>(place), kGasBandCount - 1);
}

std::vector<double> gas_band_edges_um(double lambda_min_um, double lambda_max_um) {
  std::vector<double> out;
  for (std::size_t k = kGasBandCount + 1; k-- > 0;) {
    const double edge_um = 1e4 / (kGasFirstCm1 + kGasBandWidthCm1 * static_cast<double>(k));
    if (edge_um > lambda_min_um && edge_um < lambda_max_um) out.push_back(edge_um);
  }
  return out;
}

}  // namespace irsig
