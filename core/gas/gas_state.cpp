#include "core/gas/gas_state.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "core/base/status_macros.h"

namespace irsig {

absl::Status check_gas(const GasState& s) {
  // Comparisons that NaN fails.
  if (!(s.temperature_k >= kGasTemperatureMinK && s.temperature_k <= kGasTemperatureMaxK)) {
    return absl::OutOfRangeError(
        absl::StrFormat("gas temperature_k %g: the tables hold from %g to %g K", s.temperature_k,
                        kGasTemperatureMinK, kGasTemperatureMaxK));
  }
  if (!(s.pressure_pa >= kGasPressureMinPa && s.pressure_pa <= kGasPressureMaxPa)) {
    return absl::OutOfRangeError(
        absl::StrFormat("gas pressure_pa %g: the tables hold from %g to %g Pa", s.pressure_pa,
                        kGasPressureMinPa, kGasPressureMaxPa));
  }
  struct Share {
    const char* name;
    double value;
  };
  for (const Share& share : {Share{"h2o", s.h2o}, Share{"co2", s.co2}, Share{"co", s.co},
                             Share{"h2o + co2 + co", s.h2o + s.co2 + s.co}}) {
    if (!(share.value >= 0 && share.value <= 1 + 1e-12)) {
      return absl::InvalidArgumentError(
          absl::StrFormat("gas mole fraction %s %g: expected 0 to 1", share.name, share.value));
    }
  }
  if (!(s.soot >= 0 && s.soot <= kGasSootMax)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("gas soot volume fraction %g: expected 0 to 1e-3", s.soot));
  }
  return absl::OkStatus();
}

absl::Status check_gas(const GasLayer& segment) {
  if (!(segment.length_m >= 0 && std::isfinite(segment.length_m))) {
    return absl::InvalidArgumentError(
        absl::StrFormat("gas length_m %g: expected 0 or more", segment.length_m));
  }
  RETURN_IF_ERROR(check_gas(segment.state));
  if (!(segment.temperature_spread_k >= 0 &&
        segment.temperature_spread_k < segment.state.temperature_k)) {
    return absl::InvalidArgumentError(absl::StrFormat("gas temperature_spread_k %g at %g K",
                                                      segment.temperature_spread_k,
                                                      segment.state.temperature_k));
  }
  return absl::OkStatus();
}

}  // namespace irsig
