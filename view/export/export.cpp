#include "view/export/export.h"

#include <fmt/format.h>

#include <fstream>

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

}  // namespace

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
  if (format == "netcdf") return export_netcdf(reader, asked, path);
  if (format == "envi") {
    ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, asked.query, asked.extent_of));
    return write_envi(reader, *rows, asked.query.quantity, path);
  }
  if (format == "tsf") {
    if (asked.query.quantity != SignatureQuantity::kIntensity)
      return absl::InvalidArgumentError(
          "--quantity: a target signature file has the intensity at the target: STK puts its own "
          "air and background to it");
    ASSIGN_OR_RETURN(const auto rows, QueryRows::open(reader, asked.query, asked.extent_of));
    return write_tsf(reader, *rows, path);
  }
  if (format != "csv")
    return absl::InvalidArgumentError(
        fmt::format("unknown format \"{}\": expected csv, netcdf, envi or tsf", format));
  return replace_file(path, [&](const std::string& beside) -> absl::Status {
    std::ofstream file(beside, std::ios::trunc);
    return export_csv(reader, asked, file);
  });
}

}  // namespace irsig
