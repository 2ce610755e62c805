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
//   netcdf   netCDF-4 with CF-1.10 attributes: dimensions viewpoint, condition (season and time),
//   band, part and one
//            lambda axis per band; scalars, causes, parts and spectra. One sweep per file.
//            Signatures that are not there (yet) are NaN.
// NOT_FOUND: nothing matches.
[[nodiscard]] absl::Status export_file(StoreReader& reader, const Query& query,
                                       std::string_view format, const std::string& path);

// The same CSV to a stream.
[[nodiscard]] absl::Status export_csv(StoreReader& reader, const Query& query, std::ostream& out);

// The netCDF writer: rows of one sweep, not interpolated, not empty.
[[nodiscard]] absl::Status write_netcdf(StoreReader& reader, const std::vector<QueryRow>& rows,
                                        const std::string& path);

}  // namespace irsig
