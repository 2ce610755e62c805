#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "core/accuracy/measured.h"
#include "schema/result.pb.h"
#include "schema/store/tables/filters.h"
#include "schema/store/tables/rows.h"

namespace irsig {

// Columns of a quantity of a signature that can be queried, sorted by and drawn.
struct QuantityColumns {
  SignatureQuantity quantity;
  const char* name;   // in queries: "contrast_intensity"
  const char* title;  // of a plot: "In-band contrast intensity"
  const char* unit;   // "W/sr"
  const char *value_name, *stderr_name, *error_name;
  double StoredSignature::*value;
  double StoredSignature::*value_stderr;
  double StoredSignature::*numerical_error;  // the background radiance has its standard error alone
  // One sigma that uncertain inputs leave; of the background radiance: none.
  const char* input_name;
  double StoredSignature::*input_uncertainty;
  // The value with its bounds; null for the background radiance.
  Measured (*measured)(const StoredSignature&);

  using Values = google::protobuf::RepeatedField<float>;
  const char* spectral_title;
  const char* spectral_unit;
  const Values& (schema::Spectrum::*spectral_value)() const;
  const Values& (schema::Spectrum::*spectral_stderr)() const;

  // Returns true if values below zero are meaningful (a target darker than its background).
  [[nodiscard]] bool is_signed() const { return quantity == SignatureQuantity::kContrastIntensity; }
};

[[nodiscard]] const QuantityColumns& columns_of(SignatureQuantity quantity);

// Returns the uncertainty of the quantity due to uncertain inputs. kNotComputed: the sweep states
// no uncertain inputs, or the quantity has no such uncertainty.
[[nodiscard]] double input_uncertainty_of(const QuantityColumns& columns,
                                          const StoredSignature& row);

// Returns the names intensity, apparent_intensity, contrast_intensity and background_radiance.
[[nodiscard]] std::vector<std::string> quantity_names();
// Returns the quantity of this name. INVALID_ARGUMENT: the name is none of these.
[[nodiscard]] absl::StatusOr<SignatureQuantity> quantity_named(std::string_view name);

// Checks that all signatures have the quantity. FAILED_PRECONDITION, with the remedy: an older
// irsig stored a signature without it.
[[nodiscard]] absl::Status check_computed(const std::vector<StoredSignature>& signatures,
                                          SignatureQuantity quantity);
[[nodiscard]] absl::Status check_computed(std::span<const StoredValue> values,
                                          SignatureQuantity quantity);

}  // namespace irsig
