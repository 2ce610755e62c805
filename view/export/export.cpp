#include "view/export/export.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <vector>

#include "core/base/status_macros.h"
#include "view/base/atomic_file.h"
#include "view/base/progress.h"
#include "view/query/query_table.h"

namespace irsig {

namespace {

absl::Status nothing() {
  return absl::NotFoundError("nothing to export: no signature matches the filters");
}

absl::Status export_netcdf(StoreReader& reader, const ExportAsked& asked, const std::string& path) {
  if (asked.query.interpolate) {
    return absl::InvalidArgumentError(
        "netcdf holds computed signatures only: export interpolated ones as csv");
  }
  ASSIGN_OR_RETURN(auto rows, run_query(reader, asked.query, asked.extent_of));
  if (rows.empty()) return nothing();
  return replace_file(path, [&](const std::string& beside) {
    return write_netcdf(reader, std::move(rows), beside);
  });
}

absl::Status export_envi(StoreReader& reader, const ExportAsked& asked, const std::string& path) {
  ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, asked.query, asked.extent_of));
  return write_envi(reader, *rows, asked.query.quantity, path);
}

absl::Status export_tsf(StoreReader& reader, const ExportAsked& asked, const std::string& path) {
  if (asked.query.quantity != SignatureQuantity::kIntensity)
    return absl::InvalidArgumentError(
        "--quantity: a target signature file has the intensity at the target: STK puts its own "
        "air and background to it");
  ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, asked.query, asked.extent_of));
  return write_tsf(reader, *rows, path);
}

absl::Status export_csv_file(StoreReader& reader, const ExportAsked& asked,
                             const std::string& path) {
  return replace_file(path, [&](const std::string& beside) -> absl::Status {
    std::ofstream file(beside, std::ios::trunc);
    return export_csv(reader, asked, file);
  });
}

constexpr ExportFormat kFormats[] = {
    {"csv", "one line each", export_csv_file},
    {"netcdf", "netCDF-4 with CF attributes", export_netcdf},
    {"envi", "spectral library of one --band, with its .hdr", export_envi},
    {"tsf", "STK's target signature file of one --season and --band", export_tsf},
};

}  // namespace

std::span<const ExportFormat> export_formats() { return kFormats; }

absl::Status export_csv(StoreReader& reader, const ExportAsked& asked, std::ostream& out) {
  ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, asked.query, asked.extent_of));
  auto some = rows->next();
  if (!some.ok()) return some.status();
  if (some->empty()) return nothing();
  const bool wide = asked.spectra == TableSpectra::kWide;
  ASSIGN_OR_RETURN(auto table, RowTable::make(reader, *some,
                                              {.spectrum = asked.spectra == TableSpectra::kLong,
                                               .wide = wide,
                                               .causes = !wide,
                                               .quantity = asked.query.quantity},
                                              "csv", out));
  LoopProgress progress("rows written", rows->count());
  while (!some->empty() && out) {  // finish() says if the stream failed
    for (const QueryRow& row : *some) {
      RETURN_IF_ERROR(table.write(row));
      progress.step();
    }
    some = rows->next();
    if (!some.ok()) return some.status();
  }
  return table.finish();
}

absl::Status export_file(StoreReader& reader, const ExportAsked& asked, std::string_view format,
                         const std::string& path) {
  std::vector<std::string_view> names;
  for (const ExportFormat& of : kFormats) {
    if (of.name == format) return of.write(reader, asked, path);
    names.push_back(of.name);
  }
  return absl::InvalidArgumentError(
      fmt::format("unknown format \"{}\": expected one of {}", format, fmt::join(names, ", ")));
}

}  // namespace irsig
