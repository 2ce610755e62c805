#include "view/rows/signature_quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "absl/strings/str_join.h"
#include "view/rows/measured_row.h"

namespace irsig {
namespace {

using S = StoredSignature;
using Sp = schema::Spectrum;

Measured background_of(const S& row) {
  return {row.background_radiance_w_m2_sr, row.background_radiance_stderr_w_m2_sr, {}};
}

// In the order of SignatureQuantity.
constexpr std::array kColumns = std::to_array<QuantityColumns>({
    {SignatureQuantity::kIntensity, "intensity", "In-band intensity", "W/sr", "intensity_w_sr",
     "intensity_stderr_w_sr", "numerical_error_w_sr", &S::intensity_w_sr, &S::intensity_stderr_w_sr,
     &S::numerical_error_w_sr, "input_uncertainty_w_sr", &S::input_uncertainty_w_sr, source_of,
     "Spectral intensity", "W/(sr \u00b5m)", &Sp::spectral_intensity_w_sr_um,
     &Sp::spectral_intensity_stderr_w_sr_um},
    {SignatureQuantity::kApparentIntensity, "apparent_intensity", "In-band apparent intensity",
     "W/sr", "apparent_intensity_w_sr", "apparent_intensity_stderr_w_sr",
     "apparent_numerical_error_w_sr", &S::apparent_intensity_w_sr,
     &S::apparent_intensity_stderr_w_sr, &S::apparent_numerical_error_w_sr,
     "apparent_input_uncertainty_w_sr", &S::apparent_input_uncertainty_w_sr, apparent_of,
     "Apparent spectral intensity", "W/(sr \u00b5m)", &Sp::apparent_spectral_intensity_w_sr_um,
     &Sp::apparent_spectral_intensity_stderr_w_sr_um},
    {SignatureQuantity::kContrastIntensity, "contrast_intensity", "In-band contrast intensity",
     "W/sr", "contrast_intensity_w_sr", "contrast_intensity_stderr_w_sr",
     "contrast_numerical_error_w_sr", &S::contrast_intensity_w_sr,
     &S::contrast_intensity_stderr_w_sr, &S::contrast_numerical_error_w_sr,
     "contrast_input_uncertainty_w_sr", &S::contrast_input_uncertainty_w_sr, contrast_of,
     "Contrast spectral intensity", "W/(sr \u00b5m)", &Sp::contrast_spectral_intensity_w_sr_um,
     &Sp::contrast_spectral_intensity_stderr_w_sr_um},
    {SignatureQuantity::kBackgroundRadiance, "background_radiance", "In-band background radiance",
     "W/(m\u00b2 sr)", "background_radiance_w_m2_sr", "background_radiance_stderr_w_m2_sr",
     "background_radiance_stderr_w_m2_sr", &S::background_radiance_w_m2_sr,
     &S::background_radiance_stderr_w_m2_sr, &S::background_radiance_stderr_w_m2_sr, nullptr,
     nullptr, background_of, "Background spectral radiance", "W/(m\u00b2 sr \u00b5m)",
     &Sp::background_radiance_w_m2_sr_um, &Sp::background_radiance_stderr_w_m2_sr_um},
});

}  // namespace

double input_uncertainty_of(const QuantityColumns& columns, const StoredSignature& row) {
  return columns.input_uncertainty != nullptr ? row.*columns.input_uncertainty : kNotComputed;
}

const QuantityColumns& columns_of(SignatureQuantity quantity) {
  return kColumns[static_cast<std::size_t>(quantity)];
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> out;
  for (const QuantityColumns& c : kColumns) out.emplace_back(c.name);
  return out;
}

absl::StatusOr<SignatureQuantity> quantity_named(std::string_view name) {
  for (const QuantityColumns& c : kColumns)
    if (name == c.name) return c.quantity;
  return absl::InvalidArgumentError(fmt::format("no quantity \"{}\": expected one of {}", name,
                                                absl::StrJoin(quantity_names(), ", ")));
}

namespace {

absl::Status not_computed(std::uint64_t row, const QuantityColumns& c) {
  return absl::FailedPreconditionError(fmt::format(
      "row {} has no {}: an older irsig stored it (run the sweep again into the same database to "
      "compute it)",
      row, c.value_name));
}

}  // namespace

absl::Status check_computed(const std::vector<StoredSignature>& signatures,
                            SignatureQuantity quantity) {
  const QuantityColumns& c = columns_of(quantity);
  for (const StoredSignature& s : signatures)
    if (std::isnan(s.*c.value)) return not_computed(s.row, c);
  return absl::OkStatus();
}

absl::Status check_computed(std::span<const StoredValue> values, SignatureQuantity quantity) {
  for (const StoredValue& v : values)
    if (std::isnan(v.value)) return not_computed(v.row, columns_of(quantity));
  return absl::OkStatus();
}

}  // namespace irsig
