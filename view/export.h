#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/store.h"
#include "view/query.h"

namespace irsig {

// Writes what a query selects to a file, completely or not at all.
//   csv      the columns of `irsig query --format csv --causes`, one line per signature
//   netcdf   netCDF-4 with CF-1.10 attributes: dimensions viewpoint, season, time_of_day, band,
//            part, and bin (of the band's wavelengths, which are lambda_um(band, bin)); scalars,
//            causes, parts, spectra with the bins' limits and weights; instant, sun, weather and
//            warnings by condition. One sweep per file. What is not there (yet) is NaN.
//   envi     spectral library of the query's quantity, float32, and beside it its header (.hdr):
//            one band's wavelengths, a spectrum and its name for each signature
// NOT_FOUND: nothing matches.
[[nodiscard]] absl::Status export_file(StoreReader& reader, const Query& query,
                                       std::string_view format, const std::string& path);

// The same CSV to a stream.
[[nodiscard]] absl::Status export_csv(StoreReader& reader, const Query& query, std::ostream& out);

// The netCDF writer: rows of one sweep, not interpolated, not empty.
[[nodiscard]] absl::Status write_netcdf(StoreReader& reader, const std::vector<QueryRow>& rows,
                                        const std::string& path);

// The same for an ENVI spectral library. INVALID_ARGUMENT: rows of different wavelengths.
[[nodiscard]] absl::Status write_envi(StoreReader& reader, const std::vector<QueryRow>& rows,
                                      SignatureQuantity quantity, const std::string& path);
// Of "ship.sli": "ship.hdr".
[[nodiscard]] std::string envi_header_of(const std::string& path);

}  // namespace irsig
