#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "schema/store/store.h"
#include "view/interpolate.h"

namespace irsig {

// What a user asks of a database; an empty string means "any".
struct Query {
  // {}: so that a designated initializer may name some of the fields.
  std::string sweep{}, season{}, band{};
  std::string time{};                                  // RFC 3339 with any offset
  std::optional<SignatureFilter::Direction> aspect{};  // with exactly one of the next three
  std::uint32_t nearest = 0;
  std::optional<double> within_deg{};
  bool interpolate = false;
  std::optional<std::uint64_t> row{};
  std::optional<double> max_relative_error{};  // of the numerical error, interpolation included
};

// Where an interpolated row comes from.
struct Interpolation {
  SphereFit fit;
  std::vector<StoredSignature> from;  // in the order of fit.used()
  double interpolation_error_w_sr;    // part of numerical_error_w_sr
};

struct QueryRow {
  // Interpolated: row and signature_id are 0, the fields that are not a function of the aspect are
  // those of the nearest viewpoint, numerical errors include the interpolation error.
  StoredSignature signature;
  std::optional<Interpolation> interpolation;
};

// Errors: INVALID_ARGUMENT for contradictory or malformed questions, NOT_FOUND for a sweep, season,
// band or row that does not exist (the message lists the known ones), OUT_OF_RANGE for an aspect
// that the viewpoints do not cover. No match: no rows.
[[nodiscard]] absl::StatusOr<std::vector<QueryRow>> run_query(StoreReader& reader,
                                                              const Query& query);

struct RowSpectrum {
  schema::Spectrum spectrum;
  std::vector<double>
      spectral_interpolation_error_w_sr_um;  // of the source spectrum; empty: not interpolated
};
struct RowPart {
  StoredPart part;
  double interpolation_error_w_sr;  // 0: not interpolated
};

// The spectrum and the parts of a row; of an interpolated one with the row's own weights, so that
// they add up to it.
[[nodiscard]] absl::StatusOr<RowSpectrum> spectrum_of(StoreReader& reader, const QueryRow& row);
[[nodiscard]] absl::StatusOr<std::vector<RowPart>> parts_of(StoreReader& reader,
                                                            const QueryRow& row);

}  // namespace irsig
