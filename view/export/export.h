#pragma once

#include <ostream>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "schema/store/reader.h"
#include "view/query/query.h"

namespace irsig {

// Form of spectra in a table.
enum class TableSpectra {
  kNone,  // a line for each signature, in-band
  kLong,  // a line for each wavelength
  kWide   // a line for each signature, and a column for each wavelength of the quantity's spectrum
};

struct ExportAsked {
  Query query;
  TableSpectra spectra = TableSpectra::kNone;  // of csv
  ExtentOf extent_of = {};                     // where rows are moved: query.range_m
};

// A format of export_file().
struct ExportFormat {
  std::string_view name, what;
  absl::Status (*write)(StoreReader&, const ExportAsked&, const std::string& path);
};
[[nodiscard]] std::span<const ExportFormat> export_formats();

// Writes the rows that a query selects to a file, completely or not at all. Memory does not grow
// with the number of rows, except for netcdf (4 kB a row, and its spectrum if the row is moved).
//   csv      the columns of `irsig query --format csv --causes`, one line per signature, or with
//            spectra; one or several sweeps
//   netcdf   netCDF-4 with CF-1.10 attributes. Dimensions are viewpoint, season, time_of_day (time,
//            if there is one season, or a season has several dates), band, part, bin (of the band's
//            wavelengths lambda_um(band, bin)), and range_m if rows are moved to other ranges.
//            Variables are scalars, causes, parts, and spectra with the bins' limits, response and
//            weights; by condition instant, sun, weather and warnings. Each of several sweeps is a
//            group. Missing values are NaN
//   envi     spectral library of the query's quantity, float32, with its header (.hdr): one band's
//            wavelengths, a spectrum and its name for each signature
//   tsf      STK's target signature file: the source spectra of one sweep, season, band and range,
//            by time and direction
// A further format is a line in export_formats(). NOT_FOUND: nothing matches.
[[nodiscard]] absl::Status export_file(StoreReader& reader, const ExportAsked& asked,
                                       std::string_view format, const std::string& path);

// Writes the CSV of export_file() to a stream.
[[nodiscard]] absl::Status export_csv(StoreReader& reader, const ExportAsked& asked,
                                      std::ostream& out);

// Writes rows to a netCDF file. rows: not empty, not interpolated.
[[nodiscard]] absl::Status write_netcdf(StoreReader& reader, std::vector<QueryRow> rows,
                                        const std::string& path);

// Writes an ENVI spectral library. INVALID_ARGUMENT: rows of different wavelengths.
[[nodiscard]] absl::Status write_envi(StoreReader& reader, QueryRows& rows,
                                      SignatureQuantity quantity, const std::string& path);
// Writes a target signature file. INVALID_ARGUMENT: rows of more than one sweep, season, band or
// range, or two of one time and direction.
[[nodiscard]] absl::Status write_tsf(StoreReader& reader, QueryRows& rows, const std::string& path);
// Returns "ship.hdr" for "ship.sli".
[[nodiscard]] std::string envi_header_of(const std::string& path);

}  // namespace irsig
